"""Friction that falls as the windings alone heat a joint: beside its closed form under a constant current."""

from __future__ import annotations

import inspect
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from eccentric.effects import Setting, library
from eccentric.emission import executed, render
from eccentric.joints.joint_model import joint_model
from eccentric.model import with_values

MEAN_LOSS_W, MEAN_SQUARE_A2, DURATION_S = 3.0, 2.0, 60.0
TAU, FALL, CURRENT, DT, STEPS = 20.0, 0.4, 1.7, 0.05, 800
VALUES = {"mu": 0.1, "k_i": 0.1, "k_e": 0.1, "B_m": 1e-3, "C_m": 1e-2, "B_lN": 1e-4, "C_lN": 2e-3}
VALUES |= {"B_lT": 0.0, "C_lT": 0.0, "B_lM": 0.0, "C_lM": 0.0}
W, F_N = 30.0, 5.0


def setting(**known: float) -> Setting:
    """A joint of an arm, of which a current is logged."""
    return Setting(
        base=joint_model("joint", "A joint"), mu=VALUES["mu"], known={"k_i": 0.1, **known},
        w_min=0.1, w_max=100.0, current_max=5.0, duration_s=DURATION_S, mean_loss_W=MEAN_LOSS_W,
        mean_force=30.0, mean_square_A2=MEAN_SQUARE_A2, temperature_mid=None,
        channels=frozenset({"current", "voltage"}),
    )  # fmt: skip


@pytest.fixture(scope="module")
def module() -> ModuleType:
    """The emitted joint with the effect."""
    (effect,) = (e for e in library(setting()) if e.id == "hidden_thermal_drift[windings]")
    model = effect.extend(joint_model("joint", "A joint"), {"heat_tau": TAU, "heat_b": FALL})
    return executed(render(with_values(model, VALUES, "warm"), backends=("numpy",)), "warm")


def test_the_factor_is_that_of_an_implicit_first_order_body(module: ModuleType) -> None:
    """P_n = P (1 - (1 + dt/tau)^-n) with P = R i^2, R such that the mean losses are those of the log."""
    given: dict[str, Any] = {
        "theta_m": 0.0, "omega_m": W, "alpha_m": 0.0, "i": CURRENT, "u": 0.0, "t": 0.0, "dt": DT,
        "T_g": 0.0, "T_d": 0.0, "T_r": 0.0, "load_N": F_N, "load_T": 0.0, "load_M": 0.0,
    }  # fmt: skip
    n = np.arange(STEPS)
    columns = {name: np.full(STEPS, value) for name, value in given.items()} | {"t": n * DT, "dt": DT}

    def called(name: str) -> np.ndarray:
        function = getattr(module, name)
        taken = [x for x in inspect.signature(function).parameters if x not in {"parameters", "out"}]
        return function(*(columns[x] for x in taken))

    columns |= dict(zip(module.STATES, called("follow_states").T, strict=True))
    resistance = MEAN_LOSS_W / MEAN_SQUARE_A2
    full = MEAN_LOSS_W * (1.0 - np.exp(-DURATION_S / TAU))
    rise = resistance * CURRENT**2 * (1.0 - (1.0 + DT / TAU) ** -n) / full
    cold = (
        VALUES["B_m"] * W
        + VALUES["C_m"]
        + VALUES["mu"] * F_N * (VALUES["mu"] * VALUES["B_lN"] * W + VALUES["C_lN"])
    )

    assert rise[-1] > 0.5
    np.testing.assert_allclose(called("mechanical_friction_torque"), cold * np.exp(-FALL * rise), rtol=1e-12)


def test_it_is_offered_where_the_losses_lack_those_of_the_windings() -> None:
    """Where R is given, they are part of the losses; where it is not, their course alone counts."""
    without, with_R = ({e.id for e in library(one)} for one in (setting(), setting(R=1.0)))

    assert {"hidden_thermal_drift[windings]"} == without - with_R
    assert with_R < without
