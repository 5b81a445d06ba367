"""Sizes of planted effects come back from bench logs: the gap of a backlash, the knee of a torque."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import eccentric
from eccentric.virtual_bench import simulate
from tests.virtual import drawn_scenario

pytestmark = pytest.mark.slow


def test_a_gap_under_gravity_is_found_with_its_size() -> None:
    """The load changes its side where gravity outweighs the friction of the link, of both kinds."""
    effects = [("backlash", 0.2)]
    scenario = drawn_scenario(4, case="C2", mu=0.5, log_type="runs", effects=effects, noise=0.008)
    run, plant = simulate(scenario), scenario.plant
    found = eccentric.diagnose(run.columns, run.rig, only=["backlash", "presliding", "load_dependent"])
    (effect,) = found.document["effects"]
    values = {name: q["value"] for name, q in effect["parameters"].items()}

    assert ("named", "backlash") == (found.verdict, effect["id"])
    assert run.truth["effects"][0]["amplitude"] == pytest.approx(values["backlash_gap"], rel=0.1)
    # In the gap all of gravity and of the link's dry friction is gone.
    assert 1.0 == pytest.approx(values["backlash_G"], rel=0.1)
    assert plant.C_lN == pytest.approx(values["backlash_C"], rel=0.15)


def test_the_knee_and_the_curvature_are_the_planted_ones() -> None:
    """k_i/(1 + (i/i_s)^2) is the fitted form with c = 1/i_s^2; the current reaches 2 i_s."""
    amplitude = 0.12
    scenario = drawn_scenario(1, case="C2", mu=0.2, effects=["kt_saturation"], noise=0.004, seconds=40.0)
    planted = replace(scenario.effects[0], amplitude=amplitude)
    run = simulate(replace(scenario, effects=(planted,)), again=True)
    i_s = planted.shape[0] / amplitude**0.5
    assert i_s < 0.5 * np.max(np.abs(run.columns["current_A"]))

    (found,) = eccentric.diagnose(run.columns, run.rig).document["effects"]
    parameters = found["parameters"]

    assert "kt_saturation" == found["family"]
    assert parameters["ktsat_i"]["value"] == pytest.approx(i_s, rel=0.02)
    assert parameters["ktsat_c"]["value"] == pytest.approx(i_s**-2, rel=0.02)
