"""Backlash on bench logs: the gap, and the friction of the link that decides where it opens."""

from __future__ import annotations

import pytest

import eccentric
from eccentric.virtual_bench import simulate
from tests.virtual import drawn_scenario


@pytest.mark.slow
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
