"""Scenarios of the virtual bench."""

import numpy as np

from eccentric.bench import Scenario, random_scenario


def drawn_scenario(seed: int = 3, /, **options: object) -> Scenario:
    """Return a scenario of this seed: speed runs of 15 s in C2, unless the options say otherwise."""
    chosen = {"case": "C2", "mu": 0.2, "log_type": "runs", "seconds": 15.0, **options}
    return random_scenario(np.random.default_rng(seed), **chosen)  # pyright: ignore[reportArgumentType]
