"""A model with different defaults: fitted values in place of the paper's, with remarks for their comments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import sympy as sp

from eccentric.errors import InputError
from eccentric.model.model import Model
from eccentric.model.quantity import Quantity

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


def with_values(
    model: Model,
    values: Mapping[str, float],
    name: str,
    notes: Mapping[str, str] | None = None,
    title: str | None = None,
    source: str = "parameters",
    back_emf_in_friction: bool = False,
    current_known: bool = True,
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
        torque_unit: of the values: "N m", or "V" or "A" without a scale for a torque.

    Raises:
        InputError: a value does not belong to a parameter of the model, or has an invalid sign.
    """
    axis = model.axis
    known = {q.name: axis.said(q.name) for q in model.parameters}
    own = {letter: letter if letter in known else axis.general(letter) for letter in values}
    if unknown := sorted(letter for letter, name in own.items() if name not in known):
        raise InputError(
            f"{source}: parameters.{unknown[0]}: {model.name} has no such parameter;"
            f" it has {', '.join(known.values())}"
        )
    if len(set(own.values())) < len(own):
        twice = " and ".join(letter for letter, name in own.items() if list(own.values()).count(name) > 1)
        raise InputError(f"{source}: parameters: each is required only once, received {twice}")
    values = {own[letter]: value for letter, value in values.items()}
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
        torque_unit=torque_unit,
    )
