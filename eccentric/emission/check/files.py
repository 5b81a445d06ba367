"""Checks of an emitted C source for its user: a self-test with vectors, and a driver for a proof.

Everything comes from the emitted NumPy module by its public names, so that nothing here knows how a model is
evaluated.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import sympy as sp

from eccentric.emission.check import proof, selftest
from eccentric.emission.check.selftest import Called
from eccentric.emission.hot import executed
from eccentric.emission.templates import template
from eccentric.model import Model, spoken
from eccentric.model import vocabulary as v

# For parameters without a default, or with one that makes functions zero. Sine and cosine of this tilt are
# far from halfway between two numbers, so that every libm rounds them the same way.
_ASSUMED = {"J_m": 2e-4, "J_l": 0.04, "phi": 0.6}
_ELSE_ASSUMED = 0.25


def render_check(
    model: Model, files: Mapping[str, str], *, arrays: bool = True, joints: int = 0
) -> dict[str, str]:
    """The files that check a model's emitted C, file name -> text.

    Args:
        model: what was emitted.
        files: the output of `render`, or of `render_arm`.
        arrays: whether the C has array functions.
        joints: of an arm, whose inputs are vectors with an entry for each; 0 for other models.
    """
    return {
        f"check/{model.name}_{kind}": template(f"check/{kind}").render(view)
        for kind, view in views(model, files, arrays=arrays, joints=joints).items()
    }


def views(
    model: Model, files: Mapping[str, str], *, arrays: bool = True, joints: int = 0
) -> dict[str, dict[str, Any]]:
    """The variables of the templates: kind of file -> view."""
    # What is called has the names of the axis.
    axis, model = model.axis, spoken(model)
    acceleration = axis.said(v.alpha_m.name)
    source, in_c = files[f"{model.name}.py"], files[f"{model.name}.c"]
    module = executed(files, model.name)
    # Firmware steps hidden states itself; only Python follows them through a log.
    names = [name for name in module.__all__ if f"{model.name}_{name}(" in in_c]
    public = {name: getattr(module, name) for name in names}
    inputs = _inputs(() if joints else [q.name for q in model.inputs], public.values())
    functions = [
        _function(model.name, name, function, inputs, arrays, joints, acceleration)
        for name, function in public.items()
    ]
    defaults = _defaults(model)
    missing = [q.name for q in model.parameters if q.name not in defaults]
    assumed = {name: _ASSUMED.get(name, _ELSE_ASSUMED) for name in missing}
    assumed |= {name: value for name, value in _ASSUMED.items() if defaults.get(name) == 0}
    given = {
        "name": model.name,
        "program": re.findall(r"program \w+", source)[0],
        "assumed": [(name, repr(value)) for name, value in assumed.items()],
    }
    driver = {"proof.c": given | proof.view(model, functions, inputs, in_c, joints, axis)}
    beside = f"{model.name}_arrays.h"
    header = {"has_arrays": arrays, "header": beside if beside in files else f"{model.name}.h"}
    # A module that was called keeps how it evaluates the exponential, which the self-test takes out of it.
    fresh = executed(files, model.name)
    tested = given | header | selftest.view(fresh, functions, inputs, defaults | assumed, in_c, joints)
    return {"selftest.c": tested, "vectors.h": tested} | driver


def _defaults(model: Model) -> dict[str, float]:
    """The parameters that have a default, rounded once from the exact value as in the C."""
    exact = {q.symbol: q.default for q in model.parameters if q.default is not None}
    return {symbol.name: float(sp.Rational(value.xreplace(exact))) for symbol, value in exact.items()}


def _taken(function: Any) -> tuple[str, ...]:
    return tuple(x for x in inspect.signature(function).parameters if x not in {"parameters", "out"})


def _inputs(own: Iterable[str], functions: Iterable[Any]) -> list[str]:
    """The inputs of the model, then hidden states and any other inputs of a function."""
    return list(dict.fromkeys([*own, *(x for function in functions for x in _taken(function))]))


def _function(
    prefix: str, name: str, function: Any, inputs: list[str], many: bool, joints: int, acceleration: str
) -> Called:
    taken, length = _taken(function), joints or 1
    sample = [1.0 if x != acceleration else 0.0 for x in taken]
    shape = np.shape(function(*([x] * joints if joints else x for x in sample)))
    places = [length * inputs.index(x) for x in taken]
    arguments = [f"{'&' if joints else ''}x[{k}]" for k in places]
    call = (
        f"{prefix}_{name}({', '.join([*arguments, 'out', '&c'])});"
        if shape
        else f"out[0] = {prefix}_{name}({', '.join([*arguments, '&c'])});"
    )
    arrays = ", ".join(f"&x_n[{k}u * ARRAY]" if joints else f"x_n[{k}]" for k in places)
    array_call = f"{prefix}_{name}_n(ARRAY, {arrays}, out_n, &c);" if taken and many else ""
    return Called(name, taken, shape[0] if shape else 1, not shape, call, array_call)
