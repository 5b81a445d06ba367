"""A diagnosis in words: one sentence that can be sent to a colleague, and a few lines for a terminal.

The description of an effect comes first, its id second; both come from the effect's own record.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from eccentric.core import few
from eccentric.diagnosis import PROVABLE, ROUNDING, Diagnosis, OverRuns, SearchRequest, only_below
from eccentric.effects import Effect
from eccentric.identification import in_drive_unit
from eccentric.model import DRIVE_PARTS, spoken_quantity
from eccentric.presentation.calls_text import calls, share_words
from eccentric.presentation.fit_text import band_line, inertia_words
from eccentric.presentation.plan_text import measurement_sentence
from eccentric.presentation.ranges_text import (
    declare_sentence,
    effect_name,
    excluded_sentence,
    outside_sentences,
    parts_needed,
    possible_causes,
    range_line,
    ruled_out_sentence,
    undeclared,
)

VERDICTS = {
    "named": "effect named",
    "not_identifiable": "not identifiable from this log",
    "unexplained": "structure unexplained",
    "nothing_missing": "nothing missing",
}
MOSTLY = 0.5
"""Part of the residual's mean square from which effects that explain it, but not all of it, are mentioned."""
_MISFIT = "log does not fit the rig"
_NONE = "no effect in the library explains"
_NONE_HERE = "no cause that this drive can have explains"
_NONE_SEEN = "no effect that this log can prove explains"


def verdict_words(verdict: str, fits_the_rig: bool) -> str:
    """A verdict in a few words; a log that does not fit its rig has none."""
    return VERDICTS[verdict] if fits_the_rig else _MISFIT


def diagnosis_sentence(found: Diagnosis) -> str:
    """One sentence that can be sent to a colleague, and one for each estimate outside its known range."""
    return " ".join([_verdict(found), *outside_sentences(found)])


def _verdict(found: Diagnosis) -> str:
    a, axis, unit = found.attribution, found.rig.axis, _unit(found)
    if a.verdict == "named":
        missing = [effect for effect, _ in (*found.effects, *found.undecided)]
        changed = "Adding" if any(_values(found, effect) is None for effect in missing) else "Correcting"
        these = "it" if len(missing) == 1 else "them"
        more = f"{_causes(found)}{_alike(found)}{_grave(found)}"
        return f"{_missing(found, missing)} {_gain(found, f'{changed} {these}')}.{more}"
    if a.verdict == "not_identifiable" and found.clear:
        clear = _missing(found, [effect for effect, _ in found.clear])
        return (
            f"{clear} Also missing is one of these, which this log cannot distinguish: {_tied(found, 'or')}."
            f" {_gain(found, 'Adding the first of them')}.{_causes(found)}"
        )
    if a.verdict == "not_identifiable":
        return (
            f"An effect is missing, but this log cannot distinguish between {_tied(found, 'and')}."
            f" {_gain(found, 'Adding the first')}."
        )
    if misfit := found.models.misfit:
        return (
            f"This log does not fit the rig ({misfit}): check units and signs before anything else."
            f"{_grave(found)}"
        )
    depends = _listed([axis.term(variable.replace("_", " ")) for variable in a.depends_on])
    if a.unconfirmed:
        words = {c.id: c.words for c in a.candidates}
        names = _listed([effect_name(words[name].headline, name) for name in a.unconfirmed])
        fit = "fits the training part but does" if len(a.unconfirmed) == 1 else "fit the training part but do"
        where = _of_balance(found, found.refused.balance) if found.refused else ""
        return (
            f"{names[0].upper()}{names[1:]} {fit} not predict the held-out part{where}: no effect is named."
            f" The residual depends on {depends}."
        )
    if a.verdict == "unexplained":
        asked = found.asked.request.only
        explains = f"none of the requested effects ({_listed(asked)}) explains" if asked else _NONE
        if a.ruled_out:
            needing = any(e.lacks(found.rig.parts) for e in _left_out(found))
            explains = _NONE_HERE if needing else _NONE_SEEN
        elif not asked and (part := a.explained) > MOSTLY:
            effects = [one.variant.candidate for one in a.adopted]
            names = _listed([effect_name(c.words.headline, c.id) for c in effects])
            return (
                f"{names[0].upper()}{names[1:]} would explain {100.0 * part:.0f} % of the residual's mean"
                f" square, but more than chance is left, so no effect is named. The residual depends on"
                f" {depends}."
            )
        return f"The residual still depends on {depends or 'something unknown'}, and {explains} it."
    left = found.score.rmse[found.score.balance]["paper"]
    if left > PROVABLE * found.noise_floor:
        return (
            f"Nothing more can be proved from this log: the remaining {left:.4g} {unit} is well above"
            f" the sensor noise of {found.noise_floor:.2g} {unit}, but no effect explains more of it"
            " than chance would."
        )
    return (
        f"Nothing is missing: no effect explains more of the residual than chance would"
        f" (held-out error {left:.4g} {unit}; sensor noise alone {found.noise_floor:.4g} {unit})."
    )


