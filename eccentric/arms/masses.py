"""A joint that moves nothing has no dynamics: it is refused."""

from __future__ import annotations

from eccentric.errors import InputError
from eccentric.model import Chain


def require_mass(chain: Chain) -> None:
    """Raise InputError unless every joint moves a mass or a rotor.

    A body without mass between others is right: wrists of two or three joints in one point have them. The
    last joint must have some, or any torque would accelerate it without limit; then all others move it too.
    """
    last = chain.links[-1]
    if last.moments.mass == 0 and not any(last.moments.second) and last.joint.J_m == 0:
        raise InputError(
            f"{last.joint.name}: a mass on the body of the last joint, or a rotor, is required, received none"
        )
