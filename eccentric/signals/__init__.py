"""Logs and a rig in, motor-side signals in SI units out: masks, hold-out, the rows of a comparison.

In: logs and a `Rig`.  Out: `Channels`; the rows that models are fitted, compared and searched on (`Rows`);
what is unusual about the record (`Finding`).
May import: `logs`, `rigs`; `model` for what a rig declares, by the general derivation. Nothing is fitted.
"""

from eccentric.signals.channels import read_channels
from eccentric.signals.clock import Finding, far_from_others, with_doubts
from eccentric.signals.converted import stream_columns
from eccentric.signals.filters import low_pass_of, motion_of, places_of, rows_of_each, stretches
from eccentric.signals.joints import read_joints
from eccentric.signals.limits import FIT_POINTS, LEAST_HELD_OUT, MANY_RUNS, UNEVEN_STEP
from eccentric.signals.long_log import read_long, read_long_joints
from eccentric.signals.measured import Channels
from eccentric.signals.motion import of_the_motor, turn_line, white_noise
from eccentric.signals.quality import Ratio, beside_the_rig, shared_cause
from eccentric.signals.rows import Band, Filtered, Rows, band_of, blocks_of, require_rows
from eccentric.signals.sampling import fit_rows, hann_windows, rows_of, search_rows, weights_by_parts
from eccentric.signals.table import Table, read_table
