"""The records of the library: complete, sound, composing, told apart in words; and a user's own file."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from eccentric.core import InputError
from eccentric.effects import (
    FAMILIES,
    Effect,
    Evidence,
    Kin,
    Words,
    base_aliases,
    library,
    load_effects,
    measurement_between,
)
from eccentric.emission import load_module
from eccentric.model import (
    ANGLE,
    DRIVE_PARTS,
    MOTOR_ANGLE,
    OUTPUT_ANGLE,
    Change,
    Definition,
    load_model,
    quantity,
)
from eccentric.model import vocabulary as v
from eccentric.model.limit import of_expression, of_unit
from tests.extended import BASE, CASES, KNOWN, effects, every_case, setting


@every_case
def test_every_family_of_the_table_is_offered_or_an_alias(case: str) -> None:
    """FAMILIES lists exactly what the modules make, except for what a case already contains."""
    made = {effect.family for effect in effects(case).values()}

    assert set(FAMILIES) - set(base_aliases(case)) == made


@every_case
def test_records_are_complete(case: str) -> None:
    """Every effect has a formula, a reference, variables, and its ranges the right way round."""
    for effect in effects(case).values():
        assert all((effect.formula, effect.reference, effect.evidence.depends_on, effect.parameters)), (
            effect.id
        )
        assert len(effect.coefficients) == len(effect.bounds), effect.id
        for shape in effect.shapes:
            assert (effect.id, True) == (effect.id, 0 <= shape.low < shape.high or shape.scale == "linear")


@every_case
def test_parts_and_ranges_are_complete(case: str) -> None:
    """An effect needs parts that a rig can name; a range has two ends, a dated source, and known letters."""
    letters = {q.name for q in load_model(BASE[case]).parameters}
    known_parts = {**DRIVE_PARTS, ANGLE: (*MOTOR_ANGLE, *OUTPUT_ANGLE)}
    for effect in effects(case).values():
        for kind, words in effect.only_with.items():
            assert (effect.id, set()) == (effect.id, set(words) - set(known_parts[kind]))
        for known in effect.plausible:
            used = {symbol.name for symbol in known.value.free_symbols}
            assert (effect.id, set()) == (effect.id, used - letters - {q.name for q in effect.parameters})
            for low, high, source in ((known.low, known.high, known.source), *known.by_part.values()):
                assert low < high, effect.id
                assert re.search(r"\b(18|19|20)\d\d\b|undated", source), source
            assert set(known.by_part) <= {word for words in DRIVE_PARTS.values() for word in words}
            assert known.usual is None or known.low <= known.usual <= known.high


def test_families_without_a_known_range_are_these() -> None:
    """Where no source gives a range that a rig file could be compared with, none is declared."""
    known = {e.family for case in CASES for e in effects(case).values() if e.plausible}

    assert set(FAMILIES) - known == {
        "quadratic_drag", "oneway_windage", "cubic_drag", "sublinear_viscous", "eddy_current",
        "coulomb_temperature", "local_defect", "cable_spring", "gravity_tilt", "angle_offset",
        "mass_mismatch", "inertia_mismatch",
        "kt_saturation", "magnetic_hysteresis", "current_bias", "inverter_deadtime", "armature_inductance",
        "wear_runin", "time_drift", "sensor_delay", "joint_compliance",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("parts", "families"),
    [
        (
            {"gear": ("none",)},
            {"gear_efficiency", "load_dependent", "backlash", "kinematic_error", "stribeck_load"},
        ),
        ({"gear": ("strain wave",)}, {"backlash"}),
        ({"gear": ("strain wave", "belt")}, set()),
        ({"motor": ("brushless",)}, {"eddy_current"}),
        ({"motor": ("brushless", "eddy-current brake")}, set()),
        ({"motor": ("coreless",)}, {"eddy_current", "cogging", "kt_saturation", "magnetic_hysteresis"}),
        ({"motor": ("slotless",)}, {"eddy_current", "cogging"}),
        ({"motor": ("induction",)}, {"cogging", "kt_ripple", "magnet_temperature"}),
        ({"angle": ("output",)}, {"cogging", "kt_ripple", "motor_harmonic_friction"}),
        ({"bearing": ("plain",)}, {"bearing_load"}),
        ({"lubricant": ("none",)}, {"viscosity_temperature", "stribeck_temperature"}),
        ({}, set()),
    ],
)
def test_a_drive_has_no_cause_without_the_part_that_makes_it(
    parts: dict[str, tuple[str, ...]], families: set[str]
) -> None:
    """No teeth, no backlash; no slots, no cogging; what a rig does not say rules out nothing."""
    assert families == {effect.family for effect in effects("C2").values() if effect.lacks(parts)}


@pytest.mark.parametrize(("known", "linked"), [({}, True), ({"M_l": 0.0}, False), ({"M_l": 0.3}, True)])
def test_no_link_is_to_be_removed_from_a_bare_motor(known: dict[str, float], linked: bool) -> None:
    """Without an imbalance and a mass of the link, nobody is told to take it off; a disc may be."""
    bare = {**KNOWN, "M": 0.0, "L": 0.0, **known} if known else KNOWN
    made = library(dataclasses.replace(setting("C1", warm=False), known=bare))
    advice = [text for effect in made for text in effect.words.tell_apart.values()]

    assert linked == any("link removed" in text for text in advice)


@every_case
def test_backlash_is_named_by_what_stands_in_the_gap(case: str) -> None:
    """The share of gravity that the motor does not carry; without gravity, dry friction: the speed is low."""
    expected = {"C1": "backlash_C", "C2": "backlash_G"}[case]

    assert expected == effects(case)["backlash"].coefficients[0].name


def test_parameter_names_are_short_and_tell_the_family() -> None:
    """A name of a parameter belongs to one family and has 24 characters at most."""
    owner: dict[str, str] = {}
    for case in CASES:
        for effect in effects(case).values():
            brought = (*effect.parameters, *(d.quantity for d in effect.change.definitions))
            for q in (*brought, *(s.quantity for s in effect.change.states)):
                assert len(q.name) <= 24, q.name
                assert effect.family == owner.setdefault(q.name, effect.family), q.name


@every_case
def test_harmonics_of_all_orders_stand_side_by_side(case: str) -> None:
    """Orders have parameters of their own: one model takes them all."""
    model = load_model(BASE[case])
    orders = [e for e in effects(case).values() if e.evidence.repeats]
    for effect in orders:
        model = effect.extend(model)

    assert len(load_model(BASE[case]).parameters) + 2 * len(orders) == len(model.parameters)


def test_harmonics_begin_with_once_a_turn() -> None:
    """Every order is offered, 12 of the link and 24 of the motor, but what at mu = 1/5 is one of the link."""
    orders: dict[str, list[int]] = {}
    for effect in effects("C2").values():
        if effect.evidence.repeats:
            orders.setdefault(effect.family, []).append(int(effect.variant.removeprefix("n=")))

    assert {
        "link_harmonic_friction": list(range(1, 13)),
        "motor_harmonic_friction": list(range(3, 25)),
        "cogging": list(range(1, 25)),
        "kt_ripple": list(range(1, 25)),
    } == orders


@every_case
def test_dimensions_hold(case: str) -> None:
    """Terms have the unit of their balance, definitions and updates that of their quantity."""
    for effect in effects(case).values():
        model = effect.extend(load_model(BASE[case]))
        units = {**model.units(), v.dt.symbol: "s"}
        for balance in model.balances:
            for term in balance.terms:
                assert of_unit(balance.unit) == of_expression(term.value, units), (effect.id, term.name)
        for definition in effect.change.definitions:
            if not definition.value.is_number:  # a constant brings its unit along
                expected = of_unit(definition.quantity.unit)
                assert expected == of_expression(definition.value, units), (
                    effect.id,
                    definition.quantity.name,
                )
        for state in effect.change.states:
            assert of_unit(state.quantity.unit) == of_expression(state.update, units), (
                effect.id,
                state.symbol,
            )


@every_case
def test_hidden_states_but_those_with_a_gap_are_affine_in_themselves(case: str) -> None:
    """Next = a(inputs) state + b(inputs): such states are computed along a log without a loop."""
    curved = {
        effect.id
        for effect in effects(case).values()
        for state in effect.change.states
        if sp.diff(state.update, state.symbol).has(state.symbol)
    }

    lag = {"backlash[lag]"} if case == "C2" else set()
    assert {"magnetic_hysteresis[play]", "backlash"} | lag == curved


def test_effects_need_the_channels_they_are_seen_in() -> None:
    """Without a voltage nothing electrical is offered; a current bias is then an alias of an asymmetry."""
    torque_only = dataclasses.replace(setting("C2", warm=False), channels=frozenset({"current"}))
    offered = {effect.id: effect for effect in library(torque_only)}

    assert {"mechanical"} == {effect.balance for effect in offered.values()}
    assert ("current_bias",) == offered["coulomb_asymmetry"].evidence.aliases


def test_what_the_base_model_of_c1_holds_is_an_alias() -> None:
    """In C1 w|w| and w^3 are the columns of C_lN and B_lN up to a factor."""
    columns = load_module(load_model(BASE["C1"])).regressor(w := np.array([-30.0, -2.0, 5.0, 60.0]))

    for column, power in ((0, w**3), (1, w * np.abs(w))):
        np.testing.assert_allclose(columns[:, column] / power, columns[0, column] / power[0], rtol=1e-13)
    assert {"quadratic_drag", "cubic_drag"} < set(base_aliases("C1"))


def replacing(name: str) -> Effect:
    """Return an effect of a user's own that replaces the mass."""
    lost = Definition(quantity(name, "kg", "mass with water in it"), v.M.symbol * sp.Rational(11, 10))
    change = Change(definitions=(lost,), replaces={v.M.symbol: lost.symbol})
    return Effect(name, "mechanical", "1.1 M", "own", change, Evidence(("gravity_load",)))


