"""The audit: findings of a careful reading of the paper, computed from the derivation, with our reading."""

from __future__ import annotations

from eccentric.audit import audit
from eccentric.audit.audit import PRINTED, agrees, polynomial, table_1

__all__ = ["PRINTED", "agrees", "findings", "polynomial", "table_1"]


def findings() -> tuple[str, ...]:
    """The findings, each as a short text with its numbers computed."""
    return (
        audit.transversal_force(),
        audit.back_emf_unit(),
        audit.global_minimum(),
        audit.ideal_motor(),
        audit.sign_in_14(),
        audit.gear_ratio(),
        audit.balanced_mass(),
        audit.motor_friction_alone(),
        audit.constant_speed(),
        audit.progressive(),
    )
