"""An emitted function as called by the checks."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Called:
    """One emitted function.

    Attributes:
        name: in NumPy and, behind the model's prefix, in C.
        inputs: names, in order.
        width: number of its values.
        scalar: whether C returns the single value; otherwise it writes to an array.
        call: in C, from x[] to out[].
        array_call: of its array function, from ARRAY samples in each of x_n[] to out_n[]; "" without inputs.
    """

    name: str
    inputs: tuple[str, ...]
    width: int
    scalar: bool
    call: str
    array_call: str
