"""Of several joints a draft has one: that which moves, with its own drive; and ripple is no gravity."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

import eccentric
from tests.test_draft_names import STEP, bare, channels


@pytest.mark.parametrize(
    ("pattern", "keys"),
    [
        ("{what}_{key}", ("1", "2", "3")),
        ("{what}(:,{key})", ("4", "5", "6")),
        ("/joint_states/{key}/{what}", ("shoulder_pan_joint", "elbow_joint")),
        ("{key}_{what}", ("left", "right")),
    ],
)
def test_all_channels_are_of_the_joint_that_moves(pattern: str, keys: tuple[str, ...]) -> None:
    """The others jitter, and one of them has a torque that goes with the motion better than its own."""
    b = bare()
    rng = np.random.default_rng(2)
    log = {"t_s": b["time"]}
    for key in keys:
        moves = key == keys[1]
        noise = rng.normal(0.0, 1e-3, len(b["time"]))
        log[pattern.format(what="position", key=key)] = b["angle"] if moves else noise
        log[pattern.format(what="velocity", key=key)] = b["speed"] if moves else np.gradient(noise, STEP)
        log[pattern.format(what="torque", key=key)] = b["torque"] + 30.0 * noise if moves else b["torque"]
    draft = eccentric.draft_rig(log)
    found = channels(draft)

    assert {v for k, v in found.items() if k != "time"} == {
        pattern.format(what=what, key=keys[1]) for what in ("position", "velocity", "torque")
    }
    assert not any("move" in doubt for doubt in draft.doubts)


def test_where_two_joints_move_a_draft_asks() -> None:
    """Either could be meant; the arm has a rig of its own."""
    b = bare()
    log = {"t_s": b["time"]}
    for key, phase in (("1", 0), ("2", 700)):
        log |= {f"q_{key}": np.roll(b["angle"], phase), f"tau_{key}": np.roll(b["torque"], phase)}

    assert any("--arm reads all joints" in doubt for doubt in eccentric.draft_rig(log).doubts)


def test_a_drive_of_no_joint_goes_to_the_joint_that_explains_it() -> None:
    """A driven arm and a free pendulum: the command has no number."""
    b = bare()
    log = {
        "t_s": b["time"],
        "/joint_states/joint0/position": b["angle"],
        "/joint_states/joint1/position": 5.0 * np.sin(2.7 * b["time"] + 0.4) + 2.0 * np.sin(0.3 * b["time"]),
        "/command/data.0": b["torque"],
        "motor_current": b["torque"] + 0.01 * np.sin(40.0 * b["time"]),
    }

    assert "/joint_states/joint0/position" in channels(eccentric.draft_rig(log)).values()


def test_three_phases_are_no_joints() -> None:
    """Currents with numbers beside one angle."""
    b = bare()
    log = {"t_s": b["time"], "theta": b["angle"], "iq_A": b["torque"]}
    log |= {f"u{k}": np.sin(11.0 * b["angle"] + 2.1 * k) for k in (1, 2, 3)}
    draft = eccentric.draft_rig(log)

    assert channels(draft)["current"] == "iq_A"
    assert "joint" not in " ".join(draft.left_out.values())


@pytest.mark.parametrize("times", [12, 36])
@pytest.mark.parametrize("both", [True, False])
def test_what_repeats_within_a_turn_is_ripple(times: int, both: bool) -> None:
    """Cogging of slots and poles, seen at one speed or both ways: the gear stays 1 and the plane level."""
    t = np.arange(0.0, 40.0, STEP)
    speed = (np.sign(np.sin(0.4 * t)) if both else 1.0) + 0.1 * np.sin(2.1 * t)
    angle = np.cumsum(speed) * STEP
    current = 0.2 * np.sign(speed) + 0.05 * speed + 0.12 * np.sin(times * angle)
    draft = eccentric.draft_rig({"t_s": t, "theta_rad": angle, "omega_rad_s": speed, "current_A": current})
    known = tomllib.loads(draft.text)["known"]

    assert (known["case"], known["mu"]) == ("C1", 1)
    assert "ripple" in draft.text


def test_gravity_is_found_below_a_stronger_ripple() -> None:
    """Once per turn, in both directions: a link on the shaft."""
    t = np.arange(0.0, 60.0, STEP)
    angle = 5.0 * np.sin(0.7 * t) + 2.0 * np.sin(1.7 * t)
    speed, rise = np.gradient(angle, STEP), np.gradient(np.gradient(angle, STEP), STEP)
    current = 0.1 * np.sign(speed) + 0.02 * rise + 0.4 * np.sin(angle) + 0.6 * np.sin(24.0 * angle)
    draft = eccentric.draft_rig({"t_s": t, "theta_rad": angle, "current_A": current})
    known = tomllib.loads(draft.text)["known"]

    assert (known["case"], known["mu"]) == ("C2", 1)


def test_an_integrated_speed_shows_no_gravity() -> None:
    """Without an angle none lasts: a drift of the integral would do as well."""
    t = np.arange(0.0, 40.0, STEP)
    angle = 5.0 * np.sin(0.7 * t) + 2.0 * np.sin(1.7 * t)
    speed = np.gradient(angle, STEP)
    log = {"t_s": t, "omega_rad_s": speed, "current_A": 0.1 * np.sign(speed) + 0.4 * np.sin(angle)}

    assert tomllib.loads(eccentric.draft_rig(log).text)["known"]["case"] == "C1"
