"""What a joint meets along a log from outside its own motor: the loads of its bearing, and the other joints.

A single link has none of it: its loads follow from its own angle and velocity.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from eccentric.estimation import Coefficient

__all__ = ["MetAlong"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MetAlong:
    """Signals of a log (n,) that a model takes as inputs besides the motion of its motor.

    Attributes:
        signals: by the name of the input, in SI units.
        torque: the sum of those that the drive has to supply, motor side [N m]: they come from filtered
            angles and must not pass the low pass twice.
        force: name of the signal that is the normal force on the bearing [N]; "" for none.
        open: what the rig leaves open of the bodies, coefficient -> column of torque, from the same angles.
        below: the same with all angles below another cut-off [Hz].
    """

    signals: Mapping[str, Array]
    torque: Array
    force: str = ""
    open: Mapping[Coefficient, Array] = field(default_factory=dict)
    below: Callable[[float], MetAlong] | None = None

    def narrowed(self, cut_hz: float) -> MetAlong:
        """The same with all angles below a cut-off."""
        return self if self.below is None else self.below(cut_hz)
