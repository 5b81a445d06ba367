"""Estimates beside what is known from elsewhere: figures, intervals and sentences by closed forms."""

import math
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import sympy as sp

from eccentric.diagnosis import Diagnosis
from eccentric.diagnosis.models import RangeCheck, range_checks
from eccentric.effects import Effect, Plausible
from eccentric.presentation.ranges_text import (
    declare_sentence,
    excluded_sentence,
    outside_sentences,
    possible_causes,
    range_line,
    ruled_out_sentence,
    undeclared,
)
from tests.extended import effects

NORMAL = 1.959963984540054


def checked(
    effect: Effect,
    values: dict[str, float],
    errors: dict[str, float],
    parts: dict[str, tuple[str, ...]] | None = None,
    unit: str = "N m",
) -> tuple[RangeCheck, ...]:
    """The checks of a fit with these values, and symmetric 95 % intervals of independent errors."""
    estimates = {
        name: SimpleNamespace(interval=(values[name] - NORMAL * e, values[name] + NORMAL * e))
        for name, e in errors.items()
    }
    fit = SimpleNamespace(
        effects=((effect, values),),
        values=values,
        estimates=estimates,
        covariance=np.diag(np.square(list(errors.values()))),
    )
    return range_checks(cast("Any", fit), parts or {}, unit)


def test_a_figure_of_one_parameter_takes_over_the_ends_of_its_interval() -> None:
    """A loss of 0.25 per torque, 0.2 to 0.3, is an efficiency of 80 %, 100/1.3 to 100/1.2."""
    (found,) = checked(
        effects("C2")["load_dependent[gravity]"], {"load_eta": 0.25}, {"load_eta": 0.05 / NORMAL}
    )

    assert (80.0, "") == (pytest.approx(found.value), found.outside)
    assert pytest.approx((100 / 1.3, 100 / 1.2)) == found.interval


def test_a_figure_of_two_parameters_has_the_error_of_both() -> None:
    """The size of (3, 4) % is 5 %, of variance (9 a^2 + 16 b^2)/25."""
    values, errors = {"kt_ripple_c2": 0.03, "kt_ripple_s2": 0.04}, (0.001, 0.002)
    (found,) = checked(effects("C2")["kt_ripple[n=2]"], values, dict(zip(values, errors, strict=True)))
    spread = 100 * NORMAL * math.sqrt((9 * errors[0] ** 2 + 16 * errors[1] ** 2) / 25)

    assert pytest.approx(5.0) == found.value
    assert pytest.approx((5.0 - spread, 5.0 + spread)) == found.interval


@pytest.mark.parametrize(
    ("alpha", "error", "expected"),
    [(0.017, 0.0026, "above"), (0.017, 0.008, ""), (0.0039, 0.0001, ""), (0.001, 0.0001, "below")],
)
def test_all_of_the_interval_has_to_be_outside(alpha: float, error: float, expected: str) -> None:
    """Copper rises by 0.25 to 0.43 % per kelvin between 180 and 0 degC."""
    effect = effects("C2")["resistance_temperature"]
    (found,) = checked(effect, {"resistance_alpha": alpha}, {"resistance_alpha": error})

    assert expected == found.outside


@pytest.mark.parametrize(("degree", "slope"), [(0.0, 0.43), (20.0, 0.393), (180.0, 0.25)])
def test_the_range_of_copper_is_that_of_a_line(degree: float, slope: float) -> None:
    """What rises by 0.393 % of its value at 20 degC per kelvin rises by this much of its value elsewhere."""
    assert slope == pytest.approx(0.393 / (1.0 + 0.00393 * (degree - 20.0)), abs=0.01)


@pytest.mark.parametrize(
    ("parts", "expected"),
    [
        ({}, (14.0, "")),
        ({"gear": ("worm",)}, (25.0, "")),
        ({"gear": ("planetary",)}, (86.0, "below")),
        ({"gear": ("planetary", "worm")}, (25.0, "")),
    ],
)
def test_the_range_is_that_of_the_gear(
    parts: dict[str, tuple[str, ...]], expected: tuple[float, str]
) -> None:
    """Of two gears in a row the wider range; an efficiency of half is no planetary gear's."""
    effect = effects("C2")["load_dependent[gravity]"]
    (found,) = checked(effect, {"load_eta": 1.0}, {"load_eta": 0.1}, parts)

    assert expected == (found.known.low, found.outside)


