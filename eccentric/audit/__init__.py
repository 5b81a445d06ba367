"""The audit: findings of a careful reading of the paper, computed from the derivation, with our reading."""

from __future__ import annotations

from eccentric.audit import case_1, case_2
from eccentric.audit.printed import PRINTED, agrees, polynomial, table_1

__all__ = ["PRINTED", "agrees", "findings", "polynomial", "table_1"]


def findings() -> tuple[str, ...]:
    """The findings, each as a short text with its numbers computed."""
    return (
        case_1.transversal_force(),
        case_1.back_emf_unit(),
        case_2.global_minimum(),
        case_1.ideal_motor(),
        case_1.sign_in_14(),
        case_1.gear_ratio(),
        case_2.balanced_mass(),
        case_2.motor_friction_alone(),
        case_2.constant_speed(),
        case_2.progressive(),
    )
