"""The virtual bench obeys mechanics: its motion against closed forms, logs against what a rig may say."""

import ast
import gzip
import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from math import exp, log, pi, sin
from pathlib import Path

import numpy as np
import pytest

from eccentric import cli
from eccentric.bench import EFFECTS, BenchRun, Scenario, random_scenario, simulate, write
from eccentric.bench.effects import Effect
from eccentric.bench.motion import Motion, laws, mover
from eccentric.bench.plant import Plant
from eccentric.cli.bench import VARIANTS
from eccentric.errors import InputError

ROOT = Path(__file__).resolve().parents[1]
BUNDLED = ROOT / "examples" / "bench"

# Table 1 of the paper at mu = 1/5, in the reading that its F_1 and F_0 take: k_e = 0.2 V s/rad, F_T = M_l g.
TABLE_1 = Plant(
    case="C1", M=0.5, M_l=0.2, L=0.25, mu=0.2, R=1.0, k_i=0.02, k_e=0.2, J_m=2e-5, J_l=0.03, g=9.81,
    C_m=0.008, B_m=0.0004, C_lN=0.08, B_lN=0.004, gamma_T=0.08 * 0.2 * 9.81, beta_T=0.004 * 0.2 * 9.81,
)  # fmt: skip
C2 = replace(TABLE_1, case="C2")


def _run(
    plant: Plant, seconds: float, voltage: float, dt: float, effects: Sequence[Effect] = (), **start: float
) -> Motion:
    bound = laws(effects)
    motion = Motion(plant, effects=len(bound), **start)
    advance = mover(plant, motion, dt, bound)
    for _ in range(round(seconds / dt)):
        advance(voltage)
    return motion


def _scenario(seed: int = 3, /, **options: object) -> Scenario:
    chosen = {"case": "C2", "mu": 0.2, "log_type": "runs", "seconds": 15.0, **options}
    return random_scenario(np.random.default_rng(seed), **chosen)  # pyright: ignore[reportArgumentType]


def _energy(motion: Motion, plant: Plant) -> float:
    height = -plant.L * np.cos(plant.mu * motion.theta)
    return 0.5 * plant.inertia * motion.w**2 + plant.M * plant.in_plane_gravity * height


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_steady_speed_obeys_the_polynomial_that_the_paper_prints(direction: float) -> None:
    """In C1 at constant voltage, (k_i/R) u = F_3 w^3 + F_2 w^2 + F_1 w + F_0 with the digits of Table 1."""
    u = 12.0 * direction
    w = abs(_run(TABLE_1, 8.0, u, 1e-3).w)

    polynomial = 8.0e-7 * w**3 + 8.0e-5 * w**2 + 4.7139e-3 * w + 3.9392e-2
    assert 0.02 * 12.0 == pytest.approx(polynomial, rel=2e-5)  # five digits are printed


def test_spin_down_follows_its_closed_form_and_ends_in_rest() -> None:
    """Coulomb and viscous friction alone: w = (w0 + c/b) exp(-b t/J) - c/b until it stops, then exactly 0."""
    plant = replace(TABLE_1, M=0.0, k_i=0.0, k_e=0.0)
    c = plant.C_m + plant.mu * plant.gamma_T
    b = plant.B_m + plant.mu**2 * plant.beta_T
    w0, J = 40.0, plant.inertia
    stop = J / b * log(1.0 + b * w0 / c)

    half = _run(plant, 0.5, 0.0, 5e-4, w=w0).w
    assert half == pytest.approx((w0 + c / b) * exp(-b * 0.5 / J) - c / b, rel=1e-6)
    assert _run(plant, stop - 1e-3, 0.0, 5e-4, w=w0).w > 0.0
    assert _run(plant, stop + 1e-3, 0.0, 5e-4, w=w0).w == 0.0


