"""Fitted values as the defaults of an emitted trio, with their uncertainty and range as comments."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace
from pathlib import Path

import sympy as sp

from eccentric.errors import InputError
from eccentric.model import Model


@dataclass(frozen=True)
class Fitted:
    """What a fit hands to emission.

    Attributes:
        source: name of the file, for error messages.
        values: parameter by the paper's letter, in SI units.
        notes: parameter -> remark for its comment, such as its interval.
        identified_on: range of speeds and temperatures, for the head of the files.
    """

    source: str
    values: dict[str, float]
    notes: dict[str, str]
    identified_on: str


def read_parameters(path: Path) -> Fitted:
    """Read the parameters of a fit from its fit.json.

    Raises:
        InputError: the file is missing, is not JSON, or has no `parameters` of finite numbers.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; required the fit.json of `eccentric fit`") from None
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: required JSON, got {error}") from None
    values = content.get("parameters") if isinstance(content, dict) else None
    if not isinstance(values, dict) or not values:
        raise InputError(f"{path}: required an object `parameters` of numbers by the paper's letters")
    values = {name: value for name, value in values.items() if value is not None}
    for name, value in values.items():
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise InputError(f"{path}: parameters.{name}: required a finite number, got {value!r}")
    return Fitted(path.name, values, dict(content.get("parameter_notes", {})), str(content.get("identified_range", "")))


def with_defaults(model: Model, fitted: Fitted | None, name: str) -> Model:
    """Return the model under a new name, with fitted values as its defaults.

    Raises:
        InputError: a value is of no parameter of the model, or of a sign that it cannot have.
    """
    if fitted is None:
        return replace(model, name=name)
    known = {q.name: q for q in model.parameters}
    if unknown := sorted(set(fitted.values) - set(known)):
        raise InputError(
            f"{fitted.source}: parameters.{unknown[0]}: {model.name} has no such parameter;"
            f" it has {', '.join(known)}"
        )
    parameters = []
    for q in model.parameters:
        if q.name not in fitted.values:
            parameters.append(q)
            continue
        value = fitted.values[q.name]
        if (q.domain == "positive" and value <= 0) or (q.domain == "nonnegative" and value < 0):
            raise InputError(
                f"{fitted.source}: parameters.{q.name}: required a {q.domain} number, got {value!r}"
            )
        note = fitted.notes.get(q.name)
        meaning = f"{q.meaning}; {note}" if note else q.meaning
        parameters.append(replace(q, default=sp.Rational(repr(float(value))), meaning=meaning))
    title = f"{model.title}; {fitted.identified_on}" if fitted.identified_on else model.title
    return replace(model, name=name, title=title, parameters=tuple(parameters))
