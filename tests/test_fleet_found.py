"""What a fleet says of a joint: when an earlier diagnosis still counts."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from eccentric.api import fleet as api
from eccentric.fleet import Suspect
from eccentric.fleet.changed import Changed
from eccentric.rigs import Rig
from tests.fleets import one_joint, rig_of


def _suspect(rig: Rig) -> Suspect:
    """A joint whose change no coefficient explains, without logs."""
    return Suspect("J", rig, (), Changed((), (), 0.1, 0.05, 0.02, 0.05, 0.2, 0.5), None, None)


@pytest.mark.parametrize(
    "entry",
    [
        {"theta_zero_rad": 0.7},
        {"voltage_offset_V": 1.0},
        {"holdout_intervals_s": [[1.0, 2.0]]},
        {"low_pass_hz": 10.0},
        {"known": {"M_kg": 9.0}},
    ],
    ids=lambda entry: next(iter(entry)),
)
def test_a_diagnosis_counts_for_its_own_rig_only(entry: dict[str, Any]) -> None:
    """Whatever is said of the rig in another way, a joint is diagnosed again; a new name changes nothing."""
    _, joint = one_joint()
    rig = rig_of(joint)

    assert api._digest(_suspect(rig_of(joint, **entry))) != api._digest(_suspect(rig))
    assert api._digest(_suspect(replace(rig, path="elsewhere", name="K"))) == api._digest(_suspect(rig))
