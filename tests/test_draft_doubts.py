"""What a short swing does not show is doubted, in the draft and in the check; a unit goes before per cent."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

import eccentric

TURN = 2.0 * np.pi
TYPED = {"M": "0.3 kg", "M_l": "0.1 kg", "L": "0.1 m"}


def swing(angle: str, scale: float, *, counts: bool = False, turns: float = 1.0) -> dict[str, np.ndarray]:
    """A link that swings by a fifth of a turn: the angle times `scale` in this column, whole if in counts.

    What looks like gravity repeats after these turns.
    """
    t = np.arange(0.0, 60.0, 0.004)
    ways = [(0.55, 0.4), (0.15, 1.1)]
    theta = sum(a * np.sin(TURN * f * t) for a, f in ways)
    omega = sum(a * TURN * f * np.cos(TURN * f * t) for a, f in ways)
    alpha = sum(-a * (TURN * f) ** 2 * np.sin(TURN * f * t) for a, f in ways)
    torque = 0.004 * alpha + 0.02 * np.sign(omega) + 0.01 * omega + 0.33 * np.sin(theta / turns)
    noise = 0.002 * np.random.default_rng(1).standard_normal(len(t))
    shown = theta * scale
    return {"t_s": t, angle: np.round(shown) if counts else shown, "torque_Nm": torque + noise}


@pytest.mark.parametrize(
    ("log", "key"),
    [
        (swing("q_rad", 1.0, turns=1.6), "mu"),
        (swing("q_counts", 2000.0 / TURN, counts=True), "encoder_counts_per_rev"),
    ],
    ids=["gear", "counts"],
)
def test_a_part_of_a_period_is_no_more_than_a_guess(log: dict[str, np.ndarray], key: str) -> None:
    """A gear that it would need is not taken; the draft says so, and the check repeats it."""
    draft = eccentric.draft_rig(log)
    rig = tomllib.loads(draft.text)
    rig["known"] |= TYPED
    found = eccentric.check_rig(log, rig)

    assert any(line.startswith(f"{key}: less than one period") for line in draft.doubts)
    assert rig["known"]["mu"] == 1
    assert any(f"{key} = " in line and "as drafted" in line for line in found.warnings)


def test_a_value_of_ones_own_is_not_doubted() -> None:
    """What is not as the draft has it was checked by somebody."""
    log = swing("q_rad", 1.0)
    rig = tomllib.loads(eccentric.draft_rig(log).text)
    rig["known"] |= TYPED | {"mu": 0.5}

    assert [] == [line for line in eccentric.check_rig(log, rig).warnings if "mu = " in line]


def test_a_torque_in_newton_metres_goes_before_one_in_per_cent() -> None:
    """Both are the same signal; the log does not say of what the per cent are."""
    log = swing("q_rad", 1.0)
    torque = log.pop("torque_Nm")
    log |= {"torque_pct": 50.0 * torque, "torque_mNm": 1e3 * torque + 0.5 * np.sin(7.0 * log["t_s"])}
    columns = tomllib.loads(eccentric.draft_rig(log).text)["columns"]

    assert columns["torque"] == {"column": "torque_mNm", "unit": "mNm"}
