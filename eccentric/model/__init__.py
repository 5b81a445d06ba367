"""The words of a derivation: quantity, equation, balance, term, model, and the numerically stable steps.

In: the scripts of `derivations/`, by `load_model`.  Out: `Model`, `regressor` (what of its friction a log can
show), `extended` (a model with further terms), `meaning` (an expression without the stable steps).
May import: no room but `output`, whose cache keeps models; it knows no data and no templates.
"""

from eccentric.model import steps, vocabulary
from eccentric.model.axis import AXES, LINEAR, TURNING, AxisKind
from eccentric.model.balance import KINDS, Balance, Term
from eccentric.model.chain import (
    Body,
    Chain,
    Joint,
    JointDrive,
    Moments,
    Placement,
    Recursion,
    arm,
    at_rest,
    drives,
    friction_units,
    identity_of,
    letters_of,
    recursion,
    unlike,
    with_bodies,
    with_letters,
    with_numbers,
)
from eccentric.model.change import Change, Extension
from eccentric.model.defaults import in_general_letters, with_values
from eccentric.model.definition import Definition, State
from eccentric.model.equation import Equation, Identity
from eccentric.model.exact import fingerprint
from eccentric.model.extension import extended
from eccentric.model.functions import NumericFunction, PartValues, function_of, printed
from eccentric.model.load import load_model, model_names
from eccentric.model.model import Model
from eccentric.model.quantity import Quantity, quantity, symbols
from eccentric.model.regressor import Column, regressor
from eccentric.model.reserved import C_KEYWORDS
from eccentric.model.role import CONTACT, Load, Role
from eccentric.model.spoken import spoken_quantity, spoken_symbol
from eccentric.model.spoken_model import spoken
from eccentric.model.steps import (
    STEPS,
    Across,
    Along,
    Backward,
    Bounded,
    ByDirection,
    Chord,
    Forward,
    Gated,
    HalfCosine,
    HalfSine,
    Leading,
    Magnitude,
    OpaqueStep,
    Sgn,
    SquareDifference,
    meaning,
)

__all__ = [
    "AXES",
    "CONTACT",
    "C_KEYWORDS",
    "KINDS",
    "LINEAR",
    "STEPS",
    "TURNING",
    "Across",
    "Along",
    "AxisKind",
    "Backward",
    "Balance",
    "Body",
    "Bounded",
    "ByDirection",
    "Chain",
    "Change",
    "Chord",
    "Column",
    "Definition",
    "Equation",
    "Extension",
    "Forward",
    "Gated",
    "HalfCosine",
    "HalfSine",
    "Identity",
    "Joint",
    "JointDrive",
    "Leading",
    "Load",
    "Magnitude",
    "Model",
    "Moments",
    "NumericFunction",
    "OpaqueStep",
    "PartValues",
    "Placement",
    "Quantity",
    "Recursion",
    "Role",
    "Sgn",
    "SquareDifference",
    "State",
    "Term",
    "arm",
    "at_rest",
    "drives",
    "extended",
    "fingerprint",
    "friction_units",
    "function_of",
    "identity_of",
    "in_general_letters",
    "letters_of",
    "load_model",
    "meaning",
    "model_names",
    "printed",
    "quantity",
    "recursion",
    "regressor",
    "spoken",
    "spoken_quantity",
    "spoken_symbol",
    "steps",
    "symbols",
    "unlike",
    "vocabulary",
    "with_bodies",
    "with_letters",
    "with_numbers",
    "with_values",
]