def test_friction_takes_what_the_motor_gives_and_gravity_keeps() -> None:
    """Work of k_i i = gain of kinetic and potential energy + work of the friction (17)-(20)."""
    p, dt, voltage = C2, 2.5e-4, 9.0
    motion = Motion(p, w=30.0)
    advance = mover(p, motion, dt)
    before, driven, lost = _energy(motion, p), 0.0, 0.0
    for _ in range(8000):
        w, theta = motion.w, motion.theta
        advance(voltage)
        w, theta = 0.5 * (w + motion.w), 0.5 * (theta + motion.theta)
        pull, weight = p.M * p.L * (p.mu * w) ** 2, (p.M + p.M_l) * p.g
        normal = np.sqrt(pull**2 + 2.0 * weight * pull * np.cos(p.mu * theta) + weight**2)
        friction = (p.B_m + p.mu**2 * p.B_lN * normal) * w + (p.C_m + p.mu * p.C_lN * normal) * np.sign(w)
        driven += dt * w * p.k_i * motion.i
        lost += dt * w * friction

    assert driven == pytest.approx(_energy(motion, p) - before + lost, rel=1e-5)


def test_the_step_is_of_second_order() -> None:
    """Halving the step of a moving link under gravity quarters its error."""
    exact = _run(C2, 0.4, 9.0, 1e-5, w=30.0).theta
    coarse, fine = (abs(_run(C2, 0.4, 9.0, dt, w=30.0).theta - exact) for dt in (2e-3, 1e-3))

    assert round(np.log2(coarse / fine), 1) == 2.0


def test_a_link_within_its_coulomb_level_does_not_creep() -> None:
    """Friction holds up to c, to the last bit; a little more torque than G + c moves the link."""
    theta = 0.3 / C2.mu
    gravity = C2.mu * C2.M * C2.g * C2.L * sin(0.3)
    level = C2.C_m + C2.mu * C2.C_lN * (C2.M + C2.M_l) * C2.g
    limit = (gravity + level) * C2.R / C2.k_i

    assert gravity < level
    assert _run(C2, 1.0, 0.0, 5e-4, theta=theta).theta == theta
    assert _run(C2, 1.0, limit * (1.0 - 1e-9), 5e-4, theta=theta).theta == theta
    assert _run(C2, 1.0, limit * (1.0 + 1e-6), 5e-4, theta=theta).theta > theta


def test_a_stalled_motor_warms_up_by_the_first_order_law() -> None:
    """At rest the loss is u^2/R, so the temperature is Tamb + Rth u^2/R (1 - exp(-t/tau))."""
    plant = replace(TABLE_1, C_m=10.0, Rth=2.0, tau=5.0, Tamb=20.0)

    expected = 20.0 + 2.0 * 9.0 * (1.0 - exp(-3.0 / 5.0))
    assert _run(plant, 3.0, 3.0, 1e-3).temperature == pytest.approx(expected, rel=1e-4)


def test_dead_time_takes_its_voltage_from_the_current() -> None:
    """At stall the current is (u - A)/R."""
    scenario = _scenario(effects=["inverter_deadtime"])
    plant = replace(scenario.plant, C_m=10.0)
    effect = replace(scenario.effects[0], amplitude=0.4)

    assert _run(plant, 0.1, 6.0, 1e-3, [effect]).i == pytest.approx((6.0 - 0.4) / plant.R, rel=1e-12)


def _mechanics(run: BenchRun) -> np.ndarray:
    """Return k_i i - J dw/dt - G - f from the logged angle and current, f by the sealed coefficients."""
    known, hidden = run.rig["known"], run.truth["hidden_parameters"]
    mu, dt = known["mu"], 1.0 / run.rig["sample_rate_hz"]
    theta = run.columns["theta_m_rad"]
    window = np.hanning(15) / np.hanning(15).sum()
    w = np.gradient(np.convolve(theta, window, "same"), dt)
    alpha = np.gradient(w, dt)
    load, weight = known["M_kg"] * known["L_m"], (known["M_kg"] + known["M_l_kg"]) * known["g_m_s2"]
    pull = load * (mu * w) ** 2
    normal = np.hypot(pull * np.sin(mu * theta), pull * np.cos(mu * theta) + weight)
    viscous = hidden["B_m"] + mu**2 * hidden["B_lN"] * normal
    friction = viscous * w + (hidden["C_m"] + mu * hidden["C_lN"] * normal) * np.sign(w)
    gravity = mu * load * known["g_m_s2"] * np.sin(mu * theta)
    inertia = known["J_m_kgm2"] + mu**2 * known["J_l_kgm2"]
    return known["k_i_Nm_per_A"] * run.columns["current_A"] - inertia * alpha - gravity - friction


