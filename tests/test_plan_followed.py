"""Planned motions as true drives make them: limits hold for those that are not the fitted one."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from scipy.signal import StateSpace, lsim

import eccentric
from eccentric.core import InputError
from eccentric.diagnosis import diagnose
from eccentric.planning import Bounds, Reference, planned, question_of
from eccentric.planning.limits import INTEGRAL_PER_S, SPEED_FILTER_HZ
from eccentric.planning.motion import joined, pieces
from eccentric.planning.outcome import kept
from eccentric.planning.separation import Met, Separation, extremes
from eccentric.presentation import plan_document, plan_lines
from eccentric.rigs import AddedMass
from eccentric.virtual_bench import BenchRun, Scenario, random_scenario, simulate
from eccentric.virtual_bench.scenario import Course

SEED = 310012
"""Of the rig."""


@dataclass(frozen=True)
class Follows(Course):
    """The course of a reference."""

    motion: Reference | None = field(default=None, compare=False)

    def reference(self, time: np.ndarray) -> np.ndarray:
        """The motor speed [rad/s]."""
        assert self.motion is not None
        return np.interp(time, self.motion.t, self.motion.omega)


@pytest.fixture(scope="module")
def bench() -> BenchRun:
    """A rig with gravity in the plane, and a log of it."""
    rng = np.random.default_rng(SEED)
    return simulate(random_scenario(rng, case="C2", mu=0.5, log_type="runs", seconds=20.0))


@pytest.fixture(scope="module")
def contest(bench: BenchRun) -> Separation:
    """What is known of that rig from its log."""
    return Separation(question_of(diagnose([bench.columns], bench.rig)))


def _bounds(bench: BenchRun, current: float) -> Bounds:
    """Limits of a drive that reaches its top speed in 0.3 s."""
    speed = float(np.max(np.abs(bench.columns["omega_m_rad_s"])))
    plant = bench.scenario.plant
    torque = plant.inertia * speed / 0.3 + plant.friction_torque(0.0, plant.mu * speed)
    needed = (torque + abs(plant.gravity_torque(0.5 * np.pi))) / plant.k_i
    return Bounds(speed, speed / 0.3, current * needed, 12.0)


def _driven(
    bench: BenchRun, motion: Reference, mass: float, friction: float, loop: float
) -> dict[str, float]:
    """Largest speed, current and angle of the bench's drive on a motion, with these factors on what it is."""
    scenario: Scenario = bench.scenario
    p, c = scenario.plant, scenario.controller
    p = replace(p, M=mass * p.M, M_l=mass * p.M_l, J_m=mass * p.J_m, J_l=mass * p.J_l)
    p = replace(p, C_m=friction * p.C_m, B_m=friction * p.B_m, C_lN=friction * p.C_lN, B_lN=friction * p.B_lN)
    course = Follows("traj", round(motion.seconds, 2), (), (0.0,), motion=motion)
    off = replace(scenario, plant=p, controller=replace(c, kp=loop * c.kp, ki=loop * c.ki), course=course)
    columns = simulate(replace(off, start_angle=0.0), again=True).columns
    names = {"speed": "omega_m_rad_s", "current": "current_A", "angle": "theta_m_rad"}
    return {word: float(np.max(np.abs(columns[name]))) for word, name in names.items()}


def test_the_simulated_loop_is_that_of_linear_theory() -> None:
    """An inertia under a PI controller behind a filtered speed, no friction: SciPy's lsim on its states."""
    bounds = Bounds(100.0, 400.0, 1e3, 12.0)
    motion = joined([list(pieces(bounds, 10.0, np.random.default_rng(0)))[20]], bounds)
    none = np.zeros(len(motion.t))
    loop, inertia = 5.0, 0.02
    found = extremes(motion, Met(inertia, none, none, 0.5), loop)
    overshoots, torques = [], []
    for mass in (0.9, 1.1):
        for own in (0.9 * loop, 1.1 * loop):
            gain, pole = 2.0 * np.pi * own * inertia, 2.0 * np.pi * SPEED_FILTER_HZ
            j = mass * inertia
            # States: speed, filtered speed, integral.
            a = [[0.0, -gain / j, 1.0 / j], [pole, -pole, 0.0], [0.0, -gain * INTEGRAL_PER_S, 0.0]]
            b = [[gain / j], [0.0], [gain * INTEGRAL_PER_S]]
            system = StateSpace(a, b, [[1.0, 0.0, 0.0], [0.0, -gain, 1.0]], [[0.0], [gain]])
            _, y, _ = lsim(system, motion.omega, motion.t)
            overshoots.append(np.max(np.abs(y[:, 0])))
            torques.append(np.max(np.abs(y[:, 1])))
    assert found.speed == pytest.approx(max(overshoots), rel=0.01)
    assert found.speed > 1.01 * np.max(np.abs(motion.omega))
    assert found.current == pytest.approx(max(torques) / 0.5, rel=0.03)


