"""Friction at a non-integer order: found in a spectrum over the angle, kept apart from the harmonics."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eccentric.diagnosis import SearchRequest, diagnose
from eccentric.diagnosis.search.balances import standing_orders
from eccentric.effects import library
from eccentric.virtual_bench import simulate, write
from tests.extended import MU, TURNS, every_case, setting
from tests.identified import left_of
from tests.virtual import drawn_scenario

Array = np.ndarray
RIVALS = (
    "nonsynchronous_friction",
    "motor_harmonic_friction",
    "link_harmonic_friction",
    "cogging",
    "kt_ripple",
    "kinematic_error",
    "stribeck",
)
HARMONICS = sorted({*map(float, range(1, 9)), *(n * MU for n in range(1, 13))})
GRAVITY = [n * MU for n in range(1, 4)]


def swings(seed: int) -> tuple[Array, Array]:
    """Return motor angle and velocity of a minute of swings, both directions, some tens of turns."""
    rng, t = np.random.default_rng(seed), np.arange(0.0, 60.0, 0.004)
    parts = [
        (rng.uniform(8.0, 25.0), f * rng.uniform(0.9, 1.1), rng.uniform(0.0, 6.0)) for f in (0.05, 0.13, 0.4)
    ]
    omega = sum(a * np.sin(2.0 * np.pi * f * t + p) for a, f, p in parts)
    return np.cumsum(omega) * 0.004, np.asarray(omega)


@pytest.mark.parametrize("nu", [0.7, *(pytest.param(nu, marks=pytest.mark.slow) for nu in (3.57, 7.3))])
def test_an_order_stands_out_to_a_fifth_of_a_cycle(nu: float) -> None:
    """Friction in noise twice as large: its order comes first, and first after a harmonic twice as large."""
    theta, omega = swings(1)
    way = np.sign(omega)
    own = 0.01 * np.cos(nu * theta + 0.7) * way + 0.02 * np.random.default_rng(2).normal(size=len(theta))
    turns, alone = standing_orders(theta, omega, own, HARMONICS, GRAVITY)
    _, beside = standing_orders(theta, omega, own + 0.02 * np.cos(2.0 * theta) * way, HARMONICS, GRAVITY)

    assert np.ptp(theta) / (2.0 * np.pi) == pytest.approx(turns)
    assert nu == pytest.approx(alone[0], abs=0.2 / turns)
    assert 2.0 == pytest.approx(beside[0], abs=0.2 / turns)
    assert nu == pytest.approx(beside[1], abs=0.2 / turns)


@pytest.mark.parametrize(
    ("nu", "noise"),
    [
        pytest.param(nu, noise, marks=() if noise == few else pytest.mark.slow)
        for nu, few in ((4.3, 0.0), (5.43, 0.01), (2.64, 1e-4), (4.65, 0.0))
        for noise in (0.01, 1e-4)
    ],
)
def test_on_two_turns_it_is_found_between_the_harmonics(nu: float, noise: float) -> None:
    """Where no order is a cycle from every harmonic, and the motion dwells at its ends."""
    t = np.arange(0.0, 60.0, 0.004)
    theta = 2.03 * np.pi * np.sin(0.9 * t + 0.3 * np.sin(0.13 * t))
    omega = np.gradient(theta, t)
    harmonics = [float(n) for n in range(1, 13)]
    residual = 0.02 * np.cos(nu * theta + 0.7) * np.sign(omega)
    residual += noise * np.random.default_rng(2).normal(size=len(theta))
    turns, found = standing_orders(theta, omega, residual, harmonics, [1.0, 2.0, 3.0])
    offered = library(replace(setting("C1", warm=False), mu=1.0, turns=turns, orders=found))
    (shape,) = next(e.shapes for e in offered if e.family == "nonsynchronous_friction")

    assert nu == pytest.approx(found[0], abs=0.2 / turns)
    assert shape.low < nu < shape.high
    assert min(abs(shape.low - round(shape.low)), abs(shape.high - round(shape.high))) > 0.249 / turns


@pytest.mark.parametrize(
    ("kind", "turns"),
    [
        pytest.param(kind, turns, marks=() if turns == few else pytest.mark.slow)
        for kind, few in (("harmonic", 1.5), ("white", 0.0), ("speed", 7.9))
        for turns in (1.5, 7.9)
    ],
)
def test_over_a_few_turns_neither_noise_nor_a_harmonic_has_an_order_of_its_own(
    turns: float, kind: str
) -> None:
    """Nor does what follows the speed."""
    t, offered = np.arange(0.0, 60.0, 0.01), 0
    harmonics = [float(n) for n in range(1, 13)]
    for seed in range(8):
        noise = np.random.default_rng(seed).normal(size=len(t))
        theta = np.pi * turns * np.sin((0.9 + 0.05 * seed) * t + 0.3 * np.sin(0.13 * t))
        omega = np.gradient(theta, t)
        residual = {
            "harmonic": np.cos(5.0 * theta + seed) * np.sign(omega) + 0.1 * noise,
            "white": noise,
            "speed": np.exp(-2.0 * np.abs(omega)) * np.sign(omega) + 0.5 * noise,
        }[kind]
        _, found = standing_orders(theta, omega, residual, harmonics, [1.0, 2.0, 3.0])
        given = replace(setting("C1", warm=False), mu=1.0, turns=turns, orders=found)
        offered += any(e.family == "nonsynchronous_friction" for e in library(given))

    assert 0 == offered


def test_a_periodic_motion_hides_no_order() -> None:
    """At a whole number of samples per period it is always at the same angles."""
    t = np.arange(0.0, 200.0, 0.01)
    theta = 2.03 * np.pi * np.sin(np.pi * t)
    omega = np.gradient(theta, t)
    residual = 0.02 * np.cos(5.43 * theta + 0.7) * np.sign(omega)
    turns, found = standing_orders(theta, omega, residual, [float(n) for n in range(1, 13)], [1.0, 2.0, 3.0])

    assert 5.43 == pytest.approx(found[0], abs=0.2 / turns)


@pytest.mark.parametrize("harmonic", [*(pytest.param(n, marks=pytest.mark.slow) for n in (4.0, 5.0)), 9 * MU])
def test_a_harmonic_alone_offers_no_other_order(harmonic: float) -> None:
    """Friction at a harmonic of motor or link, with and without the sign of the motion: none is offered."""
    theta, omega = swings(3)
    for way in (np.sign(omega), 1.0):
        residual = 0.02 * np.cos(harmonic * theta) * way
        residual += 0.005 * np.random.default_rng(2).normal(size=len(theta))
        turns, found = standing_orders(theta, omega, residual, HARMONICS, GRAVITY)
        offered = library(replace(setting("C2", warm=False), turns=turns, orders=found))

        assert "nonsynchronous_friction" not in {effect.family for effect in offered}


def test_noise_and_what_follows_speed_or_load_have_no_order() -> None:
    """White noise, a wrong Coulomb and viscous coefficient and a gravity torque: no order is offered."""
    for seed in range(5):
        theta, omega = swings(seed)
        rng = np.random.default_rng(seed)
        residual = 0.02 * np.sign(omega) + 1e-3 * omega + 0.01 * rng.normal(size=len(theta))
        residual += 0.02 * np.sin(MU * theta)
        turns, found = standing_orders(theta, omega, residual, HARMONICS, GRAVITY)
        offered = library(replace(setting("C2", warm=False), turns=turns, orders=found))

        assert "nonsynchronous_friction" not in {effect.family for effect in offered}


@pytest.mark.parametrize(("cycles", "offered"), [(0.1, False), (0.2, False), (0.3, True), (1.7, True)])
@pytest.mark.parametrize("harmonic", [4.0, 11 * MU], ids=["motor", "link"])
def test_it_is_offered_where_no_harmonic_is_like_it(harmonic: float, cycles: float, offered: bool) -> None:
    """It slips by a quarter of a cycle over the log against each harmonic; sqrt(1 - sinc^2) of it is left."""
    nu = harmonic + cycles / TURNS
    angle = np.linspace(0.0, 2.0 * np.pi * TURNS, 20000)
    rest = left_of(np.cos(nu * angle), np.cos(harmonic * angle), np.sin(harmonic * angle))
    found = library(replace(setting("C2", warm=False), orders=(nu,)))

    assert offered == any(effect.family == "nonsynchronous_friction" for effect in found)
    assert rest == pytest.approx(np.sqrt(1.0 - np.sinc(cycles) ** 2), abs=0.01)


def test_where_the_motor_turns_too_little_it_is_not_offered() -> None:
    """An eighth of the way between two integers it slips by a quarter of a cycle in two turns."""
    for turns, offered in ((1.5, False), (1.9, False), (2.1, True)):
        found = library(replace(setting("C2", warm=False), mu=1.0, turns=turns, orders=(3.125,)))
        assert offered == any(e.family == "nonsynchronous_friction" for e in found)


@pytest.mark.parametrize("turns", [1.3, 2.2, 9.0])
def test_its_order_is_searched_no_nearer_than_a_quarter_of_a_cycle_to_any_harmonic(turns: float) -> None:
    """Neither to the one below nor to the one above, and within half a cycle of where it stands out."""
    (shape,) = next(
        e.shapes
        for e in library(replace(setting("C1", warm=False), mu=1.0, turns=turns, orders=(3.48,)))
        if e.family == "nonsynchronous_friction"
    )
    assert (shape.low, shape.high) == pytest.approx(
        (max(3.48 - 0.5 / turns, 3.0 + 0.25 / turns), min(3.48 + 0.5 / turns, 4.0 - 0.25 / turns))
    )


@every_case
def test_it_follows_the_strongest_order_that_is_no_harmonic(case: str) -> None:
    """Harmonics and orders beyond the range are passed over; without any other it is not offered."""

    def offered(*orders: float) -> list[float]:
        found = library(replace(setting(case, warm=False), orders=orders))
        return [e.shapes[0].middle for e in found if e.family == "nonsynchronous_friction"]

    assert [pytest.approx(5.43)] == offered(3.0, 9.7, 0.1, 5.43, 2.6)
    assert [] == offered(3.0, 9.7)
    assert [] == offered()


def test_a_planted_one_is_named_with_its_order_and_size(tmp_path: Path) -> None:
    """On a bench log it is the only name, before all that a ripple over an angle may be taken for."""
    scenario = drawn_scenario(97410, case="C2", mu=0.2, effects=["nonsynchronous_friction"], strength=0.1)
    run = simulate(scenario)
    log, rig, _ = write(run, tmp_path / "log.csv.gz")
    found = diagnose([log], rig, request=SearchRequest(only=RIVALS))
    values = found.models.extended.values
    planted = run.truth["effects"][0]

    assert ["nonsynchronous_friction"] == [a.variant.candidate.id for a in found.attribution.adopted]
    assert "named" == found.attribution.verdict
    assert planted["shape"][0] == pytest.approx(values["nonsync_order"], abs=0.1 / found.setting.turns)
    assert planted["amplitude"] == pytest.approx(np.hypot(values["nonsync_c"], values["nonsync_s"]), rel=0.05)
