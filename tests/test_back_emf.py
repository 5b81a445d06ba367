"""A voltage without k_e: the back-EMF k_e omega_m is in the friction in proportion to omega_m alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from eccentric.core import InputError
from eccentric.identification import Fit, back_emf_columns, fit
from eccentric.model import Model, Role, Term, load_model, quantity
from eccentric.model import vocabulary as v
from tests.planted import FRICTION, K_E, K_I, KNOWN, MASS, MOTOR, R, fitted, motion, torque, voltage, written

w = v.omega_m.symbol
D_S, KNEE = 0.002, 20
SEAL = quantity("D_s", "N m s/rad", "damping of a seal that thins with speed", "", "nonnegative")
UNKNOWN = 'case = "C2"\n' + KNOWN


def with_friction(*terms: Term) -> Model:
    """Case C2 with the motor's viscous friction replaced by these terms."""
    base = load_model("c2_parallel")
    mechanical, electrical = base.balance("mechanical"), base.balance("electrical")
    kept = tuple(term for term in mechanical.terms if term.coefficient != v.B_m.symbol)
    letters = [q for q in base.parameters if q != v.B_m]
    given = {term.coefficient: q for term in terms for q in (SEAL, v.B_m) if q.symbol == term.coefficient}
    return replace(
        base,
        name="own",
        parameters=(*letters, *given.values()),
        balances=(replace(mechanical, terms=(*kept, *terms)), electrical),
    )


def viscous(coefficient: sp.Symbol, basis: sp.Expr) -> Term:
    """A viscous term that follows no load."""
    return Term(str(coefficient), "friction", coefficient, basis, "own", role=Role.VISCOUS)


DAMPER = viscous(v.B_m.symbol, w)
THINNING = viscous(SEAL.symbol, w / (1 + (w / KNEE) ** 2))


def seal(omega: np.ndarray) -> np.ndarray:
    """The torque of the seal (n,) [N m]."""
    return D_S * omega / (1.0 + (omega / KNEE) ** 2)


def test_friction_that_thins_with_speed_holds_no_back_emf(tmp_path: Path) -> None:
    """Of two viscous terms only B_m omega_m shares its column with k_e; the other is found by itself."""
    signal = voltage("C2") + R / K_I * seal(motion()[1])
    channels, rig = written(tmp_path, UNKNOWN, {"voltage_V": signal})
    found = fit(channels, rig, with_friction(DAMPER, THINNING))
    actual = {name: e.value for name, e in found.coefficients.items() if name.startswith(("B_m", "D_s"))}
    expected = {"B_m*R/k_i + k_e": FRICTION["B_m"] * R / K_I + K_E, "D_s*R/k_i": D_S * R / K_I}
    assert expected == pytest.approx(actual, rel=1e-2)


def test_without_a_term_in_proportion_to_speed_k_e_is_required(tmp_path: Path) -> None:
    """No column would hold the back-EMF: refused with the name of k_e; with k_e known the model fits."""
    model = with_friction(THINNING)
    own = {**FRICTION, "B_m": 0.0}
    drive = torque("C2", own) + seal(motion()[1])
    signal = {"voltage_V": R / K_I * drive + K_E * motion()[1]}
    channels, rig = written(tmp_path, UNKNOWN, signal)
    with pytest.raises(InputError, match=r"expected \[known\] k_e .* own, .* got none"):
        fit(channels, rig, model)
    channels, rig = written(tmp_path, UNKNOWN + MOTOR + MASS, signal)
    found = fit(channels, rig, model)
    assert found.coefficients["D_s"].value == pytest.approx(D_S, rel=1e-2)


def test_a_basis_with_a_factor_has_its_share_of_the_back_emf(tmp_path: Path) -> None:
    """With the term B_m 4 omega_m, a coefficient holds a quarter of the damping by the back-EMF."""
    channels, rig = written(tmp_path, UNKNOWN, {"voltage_V": voltage("C2")})
    found = fit(channels, rig, with_friction(viscous(v.B_m.symbol, 4 * w)))
    name = "B_m*R/k_i + k_e/4"
    assert found.coefficients[name].value == pytest.approx((FRICTION["B_m"] * R / K_I + K_E) / 4, rel=2e-3)


def test_each_direction_holds_the_whole_back_emf(tmp_path: Path) -> None:
    """With one coefficient for each direction, both contain k_e."""
    friction = {
        f"{k}_{s}": x * (1.0 if s == "pos" else 1.3) for k, x in FRICTION.items() for s in ("pos", "neg")
    }
    signal = R / K_I * torque("C2", friction) + K_E * motion()[1]
    found: Fit = fitted(tmp_path, UNKNOWN, {"voltage_V": signal}, model="c2_asymmetric")
    expected = {f"B_m_{s}*R/k_i + k_e": friction[f"B_m_{s}"] * R / K_I + K_E for s in ("pos", "neg")}
    actual = {name: e.value for name, e in found.coefficients.items() if "k_e" in name}
    assert expected == pytest.approx(actual, rel=2e-3)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("c1_perpendicular", {"B"}),
        ("c1_asymmetric", {"B_pos", "B_neg"}),
        ("c2_parallel", {"B_m"}),
        ("c2_asymmetric", {"B_m_pos", "B_m_neg"}),
        ("rotating_link", {"B"}),
    ],
)
def test_the_papers_models_hold_it_in_the_motors_damping(name: str, expected: set[str]) -> None:
    """Of the paper's viscous terms those by F_N are no part of it."""
    assert expected == set(back_emf_columns(load_model(name)))
