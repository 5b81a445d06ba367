"""No effect makes or loses energy that it must not: torque and back-EMF, friction, hysteresis."""

import numpy as np
import pytest

from tests.extended import END, J_L, J_M, K_I, MU, R, briefly, call, effects, inputs

J = J_M + MU**2 * J_L


FLUX = {
    "kt_ripple[n=7]": {"kt_ripple_c7": 0.1, "kt_ripple_s7": -0.2},
    "kt_saturation": {"ktsat_c": 0.008, "ktsat_i": 10.0},
    "magnet_temperature": {"magnet_a": 0.008, "magnet_0": -0.1},
}


@pytest.mark.parametrize("effect_id", FLUX)
def test_power_into_the_back_emf_is_the_power_of_the_torque(effect_id: str) -> None:
    """With k_e = k_i in SI units, u i - R i^2 = tau w at every angle, speed and current; tau is not k_i i."""
    values = FLUX[effect_id] | {"k_e": K_I}
    module, given = briefly("C1", effect_id), inputs() | {"u": np.zeros(40)}
    friction_and_inertia = call(module, "mechanical_friction_torque", given) + J * given["alpha_m"]
    torque = call(module, "mechanical_residual", given, **values) + friction_and_inertia
    voltage = -call(module, "electrical_residual", given, **values) * R / K_I

    np.testing.assert_allclose(
        voltage * given["i"] - R * given["i"] ** 2, torque * given["omega_m"], rtol=1e-10, atol=1e-12
    )
    assert np.max(np.abs(torque / (K_I * given["i"]) - 1.0)) > 0.1


def test_saturation_far_below_its_current_is_one_coefficient() -> None:
    """There k_t is k_i (1 - c i^2) whatever i_s: the coefficient is what a log determines."""
    module, given = briefly("C1", "kt_saturation"), inputs()
    plain = call(module, "mechanical_residual", given)
    found = [
        plain
        - call(module, "mechanical_residual", given, ktsat_c=1e-3, ktsat_i=far * np.max(np.abs(given["i"])))
        for far in (100.0, 1000.0)
    ]

    for one in found:
        np.testing.assert_allclose(one, 1e-3 * K_I * given["i"] ** 3, rtol=2e-4, atol=1e-9)


@pytest.mark.parametrize("effect_id", ["time_drift[all]", "coulomb_temperature"])
def test_friction_never_drives(effect_id: str) -> None:
    """At both ends of the search, from -60 to 120 degC and up to ten times the log, it opposes the motion."""
    given, module = inputs(), briefly("C1", effect_id)
    (shape,) = effects("C1")[effect_id].shapes
    for value in (shape.low, shape.high):
        for part in np.linspace(0.0, 1.0, 11):
            at = given | {"t": np.full(40, 10 * END * part), "temperature": np.full(40, 180 * part - 60)}
            torque = call(module, "mechanical_friction_torque", at, **{shape.quantity.name: value})

            assert np.min(torque * given["omega_m"]) >= 0.0


@pytest.mark.parametrize("effect_id", ["magnetic_hysteresis", "magnetic_hysteresis[play]"])
def test_hysteresis_takes_energy(effect_id: str) -> None:
    """A motor that turns against a spring as its current cycles loses work, for every allowed coefficient."""
    (low, high), *_ = effects("C1")[effect_id].bounds
    assert (0.0, None) == (low, high)

    module, rng = briefly("C1", effect_id), np.random.default_rng(3)
    time = np.linspace(0.0, 2.0 * np.pi, 201)[1:]
    for _ in range(5):
        waves = rng.normal(size=(4, 2))
        current = 6.0 * np.sum([a * np.sin(k * time + b) for k, (a, b) in enumerate(waves, 1)], axis=0)
        now, work = dict.fromkeys(module.STATES, 0.0), [0.0, 0.0]
        for turn in range(2):  # the first one ends on the loop
            for before, i in zip(np.roll(current, 1), current, strict=True):
                x = (
                    inputs(1)
                    | {name: np.array([value]) for name, value in now.items()}
                    | {"i": np.array([i])}
                )
                now = dict(zip(module.STATES, np.ravel(call(module, "next_state", x)).tolist(), strict=True))
                x |= {name: np.array([value]) for name, value in now.items()}
                with_it, without = (
                    call(module, "mechanical_residual", x, hysteresis_A=a).item() for a in (0.03, 0.0)
                )
                work[turn] += (with_it - without) * (i - before)

        assert work[1] < 0.0
