"""Load a derivation by name or path: a script with a module-level `model`."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import sympy as sp

from eccentric.core import (
    InputError,
    asks,
    derivation,
    derived,
    folder,
    loads_behind,
    meant,
    remember_loads,
    run_script,
)
from eccentric.model.axis import LINEAR, AxisKind
from eccentric.model.functions import from_bytes, to_bytes
from eccentric.model.model import Model
from eccentric.model.quantity import Quantity

_BESIDE = frozenset({"serial_chain", "linear_axis", "screw_axis"})
"""Derivations other than of the paper's drive: several joints, and a carriage."""

_loaded: dict[Path, Model] = {}
_loading: list[Path] = []


def model_names() -> tuple[str, ...]:
    """Names of the bundled derivations of the paper's drive, in alphabetical order."""
    names = (path.stem for path in folder("derivations").glob("*.py") if not path.stem.startswith("_"))
    return tuple(sorted(set(names) - _BESIDE))


def load_model(name_or_path: str | os.PathLike[str]) -> Model:
    """Load the model of a derivation, given by a name such as "c2_parallel" or the path of a script.

    A script is executed once; further calls return the same object. The models of bundled derivations are
    cached until a source of the toolkit changes.

    Raises:
        InputError: there is no such derivation, scripts load each other in a circle, the script raises an
            error or has no Model named `model`.
    """
    path = _find(name_or_path)
    asks(str(name_or_path), path)
    if path in _loaded:
        return _loaded[path]
    if path in _loading:
        circle = " -> ".join(p.stem for p in [*_loading[_loading.index(path) :], path])
        raise InputError(path.name, problem=f"derivations load each other in a circle: {circle}")
    bundled = path.parent == folder("derivations").resolve()
    if bundled and (cached := derived.get(f"model {path.stem}")) is not None:
        _loaded[path], loads = from_bytes(cached)
        remember_loads(loads)
        return _loaded[path]
    _loading.append(path)
    try:
        module = run_script(path, f"eccentric_derivation_{path.stem}")
    except InputError:
        raise
    except Exception as error:
        raise InputError(
            path, problem=f"the derivation stopped with {type(error).__name__}: {error}"
        ) from error
    finally:
        _loading.pop()
    model = getattr(module, "model", None)
    if not isinstance(model, Model):
        raise InputError(path, "a module-level `model` of type Model", type(model).__name__)
    _loaded[path] = model
    if bundled:
        derived.put(f"model {path.stem}", to_bytes((model, loads_behind(path))))
    return model


def _find(name_or_path: str | os.PathLike[str]) -> Path:
    path = derivation(name_or_path)
    if not path.is_file():
        if Path(name_or_path).suffix == ".py":
            raise InputError(name_or_path, problem="no such derivation script")
        known = (*model_names(), LINEAR.model, LINEAR.screw)
        raise InputError(
            f"model {str(name_or_path)!r} is unknown; known are {', '.join(known)}, or a path.py"
            + meant(name_or_path, known)
        )
    return path


T = TypeVar("T")

_RIGHT_ANGLE = 1.5707964  # also one that was rounded up to single precision
_SMALLEST, _LARGEST = 1e-12, 1e12
"""Smallest positive and largest parameter: beyond them products would leave the range of single precision."""


def _require_valid(q: Quantity, value: float, where: str) -> None:
    """Raise InputError for a value outside a parameter's domain or the range of the emitted C."""
    if (q.domain == "positive" and value <= 0) or (q.domain in {"nonnegative", "tilt"} and value < 0):
        raise InputError(where, f"a {q.domain} number", f"{value!r}")
    if q.domain == "tilt" and value > _RIGHT_ANGLE:
        raise InputError(where, "an angle from 0 to pi/2", f"{value!r}")
    if abs(value) > _LARGEST or (q.domain == "positive" and value < _SMALLEST):
        sizes = f"of size {_SMALLEST:g} to" if q.domain == "positive" else "of size up to"
        raise InputError(where, f"a number {sizes} {_LARGEST:g}", f"{value!r}")


def in_general_letters(values: Mapping[str, T], axis: AxisKind, source: str) -> dict[str, T]:
    """Values by the symbols of a rotary drive, from ones by these or by the names of their axis.

    Raises:
        InputError: two names denote one parameter.
    """
    general = [axis.general(letter) for letter in values]
    if twice := [letter for letter in values if general.count(axis.general(letter)) > 1]:
        raise InputError(f"{source}: parameters", "each", " and ".join(twice), why="only once")
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
    caution: str = "",
    fits_the_rig: bool = True,
) -> Model:
    """Return the model under a new name, with these values as its defaults.

    Args:
        model: the model.
        values: parameter by the paper's symbol, or the axis's name -> value in SI units.
        name: of the result.
        notes: parameter -> note for its comment, such as its interval.
        title: of the result, by default the model's.
        source: where the values come from, for error messages.
        back_emf_in_friction: whether the values of viscous friction contain the back-EMF.
        current_known: whether the values give a current in amperes; a voltage may determine R/k_i alone.
        voltage_known: whether the values give a voltage; a current alone determines neither R nor k_e.
        torque_unit: of the values: "N m", or "V" or "A" without a scale for a torque.
        caution: what to know before the model is used; by default the model's.
        fits_the_rig: whether the log of the values fits its rig.

    Raises:
        InputError: a value does not belong to a parameter of the model, or has an invalid sign.
    """
    axis = model.axis
    known = {q.name: axis.named(q.name) for q in model.parameters}
    if unknown := sorted(letter for letter in values if axis.general(letter) not in known):
        raise InputError(
            source,
            problem=f"parameters.{unknown[0]}: {model.name} has no such parameter;"
            f" it has {', '.join(known.values())}",
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
        defaults="fitted values; see the comment on each parameter" if notes else "values as given",
        back_emf_in_friction=back_emf_in_friction,
        current_known=current_known,
        voltage_known=voltage_known,
        torque_unit=torque_unit,
        caution=caution or model.caution,
        # Values of a log that fits its rig clear the flag once they cover all parameters.
        fits_the_rig=fits_the_rig
        and (model.fits_the_rig or {q.name for q in model.parameters} <= set(values)),
    )
