"""What is promised of an arm's arithmetic: bounds that `tests/test_arm_accuracy.py` measures at 50 digits.

They are relative to the size that forces and moments can have at that motion, not to the results: these are
small where the forces of several bodies cancel. With all masses M, the reach R (the distances of the joints
from one another, the travel of slides, the farthest centre of mass and the largest radius of gyration,
added), the farthest centre of a bearing from its joint r, and the sums W, A, V, B of the joints' speeds and
accelerations, turning and sliding,

    F = M (g + R (W^2 + A) + 2 V W + B)
    P = J_m (alpha_m + W omega_m + A)                 of each rotor
    N = F (R + r) + the sum of P

found by a search over random arms of 1 to 7 joints, and stated one unit above the worst case.
"""

from __future__ import annotations

from collections.abc import Collection

FORCE, MOMENT = 4, 3
"""Largest error of a force, in eps of F; of a moment or torque, in eps of N; on the motor side that times mu,
and P of its own rotor."""
_OF = {
    "inverse_dynamics": f"within {MOMENT} eps of mu N + P (slides: of mu F + P)",
    "joint_wrenches": f"forces within {FORCE} eps of F, moments within {MOMENT} eps of N",
    "bearing_loads": f"F_N, F_T within {FORCE} eps of F; M_B, T within {MOMENT} eps of N (slides: T of F)",
}
_WITH = (
    "with F = M (g + R (W^2 + A) + 2 V W + B), P = J_m (alpha_m + W omega_m + A), N = F (R + r) + all P:",
    "mass M, reach R, farthest bearing r, and W, A, V, B the sums of the joints' speeds and accelerations,",
    "turning and sliding",
)


def arm_promises(names: Collection[str]) -> tuple[str, ...]:
    """The bounds of the functions that are emitted, one line each; none for none of them."""
    said = [f"{name}: {bound}" for name, bound in _OF.items() if name in names]
    return (*said, *_WITH) if said else ()
