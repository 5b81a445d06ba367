"""The extended model with its fitted values, as an object and as a derivation script to run and edit."""

from __future__ import annotations

import ast
import keyword
import pprint
import re
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import sympy as sp
from sympy.printing.str import StrPrinter

import eccentric.model
from eccentric.diagnosis.loop import Diagnosis
from eccentric.effects import constant_load
from eccentric.emission import plain
from eccentric.identification import NO_BACK_EMF, Drive, back_emf_columns
from eccentric.model import Model, regressor, steps, with_values

# The base model as a derivation, where it was given as an object: base.py, which model.py loads.
#
# It has the outcome of a derivation, not its steps: every quantity, definition, term and equation as it is.
_WIDTH = 110
_TAKEN = frozenset({*vars(sp), *vars(steps), *vars(eccentric.model), "model", "show"})


def base_source(model: Model) -> str:
    """The text of a Python script whose module-level `model` equals this one.

    Expressions are evaluated when the script runs: an equation that SymPy was kept from simplifying may be
    printed in another form, its value the same.
    """
    writer = _Writer()
    body = writer.text(model, 0)
    symbols = "".join(f"{name} = {sp.srepr(symbol)}\n" for symbol, name in writer.names.items())
    used = {node.id for node in ast.walk(ast.parse(symbols + body)) if isinstance(node, ast.Name)}
    used -= set(writer.names.values())
    of_steps = {name for name in used if isinstance(getattr(steps, name, None), type)}
    return (
        f'"""{plain(model.title)}.\n\nWritten by `eccentric diagnose`: the base model, as provided.\n"""\n\n'
        f"{_imports('sympy', used - of_steps - writer.words)}\n"
        f"{_imports('eccentric.model', writer.words)}"
        f"{_imports('eccentric.model.steps', of_steps)}"
        f"from eccentric.output import show\n\n"
        f"{symbols}\n"
        f"model = {body}\n\n"
        'if __name__ == "__main__":\n    show(model)\n'
    )


class _Writer(StrPrinter):
    """Values as source text; symbols by names that are given to them here."""

    def __init__(self) -> None:
        super().__init__({"sympy_integers": True, "full_prec": True})
        self.names: dict[sp.Symbol, str] = {}
        self.words: set[str] = set()

    def text(self, value: Any, indent: int) -> str:
        """The value as source text, its further lines indented."""
        if isinstance(value, Enum):
            self.words.add(type(value).__name__)
            return f"{type(value).__name__}.{value.name}"
        if isinstance(value, sp.Basic | sp.MatrixBase):
            return self.doprint(value)
        if is_dataclass(value):
            name = type(value).__name__
            self.words.add(name)
            given = [(f"{f.name}=", getattr(value, f.name)) for f in fields(value) if not _usual(f, value)]
            return self._joined(f"{name}(", given, ")", indent)
        if isinstance(value, Mapping):
            given = [(f"{self.text(key, 0)}: ", x) for key, x in value.items()]
            return self._joined("{", given, "}", indent)
        if isinstance(value, tuple):
            return self._joined("(", [("", x) for x in value], ",)" if len(value) == 1 else ")", indent)
        return repr(value)

    def _joined(self, head: str, parts: list[tuple[str, Any]], tail: str, indent: int) -> str:
        inner = indent + 4
        shown = [f"{label}{self.text(x, inner)}" for label, x in parts]
        line = f"{head}{', '.join(shown)}{tail}"
        if "\n" not in line and indent + len(line) <= _WIDTH:
            return line
        lines = "".join(f"{' ' * inner}{part},\n" for part in shown)
        return f"{head}\n{lines}{' ' * indent}{tail.lstrip(',')}"

    def _print_Symbol(self, expr: sp.Symbol) -> str:
        if expr not in self.names:
            letters = re.sub(r"\W", "_", expr.name, flags=re.ASCII)
            name = f"_{letters}" if keyword.iskeyword(letters) or not letters.isidentifier() else letters
            while name in _TAKEN or name in self.names.values():
                name += "_"
            self.names[expr] = name
        return self.names[expr]

    _print_Dummy = _print_Symbol

    def _print_Integer(self, expr: sp.Integer) -> str:
        # Where a Python number would do, SymPy takes it; alone it has to be SymPy's.
        return f"S({expr.p})" if self._print_level <= 1 else super()._print_Integer(expr)


