"""The emitted compensation: never more than the friction, no jump anywhere, the same bits in C and NumPy.

Bounds and slopes are those of the formulas in the header; the friction that they are held against is the
model's own, and for the case C2 that of the paper, differentiated here.
"""

import dataclasses
import itertools
import json
import math
import re
import subprocess
import warnings
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import sympy as sp

import eccentric
from benchmarks import cortex_m4
from eccentric.cli import main
from eccentric.core import InputError
from eccentric.emission import executed, executed_beside, gain_of, inputs_of, render, render_compensation
from eccentric.emission.compensate.slopes import Walk, steepness
from eccentric.model import Definition, load_model, quantity, steps, vocabulary
from tests import extended
from tests.carriage import GIVEN
from tests.compensated import PUSHES, VELOCITIES, Compensation, drawn, emitted, module
from tests.compiled import FLAGS, run
from tests.emitted import quick
from tests.hosts import need
from tests.test_proof import SPECIFIED, alarms, proved

NAMES = ("c1_perpendicular", "c1_asymmetric", "c2_parallel", "c2_asymmetric", "rotating_link")
KINDS = list(itertools.product(VELOCITIES, PUSHES))
EVERY = [(NAMES[(k + n) % len(NAMES)], *kind) for k, kind in enumerate(KINDS) for n in (0, 2)]
"""Every kind of settings with two of the models."""
BAND = 1.6
"""A dead band above the default encoder's step per tick, 1.534 rad/s."""
CHOSEN: dict[str, Any] = {
    "gain": 0.85, "width": 0.4, "band": BAND, "fade": 2.0, "push_width": 0.05, "speed_max": 80.0
}  # fmt: skip


@cache
def python(name: str) -> ModuleType:
    """The emitted module of a model with its compensation."""
    model = load_model(name)
    files = render(model)
    return _beside(model, files)


def _beside(model: Any, files: Any) -> ModuleType:
    text = render_compensation(model, files, gain_of(model))[f"{model.name}_compensation.py"]
    return executed_beside(executed(files, model.name), model.name, text)


@cache
def effect_of(case: str, effect: str) -> ModuleType:
    """The same of a model with an effect."""
    one = extended.effects(case)[effect]
    model = one.extend(load_model(extended.BASE[case]), {q.name: 0.01 for q in one.coefficients})
    return _beside(model, render(model))


def parameters(c: ModuleType) -> Any:
    """The defaults of a model with inertias."""
    return c.model.Parameters(J_m=2e-4, J_l=0.04)


def settings(c: ModuleType, velocity: str = "reference", push: str = "none", **more: Any) -> Any:
    """Settings of the tests."""
    return c.Settings(velocity=velocity, push=push, **(CHOSEN | more))


