"""Every threshold of this room, each with its reason."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr

from eccentric.diagnosis import PARTS, STABLE, SURE

RATE_HZ = 200.0
"""Sampling rate of a reference: usual for a position controller, and well above the 25 Hz low pass."""
FIRMWARE_HZ = 50
"""Points of the table for firmware, to be interpolated: 36 kB a minute."""
INFORMATIVE_HZ = 50.0
"""Independent samples per second below a low pass of 25 Hz."""
TRAINED = 0.8
"""Fraction of a log used by the search: the rest is held out."""
MARGIN = 0.03
"""Fraction of speed and angle reserved in all pieces, for the overshoot simulated in `separation`."""
ACCELERATION_PART = 0.9
"""Fraction of the acceleration that ramps use: a sampled smoothstep slightly exceeds its nominal peak."""
OFF = 0.1
"""Relative deviation of mass, friction and loop of the true drive from the fitted one."""
LOOPS_HZ = (3.5, 12.0)
"""Bandwidths of the speed loop to cover if none is given: a slow loop overshoots ramps, a fast one needs
more current."""
INTEGRAL_PER_S = 6.0
"""Integral over proportional gain of the loop [1/s]: the upper end of usual values; more overshoots more."""
SPEED_FILTER_HZ = 30.0
"""Corner frequency of the speed filter: the lower end of usual values; its lag costs damping."""
LOOP_STEPS = 2
"""Steps of the simulated loop per sample of the reference: 2.5 ms, half the filter's time constant."""
KEPT = 0.97
"""Fraction of a limit that the simulated drives may use, leaving room for sensor noise."""
RESCALED, LEAST_SCALE = 6, 0.6
"""How often a piece is slowed down to stay within the limits, and its least fraction of speed: below that
the slower pieces on offer serve."""
SLOWER = 0.9
"""Largest factor on the speed when a motion is slowed down."""
SLOWEST_OF = 0.005
"""Slowest motion of interest, as a fraction of the speed limit."""
REST_S = 0.05
"""Rest at the end of a reference [s], to complete the last step of the firmware table."""
NOISE_PEAK = 4.0
"""Peak of the current noise in a minute of samples, in standard deviations."""
WHOLE_TURNS = 10.0 * np.pi
"""Reach of the largest reversals of a drive that turns without end [rad]: five turns of the motor."""
HARDLY = 0.95
"""Remaining fraction of the standard errors: a motion that leaves more of all of them is not worth a run."""
MOST_TIME_S = 3600.0
"""Longest plan: its reference of 200 Hz and the signals of its pieces are held in memory."""
LEAST_TIME_S, LEAST_PIECE_S = 10.0, 4.0
"""Shortest plan, and shortest piece: a stroke at constant speed, back and forth."""
PIECES = 6
"""Most pieces of a plan: further ones repeat the information of the first."""
COARSE = (0.5, 0.75, 1.0, 1.4, 2.0)
"""Factors on a rival's shape parameters while pieces are selected: in between its fit changes little."""
STEPS = 15
"""Refinement steps when judging the selected motion."""
SURPLUS, BEYOND = 5.0, 0.02
"""A motion is selected to separate rivals this many times as far as the probability requires, plus a small
reward for more: the fitted rivals are not quite the true drive."""
HEAVIER = 0.5
"""Added mass as a fraction of the link's, if no motion decides: easily available, and enough to change the
bearing and gear loads."""
ODDS = SURE / (1.0 - SURE)
"""Odds at which a verdict names an effect."""
VARIANTS_AGREE = float(
    brentq(lambda x: np.mean([ndtr(x / np.sqrt(1.0 / f - 1.0)) for f in PARTS]) - STABLE, 0.0, 5.0)
)
"""Lead of the log-likelihood ratio, in units of its spread, for the required fraction of resampled logs to
agree."""
LEAST_CHANCE = 1e-3
"""Least probability of a rival, for one without a probability in the list of candidates."""
UNDECIDED = (2.0 * VARIANTS_AGREE) ** 2
"""Expected deviance at which a verdict names the true one of two in half of the logs. If a log with a larger
one left rivals open, the model errors exceed the noise, and the evidence is discounted."""
SAME_TORQUE = 1.0
"""Deviance over log and motion below which two rivals predict the same torque: noise changes it by more."""
DECIDES = 0.9
"""Probability from which a plan is said to decide."""
WORTH_A_RUN = 0.5
"""Probability below which another motion is not worth the run."""
SHOWN_AT_Z = 5.0
"""Standard errors at which a coefficient counts as shown beyond doubt."""
NOISE_OF_THE_LIMIT = 0.01
"""Default noise of an independent torque sample, relative to the torque at the current limit: a ten-bit
current sensor with a range of several times that current, and the ripple after a low pass."""
SLOW_PART = 0.03
"""Fraction of the largest speed below which rows do not count as moving, as in a fit."""
MOST_TIMES_FASTER = MOST_TIMES_HEAVIER = 100.0
"""Largest multiples of speed and mass to consider."""
WIDER, SEARCH_STEPS = 1.5, 5
"""Factor between successive multiples, and bisections between the last two: within 1 %."""
PIECE_S = 20.0
"""Length of the pieces [s]: longer times are repetitions."""