def _circuit(run: BenchRun) -> np.ndarray:
    """Return (k_i/R)(u - k_e w) - k_i i from the logged voltage, angle and current."""
    known = run.rig["known"]
    w = np.gradient(run.columns["theta_m_rad"], 1.0 / run.rig["sample_rate_hz"])
    k_i = known["k_i_Nm_per_A"]
    lost = run.columns["voltage_V"] - known["k_e_Vs_per_rad"] * w
    return k_i * lost / known["R_ohm"] - k_i * run.columns["current_A"]


@pytest.mark.parametrize(
    ("effect", "residual"),
    [
        ("link_harmonic_friction[n=2]", _mechanics),
        ("coulomb_asymmetry", _mechanics),
        ("cable_spring", _mechanics),
        ("current_bias", _circuit),
        ("ke_mismatch", _circuit),
        ("resistance_temperature", _circuit),
    ],
)
def test_the_strength_stated_is_found_in_the_log(
    effect: str, residual: Callable[[BenchRun], np.ndarray]
) -> None:
    """A noise-free log's residual in motion has the rms that the truth states; filtering costs up to 3 %."""
    run = simulate(_scenario(effects=[effect], strength=0.2, noise=0.0, seconds=30.0))
    speed = run.columns["omega_m_rad_s"]
    moving = np.abs(speed) > 3.0 * run.rig["moving_threshold_rad_s"]
    steady = np.convolve(moving, np.ones(51), "same") > 50.5
    steady[:125] = steady[-125:] = False

    rms = np.sqrt(np.mean(residual(run)[steady] ** 2))
    assert rms == pytest.approx(0.2 * run.truth["friction_rms_Nm"], rel=0.03)


# Backlash acts reversal by reversal: on a short log its strength comes in steps. It has a test of its own.
@pytest.mark.parametrize("family", [family for family in EFFECTS if family != "backlash"])
def test_every_family_reaches_the_strength_asked_for(family: str) -> None:
    """Each family alone, at 5 % of the friction on a short trajectory, is there as asked for."""
    run = simulate(_scenario(effects=[family], strength=0.05, log_type="traj"))

    (effect,) = run.truth["effects"]
    assert effect["family"] == family
    assert effect["rms_fraction_of_friction"] == pytest.approx(0.05, rel=5e-3)
    assert all(np.isfinite(column).all() for column in run.columns.values())


def test_backlash_lets_go_of_the_link_for_the_gap() -> None:
    """After a reversal the link's friction is gone while the motor turns by the gap, and only then."""
    scenario = _scenario(case="C1", effects=["backlash"])
    effect = replace(scenario.effects[0], amplitude=0.5)
    bound = laws([effect])
    motion = Motion(scenario.plant, w=20.0, effects=len(bound))
    advance = mover(scenario.plant, motion, 1e-5, bound)
    free = 0.0
    for _ in range(100_000):
        travel = motion.travel
        advance(-20.0)
        if motion.acting[0]:
            assert motion.acting[0] == -motion.link_dry
            free += motion.travel - travel

    assert motion.w < 0.0
    assert free == pytest.approx(0.5, abs=1e-3)


def test_effects_combine() -> None:
    """Two effects in two balances each have their own strength."""
    run = simulate(_scenario(effects=[("stribeck", 0.2), ("current_bias", 0.05)]))

    fractions = [effect["rms_fraction_of_friction"] for effect in run.truth["effects"]]
    assert fractions == pytest.approx([0.2, 0.05], rel=5e-3)
    assert run.truth["kind"] == "double"


