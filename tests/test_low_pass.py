"""The low pass: its closed form at single frequencies, and SciPy's filter of the same kind."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from eccentric.signals.filters import low_pass, motion


@pytest.mark.parametrize("cut", [2.0, 25.0, 90.0])
@pytest.mark.parametrize("part", [0.2, 1.0, 1.1])
def test_a_sine_keeps_its_phase_and_loses_what_the_butterworth_square_takes(cut: float, part: float) -> None:
    """Forwards and backwards 1/(1 + r^4), r the ratio of tangents: the bilinear transform of the filter."""
    rate, frequency = 250.0, cut * part
    t = np.arange(20_000) / rate
    r = np.tan(np.pi * frequency / rate) / np.tan(np.pi * cut / rate)
    x = np.sin(2.0 * np.pi * frequency * t + 0.3)
    passed = low_pass(x, rate, cut)

    assert passed is not None
    middle = slice(5000, -5000)
    np.testing.assert_allclose(passed[middle], x[middle] / (1.0 + r**4), atol=1e-9)


def test_a_straight_line_passes_unchanged() -> None:
    """To its very ends, where the signal is reflected about them, but for what the slope does there."""
    line = 3.0 - 0.02 * np.arange(2000)
    passed = low_pass(np.column_stack([line, np.full(2000, 7.0)]), 250.0, 25.0)

    assert passed is not None
    np.testing.assert_allclose(passed[:, 1], 7.0, rtol=1e-12)
    np.testing.assert_allclose(passed[200:-200, 0], line[200:-200], rtol=1e-11)


@pytest.mark.parametrize("shape", [(10,), (11, 3), (5000,), (300, 7, 2), (50, 0)])
@pytest.mark.parametrize(("rate", "cut"), [(250.0, 25.0), (1000.0, 2.0), (50.0, 20.0), (1e4, 25.0)])
def test_it_is_scipys(shape: tuple[int, ...], rate: float, cut: float) -> None:
    """Of any shape, from the shortest stretch on: `sosfiltfilt` with its default padding."""
    x = np.random.default_rng(0).normal(size=shape).cumsum(axis=0) + 3.0
    passed = low_pass(x, rate, cut)
    expected = sosfiltfilt(butter(2, cut, fs=rate, output="sos"), x, axis=0) if x.size else x

    assert passed is not None
    np.testing.assert_allclose(passed, expected, rtol=0.0, atol=1e-11 * np.max(np.abs(x), initial=0.0))


def test_what_is_too_short_or_too_coarse_is_not_filtered() -> None:
    """Nine rows, and a cut-off above 0.4 of the sampling rate."""
    assert (None, None) == (low_pass(np.ones(9), 250.0, 25.0), low_pass(np.ones(50), 50.0, 20.1))


@pytest.mark.parametrize(("rate", "cut"), [(250.0, 25.0), (2e4, 25.0), (5e4, 5.0)])
def test_a_constant_passes_whatever_its_size(rate: float, cut: float) -> None:
    """An angle after a thousand turns: its offset has no rounding that a low cut-off would amplify."""
    passed = low_pass(np.full(4000, 1e4), rate, cut)

    assert passed is not None
    np.testing.assert_array_equal(passed, 1e4)


@pytest.mark.parametrize("part", [0.04, 0.1])
def test_the_acceleration_of_a_sine_is_that_of_its_quintic_spline(part: float) -> None:
    """Sampled at the phase x per step, its second derivative is -sum (x + 2 pi k)^-4/sum (x + 2 pi k)^-6."""
    rate = 250.0
    t = np.arange(4000) / rate
    angle, _, acceleration, passed = motion(t, np.sin(2.0 * np.pi * part * np.arange(4000)), 25.0)
    aliases = 2.0 * np.pi * (part + np.arange(-50, 51))
    factor = -(rate**2) * float(np.sum(aliases**-4) / np.sum(aliases**-6))
    middle = slice(1500, -1500)

    assert passed
    np.testing.assert_allclose(acceleration[middle], factor * angle[middle], atol=1e-8 * abs(factor))