def request_words(asked: SearchRequest) -> str:
    """What was asked of a search; "" for nothing."""
    parts = (("with", asked.including), ("without", asked.without), ("only", asked.only))
    return "; ".join(f"{word} {', '.join(names)}" for word, names in parts if names)


def _unit(found: Diagnosis) -> str:
    """The unit of the errors, for the axis."""
    return found.rig.axis.unit(found.unit)


def tied_families(found: Diagnosis) -> tuple[str, ...]:
    """The families that the log does not distinguish; none unless that is the verdict."""
    a = found.attribution
    if a.verdict != "not_identifiable":
        return ()
    return a.tied or tuple(dict.fromkeys(c.family for c in a.candidates))[:2]


def further_sentences(found: Diagnosis) -> list[str]:
    """What else predicts the log: causes ruled out, the best candidate, another model, a smooth term."""
    sentences = (
        excluded_sentence(found, [effect for effect, _ in found.models.extended.effects]),
        declare_sentence(undeclared_parts(found)),
        ruled_out_sentence(found),
        _closest(found),
        _better_model(found),
        empirical_sentence(found),
    )
    return [sentence for sentence in sentences if sentence]


def _closest(found: Diagnosis) -> str:
    """What the best effect takes out of the held-out error, where none is adopted; "" without one."""
    if (best := found.closest) is None:
        return ""
    what = effect_name(best.effect.words.headline, best.effect.id)
    rest = (
        "it explains only part of the residual"
        if found.attribution.verdict == "unexplained"
        else "it is not proved"
    )
    percent, (low, high), where = best.percent, best.interval, ""
    if best.below is not None and only_below(best.interval, best.below):
        percent, (low, high) = best.below.percent, best.below.interval
        where = f" below {best.below.cut_hz:g} Hz"
    where = _of_balance(found, best.balance) + where
    interval = f"95 % interval {low:.1f} to {high:.1f} %"
    if percent <= 0.0:
        gain = f"95 % interval of its gain {low:.1f} to {high:.1f} %"
        return f"Best candidate: {what}; it does not lower the held-out error{where} ({gain})."
    return f"Best candidate: {what}, with {percent:.1f} % lower held-out error{where} ({interval}); {rest}."


def _of_balance(found: Diagnosis, balance: str) -> str:
    """Which balance is meant, where the log shows two."""
    return f" of the {balance} balance" if len(found.models.paper.residuals) > 1 else ""


def _better_model(found: Diagnosis) -> str:
    """Which shipped model predicts better as it stands; "" for none."""
    if (better := found.sibling) is None:
        return ""
    low, high = better.interval
    ours = found.models.base.name + (" with the effects found" if found.models.adopted else "")
    return (
        f"{better.name} as shipped has {better.percent:.1f} % lower held-out error than {ours}"
        f" (95 % interval {low:.1f} to {high:.1f} %)."
    )


