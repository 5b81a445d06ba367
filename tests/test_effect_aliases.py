"""Which effects no log can separate, by computation: what is left of a column beside others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from eccentric.effects import library
from eccentric.emission import load_module
from eccentric.model import load_model
from tests.extended import BASE, M_L, G, L, M, setting

Array = np.ndarray
WEIGHT, PULL = (M + M_L) * G, M * L


def swings(fastest: float) -> tuple[Array, Array]:
    """Return link angles and link speeds up to `fastest` [rad/s], in both directions."""
    rng = np.random.default_rng(7)
    return rng.uniform(0.0, 2.0 * np.pi, 4000), rng.uniform(-fastest, fastest, 4000)


def left(y: Array, *columns: Array) -> Array:
    """Return what a fit of the columns leaves of y."""
    design = np.column_stack(columns)
    return y - design @ np.linalg.lstsq(design, y, rcond=None)[0]


def alike(x: Array, y: Array) -> float:
    """Return the size of the correlation of two remainders."""
    return float(abs(x @ y) / np.sqrt((x @ x) * (y @ y)))


def size(x: Array) -> float:
    """Return the RMS."""
    return float(np.sqrt(np.mean(x**2)))


@pytest.mark.parametrize("fastest", [4.0, 8.0])
def test_one_power_of_the_load_below_one_and_one_above_are_enough(fastest: float) -> None:
    """Beside the model's columns in C2, powers 1/2 and 2/3 of F_N are alike to 0.001; so are 4/3 to 1.55."""
    angle, speed = swings(fastest)
    force = np.hypot(PULL * speed**2 + WEIGHT * np.cos(angle), WEIGHT * np.sin(angle)) / WEIGHT
    way = np.sign(speed)
    base = (way, speed, force * way, force * speed)
    rest = {power: left(force**power * way, *base) for power in (1 / 2, 2 / 3, 4 / 3, 3 / 2, 1.55)}

    assert min(alike(rest[1 / 2], rest[2 / 3]), alike(rest[3 / 2], rest[4 / 3])) > 0.998
    assert alike(rest[3 / 2], rest[1.55]) > 0.999
    assert size(rest[3 / 2]) > 1e-3


def test_a_load_by_any_of_its_laws_is_a_polynomial_of_the_speed_in_c1() -> None:
    """F_N^(1/2) and F_N^(3/2) are columns of the model; a preload of the weight leaves 3 % of its change."""
    _, speed = swings(8.0)
    columns = load_module(load_model(BASE["C1"])).regressor(5.0 * speed).T
    force, way = PULL * speed**2, np.sign(speed)
    change = np.hypot(force, WEIGHT) - WEIGHT

    for power in (1 / 2, 3 / 2):
        assert size(left(force**power * way, *columns)) < 1e-12 * size(force**power)
    assert size(left(change * way, *columns)) < 0.03 * size(change)


@pytest.mark.parametrize("mu", [0.2, 0.5, 1.0, 1.0 / 30.0, 0.21])
def test_an_order_of_the_motor_is_offered_once(mu: float) -> None:
    """Order k of the motor is order n of the link where k = n mu; the link's names it as its alias."""
    angle, way = np.linspace(0.0, 50.0, 400), np.sign(np.sin(np.arange(400.0)))
    given = replace(setting("C2", warm=False), mu=mu)
    offered = {e.id: e for e in library(given) if "harmonic_friction" in e.family}

    for k in range(1, 25):
        own = [np.cos(k * angle) * way, np.sin(k * angle) * way]
        same = [
            n
            for n in range(1, 13)
            if size(left(own[0], np.cos(n * mu * angle) * way, np.sin(n * mu * angle) * way)) < 1e-9
        ]
        name = f"motor_harmonic_friction[n={k}]"
        assert (name in offered) == (not same), (mu, k)
        assert [f"link_harmonic_friction[n={n}]" for n in same] == [
            other.id for other in offered.values() if name in other.evidence.aliases
        ]


THINNING = {
    "power law": lambda w, w_c: np.sqrt(w * w_c),
    "Sisko's power, 3/5": lambda w, w_c: w_c * (w / w_c) ** 0.6,
    "Eyring": lambda w, w_c: w_c * np.arcsinh(w / w_c),
    "Cross, 2/3": lambda w, w_c: w / (1.0 + (w / w_c) ** (2 / 3)),
    "Cross, 1": lambda w, w_c: w / (1.0 + w / w_c),
    "Carreau, 1/4": lambda w, w_c: w * (1.0 + (w / w_c) ** 2) ** -0.375,
    "Carreau, 3/4": lambda w, w_c: w * (1.0 + (w / w_c) ** 2) ** -0.125,
}


def left_by_carreau(torque: Array, w: Array) -> float:
    """Return what Carreau's law with exponent 1/2 or 0 leaves of a law beside C and B, of what they leave."""
    base = (np.ones_like(w), w)
    laws = [w * (1.0 + (w / x) ** 2) ** p for p in (-0.25, -0.5) for x in np.geomspace(w[0], w[-1], 60)]
    return min(size(left(torque, *base, law)) for law in laws) / size(left(torque, *base))


@pytest.mark.parametrize("knee", [0.03, 0.1, 0.3])
@pytest.mark.parametrize("law", THINNING)
def test_two_exponents_of_carreaus_law_are_enough_for_every_law_of_thinning(law: str, knee: float) -> None:
    """Over speeds of 1 to 100 they leave at most 17 % of what is not C or B: 3 % of its squares."""
    w = np.linspace(0.01, 1.0, 2000)

    assert left_by_carreau(THINNING[law](w, knee), w) < 0.175


def test_an_eddy_current_brake_is_one_more_until_its_torque_falls() -> None:
    """Up to its peak they leave 1 % of what is not C or B, to twice that speed 4 %, to ten times most."""
    rest = {}
    for top in (1.0, 2.0, 10.0):
        w = np.linspace(0.01, 1.0, 2000) * top
        rest[top] = left_by_carreau(w / (1.0 + w**2), w)

    assert (rest[1.0] < 0.01, rest[2.0] < 0.04, rest[10.0] > 0.7) == (True, True, True)


def test_iron_losses_leave_their_excess_part_alone() -> None:
    """Of Steinmetz' and Bertotti's torques 1, w and sqrt|w|, C_m and B_m are the first two in both cases."""
    angle, speed = swings(8.0)
    way, w = np.sign(speed), 5.0 * speed
    for columns in (
        load_module(load_model(BASE["C1"])).regressor(w),
        load_module(load_model(BASE["C2"])).regressor(5.0 * angle, w),
    ):
        iron = {"hysteresis": way, "eddy currents": w, "excess": np.sqrt(np.abs(w)) * way}
        rest = {part: size(left(torque, *columns.T)) / size(torque) for part, torque in iron.items()}

        assert max(rest["hysteresis"], rest["eddy currents"]) < 1e-12
        assert rest["excess"] > 0.01
