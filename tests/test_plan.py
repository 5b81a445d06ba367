"""The next motion: within its limits, worth what a fit of the rivals says, and written as it was planned."""

from __future__ import annotations

import json
import re
import subprocess
from dataclasses import replace
from itertools import permutations
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.optimize import lsq_linear

import eccentric
from eccentric.api.planned import PlanResult
from eccentric.cli import main
from eccentric.core import InputError
from eccentric.diagnosis import Diagnosis, diagnose
from eccentric.diagnosis.search import PARTS, STABLE, SURE, Variant
from eccentric.model import TURNING, load_model
from eccentric.planning import (
    Bounds,
    MeasurementPlan,
    plan_detection,
    planned,
    question_from,
    question_of,
    read_bounds,
    sought_of,
)
from eccentric.planning.limits import MARGIN, UNDECIDED
from eccentric.planning.motion import Reference, joined, pieces
from eccentric.planning.outcome import Heavier, _names, decided
from eccentric.planning.question import Rival
from eccentric.planning.separation import Ground, Separation
from eccentric.presentation import diagnosis_document, plan_lines
from eccentric.rigs import read_rig
from eccentric.virtual_bench import random_scenario, simulate

Tied = tuple[dict[str, np.ndarray], dict[str, object]]
LIMITS = {"speed_rad_s": 190.0, "acceleration_rad_s2": 500.0, "current_A": 9.0, "time_s": 40.0}


@pytest.fixture(scope="module")
def tied() -> Tied:
    """A log in which an eddy-current brake and Stribeck friction look alike, and its rig; it is the brake."""
    rng = np.random.default_rng(160019)
    case, log_type = str(rng.choice(["C1", "C2"])), str(rng.choice(["runs", "traj"]))
    mu, noise = float(rng.choice([1 / 30, 1 / 5, 1 / 2, 1.0])), float(rng.choice([0.004, 0.008, 0.012]))
    effects = (("eddy_current", 0.08),)
    run = simulate(random_scenario(rng, case=case, mu=mu, log_type=log_type, effects=effects, noise=noise))
    return run.columns, run.rig


@pytest.fixture(scope="module")
def found(tied: Tied) -> Diagnosis:
    """Its diagnosis."""
    return diagnose([tied[0]], tied[1])


@pytest.fixture(scope="module")
def contest(found: Diagnosis) -> Separation:
    """Its rivals."""
    assert found.attribution.verdict == "not_identifiable"
    return Separation(question_of(found))


@pytest.fixture(scope="module")
def plan(contest: Separation) -> MeasurementPlan:
    """The plan that decides between them."""
    return planned(contest.question, read_bounds(LIMITS))


@pytest.mark.parametrize("angle", [None, (-3.0, 5.0)])
def test_every_piece_keeps_its_margin(angle: tuple[float, float] | None) -> None:
    """Largest speed, acceleration and angle; it begins and ends at rest, and the angle is the integral."""
    bounds = Bounds(30.0, 200.0, 1.0, 60.0, angle)
    found = list(pieces(bounds, 10.0, np.random.default_rng(0)))

    assert len(found) > 8
    for piece in found:
        motion = joined([piece], bounds)
        assert np.max(np.abs(motion.omega)) <= (1.0 - MARGIN) * bounds.speed * (1.0 + 1e-9), piece.words
        assert np.max(np.abs(motion.alpha)) <= bounds.acceleration, piece.words
        assert len(piece.omega) <= 10.0 * 200.0 + 1, piece.words
        assert motion.omega[0] == pytest.approx(0.0, abs=1e-9)
        assert motion.omega[-1] == pytest.approx(0.0, abs=1e-9)
        way = np.trapezoid(motion.omega, motion.t)
        assert motion.theta[-1] - motion.theta[0] == pytest.approx(way, rel=1e-9, abs=1e-9)
        if angle is not None:
            half = 0.5 * (1.0 - MARGIN) * (angle[1] - angle[0]) + 1e-3
            assert np.max(np.abs(motion.theta - 0.5 * sum(angle))) <= half, piece.words