def empirical_sentence(found: Diagnosis) -> str:
    """What the term without a cause does, or why there is none; where it may help, the offer of one.

    "" where nothing of it is to be said.
    """
    own, axis = found.empirical, found.rig.axis
    if not found.asked.request.empirical:
        offer = "With --empirical, the emitted model gets a smooth term without a cause instead."
        return offer if found.attribution.verdict == "unexplained" and found.models.fits_the_rig else ""
    if own is None:
        return "No smooth term in one or two variables predicts this log clearly better; none is added."
    over = _listed([axis.term(name.replace("_", " ")) for name in own.variables])
    low, high = own.interval
    if not own.confirmed:
        return (
            f"A smooth term in {over} fits the training part, but does not lower the held-out error"
            f" (95 % interval of its gain {low:.1f} to {high:.1f} %); none is added."
        )
    lowers, change = _lowers(*own.rmse, _unit(found), own.percent, own.interval)
    count = len(own.effect.coefficients)
    return (
        f"The emitted model has a term without a cause, {own.effect.id}, smooth in {over} with {count}"
        f" coefficients; it {lowers} the held-out error {change}."
    )


def _listed(names: Sequence[str], last: str = "and") -> str:
    """Names joined as in a sentence."""
    return f" {last} ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def _gain(found: Diagnosis, change: str) -> str:
    """What a change, such as "Adding it", does to the held-out error."""
    score, unit = found.score, _unit(found)
    before, after = (score.rmse[score.balance][model] for model in ("paper", "extended"))
    of = " of the electrical balance" if score.balance == "electrical" else ""
    if score.below is None or not score.only_below:
        lowers, by = _lowers(before, after, unit, score.percent, score.interval)
        return f"{change} {lowers} the held-out error{of} {by}"
    below = score.below
    lowers, by = _lowers(below.before, below.after, unit, below.percent, below.interval)
    goes, why = "goes", ""
    if score.interval[1] < 0.0:
        goes, why = "rises", ", because the filter removes the acceleration that faster ripple causes"
    return (
        f"{change} {lowers} the held-out error below {below.cut_hz:g} Hz {by}; row by row it"
        f" {goes} from {before:.4g} to {after:.4g} {unit}{why}"
    )


def _lowers(
    before: float, after: float, unit: str, percent: float, interval: tuple[float, float]
) -> tuple[str, str]:
    low, high = interval
    return (
        "lowers" if low > 0.0 else "does not clearly lower",
        f"from {before:.4g} to {after:.4g} {unit} ({percent:.1f} %, 95 % interval {low:.1f} to {high:.1f} %)",
    )


def _missing(found: Diagnosis, effects: Sequence[Effect]) -> str:
    """Sentences that name effects, each with its probability: declared values that are wrong come first."""
    corrections, named = [], []
    for effect in effects:
        ranked = [c.probability for c in found.attribution.candidates if c.family == effect.family]
        sure, headline = f"probability {max(ranked, default=0.0):.2f}", effect.words.headline
        if effect.corrects and (values := _values(found, effect)):
            q = spoken_quantity(found.rig.axis, effect.corrects.quantity)
            true, declared = (f"{x:.4g}{'' if q.unit == '1' else f' {q.unit}'}" for x in values)
            corrections.append(
                f"{q.name} should be {true}; the rig file has {declared} ({effect.id},"
                f" {sure}){_or_else(found, effect)}."
            )
        else:
            named.append(f"{headline} ({effect.id}, {sure})" if headline else f"{effect.id} ({sure})")
    return " ".join([*corrections, *([f"Missing: {_listed(named)}."] if named else [])])


def _or_else(found: Diagnosis, effect: Effect) -> str:
    """What explains the log as well as a wrong declared value does."""
    own, best = found.attribution.adopted_as(effect.id), {c.family: c for c in found.attribution.candidates}
    others = [best[f] for f in own.alike if f in best and f != effect.family] if own else []
    return "".join(f", or the model is missing {effect_name(c.words.headline, c.id)}" for c in others)