def test_the_angle_comes_in_counts_of_the_encoder() -> None:
    """Every logged angle is a whole number of encoder steps, to the digits written."""
    run = simulate(_scenario())
    counts = run.columns["theta_m_rad"] * run.rig["encoder_counts_per_rev"] / (2.0 * pi)

    step = 2.0 * pi / run.rig["encoder_counts_per_rev"]
    assert np.max(np.abs(counts - np.round(counts))) * step <= 0.5e-5 + 1e-12


def test_a_rippling_bus_shows_in_the_current_but_not_in_the_command() -> None:
    """A ripple of 5 % leaves (k_i/R) 0.05 u sin(2 pi f t) in the electrical residual."""
    scenario = _scenario(noise=0.0)
    ripple = simulate(replace(scenario, drive=replace(scenario.drive, ripple=0.05, ripple_hz=30.0)))
    known, time = ripple.rig["known"], ripple.columns["time_s"]
    expected = 0.05 * ripple.columns["voltage_V"] * np.sin(2.0 * pi * 30.0 * time)

    found = -_circuit(ripple) * known["R_ohm"] / known["k_i_Nm_per_A"]
    assert np.sum(found * expected) / np.sum(expected**2) == pytest.approx(1.0, rel=0.02)


def test_noise_is_what_was_asked_for() -> None:
    """Two logs that differ in noise only differ in the current only, by noise times its largest size."""
    quiet, noisy = (simulate(_scenario(noise=noise)) for noise in (0.0, 0.02))
    differing = [name for name in quiet.columns if np.any(quiet.columns[name] != noisy.columns[name])]
    spread = np.std(noisy.columns["current_A"] - quiet.columns["current_A"])

    assert differing == ["current_A"]
    assert spread == pytest.approx(0.02 * np.max(np.abs(quiet.columns["current_A"])), rel=0.05)


@pytest.mark.parametrize("log_type", ["runs", "traj"])
@pytest.mark.parametrize("case", ["C1", "C2"])
def test_the_rig_says_what_a_user_knows_and_no_more(case: str, log_type: str) -> None:
    """Its keys are those of the format; five disjoint blocks, about a fifth of the log, are held out."""
    scenario = _scenario(case=case, log_type=log_type, seconds=60.0, effects=["current_bias"])
    rig = simulate(scenario).rig

    assert list(rig) == [
        "format", "name", "log_type", "known", "encoder_counts_per_rev", "sample_rate_hz", "columns",
        "moving_threshold_rad_s", "holdout_intervals_s",
    ]  # fmt: skip
    assert "bias" not in json.dumps(rig)
    edges = np.array(rig["holdout_intervals_s"])
    assert edges.shape == (5, 2)
    assert np.all(np.diff(edges.ravel()) >= 0.0)
    assert 0.0 <= edges.min() < edges.max() <= 60.0
    assert round(float(np.sum(edges[:, 1] - edges[:, 0]) / 60.0), 1) == 0.2


def test_runs_go_both_ways() -> None:
    """Speed runs come in both directions, as many forth as back."""
    speeds = np.array(_scenario(seconds=60.0).course.speeds)

    assert abs(int(np.sign(speeds).sum())) <= 1


def test_a_control_has_the_same_rig_and_course_as_its_twin_with_an_effect() -> None:
    """The same seed draws the same plant, drive and course, whatever the effects."""
    control, twin = _scenario(), _scenario(effects=["cogging"])

    assert (control.plant, control.drive, control.course) == (twin.plant, twin.drive, twin.course)


def test_a_temperature_is_logged_where_an_effect_needs_it() -> None:
    """A temperature effect brings its column; a hidden drift warms without one."""
    shown = simulate(_scenario(effects=["coulomb_temperature"]))
    hidden = simulate(_scenario(effects=["hidden_thermal_drift"]))

    assert shown.rig["columns"][-1] == "temperature_C"
    assert "temperature_C" not in hidden.columns
    assert hidden.truth["temperature_range"][1] > hidden.truth["temperature_range"][0]


def test_the_same_seed_writes_the_same_bytes(tmp_path: Path) -> None:
    """Two runs of one seed give the same three files; the archive carries no time and no name."""
    first, second = (
        [
            path.read_bytes()
            for path in write(simulate(_scenario(effects=["backlash"])), tmp_path / place / "a.csv.gz")
        ]
        for place in ("one", "two")
    )

    assert first == second
    assert first[0][3:8] == bytes(5)


