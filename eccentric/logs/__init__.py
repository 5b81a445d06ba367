"""Readers: a log in, named columns out; nothing is converted or dropped, and no physics is applied.

In: the path of a file (CSV, JSON, MAT, Parquet, HDF5, MDF, bags of ROS 2, ...), or a table in memory.
Out: a `Log` of columns of one length, or a `LogStream` of batches; arithmetic on its columns (`evaluate`) and
the units that a rig may assign to them (`require_unit`, `parse_value`).
A file is imported when one of its names is first used; `__init__.pyi` lists them.
May import: `core`.  A new format is a file beside `csv_file.py` and a line in `formats.FORMATS`.
"""

from eccentric.lazy import lazy_names

__getattr__, __dir__ = lazy_names(__name__, __file__)
