"""A diagnosis in words: one sentence that can be sent to a colleague, and a few lines for a terminal."""

from __future__ import annotations

import inspect
from collections.abc import Mapping

from eccentric.diagnosis.limits import PROVABLE
from eccentric.diagnosis.model_script import extended_name
from eccentric.diagnosis.outcome import Diagnosis
from eccentric.diagnosis.score import OverRuns
from eccentric.effects import Effect
from eccentric.emission import load_module
from eccentric.errors import few

__all__ = ["diagnosis_lines", "diagnosis_sentence"]

_GRAVE = {"wrong_sign", "wrong_unit", "contradiction", "another_rig", "mismatch", "zero_angle"}
_FOLLOWS = {"k_i": {"J", "M g L"}, "M": {"M g L"}}
"""What else a wrong declaration makes look wrong."""


def diagnosis_sentence(found: Diagnosis) -> str:
    """One sentence that can be sent to a colleague."""
    a = found.attribution
    score = found.score
    before, after = (score.rmse[score.balance][model] for model in ("paper", "extended"))
    falls = "falls" if score.interval[0] > 0.0 else "does not clearly fall:"
    gain = (
        f"the held-out error {falls} from {before:.4g} to {after:.4g} {found.unit}"
        f" ({score.percent:.1f} %, 95 % interval {score.interval[0]:.1f} to {score.interval[1]:.1f} %)"
    )
    if a.verdict == "named":
        names = " and ".join(_name(found, effect) for effect, _ in found.effects)
        sure = min(_probability(found, effect) for effect, _ in found.effects)
        these = "it" if len(found.effects) == 1 else "them"
        return (
            f"The model lacks {names} (probability {sure:.2f}); with {these} {gain}."
            f"{_alike(found)}{_first(found)}"
        )
    if a.verdict == "not_identifiable":
        families = " or ".join(a.tied or tuple(dict.fromkeys(c.family for c in a.candidates[:2])))
        return f"An effect is missing, but this log cannot tell {families} apart; with the first {gain}."
    if not found.models.fits_the_rig:
        return (
            f"This log does not fit the rig (R^2 of the drive torque {found.models.r_squared:.2f}): check"
            f" units and signs before anything else.{_first(found)}"
        )
    if a.unconfirmed:
        return (
            f"{' and '.join(a.unconfirmed)} fits the training part but does not predict what was held out; no"
            f" name is given. The structure depends on {', '.join(a.depends_on)}."
        )
    if a.verdict == "unexplained":
        return (
            f"Structure remains that depends on {', '.join(a.depends_on) or 'something unknown'},"
            " and no effect of the library explains it; no name is given."
        )
    if before > PROVABLE * found.noise_floor:
        return (
            f"Nothing further can be proved from this log: {before:.4g} {found.unit} are left, well above the"
            f" {found.noise_floor:.2g} {found.unit} of the sensors' noise, but no effect takes out more of"
            " them than chance would."
        )
    return (
        f"Nothing is missing: no effect takes out more of the residual ({before:.4g} {found.unit} held out;"
        f" noise of the sensors alone {found.noise_floor:.4g} {found.unit}) than chance would."
    )


def _name(found: Diagnosis, effect: Effect) -> str:
    """Its id; where it is a wrong declaration, which quantity of the rig should have which value."""
    if effect.corrects is None:
        return effect.id
    quantity, value = effect.corrects
    fitted = {q.symbol: found.models.extended.values[q.name] for q in effect.parameters}
    letters = {s.name: s for s in value.free_symbols - set(fitted)}
    if not set(letters) <= set(found.rig.known):
        return effect.id
    declared = {s: found.rig.known[name] for name, s in letters.items()}
    true, said = (float(value.subs(declared | x)) for x in (fitted, dict.fromkeys(fitted, 0)))
    return (
        f"the right value of {quantity.name} ({effect.id}: {true:.4g} {quantity.unit},"
        f" {said:.4g} in the rig file)"
    )