def _usual(field: Field[Any], value: Any) -> bool:
    default = field.default
    if field.default_factory is not MISSING:
        default = field.default_factory()
    return default is not MISSING and bool(getattr(value, field.name) == default)


def _imports(module: str, names: Iterable[str]) -> str:
    names = sorted(names)
    line = f"from {module} import {', '.join(names)}\n"
    if len(line) <= _WIDTH or not names:
        return line if names else ""
    return f"from {module} import (\n{''.join(f'    {name},{chr(10)}' for name in names)})\n"


_NAME = re.compile(r"(.+?)(?:(_extended)(?:_(\d+))?|_fitted)?")
"""Stem, suffix and number of a model's name."""


def result_name(found: Diagnosis) -> str:
    """Name of the resulting model, and of its emitted trio: `_extended`, numbered from the second on.

    Where nothing was added it is `_fitted`, or the base model's own name if that says what it is.
    """
    base = found.models.base.name
    stem, extended, number = _NAME.fullmatch(base).groups()  # pyright: ignore[reportOptionalMemberAccess]
    if not found.result.effects and not found.asked.request.including:
        return base if is_result_name(base) else f"{base}_fitted"
    return f"{stem}_extended" + (f"_{int(number or 1) + 1}" if extended else "")


def is_result_name(name: str) -> bool:
    """Whether a diagnosis gives models such a name."""
    return _NAME.fullmatch(name)[1] != name  # pyright: ignore[reportOptionalSubscript]


def extended_model(found: Diagnosis) -> Model:
    """The extended model with the fitted values as its defaults: the one that the script builds."""
    fitted, model = _fitted(found), found.result.model
    said = result_name(found), fitted.notes, fitted.title, "diagnosis"
    return with_values(model, fitted.values, *said, **_options(found))


def _options(found: Diagnosis) -> dict[str, Any]:
    """What `with_values` takes of a drive and its log, without what is so by default."""
    drive = found.data.drive
    said = {
        "back_emf_in_friction": (drive.back_emf_in_friction, False),
        "current_known": (drive.current_known, True),
        "voltage_known": (drive.voltage_known, True),
        "torque_unit": (drive.emitted_unit, "N m"),
        "caution": (_caution(found), ""),
        "fits_the_rig": (found.models.fits_the_rig, True),
    }
    return {name: value for name, (value, default) in said.items() if value != default}


def undecided(found: Diagnosis) -> list[str]:
    """Ids of the effects of the emitted model that this log does not distinguish from others."""
    clear = [effect.id for effect, _ in found.clear]
    tied = found.attribution.verdict == "not_identifiable"
    return [effect.id for effect, _ in found.models.extended.effects if tied and effect.id not in clear]


def _caution(found: Diagnosis) -> str:
    """What emitted code says of a tie; "" without one."""
    if not (own := undecided(found)):
        return ""
    between = " and ".join(found.attribution.tied)
    return f"the log does not distinguish between {between}; the model has {' and '.join(own)}, undecided"


@dataclass(frozen=True)
class _Fitted:
    """What is fitted: values and remarks by the paper's letters, and the title of the model."""

    values: dict[str, float]
    notes: dict[str, str]
    title: str


