"""What the user knows of the test bench: a rig in, checked values in SI units out.

In: the path of a TOML or JSON file, or its content.  Out: a `Rig`, with a `ColumnSource` for each channel
that it maps; the tables of what a rig file may hold (`KEYS`, `KNOWNS`, `CHANNELS`, `ALIGNMENT`).
May import: `logs` for units, `model` for the vocabulary.
"""

from eccentric.rigs.known import KNOWNS, Known
from eccentric.rigs.rig import ALIGNMENT, KEYS, Rig, read_rig
from eccentric.rigs.sources import CHANNELS, ColumnSource

__all__ = ["ALIGNMENT", "CHANNELS", "KEYS", "KNOWNS", "ColumnSource", "Known", "Rig", "read_rig"]
