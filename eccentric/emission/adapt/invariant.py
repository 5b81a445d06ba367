"""What holds of every state of the estimator, and how Frama-C's Eva proves it."""

from __future__ import annotations

STATES = (
    "-eva-domains equality -eva-slevel 20 -eva-slevel-function NAME_project:2000,NAME_variance:100,main:100"
)
"""Options of the proof: loops over coefficients are followed index by index, and nothing else is."""


def bounds(n: int) -> list[tuple[str, str, str]]:
    """The invariant of the state: field, lowest and highest value."""
    return [
        *((f"coefficient[{k}]", f"LOWEST_{k}", f"HIGHEST_{k}") for k in range(n)),
        *((f"d[{k}]", "ZERO", "ONE") for k in range(n)),
        *((f"u[{k}]", "-(MOST_U)", "MOST_U") for k in range(n * (n - 1) // 2)),
        ("before", "-(MOST_LIMIT)", "MOST_LIMIT"),
        ("square", "LEAST_SQUARE", "MOST_SQUARE"),
        ("product", "-(MOST_SQUARE)", "MOST_SQUARE"),
        ("rho", "ZERO", "MOST_RHO"),
        ("sharpness", "LEAST_SHARPNESS", "MOST_SHARPNESS"),
        ("limit", "LEAST_LIMIT", "MOST_LIMIT"),
        ("rate", "RATE", "FIRST_RATE"),
        ("up", "ZERO", "THRESHOLD"),
        ("down", "ZERO", "THRESHOLD"),
    ]


def within(n: int) -> str:
    """The condition in C that the coefficients are within their bounds."""
    return " && ".join(f"(x_{k} >= LOWEST_{k}) && (x_{k} <= HIGHEST_{k})" for k in range(n))
