"""What to measure where structure remains that no effect explains: one sentence for each variable."""

from __future__ import annotations

from types import MappingProxyType

__all__ = ["measurement_of"]

_MEASUREMENTS = MappingProxyType(
    {
        "velocity": (
            "Hold eight or more constant speeds over the range of use, each for several turns of the link, in"
            " both directions."
        ),
        "direction": (
            "Run the same constant speeds forwards and backwards in turn, the first pair again at the end."
        ),
        "link_angle": (
            "Turn the link slowly at one constant speed, over five whole turns in each direction; repeat at"
            " twice that speed."
        ),
        "motor_angle": (
            "Turn at one slow, constant speed with at least fifty rows per motor turn, in both directions;"
            " repeat at twice that speed."
        ),
        "gravity_load": "Repeat the log with half of the mass on the link, and with none.",
        "transmitted_torque": (
            "Accelerate and brake through the same speeds at three rates, then repeat with another mass on"
            " the link."
        ),
        "acceleration": (
            "Leave J_m and J_l out of the rig file: the log then identifies the inertia and shows what else"
            " is left."
        ),
        "current": (
            "Hold one slow, constant speed with three different masses on the link: the current changes, the"
            " speed does not."
        ),
        "voltage": "Run the same constant speeds at two supply voltages, a fifth or more apart.",
        "temperature": (
            "Run the same speeds from a cold start until the motor is warm, and again while it cools, with"
            " its temperature logged."
        ),
        "time": (
            "Run the same course at once and again after an hour at rest, with the temperature logged if"
            " possible."
        ),
        "history": (
            "Start from rest after pauses of 1 s, 10 s and 100 s, and swing back and forth slowly over a few"
            " degrees."
        ),
    }
)
"""Variable -> a measurement that a person can do."""


def measurement_of(variable: str) -> str:
    """What to measure where the residual follows a variable; a user's own effect may name any."""
    name = variable.replace("_", " ")
    own = (
        f"Change the {name} alone, in five steps up and down, at the same constant speed in both directions."
    )
    return _MEASUREMENTS.get(variable, own)
