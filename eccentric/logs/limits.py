"""Every limit of what is read from a file, each with its reason."""

# Which columns of a file are a log.

SHORTEST_VECTOR = 10
"""Vectors shorter than this are taken for parameters of the rig if there are longer ones."""
MOST_PARTS = 100
"""At most this many columns of a matrix, or elements of a structure array with vectors, are named singly."""
DEEPEST_STRUCTURE = 20
"""Structures nested deeper than this are left out: logs have two or three levels."""

# What a file is, and where the table of a text file is.

FIRST_BYTES = 4096
"""Bytes that show of which format a file is: what names one is first, but for the files in an archive."""
DAY_S = 86_400.0
"""Times of day start again after so long."""

SAMPLE_LINES = 20
"""Lines that show of which width the rows of a table are, and which of its columns are numbers."""
FEWEST_LINES = 5
"""Lines of one width that may be rows of the table: a short group of a scope ends after a few."""
ROWS_OF_A_TABLE = 3
"""Rows in a row that make a table: of two, the first may be a header."""
LAYOUT_LINES = 400
"""Lines that are looked at for the first row: the settings that a scope writes above it are tens."""
PREAMBLE_LINES = 10
"""Lines directly above the first row that the header and its units are looked for in."""
MOST_BROKEN = 0.01
"""Rows of another width than the header are broken where they are no more than this part, or the last one;
where they are more, the table is not what its header says."""

MOST_TEXT = 0.2
"""Part of the rows of a column of numbers that may hold a text, as for a sensor that failed; rows without a
number are refused beyond the same part."""

# Clocks that have to be put right.

FALLING = 0.9
"""A clock of which this part of the steps is downwards runs backwards: the newest row is the first."""
MOST_OUT_OF_ORDER = 5
"""Rows in a row whose time fits into no order are damaged; more than these are another recording."""
FEWEST_IN_PACKETS = 0.01
"""Part of the rows from which shared stamps are the logger's way, and no accident."""
FEWEST_AFTER, FAR_AWAY = 6, 10.0
"""Rows of a recording whose first time is not its own, and how far away that is, in the time that all others
last: a pause before the first row is shorter."""
LONGEST_BREAK = 5.0
"""A packet that takes this many times its usual time is followed by a gap."""

# Channels with clocks of their own.

SIMILAR_RATE = 0.1
"""A channel with fewer rows than this part of the fastest one's is slow, as a temperature or a parameter is:
its first and last row say nothing about when the log begins and ends."""
SIMILAR_TIME = 0.5
"""Nor do those of a channel that was recorded for less than this part of the time: most rows would go."""

WHOLE_CYCLES = 0.9
"""Part of the times that have a row of every joint, in a table of such rows: a logger that is stopped, or
loses a row, leaves few incomplete."""

# What a damaged or hostile file may cost.

MOST_CHARACTERS = 1_000_000_000
"""Longest text of a log: a small gzip file can unpack to more than fits in memory."""
MOST_BYTES = 1_000_000_000
"""Largest variable of a MAT file, unpacked, for the same reason."""
BYTES_PER_ROW, BYTES_PER_VALUE, BYTES_PER_CHARACTER = 350, 60, 6
"""Memory that reading a text takes at its peak: 400 to 740 were measured per row of one to four values, and
rounded up. A fit of the log takes no more than that afterwards."""
MOST_LISTS = 1000
"""Lists of a JSON log that are looked at to count its rows: entries with a list in each have too many."""
BYTES_PER_NUMBER = 160
"""The same for a value of a MAT or Parquet file: 20 to 60 for numbers, 160 for text."""
MEMORY_IF_UNKNOWN = 8_000_000_000
"""Where the system does not say how much memory there is."""
DEEPEST_VARIABLE = 50
"""Nesting at which a MAT variable counts as damaged: each level is a call."""
DEEPEST_REFERENCE = 20
"""References in a file of version 7.3 can go in circles."""

# A file that is read in parts.

BATCH_ROWS = 131_072
"""Rows of a part: some 1 MB a column, where the work on one outweighs its start by far."""
SAMPLE_ROWS = 1000
"""Rows of a CSV file that show whether it can be read in parts: topics take turns within a few of them."""

# Arithmetic on columns.

LONGEST_ARITHMETIC = 500
"""Characters; a longer text is no formula that a person wrote into a rig file."""
DEEPEST_ARITHMETIC = 40
"""Nesting; no formula that a person wrote is deeper, and each level is a call."""
