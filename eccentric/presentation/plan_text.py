"""A plan in words and as plan.json."""

from __future__ import annotations

from itertools import groupby
from typing import Any

import numpy as np

from eccentric.diagnosis import NextMeasurement
from eccentric.effects import measurement_between
from eccentric.model import AxisKind
from eccentric.planning import (
    DECIDES,
    HARDLY,
    RATE_HZ,
    SHOWN_AT_Z,
    WORTH_A_RUN,
    Bounds,
    DetectionPlan,
    MeasurementPlan,
)

# The measurement that would decide what a diagnosis left open, as a sentence.


_MEASUREMENTS = {
    "velocity": (
        "Hold eight or more constant speeds over the range of use, each for several {turns of the link}, in"
        " both directions."
    ),
    "direction": (
        "Run the same constant speeds forwards and backwards in turn, and repeat the first pair at the end."
    ),
    "link_angle": (
        "{Turn the link} slowly at one constant speed, over {five whole turns} in each direction; repeat at"
        " twice that speed."
    ),
    "motor_angle": (
        "Turn at one slow, constant speed with at least fifty rows per {motor turn}, in both directions;"
        " repeat at twice that speed."
    ),
    "gravity_load": "Repeat the log with half of the mass on the {link}, and with none.",
    "transmitted_torque": (
        "Accelerate and brake through the same speeds at three rates, then repeat with another mass on"
        " the {link}."
    ),
    "acceleration": (
        "{Leave J_m and J_l out} of the rig file: the log then identifies the {inertia} and"
        " shows what remains."
    ),
    "current": (
        "Hold one slow, constant speed with three different masses on the {link}: the current changes, the"
        " speed does not."
    ),
    "voltage": "Run the same constant speeds at two supply voltages, a fifth or more apart.",
    "temperature": (
        "Run the same speeds from a cold start until the motor is warm, and again while it cools, with"
        " its temperature logged."
    ),
    "time": (
        "Repeat the same motion immediately and again after an hour at rest, with the temperature logged if"
        " possible."
    ),
    "history": (
        "Start from rest after pauses of 1 s, 10 s and 100 s, and swing back and forth slowly over"
        " {a few degrees}."
    ),
}
"""Variable -> a measurement that a person can do; its terms are in braces."""
_HOLD_OTHERS = (
    "Accelerate and brake this joint at three rates with the others held, then move the others with this one"
    " held: that separates its own {inertia} from theirs."
)
_CONSTANT_FIRST = (
    "Declare {k_i} under [known] first, from the data sheet: until then, a load effect cannot be told from a"
    " wrong {k_i}."
)
_BOTH_DIRECTIONS = (
    "Log both directions first: friction changes sign with the direction, cogging and loads do not."
)


def measurement_sentence(found: NextMeasurement | None, axis: AxisKind) -> str:
    """What to do, in a sentence or two; "" where nothing is open."""
    if found is None:
        return ""
    first = f"{axis.filled(_CONSTANT_FIRST)} " if found.constant_first else ""
    first += f"{_BOTH_DIRECTIONS} " if found.one_way else ""
    return first + _SENTENCES[found.code](found, axis)


def _correct(found: NextMeasurement) -> str:
    lines = "; ".join(found.mends)
    return (
        f"Correct the rig file first: write {lines}." if lines else "Correct the rig file or the log first."
    )


def _vary(found: NextMeasurement, axis: AxisKind) -> str:
    if found.variable in _MEASUREMENTS:
        return axis.filled(_MEASUREMENTS[found.variable])
    name = axis.term(found.variable.replace("_", " "))
    return (
        f"Change the {name} alone, in five steps up and down, at the same constant speed in both directions."
    )


def _separate(found: NextMeasurement, axis: AxisKind) -> str:
    first, second = found.between
    one, other = (words.headline or family for family, words in (first, second))
    return axis.text(measurement_between(first, second)) or (
        f"Log what separates {one} from {other}: speeds, loads and directions that this log does not contain."
    )


_SENTENCES = {
    "correct": lambda found, axis: _correct(found),
    "vary": _vary,
    "separate": _separate,
    "hold_others": lambda found, axis: axis.filled(_HOLD_OTHERS),
}


