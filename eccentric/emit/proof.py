"""The driver by which Frama-C's Eva proves that an emitted C source neither overflows nor makes a NaN."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from eccentric.emit.called import Called
from eccentric.model import Model

# Arrays are proved for this many samples: the loop's body is the same for all.
_SAMPLES = 2
# Largest size of an input, in SI units.
_RANGES = {"theta_m": "1e4", "omega_m": "1e3", "alpha_m": "1e4", "i": "1e3", "u": "1e3"}
_OTHER_RANGE = "1e2"
# Cases stay apart, each keeps what its condition says, and squares are squares.
_OPTIONS = "-eva-slevel 300 -eva-split-return full -eva-domains cvalue,equality -eva-subdivide-non-linear 20"
# Any NaN or infinity is an alarm, and no result is taken on trust.
_STRICT = "-warn-special-float non-finite -kernel-warn-key annot:missing-spec=abort"
# Where an angle minus itself stands for what is lost, only narrow intervals of the angle show that it is 0.
_NARROW = 500


def view(model: Model, functions: Sequence[Called], inputs: Sequence[str], source: str) -> dict[str, Any]:
    """What the template of the proof driver is filled with; `source` is the emitted C."""
    units = {symbol.name: unit for symbol, unit in model.units().items()}
    reductions = sorted(set(re.findall(rf"\b{model.name}_from_top\w*(?=\()", source)))
    narrow = ",".join(f"{function}:{_NARROW}" for function in reductions)
    return {
        "command": [
            f"frama-c -eva {_OPTIONS} \\",
            *([f"  -eva-subdivide-non-linear-function {narrow} \\"] if narrow else []),
            f"  {_STRICT} \\",
            f'  -cpp-extra-args="-DECCENTRIC_REAL=float -I.." {model.name}_proof.c',
        ],
        "inputs": [
            {"name": x, "unit": units.get(x, "1"), "range": _RANGES.get(x, _OTHER_RANGE)} for x in inputs
        ],
        "samples": _SAMPLES,
        "largest": max(f.width for f in functions),
        "calls": [call for f in functions for call in _calls(model.name, f)],
    }


def _calls(prefix: str, f: Called) -> list[dict[str, Any]]:
    """The call of a function and, where it has inputs, of that over arrays."""
    own = f"{prefix}_{f.name}"
    one = [*f.inputs, *([] if f.scalar else ["out"]), "c"]
    line = f"{'out[0] = ' if f.scalar else ''}{own}({', '.join(one)});"
    calls = [{"name": f.name, "line": line, "width": f.width}]
    if f.inputs:
        many = ["SAMPLES", *(f"{x}_n" for x in f.inputs), "out", "c"]
        calls.append({
            "name": f"{f.name}_n", "line": f"{own}_n({', '.join(many)});", "width": _SAMPLES * f.width
        })  # fmt: skip
    return calls
