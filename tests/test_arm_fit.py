"""Friction of the joints of an arm: which load it follows, where none; the bodies where they are open."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from eccentric.api.of_arms import ArmFitResult
from eccentric.core import InputError
from eccentric.joints import ArmFit, fit_arm
from eccentric.joints.base_parameters import (
    BodyModule,
    JointMotions,
    base_of,
    matrix_of,
    moments_of,
    names_of,
)
from eccentric.joints.bodies import possible_bodies
from eccentric.model import Chain, Joint, Load, Placement
from eccentric.presentation import arm_fit_document, arm_fit_lines
from eccentric.rigs import read_arm_rig
from tests.arm_logs import LENGTHS, MASSES, MU, Friction, arm_log_of, arm_rig_of, moved, plain, planar_arm
from tests.arm_logs import shoulder_by_load as by_load
from tests.arms import random_chain

SHORT = 4, 10.0
"""Runs, and seconds of each: enough where only what is said of a log counts."""


def fitted(friction: Friction, masses: tuple[float, float] = MASSES, **more: Any) -> ArmFit:
    """The fit of a simulated log."""
    return fit_arm([arm_log_of(friction)], read_arm_rig(arm_rig_of(planar_arm(masses), **more)), ["log"])


@pytest.fixture(scope="module")
def known() -> ArmFit:
    """Friction of the shoulder follows F_N; the bodies are declared."""
    return fitted(by_load)


@pytest.fixture(scope="module")
def opened() -> ArmFit:
    """The same with open bodies, which the arm file has wrong by a fifth."""
    return fitted(by_load, (1.0, 0.5), joints={"inertial": "open"})


def test_the_load_is_found_in_the_right_joint(known: ArmFit, opened: ArmFit) -> None:
    """The shoulder's friction follows F_N; in the elbow Coulomb and viscous friction is enough."""
    for found in (known, opened):
        assert [(Load.NORMAL,), ()] == [joint.loads.followed for joint in found.joints]
        assert found.joints[0].interval[0] > 80.0


def test_the_table_has_a_row_for_each_joint(known: ArmFit) -> None:
    """By the names of its columns: the shoulder follows F_N, the elbow nothing."""
    table = ArmFitResult(fit=known, lines=(), warnings=(), document={}).table()

    assert [1, 2] == table["joint"]
    assert [Load.NORMAL.value, ""] == table["follows"]
    assert [joint.interval[0] for joint in known.joints] == table["lower"]


def test_coefficients_are_those_planted(known: ArmFit) -> None:
    """Within their intervals, on the motor side; 20 mm per newton of F_N."""
    shoulder, elbow = (joint.friction for joint in known.joints)
    planted = {"C_lN": 0.02, "C_m": 0.3 * MU[0], "B_m": 0.05 * MU[0] ** 2}

    for name, value in planted.items():
        assert shoulder[name].interval[0] <= value * 1.001
        assert shoulder[name].interval[1] >= value * 0.999
    assert pytest.approx(0.12 * MU[1], rel=0.01) == elbow["C_m"].value
    assert pytest.approx(0.03 * MU[1] ** 2, rel=0.01) == elbow["B_m"].value


def test_open_bodies_are_identified(opened: ArmFit) -> None:
    """Base parameters of the textbook's arm: they are within 1 %, and bodies that could exist have them."""
    found = opened.bodies
    assert found is not None
    truth = dict(zip(names_of(2), moments_of(planar_arm()).ravel(), strict=True))
    sums = found.base.sums @ np.array([truth[name] for name in names_of(2)])
    values = np.array([e.value for e in found.estimates.values()])

    assert np.allclose(sums, values, atol=2e-3)
    assert found.bodies.explain
    assert np.all(np.linalg.eigvalsh(matrix_of(found.bodies.values)) > 0.0)


def test_without_friction_by_load_nothing_is_claimed() -> None:
    """Coulomb and viscous friction is enough in both joints, and no error is said to fall."""
    found = fitted(plain)

    assert [(), ()] == [joint.loads.followed for joint in found.joints]
    assert [0.0, 0.0] == [joint.percent for joint in found.joints]
    assert "Coulomb and viscous friction is enough in every joint" in arm_fit_lines(found)[-1]


