"""A term without a cause: its curves, what is emitted of it, and how it is found on a log."""

import shutil
from dataclasses import replace
from pathlib import Path

import jax
import numpy as np
import pytest
from scipy.interpolate import BSpline

import eccentric
from eccentric.diagnosis import fit_empirical, staged_log
from eccentric.effects import Curve, empirical_term
from eccentric.emission import load_module
from eccentric.identification import refit, rms
from eccentric.model import load_model
from tests import adapted, jaxed
from tests.extended import setting

RNG = np.random.default_rng(5)
THETA, OMEGA = RNG.uniform(-60.0, 60.0, 400), RNG.uniform(-90.0, 90.0, 400)
MU = 0.2
FRICTION = (Curve("velocity", 2, 2.0, 70.0, bend=12.0), Curve("link_angle", 3))
BOTH_WAYS = (Curve("gravity_load", 2, -0.1, 0.2, each_way=True), Curve("motor_angle", 3, conservative=True))


def _signal(curve: Curve) -> np.ndarray:
    module = load_module(load_model("c2_parallel"))
    return {
        "velocity": np.abs(OMEGA),
        "link_angle": MU * THETA,
        "motor_angle": THETA,
        "gravity_load": module.gravity_torque(THETA),
    }[curve.variable]


@pytest.mark.parametrize("bend", [0.0, 7.0])
def test_a_curve_is_a_quadratic_b_spline(bend: float) -> None:
    """Inside its knots, bent or not, as SciPy has it on the same knots; beyond them constant."""
    curve = Curve("velocity", 6, 1.0, 40.0, bend)
    x = np.linspace(0.0, 60.0, 500)
    found = curve.columns(x, np.ones_like(x))

    bent = np.clip(x, 1.0, 40.0)
    ends = np.array([1.0, 40.0])
    if bend:
        bent, ends = bent / (bent + bend), ends / (ends + bend)
    knots = ends[0] + np.ptp(ends) / 6 * np.arange(-2, 9)
    inside = np.clip(bent, knots[2], np.nextafter(knots[8], 0.0))
    expected = BSpline.design_matrix(inside, knots, 2).toarray()

    assert np.allclose(found, expected, atol=1e-12)
    assert np.isclose(curve.knots[0], 1.0)
    assert np.isclose(curve.knots[-1], 40.0)


def test_a_curve_over_an_angle_closes() -> None:
    """It is the same a turn on, its B-splines sum to 1, and are one another's images."""
    curve, x = Curve("link_angle", 5), np.linspace(-9.0, 9.0, 300)
    found = curve.columns(x, np.ones_like(x))

    assert np.allclose(found, curve.columns(x + 2.0 * np.pi, np.ones_like(x)))
    assert np.allclose(1.0, found.sum(axis=1))
    assert np.allclose(found[:, 1:], curve.columns(x - 2.0 * np.pi / 5, np.ones_like(x))[:, :-1])


def test_what_is_the_same_in_both_directions_has_no_mean() -> None:
    """Over a turn, whatever its coefficients, and it does not ask for the direction."""
    curve = Curve("motor_angle", 7, conservative=True)
    turn = np.arange(7000) * 2.0 * np.pi / 7000
    forward = curve.columns(turn, np.ones(7000))

    assert np.allclose(0.0, forward.mean(axis=0), atol=1e-7)
    assert np.array_equal(forward, curve.columns(turn, -np.ones(7000)))


@pytest.mark.slow
@pytest.mark.parametrize("curves", [FRICTION, BOTH_WAYS], ids=["friction", "both ways"])
def test_what_is_emitted_is_the_curves(curves: tuple[Curve, ...]) -> None:
    """Friction and gravity torque change by columns times coefficients, and the regressor has the columns."""
    base = replace(setting("C2", warm=False), mu=MU)
    effect = empirical_term(base, curves)
    values = dict(zip((q.name for q in effect.coefficients), RNG.uniform(0.0, 0.02, 99), strict=False))
    model = effect.extend(load_model("c2_parallel"), values)
    plain, emitted = load_module(load_model("c2_parallel")), load_module(model)
    columns = np.hstack([c.columns(_signal(c), OMEGA) for c in curves])
    friction = np.concatenate([np.full(len(c.numbers), not c.conservative) for c in curves])
    own = np.array([*values.values()])

    added = emitted.mechanical_friction_torque(THETA, OMEGA) - plain.mechanical_friction_torque(THETA, OMEGA)
    torque = emitted.gravity_torque(THETA) - plain.gravity_torque(THETA)
    lower, upper, _ = emitted.friction_budget(THETA, OMEGA).T
    width = len(plain.REGRESSOR)

    assert np.allclose(columns[:, friction] @ own[friction], added, atol=1e-13)
    assert np.allclose(columns[:, ~friction] @ own[~friction], torque, atol=1e-13)
    assert np.allclose(emitted.regressor(THETA, OMEGA)[:, width:], columns[:, friction], atol=1e-13)
    assert np.all(added * OMEGA >= 0.0)
    assert np.all((lower <= 0.0) & (upper >= 0.0))
    step = 1e-6
    slope = emitted.friction_torque_gradient(THETA, OMEGA)[:, 0]
    over = emitted.friction_torque(THETA + step, OMEGA) - emitted.friction_torque(THETA - step, OMEGA)
    assert np.allclose(slope, over / (2.0 * step), atol=1e-8)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")
