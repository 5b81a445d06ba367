"""What a model defines is computed once along a log: by its own formula, under any name, shapes and all."""

import dataclasses

import numpy as np
import pytest

from eccentric.identification import Signals, compiled
from eccentric.model import Definition, load_model, quantity
from eccentric.model import vocabulary as v
from generated import c2_parallel
from tests.extended import KNOWN, effects

DT = 0.004
T = DT * np.arange(500)
THETA, OMEGA = 3.0 + 40.0 * np.sin(1.3 * T), 52.0 * np.cos(1.3 * T)
MODEL = load_model("c2_parallel")


def signals(**others: np.ndarray) -> Signals:
    """Return signals of a swing on which the paper's model is the base."""
    values = {"theta_m": THETA, "omega_m": OMEGA, "alpha_m": np.zeros_like(T), "t": T, **others}
    return Signals(values, np.full_like(T, DT), (0,), KNOWN, base=MODEL)


def force(**changed: float) -> np.ndarray:
    """Return the emitted normal force, which tests of its own hold against the closed form [N]."""
    letters = {letter: KNOWN[letter] for letter in ("M", "M_l", "L", "mu", "g")}
    return c2_parallel.normal_force(THETA, OMEGA, c2_parallel.Parameters(**{**letters, **changed}))


@pytest.mark.parametrize("name", ["F_own", "dt", "t", "temperature", "J_l"])
def test_a_definition_may_have_any_name(name: str) -> None:
    """Even that of a time step, a signal or a parameter that the rig knows: its formula counts."""
    own = quantity(name, "N", "a force of the user's", "", "nonnegative")
    defined = Definition(own, MODEL.definition("F_N").symbol + 8)
    kept = tuple(p for p in MODEL.parameters if p.name != name)
    others = tuple(d for d in MODEL.definitions if d.quantity.name != "J")
    model = dataclasses.replace(
        MODEL, parameters=kept, definitions=(*others, defined), balances=(), equations=()
    )
    given = dataclasses.replace(signals(temperature=np.full_like(T, 25.0)), base=model)

    actual = compiled(model, own.symbol * v.omega_m.symbol, given)({}, {})

    assert pytest.approx((force() + 8.0) * OMEGA, rel=1e-9) == actual


@pytest.mark.parametrize("ratio", [0.0, 0.3])
def test_a_shape_reaches_what_depends_on_it(ratio: float) -> None:
    """Beside a wrong mass the normal force is that of the true one, not the base model's."""
    model = effects("C2")["mass_mismatch"].extend(MODEL)

    found = compiled(model, model.definition("F_N").symbol, signals(), ("mass_ratio",))

    assert pytest.approx(force(M=KNOWN["M"] * (1.0 + ratio)), rel=1e-9) == found({"mass_ratio": ratio}, {})


def test_other_signals_give_other_values() -> None:
    """Nothing of what was computed stays when a signal is replaced."""
    before = signals()
    symbol = MODEL.definition("F_N").symbol
    compiled(MODEL, symbol, before)({}, {})
    after = dataclasses.replace(before, values={**before.values, "omega_m": 0.0 * OMEGA})

    weight = KNOWN["g"] * (KNOWN["M"] + KNOWN["M_l"])
    assert pytest.approx(np.full_like(T, weight), rel=1e-12) == compiled(MODEL, symbol, after)({}, {})
