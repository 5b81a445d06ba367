"""Effects in pairs: the order of adoption changes nothing; what scales friction reaches it by its role."""

import hashlib
import itertools
from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.effects import Effect, library
from eccentric.emission import load_module
from eccentric.model import Model, load_model, meaning
from tests.extended import M_L, MU, L, M, effects, setting

MODELS = {
    "c1_perpendicular": "C1",
    "c1_asymmetric": "C1",
    "c2_parallel": "C2",
    "c2_asymmetric": "C2",
    "rotating_link": "C2",
}
WHOLE = ("c1_asymmetric",)
"""With every pair, among the slow tests: friction by the direction."""


@cache
def whole_library(name: str) -> tuple[Effect, ...]:
    """Return every effect for a base model, with and without a logged temperature."""
    base = load_model(name)
    made = {
        effect.id: effect
        for warm in (True, False)
        for effect in library(replace(setting(MODELS[name], warm=warm), base=base))
    }
    return tuple(made.values())


def few_orders(name: str) -> tuple[Effect, ...]:
    """Return the library with two orders of each harmonic: others differ in a number only."""
    shown: dict[str, int] = {}
    found = []
    for effect in whole_library(name):
        shown[effect.family] = shown.get(effect.family, 0) + 1
        if not effect.evidence.repeats or shown[effect.family] <= 2:
            found.append(effect)
    return tuple(found)


def content(model: Model) -> dict[str, Any]:
    """Return what a model is, whatever the order in which it lists its parts."""
    return {
        "inputs": [q.name for q in model.inputs],
        "parameters": {q.name: q for q in model.parameters},
        "definitions": {d.quantity: d.value for d in model.definitions},
        "balances": {(b.name, b.unit): set(b.terms) for b in model.balances},
        "states": {s.quantity: (s.initial, s.update) for s in model.states},
        "replaced": model.replaced,
    }


def joined(base: Model, pair: Iterable[Effect]) -> dict[str, Any] | str:
    """Return the content of the base model with the effects, or the line that refuses them."""
    model = base
    try:
        for effect in pair:
            model = effect.extend(model)
    except InputError as error:
        return str(error)
    return content(model)


Pair = tuple[Effect, Effect]


def every_nth(pairs: Iterable[Pair], step: int) -> list[Pair]:
    """Return one pair in `step`, always the same ones, and every pair of two that replace or scale."""

    def rules(effect: Effect) -> bool:
        return bool(effect.change.replaces or effect.change.scales)

    def turn(pair: Pair) -> int:
        return hashlib.sha256(" ".join(effect.id for effect in pair).encode()).digest()[0]

    return [pair for pair in pairs if all(map(rules, pair)) or turn(pair) % step == 0]


def differ_by_order(name: str, pairs: Iterable[Pair]) -> list[tuple[str, str]]:
    """Return the pairs of effects whose order changes the model, or the line that refuses them."""
    base = load_model(name)
    found = []
    for one, other in pairs:
        there, back = joined(base, (one, other)), joined(base, (other, one))
        if there != back or (isinstance(there, str) and "\n" in there):
            found.append((one.id, other.id))
    return found


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name == "c1_perpendicular" else pytest.mark.slow)
        for name in MODELS
        if name not in WHOLE
    ],
)
def test_the_order_of_two_effects_changes_nothing(name: str) -> None:
    """A pair of the library gives one model in both orders, or one refusal in one line; an eighth of them."""
    assert [] == differ_by_order(name, every_nth(itertools.combinations(few_orders(name), 2), 8))


@pytest.mark.slow
@pytest.mark.parametrize("name", WHOLE)
def test_the_order_of_two_effects_changes_nothing_whatever_the_harmonic(name: str) -> None:
    """The same for every pair, with all orders of all harmonics."""
    assert [] == differ_by_order(name, itertools.combinations(whole_library(name), 2))


def test_the_order_of_four_effects_changes_nothing() -> None:
    """Two that replace, one that scales and one that adds friction in states: one model in all 24 orders."""
    chosen = [
        effects("C2")[e] for e in ("mass_mismatch", "angle_offset", "time_drift[all]", "presliding[lugre]")
    ]
    base = load_model("c2_parallel")
    first, *others = (joined(base, order) for order in itertools.permutations(chosen))

    assert not isinstance(first, str)
    assert all(first == other for other in others)