def test_of_a_log_that_does_not_fit_nothing_is_concluded() -> None:
    """Milliamperes read as amperes in the elbow: it is named with its R^2; of the shoulder all is said."""
    log = arm_log_of(by_load, *SHORT)
    log["tau_Nm_2"] = 1e3 * log["tau_Nm_2"]
    found = fit_arm([log], read_arm_rig(arm_rig_of(planar_arm())), ["log"])
    *table, said = arm_fit_lines(found)

    assert [True, False] == [joint.fits_the_rig for joint in found.joints]
    assert f"does not fit the rig in joint 2 (R^2 {found.joints[1].r_squared:.2f}): check units" in said
    assert "Friction follows the load in joint 1 (F_N" in said
    assert "enough" not in said
    assert not any("enough" in line for line in table)


def test_an_arm_that_hangs_upwards_does_not_fit() -> None:
    """Gravity upside down in the arm file: of no joint anything is said to be enough."""
    right = planar_arm()
    chain = Chain("planar", right.joints, right.bodies, [-x for x in right.gravity])
    found = fit_arm([arm_log_of(plain, *SHORT)], read_arm_rig(arm_rig_of(chain)), ["log"])

    assert not found.fits_the_rig
    assert "This log does not fit the rig in joints 1 (R^2 " in arm_fit_lines(found)[-1]
    assert "enough" not in "".join(arm_fit_lines(found))


def test_what_the_held_out_part_does_not_confirm_is_no_fact(known: ArmFit) -> None:
    """A load that the training runs chose and whose gain may be nothing on those held out."""
    shoulder, elbow = known.joints
    doubtful = replace(known, joints=(replace(shoulder, percent=1.0, interval=(-2.0, 4.0)), elbow))
    table, said = arm_fit_lines(doubtful), arm_fit_lines(doubtful)[-1]

    assert "Friction follows" not in said
    assert "not confirmed by the held-out part: F_N in joint 1" in said
    assert "F_N, not confirmed" in table[2]
    assert "Friction follows the load in joint 1 (F_N" in arm_fit_lines(known)[-1]


def in_amperes() -> tuple[dict[str, Any], dict[str, Any]]:
    """The log of friction by the load, with currents for torques, and its rig without k_i."""
    log = arm_log_of(by_load, *SHORT)
    for j, k_i in enumerate((0.08, 0.05)):
        log[f"i_A_{j + 1}"] = log.pop(f"tau_Nm_{j + 1}") * MU[j] / k_i
    columns = {"time": "t_s", "run": "run", "theta_l": "q_rad_{j}", "current": "i_A_{j}"}
    return log, arm_rig_of(planar_arm()) | {"drive": "current", "columns": columns}


@pytest.fixture(scope="module")
def gained() -> ArmFit:
    """The fit of that log with declared bodies."""
    log, rig = in_amperes()
    return fit_arm([log], read_arm_rig(rig), ["log"])


def test_a_current_without_gain_is_told(gained: ArmFit) -> None:
    """With open bodies in amperes; with declared ones the gain is identified."""
    log, rig = in_amperes()
    opened = fit_arm([log], read_arm_rig(rig | {"joints": {"inertial": "open"}}), ["log"])
    said = [arm_fit_document(found)["joints"][0] for found in (opened, gained)]

    assert [("not identifiable", "A"), ("identified", "N m")] == [(x["gain"], x["unit"]) for x in said]
    assert pytest.approx([0.08, 0.05], rel=0.05) == [e.value for e in gained.log.gains if e is not None]
    assert [(Load.NORMAL,), ()] == [joint.loads.followed for joint in opened.joints]
    # Planted in N m, logged in A: divided by k_i.
    friction, document = said[0]["friction"], arm_fit_document(opened)
    assert ("A/N", "A") == (friction["C_lN"]["unit"], friction["C_m"]["unit"])
    assert pytest.approx(0.02 / 0.08, rel=0.1) == friction["C_lN"]["value"]
    assert ["shoulder", "elbow"] == document["joints_without_scale"]


def test_the_summary_has_coefficients_and_gains(gained: ArmFit) -> None:
    """Each with unit and interval, per joint: what was planted, 20 mm in the shoulder and its k_i."""
    lines = arm_fit_lines(gained)
    rows = {tuple(line.split()[:3]): line.split()[3:] for line in lines}

    for of, unit, planted in (
        (("1", "shoulder", "C_lN"), "m", 0.02),
        (("1", "shoulder", "k_i"), "N m/A", 0.08),
        (("2", "elbow", "C_m"), "N m", 0.12 * MU[1]),
        (("2", "elbow", "k_i"), "N m/A", 0.05),
    ):
        value, _, low, _, high, *rest = rows[of]
        assert unit == " ".join(rest).partition(" (")[0]
        assert pytest.approx(planted, rel=0.05) == float(value)
        assert float(low) <= float(value) <= float(high)


