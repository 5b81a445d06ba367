"""The driver with which Frama-C's Eva proves that an emitted C source gives no overflow and no NaN."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from eccentric.emission.check.selftest import Called
from eccentric.emission.program import SHORTEST
from eccentric.emission.templates import plain
from eccentric.model import TURNING, AxisKind, Model, Quantity
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
    "t": (0.0, 1e6),
    "temperature": (-60.0, 3e2),
    "dt": (-1e2, 1e2),
}
# Where a force is logged, k_f is 1 N/A, and a current is as large as the force.
_OF_A_CARRIAGE = {**_RANGES, "i": (-1e6, 1e6)}
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
# Cases are kept separate, each with its condition, and squares are known to be squares.
_SUBDIVIDED = "-eva-subdivide-non-linear 20"
_OPTIONS = f"-eva-slevel 30 -eva-split-return full {_SUBDIVIDED}"
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
    known = {q.name: q for q in (*model.inputs, *states, v.dt)}
    known |= {q.name: q for q in (v.theta_m, v.omega_m, v.alpha_m, v.i, v.u, v.temperature)}
    return {
        "command": proof_command(model.name, source, real="double" if joints > _IN_FLOAT else "float"),
        "precisions": _IN_DOUBLE if joints > _IN_FLOAT else _IN_BOTH,
        "inputs": [_input(known[x], axis) for x in inputs],
        "joints": joints,
        "velocity": axis.said(v.omega_m.name),
        "states": [q.name for q in states],
        "samples": _SAMPLES,
        "largest": max(f.width for f in functions),
        "calls": [call for f in functions for call in (*_calls(model.name, f), *_step(model, f))],
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


def _calls(prefix: str, f: Called) -> list[dict[str, Any]]:
    """The call of a function and, if it has inputs, of its array function."""
    own = f"{prefix}_{f.name}"
    one = [*f.inputs, *([] if f.scalar else ["out"]), "c"]
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