def test_what_cannot_be_joined_is_refused_by_names_alone() -> None:
    """Two that replace the mass, and two variants that bring the same names: one line, the same both ways."""
    base, known = load_model("c2_parallel"), effects("C2")
    mass, inertia = known["mass_mismatch"], known["mass_mismatch[inertia]"]
    cold, warm = known["viscosity_temperature"], known["viscosity_temperature[bearing]"]

    said = "mass_mismatch and mass_mismatch[inertia]: both introduce M_true, mass_ratio"
    assert [said, said] == [joined(base, (mass, inertia)), joined(base, (inertia, mass))]
    said = (
        "viscosity_temperature and viscosity_temperature[bearing]: both introduce viscosity_T0, viscosity_b"
    )
    assert [said, said] == [joined(base, (cold, warm)), joined(base, (warm, cold))]


# --- What a factor on friction reaches ----------------------------------------------------------------------

VISCOUS = {
    "viscous_asymmetry", "sublinear_viscous[n=0.5]", "sublinear_viscous[n=0]",
    "viscosity_temperature[bearing]", "hidden_thermal_drift[bearing]",
}  # fmt: skip
COULOMB = {
    "coulomb_asymmetry", "coulomb_temperature[bearing]", "hidden_thermal_drift[coulomb]",
    "link_harmonic_friction[n=1]", "link_harmonic_friction[n=2]", "motor_harmonic_friction[n=3]",
    "motor_harmonic_friction[n=4]", "nonsynchronous_friction", "bearing_load[degressive]",
    "bearing_load[progressive]", "bearing_load[preload]", "load_dependent[transmitted]",
    "load_dependent[progressive]", "load_dependent[gravity]", "gear_efficiency[transmitted]",
    "gear_efficiency[gravity]", "gear_efficiency[transmitted,driven]", "gear_efficiency[gravity,driven]",
    "local_defect", "time_drift", "wear_runin", "wear_runin[travel]", "presliding", "presliding[lugre]",
}  # fmt: skip
STRIBECK = {
    "stribeck[d=0.5]", "stribeck[d=1]", "stribeck[d=1.5]", "stribeck[d=2]", "stribeck_load[transmitted,d=1]",
    "stribeck_load[transmitted,d=2]", "stribeck_load[gravity,d=1]", "stribeck_load[gravity,d=2]",
    "stribeck_temperature", "stribeck_load[F_N]",
}  # fmt: skip
MIXED = {"backlash"}
NEITHER = {"quadratic_drag", "cubic_drag", "oneway_windage[+]", "oneway_windage[-]", "eddy_current"}
REACHED = {
    "viscosity_temperature": VISCOUS,
    "viscosity_temperature[arrhenius]": VISCOUS,
    "hidden_thermal_drift[viscous]": VISCOUS,
    "coulomb_temperature": COULOMB,
    "hidden_thermal_drift": VISCOUS | COULOMB | STRIBECK | MIXED,
    "time_drift[all]": VISCOUS | COULOMB | STRIBECK | MIXED,
}


def test_every_friction_of_the_library_has_its_place_in_the_table() -> None:
    """The sets above are disjoint and hold each effect that adds friction, as its physics says."""
    adding = {
        effect.id
        for effect in few_orders("c2_parallel")
        if any(term.kind == "friction" for terms in effect.change.terms.values() for term in terms)
    }
    sets = (VISCOUS, COULOMB, STRIBECK, MIXED, NEITHER)

    assert adding == set().union(*sets)
    assert len(adding) == sum(map(len, sets))


