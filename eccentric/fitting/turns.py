"""The turns of one fit: least squares on the emitted module, repeated until the scale of the drive settles.

The residual of the mechanical balance is linear in friction, in the coefficients of effects and in what the
rig leaves open; only the scale of the drive is not.  A free column of gravity finds it: where the fit wants
1 + g times the gravity torque, the scale (or the unknown arm) was too small by that factor, and the fit is
repeated with the better one until g vanishes.

Where one signal alone measures the drive, effects on the current take the one that the model asks for,
(torque - residual)/k_i of the turn before: with the measured one the drive would explain itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from eccentric.effects.effect import Effect
from eccentric.fitting.emitted import Emitted, FitData, Values
from eccentric.fitting.least_squares import bounded
from eccentric.model import Model

__all__ = ["Solved", "Turns"]

Array = np.ndarray
Limits = list[tuple[float | None, float | None]]
_TURNS = 8
_SETTLED = 1e-9


@dataclass(frozen=True)
class Solved:
    """A balance solved for its linear unknowns."""

    balance: str
    names: tuple[str, ...]
    coefficients: Array
    low: Array
    high: Array
    active: Array
    design: Array
    rows: Array


class Turns:
    """The turns of one fit; values, scale, residuals, target, change (as in `Refit`) are of the last one."""

    def __init__(
        self,
        base: Model,
        effects: tuple[tuple[Effect, Values], ...],
        data: FitData,
        bounds: bool,
        linear: bool,
        without: int | None,
    ) -> None:
        self.effects, self.data, self.bounds = effects, data, bounds
        self.shapes = {name: value for _, own in effects for name, value in own.items()}
        self.model = base
        for effect, own in effects:
            self.model = effect.extend(self.model, own)
        drive, letters = data.drive, {q.name for q in self.model.parameters}
        self.scale = drive.scale
        columns = data.signals.columns(base)
        self.every = [column.parameter.name for column in columns]
        self.fitted = [column.parameter.name for column in columns if column.linear or not linear]
        self.values = {name: value for name, value in drive.known.items() if name in letters}
        # What the log cannot show has no effect on it, but the module wants a number.
        absent = {"R": 1.0, "k_e": 0.0, "J_m": 0.0, "J_l": 0.0}
        self.values = {n: v for n, v in absent.items() if n in letters} | self.values
        self._scaled()
        self.values |= dict.fromkeys((q.name for q in base.friction_parameters), 0.0) | self.shapes
        self.values |= {q.name: 0.0 for effect, _ in effects for q in effect.coefficients}
        self.offset = self.zero = 0.0
        self.change = np.inf
        self.current: Array | None = None
        used = data.rows.train | data.rows.score
        self.train = data.rows.train if without is None else used & (data.rows.run != without)
        self.solved: list[Solved] = []
        self.residuals: dict[str, Array] = {}
        self.target = np.empty(0)

    def run(self) -> None:
        """Turn until scale and current have settled, or the limit is reached."""
        current = not self.data.drive.measured_twice and bool(self.effects)
        turns = _TURNS if "gravity" in self.data.drive.open or current else 1
        for _ in range(turns):
            moved = self._follow() if current else 0.0
            self.change = max(abs(self._turn()), moved)
            if self.change < _SETTLED:
                return

    def _follow(self) -> float:
        """Take the current that the last turn asks for; return the RMS of what it changed by, relative."""
        before = self.current
        if before is None:
            self.current = self.data.signals.values["i"]
            return np.inf
        self.current = self._model_current()
        return float(np.linalg.norm(self.current - before) / np.linalg.norm(self.current))

    def _model_current(self) -> Array:
        """The current (samples,) that the model of the last turn asks for [A at the scale of the fit]."""
        emitted = self.emitted()
        quiet = self.values | {q.name: 0.0 for effect, _ in self.effects for q in effect.coefficients}
        effect = emitted.samples("mechanical", self.values, self.current)
        effect = effect - emitted.samples("mechanical", quiet, self.current)
        columns = self.data.signals.open
        offset = columns["offset"] * self.offset / (self.scale or 1.0) if "offset" in columns else 0.0
        rest = emitted.samples("mechanical", quiet) + effect - offset
        return emitted.inputs["i"] - rest / self.values["k_i"]

    def emitted(self, model: Model | None = None, shapes: Mapping[str, float] | None = None) -> Emitted:
        """The module of a model under the present values."""
        given = self.shapes if shapes is None else shapes
        return Emitted(model or self.model, self.data, given, self.values, self.scale)

    def _turn(self) -> float:
        """Solve, put the solution into the values, return what the free gravity column still wants."""
        drive, emitted = self.data.drive, self.emitted()
        self.solved = []
        if drive.measured_twice:
            names, limits = _coefficients(self.effects, "electrical")
            rows = self.data.rows.train & self._usable()
            if names:
                self.solved.append(self._solve(emitted, "electrical", names, limits, {}, rows)[0])
                self._take(self.solved[-1])
            both = True
        else:
            both = False
        names, limits = _coefficients(self.effects, "mechanical")
        count = len(self.fitted) + len(names)
        if drive.by_voltage:
            more = _coefficients(self.effects, "electrical")
            names, limits = names + more[0], limits + more[1]
        letters = [n for n in drive.open if n in ("J_m", "T_load")]
        names = [*self.fitted, *names, *letters]
        limits = [(0.0, None)] * len(self.fitted) + limits
        limits += [(0.0 if n == "J_m" else None, None) for n in letters]
        rows, columns = self.data.rows, self.data.signals.open
        outside = {n: rows.mean(-x) for n, x in columns.items() if n not in letters}
        solved, rest = self._solve(emitted, "mechanical", names, limits, outside, self.train)
        # By its columns, since Parameters refuse what is negative without bounds.
        self.residuals = {"mechanical": rest - solved.design @ solved.coefficients}
        self.target = self.residuals["mechanical"] + solved.design[:, :count] @ solved.coefficients[:count]
        self.solved.append(solved)
        change = self._take(solved)
        if both:
            allowed = {n: max(x, 0.0) if n in self.every else x for n, x in self.values.items()}
            self.residuals["electrical"] = emitted.residual("electrical", allowed)
        return change

    def _usable(self) -> Array:
        return self.data.rows.mean(self.data.drive.channels.usable.astype(float)) > 0.5

    def _solve(
        self,
        emitted: Emitted,
        balance: str,
        names: list[str],
        limits: Limits,
        outside: dict[str, Array],
        rows: Array,
    ) -> tuple[Solved, Array]:
        """Solve a balance on these rows; and its residual (rows,) with all the unknowns at zero.

        It is linear in them: unit steps of the emitted function give its columns.
        """
        start = self.values | dict.fromkeys(names, 0.0)
        rest = emitted.residual(balance, start)
        there = rest if self.current is None else emitted.residual(balance, start, self.current)
        steps = [there - emitted.residual(balance, {**start, n: 1.0}, self.current) for n in names]
        # What is outside the module: gravity, back-EMF and offset, against the drive.
        steps += [-column for column in outside.values()]
        limits = limits + [(None, None)] * len(outside)
        design = np.column_stack(steps)
        # An inertia is never negative, whatever a friction coefficient has to imitate.
        kept = [self.bounds or name == "J_m" for name in (*names, *outside)]
        low = np.array([-np.inf if a is None or not k else a for (a, _), k in zip(limits, kept, strict=True)])
        high = np.array([np.inf if b is None or not k else b for (_, b), k in zip(limits, kept, strict=True)])
        found = bounded(design[rows], rest[rows], low, high)
        held = np.where(found.active < 0, low, np.where(found.active > 0, high, found.coefficients))
        solved = Solved(balance, (*names, *outside), held, low, high, found.active, design, rows)
        return solved, rest

    def _take(self, solved: Solved) -> float:
        """Put a solution into the values; what is outside the module changes scale, back-EMF and offset."""
        found = dict(zip(solved.names, map(float, solved.coefficients), strict=True))
        gravity = found.pop("gravity", 0.0)
        emf, offset = found.pop("back_emf", 0.0), found.pop("offset", 0.0)
        self.zero = found.pop("zero_angle", 0.0)
        adjusts = self.data.drive.adjusts
        scale = self.scale or 1.0
        if emf:
            self.values["k_e"] += emf * scale
        self.offset = offset * scale
        # All of a scaled solution is too large by the same factor.
        factor = 1.0 + gravity if adjusts == "scale" else 1.0
        self.values |= {n: x / factor for n, x in found.items()}
        if (rotor := self.data.drive.rotor) is not None and "J_m" in found:
            # The column is that of all inertia; what is beyond the known rotor is the link's.
            link = self.values["J_l"] + (self.values["J_m"] - rotor) / self.values["mu"] ** 2
            self.values |= {"J_m": rotor, "J_l": max(link, 0.0)}
        if adjusts == "scale" and self.scale is not None:
            self.scale *= factor
            self._scaled()
        elif gravity:
            self.values[adjusts] *= 1.0 + gravity
        return gravity

    def _scaled(self) -> None:
        """Write the scale as the letters that it stands for."""
        if self.scale is not None and self.data.drive.by_voltage:
            self.values |= {"k_i": 1.0, "R": self.scale}
        elif self.scale is not None:
            self.values["k_i"] = 1.0 / self.scale


def _coefficients(effects: tuple[tuple[Effect, Values], ...], balance: str) -> tuple[list[str], Limits]:
    """Names and bounds of the coefficients of the effects that a balance shows."""
    own = [effect for effect, _ in effects if effect.balance == balance]
    names = [q.name for effect in own for q in effect.coefficients]
    return names, [limit for effect in own for limit in effect.bounds]
