"""An effect on the flux that the circuit cannot tell from another: its torque tells."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from eccentric.diagnosis.search.attribution import Search
from eccentric.diagnosis.search.candidate import Candidate, Variables
from eccentric.diagnosis.search.limits import HINTED
from eccentric.diagnosis.search.two_balances import search_all
from eccentric.diagnosis.search.verdict import decided
from eccentric.effects import Shape
from eccentric.model import quantity
from tests.searched import Array, N, candidate, design, mixed


def searched(
    torque: dict[int, float],
    voltage: dict[int, float],
    *candidates: Candidate,
    noise: Mapping[str, float] | None = None,
) -> dict[str, Search]:
    """The search in two balances of these columns; the circuit has nothing to fit, all is declared."""
    t, none = mixed({0: 1.0}), np.empty((N, 0))
    circuit = replace(design(voltage), name="electrical", coefficients=(), columns=none, samples=none)
    moved = Variables(t=t, theta_m=None, omega_m=t, alpha_m=0.0 * t, gravity=0.0 * t, mu=1.0, averaged=True)
    return search_all([design(torque), circuit], candidates, moved, noise or {}, lambda _: None)


def on_the_flux(ratio: float, *, torque: int = 5, voltage: int = 2, name: str = "flux") -> Candidate:
    """An effect whose torque is `ratio` times its voltage, each in a column of its own."""
    return replace(
        candidate(name, {voltage: 1.0}, balance="electrical"),
        also=lambda _: mixed({torque: ratio})[:, None],
        joint=True,
    )


def verdict_of(
    torque: dict[int, float], voltage: dict[int, float], *candidates: Candidate
) -> tuple[str, list[str]]:
    """The verdict on two balances of these columns, with what is named or tied."""
    verdict = decided(searched(torque, voltage, *candidates))
    return verdict.verdict, sorted(verdict.tied or [one.variant.candidate.id for one in verdict.adopted])


@pytest.mark.parametrize(
    ("torque", "expected"),
    [({5: 6.0}, ("named", ["flux"])), ({}, ("not_identifiable", ["flux"]))],
    ids=["with its torque", "without"],
)
def test_the_torque_settles_what_the_circuit_leaves_open(
    torque: dict[int, float], expected: tuple[str, list[str]]
) -> None:
    """In the voltage both leave the same but for a millionth; only one has a torque, and takes it out."""
    other = candidate("other", {2: 1.0, 3: 1e-3}, balance="electrical")
    found = searched(torque, {2: 3.0}, on_the_flux(2.0), other, candidate("load", {7: 1.0}))
    verdict = decided(found)

    assert expected == (verdict.verdict, [one.variant.candidate.id for one in verdict.adopted])


def test_what_both_show_is_estimated_beside_what_else_the_torque_shows() -> None:
    """The circuit hardly tells the shape, its torque does, once a large ripple is no longer taken for noise.

    Of the shape that the circuit prefers, the torque leaves a part that another effect would take.
    """
    form, true = Shape(quantity("x", "1", "a shape"), 0.0, 4.0, points=5), 3.0

    def shown(values: Mapping[str, float]) -> Array:
        return mixed({2: 1.0, 3: 0.1 * values["x"]})[:, None]

    flux = replace(
        candidate("flux", shapes=(form,), of=shown, balance="electrical"),
        also=lambda values: mixed({5: 2.0, 6: values["x"]})[:, None],
        joint=True,
    )
    torque, voltage = {5: 6.0, 6: 3.0 * true, 7: 60.0}, {2: 3.0, 3: 0.3 * (true - 1.0)}
    found = searched(torque, voltage, flux, candidate("ripple", {7: 1.0}), candidate("other", {6: 1.0}))
    (own,) = found["electrical"].best.variants

    assert ["ripple"] == [v.candidate.id for v in found["mechanical"].best.variants]
    assert true == pytest.approx(own.values["x"], abs=0.05)


@pytest.mark.parametrize("names", ["b", "bc"])
def test_what_is_small_draws_no_part_of_what_both_show_to_itself(names: str) -> None:
    """Each leaves less than the noise, and half as much again in the column that determines the shape.

    The first estimate takes that for a part of the shape, the second one beside both does not.
    """
    form, true = Shape(quantity("x", "1", "a shape"), 0.0, 4.0, points=5), 3.0
    flux = replace(
        candidate("flux", shapes=(form,), of=lambda v: mixed({2: 1.0, 3: 0.1 * v["x"]})[:, None]),
        balance="electrical",
        also=lambda values: mixed({5: 2.0, 6: values["x"]})[:, None],
        joint=True,
    )
    others = [candidate(name, {7 + k: 1.0, 6: 0.5}) for k, name in enumerate(names)]
    torque = {5: 6.0, 6: 3.0 * true + 0.45 * len(others), **{7 + k: 0.9 for k in range(len(others))}}
    noise = {"mechanical": 0.99, "electrical": 0.99}
    found = searched(torque, {2: 3.0, 3: 0.3 * true}, flux, *others, noise=noise)
    (own,) = found["electrical"].best.variants

    assert list(names) == sorted(v.candidate.id for v in found["mechanical"].best.variants)
    assert true == pytest.approx(own.values["x"], abs=0.01)


FRICTION = candidate("friction", {5: 1.0, 6: 0.2})


@pytest.mark.parametrize(
    ("ahead", "voltage", "expected"),
    [
        ("flux", 0.107, ["flux"]),
        ("flux", -0.107, ["friction"]),
        ("flux", 0.0, ["friction"]),
        ("friction", 0.107, ["flux", "friction"]),
        ("friction", 0.0, ["friction"]),
    ],
)
def test_the_circuit_is_asked_where_the_torque_cannot_tell(
    ahead: str, voltage: float, expected: list[str]
) -> None:
    """Two in deviance are between them, for either; the voltage that the torque asks for is worth 23."""
    aside = {5: 1.0, 6: 0.0052}
    away = {"flux": aside, "friction": aside} | {ahead: {5: 1.0}}
    flux = replace(on_the_flux(1.0), also=lambda _: (6.0 / 0.107) * mixed(away["flux"])[:, None])

    found = verdict_of({5: 6.0}, {2: voltage}, flux, candidate("friction", away["friction"]))

    assert ("named" if len(expected) == 1 else "not_identifiable", expected) == found


@pytest.mark.parametrize(("part", "expected"), [(0.97, "flux"), (1.03, "friction")])
def test_the_torque_names_an_effect_on_the_flux_unless_its_voltage_is_missing(
    part: float, expected: str
) -> None:
    """It fits the torque better than friction. A voltage v that is not there costs N log(1 + v^2)."""
    predicted = part * math.sqrt(math.expm1(HINTED / N))

    assert ("named", [expected]) == verdict_of({5: 6.0}, {}, on_the_flux(6.0 / predicted), FRICTION)


def test_the_least_of_all_rivals_counts() -> None:
    """A rival without a torque is far behind; one with the same torque is as good, and settles nothing."""
    twin = replace(on_the_flux(2.0, name="twin"), columns=lambda _: mixed({2: 1.0, 3: 1e-3})[:, None])
    other = candidate("other", {2: 1.0, 3: -1e-3}, balance="electrical")

    verdict, names = verdict_of({5: 6.0}, {2: 3.0}, on_the_flux(2.0), twin, other)

    assert ("not_identifiable", True) == (verdict, {"flux", "twin"} <= set(names))


def test_what_the_circuit_shows_besides_is_fitted_beside_the_voltage_of_the_torque() -> None:
    """Fitted without it, the other effect has taken a part of its voltage, which would then count twice."""
    other = candidate("other", {2: 1.0, 3: 0.5}, balance="electrical")
    voltage = {2: 0.2 + 1.0, 3: 0.5}

    assert ("named", ["flux", "other"]) == verdict_of(
        {5: 6.0}, voltage, on_the_flux(6.0 / 0.2), other, FRICTION
    )


def test_the_voltage_denies_an_effect_beside_the_one_that_it_looked_like() -> None:
    """Alone it would explain most of the voltage; beside the constant, a part of its own is missing."""
    constant = candidate("constant", {2: 1.0}, balance="electrical")
    alike = replace(on_the_flux(2.0), columns=lambda _: mixed({2: 1.0, 3: 0.2})[:, None])

    found = verdict_of({5: 6.0}, {2: 4.0}, constant, alike, FRICTION)

    assert ("named", ["constant", "friction"]) == found


def test_the_circuit_is_against_one_order_and_not_against_its_family() -> None:
    """The torque is more like the first order, whose voltage is missing; that of the second is there."""
    orders = [
        replace(on_the_flux(60.0, voltage=2), id="flux[1]"),
        replace(on_the_flux(60.0, voltage=3), id="flux[2]"),
    ]
    orders[1] = replace(orders[1], also=lambda _: 60.0 * mixed({5: 1.0, 6: 0.02})[:, None])

    assert ("named", ["flux[2]"]) == verdict_of({5: 6.0}, {3: 0.1}, *orders, FRICTION)


@pytest.mark.parametrize(
    ("torque", "voltage", "expected"),
    [
        ({5: 3.0}, {2: 2.0}, ["angle"]),
        ({5: 3.0, 6: 0.7}, {2: 3.7}, ["angle", "ripple"]),
        ({5: 3.0, 9: 4.0}, {2: 3.0, 8: 4.0}, ["angle", "sag"]),
        ({5: 3.0, 9: 4.0}, {2: 2.0, 8: 4.0}, ["angle", "sag"]),
    ],
    ids=["an error", "a ripple", "another effect on the flux", "both"],
)
def test_what_the_torque_gets_wrong_of_a_misread_angle_is_no_ripple_of_the_flux(
    torque: dict[int, float], voltage: dict[int, float], expected: list[str]
) -> None:
    """The circuit alone would take an error of its size for a ripple; a ripple has a torque too."""
    angle = replace(candidate("angle", {5: 1.0}), also=lambda _: mixed({2: 1.0})[:, None])
    ripple = on_the_flux(1.0, torque=6, name="ripple")
    sag = on_the_flux(1.0, torque=9, voltage=8, name="sag")

    assert ("named", expected) == verdict_of(torque, voltage, angle, ripple, sag)