@pytest.mark.parametrize("curves", [FRICTION, BOTH_WAYS], ids=["friction", "both ways"])
def test_c_and_jax_have_the_term_too(curves: tuple[Curve, ...], tmp_path: Path) -> None:
    """Their functions are those of NumPy, and the estimator in C has the bits of that in Python."""
    effect = empirical_term(replace(setting("C2", warm=False), mu=MU), curves)
    values = dict(zip((q.name for q in effect.coefficients), RNG.uniform(0.0, 0.02, 99), strict=False))
    model = effect.extend(load_model("c2_parallel"), values)
    emitted, other, at = load_module(model), eccentric.compile(model), (THETA, OMEGA)

    for name in ("friction_torque", "friction_torque_gradient", "friction_budget", "regressor"):
        expected = getattr(emitted, name)(*at)
        np.testing.assert_array_equal(getattr(other, name)(*at), expected, err_msg=name)
        with jax.enable_x64(True):
            traced = np.asarray(getattr(jaxed.executed(model), name)(*at))
        np.testing.assert_allclose(traced, expected, rtol=1e-11, atol=1e-13, err_msg=name)

    folder = adapted.emitted(tmp_path, replace(model, name="term"), {**adapted.DRIVE, **values})
    python, estimator = adapted.module(folder, "term"), adapted.Estimator(folder, "term", np.float64)
    motion = adapted.motion(2000, 4)
    current = 2.0 * np.sign(motion[1]) + np.random.default_rng(4).normal(0.0, 0.2, 2000)
    moved = dict(zip(("theta_m", "omega_m", "alpha_m", "i"), (*motion, current), strict=True))
    rows, state = [moved[name] for name in python.INPUTS], python.init(np.float64)
    assert python.replay(*rows, state)["flags"].tolist() == estimator.learn(rows)
    assert adapted.python_bits(state) == estimator.bits()


BENCH = Path(__file__).resolve().parents[1] / "examples" / "bench" / "bench.csv.gz"


@pytest.mark.slow
def test_a_term_is_found_where_the_model_lacks_something() -> None:
    """On the bundled log: few coefficients, none negative, and what is predicted is what is emitted."""
    stage, _ = staged_log([BENCH], BENCH.with_name("bench.json"))
    before = refit(stage.base, (), stage.data)
    found = fit_empirical(before, stage.data, stage.setting)

    assert found is not None
    assert found.confirmed
    assert found.interval[0] > 0.0
    assert len(found.coefficients) <= 24
    for q in found.effect.coefficients:
        assert q.domain == "real" or found.coefficients[q.name] >= 0.0
    score = stage.data.rows.score
    assert np.isclose(found.rmse[0], rms(before.residuals["mechanical"][score]))
    assert np.isclose(found.percent, 100.0 * (1.0 - found.rmse[1] / found.rmse[0]))


@pytest.mark.slow
def test_the_verdict_stays_and_the_model_has_the_term(tmp_path_factory: pytest.TempPathFactory) -> None:
    """JSON, script and emitted code agree; without the option one line offers it."""
    options = {"only": "wear_runin", "rig": BENCH.with_name("bench.json")}
    plain, found = eccentric.diagnose(BENCH, **options), eccentric.diagnose(BENCH, empirical=True, **options)
    said, out = found.document["empirical"], tmp_path_factory.mktemp("empirical")
    found.write(out / "made")

    assert (plain.verdict, plain.document["empirical"]) == ("unexplained", None)
    assert any(line.startswith("With --empirical") for line in plain.lines)
    assert "unexplained" == found.verdict
    assert said["id"] == f"empirical[{','.join(said['variables'])}]"
    assert said["id"] in found.document["extended_by"]
    errors = found.document["rmse_holdout_Nm"]["mechanical"]
    assert errors["empirical"] < errors["paper"]
    assert load_model(out / "made" / "model.py").defaults == found.model.defaults
    defaults = {q.name: float(q.default) for q in found.model.parameters if q.default is not None}
    for name, value in said["coefficients"].items():
        assert np.isclose(defaults[name], value)
    assert "a term without a cause" in (out / "made" / "report.html").read_text(encoding="utf-8")
