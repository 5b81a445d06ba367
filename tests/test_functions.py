"""Expressions as NumPy functions: the values that SymPy gives at 30 digits, each part computed once."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from eccentric.model import PartValues, function_of, printed

theta, omega, mu, v, z = sp.symbols("theta omega mu v z", real=True)
FIXED, SIGNALS = {"theta", "omega", "mu"}, {"theta", "omega"}
EXPRESSIONS = {
    "cosines": sp.cos(mu * theta / 2) ** 2 * sp.sign(omega) + sp.sin(mu * theta / 2),
    "shape": mu * omega * sp.cos(theta) * sp.exp(-((omega / v) ** 2)) + mu * omega * sp.cos(theta),
    "state": (omega * theta + mu) * z / v + omega * theta + z,
    "branches": sp.Piecewise((omega / v, omega > 0), (-theta, True)) * sp.Abs(theta),
    "bounds": sp.Max(0, 1 - v * omega) + sp.Heaviside(theta, 0),
    "number": sp.Integer(3),
}


@pytest.mark.parametrize("name", EXPRESSIONS)
def test_a_printed_expression_has_the_values_of_sympy(name: str) -> None:
    """At forty samples, with parts and without."""
    expression, rng = EXPRESSIONS[name], np.random.default_rng(1)
    given = {
        "theta": rng.normal(size=40),
        "omega": rng.normal(size=40),
        "mu": 0.2,
        "v": 1.5,
        "z": rng.normal(size=40),
    }
    at = [
        {sp.Symbol(s, real=True): x if np.ndim(x) == 0 else x[k] for s, x in given.items()} for k in range(40)
    ]
    expected = pytest.approx([float(expression.subs(one).evalf(30)) for one in at], rel=1e-13, abs=1e-15)
    parts = PartValues({k: given[k] for k in FIXED})
    whole = printed(f"test {name}", lambda: expression, FIXED, SIGNALS)
    plain, arguments = function_of(expression)

    values = (parts[whole.parts[a]] if a in whole.parts else given[a] for a in whole.arguments)
    assert np.broadcast_to(whole.call(*values), 40) == expected
    assert np.broadcast_to(plain(*(given[a] for a in arguments)), 40) == expected


def test_parts_need_neither_shapes_nor_states() -> None:
    """What is left beside them is the shape, the state and scalars; signals alone stay as they are."""
    shape = printed("test parts", lambda: EXPRESSIONS["shape"], FIXED, SIGNALS)
    parts = {a for part in shape.parts.values() for a in part.arguments}

    assert {"theta", "omega", "mu"} == parts
    assert not {"theta", "mu"} & set(shape.arguments)
    assert {"v"} == {a for a in shape.arguments if a not in shape.parts} - SIGNALS


def test_a_part_is_computed_once_on_a_log() -> None:
    """Two expressions with the same cosine take its values from one array."""
    values = PartValues({"theta": np.linspace(0.0, 1.0, 5), "mu": 0.2, "omega": np.ones(5)})
    first, second = (
        printed(f"test once {k}", lambda k=k: k * sp.cos(mu * theta), FIXED, SIGNALS) for k in (2, 3)
    )
    (one,), (other,) = first.parts.values(), second.parts.values()

    assert values[one] is values[other]
    np.testing.assert_allclose(values[one], np.cos(0.2 * np.linspace(0.0, 1.0, 5)), rtol=1e-15)
