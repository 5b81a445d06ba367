"""A log file of a joint as sums: what a fit of it needs, in a few kilobytes.

pieces    a file, part by part, as stretches of even samples
windows   samples -> means over windows, with the rates of the angle
speeds    the threshold of motion, from the whole file
columns   a rig and its model -> X and y
triangle  X and y -> sums, merged in any order, solved
of_file   all of it: a file -> `FileSums`
"""

from eccentric.fleet.sums.columns import (
    OFFSET,
    SCALE,
    Columns,
    Heading,
    dependent,
    merged,
    require_rig,
    solve,
)
from eccentric.fleet.sums.of_file import Coverage, FileSums, sums_of
