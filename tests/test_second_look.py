"""Effects that use the friction of a first fit are judged with the friction that was found beside them."""

from __future__ import annotations

import pytest

from eccentric.diagnosis import diagnose, loop
from eccentric.virtual_bench import simulate
from tests.virtual import drawn_scenario


@pytest.mark.slow
def test_a_load_is_that_of_the_friction_beside_the_effect(monkeypatch: pytest.MonkeyPatch) -> None:
    """Losses of a gear are named and sized as planted; with the friction of a first fit they are not."""
    scenario = drawn_scenario(
        97312,
        mu=1 / 30,
        log_type="traj",
        effects=[("load_dependent[transmitted]", 0.12)],
        noise=0.004,
        seconds=40.0,
    )
    run = simulate(scenario)
    said: list[str] = []
    found = diagnose([run.columns], run.rig, tell=said.append)
    (planted,) = run.truth["effects"]

    assert ["load_dependent[transmitted]"] == [a.variant.candidate.id for a in found.attribution.adopted]
    assert "named" == found.attribution.verdict
    assert planted["amplitude"] == pytest.approx(found.models.extended.values["load_eta"], rel=0.02)
    assert "the same with the friction that was found beside it" in said

    monkeypatch.setattr(loop, "_with_friction_of", lambda *_: None)
    once = diagnose([run.columns], run.rig)

    assert ["load_dependent[transmitted]"] != [a.variant.candidate.id for a in once.attribution.adopted]
