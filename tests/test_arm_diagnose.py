"""What the joints of an arm lack: family and joint, from Python and from the command line."""

import json
from collections.abc import Sequence
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eccentric
from eccentric import ArmDiagnosisResult, InputError
from eccentric.cli import main
from eccentric.emission import executed, render
from eccentric.model import Chain, load_model
from tests.arm_logs import MU, Friction, arm_log_of, arm_rig_of, elbow_stribeck, moved, plain, planar_arm
from tests.test_arm_fit import in_amperes

ARM = """gravity = [0, "-9.81 m/s^2", 0]

[[joint]]
name = "shoulder"
axis = [0, 0, 1]
mu = "1/9"
[joint.body]
mass = "0.8 kg"
centre = [0, "-300 mm", 0]
inertia = { xx = "0.004 kg m^2", yy = "0.004 kg m^2", zz = "0.004 kg m^2" }

[[joint]]
name = "elbow"
axis = [0, 0, 1]
position = [0, "-300 mm", 0]
mu = "1/6"
[joint.body]
mass = "0.6 kg"
centre = [0, "-250 mm", 0]
inertia = { xx = "0.004 kg m^2", yy = "0.004 kg m^2", zz = "0.004 kg m^2" }
"""


def files_in(folder: Path) -> set[str]:
    """The files below a folder."""
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


RIVALS = ("stribeck", "quadratic_drag", "link_harmonic_friction", "cogging", "load_dependent", "presliding")


def diagnosed(friction: Friction, only: Sequence[str] = (), **more: Any) -> ArmDiagnosisResult:
    """The diagnosis of a simulated log."""
    return eccentric.diagnose_arm(arm_log_of(friction), arm_rig_of(planar_arm(), **more), only=only)


@pytest.fixture(scope="module")
def stribeck() -> ArmDiagnosisResult:
    """Of a log with Stribeck friction in the elbow."""
    return diagnosed(elbow_stribeck, RIVALS)


