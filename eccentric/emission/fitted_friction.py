"""What fitted values make of a friction law: no single solution of a step, or levels that are cut at 0."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.emission.hot import evaluated, link_over_motor, load_module, turn_of_link
from eccentric.model import Model, function_of, levels, meaning, spoken
from eccentric.model import vocabulary as v

# Friction that follows the acceleration has to stay below the inertia, for a step to have one solution.


_ACCELERATIONS = np.concatenate([-np.geomspace(1e5, 1e-2, 36), np.geomspace(1e-2, 1e5, 36)])
"""Of the motor [rad/s^2]: friction is steepest where a load begins to grow, or far beyond it."""
_ANGLES = 24
_SLOW = 1.0
"""Speed of the motor [rad/s], where no fit says at which it turns."""


@dataclass(frozen=True)
class InertialLoss:
    """How much friction changes with the acceleration, at most [kg m^2], and the inertia of the drive."""

    loss: float
    inertia: float

    @property
    def solvable(self) -> bool:
        """Whether a step has one solution, and an acceleration passed on from step to step settles."""
        return self.loss < self.inertia


def inertial_loss(model: Model, speed: float = _SLOW) -> InertialLoss | None:
    """The loss by the acceleration at motor speeds up to this [rad/s], over a turn of the link.

    None where friction does not follow the acceleration, or a parameter has no value.
    """
    friction = model.expand(model.balance("mechanical").sum_of("friction"))
    missing = any(q.default is None for q in spoken(model).parameters)
    if v.alpha_m.symbol not in friction.free_symbols or missing:
        return None
    module = load_module(model)
    speeds = np.array([-speed, -1e-3 * speed, 1e-3 * speed, speed])
    grid = np.meshgrid(turn_of_link(model, _ANGLES), speeds, _ACCELERATIONS, indexing="ij")
    states = dict(zip((v.theta_m, v.omega_m, v.alpha_m), grid, strict=True))

    def along(function: Any) -> np.ndarray:
        return np.diff(evaluated(function, model.axis, states), axis=-1) / np.diff(_ACCELERATIONS)

    slopes = along(module.mechanical_friction_torque)
    inertia = -(along(module.mechanical_residual) + slopes)
    return InertialLoss(float(np.abs(slopes).max()), float(np.median(inertia)))


def require_solvable(model: Model, speed: float = _SLOW) -> None:
    """Raise InputError for a model whose friction takes more of an acceleration than its inertia does."""
    found = inertial_loss(model, speed)
    if found is not None and not found.solvable:
        unit = model.axis.unit("kg m^2")
        raise InputError(
            f"model {model.name}",
            f"acceleration-dependent friction below the inertia, {found.inertia:.3g} {unit}",
            f"up to {found.loss:.3g} {unit}",
            why="for a time step to have one solution",
            hint="check the inertias and the loss, or the gear",
        )


# Levels of dry friction never cross zero: where fitted terms would make one negative, it is cut at 0.


Array = NDArray[np.float64]
Level = Callable[[Array, float], Array]
"""Of angle and velocity of the motor."""

_PER_TURN, _MOST = 720, 36_000
"""Angles tried: per turn of the motor, and in all over a turn of the link."""
_SPEEDS = 33
_HALVINGS = 50
_ROUNDING = 1e-9
"""Part of the largest level below which a negative one is rounding."""


@dataclass(frozen=True)
class LevelCut:
    """Where a level of dry friction is cut at 0.

    Attributes:
        directions: those of motion that it is of, 1 forwards and -1 backwards.
        speed: of the motor, from rest to the fastest, at which the level is lowest [rad/s].
        lowest: the level there if it were not cut, negative [N m].
        intervals: where it is cut at that speed: from and to an angle of the link, over one turn [rad]; where
            the axis does not turn, a position within its travel [m].
    """

    directions: tuple[int, ...]
    speed: float
    lowest: float
    intervals: tuple[tuple[float, float], ...]


def cut_levels(
    model: Model, speeds: Sequence[float], travel: tuple[float, float], temperature: float | None = None
) -> tuple[LevelCut, ...]:
    """Where the levels of a model with values are cut, one entry if both directions are alike.

    Nothing where a parameter has no value, or friction depends on the motion of an arm.

    Args:
        model: of one drive.
        speeds: lowest and highest of the motor [rad/s].
        travel: least and greatest angle of the motor [rad], used where the axis does not turn.
        temperature: at which friction is looked at [deg C].
    """
    if model.axis.wraps:
        count = min(_MOST, _PER_TURN * math.ceil(1.0 / link_over_motor(model)))
        theta_m = np.append(turn_of_link(model, count), 2.0 * math.pi / link_over_motor(model))
    else:
        theta_m = np.linspace(*travel, _MOST)
    tried = [0.0, *np.linspace(min(speeds, default=0.0), max(speeds, default=0.0), _SPEEDS)]
    cuts = [
        cut
        for direction, level in _before_the_cut(model, temperature)
        if (cut := _cut(level, direction, tried, theta_m, model)) is not None
    ]
    if len(cuts) == 2 and cuts[0].intervals == cuts[1].intervals:
        return (replace(cuts[0], directions=(1, -1)),)
    return tuple(cuts)


def _before_the_cut(model: Model, temperature: float | None) -> Iterator[tuple[int, Level]]:
    """Direction, and the level in it before it is cut, where its terms allow a negative one."""
    friction = tuple(t for t in model.balance("mechanical").terms if t.kind == "friction")
    found, values = levels(model, v.omega_m.symbol, friction), _values(model, temperature)
    for direction, cut in ((1, found.forward.dry), (-1, -found.backward.dry)):
        if not isinstance(cut, sp.Max):
            continue
        level = sp.Max(*(x for x in cut.args if x != 0))
        for a in reversed(found.definitions):
            level = level.xreplace({a.target: a.value})
        call, names = function_of(meaning(model.expand(level)).xreplace(values).xreplace(values))
        if set(names) <= {v.theta_m.name, v.omega_m.name}:
            yield direction, partial(_along, call, names)


def _along(call: Callable[..., Any], names: tuple[str, ...], theta_m: Array, omega_m: float) -> Array:
    here = {v.theta_m.name: theta_m, v.omega_m.name: omega_m}
    return np.broadcast_to(call(*(here[name] for name in names)), theta_m.shape)


def _values(model: Model, temperature: float | None) -> Mapping[sp.Symbol, sp.Expr]:
    """Parameters by their values, states as they are initially; other inputs than motion are 0."""
    known = {q.symbol: q.default for q in model.parameters if q.default is not None}
    known |= {state.symbol: state.initial for state in model.states}
    others = {q.symbol: sp.S.Zero for q in model.inputs if q not in (v.theta_m, v.omega_m)}
    return known | others | ({} if temperature is None else {v.temperature.symbol: sp.Float(temperature)})


def _cut(at: Level, direction: int, speeds: list[float], theta_m: Array, model: Model) -> LevelCut | None:
    """Where a level is cut at the speed at which it is lowest; None if it is negative at none."""
    from scipy.optimize import (
        minimize_scalar,
    )  # a command that emits without fitted values needs none of SciPy

    def least(x: float) -> float:
        return float(at(theta_m, direction * x).min())

    tried = sorted(set(speeds))
    k = min(range(len(tried)), key=lambda k: least(tried[k]))
    # A load that vanishes at one speed and angle leaves a dip between two of these.
    low, high = tried[max(k - 1, 0)], tried[min(k + 1, len(tried) - 1)]
    between = minimize_scalar(least, bounds=(low, high), method="bounded", options={"xatol": 1e-9 * high})
    lowest, speed = min((least(tried[k]), tried[k]), (float(between.fun), float(between.x)))
    omega_m = direction * speed
    below = at(theta_m, omega_m) < 0.0
    if lowest >= -_ROUNDING * float(np.abs(at(theta_m, omega_m)).max()):
        return None
    edges = np.flatnonzero(below[1:] != below[:-1])
    low, high, falling = theta_m[edges], theta_m[edges + 1], below[edges + 1]
    for _ in range(_HALVINGS):
        middle = (low + high) / 2.0
        before = (at(middle, omega_m) < 0.0) != falling
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    ends = [*([theta_m[0]] if below[0] else []), *high, *([theta_m[-1]] if below[-1] else [])]
    pairs = [(float(x), float(y)) for x, y in zip(ends[::2], ends[1::2], strict=True)]
    scale = 1.0
    if model.axis.wraps:
        scale, turn = link_over_motor(model), float(theta_m[-1])
        if len(pairs) > 1 and below[0] and below[-1]:  # one interval that contains the angle 0
            (_, end), *others, (start, _) = pairs
            pairs = [*others, (start, end + turn)]
    return LevelCut((direction,), float(speed), lowest, tuple((scale * x, scale * y) for x, y in pairs))