def test_a_current_of_the_wrong_sign_is_told() -> None:
    """Not that its bodies need too little torque."""
    log = arm_log_of(plain, 3, 6.0)
    for j in (1, 2):
        log[f"i_A_{j}"] = -log.pop(f"tau_Nm_{j}")
    columns = {"time": "t_s", "run": "run", "theta_l": "q_rad_{j}", "current": "i_A_{j}"}
    rig = arm_rig_of(planar_arm()) | {"drive": "current", "columns": columns}

    with pytest.raises(InputError, match="current is opposite to the torque of its bodies"):
        fit_arm([log], read_arm_rig(rig), ["log"])


def test_a_load_of_rounding_is_none() -> None:
    """An axis that a rounded angle turns by 4e-6 rad has no bending moment that friction could follow."""
    straight = planar_arm()
    turned = Joint(mu=MU[0], placement=Placement.turned((0, 0, 0), 3.7e-6, 0.0, 0.0), name="shoulder")
    chain = Chain("planar", [turned, straight.joints[1]], straight.bodies, straight.gravity)
    found = fit_arm([arm_log_of(by_load, *SHORT)], read_arm_rig(arm_rig_of(chain)), ["log"])

    for joint in found.joints:
        assert {Load.NORMAL, Load.TRANSMITTED} >= set(joint.loads.present)
    assert (Load.NORMAL,) == found.joints[0].loads.followed


def test_a_voltage_without_constants_is_refused() -> None:
    """One line names the first that is missing, and the joint."""
    log = arm_log_of(plain, 3, 6.0)
    columns = {"time": "t_s", "run": "run", "theta_l": "q_rad_{j}", "voltage": "tau_Nm_{j}"}
    rig = arm_rig_of(planar_arm()) | {"drive": "voltage", "columns": columns}

    with pytest.raises(
        InputError, match=r"\[drives\] k_i: expected a value to convert the voltage of joint 1"
    ):
        fit_arm([log], read_arm_rig(rig), ["log"])


def test_base_parameters_span_the_regressor() -> None:
    """Of a random arm: their columns give its torques, and there are as many as the rank."""
    rng = np.random.default_rng(3)
    chain = random_chain(rng, 4, aligned=True, sliding=0.0, geared=True, rotors=True)
    module = BodyModule(chain)
    motion = JointMotions(*(rng.normal(size=(60, 4)) * size for size in (3, 4, 9)))
    values, whole = moments_of(chain), module.regressor(motion)
    rows = whole.reshape(-1, module.count)
    base = base_of(rows)
    rotors = module.torques(motion, np.zeros(module.count))

    assert np.allclose(whole @ values.ravel() + rotors, module.torques(motion, values), atol=1e-9)
    assert np.linalg.matrix_rank(rows / np.maximum(np.linalg.norm(rows, axis=0), 1e-12), 1e-6) == len(
        base.chosen
    )
    assert np.allclose(rows[:, base.chosen] @ (base.sums @ values.ravel()), rows @ values.ravel(), atol=1e-8)


def test_loads_and_torques_are_those_of_the_textbook() -> None:
    """F_N and torque of both joints of the planar arm."""
    m = moved(np.linspace(0.0, 5.0, 40), 3)
    mu = np.array(MU)
    module = BodyModule(planar_arm())
    met = module.met(JointMotions(m.q / mu, m.w / mu, m.a / mu), moments_of(planar_arm()))

    assert np.allclose(m.F_N, np.stack([joint.F_N for joint in met], 1))
    assert np.allclose(m.torque * mu, np.stack([joint.whole for joint in met], 1))
    assert np.allclose(LENGTHS[1] * MASSES[1] * 9.81 * MU[1] * np.sin(m.q.sum(1)), met[1].gravity)


def test_impossible_base_parameters_are_told() -> None:
    """Of one pendulum with a negative inertia about its axis there is no body."""
    chain = planar_arm()
    values = moments_of(chain)
    module, rng = BodyModule(chain), np.random.default_rng(1)
    motion = JointMotions(*(rng.normal(size=(40, 2)) * 4 for _ in range(3)))
    base = base_of(module.regressor(motion).reshape(-1, 20))
    right = base.sums @ values.ravel()
    errors = np.full(len(right), 1e-3)
    wrong = np.where(np.abs(right) > 1e-9, -right, 0.0)

    unknown = np.full(len(right), np.inf)

    assert possible_bodies(values * 1.3, base, right, errors).explain
    assert not possible_bodies(values, base, right, unknown).explain  # what nothing says is not explained
    assert not possible_bodies(values, base, wrong, errors).explain
