"""A log through the estimator that `eccentric emit --adapt` writes: how friction went, and what was not seen.

    replay     channels, a fitted model, its prior -> `Replay`: coefficients over time with their bands

In: `Channels`, a `Model`, the content of a fit. Out: `replayed` -> `Replay`; `require_logged`, before a long
fit. The estimator is the emitted Python,
which has the bits of the emitted C.
May import: `signals`, `model`, `emission`.
"""

from eccentric.adaptation.replay import CURRENT, Replay, replayed, require_logged
