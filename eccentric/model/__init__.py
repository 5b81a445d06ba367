"""The words of a derivation: quantity, equation, balance, term, model, and the numerically stable steps."""

from eccentric.model.balance import KINDS, Balance, Term
from eccentric.model.change import Change, Extension
from eccentric.model.definition import Definition, State
from eccentric.model.equation import Equation, Identity
from eccentric.model.extension import extended
from eccentric.model.load import load_model, model_names
from eccentric.model.model import Model
from eccentric.model.quantity import Quantity, quantity, symbols
from eccentric.model.regressor import Column, regressor
from eccentric.model.role import CONTACT, Load, Role

__all__ = [
    "CONTACT",
    "KINDS",
    "Balance",
    "Change",
    "Column",
    "Definition",
    "Equation",
    "Extension",
    "Identity",
    "Load",
    "Model",
    "Quantity",
    "Role",
    "State",
    "Term",
    "extended",
    "load_model",
    "model_names",
    "quantity",
    "regressor",
    "symbols",
]
