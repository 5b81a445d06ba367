"""A model with different defaults: fitted values in place of the paper's, with remarks for their comments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TypeVar

import sympy as sp

from eccentric.errors import InputError
from eccentric.model.axis import AxisKind
from eccentric.model.model import Model
from eccentric.model.quantity import Quantity

T = TypeVar("T")

_RIGHT_ANGLE = 1.5707964  # also one that was rounded up to single precision
_SMALLEST, _LARGEST = 1e-12, 1e12
"""Least positive parameter, and the largest of any: beyond them, products would leave single precision."""


def _require_valid(q: Quantity, value: float, where: str) -> None:
    """Raise InputError for a value outside the domain of a parameter, or of a size that the C cannot hold."""
    if (q.domain == "positive" and value <= 0) or (q.domain in {"nonnegative", "tilt"} and value < 0):
        raise InputError(f"{where}: a {q.domain} number is required, received {value!r}")
    if q.domain == "tilt" and value > _RIGHT_ANGLE:
        raise InputError(f"{where}: an angle from 0 to pi/2 is required, received {value!r}")
    if abs(value) > _LARGEST or (q.domain == "positive" and value < _SMALLEST):
        sizes = f"of size {_SMALLEST:g} to" if q.domain == "positive" else "of size up to"
        raise InputError(f"{where}: a number {sizes} {_LARGEST:g} is required, received {value!r}")


def in_general_letters(values: Mapping[str, T], axis: AxisKind, source: str) -> dict[str, T]:
    """Values by the letters of a turning drive, from ones by these or by the names of their axis.

    Raises:
        InputError: two names are of one parameter.
    """
    general = [axis.general(letter) for letter in values]
    if twice := [letter for letter in values if general.count(axis.general(letter)) > 1]:
        raise InputError(f"{source}: parameters: each is required only once, received {' and '.join(twice)}")
    return dict(zip(general, values.values(), strict=True))


def with_values(
    model: Model,
    values: Mapping[str, float],
    name: str,
    notes: Mapping[str, str] | None = None,
    title: str | None = None,
    source: str = "parameters",
    back_emf_in_friction: bool = False,
    current_known: bool = True,
    voltage_known: bool = True,
    torque_unit: str = "N m",
) -> Model:
    """Return the model under a new name, with these values as its defaults.

    Args:
        model: the model.
        values: parameter by the paper's letter, or the axis's own -> value in SI units.
        name: of the result.
        notes: parameter -> remark for its comment, such as its interval.
        title: of the result, by default the model's.
        source: where the values come from, for error messages.
        back_emf_in_friction: whether the values of viscous friction contain the back-EMF.
        current_known: whether the values give a current in amperes; a voltage may determine R/k_i alone.
        voltage_known: whether the values give a voltage; a current alone determines neither R nor k_e.
        torque_unit: of the values: "N m", or "V" or "A" without a scale for a torque.

    Raises:
        InputError: a value does not belong to a parameter of the model, or has an invalid sign.
    """
    axis = model.axis
    known = {q.name: axis.said(q.name) for q in model.parameters}
    if unknown := sorted(letter for letter in values if axis.general(letter) not in known):
        raise InputError(
            f"{source}: parameters.{unknown[0]}: {model.name} has no such parameter;"
            f" it has {', '.join(known.values())}"
        )
    values = in_general_letters(values, axis, source)
    notes = {axis.general(letter): note for letter, note in (notes or {}).items()}
    parameters = []
    for q in model.parameters:
        if q.name in values:
            value = values[q.name]
            _require_valid(q, value, f"{source}: parameters.{known[q.name]}")
            q = replace(q, default=sp.Rational(repr(float(value))))  # noqa: PLW2901 - the same letter
        note = notes.get(q.name)
        parameters.append(replace(q, meaning=f"{q.meaning}; {note}") if note else q)
    return replace(
        model,
        name=name,
        title=title or model.title,
        parameters=tuple(parameters),
        defaults="fitted values, with the remark of each parameter",
        back_emf_in_friction=back_emf_in_friction,
        current_known=current_known,
        voltage_known=voltage_known,
        torque_unit=torque_unit,
    )
