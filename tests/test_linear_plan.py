"""The plan of a linear axis: limits and reference in its own units."""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import eccentric
from eccentric import InputError
from eccentric.model import LINEAR
from eccentric.planning import outcome, read_bounds
from tests.carriage import RIG, logged

LIMITS = {
    "speed_m_s": "400 mm/s",
    "acceleration_m_s2": 3.0,
    "force_N": "0.5 kN",
    "time_s": 10,
    "position_m": ["0 mm", "300 mm"],
}


def test_limits_are_read_in_units_of_length_and_force() -> None:
    """Speeds in mm/s, a force in kN and positions in mm become SI units."""
    found = read_bounds(LIMITS, LINEAR)

    assert (found.speed, found.acceleration, found.current) == (0.4, 3.0, 500.0)
    assert (found.time, found.angle, found.by_force) == (10.0, (0.0, 0.3), True)


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        (
            {**LIMITS, "speed_m_s": "10 rpm"},
            "speed_m_s: expected a unit like m/s, mm/s, m/min, km/h, mph, got 'rpm'",
        ),
        ({**LIMITS, "speed_rad_s": 3}, "unknown key 'speed_rad_s'"),
        ({**LIMITS, "current_A": 3}, "expected only one of current_A and force_N, got both"),
        ({k: x for k, x in LIMITS.items() if k != "force_N"}, "expected current_A or force_N"),
        ({**LIMITS, "position_m": [1, 0]}, "position_m: expected lower before upper"),
    ],
    ids=lambda x: x[:30] if isinstance(x, str) else "",
)
def test_limits_of_another_kind_are_refused(limits: dict[str, object], message: str) -> None:
    """Each message has the key as it is written."""
    with pytest.raises(InputError, match=message):
        read_bounds(limits, LINEAR)


def test_a_force_that_is_too_small_is_told_in_newtons() -> None:
    """It is named by its key, in its unit: no ampere where none was given. Dry friction and load are 23 N."""
    message = r"limits: force_N: expected enough for load and friction .*, ([\d.]+) N with .*, got 2 N$"
    with pytest.raises(InputError, match=message) as refused:
        eccentric.plan(logged(2, seconds=6.0, runs=1), RIG, {**LIMITS, "force_N": 2})
    said = str(refused.value)
    found = re.search(message, said)

    assert found is not None
    assert 23.0 < float(found[1]) < 69.0
    assert not re.search(r"\bA\b|current", said)


def test_limits_without_room_are_told_in_newtons() -> None:
    """Where no drive can be computed at all, each limit is named in its unit."""
    channels = SimpleNamespace(rig=SimpleNamespace(axis=LINEAR))
    question = SimpleNamespace(data=SimpleNamespace(drive=SimpleNamespace(channels=channels)))
    nothing: Any = SimpleNamespace(ground=lambda _: SimpleNamespace(met=None), question=question)
    error = outcome._too_tight(nothing, read_bounds(LIMITS, LINEAR))

    assert (error.place, error.got) == ("limits", "0.4 m/s, 3 m/s^2, 500 N, 0 to 0.3 m")
    assert error.expected == "speed, acceleration, force and position that leave room for one motion"


@pytest.mark.slow
def test_the_plan_is_a_motion_of_the_carriage() -> None:
    """The reference keeps within its limits, in metres; the force that it needs is the plant's own."""
    plan = eccentric.plan(logged(2, seconds=6.0, runs=1), RIG, LIMITS)
    x, v, a = (plan.reference[name] for name in ("position_m", "velocity_m_s", "acceleration_m_s2"))
    force = 95.0 * a + 203.0 * v + 20.0 * np.sign(v) - 3.0

    assert (x.min() >= 0.0, x.max() <= 0.3) == (True, True)
    assert (np.abs(v).max() <= 0.4, np.abs(a).max() <= 3.0) == (True, True)
    np.testing.assert_allclose(plan.plan.current[np.abs(v) > 0.01], force[np.abs(v) > 0.01], atol=1.0)
    assert not any(word in plan.summary() + plan.to_json() for word in (" rad", "_rad", "N m", "motor"))


def test_a_limit_of_the_current_needs_amperes() -> None:
    """A voltage without R and k_f says nothing of the current: no plan compares it with a limit."""
    log = logged(2, seconds=6.0, runs=1)
    columns = {name: column for name, column in RIG["columns"].items() if name != "force"}
    rig = RIG | {"columns": {**columns, "voltage": "u_V"}}
    limits = {**{key: x for key, x in LIMITS.items() if key != "force_N"}, "current_A": 20.0}
    message = r"rig: expected \[known\] R and k_f, got none: a voltage alone gives no current"
    with pytest.raises(InputError, match=message):
        eccentric.plan(log, rig, limits)
    with pytest.raises(InputError, match=r"expected \[known\] R, got none: a voltage alone"):
        eccentric.plan(log, {**rig, "known": {"k_f_N_per_A": 35.0}}, limits)
