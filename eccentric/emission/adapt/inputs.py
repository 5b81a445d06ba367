"""What the estimator takes in every sample, each with the range that it is left out beyond."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from eccentric.emission.check import limits
from eccentric.emission.free_text import plain
from eccentric.emission.program import Routine
from eccentric.model import Model, spoken, spoken_quantity
from eccentric.model import vocabulary as v

NEEDED = ("mechanical_residual", "regressor", "friction_coefficients")
"""The functions of the model that it calls."""


def ranged_inputs(model: Model, routines: Mapping[str, Routine]) -> list[dict[str, Any]]:
    """The motion, the current, and whatever else the balance depends on."""
    found = {
        x.quantity.name: x.quantity for name in NEEDED for x in routines[name].inputs if x.length is None
    }
    first = [spoken_quantity(model.axis, q).name for q in (v.theta_m, v.omega_m, v.alpha_m, v.i)]
    known = {q.name: q for q in spoken(model).inputs}
    ordered = [*(x for x in first if x in known), *(x for x in found if x not in first)]
    quantities = [found.get(x) or known[x] for x in ordered]
    return [
        {
            "name": q.name,
            "doc": plain(f"{q.meaning} [{q.unit}]"),
            "low": limits(q, model.axis)[0],
            "high": limits(q, model.axis)[1],
        }
        for q in quantities
    ]


def inside(inputs: list[dict[str, Any]]) -> str:
    """The condition in C that the inputs are within their ranges; NaN is not."""
    names = [x["name"] for x in inputs]
    return " && ".join(f"({name} >= LEAST_{name}) && ({name} <= MOST_{name})" for name in names)