def test_the_probability_to_decide_has_its_limits() -> None:
    """Nothing apart decides nothing; half of the logs at its constant; far apart, all: the same as drawn."""
    assert decided(0.0) < 1e-6
    assert decided(UNDECIDED) == pytest.approx(0.5, abs=1e-6)
    assert decided(200.0) > 1.0 - 1e-6
    rng = np.random.default_rng(1)
    for apart in (10.0, 20.0):
        # Gaussian noise on rows whose means are `apart` from those of the other model.
        shift = np.sqrt(apart / 400.0)
        noise = rng.standard_normal((4000, 400))
        ratio = 0.5 * ((noise + shift) ** 2 - noise**2)
        parts = np.array([rng.permutation(400) < part * 400 for part in PARTS for _ in range(50)])
        agree = np.mean(ratio @ parts.T > 0.0, axis=1) >= STABLE
        sure = ratio.sum(axis=1) > np.log(SURE / (1.0 - SURE))
        assert decided(apart) == pytest.approx(np.mean(agree & sure), abs=0.03)


def test_a_rival_is_not_apart_from_itself(contest: Separation) -> None:
    """It imitates itself exactly, on the log and on a motion."""
    for rival in contest.rivals:
        assert contest.apart(rival, rival, [contest.log, _ground(contest)]) == pytest.approx(0.0, abs=1e-3)


def test_apart_is_the_error_of_the_best_imitation(contest: Separation) -> None:
    """SciPy's bounded least squares on all rows at once, over a fine grid of shapes; declared values hold."""
    contest = Separation(contest.question)
    contest.declared.clear()
    truth, other = contest.rivals
    grounds = [contest.log, _ground(contest)]
    (shape,) = other.variants[-1].candidate.shapes
    losses = []
    for value in np.geomspace(shape.low, shape.high, 100):
        variants = [replace(other.variants[-1], values={shape.quantity.name: float(value)})]
        rows = [_rows(ground, truth, variants) for ground in grounds]
        design, target = (np.concatenate([part[k] for part in rows]) for k in (0, 1))
        lower = grounds[0].screen.design(variants)[2]
        losses.append(2.0 * lsq_linear(design, target, (lower, np.inf)).cost)

    assert contest.apart(truth, other, grounds, 60) == pytest.approx(min(losses), rel=0.02)


def test_a_motion_adds_to_what_the_log_tells(contest: Separation) -> None:
    """The best fit to both is at least as bad as the best to each."""
    grounds = [contest.log, _ground(contest)]
    for truth, other in permutations(contest.rivals, 2):
        alone = [contest.apart(truth, other, [ground]) for ground in grounds]
        assert contest.apart(truth, other, grounds) >= sum(alone) * (1.0 - 1e-9) - 1e-6


def _ground(contest: Separation) -> Ground:
    bounds = read_bounds(LIMITS)
    return contest.ground(joined([next(pieces(bounds, 10.0, np.random.default_rng(0)))], bounds))


def _rows(ground: Ground, truth: Rival, variants: list[Variant]) -> tuple[np.ndarray, np.ndarray]:
    """Design and target in units of the noise."""
    target, design, _ = ground.screen.design(ground.on(variants))
    y = ground.predicted(truth) - (ground.screen.balance.target - target)
    weight = np.sqrt(ground.per_row)
    return weight * design[ground.seen], weight * y[ground.seen]


