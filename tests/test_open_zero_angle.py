"""Current offsets with an open zero angle: the friction under F_N moves with the zero."""

from __future__ import annotations

import pytest

from eccentric.diagnosis import diagnose
from eccentric.logs import read_log
from eccentric.virtual_bench import simulate
from tests.virtual import drawn_scenario


@pytest.mark.slow
def test_an_open_zero_angle_invents_no_effect_beside_a_current_offset() -> None:
    """The first fit takes the offset for a turn of the gravity torque; what was found says better.

    At the zero of the first fit, friction at the wrong angle is called unexplained.
    """
    effects = [("current_bias", 0.3)]
    scenario = drawn_scenario(5, case="C2", mu=0.2, log_type="runs", effects=effects, noise=0.004)
    run = simulate(scenario)
    moved = run.columns["theta_m_rad"] + 0.2 / scenario.plant.mu
    rig = {**run.rig, "theta_zero_rad": "estimate"}

    found = diagnose([read_log({**run.columns, "theta_m_rad": moved})], rig)

    assert ["current_bias"] == [effect.id for effect, _ in found.effects]
    assert 0.2 == pytest.approx(found.models.extended.estimates["theta_zero_rad"].value, abs=0.002)
