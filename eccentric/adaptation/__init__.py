"""A log through the estimator that `eccentric emit --adapt` writes: how friction went, and what was not seen.

    replay     channels, a fitted model, its prior -> `Replay`: coefficients over time with their bands
    text       the replay as lines, as a document and as a figure

In: `Channels`, a `Model`, the content of a fit. Out: `replayed` -> `Replay`; `course_lines`,
`course_document`, `plot_course`; `require_logged`, before a long fit. The estimator is the emitted Python,
which has the bits of the emitted C.
May import: `signals`, `model`, `emission`.
"""

from eccentric.adaptation.replay import CURRENT, Replay, replayed, require_logged
from eccentric.adaptation.text import course_document, course_lines, plot_course

__all__ = [
    "CURRENT",
    "Replay",
    "course_document",
    "course_lines",
    "plot_course",
    "replayed",
    "require_logged",
]
