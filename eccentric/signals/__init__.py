"""Logs and a rig in, motor-side signals in SI units out: masks, hold-out, the rows of a comparison.

In: logs and a `Rig`.  Out: `Channels`; the rows that models are compared and searched on (`Rows`, `Windows`,
`BalanceDesign`); what is odd about the record (`Finding`).
May import: `logs`, `rigs`; no model.
"""

from eccentric.signals.channels import read_channels
from eccentric.signals.filters import smoothed
from eccentric.signals.finding import Finding
from eccentric.signals.measured import Channels
from eccentric.signals.residual import BalanceDesign, Windows, make_balance_design, make_windows
from eccentric.signals.rows import (
    LEAST_HELD_OUT,
    MANY_RUNS,
    Rows,
    averaged,
    require_rows,
    rows_of,
    search_windows,
)
from eccentric.signals.stretches import rows_of_each
from eccentric.signals.windowed import Sampling, sample

__all__ = [
    "LEAST_HELD_OUT",
    "MANY_RUNS",
    "BalanceDesign",
    "Channels",
    "Finding",
    "Rows",
    "Sampling",
    "Windows",
    "averaged",
    "make_balance_design",
    "make_windows",
    "read_channels",
    "require_rows",
    "rows_of",
    "rows_of_each",
    "sample",
    "search_windows",
    "smoothed",
]