def test_two_effects_that_replace_one_quantity_are_refused() -> None:
    """The second to replace the mass gets an error that names it."""
    once = replacing("wet").extend(load_model(BASE["C2"]))

    with pytest.raises(ValueError, match=r"^mass_mismatch and wet: both replace M$"):
        effects("C2")["mass_mismatch"].extend(once)


def test_an_effect_is_refused_twice_and_where_it_has_nothing_to_replace() -> None:
    """Its names are taken the second time; case C1 has no angle to shift."""
    once = effects("C1")["eddy_current"].extend(load_model(BASE["C1"]))

    with pytest.raises(ValueError, match=r"^eddy_current: is already in c1_perpendicular$"):
        effects("C1")["eddy_current"].extend(once)
    with pytest.raises(ValueError, match="theta_m does not occur in c1_perpendicular"):
        effects("C2")["angle_offset"].extend(load_model(BASE["C1"]))


def test_replacing_reaches_hidden_states() -> None:
    """An angle that is shifted after heating was added shifts the gravity in the heating too."""
    warm = effects("C2")["hidden_thermal_drift"].extend(load_model(BASE["C2"]))
    both = effects("C2")["angle_offset"].extend(warm)

    assert v.theta_m.symbol in warm.states[0].update.free_symbols
    assert v.theta_m.symbol not in both.states[0].update.free_symbols