def test_the_plan_keeps_the_limits_and_is_written_as_it_is(
    tied: Tied, found: Diagnosis, tmp_path: Path
) -> None:
    """What the files hold: the motion within its limits, and C that compiles silently and holds the same."""
    result = eccentric.plan(*tied, LIMITS, diagnosis=diagnosis_document(found))
    out = tmp_path / "plan"
    names = sorted(path.name for path in result.write(out))
    assert names == ["plan.json", "plan.png", "plan.svg", "reference.csv", "reference.h"]

    table = np.genfromtxt(out / "reference.csv", delimiter=",", names=True)
    said = json.loads((out / "plan.json").read_text(encoding="utf-8"))
    for column, limit in (("omega_m_rad_s", "speed_rad_s"), ("alpha_m_rad_s2", "acceleration_rad_s2")):
        assert np.max(np.abs(table[column])) <= LIMITS[limit]
        assert said["largest"][limit] == pytest.approx(np.max(np.abs(table[column])), rel=1e-5)
    assert said["largest"]["current_A"] <= LIMITS["current_A"]
    assert table["time_s"][-1] <= LIMITS["time_s"] * 1.05
    assert {one["family"] for one in said["rivals"]} == {"eddy_current", "stribeck"}
    assert 0.0 <= said["probability"] <= 1.0

    source = out / "use.c"
    source.write_text(
        '#include <stdio.h>\n#include "reference.h"\nint main(void) { for (int k = 0; k < REFERENCE_POINTS; '
        'k++) printf("%.9g %.9g %.9g\\n", (double)reference[k][0], (double)reference[k][1], '
        "(double)reference[k][2]); return 0; }\n",
        encoding="utf-8",
    )
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]
    subprocess.run(["cc", *flags, str(source), "-o", str(out / "use")], check=True)
    printed = subprocess.run([str(out / "use")], capture_output=True, text=True, check=True).stdout
    values = np.array([line.split() for line in printed.splitlines()], dtype=float)
    rows = np.column_stack([table[name] for name in ("theta_m_rad", "omega_m_rad_s", "alpha_m_rad_s2")])[::4]
    np.testing.assert_allclose(values, rows, rtol=1e-5, atol=1e-5)
    # From rest to rest, in both.
    assert np.max(np.abs(values[-1, 1:])) == 0.0
    assert np.max(np.abs([table[-1]["omega_m_rad_s"], table[-1]["alpha_m_rad_s2"]])) == 0.0
    # The angle is the integral of the velocity, to what six decimals round.
    way = np.diff(table["theta_m_rad"]) * 200.0
    middle = 0.5 * (table["omega_m_rad_s"][1:] + table["omega_m_rad_s"][:-1])
    assert np.max(np.abs(way - middle)) < 1e-3


@pytest.mark.slow
def test_the_angle_is_that_of_the_log() -> None:
    """A log shifted with its zero: the drive needs the same current at the same place of the machine."""
    drawn = random_scenario(np.random.default_rng(7), case="C2", mu=0.2, log_type="traj", seconds=30.0)
    run, bounds, currents = simulate(drawn), Bounds(20.0, 100.0, 1e3, 20.0), []
    for zero in (0.0, 1.2):
        columns = {**run.columns, "theta_m_rad": run.columns["theta_m_rad"] + zero / 0.2}
        found = diagnose([columns], {**run.rig, "theta_zero_rad": zero})
        motion = joined([next(pieces(bounds, 10.0, np.random.default_rng(0)))], bounds)
        moved = replace(motion, theta=motion.theta + zero / 0.2)
        currents.append(Separation(question_of(found)).ground(moved).current)
    np.testing.assert_allclose(currents[0], currents[1], rtol=0.0, atol=1e-6 * np.max(np.abs(currents[0])))


