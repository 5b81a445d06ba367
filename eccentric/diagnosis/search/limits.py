"""Every threshold of the search, each with its reason.

Those of the decision were calibrated on development seeds of the virtual bench; the published benchmark uses
none of them.
"""

from __future__ import annotations

# The gain that adopting an effect requires.

LEAST_DEVIANCE = 24.0
"""Twice the log-likelihood that an addition must gain: less may be chance.

Controls of the bench stay below 22; `stability.null_quantile` gives the level of each log as well.
"""
LEAST_SHARE = 0.0015
"""RMS that an addition must remove from the residual, as a fraction of the balance's scale: filters and the
sampling of voltage and current cause errors. On 248 controls of the bench nothing beyond chance removed
0.001; half as much again is the margin."""
LEAST_PART = 0.0003
"""The same squared, as a fraction of all the structure found so far: a small remainder beside a large effect
is an error in that effect's form."""
LEAST_PART_OF_SECOND_ORDER = 0.003
"""The same for a family that looks like what the record of another effect leaves out: 5 % of its RMS."""
LAGS = 46
"""Lags of the measured current at which the noise of the electrical balance is looked for, over the range of
`sensor_delay`, 2 ms apart, half a row of most logs: what is fast and real cancels at the true one only."""
CLEARS = 0.5
"""Fraction of what is left above the sensors' noise floor that a second or third effect must explain: less
only corrects the form of the first. Of what is left far beyond the noise, a smooth term as well."""
AT_FLOOR = 1.02
"""Sum of squares, in units of the sensors' noise floor, below which the search stops: the estimate of the
noise is uncertain by 2 %."""
BELOW_NOISE = 0.8
"""Fraction of the sensors' noise floor below which a fit must have noise on both sides of its equation (the
measured current as its own regressor): the floor is known to some 10 %, so no valid fit is a fifth below
it."""
KEPT_BY_INSTRUMENTS = 0.5
"""Part of a candidate's torque that instruments must find: all of it where its columns are free of the
target's noise, none where that noise is what was fitted."""
CLEARLY = 3.0
"""Standard errors by which they must find it."""
MOST_EFFECTS = 3
"""Most effects adopted per balance: no log of a minute has shown more."""

LEAST_MOTION = 0.995
"""Part of the squared speed that lies in the band of the instruments: below it ends the motion, and the noise
that the speed loop makes of ripple and quantisation begins."""
LOWEST_BAND_HZ = 2.0
"""The lowest such band, doubled until it holds the motion."""
CONFIRMED = 8.0
"""Deviance that a candidate has to gain on its instrument, or in a variant of the log: it was not chosen
there, so that one column gains more than 6.6 by chance in one log of a hundred."""
BEYOND_NOISE = 9.0
"""A gain, or what is left, above this multiple of the sensors' noise, in squares, cannot be noise, even of a
loop that rings: it is three times its RMS. Candidates that were their own noise took out half of it at
most."""
CONFIRMED_PART = 0.15
"""Part of the squares that it takes out which its instrument has to take out: less is the noise of its own
signals, and a remainder. Noise takes less than 0, and true effects that follow the current, which the
instrument blurs, 0.4."""

# How alternatives are weighed.

SURE = 0.8
"""Least probability of a named effect: on the log itself a special case tied with its general form has 0.88,
a third family tied with both reduces it to less."""
SPECIAL = 2.0
"""Log-odds of a special case over the family that contains it: it explains as much with fewer parameters."""
ONE_CAUSE = 0.95
"""Part of the gain of a further effect that another order of an adopted one must have to be as likely."""
POSSIBLE = 0.05
"""Least probability of a family that counts as explaining the log equally well."""
DIVERGED = 10.0
"""Cross-validated error over that of the base model from which on a candidate is not listed: its coefficients
are not determined, and the number says nothing."""
SAME = 1e-6
"""Relative difference of the losses of a block up to which two families predict it alike: rounding, and the
ridge of every fit."""
FORMS_OF_A_PATCH = 3
"""Number of members of one family that no longer count as an effect: one or two orders do, three approximate
a shape that none of them has."""
LEAST_PERIODS = 1.0
"""Periods that a log has to travel for an effect that repeats with an angle to be named: over less, any curve
is a part of a wave, and nothing in the log has repeated. Two orders of one family part by as much: nearer
ones approximate any curve together."""