OWN = """
from eccentric.effects import Effect, Evidence
from eccentric.model import Change, Role, Term, quantity
from eccentric.model import vocabulary as v

q = quantity("brush_A", "N m", "brush torque")


def make(setting):
    term = Term("brush", "friction", q.symbol, v.omega_m.symbol**5 / sum(range(1, 2)), "own", role=Role.DRAG)
    change = Change({"mechanical": (term,)})
    return Effect("brush", "mechanical", "A w^5", "own", change, Evidence(("velocity",)), coefficients=(q,))


"""


@pytest.mark.parametrize("tail", ["def effects(setting):\n    return [make(setting)]", "effect = make(None)"])
def test_a_users_file_loads(tail: str, tmp_path: Path) -> None:
    """A function `effects(setting)` or one `effect` is found, and extends a model."""
    (tmp_path / "own.py").write_text(OWN + tail)

    (found,) = load_effects(tmp_path / "own.py", setting("C1", warm=False))

    assert "brush_A" in {q.name for q in found.extend(load_model(BASE["C1"])).parameters}


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        (None, "no such script of effects"),
        ("x = 1", "expected a function `effects\\(setting\\)` or an `effect` of type Effect, got NoneType"),
        ("effect = 3", "got int"),
        ("def effects(setting):\n    return [3]", "expected effects of type Effect, got int"),
        ("1 / 0", "stopped with ZeroDivisionError: division by zero"),
        ("def effects(setting):\n    return setting.nothing", "stopped with AttributeError"),
        ("def effects(setting):\n    yield setting.nothing", "stopped with AttributeError"),
    ],
    ids=[
        "missing",
        "empty",
        "of a wrong type",
        "list of a wrong type",
        "stops",
        "stops when called",
        "stops midway",
    ],
)
def test_a_bad_file_gets_one_clear_line(source: str | None, expected: str, tmp_path: Path) -> None:
    """What is wrong with a user's file is said in one line that names the file."""
    path = tmp_path / "own.py"
    if source is not None:
        path.write_text(source)

    with pytest.raises(InputError, match=expected) as caught:
        load_effects(path, setting("C1", warm=False))

    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


def test_a_setting_without_range_is_refused() -> None:
    """A range that is not positive is named."""
    with pytest.raises(ValueError, match="w_max: expected a value above 0"):
        dataclasses.replace(setting("C1", warm=False), w_max=0.0)


