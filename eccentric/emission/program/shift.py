"""An angle shifted by a parameter: theta_m and the shift are reduced separately, never added first.

Their sum would be rounded to the digits of theta_m, and near its zero F_N depends on those that follow.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import sympy as sp

from eccentric.emission.program.prepare import Prepare
from eccentric.emission.program.primitive import InSingle, Low, Minus, Plus, Rounded
from eccentric.emission.program.program import Assignment, needed
from eccentric.model import HalfCosine, HalfSine, Leading

_Results = Sequence[tuple[str, sp.Expr]]


def written_out(
    assignments: Sequence[Assignment], results: _Results, fixed: Collection[sp.Symbol]
) -> tuple[list[Assignment], list[tuple[str, sp.Expr]]]:
    """Half-turn steps of a defined angle, replaced by those of the angle that it shifts.

    Args:
        assignments: the definitions, in order.
        results: label and expression.
        fixed: the parameters.
    """
    angles = {a.target: a.value for a in assignments if sum(split(a.value, fixed)) != 0}

    def plain(value: sp.Expr) -> sp.Expr:
        turning = [e for e in value.atoms(HalfCosine, HalfSine) if e.args[0] in angles]
        return value.xreplace({e: e.func(angles[e.args[0]], e.args[1]) for e in turning})

    written = [Assignment(a.target, plain(a.value), a.note) for a in assignments]
    wanted = [(label, plain(expression)) for label, expression in results]
    return list(needed(written, [expression for _, expression in wanted])), wanted


def split(angle: sp.Expr, fixed: Collection[sp.Symbol]) -> tuple[sp.Expr, sp.Expr]:
    """A symbol and its shift, both 0 if the angle is anything else."""
    shift = sp.Add(*(a for a in sp.Add.make_args(angle) if a.free_symbols <= set(fixed)))
    moving = angle - shift
    return (moving, shift) if moving.is_Symbol else (sp.Integer(0), sp.Integer(0))


def parts(shift: sp.Symbol, first: sp.Symbol, prepare: Prepare) -> list[sp.Symbol]:
    """The shift in parts of few digits, subtracted after those of the period, each after its own.

    The first is a multiple of the last digit of the period's first part: a number of half turns of that,
    minus the shift's, is exact, and so is the small remainder of theta_m at the top.
    """
    twice = 2 * first  # so that the sum is not small, whatever the sign of the shift
    one = prepare(f"{shift.name}_1", Minus(Leading(Plus(twice, shift)), twice))
    two = prepare(f"{shift.name}_2", Leading(Minus(shift, one)))
    left = prepare(f"{shift.name}_left", Plus(Minus(Minus(shift, one), two), Low(shift)))
    return [one, two, *last_parts(shift.name, left, prepare)]


def last_parts(name: str, left: sp.Symbol, prepare: Prepare) -> list[sp.Symbol]:
    """The third part and those after it, from the remainder after the first two."""
    third = prepare(f"{name}_3", InSingle(Leading(left), Rounded(left)))
    fourth = prepare(f"{name}_4", Leading(Minus(left, third)))
    last = prepare(f"{name}_last", Minus(Minus(left, third), fourth))
    return [third, fourth, prepare(f"{name}_5", Rounded(last))]
