"""An encoder off its centre: its balances to first order, what it resembles, and who decides."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eccentric.diagnosis import diagnose
from eccentric.diagnosis.search.candidate import Variables
from eccentric.diagnosis.search.two_balances import search_all
from eccentric.effects import library
from eccentric.virtual_bench import simulate, write
from tests.extended import (
    FIRST_FIT,
    J_L,
    J_M,
    K_E,
    K_I,
    M_L,
    MU,
    G,
    L,
    M,
    call,
    every_case,
    inputs,
    setting,
    with_effect,
)
from tests.identified import left_of
from tests.searched import adopted, candidate, design, mixed
from tests.virtual import drawn_scenario

Array = np.ndarray
J, FIRST = J_M + MU**2 * J_L, FIRST_FIT["C2"]


def balances(theta: Array, w: Array, alpha: Array) -> tuple[Array, Array]:
    """Torque of inertia, gravity and friction in C2 and back-EMF, at an angle and its derivatives."""
    angle, weight = MU * theta, (M + M_L) * G
    gravity = MU * M * G * L * np.sin(angle)
    force = np.hypot(M * L * (MU * w) ** 2 + weight * np.cos(angle), weight * np.sin(angle))
    viscous = FIRST["B_m"] + MU**2 * FIRST["B_lN"] * force
    dry = FIRST["C_m"] + MU * FIRST["C_lN"] * force
    return J * alpha + gravity + viscous * w + dry * np.sign(w), K_E * w


@pytest.mark.parametrize(("where", "rate"), [("motor", 1.0), ("link", MU)])
def test_it_is_the_first_order_of_the_balances_at_the_true_angle(where: str, rate: float) -> None:
    """What is left of both balances falls with the square of the error, for the angle and what follows."""
    x, effect = inputs(), with_effect("C2", f"encoder_eccentricity[{where}]")
    theta, w, alpha = x["theta_m"], x["omega_m"], x["alpha_m"]
    left = []
    for size in (0.02, 0.01):
        c, s = 0.6 * size, 0.8 * size
        # The chain rule on theta + (c cos(rate theta) + s sin(rate theta))/rate.
        cosine, sine = np.cos(rate * theta), np.sin(rate * theta)
        true = theta + (c * cosine + s * sine) / rate
        slope, bend = 1.0 + s * cosine - c * sine, -rate * (c * cosine + s * sine)
        exact = balances(true, slope * w, slope * alpha + bend * w**2)
        read = balances(theta, w, alpha)
        rest = []
        for balance, at, before in zip(("mechanical", "electrical"), exact, read, strict=True):
            function = f"{balance}_residual"
            found = call(effect.module, function, x)
            found = found - call(effect.module, function, x, eccentric_c=c, eccentric_s=s)
            rest.append(at - before - found * {"mechanical": 1.0, "electrical": 1.0 / K_I}[balance])
        left.append([float(np.sqrt(np.mean(r**2))) for r in rest])

    (torque, voltage), (half, half_voltage) = left
    # Inertia and back-EMF are linear in the motion, friction and gravity are not.
    assert 4.0 == pytest.approx(torque / half, rel=0.1)
    assert max(voltage, half_voltage) < 1e-12


def columns(where: str, theta: Array, w: Array) -> tuple[Array, Array]:
    """Both columns of the mechanical and of the electrical balance in C1 at steady speeds, (rows, 2) each."""
    x = inputs(len(w)) | {"theta_m": theta, "omega_m": w, "alpha_m": 0.0 * w}
    module = with_effect("C1", f"encoder_eccentricity[{where}]").module
    found = []
    for function in ("mechanical_residual", "electrical_residual"):
        plain = call(module, function, x)
        found.append(
            np.column_stack(
                [plain - call(module, function, x, **{q: 1.0}) for q in ("eccentric_c", "eccentric_s")]
            )
        )
    return found[0], found[1]


def test_its_voltage_is_a_ripple_of_the_flux_and_its_torque_is_none() -> None:
    """k_e w cos and sin of the motor angle in both; inertia and current have not the same torque."""
    rng = np.random.default_rng(3)
    theta, w, i = rng.uniform(0.0, 50.0, 500), rng.uniform(5.0, 60.0, 500), rng.uniform(1.0, 10.0, 500)
    torque, voltage = columns("motor", theta, w)
    ripple = np.column_stack([np.cos(theta), np.sin(theta)])

    assert left_of(voltage, ripple * w[:, None]) < 1e-12
    assert left_of(torque, ripple * i[:, None]) > 0.3


def test_at_one_speed_it_is_cogging_and_over_a_range_of_speeds_it_is_not() -> None:
    """In C1 at a constant speed both are cos and sin of the motor angle; from w to 2 w a fifth is left."""
    theta = np.linspace(0.0, 50.0, 2000)
    cogging = np.column_stack([np.cos(theta), np.sin(theta)])
    once, _ = columns("motor", theta, np.full(2000, 30.0))
    twice, _ = columns("motor", theta, np.linspace(30.0, 60.0, 2000))

    assert left_of(once, cogging) < 1e-12
    assert left_of(twice, cogging) > 0.2


@every_case
def test_it_is_offered_once_where_motor_and_link_turn_alike_and_not_for_an_open_inertia(case: str) -> None:
    """At mu = 1 both encoders are the same; without the inertia the balance would not be linear."""
    given = setting(case, warm=False)

    def offered(**changes: object) -> list[str]:
        found = library(replace(given, **changes))
        return [effect.variant for effect in found if effect.family == "encoder_eccentricity"]

    assert (["motor", "link"], ["motor"], []) == (offered(), offered(mu=1.0), offered(left_open=("inertia",)))


@pytest.mark.parametrize(
    ("torque", "circuit", "expected"),
    [
        ({6: 3.0}, {2: 3.0}, {"electrical": [], "mechanical": ["angle"]}),
        ({5: 6.0}, {2: 3.0}, {"electrical": ["ripple"], "mechanical": []}),
        ({6: 3.0}, {}, {"electrical": [], "mechanical": []}),
        ({6: 3.0}, {3: 300.0}, {"electrical": ["other"], "mechanical": []}),
        ({6: 3.0, 5: 4.0}, {2: 5.0, 3: 2.0}, {"electrical": ["ripple", "other"], "mechanical": ["angle"]}),
        ({6: 3.0, 7: 30.0}, {2: 3.0}, {"electrical": [], "mechanical": ["load", "angle"]}),
        ({5: 6.0, 7: 30.0}, {2: 3.0}, {"electrical": ["ripple"], "mechanical": ["load"]}),
    ],
    ids=[
        "angle",
        "ripple",
        "another torque",
        "another torque beside a large effect",
        "both",
        "angle beside a large load",
        "ripple beside a large load",
    ],
)
def test_the_mechanical_balance_decides_what_a_voltage_is(
    torque: dict[int, float], circuit: dict[int, float], expected: dict[str, list[str]]
) -> None:
    """Column 2 of the voltage is a ripple with torque 5, or a misread angle with torque 6."""
    ripple = replace(
        candidate("ripple", {2: 1.0}, balance="electrical"), also=lambda _: mixed({5: 2.0})[:, None]
    )
    other = candidate("other", {3: 1.0}, balance="electrical")
    angle = replace(candidate("angle", {6: 1.0}), also=lambda _: mixed({2: 1.0})[:, None])
    t = mixed({0: 1.0})

    found = search_all(
        [design(torque), replace(design(circuit), name="electrical")],
        [ripple, other, angle, candidate("load", {7: 1.0})],
        Variables(t=t, theta_m=None, omega_m=t, alpha_m=0.0 * t, gravity=0.0 * t, mu=1.0, averaged=True),
        {},
        lambda _: None,
    )

    assert expected == {name: adopted(search) for name, search in found.items()}


@pytest.mark.slow
def test_a_planted_one_is_named_with_its_size(tmp_path: Path) -> None:
    """On a bench log it is the only name, though the voltage alone would show a ripple of the flux."""
    scenario = drawn_scenario(97200, case="C2", mu=0.2, effects=["encoder_eccentricity[motor]"], strength=0.1)
    run = simulate(scenario)
    log, rig, _ = write(run, tmp_path / "log.csv.gz")
    found = diagnose([log], rig)
    values = found.models.extended.values
    planted = run.truth["effects"][0]

    assert ["encoder_eccentricity[motor]"] == [a.variant.candidate.id for a in found.attribution.adopted]
    assert "named" == found.attribution.verdict
    assert planted["amplitude"] == pytest.approx(
        np.hypot(values["eccentric_c"], values["eccentric_s"]), rel=0.05
    )