def plan_lines(plan: MeasurementPlan) -> list[str]:
    """What a person reads."""
    first, *others = plan.rivals
    axis, term = plan.axis, plan.axis.term
    plain = "the friction of " + term("the paper's model")
    headlines = {r.family: r.headline or plain for r in plan.rivals}
    if others:
        said = ["Remaining candidates, with their probabilities:"]
        said += [f"  {r.family}: {headlines[r.family]} ({100 * r.chance:.0f} %)" for r in plan.rivals]
    else:
        said = [f"Nothing is left to decide; this motion narrows the intervals of {headlines[first.family]}"]
    if plan.elsewhere:
        balance = "mechanical" if first.balance == "electrical" else "electrical"
        said.append(f"Not covered: {', '.join(plan.elsewhere)}, which shows in the {balance} balance.")
    if plan.follows:
        said.append(
            f"The residual depends on {', '.join(map(axis.named, plan.follows))}, and no effect explains it."
        )
        said += (
            [f"What would show it: {measurement_sentence(plan.otherwise, plan.axis)}"]
            if plan.otherwise
            else []
        )
    if plan.probability is not None:
        closest = min(plan.apart, key=lambda pair: plan.apart[pair])
        said.append(
            f"This motion has a {100 * plan.probability:.0f} % chance of settling it;"
            f" hardest to separate: {closest[0]} and {closest[1]} (deviance {plan.apart[closest]:.3g})."
        )
        if plan.probability < WORTH_A_RUN:
            said.append("No motion within the limits is likely to settle it; this is the best one.")
        said += [
            f"{one} and {other} predict the same {term('torque')} on log and motion, whichever is true:"
            " for a drive within these limits, a model with either will do."
            for one, other in plan.same
        ]
        if (more := plan.heavier) is not None:
            kg = f"{more.added_kg:.2g} kg more on the link"
            said.append(
                f"With {kg}, this motion would have a {100 * more.probability:.0f} % chance of settling it:"
                f' plan it with --added "{more.added_kg:.2g} kg".'
                if more.probability > plan.probability
                else f"{kg} would not settle it either."
            )
        if plan.probability < DECIDES and plan.otherwise:
            said.append(f"To settle it: {measurement_sentence(plan.otherwise, plan.axis)}")
    else:
        for name, part in plan.narrower.items():
            falls = (
                f"falls to {100 * part:.0f} % of its value from the log"
                if part < HARDLY
                else "hardly changes"
            )
            meaning = axis.text(plan.meanings.get(name, ""))
            said.append(f"  {axis.named(name)}{f' ({meaning})' if meaning else ''}: standard error {falls}")
        if min(plan.narrower.values(), default=0.0) > HARDLY:
            said.append("Hardly any motion within these limits adds to this log: widen them.")
    moved, bounds = plan.motion, plan.bounds
    if plan.added:
        said.append(
            f"All of this is for {plan.added:g} kg more on the link: name the run under [added] in the rig"
            f' file (RUN = "{plan.added:g} kg"), and diagnose both logs.'
        )
    said.append(
        f"Motion of {moved.seconds:.1f} s at {RATE_HZ:g} Hz, from rest at {moved.theta[0]:.4g}"
        f" {axis.unit('rad')}:"
    )
    said += [f"  {len(tuple(same))} x {words}" for words, same in groupby(plan.parts)]
    said.append(f"Largest values and limits{term(' (motor side)')}:")
    for word, values, limit, unit in (
        ("speed", moved.omega, bounds.speed, axis.unit("rad/s")),
        ("acceleration", moved.alpha, bounds.acceleration, axis.unit("rad/s^2")),
        ("force" if bounds.by_force else "current", plan.current, bounds.current, plan.strength[1]),
    ):
        said.append(f"  {word} {np.max(np.abs(values)):.4g} of {limit:.4g} {unit}")
    if bounds.angle is not None:
        low, high = np.min(moved.theta), np.max(moved.theta)
        ends = f"{bounds.angle[0]:.4g} to {bounds.angle[1]:.4g} {axis.unit('rad')}"
        said.append(f"  {term('angle')} {low:.4g} to {high:.4g} of {ends}")
    return said


