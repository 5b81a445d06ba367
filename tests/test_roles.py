"""Roles: what a term does is declared with it, so that names are free."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest
import sympy as sp

from eccentric.core import InputError
from eccentric.effects import library
from eccentric.emission import build_program, load_module
from eccentric.identification import drive_of, fit, fit_data_of, refit
from eccentric.model import (
    Definition,
    Load,
    Model,
    Role,
    Sgn,
    Term,
    load_model,
    model_names,
    quantity,
    regressor,
)
from eccentric.model import vocabulary as v
from eccentric.presentation import emitted_parameters
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from tests import planted
from tests.extended import setting
from tests.virtual import log_of

w = v.omega_m.symbol
FAMILY = "inertia_mismatch"


def with_friction(coefficient: str) -> Model:
    """Return case C2 with a drag by w|w|, its coefficient of this name."""
    base = load_model("c2_parallel")
    drag = quantity(coefficient, "N m s^2/rad^2", "drag of a fan", "", "nonnegative")
    term = Term("fan", "friction", drag.symbol, w**2 * Sgn(w), "own", role=Role.DRAG)
    mechanical, electrical = base.balance("mechanical"), base.balance("electrical")
    return replace(
        base,
        name="with_fan",
        parameters=(*base.parameters, drag),
        balances=(replace(mechanical, terms=(*mechanical.terms, term)), electrical),
    )


@pytest.fixture(scope="module")
def fan(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Return a log of a drive with quadratic drag, and its rig."""
    return log_of(tmp_path_factory.mktemp("fan"), 11, ("quadratic_drag", 0.2))


@pytest.mark.parametrize(
    "coefficient", ["eta_lN", *(pytest.param(one, marks=pytest.mark.slow) for one in ("D_m", "B_fan", "x"))]
)
def test_a_friction_parameter_of_ones_own_is_fitted_whatever_its_name(
    coefficient: str, fan: tuple[Path, Path]
) -> None:
    """The model that is diagnosed has the held-out error of the fit, and far less than without the term."""
    rig = read_rig(fan[1])
    channels, paper = read_channels([fan[0]], rig), load_model("c2_parallel")
    model = with_friction(coefficient)
    fitted = fit(channels, rig, model)
    again = refit(model, (), fit_data_of(drive_of(channels, rig, model), rig, model))

    assert again.held_out("mechanical") == pytest.approx(fitted.rmse["paper"], rel=1e-9)
    assert again.values[coefficient] == pytest.approx(fitted.coefficients[coefficient].value, rel=1e-9)
    assert again.held_out("mechanical") < 0.6 * fit(channels, rig, paper).rmse["paper"]


def renamed(names: dict[str, str], values: Mapping[str, float]) -> Model:
    """Return case C2 with parameters of other names, and these values as their defaults."""
    base = load_model("c2_parallel")
    own = {
        q.symbol: replace(
            q, symbol=sp.Symbol(names[q.name], **q.symbol.assumptions0), default=sp.Float(values[q.name])
        )
        for q in base.parameters
        if q.name in names
    }
    other = {symbol: q.symbol for symbol, q in own.items()}

    def again(term: Term) -> Term:
        return replace(term, coefficient=term.coefficient.xreplace(other), basis=term.basis.xreplace(other))

    return replace(
        base,
        name="renamed",
        parameters=tuple(own.get(q.symbol, q) for q in base.parameters),
        definitions=tuple(replace(d, value=d.value.xreplace(other)) for d in base.definitions),
        balances=tuple(replace(b, terms=tuple(map(again, b.terms))) for b in base.balances),
        equations=(),
    )


