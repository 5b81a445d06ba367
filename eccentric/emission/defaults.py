"""Fitted values as the defaults of an emitted trio, with their uncertainty and range as comments."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path

from eccentric.errors import InputError
from eccentric.model import Model
from eccentric.model.defaults import with_values


@dataclass(frozen=True)
class Fitted:
    """What a fit hands to emission.

    Attributes:
        source: name of the file, for error messages.
        model: name of the model that was fitted, None where the file names none.
        values: parameter by the paper's letter, in SI units.
        notes: parameter -> remark for its comment, such as its interval.
        identified_on: range of speeds and temperatures, for the head of the files.
    """

    source: str
    model: str | None
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
        what = "required the fit.json of `eccentric fit`, or JSON with `parameters` like it"
        raise InputError(f"{path}: {what}; got a file that is not JSON ({error})") from None
    values = content.get("parameters") if isinstance(content, dict) else None
    if not isinstance(values, dict) or not values:
        raise InputError(f"{path}: required an object `parameters` of numbers by the paper's letters")
    values = {name: value for name, value in values.items() if value is not None}
    for name, value in values.items():
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise InputError(f"{path}: parameters.{name}: required a finite number, got {value!r}")
    notes, identified_on = dict(content.get("parameter_notes", {})), str(content.get("identified_range", ""))
    return Fitted(path.name, content.get("model"), values, notes, identified_on)


def with_fitted(model: Model, fitted: Fitted, name: str) -> Model:
    """Return the model under a new name, with fitted values as its defaults.

    Raises:
        InputError: the values are those of another model, which would leave the rest at the paper's values; a
            value is of no parameter of the model, or of a sign that it cannot have.
    """
    if fitted.model not in (None, model.name):
        raise InputError(f"{fitted.source}: required a fit of {model.name}, got one of {fitted.model}")
    title = f"{model.title}; {fitted.identified_on}" if fitted.identified_on else model.title
    return with_values(model, fitted.values, name, fitted.notes, title, fitted.source)
