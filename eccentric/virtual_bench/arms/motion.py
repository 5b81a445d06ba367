"""The motion of one joint of an arm, as seen by the laws of its effects."""

from __future__ import annotations

from eccentric.virtual_bench.motion import Motion
from eccentric.virtual_bench.plant import Plant


class JointMotion(Motion):
    """`Motion` of the joint's motor, and what only an arm has.

    `normal` is F_N, `gravity` the torque that holds the joint at rest, `transmitted` what its gear passes on
    without friction, with its sign; both on the motor side [N m].
    """

    __slots__ = ("transmitted",)

    def __init__(self, plant: Plant, effects: int = 0) -> None:
        super().__init__(plant, effects=effects)
        self.transmitted = 0.0
