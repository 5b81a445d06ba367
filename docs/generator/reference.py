"""The reference of effects: a section for each family of the library, from its records."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path

from eccentric.effects import FAMILIES, Effect, base_aliases
from eccentric.model import ANGLE, Model, Quantity
from eccentric.presentation.html.formulas import short_formula
from generator.formula import equations, typesetter
from generator.pictures import draw
from generator.setting import effects

SHOWN_ORDER = "n=2"
"""Of families with an effect for each harmonic this one stands for all."""


def sections(images: Path, *leading: str) -> str:
    """Sections of the families whose leading variable is one of these, in the order of the library.

    Args:
        images: folder for the pictures.
        leading: variables, see `Evidence.depends_on`.
    """
    return "\n".join(_family(family, images) for family in FAMILIES if _leading(family) in leading)


def overview() -> str:
    """A table of all families: what it is, its name, formula, what it depends on."""
    rows = []
    for family in FAMILIES:
        effect, _ = _of(family)[0]
        adds = short_formula(effect.formula)
        rows.append(
            _row(f"[{_title(family)}](#{family}) `{family}`", adds, _words(effect.evidence.depends_on))
        )
    return "\n".join(["| effect | adds or changes | depends on |", "|---|---|---|", *rows])


def _row(*cells: str) -> str:
    """A row of a table; a bar within a cell is no border."""
    return f"| {' | '.join(cell.replace('|', '&#124;') for cell in cells)} |"


def _of(family: str) -> list[tuple[Effect, Model]]:
    return [(effect, model) for effect, model in effects() if effect.family == family]


def _leading(family: str) -> str:
    return _of(family)[0][0].evidence.depends_on[0]


def _words(names: tuple[str, ...]) -> str:
    return ", ".join(name.replace("_", " ") for name in names)


def _title(family: str) -> str:
    """A heading for the family: its own, or the headline of its only effect."""
    words = _of(family)[0][0].words
    return words.title or words.headline[0].upper() + words.headline[1:]


def _family(family: str, images: Path) -> str:
    members = _of(family)
    # Sphinx makes hyphens of underscores in a label: the family's own spelling is an anchor too.
    anchor = [f'<span id="{family}"></span>', ""] if "_" in family else []
    lines = [
        *anchor,
        f"({family})=",
        f"## {_title(family)}",
        "",
        f"`{family}`",
        "",
        members[0][0].words.meaning,
        "",
    ]
    for case in ("C1", "C2"):
        if held := base_aliases(case).get(family):
            lines += [f"Not offered in case {case}: there it is {held}.", ""]
    orders = [effect.id for effect, _ in members if effect.evidence.repeats]
    if orders:
        last = members[-1][0].variant.removeprefix("n=")
        shown = next((one for one in members if one[0].variant == SHOWN_ORDER), members[0])
        here = shown[0].variant.replace("=", " = ")
        lines += [f"Offered for every n up to {last}; here {here}.", ""]
        members = [shown]
    notes = [_notes(effect) for effect, _ in members]
    shared = [note for note in notes[0] if all(note in other for other in notes)]
    for (effect, model), own in zip(members, notes, strict=True):
        if len(members) > 1:
            lines += [
                f"### {effect.words.headline[0].upper()}{effect.words.headline[1:]}",
                "",
                f"`{effect.id}`",
                "",
            ]
        lines += [*_effect(effect, model, images), "", *(note for note in own if note not in shared), ""]
    if len(members) > 1 and shared:
        lines += [f"All effects of `{family}`:", ""]
    return "\n".join([*lines, *shared, ""])


def _effect(effect: Effect, model: Model, images: Path) -> Iterator[str]:
    """Formula, picture and parameters."""
    if effect.change.states:  # in continuous time, which is easier to read than steps
        yield from (f"<p>{short_formula(effect.formula)}</p>", "")
    for text in equations(effect):
        yield from (f'<div class="formula">{text}</div>', "")
    name = re.sub(r"\W+", "_", effect.id.replace("+", "forward").replace("[-", "[backward")).strip("_")
    shows = draw(effect, model, images / "effects" / name)
    yield '<p class="picture">'
    for style, suffix in (("light", ""), ("dark", "-dark")):
        alt = escape(f"{effect.id}: {shows}", quote=True)
        yield f'<img class="only-{style}" src="../_images/effects/{name}{suffix}.svg" alt="{alt}">'
    yield from ("</p>", "")
    yield from (
        "| symbol | parameter | meaning | unit | range |",
        "|---|---|---|---|---|",
        *_parameters(effect),
    )


def _notes(effect: Effect) -> list[str]:
    """What else its record says, as items of a list."""
    said = [f"Depends on {_words(effect.evidence.depends_on)}; {effect.balance} balance."]
    if effect.change.scales:
        roles = [
            role.value.capitalize() if role.value == "coulomb" else role.value
            for role in effect.change.scales
        ]
        said.append(
            f"f is the {_list(roles)} friction." if len(roles) < 3 else "f is the friction of all contacts."
        )
    if effect.evidence.needs:
        said.append(f"Needs a log with {_list([_words((name,)) for name in effect.evidence.needs])}.")
    for kind, words in effect.only_with.items():
        only = f"a {kind} that is not declared or {', '.join(words)}"
        said.append(f"Only with {'the angle of the motor' if kind == ANGLE else only}.")
    if causes := effect.words.causes:
        said.append(f"Possible causes: {', '.join(cause.name for cause in causes)}.")
    for known in effect.plausible:
        unit = "" if known.unit == "1" else f" {known.unit}"
        ranges = [("", known.low, known.high, known.source)]
        ranges += [(f"{part}: ", *of_part) for part, of_part in known.by_part.items()]
        said += [
            f"Known of {known.name.rstrip(',')}: {part}{low:g} to {high:g}{unit} ({source})."
            for part, low, high, source in ranges
            if math.isfinite(high)
        ]
    if effect.evidence.aliases:
        said.append(f"Indistinguishable from {_links(effect.evidence.aliases)}.")
    if effect.evidence.special_of:
        said.append(f"A special case of {_links(effect.evidence.special_of)}.")
    said += [f"To distinguish it from others: {effect.words.hint}.", f"Source: {effect.reference}."]
    return [f"- {one}" for one in said]


def _parameters(effect: Effect) -> Iterator[str]:
    """Rows of the table: coefficients with their bounds, shapes with their range, what follows from them."""
    typeset = typesetter(effect)

    def described(q: Quantity, allowed: str) -> str:
        return _row(f"<math>{typeset(q.symbol)}</math>", f"`{q.name}`", q.meaning, q.unit, allowed)

    for q, (low, high) in zip(effect.coefficients, effect.bounds, strict=True):
        yield described(q, _range(low, high))
    for shape in effect.shapes:
        yield described(shape.quantity, f"{_short(shape.low)} to {_short(shape.high)}")
    for definition in effect.change.definitions:
        value = definition.value
        yield described(definition.quantity, f"here {float(value):g}" if value.is_number else "defined above")
    for state in effect.change.states:
        yield described(state.quantity, f"hidden state, initially {float(state.initial):g}")


def _list(names: Sequence[str]) -> str:
    """Names as a sentence has them."""
    *most, last = names
    return f"{', '.join(most)} and {last}" if most else last


def _range(low: float | None, high: float | None) -> str:
    if low is None:
        return "any" if high is None else f"at most {high:g}"
    return f"at least {low:g}" if high is None else f"{low:g} to {high:g}"


def _short(x: float) -> str:
    """Three digits, without an exponent where it can be."""
    return f"{float(f'{x:.3g}'):g}"


def _links(names: tuple[str, ...]) -> str:
    return ", ".join(f"[{name}](#{name.split('[', 1)[0]})" for name in names)
