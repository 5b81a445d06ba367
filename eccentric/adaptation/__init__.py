"""A log through the estimator that `eccentric emit --adapt` writes: how friction went, and what was not seen.

    inputs     channels -> the signals that the estimator takes
    course     channels, a fitted model, its prior -> `Replay`: coefficients over time with their bands
    told       the course as text and as a document
    figure     the course as a figure

In: `Channels`, a `Model`, the content of a fit. Out: `replayed` -> `Replay`; `course_lines`,
`course_document`, `plot_course`; `require_logged`, before a long fit. The estimator is the emitted Python,
which has the bits of the emitted C.
May import: `signals`, `model`, `emission`.
"""

from eccentric.adaptation.course import Replay, replayed
from eccentric.adaptation.figure import plot_course
from eccentric.adaptation.inputs import CURRENT, require_logged
from eccentric.adaptation.told import course_document, course_lines

__all__ = [
    "CURRENT",
    "Replay",
    "course_document",
    "course_lines",
    "plot_course",
    "replayed",
    "require_logged",
]
