"""`rig --check` of a linear axis names a mass, a gain or a unit that is off by a thousand, with its mend."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest

import eccentric
from tests.carriage import RIG, logged

GAIN = 35.0
"""Of the amplifier that made the log [N/V]."""
MASS, POSITION = {"mass_kg": 95.0}, {"column": "q_m", "unit": "m"}
FORCE = {"column": "u_V", "gain": "35 N/V"}


@functools.cache
def log() -> dict[str, Any]:
    """A log of 12 s, position in m, reference of the amplifier in V, and what follows from them."""
    found = logged(3, seconds=12.0, runs=1)
    return {**found, "q_mm": 1e3 * found["q_m"], "f_N": GAIN * found["u_V"]}


def complaints(known: dict[str, Any], **columns: Any) -> str:
    """What the check says of the slide's log under these columns."""
    named = {"time": "t_s", "run": "run", "position": POSITION, "force": FORCE, **columns}
    named = {name: column for name, column in named.items() if column is not None}
    rig = {**RIG, "known": known, "columns": named}
    return "\n".join(eccentric.check_rig(log(), rig).complaints)


AMPERES = {"mass_kg": 95.0, "k_f_N_per_A": 35.0}


def current(unit: str) -> dict[str, Any]:
    """A column of amperes under a unit, in place of the force."""
    return {"force": None, "current": {"column": "u_V", "unit": unit}}


@pytest.mark.parametrize(
    ("known", "columns", "mend"),
    [
        ({"mass": "95 g"}, {}, 'mass = "9'),
        ({"mass": "95000 kg"}, {}, 'mass = "9'),
        (MASS, {"force": {**FORCE, "gain": "35000 N/V"}}, 'force = { column = "u_V", gain = "35 N/V" }'),
        (MASS, {"force": {**FORCE, "gain": "0.035 N/V"}}, 'force = { column = "u_V", gain = "35 N/V" }'),
        (
            MASS,
            {"force": {"column": "1000*u_V", "unit": "mV", "gain": "35000 N/V"}},
            'force = { column = "1000*u_V", unit = "mV", gain = "35 N/V" }',
        ),
        (MASS, {"force": {"column": "f_N", "unit": "mN"}}, 'force = { column = "f_N", unit = "N" }'),
        (MASS, {"position": {"column": "q_mm", "unit": "m"}}, 'position = { column = "q_mm", unit = "mm" }'),
        (MASS, {"position": {"column": "q_m", "unit": "mm"}}, 'position = { column = "q_m", unit = "m" }'),
        (AMPERES, current("mA"), 'current = { column = "u_V", unit = "A" }'),
        ({**AMPERES, "k_f_N_per_A": 0.035}, current("A"), 'k_f = "35 N/A"'),
    ],
    ids=str,
)
def test_a_factor_of_a_thousand_is_named_with_its_mend(
    known: dict[str, Any], columns: dict[str, Any], mend: str
) -> None:
    """One complaint has a line for each that may be wrong: a log cannot tell them apart."""
    found = complaints(known, **columns)

    assert found.count("\n") == 0
    assert found.startswith("rig: mass is ")
    assert mend in found
    assert not any(word in found for word in ("theta", "angle", "torque", "N m", "kg m^2", "k_i", "mNm"))


@pytest.mark.parametrize(("known", "columns"), [(MASS, {}), (AMPERES, current("A"))], ids=str)
def test_the_right_rig_has_no_complaint(known: dict[str, Any], columns: dict[str, Any]) -> None:
    """The mass that made the log, under the units that it has."""
    assert complaints(known, **columns) == ""


@pytest.mark.parametrize("force", ["u_V", {"column": "u_V", "unit": "V"}], ids=str)
def test_a_reference_in_volts_asks_for_its_gain(force: str | dict[str, str]) -> None:
    """With no unit, or its own: one complaint, which shows how the gain is written."""
    found = complaints({}, force=force)

    assert found.count("\n") == 0
    assert found.startswith("rig: [columns] force:")
    assert 'gain = "35 N/V"' in found


def test_a_voltage_tells_the_position_from_the_mass() -> None:
    """With R and k_e known and a current logged, one cause explains all: the position, and nothing else."""
    speed = np.gradient(log()["q_m"], log()["t_s"])
    volts = 2.0 * log()["u_V"] + 30.0 * speed
    table = {**log(), "v_V": volts}
    known = {**AMPERES, "R_ohm": 2.0, "k_e_Vs_per_m": 30.0}
    named = {
        "time": "t_s",
        "run": "run",
        "position": {"column": "q_mm", "unit": "m"},
        "current": {"column": "u_V", "unit": "A"},
        "voltage": {"column": "v_V", "unit": "V"},
    }
    (found,) = eccentric.check_rig(table, {**RIG, "known": known, "columns": named}).complaints

    assert "the position is in mm, not m" in found
    assert found.endswith('write position = { column = "q_mm", unit = "mm" }')
