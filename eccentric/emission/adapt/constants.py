"""The constants of the estimator, by the names in capitals that its C and Python share."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import mpmath
import numpy as np

from eccentric.emission.adapt.alarm import Alarm
from eccentric.emission.adapt.prior import Prior
from eccentric.emission.adapt.settings import Adaptation
from eccentric.emission.backends import decimal

AVERAGED = 2**15
"""Rows over which noise and correlation are averaged: the standard deviation to 0.4 %."""
ARMED = 2**10
"""Rows before the first alarm: by then the standard deviation is known to 2 %."""
SLOWER = 16
"""What no row excites is forgotten slower by this factor."""
_GLOBAL = {
    "ZERO": 0.0,
    "ONE": 1.0,
    "CLIP": 5.0,  # beyond so many standard deviations, an innovation counts as an outlier of this size
    "KNOWN": 0.25,  # half the prior's standard deviation, squared
    "LEAST_VARIANCE": 2.0**-40,
    "MOST_U": 2.0**10,
    "LEAST_B": 2.0**-4,  # b is at least lambda, but no interval of Eva's knows it
    "MOST_RHO": 0.96875,
    "LEAST_SQUARE": 2.0**-10,
    "MOST_SQUARE": 256.0,
    "RATE": 1 / AVERAGED,
    "FIRST_RATE": 2.0**-6,
    "ARMED": 1 / ARMED,
    "LEAST_SHARPNESS": 2.0**-5,  # spread is below 2 MOST_SQUARE, by intervals
    "MOST_SHARPNESS": 2.0**5,
    "LEAST_LIMIT": 5.0 * 2.0**-5,  # CLIP times the root of LEAST_SQUARE
    "MOST_LIMIT": 5.0 * 2.0**4,
}
_MOST_ZETA, _MOST_RESIDUAL = 1e8, 1e6
"""Largest variance of a row's friction and largest residual that count, over the noise."""


def constants_of(
    prior: Prior, asked: Adaptation, alarm: Alarm, inputs: Iterable[Mapping[str, Any]]
) -> list[tuple[str, float]]:
    """Names and values, those of the prior and of the ranges of the inputs included."""
    forget, n = 1 - asked.forgetting, len(prior.values)
    U, d = prior.factors()
    scale = prior.deviations / prior.noise
    each = {
        "SCALE": scale,
        "STEP": prior.deviations,
        "START": prior.values,
        "LOWEST": prior.lowest,
        "HIGHEST": prior.highest,
        "D": np.minimum(d, 1.0),
        "U": [U[i, j] for j in range(n) for i in range(j)],
    }
    return [
        *_GLOBAL.items(),
        ("PER_NOISE", 1 / prior.noise),
        ("MOVING", prior.moving),
        ("LAMBDA", asked.forgetting),
        ("FORGET", forget),
        ("GROWTH", 1 + n * forget / SLOWER),
        ("LEAST_ZETA", forget / 1024),
        ("REFERENCE", alarm.reference),
        ("THRESHOLD", alarm.threshold),
        ("TURNS", float(n)),
        ("MOST_ZETA", _MOST_ZETA),
        ("MOST_RESIDUAL", _MOST_RESIDUAL * prior.noise),
        *((f"{name}_{k}", float(x)) for name, values in each.items() for k, x in enumerate(values)),
        *(
            (f"{end}_{x['name']}", x[which])
            for x in inputs
            for end, which in (("LEAST", "low"), ("MOST", "high"))
        ),
    ]


def decimals(name: str, value: float) -> dict[str, str]:
    """A constant as the templates write it: its decimals in both precisions, in Python and C."""
    with mpmath.workdps(30):
        texts = [decimal(mpmath.mpf(value), single) for single in (True, False)]
    in_c = (f"({text})" if text.startswith("-") else text for text in (f"{texts[0]}f", texts[1]))
    return dict(zip(("name", "single", "double", "c_single", "c_double"), (name, *texts, *in_c), strict=True))