@pytest.mark.parametrize(
    "names",
    [
        pytest.param({"k_i": "K_t"}, marks=pytest.mark.slow),
        pytest.param({"R": "R_a", "k_e": "K_b"}, marks=pytest.mark.slow),
        {"J_m": "J_r", "J_l": "a"},
        {"mu": "n"},
        {"M": "m_1", "L": "l_1", "M_l": "m_2", "g": "g_0"},
    ],
    ids=" ".join,
)
def test_a_model_is_fitted_alike_whatever_its_parameters_are_called(
    names: dict[str, str], fan: tuple[Path, Path]
) -> None:
    """With the rig's values as defaults, motor, inertia, gear and load of other names are the same drive."""
    rig = read_rig(fan[1])
    channels, paper = read_channels([fan[0]], rig), load_model("c2_parallel")
    model = renamed(names, rig.known)
    there, here = (fit(channels, rig, one) for one in (paper, model))
    before, after = (
        refit(one, (), fit_data_of(drive_of(channels, rig, one), rig, one)) for one in (paper, model)
    )

    assert set(here.coefficients) == set(there.coefficients)
    assert here.rmse["paper"] == pytest.approx(there.rmse["paper"], rel=1e-9)
    assert after.held_out("mechanical") == pytest.approx(before.held_out("mechanical"), rel=1e-9)
    assert {n: after.values[n] for n in after.estimates} == pytest.approx(
        {n: before.values[n] for n in before.estimates}, rel=1e-9
    )


@pytest.mark.parametrize(
    "names", [{"k_i": "K_t"}, {"R": "R_a"}, {"k_e": "K_b"}, {"k_i": "K_t", "R": "R_a", "k_e": "K_b"}]
)
def test_the_torque_of_a_voltage_is_that_of_the_motor_whatever_its_parameters_are_called(
    names: dict[str, str], tmp_path: Path
) -> None:
    """The planted friction comes back, in fit and diagnosis, with part of the motor or all of it renamed."""
    known = f'case = "C2"\n{planted.KNOWN}{planted.MOTOR}{planted.MASS}'
    channels, rig = planted.written(tmp_path, known, {"voltage_V": planted.voltage("C2")})
    model = renamed(names, rig.known)
    again = refit(model, (), fit_data_of(drive_of(channels, rig, model), rig, model))

    for found in (fit(channels, rig, model).coefficients, again.estimates):
        assert {n: e.value for n, e in found.items()} == pytest.approx(planted.FRICTION, rel=1e-5)


def test_a_motor_of_ones_own_without_a_value_is_refused_in_one_line(fan: tuple[Path, Path]) -> None:
    """No rig file has a name for K_t: without a default, a current has no torque."""
    rig = read_rig(fan[1])
    model = renamed({"k_i": "K_t"}, rig.known)
    bare = tuple(replace(q, default=None) if q.name == "K_t" else q for q in model.parameters)

    with pytest.raises(InputError, match="K_t") as refused:
        fit(read_channels([fan[0]], rig), rig, replace(model, parameters=bare))
    assert "since K_t is the model's own, got none" in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("names", "gone"),
    [({}, set[str]()), ({"k_i": "K_t"}, {"kt_ripple"}), ({"R": "R_a"}, {"resistance_temperature"})],
)
def test_effects_are_offered_where_the_model_has_what_they_change(
    names: dict[str, str], gone: set[str]
) -> None:
    """Each that is offered extends the model; an effect on k_i is none of a motor with K_t."""
    given = setting("C2", warm=True)
    model = renamed(names, given.known)
    offered = library(replace(given, base=model))
    every = {effect.family for effect in library(given)}

    assert every >= gone
    assert not gone & {effect.family for effect in offered}
    assert all(effect.extend(model).extensions for effect in offered)


def test_a_name_like_that_of_a_derivative_changes_no_emitted_operation() -> None:
    """A drag named B_d_fan is emitted as one named B_a_fan is, name by name."""

    def text(coefficient: str) -> list[str]:
        routines = build_program(with_friction(coefficient)).routines
        return [str(a.value).replace(coefficient, "B_fan") for r in routines for a in r.assignments]

    assert text("B_a_fan") == text("B_d_fan")