def test_friction_holds_a_drive_and_costs_its_current() -> None:
    """Slow constant speed: load and friction, each 10 % larger, over the torque constant."""
    bounds = Bounds(10.0, 100.0, 1e3, 20.0)
    t = np.arange(4000) / 200.0
    omega = 2.0 * np.minimum(t / 15.0, 1.0)
    motion = Reference(t, np.cumsum(omega) / 200.0, omega, np.gradient(omega, t))
    met = Met(0.001, np.full(4000, 0.3), np.full(4000, 0.2), 0.1, noise=0.25)
    assert extremes(motion, met).current == pytest.approx((1.1 * 0.5) / 0.1 + 0.25, rel=0.02)
    still = replace(motion, omega=np.zeros(4000), theta=np.zeros(4000))
    assert extremes(still, met).speed == 0.0
    assert extremes(still, met).beyond(bounds) < 0.01


@pytest.mark.parametrize(("current", "angle"), [(1.3, None), (0.6, None), (1.3, 2.0)])
def test_limits_hold_for_drives_that_are_ten_percent_off(
    bench: BenchRun, contest: Separation, current: float, angle: float | None
) -> None:
    """The bench's own drive, its loop included; without the simulation the fastest motion breaks them."""
    bounds = _bounds(bench, current)
    if angle is not None:
        bounds = replace(bounds, angle=(-angle, angle))
    limits = {"speed": bounds.speed, "current": bounds.current, "angle": angle or np.inf}
    plan = planned(contest.question, bounds)
    for mass, friction, loop in ((1.1, 1.1, 0.9), (0.9, 0.9, 1.1), (1.1, 0.9, 0.9)):
        found = _driven(bench, plan.motion, mass, friction, loop)
        assert all(found[word] <= limit for word, limit in limits.items()), found
    assert np.max(np.abs(plan.motion.omega)) > 0.2 * bounds.speed
    if angle is not None:
        # Friction and gravity shorten the way of a speed loop: it does not break this limit by itself.
        assert found["angle"] > 0.5 * angle
        return
    fastest = max(pieces(bounds, 11.0, np.random.default_rng(0)), key=lambda p: np.max(np.abs(p.omega)))
    found = _driven(bench, joined([fastest], bounds), 1.1, 1.1, 0.9)
    assert any(found[word] > limit for word, limit in limits.items()), found


def test_a_motion_is_made_slower_and_not_longer(contest: Separation, bench: BenchRun) -> None:
    """What breaks the limits of true drives keeps its time, and its words follow its speed."""
    bounds = _bounds(bench, 1.3)
    fastest = max(pieces(bounds, 10.0, np.random.default_rng(0)), key=lambda p: np.max(np.abs(p.omega)))
    offer = kept(contest, [fastest], bounds)
    assert offer is not None
    (slower,), _ = offer
    ratio = np.max(np.abs(slower.omega)) / np.max(np.abs(fastest.omega))
    assert ratio < 1.0
    assert len(slower.omega) == len(fastest.omega)
    assert [float(x) for x in slower.sizes] == pytest.approx([ratio * x for x in fastest.sizes])


