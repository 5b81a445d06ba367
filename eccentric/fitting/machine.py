"""Motor, armature and inertia as numbers: the model's own balances, solved and evaluated."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import sympy as sp

from eccentric.fitting.expressions import evaluated
from eccentric.model import Model
from eccentric.model import vocabulary as v

__all__ = ["Machine"]

Values = Mapping[str, float]


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

    def back_emf(self, values: Values, omega_m: Any) -> Any:
        """Voltage of the turning motor [V], k_e omega_m."""
        return evaluated(self._back_emf, {**values, "omega_m": omega_m})

    @cached_property
    def back_emf_damping(self) -> sp.Expr:
        """Damping by the back-EMF, in parameters [N m s/rad]: k_i k_e/R."""
        return -sp.diff(self._drive.xreplace({v.i.symbol: self._armature}), v.omega_m.symbol)

    def damping(self, values: Values) -> float:
        """Torque that the back-EMF takes per speed [N m s/rad]: k_i k_e/R."""
        return float(evaluated(self.back_emf_damping, values))

    @property
    def inertia_letters(self) -> frozenset[str]:
        """The parameters of the inertia: J_m, J_l, mu."""
        return frozenset(symbol.name for symbol in self._model.inertia.free_symbols)

    @cached_property
    def rotor(self) -> str:
        """The parameter of the inertia on the motor's side, J_m: one of it is one of the total."""
        return next(name for name, slope in self._inertia_slopes.items() if slope == 1)

    @cached_property
    def link(self) -> str:
        """The parameter of the inertia behind the gear, J_l: the total is linear in it as well."""
        linear = (n for n, e in self._inertia_slopes.items() if n not in {s.name for s in e.free_symbols})
        return next(name for name in sorted(linear) if name != self.rotor)

    def inertia(self, values: Values) -> float:
        """The total inertia at the motor [kg m^2]: J_m + mu^2 J_l."""
        return float(evaluated(self._model.inertia, values))

    def inertia_per(self, letter: str, values: Values) -> float:
        """Its derivative by one of them: 1, mu^2."""
        return float(evaluated(self._inertia_slopes[letter], values))

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
    def _back_emf(self) -> sp.Expr:
        return self._model.expand(self._model.balance("electrical").sum_of("back_emf"))

    @cached_property
    def _inertia_slopes(self) -> dict[str, sp.Expr]:
        inertia = self._model.inertia
        return {symbol.name: sp.diff(inertia, symbol) for symbol in inertia.free_symbols}
