"""Formulas as MathML, which browsers typeset themselves: for the report and the manual.

    expression   an expression on one line: letters such as eta_2, stable forms as what they evaluate
    blocks       an equation as a block, a long sum in aligned lines; a formula typed as text

In: SymPy expressions, quantities with their letters, typed formulas. Out: MathML. It imports only
`eccentric.model`.
"""

from eccentric.presentation.html.formulas.blocks import (
    Line,
    aligned,
    block,
    equation,
    short_formula,
    with_symbols,
)
from eccentric.presentation.html.formulas.expression import Typesetter, is_letter, letter, plain