def test_an_earlier_diagnosis_says_what_is_open(
    tied: Tied, found: Diagnosis, contest: Separation, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From its document, without a search: the same rivals, as likely, with the same fits to the log."""

    def no_search(*_: object) -> None:
        raise AssertionError

    monkeypatch.setattr("eccentric.diagnosis.loop.attribute", no_search)
    said = json.loads(json.dumps(diagnosis_document(found)))
    question = question_from(said, [tied[0]], read_rig(tied[1]), None)
    own = {rival.family: rival for rival in question.rivals}
    assert list(own) == [rival.family for rival in contest.rivals]
    for rival in contest.rivals:
        assert own[rival.family].chance == pytest.approx(rival.chance)
        losses = [
            q.screen.fit(r.variants).score
            for q, r in ((question, own[rival.family]), (contest.question, rival))
        ]
        assert losses[0] == pytest.approx(losses[1], rel=1e-3)
    first, second = own
    grounds = [[one.log, _ground(one)] for one in (Separation(question), contest)]
    apart = [
        one.by_names(first, second, ground)
        for one, ground in zip((Separation(question), contest), grounds, strict=True)
    ]
    assert apart[0] == pytest.approx(apart[1], rel=0.05)


def test_an_effect_of_the_circuit_beside_what_is_open_changes_nothing(tied: Tied, found: Diagnosis) -> None:
    """A motion is judged in the balance of the rivals; what the other one lacks stays out of it."""
    said = json.loads(json.dumps(diagnosis_document(found)))
    circuit = {"id": "inverter_deadtime", "family": "inverter_deadtime", "probability": 0.99}
    also = dict(said, extended_by=["inverter_deadtime", *said["extended_by"]])
    also["candidates"] = [circuit, *said["candidates"]]
    plain, beside = (question_from(one, [tied[0]], read_rig(tied[1]), None) for one in (said, also))

    assert plain.screen.balance.name == beside.screen.balance.name
    assert ((), ("inverter_deadtime",)) == (plain.elsewhere, beside.elsewhere)
    for one, other in zip(plain.rivals, beside.rivals, strict=True):
        assert (one.family, one.chance) == (other.family, other.chance)
        np.testing.assert_allclose(one.coefficients, other.coefficients, rtol=1e-6)


def test_a_document_without_a_tie_leaves_one_model(tied: Tied, found: Diagnosis) -> None:
    """That of the base where nothing is missing, that with the effect where one is named: fitted as ever."""
    said = {**diagnosis_document(found), "tied": []}
    search = found.attribution.searches["mechanical"]
    for changed, own in (
        ({"verdict": "nothing_missing", "extended_by": []}, search.base),
        ({"verdict": "named"}, search.best),
    ):
        (rival,) = question_from({**said, **changed}, [tied[0]], read_rig(tied[1]), None).rivals
        assert rival.chance == 1.0
        np.testing.assert_allclose(rival.coefficients, own.coefficients, rtol=0.02)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (
            {"format": "eccentric-fit/1"},
            r"expected a document of format eccentric-diagnosis/1, got 'eccentric-fit/1'",
        ),
        ({"logs": ["other.csv"]}, r"logs: expected the diagnosis of .*, got that of other.csv"),
        ({"model": "c1_asymmetric"}, r"model: expected that of these logs"),
        ({"tied": None}, r"expected tied, got none: diagnose the logs again"),
        ({"fits_the_rig": False}, r"expected a log that fits the rig"),
        ({"asked": {"with": ["stribeck"]}}, r"without effects to begin with .* got one with stribeck"),
        (
            {"extended_by": ["my_effect"], "tied": ["my_effect"]},
            r"expected effects that these logs can show, got my_effect",
        ),
    ],
)
def test_a_diagnosis_of_something_else_is_refused(
    tied: Tied, found: Diagnosis, changed: dict[str, object], message: str
) -> None:
    """One line with the key, what is required and what came."""
    said = {
        key: value for key, value in {**diagnosis_document(found), **changed}.items() if value is not None
    }
    with pytest.raises(InputError, match=message):
        question_from(said, [tied[0]], read_rig(tied[1]), None)


def test_a_log_of_another_rig_is_refused(tied: Tied) -> None:
    """Its current belongs to another time: there is nothing to plan from."""
    columns = {name: column[:5000] for name, column in tied[0].items()}
    columns |= {name: np.roll(columns[name], 2500) for name in ("current_A", "voltage_V")}
    with pytest.raises(InputError, match=r"expected a log that fits the rig to plan from"):
        eccentric.plan(columns, tied[1], LIMITS)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"speed_rad_s": None}, r"limits: expected speed_rad_s"),
        ({"speed_rad_s": -1.0}, r"limits: speed_rad_s: expected a finite number above 0"),
        ({"speed_rad_s": "3 m"}, r"limits: speed_rad_s: .*rad/s"),
        ({"time_s": 2.0}, r"limits: time_s: expected at least 10 s"),
        ({"angle_rad": [1.0, -1.0]}, r"limits: angle_rad: expected lower before upper"),
        ({"angle_rad": 1.0}, r"limits: angle_rad: expected a range of two"),
        ({"torque": 1.0}, r"limits: .*torque"),
    ],
)
def test_limits_that_cannot_be_are_refused(changed: dict[str, object], message: str) -> None:
    """One line with the key, what is required and what came."""
    given = {key: value for key, value in {**LIMITS, **changed}.items() if value is not None}
    with pytest.raises(InputError, match=message):
        read_bounds(given)


def test_all_mistakes_of_a_limits_file_are_told_at_once() -> None:
    """What is missing, what is no number, what is unknown: one line with each of them."""
    with pytest.raises(InputError) as error:
        read_bounds(
            {"speed_rad_s": "fast", "current_A": -1.0, "torque": 1.0, "time_s": 2.0, "speed_loop_Hz": 0}
        )
    said = str(error.value)
    assert "\n" not in said
    for part in (
        "'torque'",
        "acceleration_rad_s2 = 500",
        "'fast'",
        "current_A:",
        "time_s:",
        "speed_loop_Hz:",
    ):
        assert part in said, part


def test_a_current_that_moves_nothing_is_refused(contest: Separation) -> None:
    """No piece of motion stays within it; the message says what friction and load take."""
    with pytest.raises(InputError, match=r"current_A: expected enough for load and friction") as error:
        planned(contest.question, read_bounds({**LIMITS, "current_A": 1e-3}))
    needed = float(re.findall(r"motion, ([0-9.e-]+) A", str(error.value))[0])
    planned(contest.question, read_bounds({**LIMITS, "current_A": 1.5 * needed}))


def test_a_coefficient_is_named_as_a_fit_names_it(
    plan: MeasurementPlan, bundled: tuple[Diagnosis, Path]
) -> None:
    """A harmonic has two of them: the line says which is the cosine's and which the sine's."""
    question = question_of(bundled[0])
    names = _names(question, question.rivals[0])
    parts = {name: f"torque with {part}" for name, part in zip(names[-2:], ("cos", "sin"), strict=True)}
    shown = dict(zip((names[0], *parts), (0.5, 0.4, 0.99), strict=True))
    alone = replace(plan, rivals=plan.rivals[:1], probability=None, narrower=shown, meanings=parts)

    assert names == [name for name in bundled[0].models.extended.estimates if name in names]
    assert names[-2:] == ["link_harmonic_c2", "link_harmonic_s2"]
    assert plan_lines(alone)[1:4] == [
        "  B_lN: standard error falls to 50 % of its value from the log",
        "  link_harmonic_c2 (torque with cos): standard error falls to 40 % of its value from the log",
        "  link_harmonic_s2 (torque with sin): standard error hardly changes",
    ]


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (
            0.9,
            "With 0.2 kg more on the link, this motion would have a 90 % chance of settling it: plan it with",
        ),
        (0.3, "0.2 kg more on the link would not settle it either."),
    ],
)
def test_more_mass_is_told_where_it_helps_and_where_not(
    plan: MeasurementPlan, more: float, words: str
) -> None:
    """Beside a plan that is not likely to decide, which says so."""
    said = plan_lines(replace(plan, probability=0.4, heavier=Heavier(0.2, more)))
    assert "No motion within the limits is likely to settle it; this is the best one." in said
    assert any(line.startswith(words) for line in said)


def test_rivals_that_are_the_same_torque_are_told_as_such(contest: Separation, plan: MeasurementPlan) -> None:
    """One effect under two names: no motion decides, and none has to; two that differ are not the same."""
    first = replace(contest.rivals[0], chance=0.5)
    twins = replace(contest.question, rivals=(first, replace(first, family="twin")))
    words = f"{first.family} and twin predict the same torque on log and motion"

    same = planned(twins, read_bounds(LIMITS))
    assert same.same == ((first.family, "twin"),)
    assert same.probability == pytest.approx(0.0, abs=1e-6)
    assert any(line.startswith(words) for line in plan_lines(same))
    assert plan.same == ()


def test_the_command_prints_what_is_open(
    tied: Tied, found: Diagnosis, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """From files to files, by an earlier diagnosis, with a missing limit and a wrong document as one line."""
    log, rig, limits, said = (tmp_path / name for name in ("log.csv", "rig.json", "limits.toml", "said.json"))
    np.savetxt(
        log, np.column_stack(list(tied[0].values())), delimiter=",", header=",".join(tied[0]), comments=""
    )
    rig.write_text(json.dumps(tied[1]), encoding="utf-8")
    limits.write_text("speed_rad_s = 190.0\nacceleration_rad_s2 = 500.0\ntime_s = 40\n", encoding="utf-8")
    said.write_text(json.dumps({**diagnosis_document(found), "logs": ["other.csv"]}), encoding="utf-8")
    out = tmp_path / "plan"
    given = ["plan", str(log), "--rig", str(rig), "--limits", str(limits), "--out", str(out)]
    given += ["--diagnosis", str(said)]

    assert main(given) == 2
    assert "expected current_A" in capsys.readouterr().err

    limits.write_text(limits.read_text(encoding="utf-8") + 'current_A = "9000 mA"\n', encoding="utf-8")
    assert main(given) == 2
    assert "said.json: logs: expected the diagnosis of" in capsys.readouterr().err
    assert not out.exists()

    said.write_text(json.dumps({**diagnosis_document(found), "logs": ["log.csv"]}), encoding="utf-8")
    assert main(given) == 0
    assert re.search(r"has a \d+ % chance of settling it", capsys.readouterr().out)
    assert (out / "reference.csv").exists()


@pytest.mark.parametrize(
    ("limit", "lines", "title"), [(19.0, [-19.0, 19.0], ""), (21.0, [], "limits -21 to 21")]
)
def test_a_limit_is_drawn_where_it_does_not_flatten_the_motion(
    limit: float, lines: list[float], title: str
) -> None:
    """Up to twice the largest value it is a line, beyond that it is in the title."""
    t = np.linspace(0.0, 1.0, 50)
    motion = Reference(t, t, 10.0 * np.sin(2.0 * np.pi * t * 49 / 4 / 12), np.zeros(50))
    motion.omega[7] = 10.0
    plan = SimpleNamespace(
        motion=motion,
        bounds=Bounds(limit, 1.0, 1.0, 1.0),
        current=np.ones(50),
        strength=("current", "A"),
        axis=TURNING,
        added=0.0,
    )
    axes = list(Figure().subplots(4, 1))
    PlanResult._draw(SimpleNamespace(plan=plan), axes)  # pyright: ignore[reportArgumentType]
    speed = axes[1]

    assert lines == [np.asarray(line.get_ydata())[0] for line in speed.lines if line.get_linestyle() == "--"]
    assert title == speed.get_title(loc="right")


def test_a_declared_value_stands_in_for_a_rivals_own_effect(contest: Separation) -> None:
    """Each is a further explanation: what all rivals have, and it alone in place of what they differ in."""
    first, *others = ([v.candidate.id for v in rival.variants] for rival in contest.rivals)
    shared = [one for one in first if all(one in other for other in others)]

    assert [] != contest.declared
    assert [[*shared, c.id] for c in contest.declared] == [
        [v.candidate.id for v in one.variants] for one in contest.besides
    ]


SLIGHT = {"case": "C1", "mu": "1/5", "M": "0.5 kg", "M_l": "0.2 kg", "L": "0.25 m"}
WIDE = Bounds(speed=100.0, acceleration=2000.0, current=1.0, time=60.0)


def _by_hand(bounds: Bounds, noise: float, mass: float, values: dict[str, float]) -> float:
    """Z of the harder coefficient in case C1 by the covariance of least squares, with the paper's columns."""
    best = 0.0
    for piece in pieces(bounds, 20.0, np.random.default_rng(1)):
        motion = joined([piece], bounds)
        w, a = motion.omega[::4], motion.alpha[::4]
        force, mu, way = mass * 0.25 * (0.2 * w) ** 2, 0.2, np.sign(w)
        x = np.column_stack([mu**2 * force * w, mu * force * way, w, way, a, np.ones_like(w)])
        x = x[np.abs(w) > 0.03 * bounds.speed]
        size = np.linalg.norm(x, axis=0)
        if len(x) > 6 and np.linalg.cond(x / size) < 1e6:
            variance = np.diag(np.linalg.inv((x / size).T @ (x / size))) / size**2 * noise**2
            variance *= motion.seconds / bounds.time
            z = [values["B_lN"] / variance[0] ** 0.5, values["C_lN"] / variance[1] ** 0.5]
            best = max(best, min(z))
    return best


def test_what_a_rig_could_show_without_a_log() -> None:
    """Z is that of least squares; the time, speed and mass that are said to be enough are, and just so."""
    rig, model, noise = read_rig({"known": SLIGHT}), load_model("c1_perpendicular"), 0.5
    values = sought_of(["B_lN", "C_lN=0.1"], model)
    found = plan_detection(rig, model, WIDE, values, noise)

    assert values == {"B_lN": 0.004, "C_lN": 0.1}
    assert found.z == pytest.approx(_by_hand(WIDE, noise, 0.5, values), rel=1e-6)
    assert found.z < 5.0
    assert found.time_s == pytest.approx(60.0 * (5.0 / found.z) ** 2)
    assert found.speed_rad_s is not None
    assert found.mass_kg is not None
    faster = _by_hand(replace(WIDE, speed=found.speed_rad_s), noise, 0.5, values)
    heavier = _by_hand(WIDE, noise, found.mass_kg, values)
    assert 5.0 <= min(faster, heavier)
    assert max(faster, heavier) < 5.2


def test_what_cannot_be_planned_without_a_log_is_refused(tmp_path: Path) -> None:
    """Another coefficient, a noise of 0, a current that does not even move the load, a log beside --for."""
    rig = {"known": {**SLIGHT, "k_i": "0.02 N m/A"}}
    with pytest.raises(InputError, match="--for: expected one of B_lN, C_lN, got 'B_m'"):
        eccentric.plan_detection(rig, LIMITS, "B_m")
    with pytest.raises(InputError, match="--noise: expected a torque above 0 N m"):
        eccentric.plan_detection(rig, LIMITS, "C_lN", noise="0 N m")
    with pytest.raises(InputError, match=r"limits: expected room for one motion at .* A"):
        eccentric.plan_detection(rig, {**LIMITS, "current_A": 1e-9}, "C_lN")
    said = eccentric.plan_detection(rig, {**LIMITS, "current_A": 90.0}, ["C_lN"], noise="0.1 N m")
    assert said.write(tmp_path / "plan") == [tmp_path / "plan" / "plan.json"]
    assert set(said.document["for"]) == {"C_lN"}
    assert (
        main(["plan", "a.csv", "--for", "C_lN", "--rig", "r", "--limits", "l", "--out", str(tmp_path / "x")])
        == 2
    )
