"""Signals of a log on cells of 20 ms: the base of every friction model, and the states of the drive."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.rigs import Rig
from eccentric.signals.long.limits import (
    ANGLES,
    COLUMNS,
    DEGREES_A_BIN,
    JUMP,
    LARGEST_BIN,
    LEAST_BIN,
    OCTAVES,
    SLOW,
)

__all__ = ["Cells", "base_of", "cells_of", "state_name", "states_of", "threshold", "usual"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

_STATES = ("speed", "angle", "drive", "acceleration", "temperature", "motor off", "speed and drive")


def state_name(state: int) -> str:
    """What a state is a state of, in words."""
    return _STATES[state >> 24]


def threshold(omega: Array, rig: Rig) -> float:
    """Speed from which a cell counts as moving [rad/s]: that of the rig, or as most of the batch suggests."""
    given = rig.sampling.moving_threshold_rad_s
    return SLOW * usual(omega) if given is None else given


def usual(x: Array) -> float:
    """The size that a signal usually stays below."""
    return float(np.quantile(np.abs(x), 0.95))


@dataclass(frozen=True)
class Cells:
    """Signals on cells, without the first and the last one; `clear` where the angle does not wrap."""

    span: Array
    omega: Array
    alpha: Array
    drive: Array
    angle: Array | None
    temperature: Array | None
    clear: Mask


def cells_of(values: Mapping[str, Array], rig: Rig, first: Integers, per: int, count: int) -> Cells:
    """Differences over neighbouring cells; the drive is averaged over each."""
    t = values["time"][first]
    span = t[2:] - t[:-2]
    name = next((c for c in ("theta_m", "theta_l") if c in values), None)
    mu = rig.known.get("mu")
    if name is None:
        speed = next(values[c] for c in ("omega_m", "omega_l") if c in values)[first]
        omega, alpha = speed[1:-1], (speed[2:] - speed[:-2]) / span
        angle, clear = None, np.ones(len(span), dtype=bool)
    else:
        theta = values[name][first]
        steps = np.diff(theta)
        clear = np.abs(steps) <= JUMP * max(float(np.quantile(np.abs(steps), 0.9)), 1e-12)
        clear = clear[1:] & clear[:-1]
        omega, alpha = (theta[2:] - theta[:-2]) / span, 4.0 * (steps[1:] - steps[:-1]) / span**2
        angle = theta[1:-1] if name == "theta_l" else None if mu is None else mu * theta[1:-1]
        if name == "theta_l" and mu is not None:
            omega, alpha = omega / mu, alpha / mu
    drive = next(values[c] for c in ("current", "torque", "torque_l", "voltage") if c in values)
    drive = drive[: count * per].reshape(count, per).mean(axis=1)[1:-1]
    warm = values.get("temperature")
    warm = None if warm is None else warm[first[1:-1]]
    return Cells(span, omega, alpha, drive, angle, warm, clear)


def base_of(cells: Cells, t: Array) -> Array:
    """The base of a friction model and the drive on the cells (cells, COLUMNS + 1)."""
    direction = np.sign(cells.omega)
    zero = np.zeros_like(t)
    angle, warm = cells.angle, cells.temperature
    x = np.empty((len(t), COLUMNS + 1))
    x[:, 0], x[:, 1], x[:, 2], x[:, 3] = direction, cells.omega, cells.alpha, 1.0
    x[:, 4] = zero if angle is None else np.sin(angle)
    x[:, 5] = zero if angle is None else np.cos(angle)
    x[:, 6] = direction * np.abs(cells.omega) ** 2
    x[:, 7] = direction * t
    x[:, 8] = zero if warm is None else direction * warm
    x[:, 9] = cells.drive
    return x


def states_of(cells: Cells, moving: Mask, free: Mask, scales: tuple[float, ...]) -> list[Integers]:
    """The state of each cell in every respect, -1 for none: a kind, and a bin of its size and direction."""
    way = (cells.omega > 0.0).astype(np.int64)
    signals = cells.omega, cells.alpha, cells.drive
    speed, acceleration, drive = (
        2 * _bin(x, scale, OCTAVES) + (x > 0.0) for x, scale in zip(signals, scales, strict=True)
    )
    coarse = 2 * _bin(cells.drive, scales[2], 1.0) + (cells.drive > 0.0)
    found = [
        (0, speed),
        (2, 2 * drive + way),
        (3, 2 * acceleration + way),
        (6, 1024 * (2 * _bin(cells.omega, scales[0], 1.0) + way) + coarse),
    ]
    if cells.angle is not None:
        place = np.floor(cells.angle / (2.0 * math.pi) * ANGLES).astype(np.int64) % ANGLES
        found.append((1, 2 * place + way))
    if cells.temperature is not None:
        warm = np.clip(np.floor(cells.temperature / DEGREES_A_BIN), -500, 500).astype(np.int64) + 500
        found.append((4, 2 * warm + way))
    states = [np.where(moving, (kind << 24) + state, -1) for kind, state in found]
    if np.any(free):
        states.append(np.where(free, (5 << 24) + way, -1))
    return states


def _bin(x: Array, scale: float, octaves: float) -> Integers:
    """Number of the bin of a size, from 0 on: its logarithm, small ones together."""
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.floor(octaves * np.log2(np.abs(x) / scale)) if scale > 0.0 else np.zeros_like(x)
    # Half as many bins span the same range at one an octave.
    least = round(LEAST_BIN * octaves / OCTAVES)
    return np.clip(np.nan_to_num(found), least, LARGEST_BIN).astype(np.int64) - least
