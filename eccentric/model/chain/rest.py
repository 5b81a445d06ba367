"""Friction at rest in an arm: the mass matrix, and a time step for the set-valued friction of all joints.

M (omega_m' - omega_m) = dt (torque - f), with the friction f of every joint between its levels at rest and
that of its direction in motion, has a unique solution: the minimum of the convex function E of omega_m' whose
gradient is M (omega_m' - omega_m) - dt (torque - f). A sweep minimises E joint by joint (Gauss-Seidel), by
the step of a single joint with the others fixed. So a joint at rest stays at exactly 0.

Sweeps alone converge slowly if the joints are strongly coupled. So each round consists of two sweeps and an
exact solution for the moving joints, in the directions found by the sweeps, with a line search that minimises
E on the way there, past joints that reverse. No part of a round increases E, and once the directions are
correct the solution is exact. There are as many rounds as joints, and a final sweep: at most three sweeps per
joint.

(M. Silcowitz, S. Niebe, K. Erleben, "A nonsmooth nonlinear conjugate gradient method for interactive contact
force problems", The Visual Computer 26, 2010, also alternate sweeps and solutions.)
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import sympy as sp

from eccentric.model import vocabulary as v
from eccentric.model.chain.recursion import Recursion
from eccentric.model.output import Assignment, differentiate, needed
from eccentric.model.rest import Levels, NamedSteps, Side, chosen
from eccentric.model.steps import AtZero, Bounded, ByDirection, Forward, Gated, Magnitude, Shrunk

Matrix = Sequence[Sequence[sp.Expr]]
Results = tuple[tuple[str, sp.Expr], ...]

_ZERO, _ONE = sp.Integer(0), sp.Integer(1)
# Least divisor and largest unknown: then nothing overflows, even if rounding makes the matrix singular. Both
# are beyond any drive, in SI: inertia, energy; velocity, acceleration.
_LEAST = sp.Rational(1, 2**50)
_MOST = sp.Integer(2**40)
_STEEPEST = sp.Integer(2**20)
"""Largest elimination factor: the root of the largest ratio of two inertias on the motor side."""


def mass_matrix(
    recursion: Recursion, definitions: Iterable[Assignment], torques: Iterable[sp.Expr]
) -> tuple[tuple[Assignment, ...], Matrix]:
    """Definitions and the inertia on the motor side: the derivatives of the torques by the accelerations.

    It is symmetric: the lower triangle, whose forces pass through fewer joints, is computed and mirrored.
    """
    by = [inputs.alpha_m.symbol for inputs in recursion.inputs]
    wanted = [Assignment(sp.Symbol(f"moving_{j}", real=True), torque) for j, torque in enumerate(torques)]
    steps = needed((*definitions, *wanted), [a.target for a in wanted])
    steps, slopes = differentiate(steps, by)
    lower = [[slopes.get((a.target, x), _ZERO) for x in by[: j + 1]] for j, a in enumerate(wanted)]
    n = range(len(by))
    return steps, [[lower[max(j, k)][min(j, k)] for k in n] for j in n]


def still(
    recursion: Recursion, definitions: Iterable[Assignment], results: Results, parameters: Iterable[sp.Symbol]
) -> tuple[tuple[Assignment, ...], Results]:
    """Definitions and results without velocities and accelerations.

    Values that then depend on parameters only get a separate name, since they are constants, unlike those of
    the same name in other functions.
    """
    fixed, known = set(parameters), dict(recursion.standing)

    def folded(value: sp.Expr) -> sp.Expr:
        value = value.xreplace(known)
        value = value.replace(lambda e: isinstance(e, Gated) and _ZERO in e.args, lambda _: _ZERO)
        return value.replace(
            lambda e: isinstance(e, Magnitude) and _ZERO in e.args, lambda e: sp.Abs(sp.Add(*e.args))
        )

    remaining = []
    for a in definitions:
        value = folded(a.value)
        if value.is_Atom or (-value).is_Symbol:
            known[a.target] = value
            continue
        target = a.target
        if value.free_symbols <= fixed:
            target = sp.Symbol(f"{a.target.name}_at_rest", **a.target.assumptions0)
            known[a.target] = target
            fixed.add(target)
        remaining.append(replace(a, target=target, value=value))
    return tuple(remaining), tuple((label, folded(value)) for label, value in results)


@dataclass(frozen=True)
class _Piece:
    """A linear piece of the law in one direction: level + slope velocity."""

    level: sp.Expr
    slope: sp.Expr


@dataclass(frozen=True)
class _Law:
    """Friction in both directions: the first piece applies at rest.

    During presliding there is a second one, and friction is the smaller of both.
    """

    forward: tuple[_Piece, ...]
    backward: tuple[_Piece, ...]

    @property
    def width(self) -> sp.Expr:
        """Difference of the levels at rest."""
        return self.forward[0].level - self.backward[0].level


def _laws(named: NamedSteps, levels: Sequence[Levels]) -> list[_Law]:
    """The friction laws of all joints in a time step."""
    dt = v.dt.symbol
    laws = []
    for j, found in enumerate(levels):
        sides = named.sides(found, f"_{j}")

        def pieces(side: Side, end: str, j: int = j, found: Levels = found) -> tuple[_Piece, ...]:
            def by_time(name: str, value: sp.Expr) -> sp.Expr:
                return named(f"{name}_{end}_{j}", dt * value)

            slid = _Piece(by_time("level", side.dry), by_time("damped", side.viscous))
            if not found.presliding:
                return (slid,)
            bent = side.damping + side.stiffness
            return _Piece(by_time("held_level", side.held), by_time("bent", bent)), slid

        forward, backward = sides
        laws.append(_Law(pieces(forward, "forward"), pieces(backward, "backward")))
    return laws


class _Solved:
    """The unknowns x of M x + f = momentum, with f by the laws; `start` is the initial value."""

    def __init__(
        self,
        named: NamedSteps,
        inertia: Matrix,
        laws: Sequence[_Law],
        momentum: Sequence[sp.Expr],
        start: Sequence[sp.Expr],
    ) -> None:
        self._named, self._M, self._laws, self._momentum = named, inertia, laws, momentum
        self._n = range(len(laws))
        self.x = list(start)
        self._pieces = [law.forward[0] for law in laws]
        self._count = 0
        for _ in self._n if len(laws) > 1 else ():
            self._sweep()
            self._sweep()
            self._solve()
        self._sweep()

    def friction(self, j: int) -> sp.Expr:
        """Friction of joint j: at rest the value that balances it, within its levels."""
        law, piece = self._laws[j], self._pieces[j]
        sticking = self._name("held", j, self._remaining(j))
        if len(self._laws) > 1:
            sticking = sp.Max(law.backward[0].level, sp.Min(law.forward[0].level, sticking))
        return AtZero(self.x[j], sticking, piece.level + piece.slope * self.x[j])

    def _remaining(self, j: int) -> sp.Expr:
        """The momentum of joint j minus the coupling with the other joints."""
        return self._momentum[j] - sp.Add(*(self._M[j][k] * self.x[k] for k in self._n if k != j))

    def _name(self, name: str, j: int, value: sp.Expr) -> sp.Expr:
        return self._named(f"{name}_{j}_{self._count}", value)

    def _sweep(self) -> None:
        self._count += 1
        for j in self._n:
            self.x[j], piece = self._alone(j, self._name("left", j, self._remaining(j)))
            level, slope = self._name("level", j, piece.level), self._name("slope", j, piece.slope)
            self._pieces[j] = _Piece(level, slope)

    def _alone(self, j: int, momentum: sp.Expr) -> tuple[sp.Expr, _Piece]:
        """The step of joint j with this momentum, a soft threshold, and the active piece of its law."""
        law = self._laws[j]
        ends: list[sp.Expr] = []
        pieces: list[_Piece] = []
        for k, (ahead, back) in enumerate(zip(law.forward, law.backward, strict=True)):
            over = self._name(f"excess{k or ''}", j, Shrunk(momentum, back.level, ahead.level))
            slope = chosen(over, ahead.slope, back.slope)
            end = over / _at_least(self._name("inertia", j, self._M[j][j] + slope))
            ends.append(self._name(f"end{k or ''}", j, _within(end)))
            pieces.append(_Piece(chosen(over, ahead.level, back.level), slope))
        if len(ends) == 1:
            return ends[0], pieces[0]
        # The smaller friction gives the greater speed; the joint is at rest if the first piece sticks.
        (bent, slid), (first, second) = ends, pieces
        speed = self._name("faster", j, sp.Abs(slid) - sp.Abs(bent))
        slides = self._name("slides", j, AtZero(bent, _ZERO, Forward(speed)))
        level, slope = (
            ByDirection(slides, x, y) for x, y in ((second.level, first.level), (second.slope, first.slope))
        )
        return self._name("velocity", j, ByDirection(slides, slid, bent)), _Piece(level, slope)

    def _solve(self) -> None:
        """The exact solution for the moving joints, with a line search of E on the way there."""
        n, name, x = self._n, self._name, self.x
        moves = [name("moves", j, AtZero(x[j], _ZERO, _ONE)) for j in n]
        diagonal = [self._M[j][j] + self._pieces[j].slope for j in n]
        lacks = [
            name("lacks", j, moves[j] * (self._remaining(j) - self._pieces[j].level - diagonal[j] * x[j]))
            for j in n
        ]
        # L D L^T of the matrix without the rows and columns of joints at rest.
        lower: dict[tuple[int, int], sp.Expr] = {}
        above: dict[tuple[int, int], sp.Expr] = {}
        pivots = []
        for j in n:
            before = sp.Add(*(lower[j, k] * above[j, k] for k in range(j)))
            pivots.append(name("pivot", j, _at_least(name("diagonal", j, diagonal[j] - before))))
            for i in n[j + 1 :]:
                eliminated = sp.Add(*(lower[i, k] * above[j, k] for k in range(j)))
                above[i, j] = name(f"above_{i}", j, moves[i] * moves[j] * self._M[i][j] - eliminated)
                lower[i, j] = name(f"lower_{i}", j, Bounded(above[i, j] / pivots[j], _STEEPEST))
        down = []
        for j in n:
            down.append(name("down", j, lacks[j] - sp.Add(*(lower[j, k] * down[k] for k in range(j)))))
        scaled = [name("scaled", j, _within(down[j] / pivots[j])) for j in n]
        way: dict[int, sp.Expr] = {}
        for j in reversed(n):
            way[j] = name("way", j, scaled[j] - sp.Add(*(lower[k, j] * way[k] for k in n[j + 1 :])))
        gained = name("gained", 0, sp.Add(*(down[j] * scaled[j] for j in n)))
        part = self._part(way, gained)
        self.x = [name("on_the_way", j, x[j] + part * way[j]) for j in n]

    def _part(self, way: Mapping[int, sp.Expr], gained: sp.Expr) -> sp.Expr:
        """Step length to the minimum of E, whose slope is gained (part - 1), and steeper past reversals."""
        n, name, x = self._n, self._name, self.x
        after = [name("after", j, x[j] + way[j]) for j in n]
        # Where a joint reverses: the way is divided in the ratio of the speeds before and after.
        turns = [name("turns", j, x[j] * after[j]) for j in n]
        places = [
            name(
                "place",
                j,
                ByDirection(-turns[j], sp.Abs(x[j]) / _at_least(sp.Abs(x[j]) + sp.Abs(after[j])), _ONE),
            )
            for j in n
        ]
        steeper = [name("steeper", j, sp.Abs(way[j]) * self._laws[j].width) for j in n]
        stops = []
        for j in n:
            so_far = sp.Add(
                *(ByDirection(places[k] - places[j], _ZERO, steeper[k]) for k in n if k != j), steeper[j]
            )
            so_far = name("so_far", j, so_far)
            level = _ONE - so_far / sp.Max(_at_least(gained), so_far)
            stops.append(name("stop", j, ByDirection(-turns[j], sp.Max(places[j], level), _ONE)))
        return name("part", 0, sp.Min(_ONE, *stops))


def _at_least(value: sp.Expr) -> sp.Expr:
    return sp.Max(_LEAST, value)


def _within(value: sp.Expr) -> sp.Expr:
    return Bounded(value, _MOST)


def _torques(recursion: Recursion) -> list[sp.Symbol]:
    return [sp.Symbol(f"torque_{j}", real=True) for j in range(len(recursion.inputs))]


Stepped = tuple[tuple[Assignment, ...], Results]


def step(recursion: Recursion, named: NamedSteps, inertia: Matrix, levels: Sequence[Levels]) -> Stepped:
    """Velocities after a time step and the friction torques in it, with intermediate assignments."""
    dt, joints = v.dt.symbol, range(len(levels))
    omega_m = [inputs.omega_m.symbol for inputs in recursion.inputs]
    momentum = [
        named(
            f"momentum_{j}",
            sp.Add(*(inertia[j][k] * omega_m[k] for k in joints)) + dt * torque,
            "momentum at the end of the step, if there were no friction [N m s]",
        )
        for j, torque in enumerate(_torques(recursion))
    ]
    solved = _Solved(named, inertia, _laws(named, levels), momentum, omega_m)
    friction = [named(f"taken_{j}", solved.friction(j)) for j in joints]
    results = [(omega_m[j].name, solved.x[j]) for j in joints]
    results += [(f"friction_{j}", friction[j] / dt) for j in joints]
    return tuple(named.listed), tuple(results)


def acceleration(
    recursion: Recursion, named: NamedSteps, inertia: Matrix, levels: Sequence[Levels]
) -> Stepped:
    """Accelerations by the torques; 0 for joints that stick within their levels."""
    laws = []
    for j, (inputs, level) in enumerate(zip(recursion.inputs, levels, strict=True)):
        omega_m = inputs.omega_m.symbol
        forward, backward = named.sides(level, f"_{j}")
        dry = chosen(omega_m, forward.held, backward.held)
        moving = named(f"in_motion_{j}", dry + omega_m * chosen(omega_m, forward.damping, backward.damping))
        ends = ((forward.held, "highest"), (backward.held, "lowest"))
        pieces = [(_Piece(named(f"{end}_{j}", AtZero(omega_m, at, moving)), _ZERO),) for at, end in ends]
        laws.append(_Law(*pieces))
    start = [_ZERO for _ in levels]
    solved = _Solved(named, inertia, laws, _torques(recursion), start)
    return tuple(named.listed), tuple((f"alpha_m_{j}", x) for j, x in enumerate(solved.x))
