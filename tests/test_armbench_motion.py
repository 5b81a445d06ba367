"""What the bench for arms simulates: energy, friction in closed form, effects of the size asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from eccentric.virtual_bench import ArmScenario, random_arm_scenario
from eccentric.virtual_bench.arms.plant import FrictionLaw, JointFriction, RigidArm
from eccentric.virtual_bench.arms.scenario import random_arm
from eccentric.virtual_bench.arms.simulation import ArmTrace, trace
from tests.armbench import drawn_arm_scenario, require_mujoco

require_mujoco()


@pytest.fixture(scope="module", params=["2r", pytest.param("3", marks=pytest.mark.slow)])
def moved(request: pytest.FixtureRequest) -> tuple[ArmScenario, ArmTrace]:
    """An arm without effects, and its true motion."""
    return trace(drawn_arm_scenario(7, arm=request.param))


def test_work_of_the_motors_is_energy_and_friction(moved: tuple[ArmScenario, ArmTrace]) -> None:
    """What the motors put in, less what friction takes, is the change of energy: to 0.5 % of what is put."""
    scenario, found = moved
    rows = found.run == 1
    mu, k_i = scenario.arm.column("mu"), scenario.arm.column("k_i")
    w = found.w[rows]
    power = ((found.current[rows] * k_i - found.friction[rows]) / mu * w).sum(axis=1)
    rigid = RigidArm(scenario.arm, len(w))
    rigid.place(found.q[rows], w)
    energy = rigid.energy(w)
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) / scenario.sample_rate_hz)])
    put_in = np.abs(found.current[rows] * k_i / mu * w).sum() / scenario.sample_rate_hz

    np.testing.assert_allclose(work, energy - energy[0], atol=0.005 * put_in)


def test_friction_is_that_of_its_closed_form(moved: tuple[ArmScenario, ArmTrace]) -> None:
    """From the sealed coefficients and the bearing loads of the rows in motion, on the motor side."""
    scenario, found = moved
    moving = found.moving(scenario.course)
    for j, link in enumerate(scenario.arm.links):
        rows, f, mu = moving[:, j], link.friction, link.mu
        F_N, F_T, M_B = found.bearing[rows, :, j].T
        w = found.w[rows, j] / mu
        level = f.C_m + mu * (f.C_lN * F_N + f.C_lT * F_T + f.C_lM * M_B)
        viscous = f.B_m + mu**2 * (f.B_lN * F_N + f.B_lT * F_T + f.B_lM * M_B)
        expected = level * np.sign(w) + viscous * w

        # The loop takes the speed of the middle of a step, and tanh for the sign: 0.3 % of the top speed.
        np.testing.assert_allclose(found.friction[rows, j], expected, rtol=0.02, atol=0.01 * level.max())


def test_each_load_has_its_own_coefficient() -> None:
    """One unit of one load at a time, over the gear."""
    arm = drawn_arm_scenario(3).arm
    for k, (dry, viscous) in enumerate((("C_lN", "B_lN"), ("C_lT", "B_lT"), ("C_lM", "B_lM"))):
        own = JointFriction(C_m=0.5, B_m=0.25, **{dry: 3.0, viscous: 2.0})
        law = FrictionLaw(replace(arm, links=tuple(replace(link, friction=own) for link in arm.links)))
        bearing, mu = np.zeros((3, 2)), arm.column("mu")
        bearing[k] = 1.0

        np.testing.assert_allclose(law.of(bearing), (0.5 / mu + 3.0, 0.25 / mu**2 + 2.0))


@pytest.mark.slow
def test_the_step_is_short_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """With steps of a quarter the currents of a run differ by less than 0.5 % of their rms.

    Encoders and current noise are finer than that would show, so the servo gets a fine encoder.
    """
    scenario = drawn_arm_scenario(11, noise=0.0)
    scenario = replace(scenario, servo=replace(scenario.servo, counts=scenario.servo.counts * 2.0**12))
    scenario = replace(scenario, course=replace(scenario.course, runs=1))
    _, coarse = trace(scenario)
    monkeypatch.setattr("eccentric.virtual_bench.arms.scenario._STEP_S", 2.5e-4)
    _, fine = trace(scenario)

    error = np.sqrt(np.mean((coarse.current - fine.current) ** 2, axis=0))
    assert (error / np.sqrt(np.mean(fine.current**2, axis=0)) < 0.005).all()


def test_drives_follow_their_reference() -> None:
    """Six joints stay within 0.25 rad of the reference, and move for most of the time."""
    scenario, found = trace(drawn_arm_scenario(5, arm="6"))
    for run in range(3):
        rows = found.run == run + 1
        q, _ = scenario.course.reference(run, found.t[rows] - found.t[rows][0])

        assert np.abs(found.q[rows] - q).max() < 0.25
    assert found.moving(scenario.course).mean() > 0.8


@pytest.mark.parametrize(
    "effect",
    [
        "stribeck@1",
        *(
            pytest.param(other, marks=pytest.mark.slow)
            for other in (
                "kt_ripple[n=2]@2",
                "coulomb_asymmetry@2",
                "gear_efficiency@1",
                "local_defect@2",
                "hidden_thermal_drift@1",
            )
        ),
    ],
)
def test_an_effect_is_in_its_joint_alone_and_of_its_size(effect: str) -> None:
    """Its torque there is the strength times that joint's friction, to 3 %; the other joint's stays."""
    control, bare = trace(drawn_arm_scenario(9))
    scenario, found = trace(drawn_arm_scenario(9, effects=[(effect, 0.2)]))
    (one,) = scenario.effects
    other = 1 - one.joint

    assert f"@{one.joint + 1}" == effect[-2:]
    assert pytest.approx(0.2, rel=0.03) == found.shares(scenario)[0]
    assert control.arm == scenario.arm
    size = np.sqrt(np.mean(bare.friction[:, other] ** 2))
    # The arm is moved a little by it, and with it the loads.
    assert np.sqrt(np.mean((found.friction - bare.friction)[:, other] ** 2)) < 0.1 * size
    assert np.sqrt(np.mean(found.effects[:, 0] ** 2)) > 0.1 * np.sqrt(
        np.mean(bare.friction[:, one.joint] ** 2)
    )


def test_an_arm_moves_for_a_minute() -> None:
    """Five runs of twelve seconds each, if nothing else is wanted."""
    course = random_arm_scenario(np.random.default_rng(1)).course

    assert (5, 12.0) == (course.runs, course.seconds)


def test_a_drawn_arm_in_a_vertical_plane_hangs_at_zero() -> None:
    """All angles 0, each link and its centre of mass are straight below the joint: gravity has no moment."""
    arm = random_arm(np.random.default_rng(5), "2r")
    for link in arm.links:
        along = np.array(link.centre) / np.linalg.norm(link.centre)

        np.testing.assert_allclose(arm.gravity, 9.81 * along, atol=1e-12)