def test_what_follows_from_the_velocity_by_way_of_a_definition_is_none_at_standstill() -> None:
    """Dry friction in proportion to a defined cube of `speed` leaves the Coulomb torque as it is."""
    model, speed = with_friction("C_fan"), v.speed.symbol
    cube = Definition(quantity("cube", "rad^3/s^3", "cubed speed", "", "nonnegative"), speed**3)
    mechanical, electrical = model.balance("mechanical"), model.balance("electrical")
    (fan,) = (term for term in mechanical.terms if term.name == "fan")
    terms = [t for t in mechanical.terms if t is not fan] + [replace(fan, basis=cube.symbol * Sgn(w))]
    model = replace(
        model,
        definitions=(*model.definitions, cube),
        balances=(replace(mechanical, terms=tuple(terms)), electrical),
    )
    module, paper = load_module(model), load_module(load_model("c2_parallel"))

    at_rest = module.breakaway_torque(module.Parameters(C_fan=0.3))
    assert at_rest.tolist() == paper.breakaway_torque().tolist()
    assert module.mechanical_friction_torque(1.0, 2.0, module.Parameters(C_fan=0.3)) == pytest.approx(
        paper.mechanical_friction_torque(1.0, 2.0) + 0.3 * 8.0, rel=1e-14
    )


def with_flywheel() -> Model:
    """Return case C2 with a flywheel J_f on the motor."""
    base = load_model("c2_parallel")
    flywheel = quantity("J_f", "kg m^2", "inertia of a flywheel on the motor", "", "nonnegative", "3e-4")
    inertia = replace(base.definition("J"), value=base.definition("J").value + flywheel.symbol)
    return replace(
        base,
        name="with_flywheel",
        parameters=(*base.parameters, flywheel),
        definitions=tuple(inertia if d.symbol == v.J.symbol else d for d in base.definitions),
    )


def test_a_known_inertia_is_not_fitted_for_a_flywheel_of_the_models_own(fan: tuple[Path, Path]) -> None:
    """The flywheel has its value: the inertia is that of the rig and the flywheel, in fit and diagnosis."""
    rig, model = read_rig(fan[1]), with_flywheel()
    channels = read_channels([fan[0]], rig)
    drive = drive_of(channels, rig, model)

    assert drive.opens("inertia") is False
    assert drive.machine.inertia(drive.known) == pytest.approx(
        rig.known["J_m"] + rig.known["mu"] ** 2 * rig.known["J_l"] + 3e-4, rel=1e-14
    )
    assert set(fit(channels, rig, model).coefficients) == {"B_lN", "C_lN", "B_m", "C_m"}


def test_the_declared_inertia_is_the_models_own() -> None:
    """With a flywheel J_f on the motor in J, a correction of the inertia begins at all three of them."""
    model = with_flywheel()
    (effect,) = (e for e in library(replace(setting("C2", warm=True), base=model)) if e.family == FAMILY)
    values = {"J_m": 2e-4, "J_l": 0.04, "mu": 0.2, "J_f": 3e-4, "inertia_ratio": 0.1}

    assert effect.corrects is not None
    assert model.value(effect.corrects.value, values) == pytest.approx(
        1.1 * (2e-4 + 0.0016 + 3e-4), rel=1e-14
    )


def test_the_linear_model_is_coulomb_and_viscous_friction_that_follow_no_load(fan: tuple[Path, Path]) -> None:
    """Fit and diagnosis take the same two columns for it; drag is none of them, whatever its name."""
    rig = read_rig(fan[1])
    channels, model = read_channels([fan[0]], rig), with_friction("B_fan")
    data = fit_data_of(drive_of(channels, rig, model), rig, model)
    linear = refit(model, (), data, linear=True)

    assert {"B_m", "C_m"} == {c.name for c in regressor(model) if c.linear}
    assert {0.0} == {linear.values[name] for name in ("B_fan", "B_lN", "C_lN")}
    assert linear.held_out("mechanical") == pytest.approx(fit(channels, rig, model).rmse["linear"], rel=1e-9)


