"""Every threshold of the diagnosis, each with its reason; the search has its own."""

from __future__ import annotations

__all__ = [
    "ABOVE",
    "FEWEST_RUNS",
    "HIGHEST_ORDER",
    "LEAST_SHARE",
    "LEAST_STRETCHES",
    "LEAST_TURNS",
    "PROVABLE",
]

FEWEST_RUNS = 5
"""Runs from which the gain is also taken over whole runs: the interval draws runs, of four it says little."""
PROVABLE = 3.0
"""Times the noise of the sensors from which a residual has a cause, found or not."""

# What is periodic inside runs.

LEAST_TURNS = 2.0
"""A stretch of fewer turns does not separate one order from the next."""
HIGHEST_ORDER = 12.0
"""Orders per motor turn that are looked at, in steps of a twentieth."""
LEAST_SHARE = 0.04
"""Of the variance inside the stretches; less is not worth a line."""
ABOVE = 4.0
"""A peak over the median of the spectrum around it: what wanders is high at low orders, and not periodic."""
LEAST_STRETCHES = 6
"""Chance makes a peak of the same order in one stretch, or in three; not in most of six."""
