"""Every limit of a drafted rig, each with its reason."""

MOST_ROWS = 60_000
"""Rows that are looked at: the question is what a column is, not its value to many digits."""
FEWEST_ROWS = 50
"""Below, neither a derivative nor a balance of torques can be told from chance."""

# Time.
RISING = 0.999
"""Share of rows whose time is above that of the row before, within a run: a clock may be set once."""
SLOWEST_HZ, FASTEST_HZ = 2.0, 50_000.0
"""Rates of logs that show a friction torque: below, no acceleration; above, only currents of an inverter."""
SHORTEST_S, LONGEST_S = 0.2, 200_000.0
"""Lengths of logs: from one pulse to two days."""
USUAL_HZ, USUAL_DECADES = 300.0, 0.8
"""Rates that loggers of drives have, and their spread: 50 Hz to 2 kHz are within one."""
GAP = 20.0
"""Time steps above so many usual ones end a stretch."""
UNEVEN = 1.2
"""Ratio of long to short time steps (deciles) from which rows may be events: sampled rows are even, but for
jitter, and a shaft that never changes its speed by so much has nothing to fit."""
FEW_STEPS = 0.02
"""Part of the rows that may count up by more than one where rows are turns: some events are missed."""
ONE_TURN = 0.1
"""Relative scatter (deciles) of speed times step of time up to which it is one turn: speeds are rounded."""

# Moved.
SMOOTH_S, SMOOTH_ROWS = 0.08, 9
"""Window of the local cubic that gives speed and acceleration: the longer of the two."""
DERIVATIVE = 0.9
"""Correlation from which a column is the slope of another: drives filter their speed, which lowers it."""
UNNAMED = 0.97
"""The same for two columns without names, one of which could be a voltage."""
COMPARED, ROUGHLY = 3000, 0.1
"""Points on which pairs of columns are compared first, and how far their correlation is off there at most."""
MANY = 40
"""Columns from which those without a name are looked at only where none has one: each takes time."""
COPY = 0.98
"""Correlation from which a column is another one in other units, or its set value."""
SAME = 0.9999
"""Correlation from which two columns without names are one signal: a current and a voltage stay below it."""
STILL = 0.05
"""Rows slower than this part of the 95th percentile of the speed count as standing."""
WRAP = 0.5
"""A step above this part of the range is a wrap of the angle."""
ODD_COUNTS = 0.2
"""How much rarer an encoder has another number of counts per turn than one that is sold."""
MOVES = 0.1
"""Travel of a joint over that of the one that travels furthest, from which it moves too: less is jitter."""
TRIED = 8
"""Drives of no joint that are tried for it."""
FACTOR = 0.03
"""Relative scatter of the ratio between a logged speed and the slope of the angle: filters cost a little."""
USUAL_SPEED, SPEED_DECADES = 20.0, 0.9
"""Fastest speed of a drive in rad/s, and its spread in decades: 2.5 to 160 rad/s are within one."""

# Explained.
SHOWN = 0.5
"""R^2 from which motion explains a column as it explains a drive; noise and stiction leave less than all."""
SCREENED = 0.35
"""The same in a first look at very many columns, which tries waves of the angle a tenth of a period apart on
a part of the rows: what lies below is not looked at again."""
GRAVITY = 0.02
"""Share of a drive's variance from which a periodic part is gravity: harmonics of friction have its sign and
average out over both directions."""
DRIFTS, GRAVITY_OR_DRIFT = 2.0, 0.1
"""Periods in the travel up to which a drift can be read as a swing, and what gravity has to explain there."""
SAME_COUNTS = 0.003
"""Relative difference of measured counts per turn from a number that encoders have: gears make others."""
HIGHEST_SUPPLY = 60.0
"""Small drives seldom have a supply above this [V]."""
LOW, FEW_VISITS = 0.05, 3
"""Part of the largest speed that counts as near zero, and how often one without a sign gets there."""
BOTH_WAYS = 0.05
"""Part of the motion in the rarer direction from which friction's harmonics can be told from gravity."""
SIGN = 0.05
"""Share of a term from which its sign counts: below, noise decides it."""
SCANNED = 3000
"""Points that the wave number of gravity is searched on."""
MOST_GEAR = 400.0
"""Turns of the logged shaft for one of the link, up to which a gear is plausible: one stage of a cycloidal or
strain wave gear has 30 to 200, and two stages of planets as many."""
HARDLY = 0.05
"""Range of a drive over its largest value up to which it hardly varies: a constant command, or a supply."""
CLIPPED = 0.02
"""Part of the rows at the largest and smallest value from which a sensor may be at the ends of its range."""
COUNTED = 20.0
"""Largest whole number from which a drive without a unit may be in counts, not a coarse sensor."""
COASTS = 0.75
"""Share of the motion in which it slows down, from which it coasts: a driven one comes back to its speed."""
SUPPLY = 0.2
"""The same for a voltage beside another drive: what the speed needs of a voltage would show."""
COUNTERS = (2.0**16, 2.0**32)
"""Periods at which an angle in counts restarts where its counter overflows, as well as after a turn."""
SAME_SHAFT = 0.1
"""Relative error of the number of turns in which gravity repeats: less than two shafts of a gear differ."""
NEAR_WHOLE = 0.02
"""A gear this close to a whole number is taken for it: gravity and a filtered speed say no more."""
MOSTLY_NUMBERS = 0.5
"""Part of the entries of a column that are numbers: a column of text has a number here and there."""
MOST_TURNS = 400
"""Periods within the travel that are tried: an axis that turned further is cut."""
NUMBERS_AT_ONCE = 32
"""Wave numbers that are tried at once: their waves on the points searched fit into the cache."""
DISTINCT = 1e-9
"""Determinant of sin and cos beside the other terms, relative: below it, a log shows one at most."""
TOLD = 0.1
"""Share of a term from which it is told as evidence."""
LIKE_VOLTAGE, OVER_THE_REST = 0.9, 3.0
"""Share of the speed, and its ratio to friction and inertia, from which a current or torque by its name is
doubted: viscous friction reaches less."""
CIRCUIT, LEAST_EMF = 0.9, 0.03
"""R^2 of voltage = R current + k_e speed from which two columns are these, and the least share of the speed:
below it, one is a multiple of the other."""
BACK_EMF = 0.5
"""Share of the explained variance that follows the speed from which a column is a voltage, not a current."""

# Others.
SLOW = 0.03
"""Step from row to row over the range below which a column drifts like a temperature."""
FEW_VALUES = 400
"""Most runs of one log."""

# Posteriors.
TURNS_BY_SYMBOL = 0.1
"""How much rarer turns are under a symbol of mechanics, as theta, and in ROS, than under a word."""
SURE = 0.95
"""Probability below which a doubt is stated."""
