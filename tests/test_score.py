"""Every run left out once: the errors are those of least squares on the other runs' rows."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import nnls

import eccentric
from eccentric.diagnosis import diagnose, leave_runs_out
from eccentric.diagnosis.models import Models, confirms, contradiction
from eccentric.diagnosis.score import BelowLowPass, Score, score
from eccentric.identification import FitData, fit, refit
from eccentric.model import Model
from eccentric.presentation import diagnosis_sentence
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from eccentric.virtual_bench import simulate
from tests.extended import effects
from tests.identified import inertia, prepared
from tests.swing import Array, Swing, driven, sines, write_rig, write_runs
from tests.virtual import drawn_scenario

BENCH = Path(__file__).resolve().parent.parent / "examples" / "bench"
RIG = Swing()
WEIGHT = RIG.M * RIG.g


def less_with_load(theta: Array, omega: Array) -> Array:
    """Dry friction at the motor (n,) [N m] that falls with F_N, of weight and centrifugal force."""
    pull = RIG.M * RIG.L * (RIG.mu * omega) ** 2
    normal = np.sqrt(pull**2 + 2.0 * WEIGHT * pull * np.cos(RIG.mu * theta) + WEIGHT**2)
    return -0.01 * normal * np.sign(omega)


FALLING = Swing(C=0.2, more=less_with_load)
RISING = Swing(more=lambda theta, omega: -4.0 * less_with_load(theta, omega))
KNOWN = RIG.known + f"J_m_kgm2 = {RIG.J}\nJ_l_kgm2 = 0.0\n"


def data(tmp_path: Path, runs: int, real: Swing = RIG) -> tuple[FitData, Model]:
    """A known rig with a noisy torque signal and the third run held out."""
    rng = np.random.default_rng(9)
    table = {f"run_{k}": driven(real, rng, noise_Nm=0.01) for k in range(runs)}
    log = write_runs(tmp_path / "log.csv", table, ("time_s", "theta_m_rad", "torque_Nm"))
    return prepared(log, write_rig(tmp_path / "rig.toml", KNOWN, 'holdout_runs = ["run_2"]'))


def columns(one: FitData, smooth: bool = False) -> tuple[Array, Array]:
    """Friction torque (n,) and the columns of its coefficients (n, 4), by hand; Coulomb and viscous first.

    Optionally both after the low pass of the angle.
    """
    c = one.drive.channels
    assert c.motor.torque is not None
    link, pull = RIG.mu * c.motion.theta_m, RIG.M * RIG.L * (RIG.mu * c.motion.omega_m) ** 2
    weight = RIG.M * RIG.g
    normal = np.sqrt(pull**2 + 2.0 * weight * pull * np.cos(link) + weight**2)
    sign, speed = np.sign(c.motion.omega_m), c.motion.omega_m
    required = c.motor.torque - RIG.load(c.motion.theta_m)
    every = np.column_stack([required, sign, speed, normal * sign, normal * speed])
    if smooth:
        # The acceleration has passed the low pass already.
        every = c.smooth(every)
    return every[:, 0] - RIG.J * c.motion.alpha_m, every[:, 1:]


@pytest.mark.parametrize(("model", "count"), [("linear", 2), ("paper", 4)])
def test_left_out_runs_have_the_error_of_plain_least_squares(tmp_path: Path, model: str, count: int) -> None:
    """The RMSE over all runs is that of a fit by hand to the used rows of the others, filtered."""
    one, base = data(tmp_path, 6)
    channels = one.drive.channels
    (target, design), (passed, filtered) = columns(one), columns(one, smooth=True)
    squares, rows = 0.0, 0
    for run in range(6):
        own = channels.selection.usable & (channels.time.run == run)
        others = channels.selection.usable & (channels.time.run != run)
        found = np.linalg.lstsq(filtered[others, :count], passed[others], rcond=None)[0]
        squares += float(np.sum((target[own] - design[own, :count] @ found) ** 2))
        rows += np.count_nonzero(own)
    over = leave_runs_out(base, refit(base, (), one, bounds=False), one, bounds=False)
    assert over is not None
    assert over.runs == 6
    assert over.rmse[model] == pytest.approx(np.sqrt(squares / rows), rel=1e-6)


def test_a_left_out_run_is_predicted_within_the_bounds(tmp_path: Path) -> None:
    """Friction that falls with F_N has no coefficient within bounds: the error is that of SciPy's `nnls`."""
    one, base = data(tmp_path, 6, FALLING)
    usable, runs = one.drive.channels.selection.usable, one.drive.channels.time.run
    (target, design), (passed, filtered) = columns(one), columns(one, smooth=True)
    squares = 0.0
    for run in range(6):
        own, others = usable & (runs == run), usable & (runs != run)
        found, _ = nnls(filtered[others], passed[others])
        assert 0.0 in found
        squares += float(np.sum((target[own] - design[own] @ found) ** 2))
    over = leave_runs_out(base, refit(base, (), one), one)

    assert over is not None
    assert pytest.approx(np.sqrt(squares / np.count_nonzero(usable)), rel=1e-6) == over.rmse["paper"]