@pytest.mark.parametrize("scaling", REACHED)
def test_a_factor_reaches_the_friction_of_its_role_and_no_other(scaling: str) -> None:
    """Of what another effect adds, viscosity scales what is viscous, and no drag, windage or eddy current."""
    known, base, reached = effects("C2"), load_model("c2_parallel"), set()
    (factor,) = set(known[scaling].change.scales.values())
    for other in few_orders("c2_parallel"):
        if other.id in MIXED or other.id not in set().union(*REACHED.values(), STRIBECK, NEITHER):
            continue
        model = base
        try:
            for effect in (known[scaling], other):
                model = effect.extend(model)
        except InputError:
            # Two variants of a family are not joined; either is an expression of the same role.
            reached |= {other.id} & REACHED[scaling]
            continue
        own = {q.symbol for q in other.coefficients}
        terms = [t for t in model.balance("mechanical").terms if t.coefficient in own]
        if all(factor in t.basis.free_symbols for t in terms):
            reached.add(other.id)
        else:
            assert not any(factor in t.basis.free_symbols for t in terms), other.id

    assert REACHED[scaling] - MIXED == reached


@pytest.mark.parametrize(
    ("scaling", "other", "expected"),
    [
        ("viscosity_temperature", "backlash", {"B_m", "B_lN", "backlash_B"}),
        ("coulomb_temperature", "backlash", {"C_m", "C_lN", "backlash_C"}),
        ("coulomb_temperature", "presliding[lugre]", {"C_m", "C_lN", "presliding_A", "presliding_D"}),
    ],
)
def test_each_part_of_an_effect_is_scaled_by_its_own_role(
    scaling: str, other: str, expected: set[str]
) -> None:
    """In the gap neither friction of the bearing is felt; warm bristles carry what warm sliding does."""
    known = effects("C2")
    model = known[scaling].extend(known[other].extend(load_model("c2_parallel")))
    (factor,) = set(known[scaling].change.scales.values())

    assert expected == {str(t.coefficient) for t in model.balance("mechanical").terms if t.basis.has(factor)}


W, TEMPERATURE, THETA = 30.0, 45.0, 0.7 / MU
ASYMMETRIES = (
    ("viscous_asymmetry", "viscosity_temperature", {"viscous_asym": 2e-4, "viscosity_b": 0.04}),
    ("coulomb_asymmetry", "coulomb_temperature", {"coulomb_asym": 3e-3, "coulomb_b": -0.01}),
)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)], ids=["asymmetry first", "temperature first"])
@pytest.mark.parametrize(("asymmetry", "temperature", "values"), ASYMMETRIES, ids=["viscous", "coulomb"])
def test_a_warm_asymmetric_bearing_follows_the_closed_form(
    asymmetry: str, temperature: str, values: dict[str, float], order: tuple[int, int]
) -> None:
    """Forwards its coefficient is the sum of mean and asymmetry, times one factor of the temperature."""
    pair = [effects("C2")[asymmetry], effects("C2")[temperature]]
    model = load_model("c2_parallel")
    for k in order:
        model = pair[k].extend(model, values)
    actual = load_module(model).mechanical_friction_torque(THETA, W, TEMPERATURE)

    radial, weight = M * L * (MU * W) ** 2, (M + M_L) * 9.81
    force = np.sqrt(radial**2 + weight**2 + 2 * radial * weight * np.cos(MU * THETA))
    warmer = TEMPERATURE - 25.0
    viscous = 0.0004 + values.get("viscous_asym", 0.0) + MU**2 * 0.004 * force
    dry = 0.008 + values.get("coulomb_asym", 0.0) + MU * 0.08 * force
    expected = viscous * W * np.exp(-values.get("viscosity_b", 0.0) * warmer) + dry * (
        1.0 + values.get("coulomb_b", 0.0) * warmer
    )
    assert actual == pytest.approx(expected, rel=1e-12)


def test_what_is_replaced_is_replaced_in_what_comes_later_too() -> None:
    """A harmonic adopted after an offset of the angle turns with the true angle, as one adopted before."""
    known = effects("C2")
    model = known["link_harmonic_friction[n=1]"].extend(
        known["angle_offset"].extend(load_model("c2_parallel"), {"offset_angle": 0.3})
    )
    values = {"link_harmonic_c1": 1.0, "mu": MU, "theta_m": THETA, "offset_angle": 0.3, "omega_m": W}
    (term,) = [t for t in model.balance("mechanical").terms if t.name == "link_harmonic_c1"]

    assert model.value(meaning(term.value), values) == pytest.approx(np.cos(MU * THETA + 0.3), rel=1e-12)
