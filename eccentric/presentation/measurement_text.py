"""The measurement that would decide what a diagnosis left open, as a sentence."""

from __future__ import annotations

from eccentric.diagnosis import NextMeasurement
from eccentric.effects import measurement_between
from eccentric.model import AxisKind

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
_CORRECT = "Correct the rig file or the log first."
_HOLD_OTHERS = (
    "Accelerate and brake this joint at three rates with the others held, then move the others with this one"
    " held: that separates its own {inertia} from theirs."
)
_CONSTANT_FIRST = (
    "Declare {k_i} under [known] first, from the data sheet: until then, a load effect cannot be told from a"
    " wrong {k_i}."
)
_BOTH_DIRECTIONS = (
    "Log both directions first: friction changes its sign with the direction, cogging and loads do not."
)


def measurement_sentence(found: NextMeasurement | None, axis: AxisKind) -> str:
    """What to do, in a sentence or two; "" where nothing is open."""
    if found is None:
        return ""
    first = f"{axis.filled(_CONSTANT_FIRST)} " if found.constant_first else ""
    first += f"{_BOTH_DIRECTIONS} " if found.one_way else ""
    return first + _SENTENCES[found.code](found, axis)


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
        f"Log what separates {one} from {other}: other speeds, loads and directions than this log has."
    )


_SENTENCES = {
    "correct": lambda found, axis: _CORRECT,
    "vary": _vary,
    "separate": _separate,
    "hold_others": lambda found, axis: axis.filled(_HOLD_OTHERS),
}