def _alike(found: Diagnosis) -> str:
    """What no log of this rig, as it is declared, tells from the named effects."""
    aliases = {effect.id: effect.evidence.aliases for effect, _ in found.effects}
    alike = {name: " or ".join(others) for name, others in aliases.items() if others}
    return "".join(
        f" As the rig is declared, {name} looks the same as {other}." for name, other in alike.items()
    )


def _first(found: Diagnosis) -> str:
    """What the record itself says is wrong, if anything that the named effects do not say."""
    told = {effect.corrects[0].name for effect, _ in found.effects if effect.corrects}
    told |= set().union(*(_FOLLOWS.get(name, set()) for name in told))
    warnings = [f for f in found.channels.findings if f.severity == "warning" and f.kind in _GRAVE]
    grave = [f for f in warnings if f.channel not in told]
    return f" {grave[0].text[0].upper()}{grave[0].text[1:]}." if grave else ""


def _probability(found: Diagnosis, effect: Effect) -> float:
    return max(
        (c.probability for c in found.attribution.candidates if c.family == effect.family), default=0.0
    )


def diagnosis_lines(found: Diagnosis) -> list[str]:
    """At most fourteen lines for a terminal."""
    a = found.attribution
    out = [
        f"{few(found.asked.logs)}: {found.models.base.name}, verdict {a.verdict}",
        diagnosis_sentence(found),
    ]
    out += [_effect(found, effect, own) for effect, own in found.effects[:3]]
    for balance, models in found.score.rmse.items():
        shown = {n: x for n, x in models.items() if n != "extended" or found.models.adopted}
        out.append(f"held-out RMSE, {balance} [{found.unit}]: {_errors(shown)}")
    if found.score.over_runs is not None:
        out += _over_runs(found.score.over_runs, found.unit)
    if a.verdict == "unexplained":
        if found.models.fits_the_rig:
            out.append(f"nearest, and not enough: {', '.join(c.id for c in a.candidates[:4])}")
    elif a.verdict != "nothing_missing":
        ranked = ", ".join(f"{c.id} {c.probability:.2f}" for c in a.candidates[:4])
        out.append(f"candidates: {ranked}")
    if found.orders:
        parts = ", ".join(f"{o.per_turn:.2f} ({100 * o.share:.0f} % of its variance)" for o in found.orders)
        out.append(f"what is left inside runs is periodic in the motor angle, per turn: {parts}")
    shipped, name = found.models.shipped, extended_name(found)
    module = load_module(shipped.model)
    arguments = list(inspect.signature(module.mechanical_friction_torque).parameters)[:-2]
    what = "to call" if shipped.effects else "nothing was added; to call the paper's model, fitted"
    out.append(f"{what}: {name}_mechanical_friction_torque({', '.join([*arguments, f'&{name}_default'])})")
    if a.next_measurement:
        out.append(f"next: {a.next_measurement}")
    return out


def _effect(found: Diagnosis, effect: Effect, own: Mapping[str, float]) -> str:
    shown = []
    for q in effect.parameters:
        estimate = found.models.extended.estimates.get(q.name)
        error = "" if estimate is None else f" +- {estimate.std_error:.2g}"
        shown.append(f"{q.name} = {own[q.name]:.4g}{error}{'' if q.unit == '1' else ' ' + q.unit}")
    share = 100 * found.models.extended.shares.get(effect.id, 0.0)
    return f"  {effect.id} ({share:.1f} % of friction): {', '.join(shown)}"


def _errors(models: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {value:.4g}" for name, value in models.items())


def _over_runs(over: OverRuns, unit: str) -> list[str]:
    out = [f"each of {over.runs} runs predicted from the others [{unit}]: {_errors(over.rmse)}"]
    for name, (percent, (low, high), better) in over.gains.items():
        if low == high:  # without a mass, the paper's model is the linear one
            continue
        than = {"paper": "linear", "extended": "paper"}[name]
        out.append(
            f"  {name} against {than}: {abs(percent):.1f} % {'less' if percent > 0 else 'more'} error"
            f" (95 % interval of the gain {low:.1f} to {high:.1f} %, {better} of {over.runs} runs better)"
        )
    return out