def _values(found: Diagnosis, effect: Effect) -> tuple[float, float] | None:
    """True and declared value of what an effect corrects; None if it, or the rig, does not tell them."""
    if (correction := effect.corrects) is None:
        return None
    fitted = {q.symbol: found.models.extended.values[q.name] for q in effect.parameters}
    letters = {s.name: s for s in correction.value.free_symbols - set(fitted)}
    if not set(letters) <= set(found.rig.known):
        return None
    known = {s: found.rig.known[name] for name, s in letters.items()}
    true, declared = (float(correction.value.subs(known | own)) for own in (fitted, dict.fromkeys(fitted, 0)))
    return true, declared


def _tied(found: Diagnosis, last: str) -> str:
    """The families that explain the log equally well, each by its best member that is not clear itself."""
    clear, listed = {effect.id for effect, _ in found.clear}, found.attribution.candidates[::-1]
    best = {c.family: c for c in listed} | {c.family: c for c in listed if c.id not in clear}
    names = [effect_name(best[family].words.headline, best[family].id) for family in tied_families(found)]
    return _listed(names, last)


def _alike(found: Diagnosis) -> str:
    """What no log of this rig, as declared, distinguishes from the named effects."""
    aliases = {effect.id: aliases_of(found, effect) for effect, _ in found.effects}
    alike = {name: " or ".join(others) for name, others in aliases.items() if others}
    return "".join(
        f" With the rig as declared, {name} looks the same as {other}." for name, other in alike.items()
    )


def aliases_of(found: Diagnosis, effect: Effect) -> tuple[str, ...]:
    """What no log of this rig distinguishes from an effect, without families that the drive cannot have."""
    parts, offered = found.rig.parts, found.offered
    impossible = {e.family for e in offered if e.lacks(parts)} - {
        e.family for e in offered if not e.lacks(parts)
    }
    return tuple(name for name in effect.evidence.aliases if name.partition("[")[0] not in impossible)


def _causes(found: Diagnosis) -> str:
    """The possible causes of named effects."""
    effects = [effect for effect, _ in (*found.effects, *found.clear)]
    every = {e.id: [cause.name for cause in possible_causes(found, e)] for e in effects}
    causes = {name: names for name, names in every.items() if names}
    if len(causes) > 1:
        each = (f"{name} may be {_listed(names, 'or')}" for name, names in causes.items())
        return f" {'; '.join(each)}."
    return "".join(f" Possible causes: {', '.join(names)}." for names in causes.values())


def undeclared_parts(found: Diagnosis) -> tuple[str, ...]:
    """Kinds of parts that would narrow the causes of a name, or a tie, if the rig declared them.

    Also those that could rule out a name that was not checked on resampled logs, or an effect left out.
    """
    offered, best = (
        {effect.id: effect for effect in found.offered},
        {c.family: c.id for c in reversed(found.attribution.candidates)},
    )
    groups = [
        [cause.only_with for cause in possible_causes(found, effect)]
        for effect, _ in (*found.effects, *found.clear)
    ]
    groups.append([offered[best[family]].only_with for family in tied_families(found)])
    named = [effect for effect, _ in (*found.effects, *found.clear)]
    unsure = [e for e in named if (own := found.attribution.adopted_as(e.id)) and not own.variants]
    unsure += [effect for effect in _left_out(found) if not effect.lacks(found.rig.parts)]
    groups += [[parts_needed(effect, found.rig), {}] for effect in unsure]
    kinds = {kind for needs in groups for kind in undeclared(found.rig.parts, needs)}
    return tuple(kind for kind in DRIVE_PARTS if kind in kinds)


def _left_out(found: Diagnosis) -> list[Effect]:
    """Effects that explain more, but that the drive cannot have, or of which the log shows no period."""
    offered = {effect.id: effect for effect in found.offered}
    return [offered[c.id] for c in found.attribution.ruled_out if c.id in offered]


