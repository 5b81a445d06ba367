"""The elements of a derivation: quantity, equation, balance, term, model, and numerically stable steps.

In: the scripts of `derivations/`, by `load_model`.  Out: `Model`, `interface_of` (its outputs, which emission
prints), `regressor` (the identifiable friction columns), `extended` (a model with further terms), `meaning`
(an expression without the stable steps).
May import: no room but `core`, whose cache keeps models; it knows no data and no templates.
"""

from eccentric.model import steps, vocabulary
from eccentric.model.axis import AXES, LINEAR, TURNING, AxisKind, spoken_quantity, spoken_symbol
from eccentric.model.balance import CONTACT, KINDS, Balance, Equation, Identity, Load, Role, Term
from eccentric.model.chain import (
    ArmOutputs,
    Body,
    Chain,
    DriveSymbols,
    Joint,
    JointDrive,
    Moments,
    Placement,
    Recursion,
    arm,
    at_rest,
    drive_balances,
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
from eccentric.model.functions import (
    ANGLE,
    DRIVE_PARTS,
    GEARS,
    IRON,
    MAGNETS,
    MOTOR_ANGLE,
    MOTORS,
    NO_PART,
    OUTPUT_ANGLE,
    REDUCERS,
    NumericFunction,
    Parts,
    PartValues,
    cached,
    fingerprint,
    function_of,
    missing,
    printed,
)
from eccentric.model.load import in_general_letters, load_model, model_names, with_values
from eccentric.model.model import Change, Extension, Model, extended, spoken
from eccentric.model.output import Assignment, Expressions, Input, Interface, Output, differentiate, needed
from eccentric.model.outputs import drive_interface, interface_of, normal_force, structure_of
from eccentric.model.quantity import C_KEYWORDS, Definition, Quantity, State, quantity, symbols
from eccentric.model.regressor import Column, regressor
from eccentric.model.rest import law_at_rest, levels, moving
from eccentric.model.steps import (
    STEPS,
    Across,
    Along,
    Backward,
    Bounded,
    Bump,
    ByDirection,
    Chord,
    Clipped,
    Forward,
    FromTop,
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
    "ANGLE", "AXES", "CONTACT", "C_KEYWORDS", "DRIVE_PARTS", "GEARS", "IRON", "KINDS", "LINEAR", "MAGNETS",
    "MOTORS", "MOTOR_ANGLE", "NO_PART", "OUTPUT_ANGLE", "REDUCERS", "STEPS", "TURNING", "Across", "Along",
    "ArmOutputs", "Assignment", "AxisKind", "Backward", "Balance", "Body", "Bounded", "Bump", "ByDirection",
    "Chain", "Change", "Chord", "Clipped", "Column", "Definition", "DriveSymbols", "Equation", "Expressions",
    "Extension", "Forward", "FromTop", "Gated", "HalfCosine", "HalfSine", "Identity", "Input", "Interface",
    "Joint", "JointDrive", "Leading", "Load", "Magnitude", "Model", "Moments", "NumericFunction",
    "OpaqueStep", "Output", "PartValues", "Parts", "Placement", "Quantity", "Recursion", "Role", "Sgn",
    "SquareDifference", "State", "Term", "arm", "at_rest", "cached", "differentiate", "drive_balances",
    "drive_interface", "drives", "extended", "fingerprint", "friction_units", "function_of", "identity_of",
    "in_general_letters", "interface_of", "law_at_rest", "letters_of", "levels", "load_model", "meaning",
    "missing", "model_names", "moving", "needed", "normal_force", "printed", "quantity", "recursion",
    "regressor", "spoken", "spoken_quantity", "spoken_symbol", "steps", "structure_of", "symbols", "unlike",
    "vocabulary", "with_bodies", "with_letters", "with_numbers", "with_values",
]  # fmt: skip