def plan_document(plan: MeasurementPlan) -> dict[str, Any]:
    """The content of plan.json, format eccentric-plan/1."""
    moved, bounds, current = plan.motion, plan.bounds, "_".join(plan.strength)
    document = {
        "format": "eccentric-plan/1",
        "rivals": [
            {
                "family": r.family,
                "id": r.variants[-1].candidate.id if r.variants else "",
                "balance": r.balance,
                "probability": r.chance,
            }
            for r in plan.rivals
        ],
        "probability": plan.probability,
        "deviance": [
            {"true": truth, "other": other, "expected": value} for (truth, other), value in plan.apart.items()
        ],
        "same_torque": [list(pair) for pair in plan.same],
        "relative_std_error": plan.narrower,
        "added_kg": plan.added,
        "heavier": None if plan.heavier is None else vars(plan.heavier),
        "otherwise": measurement_sentence(plan.otherwise, plan.axis),
        "residual_depends_on": [plan.axis.named(name) for name in plan.follows],
        "elsewhere": list(plan.elsewhere),
        "parts": list(plan.parts),
        "seconds": moved.seconds,
        "rate_Hz": RATE_HZ,
        "limits": _limits(bounds, current) | {"speed_loop_Hz": bounds.loop_hz},
        "largest": {
            "speed_rad_s": float(np.max(np.abs(moved.omega))),
            "acceleration_rad_s2": float(np.max(np.abs(moved.alpha))),
            current: float(np.max(np.abs(plan.current))),
            "angle_rad": [float(np.min(moved.theta)), float(np.max(moved.theta))],
        },
    }
    return plan.axis.keyed(document)


def _limits(bounds: Bounds, current: str) -> dict[str, Any]:
    """The limits of a motion; `current` is the key of that of the drive."""
    return {
        "speed_rad_s": bounds.speed,
        "acceleration_rad_s2": bounds.acceleration,
        current: bounds.current,
        "time_s": bounds.time,
        "angle_rad": None if bounds.angle is None else list(bounds.angle),
    }


def detection_lines(plan: DetectionPlan) -> list[str]:
    """What a person reads of a plan without a log."""
    bounds, own = plan.bounds, "assumed, 1 % of the torque at the limit" if plan.assumed else "as given"
    head = f"{plan.model}, {bounds.speed:.4g} rad/s, {bounds.time:.4g} s, {plan.mass:.4g} kg; noise of an"
    said = [f"{head} independent sample {plan.noise:.3g} N m ({own}):"]
    said += [f"  {name} = {one.value:g} {one.unit}: z = {one.z:.3g}" for name, one in plan.sought.items()]
    needs = (
        ("time", plan.time_s, "s"),
        ("speed", plan.speed_rad_s, "rad/s"),
        ("unbalanced mass", plan.mass_kg, "kg"),
    )
    said.append(f"Enough for z = {SHOWN_AT_Z:g}, changing one at a time:")
    said += [
        f"  {name} " + ("alone does not help" if need is None else f"{need:.3g} {unit}")
        for name, need, unit in needs
    ]
    current = "" if plan.current is None else f", {plan.current:.3g} of {bounds.current:.3g} A"
    said.append(f"Motion: {plan.motion}; with these values it needs {plan.torque:.3g} N m{current}.")
    said.append("Only white noise is counted: let the drive warm up first, and alternate the directions.")
    return said


def detection_document(plan: DetectionPlan) -> dict[str, Any]:
    """The content of plan.json of a plan without a log, format eccentric-detection/1."""
    return {
        "format": "eccentric-detection/1",
        "model": plan.model,
        "for": {name: vars(one) for name, one in plan.sought.items()},
        "required_z": SHOWN_AT_Z,
        "noise_Nm": plan.noise,
        "noise_assumed": plan.assumed,
        "limits": _limits(plan.bounds, "current_A"),
        "M_kg": plan.mass,
        "enough": {"time_s": plan.time_s, "speed_rad_s": plan.speed_rad_s, "M_kg": plan.mass_kg},
        "motion": plan.motion,
        "largest": {"torque_Nm": plan.torque, "current_A": plan.current},
    }