def _fitted(found: Diagnosis) -> _Fitted:
    letters = {q.name for q in found.result.model.parameters}
    values = {k: v for k, v in found.result.values.items() if k in letters and v is not None}
    values = {k: v for k, v in values.items() if k not in _placeholders(found.data.drive)}
    notes = {
        name: f"fitted: {e.value:.4g}, 95 % interval {e.interval[0]:.4g} to {e.interval[1]:.4g}"
        for name, e in found.result.estimates.items()
    }
    drive = found.data.drive
    declared = set(found.rig.known)
    if drive.scale is not None and not (drive.by_voltage and {"R", "k_i"} <= declared):
        with_k_i = "k_i as declared" if "k_i" in declared else "k_i = 1 N m/A"
        letters_of = f"R/k_i, with {with_k_i}" if drive.by_voltage else "k_i"
        identified = "identified through gravity or inertia"
        if found.unit != "N m":
            identified = f"not identified: N m represents {found.unit}"
        notes["R" if drive.by_voltage else "k_i"] = f"{letters_of}: {identified}"
    if drive.back_emf_in_friction:
        notes["k_e"] = "0 by convention: the back-EMF is in the viscous friction"
        shared = back_emf_columns(found.models.base)
        for c in regressor(found.models.base):
            if c.name in shared:
                name, emf = c.parameter.name, "contains k_e k_i/R, which this log cannot separate from it"
                notes[name] = f"{notes.get(name, '')}; {emf}"
    if not drive.voltage_known and drive.along is None:
        values |= dict.fromkeys(drive.machine.back_emf_letters & letters, 0.0)
        notes |= dict.fromkeys(drive.machine.back_emf_letters & letters, NO_BACK_EMF)
    names = ", ".join(effect.id for effect, _ in found.result.effects)
    done = f"extended by {names}" if names else "fitted"
    return _Fitted(values, notes, f"{found.models.base.title}, {done}")


def _placeholders(drive: Drive) -> set[str]:
    """Constants of the drive of an arm's joint that the fit has a number for and nobody knows."""
    if drive.along is None:
        return set()
    unknown = set(drive.machine.absent) - set(drive.known)
    return unknown | ({"k_i"} if drive.channels.motor.measured_by == "torque" else set())


def script(found: Diagnosis) -> str:
    """The text of model.py: the base model, the effects with their values, the fitted coefficients.

    It is an ordinary derivation: `python model.py` prints it, `eccentric emit model.py` emits it.
    """
    adopted, fitted = found.models.extended.effects, _fitted(found)
    origin, base = plain(", ".join(found.asked.logs)), repr(found.models.base.name)
    if found.asked.model.endswith(".py"):  # in the same folder
        base = f"Path(__file__).with_name({Path(found.asked.model).name!r})"
    setting = pprint.pformat(found.setting, width=100, compact=True)
    # A set prints in a different order in every run.
    channels = found.setting.channels
    setting = setting.replace(repr(channels), f"frozenset({sorted(channels)})")
    setting = setting.replace("Setting(", "Setting(base=model,\n        ", 1)
    chosen = pprint.pformat([(effect.id, own) for effect, own in adopted], width=100)
    load = ("", "")
    if any(extension.name == constant_load.id for extension in found.models.base.extensions):
        load = (", with_constant_load", "model = with_constant_load(model)\n")
    log = "".join(f"\n    {name}={value!r}," for name, value in _options(found).items())
    own = ""
    if found.asked.effects is not None:
        own = f"\noffered += load_effects(Path(__file__).with_name({found.asked.effects.name!r}), setting)"
    term, words = "", ["Setting", "library", f"load_effects{load[0]}"]
    if found.result is not found.models.extended and found.empirical is not None:
        curves = pprint.pformat(found.empirical.curves, width=100)
        values = pprint.pformat(found.empirical.coefficients, width=100)
        term = f"\n# A term without a cause.\nterm = empirical_term(setting, {curves})\n"
        term += f"model = term.extend(model, {values})\n"
        words = ["Curve", "Setting", "empirical_term", *words[1:]]
    return f'''"""{plain(fitted.title)}.

Written by `eccentric diagnose` from {origin}.
An ordinary derivation: run it to print it, edit it, emit it with `eccentric emit model.py --out DIR`.
"""

from pathlib import Path

from eccentric.effects import {", ".join(words)}
from eccentric.model import load_model, with_values
from eccentric.output import show

# {found.rig.axis.text("The paper's model")}.
model = load_model({base})
{load[1]}
# The ranges of the log, from which those of the effects in the library follow.
setting = {setting}
offered = [*library(setting)]{own}
effects = {{effect.id: effect for effect in offered}}

# The effects that the model is missing on this log.
for name, values in {chosen}:
    model = effects[name].extend(model, values)
{term}
model = with_values(
    model,
    {pprint.pformat(fitted.values, width=96, indent=1)},
    name={result_name(found)!r},
    notes={pprint.pformat(fitted.notes, width=96)},
    title={fitted.title!r},{log}
)

if __name__ == "__main__":
    show(model)
'''