def test_the_bundled_log_is_what_its_command_writes(tmp_path: Path) -> None:
    """The command in the README of examples/bench regenerates its rows, its rig and its truth."""
    (line,) = (s for s in (BUNDLED / "README.md").read_text().splitlines() if s.startswith("eccentric bench"))
    arguments = line.replace("'", "").replace("examples/bench", str(tmp_path)).split()[1:]

    assert cli.main(arguments) == 0
    for name in ("bench.json", "bench.truth.json"):
        assert (BUNDLED / name).read_text() == (tmp_path / name).read_text()
    bundled, again = ((place / "bench.csv.gz").read_bytes() for place in (BUNDLED, tmp_path))
    assert gzip.decompress(bundled) == gzip.decompress(again)
    assert len(bundled) < 400_000


@pytest.mark.parametrize(
    ("options", "names"),
    [
        ({"mu": 0.0}, "mu"),
        ({"mu": float("nan")}, "mu"),
        ({"case": "C3"}, "case"),
        ({"log_type": "walk"}, "log type"),
        ({"seconds": 2.0}, "seconds"),
        ({"noise": -0.1}, "noise"),
        ({"effects": ["stribec"]}, "stribeck, quadratic_drag"),
        ({"effects": [("stribeck", 0.0)]}, "strength"),
        ({"effects": ["stribeck[new]"]}, "variant"),
        ({"effects": ["load_dependent[air]"]}, "gravity, transmitted"),
        ({"effects": ["angle_offset"], "case": "C1"}, "C2"),
        ({"effects": ["hidden_thermal_drift"], "temperature": True}, "temperature"),
    ],
)
def test_bad_scenarios_are_refused_by_name(options: dict[str, object], names: str) -> None:
    """What cannot be simulated is refused in one line that names it."""
    with pytest.raises(InputError, match=names) as refused:
        _scenario(**options)

    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "arguments",
    [
        ["--effect", "stribeck=much"],
        ["--effect", "stribeck=2"],
        ["--effect", "stribeck[n=2]"],
        ["--effect", "cogging[n=3]"],
        ["--effect", "unheard_of"],
        ["--seed", "-1"],
        ["--mu", "-1"],
        ["--seconds", "2"],
        ["--noise", "-1"],
        ["--case", "C3"],
        ["--log-type", "walk"],
        ["--out", "log.csv"],
    ],
)
def test_the_command_line_refuses_and_writes_nothing(
    arguments: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Bad values end in status 2 with one line that begins with the option, and no file."""
    assert cli.main(["bench", "--out", str(tmp_path / "log.csv.gz"), *arguments]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"eccentric: error: {arguments[0]}")
    assert said.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_the_command_line_requires_a_place_for_the_log(capsys: pytest.CaptureFixture[str]) -> None:
    """Without --out there is one line that asks for it."""
    assert cli.main(["bench"]) == 2
    assert capsys.readouterr().err.startswith("eccentric: error: --out: required the path of a log")


@pytest.mark.parametrize("family", EFFECTS)
def test_listed_variants_are_those_of_the_families(family: str) -> None:
    """What a family answers to a variant that does not exist is what --list-effects shows."""
    expected = f"required a variant of {', '.join(VARIANTS[family])};" if family in VARIANTS else "no variant"
    with pytest.raises(InputError, match=expected):
        _scenario(effects=[f"{family}[x]"])


def test_the_bench_shares_nothing_with_the_toolkit() -> None:
    """Of eccentric, the bench imports itself and the errors."""
    foreign = set()
    for path in (ROOT / "eccentric" / "bench").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [str(node.module)] if isinstance(node, ast.ImportFrom) and not node.level else []
            foreign |= {
                name for name in names if name.split(".")[0] in {"eccentric", "derivations", "generated"}
            }

    assert {name for name in foreign if not name.startswith("eccentric.bench")} == {"eccentric.errors"}
