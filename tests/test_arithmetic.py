"""Arithmetic on columns computes what it says and runs nothing."""

from __future__ import annotations

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.logs.limits import DEEPEST_ARITHMETIC, LONGEST_ARITHMETIC
from eccentric.logs.units import evaluate, is_arithmetic

COLUMNS = {
    "a": np.array([1.0, 2.0, 3.0]),
    "b": np.array([4.0, 0.0, -1.0]),
    "speed (rpm)": np.array([60.0, 120.0, 0.0]),
}


def column(name: str) -> np.ndarray:
    """Return a column, or refuse as a log does."""
    if name not in COLUMNS:
        raise InputError(f"expected column {name!r}, but the log has {', '.join(COLUMNS)}")
    return COLUMNS[name]


VALUES = {
    "a": [1.0, 2.0, 3.0],
    "a / 2 * b": [2.0, 0.0, -1.5],
    "-(a - b) + 1e1": [13.0, 8.0, 6.0],
    "`speed (rpm)` / 60": [1.0, 2.0, 0.0],
    "2 * +a": [2.0, 4.0, 6.0],
    "a == 2": [False, True, False],
    "1 < a <= 3": [False, True, True],
    "a > 1 and not b < 0 or a == 1": [True, True, False],
    "a != 2 and b >= -1": [True, False, True],
}


@pytest.mark.parametrize("text", VALUES)
def test_value(text: str) -> None:
    """Sums, products, comparisons and conditions have the values calculated manually."""
    actual = evaluate(text, column, "rig")
    assert actual.tolist() == VALUES[text]


def test_division_by_zero_is_not_finite() -> None:
    """A division by zero is silent here and not finite, so the row is counted as missing later."""
    assert np.isfinite(evaluate("a / b", column, "rig")).tolist() == [True, False, True]


EXPECTED = "expected a column of the log, or arithmetic of + - * / ( ), numbers"
BAD = {
    "a ** 2": EXPECTED,
    "a % 2": EXPECTED,
    "a // 2": EXPECTED,
    "a & b": EXPECTED,
    "abs(a)": EXPECTED,
    "a.size": EXPECTED,
    "a[0]": EXPECTED,
    "__import__('os').system('true')": EXPECTED,
    "[x for x in a]": EXPECTED,
    "lambda: a": EXPECTED,
    "(a := b)": EXPECTED,
    "a if a else b": EXPECTED,
    "'text'": EXPECTED,
    "True": EXPECTED,
    "1j * a": EXPECTED,
    "a in b": EXPECTED,
    "1 + 2": "names no column",
    "a +": EXPECTED,
    "a; b": EXPECTED,
    "a = b": EXPECTED,
    "": EXPECTED,
    "c + a": "expected column 'c', but the log has a, b",
    "a + (b > 0)": "expected a number, got the condition 'b > 0'",
    "a and b > 0": "expected a condition, got the number 'a'",
    "a + 1e999": "expected a finite number",
    "9" * 400 + " * a": "expected a finite number",
    "a" + " + a" * LONGEST_ARITHMETIC: "at most 500 characters",
    "-" * (DEEPEST_ARITHMETIC + 2) + "a": "nested deeper",
    "(" * 240 + "a" + ")" * 240: EXPECTED,
}


@pytest.mark.parametrize("text", BAD)
def test_anything_else_is_refused(text: str) -> None:
    """Powers, calls, attributes, indices, strings, too deep or too long texts are refused in one line."""
    with pytest.raises(InputError) as caught:
        evaluate(text, column, "rig")
    assert BAD[text] in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "arithmetic"),
    [
        ("Zeit[s]", False),
        ("Iq [mA]", False),
        ("Iq (A)", False),
        ("Moment [N*m]", False),
        ("Iq-soll", False),
        ("Iq", False),
        ("Iq * 2", True),
        ("a ** 2", True),
        ("-speed (rpm)", True),
        ("`speed [rpm]`", True),
    ],
)
def test_a_name_with_a_unit_is_no_arithmetic(text: str, arithmetic: bool) -> None:
    """Of texts that are no column, those count as arithmetic that have one, or an operator between names."""
    assert is_arithmetic(text, COLUMNS) == arithmetic