def test_an_effect_has_to_beat_the_model_without_bounds(tmp_path: Path) -> None:
    """One that imitates friction falling with F_N beats the bounded model, not the one that contains it."""
    one, base = data(tmp_path, 4, FALLING)
    imitation = (effects("C2")["link_harmonic_friction[n=1]"], {})
    models = Models(
        linear=refit(base, (), one, linear=True),
        paper=refit(base, (), one),
        paper_unbounded=refit(base, (), one, bounds=False),
        extended=refit(base, (imitation,), one),
    )
    held_out = {name: fit.held_out("mechanical") for name, fit in vars(models).items()}
    within = score(models.linear, models.paper, models.extended, "mechanical", None)

    assert held_out["paper_unbounded"] < held_out["extended"] < held_out["paper"]
    assert within.confirms
    assert not confirms(within, models, one)


def test_a_worse_prediction_contradicts_an_answer(tmp_path: Path) -> None:
    """Where friction follows F_N, a model without contradicts; one that is worse by chance alone does not."""
    one, base = data(tmp_path, 4, RISING)
    linear, paper, free = refit(base, (), one, linear=True), refit(base, (), one), refit(base, (), one, False)
    harmonics = (
        refit(base, ((effects("C2")[f"link_harmonic_friction[n={n}]"], {}),), one) for n in range(1, 13)
    )
    worse = next(fit for fit in harmonics if fit.held_out("mechanical") > paper.held_out("mechanical"))
    found = contradiction(Models(linear, paper, free, linear), one)

    assert found is not None
    assert ("mechanical", True) == (found[0], found[1] < found[2][1] < 0.0)
    assert contradiction(Models(linear, linear, linear, paper), one) is None
    assert contradiction(Models(linear, paper, free, worse), one) is None


def test_to_leave_out_the_held_out_run_is_the_fit_itself(tmp_path: Path) -> None:
    """What is held out is one run: a fit on all others is the fit on the training part."""
    one, base = data(tmp_path, 6)
    expected, actual = refit(base, (), one), refit(base, (), one, without=2)
    assert expected.values == pytest.approx(actual.values, rel=1e-12)


@pytest.mark.slow
def test_the_baseline_of_an_open_inertia_is_that_of_a_fit() -> None:
    """Here Coulomb + viscous friction takes less inertia than the mass alone has, in both commands."""
    log = BENCH / "bench.csv.gz"
    content = json.loads((BENCH / "bench.json").read_text(encoding="utf-8"))
    content["known"] = {k: x for k, x in content["known"].items() if not k.startswith("J_")}
    rig = read_rig(content)
    data, model = prepared(log, content)
    expected = fit(read_channels([log], rig), rig, model).rmse
    found = {name: refit(model, (), data, linear=name == "linear") for name in ("linear", "paper")}

    assert expected["linear"] == pytest.approx(found["linear"].held_out("mechanical"), rel=1e-9)
    assert expected["paper"] == pytest.approx(found["paper"].held_out("mechanical"), rel=1e-9)
    mass = content["known"]["M_kg"] * content["known"]["L_m"] ** 2 * content["known"]["mu"] ** 2
    assert inertia(found["linear"], content["known"]["mu"]) < mass


def test_gain_over_runs_counts_the_better_ones(tmp_path: Path) -> None:
    """Where friction is Coulomb and viscous, that of F_N neither gains nor clearly loses."""
    one, base = data(tmp_path, 6)
    over = leave_runs_out(base, refit(base, (), one, bounds=False), one, bounds=False)
    assert over is not None
    percent, (low, high), better = over.gains["paper"]
    assert set(over.gains) == {"paper"}
    assert percent == pytest.approx(100.0 * (1.0 - over.rmse["paper"] / over.rmse["linear"]), abs=1e-9)
    assert low <= percent <= high
    assert low <= 0.0 <= high
    assert 0 <= better <= over.runs


def test_fewer_than_five_runs_are_not_left_out(tmp_path: Path) -> None:
    """Four runs say too little of a fifth."""
    one, base = data(tmp_path, 4)
    assert leave_runs_out(base, refit(base, (), one), one) is None


