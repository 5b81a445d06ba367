"""Very many columns whose names tell nothing: the first look at them loses no drive."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

import eccentric
from eccentric.drafting.balance import Moved, most_explained

N = 6000
T = 0.004 * np.arange(N)


def motion() -> Moved:
    """An axis that turns back and forth over many turns."""
    speed = 9.0 * np.sin(1.3 * T) + 3.0 * np.sin(0.31 * T)
    angle = -9.0 / 1.3 * np.cos(1.3 * T) - 3.0 / 0.31 * np.cos(0.31 * T)
    rise = 9.0 * 1.3 * np.cos(1.3 * T) + 3.0 * 0.31 * np.cos(0.31 * T)
    return Moved(angle, speed, rise, np.abs(speed) > 0.5)


@pytest.mark.parametrize("often", [1.0, 2.37, 5.0])
@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_the_share_of_a_wave_is_found_without_its_period(often: float, share: float) -> None:
    """A wave of the angle in white noise has this part of the variance, friction and inertia none."""
    moved, noise = motion(), np.random.default_rng(3).standard_normal(N)
    wave = np.sin(often * moved.x + 0.4)
    for plain in (np.ones(N), moved.w, moved.a, np.sign(moved.w)):
        rows = moved.moving
        wave[rows] -= plain[rows] * (plain[rows] @ wave[rows]) / (plain[rows] @ plain[rows])
    size = np.std(wave[moved.moving])
    columns = np.column_stack([np.sqrt(share) * wave / size + np.sqrt(1.0 - share) * noise, noise])
    found = most_explained(moved, columns)

    assert found[0] == pytest.approx(share, abs=0.06)
    assert found[1] < 0.05


@pytest.mark.slow
def test_a_drive_among_columns_that_tell_nothing_is_found() -> None:
    """Three hundred of noise, drifts and waves in time beside angle, speed and a current with gravity."""
    rng, moved = np.random.default_rng(5), motion()
    current = 0.02 * moved.a + 0.3 * np.sign(moved.w) + 0.02 * moved.w + 0.9 * np.sin(moved.x)
    log = {"c0": T}
    for k in range(1, 301):
        phase = rng.uniform(0.0, 6.0)
        made = (rng.standard_normal(N), 0.05 * np.cumsum(rng.standard_normal(N)), np.sin(0.1 * k * T + phase))
        log[f"c{k}"] = made[k % 3]
    log |= {"c17": moved.x, "c111": current + 0.01 * rng.standard_normal(N), "c250": moved.w}
    columns = tomllib.loads(eccentric.draft_rig(log).text)["columns"]

    assert columns["time"] == "c0"
    assert "c17" in str(columns["theta_m"])
    assert "c250" in str(columns["omega_m"])
    assert "c111" in str(columns["current"])