def friction(c: ModuleType, rows: dict[str, np.ndarray], w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The friction torque at this speed backwards and forwards, of the model's own budget."""
    taken = inputs_of(c.model.friction_budget)
    ends = []
    for sign in (-1.0, 1.0):
        given = rows | {"omega_m": sign * np.abs(w)}
        budget = np.broadcast_to(
            c.model.friction_budget(*(given[x] for x in taken), parameters=parameters(c)), (len(w), 3)
        )
        ends.append(budget[:, int(sign > 0)] + sign * np.abs(w) * budget[:, 2])
    return ends[0], ends[1]


def velocity_of(s: Any, rows: dict[str, np.ndarray]) -> np.ndarray:
    """The velocity that there is friction for, as the header says."""
    measured = rows["omega_m"]
    beyond = np.sign(measured) * np.maximum(np.abs(measured) - s.band, 0.0)
    w = {"none": 0.0 * measured, "reference": rows["omega_ref"], "measured": beyond}[s.velocity]
    return np.clip(w, -s.speed_max, s.speed_max)


# Never more than the friction.


@pytest.mark.parametrize(("name", "velocity", "push"), EVERY)
def test_it_is_never_more_than_the_friction(name: str, velocity: str, push: str) -> None:
    """At any of 20,000 states, the friction of the model at that velocity, times the share, bounds it."""
    c = python(name)
    s = settings(c, velocity, push)
    rows = drawn(c.INPUTS, 20_000, 1)
    found = c.compensation(**rows, settings=s, parameters=parameters(c))
    w = velocity_of(s, rows)
    backwards, forwards = friction(c, rows, w)
    share = 1.0 if velocity == "reference" else s.gain

    assert np.all(found <= share * forwards * (1.0 + 1e-12))
    assert np.all(found >= share * backwards * (1.0 + 1e-12))
    moving = np.abs(w) >= s.width
    if moving.any():
        expected = np.where(w > 0.0, forwards, backwards)[moving]
        assert found[moving] == pytest.approx(share * expected, rel=1e-12)


def test_it_is_the_friction_where_the_reference_moves() -> None:
    """Beyond the width, it is what the model's mechanical_friction_torque gives."""
    c = python("c2_parallel")
    theta, w = np.linspace(-9.0, 9.0, 400), np.linspace(0.5, 60.0, 400)
    for sign in (-1.0, 1.0):
        found = c.compensation(theta, sign * w, 0.0, 0.0, 0.0)
        assert found == pytest.approx(c.model.mechanical_friction_torque(theta, sign * w), rel=1e-13)


def test_at_rest_it_is_the_share_of_the_breakaway_level() -> None:
    """With the whole error at rest the push is gain times the level, towards the reference; with none, 0."""
    c = python("c2_asymmetric")
    p = c.model.Parameters(C_m_neg=0.02)
    s = settings(c, push="error")
    lower, upper = c.model.breakaway_torque(p)

    def pushed(error: float, measured: float = 0.0) -> float:
        return float(c.compensation(0.3, 0.0, measured, error, 0.0, s, p))

    assert pushed(1.0) == pytest.approx(0.85 * upper, rel=1e-14)
    assert pushed(-1.0) == pytest.approx(0.85 * lower, rel=1e-14)
    assert abs(lower) > 1.1 * upper
    assert pushed(0.0) == 0.0
    assert pushed(0.9 * s.encoder_step) == 0.0
    assert pushed(1.0, BAND) == pushed(1.0)
    assert pushed(1.0, BAND + 1.0) == pytest.approx(0.5 * pushed(1.0), rel=1e-14)
    assert pushed(1.0, -BAND - 2.0) == 0.0


def test_a_measured_velocity_within_its_band_gives_nothing() -> None:
    """One step of the encoder in a tick, in either direction, is no motion."""
    c = python("c2_parallel")
    s = c.Settings(velocity="measured")
    step = s.encoder_step / s.tick

    found = c.compensation(0.3, 5.0, np.array([-step, -1e-310, 0.0, 5e-324, step]), 1.0, 1.0, s)

    assert not found.any()


# Without a jump.


def steepest(c: ModuleType, s: Any, seed: int, count: int = 20_000) -> dict[str, float]:
    """The largest slope between two random inputs that differ in one of them, over its constant."""
    constants = c.lipschitz(s, parameters(c))
    rows = drawn(c.INPUTS, count, seed)
    generator = np.random.default_rng(seed + 1)
    ratios = {}
    for name in c.INPUTS:
        step = 10.0 ** generator.uniform(-6.0, 2.0, count) * generator.choice([-1.0, 1.0], count)
        other = rows | {name: rows[name] + step}
        if name not in ("theta_m", "omega_ref", "omega_m", "error", "torque"):
            other[name] = np.clip(other[name], -1e4, 1e4)
        moved = np.abs(other[name] - rows[name])
        ends = [c.compensation(**x, settings=s, parameters=parameters(c)) for x in (rows, other)]
        changed = np.abs(ends[1] - ends[0])
        # What rounding alone changes is no slope.
        rounding = 1e-13 * (1.0 + np.abs(ends[0]))
        if constants[name] == 0.0:
            assert np.all(changed == 0.0), name
            continue
        ratios[name] = float(np.max((changed - rounding) / (constants[name] * moved + 1e-300)))
    return ratios


@pytest.mark.parametrize(("name", "velocity", "push"), EVERY)
def test_no_pair_of_inputs_is_steeper_than_the_constants(name: str, velocity: str, push: str) -> None:
    """Of 20,000 random pairs for each input, near and far, none changes by more than its constant says."""
    c = python(name)

    found = steepest(c, settings(c, velocity, push), 3)

    assert all(ratio <= 1.0 for ratio in found.values()), found


def families() -> list[Any]:
    """One effect of each family, the cases by turns; a few for `make test`."""
    found: dict[str, dict[str, str]] = {}
    for case in extended.CASES:
        for key, one in extended.effects(case).items():
            found.setdefault(one.family, {}).setdefault(case, key)
    chosen = [list(own.items())[k % len(own)] for k, own in enumerate(found.values())]
    return quick(chosen, chosen[::7])


@pytest.mark.parametrize(("effect", "left"), [("cogging[n=3]", 0.05), ("stribeck[d=1]", 0.0)])
def test_what_is_no_friction_is_told(effect: str, left: float, tmp_path: Path) -> None:
    """Cogging is no part of the compensation: a warning and the header say how large it is."""
    one = extended.effects("C1")[effect]
    sizes = dict(zip((q.name for q in one.coefficients), (0.03, 0.04), strict=False))
    model = one.extend(load_model(extended.BASE["C1"]), sizes)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        eccentric.emit(model, tmp_path / "out", compensation=True)
    told = (
        f"of up to {left} N m (motor side) that is not friction (gravity, cogging, a spring, a load): add"
        f" {model.name}_gravity"
    )
    assert [told in str(one.message) for one in caught] == [True] * bool(left)
    header = (tmp_path / "out" / f"{model.name}_compensation.h").read_text(encoding="utf-8")
    assert (f"gravity_torque, up to {left} N m" in header) == bool(left)


@pytest.mark.parametrize(("case", "effect"), families())
def test_of_every_effect_as_well(case: str, effect: str) -> None:
    """A model with any effect of the library has bounds and constants that hold, too."""
    c = effect_of(case, effect)
    s = settings(c, "reference", "error")
    rows = drawn(c.INPUTS, 4000, 5)
    for name, (low, high) in {"temperature": (-60.0, 300.0), "t": (0.0, 1e6)}.items():
        if name in rows:
            rows[name] = np.random.default_rng(6).uniform(low, high, 4000)
    found = c.compensation(**rows, settings=s, parameters=parameters(c))
    backwards, forwards = friction(c, rows, velocity_of(s, rows))
    constants = c.lipschitz(s, parameters(c))

    assert np.all((found <= forwards * (1 + 1e-12)) & (found >= backwards * (1 + 1e-12)))
    for name in ("theta_m", "omega_ref", "omega_m", "error"):
        for size in (1e-5, 1e-2, 3.0):
            other = c.compensation(**(rows | {name: rows[name] + size}), settings=s, parameters=parameters(c))
            assert np.max(np.abs(other - found)) <= constants[name] * size * (1 + 1e-9) + 1e-11, (name, size)


def test_constants_of_one_value_keep_their_names() -> None:
    """An effect that takes several numbers from an earlier fit works where they are the same, such as 0."""
    one = extended.effects("C2")["gear_efficiency[transmitted]"]
    model = one.extend(load_model("c2_parallel"), {q.name: 0.01 for q in one.coefficients})
    same = (
        dataclasses.replace(d, value=sp.Integer(0)) if d.value.is_Number else d for d in model.definitions
    )
    model = dataclasses.replace(model, definitions=tuple(same))
    c = _beside(model, render(model))

    assert np.all(np.isfinite(list(c.lipschitz(parameters=parameters(c)).values())))


def test_the_constants_are_above_the_derivatives_of_the_paper() -> None:
    """Case C2: SymPy's derivatives of the paper's friction, written here, at 20,000 states; not far above."""
    theta, w = sp.symbols("theta w", real=True)
    p = extended
    pull, weight = sp.Rational(1, 2) * 0.25 * (p.MU * w) ** 2, (p.M + p.M_L) * p.G
    force = sp.sqrt((pull + weight * sp.cos(p.MU * theta)) ** 2 + (weight * sp.sin(p.MU * theta)) ** 2)
    c = python("c2_parallel")
    q = c.model.Parameters()
    assert (q.M, q.L) == (0.5, 0.25)
    torque = q.mu * q.C_lN * force + q.C_m + (q.mu**2 * q.B_lN * force + q.B_m) * w
    generator = np.random.default_rng(2)
    at = (generator.uniform(0.0, 2 * math.pi / q.mu, 20_000), generator.uniform(1e-6, 80.0, 20_000))
    found = c.lipschitz(settings(c))
    level = float(c.model.breakaway_torque()[1])

    for symbol, constant in ((theta, found["theta_m"]), (w, found["omega_ref"] - level / CHOSEN["width"])):
        slope = np.max(np.abs(sp.lambdify((theta, w), sp.diff(torque, symbol))(*at)))
        assert slope <= constant
        assert constant <= 3.0 * slope


def test_the_level_is_that_at_the_width() -> None:
    """Case C1, in closed form: C_lN mu F_N + C with F_N = M L mu^2 w^2, and the slopes of its cubic."""
    c = python("c1_perpendicular")
    p, s = c.model.Parameters(), settings(c, push="error")
    found = c.lipschitz(s)
    F_3, F_2, F_1, F_0 = c.model.polynomial()
    F_1 = F_1 - p.k_i * p.k_e / p.R
    W, width = s.speed_max, s.width
    level = F_2 * width**2 + F_0

    slope = 3 * F_3 * W**2 + 2 * F_2 * W + F_1
    assert found["omega_ref"] == pytest.approx(slope + (1.0 + s.gain) * level / width, rel=2e-6)
    assert found["error"] == pytest.approx(s.gain * level / s.push_width, rel=2e-6)
    assert found["omega_m"] == pytest.approx(s.gain * level / s.fade, rel=2e-6)
    assert found["theta_m"] == found["torque"] == 0.0


X, Y, K = sp.symbols("x y k", real=True)
STEPS = [  # an expression, its largest slopes for |x| <= 2 and |y| <= 3 with k = 1.5, in closed form
    (steps.Clipped(X, -(1 + sp.Abs(Y)), 1 + K * sp.Abs(Y)), {"x": 1.0, "y": 1.5}),
    (steps.Bounded(sp.Abs(X), 1 + K * sp.Abs(Y)), {"x": 1.0, "y": 1.5}),
    (K * sp.Abs(X), {"x": 1.5}),
    (sp.Piecewise((X, sp.Eq(K, 0)), (K * X, True)), {"x": 1.5}),
]


@pytest.mark.parametrize(("expression", "expected"), STEPS, ids=lambda given: str(given)[:12])
def test_no_slope_is_left_out(expression: sp.Expr, expected: dict[str, float]) -> None:
    """A limit that moves makes what it limits move; a factor made of parameters stays a factor."""
    walk = Walk({X: sp.Integer(2), Y: sp.Integer(3)}, frozenset())
    found = walk(expression).slopes

    assert {x.name: float(k.subs(K, 1.5)) for x, k in found.items()} == expected


def test_a_slope_of_a_number_made_of_parameters_is_kept() -> None:
    """F_N made proportional to the angle, by a definition of parameters alone."""
    model = load_model("c2_parallel")
    given = {d.symbol.name: d for d in model.definitions}
    stiff = quantity("stiff", "N/rad", "normal force per angle")
    letters = {q.name: q.symbol for q in model.parameters}
    force = dataclasses.replace(given["F_N"], value=stiff.symbol * sp.Abs(vocabulary.theta_m.symbol))
    own = (given["J"], Definition(stiff, letters["M"] * letters["g"] * letters["L"]), force)
    found = steepness(dataclasses.replace(model, definitions=own))
    numbers = {q.symbol.name: q.default for q in model.parameters if q.default is not None}
    known = {**numbers, "speed_at_most": sp.Integer(40)}
    for name, value in found.assignments:
        known[name] = value.subs({x: known[x.name] for x in value.free_symbols})
    slope = found.by["theta_m"].subs({x: known[x.name] for x in found.by["theta_m"].free_symbols})
    p = extended

    expected = (p.MU * 0.08 + p.MU**2 * 0.004 * 40.0) * p.M * p.G * p.L
    assert float(slope) == pytest.approx(expected, rel=1e-12)


def test_a_choice_by_an_input_is_refused() -> None:
    """It may jump, and no slope bounds a jump."""
    walk = Walk({X: sp.Integer(2)}, frozenset())
    with pytest.raises(InputError, match="a choice by parameters alone"):
        walk(sp.Piecewise((X, X > 0), (2 * X, True)))


TINY = [0.0, 5e-324, 1e-310, 2.3e-308, 1e-30]


@pytest.mark.parametrize(("velocity", "push"), KINDS, ids=map("-".join, KINDS))
def test_no_jump_at_zero(velocity: str, push: str) -> None:
    """From the smallest denormal number on, of either sign, there is nothing: no sign is ever taken."""
    c = python("c2_asymmetric")
    s = settings(c, velocity, push)
    both = np.array([sign * x for x in TINY for sign in (1.0, -1.0)])

    for name in c.INPUTS[1:]:
        rows = dict.fromkeys(c.INPUTS, 0.0 * both) | {name: both}
        assert np.all(np.abs(c.compensation(**rows, settings=s)) <= 1e-25), name


def test_beyond_the_largest_speed_it_is_constant() -> None:
    """From speed_max on, up to infinity."""
    c = python("c2_parallel")
    s = settings(c)

    found = c.compensation(0.3, np.array([80.0, 81.0, 1e6, 1e308, math.inf]), 0.0, 0.0, 0.0, s)

    assert len(set(found.tolist())) == 1


# NaN, types, and what is not used.


@pytest.mark.parametrize(("velocity", "push"), KINDS, ids=map("-".join, KINDS))
def test_what_is_no_number_gives_none(velocity: str, push: str) -> None:
    """NaN in an input that is used gives NaN; one that is not used changes nothing."""
    c = python("c2_parallel")
    s = settings(c, velocity, push)
    used = {"theta_m", {"reference": "omega_ref", "measured": "omega_m"}.get(velocity, "theta_m")}
    if push != "none":
        used |= {"omega_m", {"error": "error", "demand": "torque"}[push]}
    rows: dict[str, float] = dict(zip(c.INPUTS, (0.3, 0.1, 0.2, 0.02, 0.03), strict=True))
    for name in c.INPUTS:
        found = c.compensation(**(rows | {name: math.nan}), settings=s)
        assert np.isnan(found) == (name in used), name


def test_shapes_and_types() -> None:
    """Numbers give a number, arrays broadcast, float32 stays float32."""
    c = python("c2_parallel")

    assert isinstance(c.compensation(0.1, 2.0, 0.0, 0.0, 0.0), float)
    assert c.compensation(np.zeros((3, 1)), np.ones(4), 0.0, 0.0, 0.0).shape == (3, 4)
    assert c.compensation(np.float32(0.1), np.ones(2, np.float32), 0.0, 0.0, 0.0).dtype == np.float32


# The settings.

WRONG: dict[str, list[Any]] = {
    "velocity": ["filtered", 1],
    "push": ["velocity"],
    "gain": [-0.1, 1.1, math.nan, math.inf, "1", True],
    "feedforward": [1.1, -1.0],
    "speed_max": [0.0, 2e3, math.nan],
    "width": [0.0, 1e-9],
    "encoder_step": [-1.0, math.inf],
    "tick": [0.0, -1e-3],
    "band": [1.5, -2.0, math.nan],
    "fade": [0.0],
    "push_width": [0.0, -0.1],
}


@pytest.mark.parametrize("name", WRONG)
def test_invalid_settings_are_refused(name: str) -> None:
    """With one error that names the setting, what is required and what came."""
    c = python("c2_parallel")
    for value in WRONG[name]:
        with pytest.raises(ValueError, match=rf"^{name}: expected .*, got {value!r}$"):
            c.Settings(**{name: value})


def test_without_a_reference_a_tenth_of_the_friction_stays() -> None:
    """A gain above 0.9 is refused where the compensation follows a measurement."""
    c = python("c2_parallel")

    assert c.Settings(velocity="reference", gain=1.0).gain == 1.0
    for velocity in ("measured", "none"):
        with pytest.raises(ValueError, match=r"gain: expected a number from 0 to 0\.9 without a reference"):
            c.Settings(velocity=velocity, gain=0.95)


# The gain.


def test_the_gain_is_the_bound_of_the_torque() -> None:
    """One coefficient with a standard error of 5 %: the ratio's 2.5 % quantile is 1 - 1.96 * 0.05."""
    model = load_model("c1_perpendicular")
    module_ = python("c1_perpendicular").model
    values = dict(zip(module_.REGRESSOR, module_.friction_coefficients().tolist(), strict=True))
    # All coefficients share one factor: fully correlated errors of 5 % each.
    errors = {name: {"value": x, "std_error": 0.05 * x} for name, x in values.items()}
    n = len(values)
    together = {"names": list(values), "matrix": [[1.0] * n] * n}

    assert gain_of(model, {"coefficients": errors, "correlation": together}).value == pytest.approx(
        1 - 1.95996 * 0.05, abs=3e-3
    )
    assert gain_of(model, {}).value == 0.9


def test_errors_against_each_other_cost_nothing() -> None:
    """Two parts of Coulomb friction that only their sum determines leave the gain as their sum has it."""
    model = load_model("c1_perpendicular")
    c = python("c1_perpendicular").model
    names = list(c.REGRESSOR)
    values = dict(zip(names, c.friction_coefficients().tolist(), strict=True))
    errors = {name: {"value": x, "std_error": 0.5 * x} for name, x in values.items()}
    apart = gain_of(model, {"coefficients": errors}).value

    assert apart < 0.5


def test_a_fit_gives_the_gain(tmp_path: Path) -> None:
    """The header has it, with its meaning."""
    model = load_model("c2_parallel")
    c = python("c2_parallel").model
    values = dict(zip(c.REGRESSOR, c.friction_coefficients().tolist(), strict=True))
    fit = {
        "parameters": values,
        "coefficients": {k: {"value": x, "std_error": 0.02 * x} for k, x in values.items()},
        "ranges": {"speed_m_rad_s": [0.5, 40.0]},
    }
    (tmp_path / "fit.json").write_text(json.dumps(fit), encoding="utf-8")
    out = tmp_path / "out"
    command = ["emit", "c2_parallel", "--compensation", "--parameters", str(tmp_path / "fit.json")]
    assert 0 == main([*command, "--out", str(out)])
    expected = gain_of(model, fit).value

    assert 0.9 < expected < 1.0
    assert f"gain: {expected}: with 97.5 %" in (out / "c2_parallel_compensation.h").read_text()
    assert module(out, "c2_parallel").Settings().gain == expected


def test_without_a_fit_the_command_says_how_to_get_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also for the model of a diagnosis, which has no fit.json."""
    assert 0 == main(["emit", "c1_perpendicular", "--compensation", "--out", str(tmp_path / "out")])
    assert capsys.readouterr().out.endswith(
        "to compute it from the errors of a fit: eccentric fit LOG --rig RIG --model c1_perpendicular"
        " --out FIT, then --parameters FIT/fit.json\n"
    )


# In C.


@pytest.mark.parametrize(
    ("name", "dtype", "compiler"),
    quick(
        itertools.product((*NAMES, "linear_axis"), (np.float32, np.float64), ("gcc", "clang")),
        {("c2_asymmetric", np.float32, "gcc"), ("rotating_link", np.float64, "gcc")},
    ),
)
def test_same_bits(tmp_path: Path, name: str, dtype: Any, compiler: str) -> None:
    """Every kind of settings over random inputs, NaN and infinities; it compiles without a warning."""
    need(compiler)
    folder = emitted(tmp_path, name, GIVEN if name == "linear_axis" else None)
    c, compiled = module(folder, name), Compensation(folder, name, dtype, compiler)
    rows = drawn(c.INPUTS, 1500, 4, dtype)
    generator = np.random.default_rng(7)
    for x in rows.values():
        x[generator.integers(0, 1500, 30)] = generator.choice([np.nan, np.inf, -np.inf, -0.0, 1e-40], 30)
    for velocity, push in KINDS:
        chosen = CHOSEN | {"velocity": velocity, "push": push}
        invalid, s = compiled.settings(**chosen)
        assert invalid == 0
        found = compiled(rows, s)
        expected = c.compensation(**rows, settings=c.Settings(**chosen))
        assert expected.dtype == dtype
        assert expected.tobytes() == found.tobytes() or _alike(expected, found)
        constants = c.lipschitz(c.Settings(**chosen)).values()
        digits = 1e-6 if dtype == np.float32 else 1e-14
        assert list(s.lipschitz) == pytest.approx(list(constants), rel=digits)


def _alike(expected: np.ndarray, found: np.ndarray) -> bool:
    """The same bits, but for those of a NaN."""
    nan = np.isnan(expected)
    return bool(np.array_equal(nan, np.isnan(found)) and expected[~nan].tobytes() == found[~nan].tobytes())


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Compensation:
    """The C of case C2."""
    need("gcc")
    return Compensation(emitted(tmp_path_factory.mktemp("c")), "c2_parallel", np.float64)


def test_c_refuses_what_python_refuses(compiled: Compensation) -> None:
    """`prepare` returns the number of the setting in the order of the structure."""
    c = python("c2_parallel")
    order = [field.name for field in dataclasses.fields(c.Settings)]
    for name, values in WRONG.items():
        for value in values:
            if isinstance(value, float):
                assert compiled.settings(**{name: value})[0] == 1 + order.index(name), (name, value)
    assert compiled.settings(velocity=7)[0] == 1
    assert compiled.settings(velocity="measured", gain=0.95)[0] == 3
    assert compiled.settings()[0] == 0


@pytest.mark.parametrize("real", ["double", "float"])
def test_the_page_compiles(real: str, tmp_path: Path) -> None:
    """The C of docs/in-the-loop.md, as it stands there, without a warning; its settings push."""
    need("gcc")
    folder = emitted(tmp_path)
    page = (Path(__file__).resolve().parents[1] / "docs" / "in-the-loop.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"^```c\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)
    called = """int main(void) {
    const ECCENTRIC_REAL q = (ECCENTRIC_REAL)0.125, none = 0;
    const int invalid = set_up();
    const ECCENTRIC_REAL there = control(q, none, q, none, none), away = control(q, none, none, none, none);
    return invalid + !(there <= none) + !(away > none);
}
"""
    kind = "ECCENTRIC_REAL control"
    code = re.sub(rf"({kind}\(.*?\)) {{", r"\1;\n\1 {", code, count=1, flags=re.DOTALL)
    (tmp_path / "main.c").write_text(code.replace("int set_up", "int set_up(void);\nint set_up") + called)
    sources = [tmp_path / "main.c", folder / "c2_parallel.c", folder / "c2_parallel_compensation.c"]
    flags = (*FLAGS, f"-DECCENTRIC_REAL={real}")
    run("gcc", *flags, f"-I{folder}", "-o", tmp_path / "main", *sources, "-lm")

    assert subprocess.run([tmp_path / "main"], check=False).returncode == 0


def test_the_default_is_prepared(compiled: Compensation) -> None:
    """Its constants are those that `prepare` computes, and those that the head comment states."""
    _, prepared = compiled.settings()
    default = compiled["compensation_default"]

    assert list(default.lipschitz) == pytest.approx(list(prepared.lipschitz), rel=1e-14)
    assert default.velocity == 1


def test_it_takes_constant_time(tmp_path: Path) -> None:
    """On a Cortex-M4F as many instructions for every input: at rest, within the widths and beyond them."""
    if absent := cortex_m4.missing():
        pytest.skip(f"not installed: {', '.join(absent)}")
    folder = emitted(tmp_path)
    values = {"gain": 0.9, "feedforward": 1, "encoder_step": 0.0015, "tick": 0.001, **CHOSEN}
    common = ", ".join(f".{name} = {float(x)}f" for name, x in values.items())
    kinds = [f"{{.velocity = {v}u, .push = {p}u, {common}}}" for v in range(3) for p in range(3)]
    lines = ['#include "c2_parallel_compensation.h"']
    subjects = []
    for k, kind in enumerate(kinds):
        inputs = "x, 0.02f * y, 0.05f * y, 0.003f * x, 0.003f * y"
        call = f"c2_parallel_compensation({inputs}, &s{k}, &c2_parallel_default)"
        lines += [
            f"static const c2_parallel_compensation_settings s{k} = {kind};",
            f"static float kind_{k}(float x, float y) {{ return {call}; }}",
        ]
        subjects.append(cortex_m4.Subject(f"kind_{k}", "(float, float)", "(x, y)"))
    sources = [folder / "c2_parallel.c", folder / "c2_parallel_compensation.c"]
    options = ["-std=c99", "-O2", "-DECCENTRIC_REAL=float", f"-I{folder}"]
    counts = cortex_m4.instructions(tmp_path, "\n".join(lines) + "\n", subjects, sources, options)

    for subject in subjects:
        assert len(set(counts[subject.name])) == 1, subject.name


@pytest.mark.parametrize(
    ("name", "real"),
    quick(zip((*NAMES, "linear_axis"), 3 * ("double", "float"), strict=True), {("c2_asymmetric", "float")}),
)
def test_proved(tmp_path: Path, name: str, real: str) -> None:
    """Eva has no alarm for any valid settings and finite inputs."""
    folder = emitted(tmp_path, name, GIVEN if name == "linear_axis" else None)

    said = proved(folder / "check" / f"{name}_compensation_proof.c", real)

    assert [] == alarms(said)
    assert "0 alarms generated by the analysis." in said
    assert "100% of the logical properties reached have been proven." in said
    assert set(said.split("using specification for function ")[1:]) <= SPECIFIED or "Frama_C" in said
    assert "either code nor specification" not in said


def test_it_takes_the_gain_of_an_estimator(tmp_path: Path) -> None:
    """The C of docs/adapt.md: emitted together, the gain of what was learned is a valid setting."""
    need("gcc")
    folder = tmp_path / "out"
    given = {"J_m": 2e-4, "J_l": 0.04}
    eccentric.emit("c2_parallel", folder, parameters=given, adapt=True, compensation=True)
    page = (Path(__file__).resolve().parents[1] / "docs" / "adapt.md").read_text(encoding="utf-8")
    code = "".join(re.findall(r"^```c\n(.*?)^```$", page, re.DOTALL | re.MULTILINE))
    code = re.sub(r"^(int|void) (\w+)\((.*?)\) \{", r"\1 \2(\3);\n\1 \2(\3) {", code, flags=re.MULTILINE)
    called = """int main(void) {
    set_up();
    loop = c2_parallel_compensation_default;
    for (int k = 0; k < 100; ++k) {
        each_sample(0, 10, 0, (ECCENTRIC_REAL)1.5);
    }
    return each_second() + !(loop.gain > 0) + !(loop.gain <= (ECCENTRIC_REAL)0.9);
}
"""
    (tmp_path / "main.c").write_text(code + called)
    sources = [folder / f"c2_parallel{x}.c" for x in ("", "_adapt", "_compensation")]
    run("gcc", *FLAGS, f"-I{folder}", "-o", tmp_path / "main", tmp_path / "main.c", *sources, "-lm")

    assert subprocess.run([tmp_path / "main"], check=False).returncode == 0


def test_what_cannot_be_emitted_is_refused(tmp_path: Path) -> None:
    """An arm, a choice of functions, and a target without the C say so in one line."""
    with pytest.raises(InputError, match="compensation: expected a model of one joint, got an arm"):
        eccentric.emit("examples/arms/planar_2r.toml", tmp_path / "a", compensation=True)
    with pytest.raises(InputError, match="compensation: cannot be combined with fixed, functions or arrays"):
        eccentric.emit("c2_parallel", tmp_path / "b", compensation=True, functions=["gravity_torque"])
    with pytest.raises(InputError, match="compensation: expected backend c99 as well"):
        eccentric.emit("c2_parallel", tmp_path / "c", compensation=True, backend="numpy")
    assert not list(tmp_path.iterdir())


def test_the_models_own_files_stay(tmp_path: Path) -> None:
    """With the compensation, the model's own files are those without, letter by letter."""
    eccentric.emit("c2_parallel", tmp_path / "plain")
    eccentric.emit("c2_parallel", tmp_path / "with", compensation=True)

    for path in (tmp_path / "plain").rglob("*"):
        if path.is_file() and not path.name.startswith("."):
            other = tmp_path / "with" / path.relative_to(tmp_path / "plain")
            assert path.read_bytes() == other.read_bytes()
