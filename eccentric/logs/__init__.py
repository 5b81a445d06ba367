"""Readers: a log in, named columns out, nothing converted and nothing dropped; no physics.

In: the path of a CSV, JSON, MAT or Parquet file, or a table in memory.  Out: a `Log` of columns of one
length; arithmetic on its columns (`evaluate`) and the units that a rig may give them (`require_unit`,
`parse_value`).
May import: `errors`.  A further format is a file beside `csv_file.py` and a line in `log.READERS`.
"""

from eccentric.logs.arithmetic import evaluate
from eccentric.logs.log import Log, LogSource, read_log
from eccentric.logs.units import Unit, parse_unit, parse_value, require_unit

__all__ = ["Log", "LogSource", "Unit", "evaluate", "parse_unit", "parse_value", "read_log", "require_unit"]
