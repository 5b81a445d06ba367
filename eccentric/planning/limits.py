"""Every threshold of the planning, each with its reason."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr

from eccentric.diagnosis import PARTS, STABLE, SURE

RATE_HZ = 200.0
"""Samples of a reference: what a position controller takes, and fine beside the 25 Hz of the low pass."""
FIRMWARE_HZ = 50
"""Points of the table for firmware, to be interpolated: 36 kB a minute."""
INFORMATIVE_HZ = 50.0
"""Independent samples that a second has below a low pass of 25 Hz."""
TRAINED = 0.8
"""Part of a log that the search sees: the rest is held out."""
MARGIN = 0.03
"""Part of speed and angle that no piece is offered with: the reserve of what is simulated in `separation`."""
ACCELERATION_PART = 0.9
"""Part of the acceleration that ramps use: a smoothstep on a grid of samples exceeds its own by little."""
OFF = 0.1
"""Part by which mass, friction and loop of the true drive may differ from the fitted one."""
LOOPS_HZ = (3.5, 12.0)
"""Bandwidths of the speed loop that a motion has to suit where none is given: a slow one overshoots ramps, a
fast one takes more current."""
INTEGRAL_PER_S = 6.0
"""Integral over proportional gain of the loop [1/s]: the upper end of what is usual; more overshoots more."""
SPEED_FILTER_HZ = 30.0
"""Corner of the filter of the speed: the lower end of what is usual; its lag costs damping."""
LOOP_STEPS = 2
"""Steps of the simulated loop per sample of the reference: 2.5 ms, half of the filter's time."""
KEPT = 0.97
"""Part of a limit that the simulated drives may use: the sensors of the drive have noise, too."""
RESCALED, LEAST_SCALE = 6, 0.6
"""How often a piece is made slower to keep its limits, and what part of its speed it keeps: what is slower
than that is left to the slower pieces on offer."""
SLOWER = 0.9
"""Most of its speed that a motion keeps when it is made slower."""
SLOWEST_OF = 0.005
"""Part of the limit of speed at which a motion is the slowest of interest."""
REST_S = 0.05
"""Rest at the end of a reference, which rounds it to whole steps of the table for firmware."""
NOISE_PEAK = 4.0
"""Standard deviations of the current's noise that count as its peak, in a minute of samples."""
WHOLE_TURNS = 10.0 * np.pi
"""Reach of the largest reversals of a drive that turns without end [rad]: five turns of the motor."""
HARDLY = 0.95
"""Part of a standard error that remains: a motion that leaves more of all of them is not worth a run."""
MOST_TIME_S = 3600.0
"""Longest plan: its reference of 200 Hz and the signals of its pieces are held in memory."""
LEAST_TIME_S, LEAST_PIECE_S = 10.0, 4.0
"""Shortest plan, and shortest piece of it: a stroke at constant speed, there and back."""
PIECES = 6
"""Pieces of a plan: more of them repeat what the first ones show."""
COARSE = (0.5, 0.75, 1.0, 1.4, 2.0)
"""Factors on the shapes of a rival while pieces are chosen: between them its fit changes little."""
STEPS = 15
"""Steps of the refinement that the chosen motion is judged with."""
SURPLUS, BEYOND = 5.0, 0.02
"""A motion is chosen to leave rivals this many times as far apart as its probability would require, and a
little farther still: the fitted rivals are not quite the true drive."""
HEAVIER = 0.5
"""Part of the mass on the link that is added where no motion decides: what a person has at hand, and enough
to change the loads of the bearing and of the gear."""
ODDS = SURE / (1.0 - SURE)
"""Odds at which a verdict names an effect."""
VARIANTS_AGREE = float(
    brentq(lambda x: np.mean([ndtr(x / np.sqrt(1.0 / f - 1.0)) for f in PARTS]) - STABLE, 0.0, 5.0)
)
"""Spreads of the log-likelihood ratio by which it has to be ahead for so many variants to find the same."""
LEAST_CHANCE = 1e-3
"""What keeps a rival in the contest that the list of candidates has no probability for."""
UNDECIDED = (2.0 * VARIANTS_AGREE) ** 2
"""Expected deviance at which a verdict names the true one of two in half of the logs. Rivals that a log left
open although its noise should have shown more differ by more than noise: their evidence is worth less."""
SAME_TORQUE = 1.0
"""Deviance over log and motion below which two rivals predict the same torque: noise moves it by more."""
DECIDES = 0.9
"""Probability from which a plan is said to decide."""
WORTH_A_RUN = 0.5
"""Probability below which another motion is not worth the run."""
SHOWN_AT_Z = 5.0
"""Standard errors at which a coefficient counts as shown beyond doubt."""
NOISE_OF_THE_LIMIT = 0.01
"""Noise of an independent sample of the torque over the torque of the largest current, where none is known: a
drive's ammeter with ten bits on a range of some times that current, and the ripple that a low pass leaves."""
SLOW_PART = 0.03
"""Part of the largest speed below which rows do not count as moving, as in a fit."""
MOST_TIMES_FASTER = MOST_TIMES_HEAVIER = 100.0
"""Multiples of speed and mass up to which a rig is imagined."""
WIDER, SEARCH_STEPS = 1.5, 5
"""Factor from one multiple to the next that is tried, and bisections between the last two: within 1 %."""
PIECE_S = 20.0
"""Length of the pieces that are tried: longer times are repetitions."""
