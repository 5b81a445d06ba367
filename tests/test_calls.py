"""The functions that the summary of a diagnosis says to call contain what was adopted."""

from __future__ import annotations

import inspect
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import eccentric
from eccentric.emission import load_module
from eccentric.model import load_model
from eccentric.presentation.calls_text import other_functions, share_words, zero_line
from tests.extended import BASE, J_L, J_M, effects

BENCH = Path(__file__).parents[1] / "examples" / "bench"
CASES = [
    ("C2", "stribeck[d=1]", None),
    ("C2", "cogging[n=3]", "gravity_torque"),
    ("C2", "cable_spring", "gravity_torque"),
    ("C1", "gravity_tilt", "gravity_torque"),
    ("C1", "gravity_tilt[load]", "gravity_torque"),
    ("C2", "kt_ripple[n=1]", "current"),
]


@pytest.mark.parametrize(("case", "effect_id", "function"), CASES, ids=[f"{c} {e}" for c, e, _ in CASES])
def test_the_functions_named_change_with_the_effect(case: str, effect_id: str, function: str | None) -> None:
    """In the emitted module, whose values without the effect are those of the base model's module."""
    effect, base = effects(case)[effect_id], load_model(BASE[case])
    model = effect.extend(base, {q.name: 0.1 for q in effect.coefficients})
    with_it, without = load_module(model), load_module(base)
    motion = {"theta_m": np.linspace(0.3, 6.0, 7), "omega_m": np.full(7, 9.0), "alpha_m": np.full(7, 2.0)}

    def value(module: ModuleType, name: str) -> np.ndarray:
        call = getattr(module, name)
        taken = [motion[n] for n in inspect.signature(call).parameters if n in motion]
        return np.broadcast_to(call(*taken, module.Parameters(J_m=J_M, J_l=J_L)), 7)

    differs = {
        name: not np.allclose(value(with_it, name), value(without, name), rtol=1e-9, atol=0.0)
        for name in ("friction_torque", "gravity_torque", "current")
    }
    (found,) = other_functions(model) or [(effect_id, None, differs["friction_torque"])]

    assert found == (effect_id, function, differs["friction_torque"])
    assert differs[function or "friction_torque"]
    assert not differs["gravity_torque"] or function == "gravity_torque"
    assert differs["current"]


def test_the_summary_names_the_torque_that_contains_a_conservative_effect() -> None:
    """Friction alone, called as the first line says, would leave the cogging uncompensated."""
    found = eccentric.diagnose(
        BENCH / "bench.csv.gz", BENCH / "bench.json", including="cogging[n=3]", only="cogging"
    )
    lines = list(found.lines)
    (to_call,) = [k for k, line in enumerate(lines) if line.startswith("to call: ")]

    assert lines[to_call + 1].startswith("  cogging[n=3] is not friction; it is in ")
    assert "_gravity_torque(theta_m, &" in lines[to_call + 1]


@pytest.mark.parametrize(
    ("effect_id", "whole"),
    [("stribeck[d=1]", "friction"), ("cogging[n=3]", "drive torque net of inertia and gravity")],
)
def test_a_share_says_what_it_is_a_share_of(effect_id: str, whole: str) -> None:
    """A conservative torque is no part of the friction."""
    effect = effects("C2")[effect_id]
    fitted = SimpleNamespace(model=effect.extend(load_model("c2_parallel")), shares={effect_id: 0.123})

    assert share_words(fitted, effect) == f"12.3 % of the {whole}"  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize(("zero", "shift"), [(0.2, "- 1 rad"), (-0.1, "+ 0.5 rad"), (0.0, None)])
def test_the_call_says_from_where_its_angle_counts(zero: float, shift: str | None) -> None:
    """In radians of the motor, five of which are one of the link."""
    alignment = SimpleNamespace(theta_zero_rad=zero)
    found: Any = SimpleNamespace(
        channels=SimpleNamespace(alignment=alignment), setting=SimpleNamespace(mu=0.2)
    )

    assert [shift] * (shift is not None) == [
        line[-len(shift or "") :] for line in zero_line(found, ["f(theta_m)"])
    ]
    assert zero_line(found, ["f(omega_m)"]) == []