@pytest.mark.parametrize("name", ["c1_perpendicular", "c1_asymmetric"])
def test_what_is_emitted_of_a_fit_has_all_its_friction(name: str, tmp_path: Path) -> None:
    """Each fitted column goes into the parameter that represents it: B into B_m, B_pos into B_m_pos."""
    log, file = log_of(tmp_path, 11, case="C1", seconds=20.0)
    rig = read_rig(file)
    fitted = fit(read_channels([log], rig), rig, load_model(name))
    values, *_ = emitted_parameters(fitted)
    expected = {c.parameter.name: fitted.coefficients[c.name].value for c in regressor(load_model(name))}

    assert all(expected[parameter] > 0.0 for parameter in expected if parameter.startswith(("B_m", "C_m")))
    assert expected == {parameter: values[parameter] for parameter in expected}


@pytest.mark.parametrize("name", model_names())
def test_with_the_others_at_zero_a_column_is_its_parameter(name: str) -> None:
    """B is B_m + mu^2 beta_T: with B_lT at zero it is B_m, which represents it."""
    model = load_model(name)
    friction = {q.symbol for q in model.friction_parameters}
    for column in regressor(model):
        others = dict.fromkeys(friction - {column.parameter.symbol}, sp.Integer(0))

        assert column.parameter.symbol == model.expand(column.coefficient).subs(others)


def test_the_papers_terms_have_their_roles_and_loads() -> None:
    """Eqs (9) and (10): both bearings viscous and dry, the link's by F_N and F_T, the motor's by no load."""
    terms = load_model("rotating_link").balance("mechanical").terms
    expected = {
        str(coefficient): (role, load, 0)
        for role, letters in (
            (Role.VISCOUS, (v.B_lN, v.B_lT, v.B_m)),
            (Role.COULOMB, (v.C_lN, v.C_lT, v.C_m)),
        )
        for coefficient, load in zip(
            (q.symbol for q in letters), (Load.NORMAL, Load.TRANSVERSAL, Load.NONE), strict=True
        )
    }

    assert expected == {str(t.coefficient): (t.role, t.load, t.joint) for t in terms if t.kind == "friction"}


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({}, "term x: expected a role of friction, one of Role.VISCOUS"),
        ({"role": "viscous"}, "term x: role: expected one of Role.NONE, .*, got 'viscous'"),
        ({"role": Role.DRAG, "load": "F_N"}, "term x: load: expected one of Load.NONE, .*, got 'F_N'"),
        ({"role": Role.DRAG, "joint": -1}, "term x: joint: expected 0 or above, got -1"),
        ({"role": Role.DRAG, "kind": "actuator"}, "only friction has a role, got drag of kind actuator"),
    ],
    ids=["none", "a string", "load a string", "joint", "no friction"],
)
def test_a_role_that_makes_no_sense_is_refused(given: dict[str, object], said: str) -> None:
    """Friction has a role, nothing else has one, and both are words of the closed sets."""
    kind = str(given.pop("kind", "friction"))
    with pytest.raises((TypeError, ValueError), match=said):
        Term("x", kind, v.B_m.symbol, w, "own", **given)  # pyright: ignore[reportArgumentType]


def test_the_model_gives_its_own_inertia_and_the_current_of_its_armature() -> None:
    """J is J_m + mu^2 J_l, and Kirchhoff's law gives i = (u - k_e w)/R: numbers calculated manually."""
    model = load_model("c2_parallel")
    known = {"J_m": 2e-4, "J_l": 0.04, "mu": 0.2, "u": 9.0, "k_e": 0.05, "R": 1.5, "omega_m": 30.0}
    current = model.balance("electrical").solved_for(v.i.symbol)

    assert model.value(model.inertia, known) == pytest.approx(2e-4 + 0.04 * 0.04, rel=1e-15)
    assert model.value(current, known) == pytest.approx((9.0 - 0.05 * 30.0) / 1.5, rel=1e-15)
    with pytest.raises(ValueError, match="balance electrical: expected a sum that is linear in theta_m"):
        model.balance("electrical").solved_for(v.theta_m.symbol)
