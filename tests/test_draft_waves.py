"""The wave of gravity in a column, found in one column and looked for in very many."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

import eccentric
from eccentric.drafting.balance import Moved, balance_of, most_explained


def left(x: np.ndarray, w: np.ndarray, a: np.ndarray, y: np.ndarray, k: float | None = None) -> float:
    """Variance of y that friction, speed, inertia and a wave leave."""
    columns = [np.ones_like(x), np.sign(w), w, a]
    columns += [] if k is None else [np.sin(k * x), np.cos(k * x)]
    design = np.column_stack(columns)
    return float(np.mean((y - design @ np.linalg.lstsq(design, y, rcond=None)[0]) ** 2))


@pytest.mark.parametrize("turns", [0.6, 3.0, 250.0])
@pytest.mark.parametrize("unit", [1.0, 4096.0])
def test_it_is_the_wave_that_explains_most(turns: float, unit: float) -> None:
    """On a swing of less than a turn, and on so many that the search begins with a part of them."""
    t = np.linspace(0.0, 60.0, 12_000)
    drift = 2.0 * np.pi * turns * t / 60.0
    x = unit * (drift + 0.8 * np.sin(1.1 * t))
    w, a = np.gradient(x, t), np.gradient(np.gradient(x, t), t)
    noise = np.random.default_rng(3).normal(0.0, 0.05, len(t))
    y = 0.3 * np.sign(w) + 0.02 * w / unit + 0.01 * a / unit + np.sin(x / unit - 0.4) + noise
    found = balance_of(Moved(x, w, a, np.abs(w) > 0.0), y)
    assert found is not None

    near = np.linspace(0.97, 1.03, 121) / unit
    best = min(left(x, w, a, y, k) for k in near)

    assert 1.0 - left(x, w, a, y) / np.var(y) == pytest.approx(found.r2_plain, abs=1e-9)
    assert found.r2 >= 1.0 - best / np.var(y) - 1e-6
    assert 1.0 - left(x, w, a, y, 2.0 * np.pi / found.period) / np.var(y) == pytest.approx(found.r2, abs=1e-9)
    assert 2.0 * np.pi * unit == pytest.approx(found.period, rel=0.02 / turns)
    assert 0.4 * unit == pytest.approx(found.zero, abs=0.05 * unit)


def test_a_short_record_has_a_wave_too() -> None:
    """Of 400 rows, fewer than the search takes from a long record, the wave comes out as it went in."""
    t = np.linspace(0.0, 8.0, 400)
    x = 2.0 * np.sin(1.3 * t) + t
    w, a = np.gradient(x, t), np.gradient(np.gradient(x, t), t)
    found = balance_of(Moved(x, w, a, np.abs(w) > 0.0), 0.3 * np.sign(w) + 0.02 * w + np.sin(1.5 * x - 0.4))
    assert found is not None

    assert 2.0 * np.pi / 1.5 == pytest.approx(found.period, rel=1e-5)
    assert 1.0 == pytest.approx(found.r2, abs=1e-9)


# Very many columns whose names tell nothing: the first look at them loses no drive.


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
