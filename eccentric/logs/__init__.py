"""Readers: a log in, named columns out; nothing is converted or dropped, and no physics is applied.

In: the path of a file (CSV, JSON, MAT, Parquet, HDF5, MDF, bags of ROS 2, ...), or a table in memory.
Out: a `Log` of columns of one length, or a `LogStream` of batches; arithmetic on its columns (`evaluate`) and
the units that a rig may assign to them (`require_unit`, `parse_value`).
May import: `core`.  A new format is a file beside `csv_file.py` and a line in `formats.FORMATS`.
"""

from eccentric.logs.arithmetic import evaluate
from eccentric.logs.assemble import number_of
from eccentric.logs.batches import LogStream, stream_log
from eccentric.logs.clock import falls, mended
from eccentric.logs.formats import FORMATS, format_of
from eccentric.logs.log import Excerpt, Log, LogSource, log_names, log_stems, read_log
from eccentric.logs.parquet_file import arrow_columns
from eccentric.logs.units import Unit, parse_unit, parse_value, require_unit
