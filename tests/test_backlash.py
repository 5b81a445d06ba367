"""Backlash on bench logs: the gap, and the friction of the link that decides where it opens."""

from __future__ import annotations

import numpy as np
import pytest

import eccentric
from eccentric.virtual_bench import simulate
from tests.virtual import drawn_scenario


def test_a_gap_under_gravity_is_found_with_its_size() -> None:
    """The load changes its side where gravity outweighs the friction of the link, of both kinds."""
    effects = [("backlash", 0.2)]
    scenario = drawn_scenario(4, case="C2", mu=0.5, log_type="runs", effects=effects, noise=0.008)
    run, plant = simulate(scenario), scenario.plant
    found = eccentric.diagnose(run.columns, run.rig)
    (effect,) = found.document["effects"]
    parameters = effect["parameters"]
    top = plant.mu * float(np.quantile(np.abs(run.columns["omega_m_rad_s"]), 0.99))

    assert ("named", "backlash") == (found.verdict, effect["id"])
    # A log shows when the gap opens and closes to a row, in which the motor turns by a few hundredths.
    assert run.truth["effects"][0]["amplitude"] == pytest.approx(
        parameters["backlash_gap"]["value"], rel=0.05
    )
    for name, true in (("backlash_arm", plant.C_lN), ("backlash_rise", plant.B_lN * top / plant.C_lN)):
        low, high = parameters[name]["interval_95"]
        assert low < true < high
        assert high - low < 0.2 * true
