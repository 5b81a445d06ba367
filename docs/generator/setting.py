"""The rig and the log that ranges and pictures are made for: the paper's Table 1, a minute."""

from __future__ import annotations

import dataclasses
from functools import cache

import sympy as sp

from eccentric.effects import Effect, Setting, library
from eccentric.model import Model, Quantity, load_model
from eccentric.model import vocabulary as v


def _defaults(*quantities: Quantity) -> dict[str, float]:
    return {q.name: float(sp.Float(q.default)) for q in quantities}


KNOWN = {**_defaults(v.M, v.M_l, v.L, v.mu, v.R, v.k_i, v.k_e, v.g), "J_m": 1e-4, "J_l": 0.035}
FRICTION = _defaults(v.B_lN, v.C_lN, v.B_m, v.C_m)
BASE = {"C1": "c1_perpendicular", "C2": "c2_parallel"}
SPEED, CURRENT, SECONDS, LOSS, WARM = 60.0, 15.0, 60.0, 70.0, 30.0
TURNS, ORDER = 60.0, 3.57  # of balls that pass the outer race of a bearing with nine


def setting(case: str, *, warm: bool) -> Setting:
    """The setting of a case, with a temperature logged or not."""
    channels = frozenset(("current", "voltage", "temperature") if warm else ("current", "voltage"))
    middle = WARM if warm else None
    base = load_model(BASE[case])
    logged = {"temperature_mid": middle, "channels": channels, "friction": FRICTION}
    logged |= {"turns": TURNS, "orders": (ORDER,)}
    return Setting(base, KNOWN["mu"], KNOWN, 1.0, SPEED, CURRENT, SECONDS, LOSS, **logged)


@cache
def effects() -> tuple[tuple[Effect, Model], ...]:
    """Every effect once, with the model it extends: of case C2, then what only C1 or only a cold log has."""
    found: dict[str, tuple[Effect, Model]] = {}
    for case in ("C2", "C1"):
        model = load_model(BASE[case])
        for warm in (True, False):
            for effect in library(setting(case, warm=warm)):
                known = found.setdefault(effect.id, (effect, model))[0]
                if (known.evidence.depends_on, known.formula) != (effect.evidence.depends_on, effect.formula):
                    variant = ", ".join(filter(None, (effect.variant, f"case {case}")))
                    own = dataclasses.replace(effect, variant=variant)
                    found.setdefault(own.id, (own, model))
    return tuple(found.values())
