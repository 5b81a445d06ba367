"""What a log can resolve, unless the rig says so: cut-off, averages, or one mean per run.

The default low pass of 25 Hz suits a fine encoder on evenly spaced time stamps.  A coarse or jittery angle
has more noise than signal in its second derivative there, and that noise, times the inertia, looks like
friction that depends on anything.  Its size is known in advance: white noise of the angle, measured by its
fourth differences, gives after the zero-phase second-order low pass and two derivatives

    noise(alpha)^2 = noise(theta)^2 2 dt (2 pi)^4 f_c^5 I,   I = integral of x^4/(1 + x^4)^2 = pi/(8 sqrt 2)

and from this follows the cut-off at which the noise is a given fraction of the acceleration.  Where a stiff
drive accelerates its load faster than 25 Hz and the encoder shows it, the cut-off is raised instead: what the
low pass took from the acceleration, and not from the drive, would look like an effect.  A bench that logs
constant speeds has hardly any acceleration: its runs are points, one mean each.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from eccentric.rigs import Rig
from eccentric.signals import filters
from eccentric.signals.limits import (
    COARSE,
    FAST,
    LEAST_DIFFERENCES,
    LEAST_STRETCH,
    LOWEST_HZ,
    MAP_PARTS,
    MAP_RANGE,
    MAP_RUNS,
    MAP_STEADY,
    MOST_STRETCHES,
    QUIET,
    RAISED,
    TOO_NOISY,
)
from eccentric.signals.stretches import rows_of_each

__all__ = ["suited"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def suited(
    rig: Rig, t: Array, theta: Array, segment: NDArray[np.int64], moving: Mask, whole: Mask
) -> tuple[Rig, str]:
    """Return the rig with settings that suit its log, and a sentence on them; unchanged if it names a filter.

    t [s], theta [rad] at the motor, number of the stretch and whether it moves, each (n,); `whole`
    (stretches,) are those that the log has begun itself, not a window that was cut out of a longer one.
    """
    if rig.sampling.low_pass_given or rig.sampling.average_over:
        return rig, ""
    stretches = rows_of_each(segment)
    # Windows of one long run may each have one speed.
    if _is_map(t, theta, [rows for rows, own in zip(stretches, whole, strict=True) if own]):
        steps = [float(np.median(np.diff(t[rows]))) for rows in stretches if len(rows) > 1]
        cut = min(rig.sampling.low_pass_hz, COARSE / max(steps))
        said = f"the log is {len(stretches)} runs of constant speed: one mean of each is compared"
        return _averaged(rig, cut, math.inf), said
    if not np.all(whole):
        places = np.linspace(0, len(stretches) - 1, MOST_STRETCHES).round().astype(int)
        stretches = [stretches[k] for k in np.unique(places)]
    low_pass_hz = rig.sampling.low_pass_hz
    noise, size = _over_all(t, theta, moving, stretches, low_pass_hz)
    if not size:
        return rig, ""
    if noise <= TOO_NOISY * size:
        return _raised(rig, t, theta, moving, stretches)
    signal = math.sqrt(max(size**2 - noise**2, (TOO_NOISY * size) ** 2))
    cut = max(LOWEST_HZ, low_pass_hz * (QUIET * signal / noise) ** (2.0 / 5.0))
    said = (
        f"at {low_pass_hz:g} Hz the steps and stamps of the angle make {noise / size:.0%} of the"
        f" acceleration: the low pass is set to {cut:.2g} Hz, and both sides are averaged over"
        f" {1.0 / cut:.2g} s (low_pass_hz and average_over of the rig override this)"
    )
    return _averaged(rig, cut, 1.0 / cut), said


def _raised(
    rig: Rig, t: Array, theta: Array, moving: Mask, stretches: list[NDArray[np.int64]]
) -> tuple[Rig, str]:
    """The rig with the highest cut-off that the noise allows, if the load moves faster than the default."""
    default = chosen = rig.sampling.low_pass_hz
    noise, size = _over_all(t, theta, moving, stretches, default)
    seen = size**2 - noise**2
    most = RAISED / max(float(np.median(np.diff(t[rows]))) for rows in stretches if len(rows) > LEAST_STRETCH)
    missed, cut = 0.0, 2.0 * default
    # Stamps are rounded: a fifth of the rate is a fifth.
    while cut <= most * (1.0 + 1e-6):
        noise, size = _over_all(t, theta, moving, stretches, cut)
        if not size or noise > TOO_NOISY * size:
            break
        if (beyond := size**2 - noise**2 - seen) > FAST * seen:
            chosen, missed, seen = cut, missed + beyond, seen + beyond
        cut *= 2.0
    if chosen == default:
        return rig, ""
    said = (
        f"the load moves faster than {default:g} Hz, with {missed / seen:.0%} of the square of its"
        f" acceleration: the low pass is set to {chosen:g} Hz (low_pass_hz of the rig overrides this)"
    )
    return dataclasses.replace(rig, sampling=dataclasses.replace(rig.sampling, low_pass_hz=chosen)), said


def _averaged(rig: Rig, cut_hz: float, over: float) -> Rig:
    sampling = dataclasses.replace(rig.sampling, low_pass_hz=cut_hz, average_over=over)
    return dataclasses.replace(rig, sampling=sampling)


def _is_map(t: Array, theta: Array, stretches: list[NDArray[np.int64]]) -> bool:
    """Whether each stretch has a constant speed, and not all have the same."""
    if len(stretches) < MAP_RUNS:
        return False
    means, spreads = [], []
    for rows in stretches:
        if len(rows) < MAP_PARTS:
            return False
        reach = len(rows) // MAP_PARTS
        speed = (theta[rows[reach:]] - theta[rows[:-reach]]) / (t[rows[reach:]] - t[rows[:-reach]])
        means.append(float(np.mean(speed)))
        spreads.append(float(np.std(speed)) / max(abs(means[-1]), 1e-12))
    return float(np.median(spreads)) < MAP_STEADY and np.ptp(means) > MAP_RANGE * float(np.max(np.abs(means)))


def _over_all(
    t: Array, theta: Array, moving: Mask, stretches: list[NDArray[np.int64]], cut_hz: float
) -> tuple[float, float]:
    """RMS of the noise in the acceleration of all stretches, and of the whole [rad/s^2]; 0 if unknown."""
    parts = [_noise_and_size(t[r], theta[r], moving[r], cut_hz) for r in stretches if len(r) > LEAST_STRETCH]
    known = np.array([part for part in parts if part is not None]).reshape(-1, 2)
    if not len(known):
        return 0.0, 0.0
    noise, size = np.sqrt(np.mean(known**2, axis=0))
    return float(noise), float(size)


def _noise_and_size(t: Array, theta: Array, moving: Mask, cut_hz: float) -> tuple[float, float] | None:
    """RMS of the noise in the acceleration of a stretch, and of the whole [rad/s^2], over its moving rows."""
    step = float(np.median(np.diff(t)))
    grid = np.arange(t[0], t[-1], step)
    inside = np.interp(grid, t, moving.astype(float)) > 0.5
    difference = np.diff(np.interp(grid, t, theta), 4)[inside[2:-2]] / math.sqrt(70.0)
    _, _, acceleration, smooth = filters.motion(t, theta, cut_hz)
    if not smooth or len(difference) < LEAST_DIFFERENCES or not np.any(moving):
        return None
    gain = math.sqrt(2.0 * step * (2.0 * math.pi) ** 4 * cut_hz**5 * math.pi / (8.0 * math.sqrt(2.0)))
    size = float(np.sqrt(np.mean(acceleration[moving] ** 2)))
    return gain * float(np.sqrt(np.mean(difference**2))), size
