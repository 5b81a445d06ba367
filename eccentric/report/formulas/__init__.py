"""Formulas as MathML, which browsers typeset themselves: for the report and the manual.

    letters      eta_2, B_lN^+, Delta k_e -> letters with Greek, indices and exponents
    reading      stable forms of a model -> the functions that they evaluate, common factors extracted
    expression   an expression on one line
    blocks       an equation as a block, a long sum in aligned lines
    short        a formula typed as text, within a sentence

In: SymPy expressions, quantities with their letters, typed formulas. Out: MathML. It imports only
`eccentric.model`.
"""

from eccentric.report.formulas.blocks import Line, aligned, block, equation
from eccentric.report.formulas.expression import Typesetter
from eccentric.report.formulas.letters import letter
from eccentric.report.formulas.reading import plain
from eccentric.report.formulas.short import short_formula

__all__ = ["Line", "Typesetter", "aligned", "block", "equation", "letter", "plain", "short_formula"]
