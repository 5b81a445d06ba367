"""Angles that restart at every turn are unwrapped; a speed that is not the slope of its angle is reported."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from eccentric.signals.motion import speed_doubt, unwrapped

Array = NDArray[np.float64]

TURN = 2.0 * math.pi
T = np.arange(0.0, 20.0, 0.004)
ANGLE = 60.0 * np.sin(0.7 * T + 0.2) + 8.0 * np.sin(1.9 * T)
SPEED = 42.0 * np.cos(0.7 * T + 0.2) + 15.2 * np.cos(1.9 * T)
ONE = np.zeros(len(T), dtype=np.int64)
MU = 0.2


def wrapped(angle: Array, low: float, period: float) -> Array:
    """Bring an angle into [low, low + period)."""
    return np.mod(angle - low, period) + low


@pytest.mark.parametrize("mu", [MU, 1.0, None])
@pytest.mark.parametrize("low", [0.0, -math.pi])
def test_an_angle_wrapped_at_a_turn_of_the_motor_comes_back(low: float, mu: float | None) -> None:
    """Unwrapped, the angle is the one before up to whole turns, and the warning counts the wraps."""
    logged = wrapped(ANGLE, low, TURN)
    found, said = unwrapped(T, logged, ONE, ONE, mu)
    np.testing.assert_allclose(found - found[0], ANGLE - ANGLE[0], atol=1e-9)
    wraps = int(np.count_nonzero(np.abs(np.diff(logged)) > math.pi))
    assert said.startswith(f"the angle is wrapped at one turn of the motor, {wraps} times: it is unwrapped")
    assert ("theta_zero_rad" in said) == (mu == MU)


@pytest.mark.parametrize("mu", [MU, 0.9, 3.0])
def test_an_angle_wrapped_at_a_turn_of_the_link_comes_back(mu: float) -> None:
    """2 pi at the link are 2 pi/mu at the motor, also where those are nearly the same."""
    found, said = unwrapped(T, wrapped(ANGLE, 0.0, TURN / mu), ONE, ONE, mu)
    np.testing.assert_allclose(found - found[0], ANGLE - ANGLE[0], atol=1e-9)
    assert "one turn of the link" in said


def test_an_angle_that_rests_at_the_seam_comes_back() -> None:
    """Noise that throws a resting angle from one end to the other and back is no motion."""
    angle = np.concatenate([ANGLE[:2000], np.full(3000, ANGLE[1999])])
    angle += 0.01 * np.random.default_rng(1).standard_normal(len(T))
    found, _ = unwrapped(T, wrapped(angle, ANGLE[1999], TURN), ONE, ONE, MU)
    np.testing.assert_allclose(found - found[0], angle - angle[0], atol=1e-9)


def test_over_a_gap_the_angle_goes_on_and_a_run_begins_anew() -> None:
    """Missing rows are bridged at the speed around them; a run starts with the turn that it was logged in."""
    kept = (T < 5.0) | (T > 5.2)
    logged = wrapped(ANGLE, 0.0, TURN)
    segment = np.where(T > 5.1, 1, 0)
    found, _ = unwrapped(T[kept], logged[kept], segment[kept], ONE[kept], MU)
    np.testing.assert_allclose(found - found[0], (ANGLE - ANGLE[0])[kept], atol=1e-9)
    found, _ = unwrapped(T[kept], logged[kept], segment[kept], segment[kept], MU)
    second = segment[kept] == 1
    assert found[second][0] == logged[kept][second][0]
    np.testing.assert_allclose(np.diff(found[second]), np.diff(ANGLE[kept][second]), atol=1e-9)


@pytest.mark.parametrize(
    "angle",
    [ANGLE, ANGLE + np.where(T > 7.0, 1.0, 0.0), 40.0 * ANGLE, 0.02 * ANGLE, np.zeros_like(T)],
    ids=["plain", "a slip of 1 rad", "up to 2 turns from row to row", "less than a turn", "still"],
)
def test_an_angle_without_wraps_is_left_alone(angle: Array) -> None:
    """Steps that fill the range up to a turn and beyond are motion, however fast."""
    found, said = unwrapped(T, angle, ONE, ONE, MU)
    np.testing.assert_array_equal(found, angle)
    assert said == ""


def test_a_wrap_that_is_sampled_too_slowly_is_uncertain() -> None:
    """At 0.4 turns from row to row the angle still comes back, and the warning says that it may not."""
    slow = slice(0, None, 12)
    found, said = unwrapped(T[slow], wrapped(ANGLE, 0.0, TURN)[slow], ONE[slow], ONE[slow], MU)
    np.testing.assert_allclose(found - found[0], (ANGLE - ANGLE[0])[slow], atol=1e-9)
    assert "uncertain at up to 0.4" in said


def test_jumps_of_360_are_degrees() -> None:
    """An angle in degrees that is taken for radians jumps by 360: it stays, and the unit is questioned."""
    degrees = np.degrees(wrapped(ANGLE, 0.0, TURN))
    found, said = unwrapped(T, degrees, ONE, ONE, MU)
    np.testing.assert_array_equal(found, degrees)
    assert said.endswith("is it in deg?")


@pytest.mark.parametrize("factor", [1.0, 0.93, 1.08])
def test_a_speed_that_is_the_slope_is_no_doubt(factor: float) -> None:
    """Encoder steps, noise, 10 ms of filter and a few per cent of scale are in order."""
    rng = np.random.default_rng(2)
    coarse = np.round(ANGLE / 0.05) * 0.05
    late = factor * np.interp(T - 0.01, T, SPEED) + rng.standard_normal(len(T))
    assert speed_doubt(T, coarse, late, ONE, MU) == ("", False)


CAUSES = {
    "rpm": (60.0 / TURN, "9.549 times the slope of the angle: the speed is in rpm?"),
    "deg/s": (
        360.0 / TURN,
        "57.3 times the slope of the angle: the speed is in deg/s, or the angle is in rad?",
    ),
    "rev/s": (
        1.0 / TURN,
        "0.1592 times the slope of the angle: the speed is in rev/s, or the angle is in rad?",
    ),
    "angle in degrees": (TURN / 360.0, "0.01745 times the slope of the angle: the angle is in deg?"),
    "milliseconds": (1000.0, "1000 times the slope of the angle: the time is in ms?"),
    "link": (MU, "0.2 times the slope of the angle: they are on opposite sides of the gear?"),
    "motor": (1.0 / MU, "5 times the slope of the angle: they are on opposite sides of the gear?"),
    "sign": (-1.0, "-1 times the slope of the angle: their signs differ?"),
    "rpm, sign": (-60.0 / TURN, "-9.549 times .*: the speed is in rpm and their signs differ?"),
    "no cause": (0.7, "0.7 times the slope of the angle"),
}


@pytest.mark.parametrize("name", CAUSES)
def test_the_factor_names_the_cause(name: str) -> None:
    """A speed in another unit, of the other side of the gear or of the other sign is named as such."""
    factor, expected = CAUSES[name]
    said, _ = speed_doubt(T, ANGLE, factor * SPEED, ONE, MU)
    parts = expected.split(".*")
    assert said.startswith(f"the logged speed is {parts[0]}")
    assert said.endswith(parts[-1])


def test_a_speed_of_something_else_is_told() -> None:
    """A speed that does not correlate with the slope of the angle is of another shaft, or of other rows."""
    said, _ = speed_doubt(T, ANGLE, 40.0 * np.sin(2.3 * T), ONE, MU)
    assert said.startswith("the logged speed does not follow the slope of the angle (correlation ")


@pytest.mark.parametrize("still", [0.0 * T, 0.0 * T[:3]], ids=["still", "short"])
def test_where_nothing_moves_there_is_nothing_to_compare(still: Array) -> None:
    """At standstill, and in stretches of a few rows, nothing is said."""
    assert speed_doubt(T[: len(still)], still, still + 1.0, ONE[: len(still)], MU) == ("", False)