# How stable a name is.

VARIANTS = 100
"""Variants of a log: shares of them are known to some percent."""
PARTS = 0.8, 0.5
"""Parts of the blocks that a variant has. Had another fifth of the log been held out, four fifths of these
blocks would have stayed; half of them is the choice of stability selection."""
IN_A_DRAW = 2.0
"""Log-odds in a variant over those on the log: half of the log has the weight of the whole there, so that
what a superfluous parameter gains by chance counts twice; in four fifths it counts 1.25 times."""
STABLE = 0.9
"""Least share of the variants that find a named effect."""
WRONG = 1.0
"""Standard deviations beyond which a declared value that a variant finds off is part of its model: a third of
all values are off by more, and what is off by less is no news."""
IN_PLACE = 2
"""Families that may be tied with one that is not stable: if three take its place, nobody knows what it is."""
LEAST_BLOCKS = 32
"""Fewest blocks to draw from: of a few whole runs, a draw often lacks the only ones that determine a
coefficient (the back-EMF without a second run with the motor off)."""
CLOSE = 24
"""Models compared in every variant, best first: one that loses by more on the whole log wins no draw."""

# Structure that no effect explains.

UNEXPLAINED = 0.04
"""Fraction of the structure that a smooth term must explain beyond the effects for the name to be refused."""
UNEXPLAINED_OVER_RUNS = 0.15
"""The same where every run is predicted from the others: no two runs are quite the same, and a named effect
has yet to predict those held out."""
EXTRAPOLATED = 4.0
"""A block counts for nothing if a smooth term multiplies its loss by this: it had to extrapolate there."""
HIDES = 2.0
"""Factor on the noise floor beyond which what is left is not noise alone: twice the power."""

# Effects that both balances show.

MOST_BESIDE = 2
"""Times that an effect of both balances is estimated anew, first beside the largest mechanical effect, then
beside two if there are two, each time with a search: the second finds what the first estimate hid."""

HINTED = 4.0
"""Deviance from which the circuit speaks for an effect on the flux that the torque shows, or against it: odds
of e^2, 7 to 1. Nothing is fitted there: the coefficients are the torque's."""

# Orders of the motor that stand out.

GRAVITY_ORDERS = 3
"""Harmonics of the link that gravity leaves where mass, angle or torque constant are not quite the rig's."""
BINS_PER_TURN = 64
"""Bins of the motor angle per turn: eight for a period of the highest order that is looked for."""
PADDED = 4
"""Steps of the spectrum per width of a peak: the nearest is off by an eighth of a cycle over the log."""
AROUND_A_PEAK = 4.0
"""Orders around a peak whose median is its floor: on a short log the sides of the peak itself fill one."""
STANDS_OUT = 25.0
"""Least power over that floor: among a thousand orders chance reaches 20 in one log of a thousand."""
MOST_PEAKS = 40
"""Peaks that are looked at, the strongest first: harmonics of motor and link are among them."""
FEW_TURNS = 8.0
"""Range of the angle, in turns, up to which every order is fitted: peaks of a spectrum are so wide there that
their sides hide its floor, and what is taken out shifts them."""
MOST_TURNS = 20_000.0
"""Longest range of the angle, in turns: no bearing keeps its phase for as long."""

# The level that chance reaches.

LEVEL = 0.99
"""Quantile: the level that chance reaches in one log out of a hundred."""
DRAWS = 200
"""Draws of random signs for the blocks: two of them lie above the 99 % quantile."""
COLUMNS_AT_ONCE = 256
"""Columns of the library whose gains by chance are computed at once: 2 MB for a thousand rows."""
SIGNS, AT_ONCE = 1000, 50
"""Draws of random signs that a gain has to beat, every one, and how many are computed at once."""
TAIL, CHANCE = 0.1, 1e-4
"""The part of the draws that shows how their gains fall off, and how rarely chance may reach a gain."""
WITH_NOISE = frozenset({"acceleration", "current", "voltage"})
"""Variables with noise that the target has as well: a speed loop turns that of the angle into all three."""
MOST_LAGS = 60
"""Longest autocorrelation of a residual, in rows: a second of overlapping windows."""
ROWS_FOR_ONE = 2.0
"""Fewest rows that count as one: windows overlap by half."""

