"""The wave of gravity that a draft finds, against least squares at every wave number of a fine grid."""

from __future__ import annotations

import numpy as np
import pytest

from eccentric.drafting.balance import Moved, balance_of


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
