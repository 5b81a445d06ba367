"""The measured arms: what is known of them, nothing invented. Their logs are read by path, never copied."""

from __future__ import annotations

import functools
from pathlib import Path

import pytest

from eccentric.joints import ArmFit, fit_arm
from eccentric.model import Load
from eccentric.rigs import read_arm_rig

ROOT = Path(__file__).resolve().parents[1]
MEASURED = ROOT.parent / "shared" / "data" / "measured"
pytestmark = pytest.mark.skipif(not MEASURED.exists(), reason="the measured logs are not beside this clone")


@functools.cache
def fitted(rig: str, folder: str) -> ArmFit:
    """The fit of a measured log under its example rig."""
    log = MEASURED / folder / "data.csv.gz"
    if not log.exists():
        pytest.skip(f"{folder}: this log is not beside this clone")
    return fit_arm([log], read_arm_rig(ROOT / "examples" / "rigs" / f"{rig}.toml"), [folder])


@pytest.mark.slow
def test_friction_of_the_loaded_joints_follows_what_the_gear_passes_on() -> None:
    """UR10e: shoulder and elbow, by a third at least; the base without gravity and the wrist are controls."""
    found = fitted("ur10e_arm", "ur10e_arm")

    assert [(), (Load.TRANSMITTED,), (Load.TRANSMITTED,), (), (), ()] == [
        joint.loads.followed for joint in found.joints
    ]
    assert all(joint.interval[0] > 20.0 for joint in found.joints[1:3])
    assert {"A"} == {joint.unit for joint in found.joints}


@pytest.mark.parametrize("design", ["a", "c"])
def test_nothing_is_claimed_of_the_double_pendulum(design: str) -> None:
    """No load in either joint; the body of the forearm is that of its authors, 0.60 and 0.63 kg."""
    found = fitted(f"dfki_double_pendulum_{design}", "dfki_double_pendulum")

    assert [(), ()] == [joint.loads.followed for joint in found.joints]
    assert found.bodies is not None
    low, high = found.bodies.estimates["h_1_y"].interval
    expected = {"a": -0.60 * 0.184, "c": -0.63 * 0.256}[design]
    assert low * 1.15 < expected < high
