"""Checks of an emitted C source for its user: a self-test with vectors, and a driver for a proof.

Everything comes from the emitted NumPy module by its public names, so that nothing here knows how a model is
evaluated.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import sympy as sp

from eccentric.emission.backends import DEFAULT
from eccentric.emission.check import selftest
from eccentric.emission.check.selftest import Called
from eccentric.emission.hot import executed, inputs_of
from eccentric.emission.program import SHORTEST, WHOLE, Choice
from eccentric.emission.render import render
from eccentric.emission.templates import plain, template
from eccentric.model import TURNING, AxisKind, Bump, Model, Quantity, interface_of, spoken, spoken_quantity
from eccentric.model import vocabulary as v

# Arrays are proved for this many samples: the loop's body is the same for all.
_SAMPLES = 2
# Lowest and highest value of an input, in SI units. A time step is positive, but any other is harmless.
_CURRENT = 1e3
_RANGES = {
    "theta_m": (-1e4, 1e4),
    "omega_m": (-1e3, 1e3),
    "alpha_m": (-1e4, 1e4),
    "i": (-_CURRENT, _CURRENT),
    "u": (-1e3, 1e3),
    "torque": (-1e4, 1e4),
    "t": (0.0, 1e6),
    "temperature": (-60.0, 3e2),
    "dt": (-1e2, 1e2),
    **dict.fromkeys(("F_N", "F_T", "M_B", "T"), (0.0, 1e5)),
}
# Where a force is logged, k_f is 1 N/A, and a current is as large as the force.
_OF_A_CARRIAGE = {**_RANGES, "i": (-1e6, 1e6), "force": (-1e6, 1e6)}
# Those of a hidden state, by its unit; it is not proved that the state stays within them. Averaged losses are
# negative only by noise.
_SLOPE = 2 * _CURRENT / float(SHORTEST)
_BEND = 2 * _SLOPE / float(SHORTEST)
_RANGES_BY_UNIT = {
    "1": (-1e4, 1e4),
    "rad": (-1e9, 1e9),
    "W": (-1.0, 1e6),
    "A": (-_CURRENT, _CURRENT),
    "A/s": (-_SLOPE, _SLOPE),
    "A/s^2": (-_BEND, _BEND),
}
_OTHER_RANGE = (-1e2, 1e2)
# Cases are kept separate, each with its condition; the two samples of an array too, or their results would
# count as not initialised; and squares are known to be squares.
_SUBDIVIDED = "-eva-subdivide-non-linear 20"
_SEPARATE = "-eva-split-return full -eva-min-loop-unroll 3"
_OPTIONS = f"-eva-slevel 30 {_SEPARATE} {_SUBDIVIDED}"
# The ends of a curve, and of its slope, are further cases.
_OF_CURVES = f"-eva-slevel 100 {_SEPARATE}"
# Any NaN or infinity is an alarm, and no result is taken on trust.
_STRICT = "-warn-special-float non-finite -kernel-warn-key annot:missing-spec=abort"
# Only narrow intervals of the angle show that an angle minus itself, which represents lost digits, is 0.
_NARROW = 500
_IN_FLOAT = 2
"""Joints of an arm that is proved in single precision as well."""
_IN_BOTH = "and the same with -DECCENTRIC_REAL=double."
_IN_DOUBLE = (
    "In single precision Eva gives alarms: over the rotations of many joints in a row its intervals grow"
    " beyond what a float holds."
)


def view(
    model: Model,
    functions: Sequence[Called],
    inputs: Sequence[str],
    source: str,
    joints: int = 0,
    axis: AxisKind = TURNING,
) -> dict[str, Any]:
    """The variables of the template of the proof driver.

    `source` is the emitted C; `joints` is the number of an arm's, whose inputs are vectors with that many
    entries; `axis` is what moves.
    """
    states = [state.quantity for state in model.states]
    loads = (x.quantity for output in interface_of(model).outputs for x in output.inputs) if joints else ()
    known = {q.name: q for q in (*model.inputs, *states, v.dt, *loads)}
    known |= {q.name: q for q in (v.theta_m, v.omega_m, v.alpha_m, v.i, v.u, v.temperature)}
    torque = spoken_quantity(axis, v.torque)
    known[torque.name] = torque
    curved = any(term.value.has(Bump) for balance in model.balances for term in balance.terms)
    real = "double" if joints > _IN_FLOAT else "float"
    return {
        "command": proof_command(model.name, source, _OF_CURVES if curved else "", real),
        "precisions": _IN_DOUBLE if joints > _IN_FLOAT else _IN_BOTH,
        "inputs": [_input(known[x], axis) for x in inputs],
        "joints": joints,
        "velocity": axis.named(v.omega_m.name),
        "states": [q.name for q in states],
        "samples": _SAMPLES,
        "largest": max(f.width for f in functions),
        "calls": [call for f in functions for call in (*_calls(model.name, f, joints), *_step(model, f))],
    }


def proof_command(name: str, source: str, states: str = "", real: str = "float") -> list[str]:
    """The command that proves the driver of that name, for the head of the driver.

    `source` is the model's C; `states` are other options, of which states of the analysis are kept apart;
    `real` is the precision that it is proved in.
    """
    reductions = sorted(set(re.findall(r"\b\w+_from_top\w*(?=\()", source)))
    narrow = ",".join(f"{function}:{_NARROW}" for function in reductions)
    return [
        f"frama-c -eva {f'{states} {_SUBDIVIDED}' if states else _OPTIONS} \\",
        *([f"  -eva-subdivide-non-linear-function {narrow} \\"] if narrow else []),
        f"  {_STRICT} \\",
        f'  -cpp-extra-args="-DECCENTRIC_REAL={real} -I.." {name}_proof.c',
    ]


def limits(q: Quantity, axis: AxisKind = TURNING) -> tuple[float, float]:
    """The lowest and highest value of an input or hidden state for which the C is proved, in SI units."""
    ranges = _RANGES if axis.wraps else _OF_A_CARRIAGE
    low, high = ranges.get(q.name) or _RANGES_BY_UNIT.get(q.unit, _OTHER_RANGE)
    return 0.0 if q.domain == "nonnegative" else low, high


def _input(q: Quantity, axis: AxisKind) -> dict[str, str]:
    """An input or hidden state, and the range that is proved."""
    low, high = limits(q, axis)
    return {"name": q.name, "doc": plain(f"{q.meaning} [{q.unit}]"), "range": f"{low:g}, {high:g}"}


def _calls(prefix: str, f: Called, joints: int) -> list[dict[str, Any]]:
    """The call of a function and, if it has inputs, of its array function."""
    own = f"{prefix}_{f.name}"
    one = [f"{x}[0]" if joints and x in selftest.NUMBERS else x for x in f.inputs]
    one += [*([] if f.scalar else ["out"]), "c"]
    line = f"{'out[0] = ' if f.scalar else ''}{own}({', '.join(one)});"
    calls = [{"name": f.name, "lines": [line], "width": f.width}]
    if f.array_call:
        many = ["SAMPLES", *(f"{x}_n" for x in f.inputs), "out", "c"]
        calls.append({
            "name": f"{f.name}_n", "lines": [f"{own}_n({', '.join(many)});"], "width": _SAMPLES * f.width
        })  # fmt: skip
    return calls


def _step(model: Model, f: Called) -> list[dict[str, Any]]:
    """In addition to `next_state`, the call of `step`, which writes to the caller's state."""
    if f.name != "next_state":
        return []
    states = [state.quantity.name for state in model.states]
    given = ["&state", *(x for x in f.inputs if x not in states), "c"]
    lines = [
        *(f"state.{name} = {name};" for name in states),
        f"{model.name}_step({', '.join(given)});",
        *(f"out[{k}] = state.{name};" for k, name in enumerate(states)),
    ]
    return [{"name": "step", "lines": lines, "width": f.width}]


