"""The sufficient statistics of a joint's log file, in a few kilobytes.

columns  a rig and its model -> X and y; their sums as triangles, merged in any order, solved
of_file  a file, batch by batch, as means over windows -> `FileSums`
"""

from eccentric.fleet.sums.columns import OFFSET, SCALE, Columns, Heading, dependent, require_rig, solve
from eccentric.fleet.sums.of_file import Coverage, FileSums, sums_of
