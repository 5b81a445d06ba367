"""The words of a derivation: quantity, equation, balance, term, model, and the numerically careful steps."""

from eccentric.model.balance import KINDS, Balance, Term
from eccentric.model.equation import Equation, Identity
from eccentric.model.load import load_model, model_names
from eccentric.model.model import Column, Definition, Model, regressor
from eccentric.model.quantity import Quantity, quantity, symbols

__all__ = [
    "KINDS",
    "Balance",
    "Column",
    "Definition",
    "Equation",
    "Identity",
    "Model",
    "Quantity",
    "Term",
    "load_model",
    "model_names",
    "quantity",
    "regressor",
    "symbols",
]