def test_what_accelerates_the_drive_passes_the_low_pass_once(tmp_path: Path) -> None:
    """A shake of 30 Hz, above the cut-off: torque and inertia are known, so that below it nothing is left."""
    t, theta, omega, alpha = sines(np.random.default_rng(3), seconds=20.0)
    shake = 2.0 * np.pi * 30.0
    theta = theta + 2e-3 * np.sin(shake * t)
    omega = omega + 2e-3 * shake * np.cos(shake * t)
    alpha = alpha - 2e-3 * shake**2 * np.sin(shake * t)
    torque = RIG.torque(theta, omega, alpha)
    log = tmp_path / "log.csv"
    table = np.column_stack([t, theta, torque])
    np.savetxt(log, table, delimiter=",", header="time_s,theta_m_rad,torque_Nm", comments="")
    rig = write_rig(tmp_path / "rig.toml", KNOWN, "low_pass_hz = 25.0")
    one, model = prepared(log, rig)
    fit, rows = refit(model, (), one), one.rows.score
    whole, below = fit.residuals["mechanical"][rows], fit.smooth_residual()[rows]
    twice = one.drive.channels.smooth(fit.residuals["mechanical"])[rows]

    assert 4.0 * np.std(below) < np.std(twice) < np.std(whole)
    band = eccentric.fit(log, rig).document["error_band"]
    assert band["below"] == pytest.approx(np.sqrt(np.mean(below**2)), rel=0.1)


@pytest.mark.parametrize(
    ("rows", "below", "confirmed", "only"),
    [
        ((10.0, (5.0, 15.0)), (12.0, (6.0, 18.0)), True, False),
        ((-1.0, (-3.0, 1.0)), (40.0, (30.0, 50.0)), True, True),
        ((-80.0, (-90.0, -70.0)), (40.0, (30.0, 50.0)), True, True),
        ((-1.0, (-3.0, 1.0)), (2.0, (-3.0, 5.0)), False, False),
        ((2.0, (-3.0, 6.0)), (-10.0, (-15.0, -5.0)), False, False),
        ((2.0, (-3.0, 6.0)), None, True, False),
    ],
    ids=str,
)
def test_a_clear_gain_below_the_low_pass_confirms(
    rows: tuple[float, tuple[float, float]],
    below: tuple[float, tuple[float, float]] | None,
    confirmed: bool,
    only: bool,
) -> None:
    """A gain of all rows does, too, unless below the low pass there is a clear loss."""
    motion = below and BelowLowPass(25.0, 1.0, 0.5, *below)
    found = Score({}, {}, {}, "mechanical", *rows, None, motion)

    assert (confirmed, only) == (found.confirms, found.only_below)


@pytest.mark.slow
@pytest.mark.parametrize("logged", [("voltage_V", "current_A"), ("current_A",), ("voltage_V",)], ids="+".join)
def test_a_ripple_above_the_low_pass_is_not_held_against_its_name(logged: tuple[str, ...]) -> None:
    """Six periods a turn of a fast motor: below 25 Hz they explain the log, row by row they add error."""
    fast = drawn_scenario(
        6, case="C1", mu=1 / 30, effects=[("cogging[n=6]", 0.08)], noise=0.004, seconds=60.0
    )
    run = simulate(fast)
    columns = {name: run.columns[name] for name in ("time_s", "theta_m_rad", *logged)}
    found = diagnose([columns], {key: value for key, value in run.rig.items() if key != "columns"})
    motion, true = found.score.below, run.truth["effects"][0]
    cos, sin = (found.models.extended.values[f"cogging_{part}6"] for part in "cs")
    named = [effect.id for effect, _ in found.models.extended.effects]

    assert ("named", ["cogging[n=6]"]) == (found.attribution.verdict, named)
    assert np.hypot(cos, sin) == pytest.approx(true["amplitude"], rel=0.02)
    assert found.score.percent < 0.0
    assert motion is not None
    assert motion.interval[0] > 0.0
    assert f"held-out error below {motion.cut_hz:g} Hz from" in diagnosis_sentence(found)


@pytest.mark.parametrize(("lower", "expected"), [(-1.0, False), (1.0, True)])
def test_a_model_that_may_be_worse_over_the_runs_is_not_confirmed(lower: float, expected: bool) -> None:
    """Better by 10 % on all rows together; the interval over the runs decides."""
    runs = SimpleNamespace(gains={"extended": (2.0, (lower, 4.0), 3)}, below=None)
    found = Score({}, {}, {}, "mechanical", 10.0, (5.0, 15.0), runs)  # pyright: ignore[reportArgumentType]

    assert expected == found.confirms