# For parameters without a default, or with one that makes functions zero. Sine and cosine of this tilt are
# far from halfway between two numbers, so that every libm rounds them the same way.
_ASSUMED = {"J_m": 2e-4, "J_l": 0.04, "phi": 0.6}
_ELSE_ASSUMED = 0.25


def joints_of(model: Model) -> int:
    """The number of joints of an arm, whose inputs are vectors with an entry for each; else 0."""
    return max(x.length or 0 for output in interface_of(model).outputs for x in output.inputs)


def complete(
    model: Model,
    command: str = "make derive",
    origin: str | None = None,
    backends: Collection[str] = DEFAULT,
    *,
    single_file: bool = False,
    choice: Choice = WHOLE,
) -> dict[str, str]:
    """The emitted files of a model and, in the folder `check`, those that check its C: name -> text.

    With fixed parameters there is nothing to compare bits with: the coefficients come from 50 digits, those
    that NumPy prepares from double precision. The self-test of the whole model calls the same functions.
    The checks know inputs with an entry for each joint: an arm with hidden states, or whose friction follows
    the time, has none.

    Raises:
        InputError: the model cannot be emitted.
    """
    files = render(model, command, origin, backends, single_file=single_file, choice=choice)
    of_one_number = bool(model.states) or v.t in model.inputs
    if "c99" not in backends or choice.fixed or (joints_of(model) and of_one_number):
        return files
    with_module = "numpy" in backends and not single_file
    whole = files if with_module else render(model, command, origin, choice=choice)
    return files | render_check(model, whole, arrays=choice.arrays != "none")