@pytest.fixture(scope="module")
def folder(stribeck: ArmDiagnosisResult, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What is written of it."""
    out = tmp_path_factory.mktemp("diagnosed") / "out"
    stribeck.write(out)
    return out


@pytest.mark.slow
def test_it_is_named_among_the_whole_library() -> None:
    """As among a few rivals."""
    assert ((2, "stribeck[d=2]"),) == diagnosed(elbow_stribeck).effects


def test_effect_and_joint_are_named(stribeck: ArmDiagnosisResult) -> None:
    """Stribeck friction in joint 2, with exponent 2; nothing is missing in joint 1."""
    shoulder, elbow = stribeck.diagnosis.joints

    assert "named" == stribeck.verdict
    assert ((2, "stribeck[d=2]"),) == stribeck.effects
    assert ["nothing_missing", "named"] == [shoulder.verdict, elbow.verdict]
    assert {"joint": 2, "verdict": "named", "family": "stribeck"} == stribeck.diagnosis.first


def test_the_held_out_error_falls_to_the_noise(stribeck: ArmDiagnosisResult) -> None:
    """In the elbow only."""
    rows = [dict(zip(stribeck.table().names, row, strict=True)) for row in stribeck.table().rows]

    assert rows[1]["extended"] < 0.3 * rows[1]["paper"]
    assert rows[0]["extended"] == rows[0]["paper"]
    assert np.isclose(rows[1]["extended"], stribeck.diagnosis.joints[1].found.noise_floor, rtol=0.2)


def test_more_joints_have_more_chances(stribeck: ArmDiagnosisResult) -> None:
    """What an effect has to gain grows with the logarithm of their number."""
    assert pytest.approx(24.0 + 2.0 * np.log(2.0)) == stribeck.diagnosis.required


@pytest.mark.slow
def test_nothing_is_named_where_nothing_is_missing() -> None:
    """Coulomb and viscous friction alone, bodies open."""
    found = diagnosed(plain, joints={"inertial": "open"})

    assert "nothing_missing" == found.verdict
    assert () == found.effects
    assert found.diagnosis.first is None
    # The arm has the bodies that were identified.
    arm = executed(found.emitted(), "planar_fitted")
    m = moved(np.arange(0.0, 20.0, 0.01), 77)
    expected = np.array(MU) * (m.torque + plain(m))
    missed = arm.motor_torque(*(x / np.array(MU) for x in (m.q, m.w, m.a))) - expected
    assert np.all(np.std(missed, axis=0) < 0.02 * np.std(expected, axis=0))


@pytest.mark.slow
def test_a_log_that_does_not_fit_is_said_first(tmp_path: Path) -> None:
    """Gravity upside down in the arm file: the closing sentence names each joint with its R^2."""
    right = planar_arm()
    chain = Chain("planar", right.joints, right.bodies, [-x for x in right.gravity])
    found = eccentric.diagnose_arm(arm_log_of(plain, runs=3), arm_rig_of(chain))
    said = found.sentence

    assert not found.fits_the_rig
    assert {} == found.emitted()
    assert "the arm as a whole is not emitted: the log does not fit the rig in joints 1, 2" in found.lines
    assert () == found.effects
    assert found.diagnosis.first is None
    for joint in found.diagnosis.joints:
        assert not joint.fits_the_rig
        assert f"{joint.number} (R^2 {joint.found.models.r_squared:.2f})" in said
    assert said.startswith("This log does not fit the rig in joints 1")
    assert said == found.summary().splitlines()[-1]
    assert "does not fit the rig" in found.write(tmp_path / "out")[0].read_text(encoding="utf-8")


def test_the_document_has_one_of_each_joint(stribeck: ArmDiagnosisResult) -> None:
    """Strict JSON, of the arm and as for one drive of each joint."""
    said = stribeck.to_dict()

    assert "eccentric-arm-diagnosis/1" == said["format"]
    assert ["nothing_missing", "named"] == [joint["diagnosis"]["verdict"] for joint in said["joints"]]
    assert [{"joint": 2, "id": "stribeck[d=2]", "family": "stribeck"}] == [
        {key: effect[key] for key in ("joint", "id", "family")} for effect in said["effects"]
    ]
    assert "Stribeck friction with exponent 2 (stribeck[d=2]) in joint 2 (held-out" in stribeck.sentence


def test_the_folder_has_a_page_for_the_arm_and_for_each_joint(folder: Path) -> None:
    """The model of the elbow is extended, a derivation of its own and emitted; loads are inputs."""
    page = (folder / "report.html").read_text(encoding="utf-8")
    model = load_model(str(folder / "joint_2" / "model.py"))

    assert {"report.html", "joint_1/report.html", "joint_2/planar_joint_2_extended.c"} <= files_in(folder)
    assert 'href="joint_2/report.html"' in page
    assert "stribeck[d=2]" in page
    assert model.name == "planar_joint_2_extended"
    assert {"load_N", "load_T", "load_M"} <= {q.name for q in model.inputs}


def test_a_joint_is_called_with_the_loads_of_the_arm(
    stribeck: ArmDiagnosisResult, folder: Path, tmp_path: Path
) -> None:
    """The comment of an input names the value of bearing_loads, by label and place, as the arm has it."""
    (tmp_path / "planar.toml").write_text(ARM, encoding="utf-8")
    paths = eccentric.emit(tmp_path / "planar.toml", tmp_path / "arm", backend="numpy")
    arm = executed({path.name: path.read_text(encoding="utf-8") for path in paths}, "planar")
    header = (folder / "joint_2" / "planar_joint_2_extended.h").read_text(encoding="utf-8")
    place = arm.BEARING_LOADS.index("F_N_1")

    assert f"load_N  force across the axis of the joint: F_N_1 of bearing_loads, out[{place}] [N]" in header
    assert f"    load_N is F_N_1 of bearing_loads, out[{place}]" in stribeck.summary().splitlines()


def test_the_arm_as_a_whole_gives_the_torque_that_was_simulated(
    stribeck: ArmDiagnosisResult, folder: Path
) -> None:
    """One call for bodies and friction, Stribeck's included: the formulas of the simulation, motor side."""
    arm = executed(stribeck.emitted(), "planar_extended")
    m = moved(np.arange(0.0, 20.0, 0.01), 77)  # a motion that is in no run of the log
    torque, friction = (np.array(MU) * x for x in (m.torque, elbow_stribeck(m)))
    motion = [x / np.array(MU) for x in (m.q, m.w, m.a)]
    rises = np.std(friction - np.array(MU) * plain(m), axis=0)[1]
    found = arm.mechanical_friction_torque(*motion)
    missed = np.sqrt(np.mean((found - friction) ** 2, axis=0))

    whole = {f"planar_extended.{end}" for end in ("py", "h", "c")}
    assert whole | {"check/planar_extended_selftest.c"} <= files_in(folder)
    np.testing.assert_allclose(arm.inverse_dynamics(*motion), torque, 1e-9, 1e-9)
    np.testing.assert_allclose(arm.motor_torque(*motion), arm.inverse_dynamics(*motion) + found, 1e-12, 1e-12)
    assert np.all(missed < 0.02 * np.sqrt(np.mean(friction**2, axis=0)))
    assert missed[1] < 0.05 * rises


def test_an_arm_that_would_be_wrong_is_not_emitted(tmp_path: Path) -> None:
    """The log has currents and open bodies: no newton metre; it is said, and nothing is written."""
    log, rig = in_amperes()
    found = eccentric.diagnose_arm(log, rig | {"joints": {"inertial": "open"}}, only=["stribeck"])

    assert {} == found.emitted()
    why = "friction has no scale in N m in joints 1, 2: give k_i under [drives] in the rig file"
    assert f"the arm as a whole is not emitted: {why}" in found.lines
    assert not [path for path in found.write(tmp_path / "out") if path.name.startswith("planar_fitted")]


def test_constants_that_nobody_knows_are_not_given(stribeck: ArmDiagnosisResult) -> None:
    """The log has a torque: friction without back-EMF is a number, and with it NaN."""
    model = stribeck.joint(2).model
    module = executed(render(model), model.name)

    assert np.isfinite(module.mechanical_friction_torque(1.0, 3.0))
    assert np.isnan(module.friction_torque(1.0, 3.0))
    assert np.isfinite(module.friction_torque(1.0, 3.0, module.Parameters(R=1.0, k_i=0.1, k_e=0.1)))
    assert "alpha_m" not in signature(module.current).parameters


def test_the_page_of_a_joint_repeats_the_diagnosis_of_the_arm(stribeck: ArmDiagnosisResult) -> None:
    """A joint has no rig and no model of its own that the command would take."""
    command = stribeck.joint(2).data.source.command

    assert command.replace("".join(f" --only {family}" for family in RIVALS), "") == (
        "eccentric diagnose table --rig rig --out DIR"
    )


def test_a_diagnosis_is_no_fit(stribeck: ArmDiagnosisResult, tmp_path: Path) -> None:
    """One line says what to emit instead, of the arm and of a joint."""
    (tmp_path / "planar.toml").write_text(ARM, encoding="utf-8")
    for document, instead in (
        (stribeck.document, "emit the model.py of a joint, joint_NUMBER/model.py next to it"),
        (stribeck.joint(2).document, "emit the model.py next to it, which has its values"),
    ):
        given = tmp_path / "diagnosis.json"
        given.write_text(json.dumps(document), encoding="utf-8")
        with pytest.raises(InputError, match=f"got a diagnosis: {instead}"):
            eccentric.emit(tmp_path / "planar.toml", tmp_path / "out", parameters=given)


def test_a_joint_that_is_not_there_is_refused(stribeck: ArmDiagnosisResult) -> None:
    """One line with the numbers that there are."""
    with pytest.raises(InputError, match="joint: expected one of 1, 2, got 3"):
        stribeck.joint(3)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A log and the rig of an arm as files."""
    folder = tmp_path_factory.mktemp("arm")
    log = arm_log_of(plain, runs=3, seconds=10.0)
    names = list(log)
    lines = [",".join(names), *(",".join(map(str, row)) for row in zip(*log.values(), strict=True))]
    (folder / "log.csv").write_text("\n".join(lines), encoding="utf-8")
    (folder / "arm.toml").write_text(ARM, encoding="utf-8")
    (folder / "rig.toml").write_text(
        """arm = "arm.toml"
drive = "torque"
moving_threshold_rad_s = 0.05
[columns]
time = "t_s"
run = "run"
theta_l = "q_rad_{j}"
torque_l = "tau_Nm_{j}"
""",
        encoding="utf-8",
    )
    return folder / "log.csv", folder / "rig.toml"


def test_fit_takes_the_rig_of_an_arm(
    written: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The same command: a table of the joints, and fit.json."""
    log, rig = written
    done = main(["fit", str(log), "--rig", str(rig), "--out", str(tmp_path / "out")])
    said = json.loads((tmp_path / "out" / "fit.json").read_text(encoding="utf-8"))

    assert 0 == done
    assert "Coulomb and viscous friction is enough in every joint" in capsys.readouterr().out
    assert ["shoulder", "elbow"] == [joint["name"] for joint in said["joints"]]


@pytest.mark.parametrize(
    ("command", "option"), [("fit", ["--model", "c2_parallel"]), ("diagnose", ["--with", "stribeck"])]
)
def test_options_of_one_drive_are_refused(
    written: tuple[Path, Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    command: str,
    option: list[str],
) -> None:
    """One line, which names the option and the rig."""
    log, rig = written
    done = main([command, str(log), "--rig", str(rig), "--out", str(tmp_path / "out"), *option])

    assert 2 == done
    assert f"{option[0]}: expected the rig of a single drive with it" in capsys.readouterr().err


def test_a_command_for_one_drive_refuses_an_arm(written: tuple[Path, Path]) -> None:
    """One line."""
    log, rig = written

    with pytest.raises(InputError, match="arm: expected the rig of a single drive here"):
        eccentric.fit(str(log), str(rig))
