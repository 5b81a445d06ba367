"""Every threshold of this room, each with its reason."""

HORIZONS_S = (0.1, 0.5, 2.0)
"""Horizons [s] of the windows: a step of a controller, a swing, a motion."""
EVERY = 0.5
"""A window starts every so many horizons: half of it is shared with the next one."""
LONGEST_STEP_S = 1e-3
"""Longest step of an integration [s]: on the bundled log and on a hobby servo, half of it changes no
simulated error by more than one per cent."""
FEW_SPANS = 4
"""Spans up to which numbers, one span after the other, are faster than arrays of all spans."""
TRACES = 4
"""Parts of a log in a figure."""
REFINED_S = 0.5
"""Horizon [s] of the windows of a refinement where no controller is simulated: long enough to show friction,
and too short for a pendulum to go over the top in one direction and not in the other."""
STEP_PART = 1e-3
"""Step of a slope by a value, over what it would be if it made up all of the drive: small beside what a log
shows of it, and large beside the rounding of a motion that sticks and slips."""
AT_BOUND = 1e-6
"""The same part of a value within which it is at a bound: a bounded search stops short of it."""
LOST = 10.0
"""Error [rad] that counts for any larger one: a motion that is lost is no worse for being further away."""
MOST_EVALUATIONS = 40
"""Steps of a refinement at most; those seen end before."""
CONVERGED = 1e-4
"""Relative change of the cost or of all values that ends a refinement: results have four digits."""
LEAST_DECAY = 1e-6
"""Part of the speed that damping takes in a step from which on it counts in what a torque gives in the step:
half of this is the relative error of that."""
MOST_DRAWS = 1000
"""Times that parameter sets outside the bounds are drawn again: what is left then is moved to the bounds."""