def test_an_offset_of_the_drives_sensor_is_said_where_it_looks_like_coulomb_friction() -> None:
    """With current and voltage it is an effect of its own; with one of them, or a torque, it is the same."""
    offset = "or an offset of the drive's sensor"
    both = {"current", "voltage"}
    for channels, by_voltage in ((both, False), ({"current"}, False), (set[str](), False), (both, True)):
        given = {"channels": frozenset(channels), "by_voltage": by_voltage}
        found = library(dataclasses.replace(setting("C1", warm=False), **given))
        (words,) = (e.words for e in found if e.family == "coulomb_asymmetry")

        assert (offset in words.headline) == (by_voltage or channels != both)


# What a person reads about an effect: complete, distinct, and decisive between similar families.


@every_case
def test_headlines_are_distinct_noun_phrases(case: str) -> None:
    """A headline continues "Missing: ...": no sentence of its own, no id, no brackets."""
    headlines = {effect.id: effect.words.headline for effect in effects(case).values()}

    assert [] == [
        effect_id
        for effect_id, text in headlines.items()
        if len(text.split()) < 3
        or text.endswith(".")
        or set("_(") & set(text)
        or text.split()[0] in {"The", "A", "An"}
    ]
    # The forms of what covers others have one name, as those have where a log does not tell them apart.
    forms = {e.words.headline for e in effects(case).values() if e.evidence.covers}
    distinct = [text for text in headlines.values() if text not in forms]
    assert len(distinct) == len(set(distinct))
    assert len(forms) == len({e.family for e in effects(case).values() if e.evidence.covers})


@every_case
def test_the_headline_of_a_harmonic_has_its_order(case: str) -> None:
    """Orders one and two have words of their own in English, all others a number."""
    found = effects(case)

    assert [
        "friction that varies once per turn of the link",
        "friction that varies twice per turn of the link",
        "friction that varies 3 times per turn of the link",
    ] == [found[f"link_harmonic_friction[n={n}]"].words.headline for n in (1, 2, 3)]


def test_a_family_has_one_meaning_and_one_hint() -> None:
    """All effects of a family share meaning and hint; no two families share a meaning."""
    meanings: dict[str, set[str]] = {}
    hints: dict[str, set[str]] = {}
    for case in CASES:
        for effect in effects(case).values():
            meanings.setdefault(effect.family, set()).add(effect.words.meaning)
            hints.setdefault(effect.family, set()).add(effect.words.hint)

    assert {1} == {len(texts) for texts in (*meanings.values(), *hints.values())}
    assert [] == [f for f, texts in meanings.items() if not min(texts).endswith(".") or len(min(texts)) < 20]
    assert "" not in set.union(*hints.values())
    assert len(meanings) == len(set.union(*meanings.values()))


@every_case
def test_words_name_families_and_kins_that_exist(case: str) -> None:
    """What distinguishes an effect is keyed by a family of the library or by a kin of one."""
    words = {effect.family: effect.words for effect in effects(case).values()}
    kins = {own.kin.name for own in words.values() if own.kin}
    known = kins | {e.family for c in CASES for e in effects(c).values()}

    assert set() == {key for own in words.values() for key in own.tell_apart} - known
    assert set() == {key for own in words.values() if own.kin for key in own.kin.tell_apart} - kins


SPEED = Kin("speed", {"speed": "More speeds."})
HEAT = Kin("heat", {"heat": "More heat.", "speed": "Warm and cold."})
A = ("a", Words(kin=SPEED, tell_apart={"b": "Look at b."}))
B = ("b", Words(kin=SPEED, tell_apart={"heat": "Log a temperature."}))
C = ("c", Words(kin=HEAT))
D = ("d", Words(kin=SPEED))
LONE = ("lone", Words())


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        (A, B, "Look at b."),
        (B, C, "Log a temperature."),
        (A, C, "Warm and cold."),
        (A, D, "More speeds."),
        (A, A, "More speeds."),
        (A, LONE, ""),
        (LONE, LONE, ""),
    ],
    ids=["family", "kin of the other", "two kins", "one kin", "alone", "one without kin", "none"],
)
def test_the_closest_relation_names_the_measurement(
    first: tuple[str, Words], second: tuple[str, Words], expected: str
) -> None:
    """A sentence on the other family precedes one on its kin, and that the kins' own; either way round."""
    assert [expected, expected] == [measurement_between(first, second), measurement_between(second, first)]


@every_case
def test_gravity_has_nothing_to_act_on_without_a_mass(case: str) -> None:
    """A bare motor has no tilted plane; in a torque that a controller logs, gravity may be subtracted."""
    bare = dataclasses.replace(setting(case, warm=False), known={"M": 0.0, "L": 0.0, "mu": 1.0})
    torque = dataclasses.replace(bare, channels=frozenset())
    assert "gravity_tilt" not in {effect.family for effect in library(bare)}
    assert "gravity_tilt" in {effect.family for effect in library(torque)}
