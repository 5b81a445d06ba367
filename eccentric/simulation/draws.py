"""Parameter sets drawn from the joint uncertainty of a fit, within the bounds of its values."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from eccentric.identification import TWO_SIDED, Estimate, Fit, Refit
from eccentric.simulation.limits import MOST_DRAWS

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Drawn:
    """How a parameter follows from a draw x of the fitted values: factor x[place] scale^power."""

    parameter: str
    place: int | None  # None for a factor alone
    factor: float = 1.0
    power: int = 0


@dataclass(frozen=True)
class Draws:
    """The joint uncertainty of k fitted values, and the parameters that follow from them."""

    values: Array  # fitted (k,)
    covariance: Array  # of their errors (k, k), 0 for a value at a bound
    lower: Array  # lower bounds (k,)
    upper: Array  # upper bounds (k,)
    reach: Array  # (k,) how far a value at a bound may be from it, 95 % interval; 0 for all others
    parameters: Mapping[str, float]  # those of the model as it was fitted
    drawn: tuple[Drawn, ...]  # those that follow from the values
    scale: int | None = None  # place of the scale of the drive among the values; None without one

    def without(self, names: Collection[str]) -> Draws:
        """The same without these parameters, such as those that are neither known nor identified."""
        parameters = {name: x for name, x in self.parameters.items() if name not in names}
        drawn = tuple(one for one in self.drawn if one.parameter not in names)
        return replace(self, parameters=parameters, drawn=drawn)

    def samples(self, count: int, seed: int) -> dict[str, Array]:
        """Parameter sets: name -> (count,).

        Errors are normal, so wide that 95 % of the draws of a value lie in its 95 % interval; draws outside
        the bounds are drawn again. A value at a bound goes from it in one direction.
        """
        random = np.random.default_rng(seed)
        spread = np.nan_to_num(self.covariance, nan=0.0, posinf=0.0) * (TWO_SIDED / ndtri(0.975)) ** 2
        found = np.tile(self.values, (count, 1))
        left = np.arange(count)
        for _ in range(MOST_DRAWS):
            if not len(left):
                break
            new = random.multivariate_normal(self.values, spread, len(left), check_valid="ignore")
            new = new + np.abs(random.standard_normal(new.shape)) * self.reach / ndtri(0.975)
            found[left] = new
            left = left[np.any((new < self.lower) | (new > self.upper), axis=1)]
        found = np.clip(found, self.lower, self.upper)
        scale = 1.0 if self.scale is None else found[:, self.scale]
        sets = {name: np.full(count, value) for name, value in self.parameters.items()}
        for one in self.drawn:
            x = 1.0 if one.place is None else found[:, one.place]
            sets[one.parameter] = np.broadcast_to(one.factor * x * scale**one.power, (count,)).copy()
        return sets


def draws_of_fit(found: Fit, parameters: Mapping[str, float]) -> Draws:
    """The draws of a fit, whose parameters are those that it is emitted with."""
    problem, estimates = found.problem, {**found.coefficients, **found.searched}
    drawn: list[Drawn] = []
    scale = next((k for k, c in enumerate(problem.coefficients) if c.role == "scale"), None)
    for k, c in enumerate(problem.coefficients):
        if c.role in {"friction", "inertia", "load"} and c.parameter in parameters:
            drawn.append(Drawn(c.parameter, k, power=-1 if scale is not None else 0))
    first = len(problem.coefficients)
    drawn += [Drawn(s.name, first + k) for k, s in enumerate(problem.nonlinear) if s.name in parameters]
    if scale is not None and problem.drive.by_voltage:
        known = problem.rig.known
        if "R" in known:
            drawn.append(Drawn("k_i", None, known["R"], -1))
        else:
            drawn.append(Drawn("R", None, parameters["k_i"], 1))
    elif scale is not None:
        drawn.append(Drawn("k_i", None, 1.0, -1))
    bounds = [(x.lower, x.upper) for x in (*problem.coefficients, *problem.nonlinear)]
    return _draws([*estimates.values()], found.spread.matrix, bounds, parameters, drawn, scale)


def draws_of_refit(found: Refit) -> Draws:
    """The draws of a fitted model, extended or not."""
    names, drawn, scale = list(found.estimates), list[Drawn](), None
    bounds = dict[str, tuple[float, float]]()
    for term in found.model.balance("mechanical").terms:
        low, high = term.bounds
        bounds[str(term.coefficient)] = (
            -math.inf if low is None else low,
            math.inf if high is None else high,
        )
    bounds |= {s.quantity.name: (s.low, s.high) for effect, _ in found.effects for s in effect.shapes}
    for k, name in enumerate(names):
        if name in found.values:
            drawn.append(Drawn(name, k))
        elif name == "R/k_i":
            scale, (torque, *_) = k, (*found.data.drive.machine.torque_letters, "")
            drawn.append(Drawn("R", None, found.values[torque], 1))
        elif name == "1/k_i":
            scale = k
            drawn += [Drawn(x, None, 1.0, -1) for x in found.data.drive.machine.torque_letters]
    positive = {"R/k_i", "1/k_i", *found.data.drive.machine.inertias, "k_e"}
    ends = [(0.0, math.inf) if n in positive else bounds.get(n, (-math.inf, math.inf)) for n in names]
    estimates = [*found.estimates.values()]
    return _draws(estimates, found.covariance, ends, found.values, drawn, scale)


def _draws(
    estimates: Sequence[Estimate],
    covariance: Array,
    bounds: Sequence[tuple[float, float]],
    parameters: Mapping[str, float],
    drawn: Sequence[Drawn],
    scale: int | None,
) -> Draws:
    reach = [
        0.0 if e.bound_active is None else e.interval[e.bound_active == "lower"] - e.value for e in estimates
    ]
    return Draws(
        np.array([e.value for e in estimates]),
        covariance,
        np.array([low for low, _ in bounds]),
        np.array([high for _, high in bounds]),
        np.array([x if math.isfinite(x) else 0.0 for x in reach]),
        dict(parameters),
        tuple(drawn),
        scale,
    )
