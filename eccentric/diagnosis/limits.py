"""Every threshold of the diagnosis, each with its reason; the search has its own."""

from __future__ import annotations

FEWEST_RUNS = 5
"""Least number of runs for a gain over whole runs: its interval draws runs, and four say little."""
LEAST_ZERO_RAD = 0.003
"""A zero angle that moves by less changes the friction under F_N by a third of a percent at most."""
FITTED = 3
"""Effects that are fitted, at most, to show the best one where none is adopted: each costs a whole fit."""
MOST_APART = 100.0
"""Electrical residual over the larger of R i and k_e w: a k_e in V/rpm reaches ten, a voltage in mV 1000."""
OF_THE_MOTION = {"motor_angle", "link_angle", "velocity", "direction"}
"""What an effect depends on first if it may be most of what a drive does: it is ripple, or over the speed."""
PROVABLE = 3.0
"""A residual above this multiple of the sensors' noise has a cause, found or not."""

LEAST_DIFFERENCE = 0.1
"""Least difference of a run's friction or gain from the nearest other run: two runs of one rig often differ
by some percent."""
LEAST_OTHERS = 3
"""Fewest other runs: two do not show how much runs of one rig differ."""
LEAST_SHARE_OF_LOAD = 0.05
"""Least standard deviation of inertia and gravity torque, over that of the drive: less gives no gain."""

# Periodic residuals within runs.

LEAST_TURNS = 2.0
"""A stretch of fewer turns does not separate neighbouring orders."""
LOWEST_ORDER, HIGHEST_ORDER, ORDER_STEP = 0.5, 12.0, 0.05
"""Orders per motor turn that are examined, and the step from one to the next."""
AROUND = 41
"""Steps that count as around a peak: two orders."""
NEIGHBOURS = 2
"""Steps to either side whose best counts for a peak: an order is known only to the inverse of the turns."""
ALONE = 8
"""Steps to either side within which a peak is the highest order of its stretch."""
ALIKE = 1e-8
"""Determinant of sine and cosine over the square of the rows below which one is the other, or nothing."""
ROWS_PER_CYCLE = 4.0
"""Of the highest order, at least: two resolve it, and the margin keeps it from being aliased."""
LEAST_SHARE = 0.04
"""Least fraction of the variance within the stretches; less is not worth a line."""
ABOVE = 4.0
"""A peak over the median of the spectrum around it: slow drift is high at low orders, but not periodic."""
LEAST_STRETCHES = 6
"""Chance can give a peak of the same order in one stretch, or in three, but not in most of six."""
ROUNDING = 1e-6
"""Gains between two models that stay below this, in per cent, are rounding: the models are the same."""

# A term without a cause.

EMPIRICAL_MOST = 24
"""Most coefficients of the term: what firmware evaluates in constant time."""
EMPIRICAL_PIECES = (2, 3, 4, 6, 8, 11, 15)
"""Pieces of a curve that are tried."""
EMPIRICAL_TURN = (3, 4, 6, 8, 12, 16, 22)
"""The same over an angle, which closes."""
EMPIRICAL_STIFF = (1e-3, 1e-1)
"""Weight of the differences of neighbouring coefficients, over that of the data."""
EMPIRICAL_GROUPS = 24
"""Groups of blocks, at most, each left out once: a hundred and fifty curves are tried."""
EMPIRICAL_RANGE = (0.002, 0.998)
"""Quantiles of a variable between which a curve has its knots; it is constant beyond."""
EMPIRICAL_WITHIN = 0.01
"""Part of the least cross-validated sum of squares by which that of a shorter term may be larger."""
EMPIRICAL_CLEARLY = 2.0
"""Standard errors, over the blocks, by which a curve has to reduce the cross-validated sum of squares."""
EMPIRICAL_LEAST = 0.02
"""Part of that sum by which it has to: a hundredth of the error is not worth code without a cause."""
EMPIRICAL_NOTHING = 1e-9
"""A coefficient, or a range of a variable, below this part of the largest is none."""
ONE_WAY = 0.01
"""Largest part of the rows that turn the other way in a log of one direction: noise around rest."""
