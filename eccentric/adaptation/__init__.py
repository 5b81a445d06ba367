"""Replay of a log through the estimator that `eccentric emit --adapt` writes: friction over time.

    replay     channels, a fitted model, its prior -> `Replay`: coefficients over time with their bands

In: `Channels`, a `Model`, the content of a fit. Out: `replayed` -> `Replay`; `require_logged`, before a long
fit. The estimator is the emitted Python, which is bit-identical to the emitted C.
May import: `signals`, `model`, `emission`.
"""

from eccentric.adaptation.replay import CURRENT, Replay, replayed, require_logged