def _grave(found: Diagnosis) -> str:
    """What the check of the log found wrong, unless the named effects already say so."""
    corrections = [effect.corrects for effect, _ in found.effects if effect.corrects]
    said = {name for c in corrections for name in (c.quantity.name, *c.looks_wrong)}
    warnings = [f for f in found.channels.intake.findings if f.doubts_the_rig]
    grave = [f.text for f in warnings if f.channel not in said]
    if not grave:
        return ""
    first, text = grave[0].split()[0].rstrip(":,"), grave[0]
    # The letter of a quantity is no word that a sentence begins with: k_i is not K_i.
    start = text[0] if first in {*found.rig.known, *found.rig.unknown} else text[0].upper()
    return f" {start}{text[1:]}{'' if text.endswith('?') else '.'}"


def diagnosis_lines(found: Diagnosis) -> list[str]:
    """At most twenty-four lines for a terminal."""
    a, adopted, axis = found.attribution, found.models.adopted, found.rig.axis
    verdict = verdict_words(a.verdict, found.models.fits_the_rig)
    out = [f"{few(found.asked.logs)}: {found.models.base.name}; verdict: {verdict}"]
    if words := request_words(found.asked.request):
        out.append(f"as requested: {words}")
    out += filter(None, (found.channels.excerpt, found.rig.added_words, inertia_words(found.rig)))
    out.append(diagnosis_sentence(found))
    out += [
        _effect(found, effect, own) for effect, own in (*found.effects, *found.undecided, *found.clear)[:3]
    ]
    out += [f"  {range_line(check)}" for check in found.ranges if check.outside]
    for balance, models in found.score.rmse.items():
        shown = {name: error for name, error in models.items() if name != "extended" or adopted}
        if axis.model:  # the base model of a carriage is Coulomb + viscous friction
            shown = {"base" if name == "paper" else name: x for name, x in shown.items() if name != "linear"}
        out.append(f"held-out RMSE, {balance} [{_unit(found)}]: {_errors(shown)}")
        if balance == "mechanical" and found.band is not None:
            plain = "base" if axis.model else "paper"
            out.append(band_line(found.band, _unit(found), "extended" if adopted else plain))
    if adopted and (aliased := _aliased(found)):
        out.append(aliased)
    if found.score.over_runs is not None:
        out += _over_runs(found.score.over_runs, _unit(found), axis.term("angle"))
    out += further_sentences(found)
    if a.verdict == "unexplained" and found.models.fits_the_rig:
        out.append("closest candidates, none sufficient:")
        out += [f"  {effect_name(c.words.headline, c.id)}" for c in a.candidates[:4]]
    elif a.verdict in {"named", "not_identifiable"}:
        several = len(a.adopted) > 1
        chances = "each with its own probability" if several else "with their probabilities"
        out.append(f"candidates, {chances}:")
        out += _ranked(found)
    if found.orders:
        parts = ", ".join(f"{o.per_turn:.2f} ({100 * o.share:.0f} % of its variance)" for o in found.orders)
        out.append(
            f"the residual within runs is periodic in the {axis.term('motor angle')}; cycles"
            f" per turn: {parts}"
        )
    out += filter(None, (_to_correct(found, effect) for effect, _ in found.effects))
    out += calls(found)
    if a.next_measurement:
        out.append(f"next: {measurement_sentence(a.next_measurement, axis)}")
    return out


def _to_correct(found: Diagnosis, effect: Effect) -> str:
    """The line of the rig file for a wrong declared value; "" for any other effect."""
    if effect.corrects is None or (values := _values(found, effect)) is None:
        return ""
    q, (true, declared) = spoken_quantity(found.rig.axis, effect.corrects.quantity), values
    times = f", {true / declared:.4g} times the declared value" if declared else ""
    unit = "" if q.unit == "1" else f" {q.unit}"
    return f'to correct in the rig file: {q.name} = "{true:.4g}{unit}"{times}'


