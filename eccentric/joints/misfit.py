"""A log that does not fit the rig of an arm, in words."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["misfit_sentence"]


def misfit_sentence(r_squared: Mapping[int, float]) -> str:
    """What to check where the log of some joints is not of this arm; "" for none.

    Args:
        r_squared: R^2 of the drive on the held-out rows, by the numbers of these joints.
    """
    if not r_squared:
        return ""
    joints = ", ".join(f"{number} (R^2 {value:.2f})" for number, value in r_squared.items())
    return (
        f"This log does not fit the rig in joint{'s' * (len(r_squared) > 1)} {joints}: check units and signs"
        " of the columns, k_i, and in the arm file mu, gravity, positions and bodies."
    )
