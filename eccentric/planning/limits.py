"""Every threshold of the planning, each with its reason."""

from __future__ import annotations

__all__ = [
    "ACCELERATION_PART",
    "COARSE",
    "DECIDES",
    "EVALUATIONS",
    "FIRMWARE_HZ",
    "INFORMATIVE_HZ",
    "LEAST_PIECE_S",
    "LEAST_TIME_S",
    "MARGIN",
    "PIECES",
    "RATE_HZ",
    "SURE",
    "TRAINED",
    "UNDECIDED",
    "VARIANTS_AGREE",
    "WORTH_A_RUN",
]

RATE_HZ = 200.0
"""Samples of a reference: what a position controller takes, and fine beside the 25 Hz of the low pass."""
FIRMWARE_HZ = 50
"""Points of the table for firmware, to be interpolated: 36 kB a minute."""
INFORMATIVE_HZ = 50.0
"""Independent samples that a second has below a low pass of 25 Hz."""
TRAINED = 0.8
"""Part of a log that the search sees: the rest is held out."""
MARGIN = 0.15
"""Part of every limit that stays unused: parameters of a drive are off by some percent, and a loop of a few
hertz overshoots the end of a ramp by a tenth of the speed."""
ACCELERATION_PART = 0.5
"""Part of the acceleration that ramps use: the loop has to make up what it lags behind."""
LEAST_TIME_S, LEAST_PIECE_S = 10.0, 4.0
"""Shortest plan, and shortest piece of it: a stroke at constant speed, there and back."""
PIECES = 6
"""Pieces of a plan: more of them repeat what the first ones show."""
COARSE = (0.5, 0.75, 1.0, 1.4, 2.0)
"""Factors on the shapes of a rival while pieces are chosen: between them its fit changes little."""
EVALUATIONS = 60
"""Fits of the refinement that the chosen motion is judged with."""
SURE = 9.0
"""Odds at which a verdict names an effect: a probability of 0.9."""
VARIANTS_AGREE = 1.28
"""Standard normal quantile of 0.9: nine variants of the log in ten must find the same."""
UNDECIDED = (2.0 * VARIANTS_AGREE) ** 2
"""Expected deviance at which a verdict names the true one of two in half of the logs. Rivals that a log left
open although its noise should have shown more differ by more than noise: their evidence is worth less."""
DECIDES = 0.9
"""Probability from which a plan is said to decide."""
WORTH_A_RUN = 0.5
"""Probability below which another motion is not worth the run."""