@pytest.mark.parametrize(
    ("values", "errors", "unit"),
    [({"load_eta": 0.2}, {"load_eta": math.inf}, "N m"), ({"load_eta": 0.2}, {}, "N m"), ({}, {}, "N m")],
    ids=["not determined", "not estimated", "not there"],
)
def test_nothing_is_said_of_what_the_log_does_not_show(
    values: dict[str, float], errors: dict[str, float], unit: str
) -> None:
    """An estimate without an end to its interval, a value that was given, a letter that no model has."""
    assert () == checked(effects("C2")["load_dependent[gravity]"], values, errors, unit=unit)


def test_a_range_of_some_drives_says_nothing_of_others() -> None:
    """Stribeck velocities are known of small servos: 3 rad/s at the output is outside theirs."""
    effect, values = effects("C2")["stribeck[d=1]"], {"mu": 0.2, "stribeck_v": 15.0}
    (found,) = checked(effect, values, {"stribeck_v": 1.0}, {"gear": ("spur",)})

    assert ("above", 3.0) == (found.outside, pytest.approx(found.value))
    assert () == checked(effect, values, {"stribeck_v": 1.0})


M, M_L, L, G, MU = 0.5, 0.2, 0.25, 9.81, 0.2
RIG = {"M": M, "M_l": M_L, "L": L, "g": G, "mu": MU, "k_i": 0.02, "k_e": 0.05, "R": 1.0, "F_T": 3.0}
FRICTION = {"C_m": 0.01, "C_lN": 0.002, "C_lT": 0.004, "B_m": 1e-3, "B_lN": 2e-4, "B_lT": 3e-4}
DRY = {"C2": 0.01 + MU * 0.002 * (M + M_L) * G, "C1": 0.01 + MU * 0.004 * 3.0}
VISCOUS = {"C2": 1e-3 + MU**2 * 2e-4 * (M + M_L) * G, "C1": 1e-3 + MU**2 * 3e-4 * 3.0}
GEAR = {"gear": ("planetary",)}
WAVE = {"gear": ("strain wave",)}
STEPPER = {"motor": ("stepper",)}


@pytest.mark.parametrize(
    ("case", "effect", "values", "parts", "expected"),
    [
        *(
            (case, effect, {name: 0.5 * size[case]}, {}, 50.0)
            for case in ("C1", "C2")
            for effect, name, size in (
                ("coulomb_asymmetry", "coulomb_asym", DRY),
                ("viscous_asymmetry", "viscous_asym", VISCOUS),
                ("hidden_thermal_drift[coulomb]", "heat_C", DRY),
                ("hidden_thermal_drift[bearing]", "heat_B", VISCOUS),
            )
        ),
        *(
            ("C2", effect, {cosine: 0.9 * DRY["C2"], sine: 1.2 * DRY["C2"]}, {}, 150.0)
            for effect, cosine, sine in (
                ("link_harmonic_friction[n=2]", "link_harmonic_c2", "link_harmonic_s2"),
                ("motor_harmonic_friction[n=4]", "motor_harmonic_c4", "motor_harmonic_s4"),
                ("nonsynchronous_friction", "nonsync_c", "nonsync_s"),
            )
        ),
        ("C2", "cogging[n=2]", {"cogging_c2": 0.0, "cogging_s2": 0.02 * 15.0}, STEPPER, 100.0),
        ("C2", "presliding", {"presliding_x": 0.05 / MU}, {}, 50.0),
        ("C2", "backlash", {"backlash_gap": math.radians(2.0) / MU}, GEAR, 2.0),
        ("C2", "kinematic_error[link,n=1]", {"kinematic_c": math.pi / 3600, "kinematic_s": 0.0}, WAVE, 3.0),
        ("C2", "ki_mismatch", {"current_scale": 0.25}, {}, -20.0),
        ("C2", "ke_mismatch", {"armature_k": 0.004}, {}, 8.0),
        ("C2", "resistance_mismatch", {"armature_R": 0.9}, {}, 90.0),
    ],
)  # fmt: skip
def test_a_figure_is_that_of_its_closed_form(
    case: str, effect: str, values: dict[str, float], parts: dict[str, tuple[str, ...]], expected: float
) -> None:
    """Parts of the friction at rest, angles at the output, errors of declared values."""
    errors = dict.fromkeys(values, 1e-9)
    (found, *_) = checked(effects(case)[effect], RIG | FRICTION | values, errors, parts)

    assert expected == pytest.approx(found.value)
    known = found.known
    assert ("above" if expected > known.high else "below" if expected < known.low else "") == found.outside


