"""The words of a derivation: quantity, equation, balance, term, model, and the numerically careful steps."""

from eccentric.model.balance import KINDS, Balance, Term
from eccentric.model.equation import Equation, Identity
from eccentric.model.load import load_model, model_names
from eccentric.model.model import Definition, Model, State
from eccentric.model.quantity import Quantity, quantity, symbols
from eccentric.model.regressor import Column, regressor
from eccentric.model.role import CONTACT, Load, Role

__all__ = [
    "CONTACT",
    "KINDS",
    "Balance",
    "Column",
    "Definition",
    "Equation",
    "Identity",
    "Load",
    "Model",
    "Quantity",
    "Role",
    "State",
    "Term",
    "load_model",
    "model_names",
    "quantity",
    "regressor",
    "symbols",
]