def _ranked(found: Diagnosis) -> list[str]:
    """The first candidates with their probability; below a name, the causes whose probability it includes."""
    above = {x: one.variant.candidate.family for one in found.attribution.adopted for x in one.covers}
    shown = found.attribution.candidates[:4]
    families = {c.family for c in shown}
    lines = []
    for c in shown:
        if above.get(c.family) in families:
            continue
        lines.append(f"  {c.probability:.2f} {effect_name(c.words.headline, c.id)}")
        lines += [
            f"    of which {part.probability:.2f} {effect_name(part.words.headline, part.id)}"
            for part in shown
            if above.get(part.family) == c.family
        ]
    return lines


def _aliased(found: Diagnosis) -> str:
    """In how many held-out rows an effect is too fast for the motion to show it; "" for none."""
    rows = found.data.rows.score
    share = 100.0 * float(np.mean(found.models.extended.unresolved_rows[rows]))
    if share == 0.0:
        return ""
    return (
        f"in {share:.0f} % of the held-out rows the effect repeats faster than half the sampling rate:"
        " the motion cannot show it there"
    )


def _effect(found: Diagnosis, effect: Effect, own: Mapping[str, float]) -> str:
    shown, axis = [], found.rig.axis
    for q in effect.parameters:
        estimate = found.models.extended.estimates.get(q.name)
        error = ""
        if estimate is not None:
            endless = math.isinf(estimate.std_error)
            end = f", at the {estimate.bound_active} end of its range" if estimate.bound_active else ""
            error = " (not determined)" if endless else f" (std error {estimate.std_error:.2g}{end})"
        unit = "" if q.unit == "1" else f" {axis.unit(in_drive_unit(q.unit, found.unit))}"
        shown.append(f"{axis.named(q.name)} = {own[q.name]:.4g}{unit}{error}")
    variants = stability_words(found, effect)
    where = f", {variants}" if variants else ""
    return f"  {effect.id}, {share_words(found.models.extended, effect)}{where}: {', '.join(shown)}"


def stability_words(found: Diagnosis, effect: Effect) -> str:
    """In how many resampled logs an adopted effect is found, and what is found instead.

    "" for an effect that was not searched for.
    """
    own = found.attribution.adopted_as(effect.id)
    if own is None:
        return ""
    if not own.variants:
        return "stability not checked (the log has too few blocks)"
    instead = ", ".join(f"{family} in {times}" for family, times in own.instead.items())
    others = f" ({instead})" if instead else ""
    if own.by_both:
        alone = f"found in {own.found} of {own.variants} resampled logs by the {own.balance} balance alone"
        return f"{alone}{others}; both balances together decide"
    return f"found in {own.found} of {own.variants} resampled logs{others}"


def _errors(models: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {value:.4g}" for name, value in models.items())


def _over_runs(over: OverRuns, unit: str, angle: str) -> list[str]:
    out = [f"each of {over.runs} runs predicted from the others [{unit}]: {_errors(over.rmse)}"]
    for name, (percent, (low, high), better) in over.gains.items():
        # Without a mass, or at its bounds, the paper's model is the linear one.
        if max(-low, high) < ROUNDING:
            continue
        than = {"paper": "linear", "extended": "paper"}[name]
        out.append(
            f"  {name} against {than}: {abs(percent):.1f} % {'lower' if percent > 0 else 'higher'} error"
            f" (95 % interval of the gain {low:.1f} to {high:.1f} %, {better} of {over.runs} runs better)"
        )
    if over.below is not None and over.gains["extended"][1][0] <= 0.0 < over.below[1][0]:
        percent, (low, high) = over.below
        out.append(
            f"  below the cut-off frequency of the {angle}: {percent:.1f} % lower error"
            f" (95 % interval of the gain {low:.1f} to {high:.1f} %)"
        )
    return out