def test_half_of_what_the_directions_differ_by_is_called_so() -> None:
    """(C + c) - (C - c) = 2 c: the parameter, and its part of the friction, are half of it."""
    for effect, name in (("coulomb_asymmetry", "coulomb_asym"), ("viscous_asymmetry", "viscous_asym")):
        (found,) = checked(effects("C2")[effect], RIG | FRICTION | {name: 0.001}, {name: 1e-4})
        assert found.known.name == "half the difference between the directions"


@pytest.mark.parametrize("effect", ["load_dependent[progressive]", "quadratic_drag", "oneway_windage[+]"])
def test_what_depends_on_more_than_the_parameters_has_no_range(effect: str) -> None:
    """An efficiency by eta + eta_2 |T| falls with the load; drag is that of a disc as well as of a link."""
    values = {"load_eta": 0.0, "load_eta_2": 3.0, "drag_2": 0.01, "windage_pos": 0.01}
    assert () == checked(effects("C2")[effect], RIG | FRICTION | values, dict.fromkeys(values, 1e-6))


def test_a_figure_in_a_line_has_no_comma_at_its_end() -> None:
    """A name that ends with a clause has one before "is"."""
    (found, *_) = checked(effects("C2")["presliding"], RIG | {"presliding_x": 1.0}, {"presliding_x": 1e-6})
    (sentence,) = outside_sentences(cast("Diagnosis", SimpleNamespace(ranges=(found,))))

    assert "from its axis: " in range_line(found)
    assert "from its axis, is " in sentence


@pytest.mark.parametrize(("error", "outside"), [(-0.16, ""), (-0.38, ""), (-0.45, "below"), (0.12, "above")])
def test_a_constant_of_warm_magnets_may_be_that_of_the_range(error: float, outside: str) -> None:
    """Ferrite 80 K above the data sheet is at -16 %, 160 K above and 10 % low at 0.9 * 0.68 - 1 = -38.8 %."""
    values = {"magnet_a": 0.001, "magnet_0": error}
    _, found = checked(effects("C2")["magnet_temperature"], values, dict.fromkeys(values, 1e-6))
    assert outside == found.outside


def test_a_part_of_no_friction_is_no_figure() -> None:
    """Where the log finds no dry friction, a harmonic is no part of it."""
    values = {"link_harmonic_c2": 0.1, "link_harmonic_s2": 0.1}
    none = dict.fromkeys(FRICTION, 0.0)

    assert () == checked(effects("C2")["link_harmonic_friction[n=2]"], RIG | none | values, {})
    assert () == checked(
        effects("C2")["link_harmonic_friction[n=2]"], RIG | none | values, dict.fromkeys(values, 0.01)
    )


def test_an_estimate_outside_is_a_sentence_with_its_meaning() -> None:
    """It is so many times the usual value where there is one; a line has the interval and the source."""
    known = Plausible(
        sp.Symbol("a"), "%/K", 0.25, 0.43, "IEC 60028, 1925", "the rise", 0.4, "copper's", "not it"
    )
    checks = (
        RangeCheck("a", known, 1.6, (1.0, 2.0)),
        RangeCheck("b", Plausible(sp.Symbol("b"), "1", 0.0, 0.2, "X, 1900", "the loss"), 0.5, (0.4, 0.6)),
        RangeCheck("c", known, 0.4, (0.3, 0.5)),
    )

    assert [
        "The rise is 4 times copper's: not it.",
        "The loss is 0.5, above the known range.",
    ] == outside_sentences(cast("Diagnosis", SimpleNamespace(ranges=checks)))
    expected = "the rise: 1.6 %/K (95 % interval 1 to 2 %/K), above the known range, 0.25 to 0.43 %/K"
    assert f"{expected} (IEC 60028, 1925)" == range_line(checks[0])