def test_more_mass_is_what_the_rig_would_have(bench: BenchRun, contest: Separation) -> None:
    """Inertia and gravity of the bench's plant with that mass, in closed form."""
    bounds = _bounds(bench, 2.0)
    motion = joined([next(pieces(bounds, 10.0, np.random.default_rng(0)))], bounds)
    plant = bench.scenario.plant
    heavier = replace(plant, M=plant.M + 0.2, J_l=plant.J_l + 0.2 * plant.L**2)
    carrying = Separation(contest.question, AddedMass(0.2))
    for own, met in ((plant, contest.ground(motion).met), (heavier, carrying.ground(motion).met)):
        assert met is not None
        zero = contest.question.data.drive.channels.alignment.theta_zero_rad
        gravity = [own.gravity_torque(own.mu * x - zero) for x in motion.theta]
        assert met.inertia == pytest.approx(own.inertia, rel=1e-3)
        np.testing.assert_allclose(met.load, gravity, atol=0.01 * np.max(np.abs(gravity)))


def test_what_the_declared_values_may_be_off_by_leaves_the_added_mass(
    bench: BenchRun, contest: Separation
) -> None:
    """An inertia that is off concerns the rig's own, a torque constant all of the load."""
    bounds = _bounds(bench, 2.0)
    motion = joined([next(pieces(bounds, 10.0, np.random.default_rng(0)))], bounds)
    grounds = [s.ground(motion) for s in (contest, Separation(contest.question, AddedMass(0.2)))]
    of_the_inertia, of_the_constant = (
        [ground.candidates[name].columns({})[:, 0] for ground in grounds]
        for name in ("inertia_mismatch", "ki_mismatch")
    )
    np.testing.assert_allclose(*of_the_inertia, rtol=1e-12)
    larger = [float(np.max(np.abs(column))) for column in of_the_constant]
    assert larger[1] > 1.1 * larger[0]


def test_a_plan_with_more_mass_says_what_to_do_with_it(bench: BenchRun, contest: Separation) -> None:
    """It is in the document, and beside the motion as the rig file takes it; the current is that it needs."""
    bounds = _bounds(bench, 2.0)
    plan = planned(contest.question, bounds, added=0.2)
    assert plan_document(plan)["added_kg"] == 0.2
    (said,) = [line for line in plan_lines(plan) if "[added]" in line]
    assert 'RUN = "0.2 kg"' in said
    assert np.max(np.abs(plan.current)) > np.max(np.abs(contest.ground(plan.motion).current))


def test_more_mass_is_refused_before_the_log_is_diagnosed(
    bench: BenchRun, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A rig without its place costs no search."""
    searched: list[object] = []
    monkeypatch.setattr("eccentric.api.planned.diagnose", lambda *given, **_: searched.append(given))
    rig = {**bench.rig, "known": {n: x for n, x in bench.rig["known"].items() if n != "L_m"}}

    with pytest.raises(InputError, match=r"expected \[known\] L to add a mass, got none"):
        eccentric.plan([bench.columns], rig, _bounds(bench, 2.0), added="0.2 kg")
    assert [] == searched


def test_more_mass_needs_the_place_of_the_one_that_is_there(bench: BenchRun, contest: Separation) -> None:
    """And a mass; each is one line."""
    data, bounds = contest.question.data, _bounds(bench, 2.0)
    rig = data.drive.channels.rig
    unplaced = replace(rig, known={name: x for name, x in rig.known.items() if name != "L"})
    drive = replace(data.drive, channels=replace(data.drive.channels, rig=unplaced))
    question = replace(contest.question, data=replace(data, drive=drive))
    with pytest.raises(InputError, match=r"expected \[known\] L to add a mass, got none"):
        planned(question, bounds, added=0.2)
    for mass in ("0.2 m", "-1 kg", "0 kg"):
        with pytest.raises(InputError, match="--added: ") as error:
            eccentric.plan([bench.columns], bench.rig, bounds, added=mass)
        assert "\n" not in str(error.value)


def test_a_drive_that_sticks_counts_with_what_the_motion_asks_for() -> None:
    """Its loop is too slow to break loose within the stroke: the current is that of a drive that moves."""
    t = np.arange(400) / 200.0
    omega = np.where((t > 0.5) & (t < 1.5), 0.2, 0.0)
    motion = Reference(t, np.cumsum(omega) / 200.0, omega, np.zeros(400))
    sticking = Met(0.001, np.zeros(400), 0.5 * np.sign(omega), 0.1)

    assert extremes(motion, sticking).current == pytest.approx(1.1 * 0.5 / 0.1)
