"""The Program of a model: ordered assignments in primitive operations, printed alike by all back ends.

In: a `Model`. Out: `build_program(model)`, a `Program` of routines, private helpers and parameter-only work,
with bounds of its rounding errors.
It knows how numbers are represented, but no target and no spelling.
Imports `eccentric.model`.
"""

from eccentric.emission.program import accuracy
from eccentric.emission.program.accuracy import (
    BITS,
    LARGEST_ANGLE,
    LARGEST_RATIO,
    LEADING_BITS,
    TURN_BITS,
    Bound,
    polynomial,
)
from eccentric.emission.program.build import SHORTEST, WHOLE, Arrays, Choice, build_program
from eccentric.emission.program.program import (
    ABSENT,
    COSINE,
    ROUNDER,
    SINE_RATIO,
    AtMost,
    Call,
    Condition,
    Helper,
    InSingle,
    Low,
    Minus,
    Over,
    Pick,
    Plus,
    Program,
    Root,
    Rounded,
    Routine,
    Size,
    Times,
    TurnLeft,
    Within,
    paired,
)