# The ranges of the library on a log, and of smooth terms.

TOP_SPEED, TOP_CURRENT = 0.99, 0.995
"""Quantiles that count as the highest speed and current of a log: single rows are noise."""
SLOWEST, SLOWEST_PART = 0.002, 0.5
"""The lowest speed of shapes: half of this quantile, since a Stribeck velocity may lie below it ..."""
SPEED_RANGE = 400.0
"""... and the highest over this at least: below, nothing of a Stribeck curve is left in the log."""
LEAST_LOSS_W = 1e-12
"""Loss that counts as none, W: a thermal drift is in proportion to it, and zero has no scale."""
PIECES = {
    "velocity": 14,
    "direction": 8,
    "acceleration": 8,
    "time": 12,
    "slope": 5,
    "gravity_load": 8,
    "current": 12,
    "voltage": 12,
    "temperature": 5,
}
"""Pieces of the splines of smooth terms: what friction has over speed is steepest, what it has over a
temperature is nearly a line; "direction" is what differs between the directions over speed, "slope" the
viscous friction over time."""
MOTOR_ORDERS, LINK_ORDERS = 8, 12
"""Highest orders per turn of smooth terms: cogging has the number of poles, a gear and its link more."""
KNOTS = 0.002, 0.998
"""Quantiles between which a spline has its knots: single rows beyond have nothing to determine a piece."""

# How it is computed.

NEIGHBOUR = 0.6
"""Distance of the points that are tried beside the best of the grid, in its spacings: within its cell."""
DERIVATIVE_STEP, SHAPE_TOLERANCE, LOSS_TOLERANCE = 1e-3, 2e-4, 1e-6
"""Of a refinement, in ranges of a shape and parts of the loss: no log resolves a thousandth of a range."""
INSIDE = 1e-6
"""A search that begins at the end of a range could not leave it."""
RIDGE = 1e-2
"""Penalty of smooth terms: a piece of a spline without rows stays at zero."""
ALIASED = 1e-10
"""Relative ridge of every fit: far below what a log resolves, and far above the rounding of its sums."""
NO_RANGE = 1e-9
"""Part of its size below which the range of a signal is rounding: nothing depends on it smoothly."""
NOTHING = 1e-12
"""RMS of a column, in its own unit, below which it is rounding and explains nothing."""
ORDER_OF_DRAWS = 7
"""Seed of the variants: the same log always has the same."""

# How far the search looks.

MOST_GROUPS = 64
"""Groups of neighbouring blocks that the cross-validation leaves out in turn, at most: a fit for each of the
thousand blocks of a long log takes longer and is no better than one to 97 % of it."""
LEADERS = 8
"""Candidates whose shapes are refined; four times as many are cross-validated at their grid point."""
STEPS = 15
"""Steps of a refinement, most of which end after five."""
SIMPLEX_STEPS = 4
"""Fits for each step of a refinement without slopes: as many as least squares takes for three shapes."""
FIRST_STEPS = 4
"""The same before the comparison, for what changes the base: its grid is coarse."""
TOGETHER = 3
"""Leaders beside other effects whose shapes are refined with those of the others."""
TRIED = 2
"""Leaders of a step that are refined in all their shapes and compared."""
PARTNERS = 3
"""Families tried as half of a pair, the first one included."""
NEAR = 2.0
"""A pair is refined and swapped if its score is below this multiple of the best single effect's: from a worse
one, swaps only lead to that effect and its partner, which are tried anyway."""
LEADERS_OF_A_PARTNER = 3
LEADERS_OF_A_SWAP = 4
"""Candidates refined beside a variant that is kept: only the best few can take the place."""
SWAPPED = 0.995
"""A swap must bring the score below this fraction, so that two effects do not alternate."""
CHANGES = 3
"""Most changes that the comparison with alternatives may make, so that it ends for any log."""
TINY_COLUMN = 1e-4
"""A column is linearly dependent if base and variants leave less than this fraction of its length."""
MOST_KEPT = 200
"""Columns and changed bases kept in memory: refinements return to a few."""
