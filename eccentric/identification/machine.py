"""Motor, armature and inertia as numbers: the model's own balances, solved and evaluated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.model import Model, function_of, meaning
from eccentric.model import vocabulary as v
from eccentric.rigs import AddedMass

Array = NDArray[np.float64]
Values = Mapping[str, float]
Carried = Sequence[tuple[NDArray[np.bool_], AddedMass]]
"""Masses that some runs carry, each with its rows (n,)."""


def evaluated(expression: sp.Expr, given: Mapping[str, Any]) -> Any:
    """An expression at values or arrays (n,) of its inputs and parameters, by name.

    Raises KeyError if one is missing.
    """
    function, arguments = function_of(meaning(expression))
    return function(*(given[name] for name in arguments))


class Machine:
    """What the balances of a model say about its motor, armature and inertia.

    `values` are parameters by the paper's letters, in SI units; signals are arrays (n,) or numbers. A letter
    that an expression needs and that is not among them is a KeyError.
    """

    def __init__(self, model: Model) -> None:
        self._model = model

    def torque(self, values: Values, current: Any) -> Any:
        """Motor torque [N m] of a current [A]: the drive term of the mechanical balance, k_i i."""
        return evaluated(self._drive, {**values, "i": current})

    def current_of_torque(self, values: Values, torque: Any) -> Any:
        """The current [A] for a motor torque [N m]."""
        return torque / evaluated(self._torque_constant, values)

    def current(self, values: Values, voltage: Any, omega_m: Any) -> Any:
        """The current [A] from the electrical balance, (u - k_e omega_m)/R."""
        return evaluated(self._armature, {**values, "u": voltage, "omega_m": omega_m})

    def voltage(self, values: Values, current: Any, omega_m: Any) -> Any:
        """The voltage [V] of a current, from the electrical balance, R i + k_e omega_m."""
        return evaluated(self._voltage, {**values, "i": current, "omega_m": omega_m})

    @cached_property
    def back_emf_damping(self) -> sp.Expr:
        """Damping by the back-EMF, in parameters [N m s/rad]: k_i k_e/R."""
        return -sp.diff(self._drive.xreplace({v.i.symbol: self._armature}), v.omega_m.symbol)

    def damping(self, values: Values) -> float:
        """Torque that the back-EMF takes per speed [N m s/rad]: k_i k_e/R."""
        return float(evaluated(self.back_emf_damping, values))

    @cached_property
    def torque_letters(self) -> frozenset[str]:
        """The parameters that the torque of a current is proportional to: k_i."""
        return self._factors("mechanical", "drive")

    @cached_property
    def resistance_letters(self) -> frozenset[str]:
        """The parameters that the resistive voltage is proportional to: R."""
        return self._factors("electrical", "resistive")

    @cached_property
    def back_emf_letters(self) -> frozenset[str]:
        """The parameters that the back-EMF is proportional to: k_e."""
        return self._factors("electrical", "back_emf")

    def _factors(self, balance: str, kind: str) -> frozenset[str]:
        """The parameters that the terms of a derivation are proportional to, and that are not of a body."""
        model = self._model
        added = {t.name for e in model.extensions for terms in e.change.terms.values() for t in terms}
        terms = (t for t in model.balance(balance).terms if t.kind == kind and t.name not in added)
        own = model.expand(sp.Add(*(term.value for term in terms)))
        body = model.expand(model.balance("mechanical").sum_of("inertial", "gravity"))
        letters = {q.symbol for q in model.parameters} & (own.free_symbols - body.free_symbols)
        return frozenset(x.name for x in letters if sp.expand(sp.diff(own, x) * x - own) == 0)

    @property
    def absent(self) -> dict[str, float]:
        """Values for parameters without effect on a log: the emitted functions require numbers."""
        one = dict.fromkeys(self.torque_letters | self.resistance_letters, 1.0)
        return one | dict.fromkeys((*self.back_emf_letters, *self.inertias), 0.0)

    @property
    def inertia_letters(self) -> frozenset[str]:
        """The parameters of the inertia: J_m, J_l, mu."""
        return frozenset(symbol.name for symbol in self._model.inertia.free_symbols)

    @cached_property
    def inertias(self) -> tuple[str, ...]:
        """The inertias that the total is linear in, J_m, J_l; those without a default first."""
        slopes = self._inertia_slopes.items()
        return tuple(name for name, slope in slopes if name not in {s.name for s in slope.free_symbols})

    @cached_property
    def rotor(self) -> str:
        """The parameter of the inertia on the motor's side, J_m: one of it is one of the total."""
        return next(name for name in self.inertias if self._inertia_slopes[name] == 1)

    @cached_property
    def link(self) -> str:
        """The parameter of the inertia behind the gear, J_l, in which the total is linear; "" if none.

        Also "" where a correction scales the whole inertia: then no parameter is the rotor alone.
        """
        rotors = [name for name in self.inertias if self._inertia_slopes[name] == 1]
        return next((name for name in self.inertias if rotors and name not in rotors), "")

    def inertia(self, values: Values) -> float:
        """The total inertia at the motor [kg m^2]: J_m + mu^2 J_l."""
        return float(evaluated(self._model.inertia, values))

    def inertia_along(self, values: Values, carried: Carried) -> Any:
        """The same along a log with masses that some runs carry: a number without any, else (n,)."""
        found: Any = self.inertia(values)
        for rows, added in carried:
            found = np.where(rows, self.inertia(self.carrying(values, added)), found)
        return found

    def carrying(self, values: Values, added: AddedMass) -> dict[str, float]:
        """The values with a mass on the link; what is relative to a declared value remains a part of that."""
        whole = {**values, **added.on(values)}
        parts = {
            q.name: values[q.name] * self.part(q.part_of, values, whole)
            for q in self._model.parameters
            if q.part_of is not None and values.get(q.name)
        }
        return whole | parts

    def part(self, declared: sp.Symbol, values: Values, whole: Values) -> float:
        """A declared quantity over the same with more mass; 1 where both are 0."""
        own, all_of_it = (float(evaluated(self._model.expand(declared), given)) for given in (values, whole))
        return own / all_of_it if all_of_it else 1.0

    def along(self, values: Values, carried: Carried) -> dict[str, Array]:
        """What differs along a log where some runs carry more mass: parameter -> (n,); nothing without."""
        found: dict[str, Array] = {}
        for rows, added in carried:
            for name, value in self.carrying(values, added).items():
                before = values.get(name, 0.0)
                if value != before:
                    found[name] = np.where(rows, value, found.get(name, before))
        return found

    def inertia_per(self, letter: str, values: Values) -> float:
        """Its derivative by one of them: 1, mu^2."""
        return float(evaluated(self._inertia_slopes[letter], values))

    def shared(self, values: Values, rotor: float) -> dict[str, float]:
        """The inertias of the same total with a known rotor: what is left of it is the link's, 0 at least."""
        beyond = self.inertia(values) - self.inertia({**values, self.rotor: rotor, self.link: 0.0})
        return {self.rotor: rotor, self.link: max(beyond / self.inertia_per(self.link, values), 0.0)}

    @cached_property
    def _drive(self) -> sp.Expr:
        return self._model.expand(self._model.balance("mechanical").sum_of("drive"))

    @cached_property
    def _torque_constant(self) -> sp.Expr:
        return sp.diff(self._drive, v.i.symbol)

    @cached_property
    def _armature(self) -> sp.Expr:
        return self._model.expand(self._model.balance("electrical").solved_for(v.i.symbol))

    @cached_property
    def _voltage(self) -> sp.Expr:
        return self._model.expand(self._model.balance("electrical").solved_for(v.u.symbol))

    @cached_property
    def _inertia_slopes(self) -> dict[str, sp.Expr]:
        inertia = self._model.inertia
        own = [q for q in self._model.parameters if q.symbol in inertia.free_symbols]
        own.sort(key=lambda q: q.default is not None)
        return {q.name: sp.diff(inertia, q.symbol) for q in own}
