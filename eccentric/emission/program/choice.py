"""What of a model is emitted: all of it, or the functions that a user calls and what they need."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from eccentric.errors import InputError, meant

_STEP = "next_state"  # of hidden states, which every function of a model with them follows
Arrays = Literal["with", "beside", "none"]


@dataclass(frozen=True)
class Choice:
    """A choice of what to emit.

    Attributes:
        functions: their names, without those of arrays and the step of hidden states; none chosen is all.
        arrays: where C has its array functions: in the header, in one of their own, or nowhere.
        fixed: whether C has the default parameters only: neither a structure of parameters nor `prepare`.
    """

    functions: tuple[str, ...] = ()
    arrays: Arrays = "with"
    fixed: bool = False

    def of(self, names: Sequence[str]) -> tuple[str, ...]:
        """Those of the names that are emitted, in their order.

        Raises:
            InputError: there is no function of a chosen name.
        """
        offered = [name for name in names if name != _STEP]
        for name in self.functions:
            if name not in offered:
                known = f"one of {', '.join(offered)} is required"
                raise InputError(f"functions: {known}, received {name!r}{meant(name, offered)}")
        return tuple(name for name in names if not self.functions or name in (*self.functions, _STEP))


WHOLE = Choice()