def named(parts: dict[str, tuple[str, ...]], covers: tuple[str, ...] = (), excluded: bool = False) -> Any:
    """A diagnosis of viscous friction that grows less than proportionally to speed."""
    brake = SimpleNamespace(id="eddy_current", family="eddy_current", instead_of="sublinear_viscous")
    brake.words = effects("C2")["eddy_current"].words
    return SimpleNamespace(
        offered=(effects("C2")["eddy_current"], THINNING),
        attribution=SimpleNamespace(
            candidates=() if excluded else (brake,),
            excluded=(brake,) if excluded else (),
            adopted_as=lambda _: SimpleNamespace(covers=covers),
        ),
        rig=SimpleNamespace(parts=parts),
    )


THINNING = effects("C2")["sublinear_viscous[n=0.5]"]
BRAKE, IRON = "an eddy-current brake (eddy_current)", "the excess part of the motor's iron losses"
OF_GREASE = ("grease or oil that thins by shear", "a lubricant that warms in its contacts as speed rises")


@pytest.mark.parametrize(
    ("found", "possible", "sentence", "keys"),
    [
        (named({}, ("eddy_current",)), (*OF_GREASE, "a seal", IRON, BRAKE), "", ("motor", "lubricant")),
        (named({"motor": ("brushless",)}), (*OF_GREASE, "a seal", IRON), "", ("lubricant",)),
        (
            named({"lubricant": ("none",), "motor": ("brushless",)}, (), excluded=True),
            ("a seal", IRON),
            (
                f'Excluded by the rig file: {" and ".join(OF_GREASE)}, which need lubricant = "grease" or'
                f' "oil" where the rig file has "none"; {BRAKE}, which needs motor = "eddy-current brake" or'
                ' "induction" where the rig file has "brushless".'
            ),
            (),
        ),
    ],
    ids=["undeclared", "motor", "both"],
)
def test_the_causes_behind_a_name_are_those_of_the_drive(
    found: Any, possible: tuple[str, ...], sentence: str, keys: tuple[str, ...]
) -> None:
    """What the drive cannot have is excluded with the reason; what is not declared would narrow the rest."""
    causes = possible_causes(found, THINNING)

    assert possible == tuple(cause.name for cause in causes)
    assert sentence == excluded_sentence(found, [THINNING])
    assert keys == undeclared(found.rig.parts, [cause.only_with for cause in causes])


def test_the_keys_that_would_narrow_a_tie_are_named() -> None:
    """Where every cause needs the same part, declaring it narrows nothing."""
    gear, motor = {"gear": ("worm",)}, {"motor": ("brushed",)}

    assert ("gear", "motor") == undeclared({}, [gear, motor])
    assert () == undeclared({}, [gear, gear])
    assert ("motor",) == undeclared({"gear": ("worm",)}, [gear, motor])
    expected = 'To narrow this down, declare gear = "..." and motor = "..." in the rig file.'
    assert expected == declare_sentence(("gear", "motor"))


def test_a_cause_that_is_ruled_out_is_told_with_the_part_that_it_needs() -> None:
    """Not as a name: the drive would have to be another one."""
    effect = effects("C2")["eddy_current"]
    found = SimpleNamespace(
        offered=(effect,),
        attribution=SimpleNamespace(ruled_out=(SimpleNamespace(id="eddy_current"),)),
        rig=SimpleNamespace(parts={"motor": ("brushless",)}),
    )

    assert (
        "An eddy-current brake (eddy_current) explains more of it, but it needs"
        ' motor = "eddy-current brake" or "induction" where the rig file has "brushless".'
    ) == ruled_out_sentence(cast("Diagnosis", found))
    found.attribution.ruled_out = ()
    assert ruled_out_sentence(cast("Diagnosis", found)) == ""