def render_check(model: Model, files: Mapping[str, str], *, arrays: bool = True) -> dict[str, str]:
    """The files that check a model's emitted C, file name -> text.

    Args:
        model: what was emitted.
        files: the output of `render`.
        arrays: whether the C has array functions.
    """
    return {
        f"check/{model.name}_{kind}": template(f"check/{kind}").render(view)
        for kind, view in views(model, files, arrays=arrays).items()
    }


def views(model: Model, files: Mapping[str, str], *, arrays: bool = True) -> dict[str, dict[str, Any]]:
    """The variables of the templates: kind of file -> view."""
    joints = joints_of(model)
    # What is called has the names of the axis.
    axis, model = model.axis, spoken(model)
    source, in_c = files[f"{model.name}.py"], files[f"{model.name}.c"]
    module = executed(files, model.name)
    # Firmware steps hidden states itself; only Python follows them through a log.
    names = [name for name in module.__all__ if f"{model.name}_{name}(" in in_c]
    public = {name: getattr(module, name) for name in names}
    inputs = _inputs(() if joints else [q.name for q in model.inputs], public.values())
    functions = [
        _function(model.name, name, function, inputs, arrays, joints) for name, function in public.items()
    ]
    defaults = _defaults(model)
    missing = [q.name for q in model.parameters if q.name not in defaults]
    assumed = {name: _ASSUMED.get(name, _ELSE_ASSUMED) for name in missing}
    assumed |= {name: value for name, value in _ASSUMED.items() if defaults.get(name) == 0}
    # Inertias assumed for a model without them are above what its friction takes of an acceleration.
    name, factor = ("J_m", 2.0) if "J_m" in assumed else ("J_l", 0.5)
    while name in assumed and module._model.unsolvable(module.Parameters(**assumed)):  # noqa: SLF001 - emission's own
        assumed[name] *= factor
    given = {
        "name": model.name,
        "program": re.findall(r"program \w+", source)[0],
        "assumed": [(name, repr(value)) for name, value in assumed.items()],
    }
    driver = {"proof.c": given | view(model, functions, inputs, in_c, joints, axis)}
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


def _inputs(own: Iterable[str], functions: Iterable[Any]) -> list[str]:
    """The inputs of the model, then hidden states and any other inputs of a function."""
    return list(dict.fromkeys([*own, *(x for function in functions for x in inputs_of(function))]))


def _function(prefix: str, name: str, function: Any, inputs: list[str], many: bool, joints: int) -> Called:
    taken, length = inputs_of(function), joints or 1
    # Of the last input, which may need an inertia that is not given, 0 alone is sure to have a value.
    sample = [1.0] * (len(taken) - 1) + [0.0] * bool(taken)
    vectors = [bool(joints) and x not in selftest.NUMBERS for x in taken]
    shape = np.shape(
        function(*([x] * joints if vector else x for x, vector in zip(sample, vectors, strict=True)))
    )
    places = [length * inputs.index(x) for x in taken]
    arguments = [f"{'&' if vector else ''}x[{k}]" for k, vector in zip(places, vectors, strict=True)]
    call = (
        f"{prefix}_{name}({', '.join([*arguments, 'out', '&c'])});"
        if shape
        else f"out[0] = {prefix}_{name}({', '.join([*arguments, '&c'])});"
    )
    arrays = ", ".join(f"&x_n[{k}u * ARRAY]" if joints else f"x_n[{k}]" for k in places)
    array_call = f"{prefix}_{name}_n(ARRAY, {arrays}, out_n, &c);" if taken and many else ""
    return Called(name, taken, shape[0] if shape else 1, not shape, call, array_call)
