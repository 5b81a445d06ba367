"""URDF, USD and BAM: read by their own packages or formulas, friction is the nearest that they can take."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.exports import ExportedDrive, export
from eccentric.model import load_model, with_values
from tests.exports import BENCH, drive, written


@pytest.fixture(scope="module")
def of() -> ExportedDrive:
    """A drive in a tilted plane."""
    return drive("rotating_link", BENCH, phi=0.4, R=1.0)


def line(of: ExportedDrive) -> tuple[float, float]:
    """Level and slope of friction over the speed, by a fit of a line to all points of a grid."""
    speed = np.linspace(*of.link_speeds, 64)
    angle = np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False)
    torque = of.friction(angle[:, None], speed[None, :]).mean(axis=0)
    slope, level = np.polyfit(speed, torque, 1)
    return level, slope


def test_urdf_in_mujoco_and_yourdfpy(of: ExportedDrive, tmp_path: Path) -> None:
    """Both read the friction of the joint, the mass and where it is."""
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo (mujoco-core) is not installed")
    yourdfpy = pytest.importorskip("yourdfpy", reason="yourdfpy is not installed")
    path = written(export(of, "urdf").files, tmp_path) / f"{of.name}.urdf"
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    data.qpos[0] = 1.0
    mujoco.mj_forward(model, data)
    joint = yourdfpy.URDF.load(str(path), load_meshes=False).joint_map["joint"]
    level, slope = line(of)

    read = [float(joint.dynamics.friction), float(joint.dynamics.damping)]  # yourdfpy keeps them as texts
    assert read == pytest.approx([level, slope], rel=1e-9)
    assert [model.dof_frictionloss[0], model.dof_damping[0]] == pytest.approx([level, slope], rel=1e-9)
    gravity = of.p.M * of.p.g * of.p.L * math.cos(0.4) * math.sin(1.0)
    assert data.qfrc_bias[0] == pytest.approx(gravity, rel=1e-3)  # MuJoCo's own g is 9.81
    inertia = np.zeros((1, 1))
    mujoco.mj_fullM(model, data, inertia)
    assert inertia[0, 0] == pytest.approx(of.p.J_l, rel=1e-9)


def test_usd_in_newton(of: ExportedDrive, tmp_path: Path) -> None:
    """Newton reads friction, damping per radian, armature, mass and inertia, in single precision."""
    newton = pytest.importorskip("newton", reason="Newton is not installed")
    pytest.importorskip("newton_usd_schemas", reason="newton-usd-schemas is not installed")
    path = written(export(of, "usd").files, tmp_path) / f"{of.name}.usda"
    builder = newton.ModelBuilder()
    builder.add_usd(str(path))
    model = builder.finalize(device="cpu")
    level, slope = line(of)

    assert model.joint_friction.numpy() == pytest.approx([level], rel=1e-6)
    assert model.joint_damping.numpy() == pytest.approx([slope], rel=1e-6)
    assert model.joint_armature.numpy() == pytest.approx([of.p.J_m / of.p.mu**2], rel=1e-6)
    assert model.body_mass.numpy() == pytest.approx([of.p.M + of.p.M_l], rel=1e-6)
    centre = of.p.M * of.p.L / (of.p.M + of.p.M_l)
    assert model.body_com.numpy()[0] == pytest.approx([0.0, 0.0, -centre], abs=1e-7)
    assert model.body_inertia.numpy()[0, 1, 1] == pytest.approx(
        of.p.J_l - (of.p.M + of.p.M_l) * centre**2, rel=1e-5
    )


def test_bam(of: ExportedDrive) -> None:
    """By its published formulas: friction M1, and the torque of a voltage at the joint."""
    values = json.loads(export(of, "bam").files[f"{of.name}.json"])
    level, slope = line(of)
    volts = 3.0

    assert values["model"] == "m1"
    assert [values["friction_base"], values["friction_viscous"]] == pytest.approx([level, slope], rel=1e-9)
    # kt V/R - kt^2 dq/R of BAM; (k_i/R)(u - k_e omega_m)/mu here, where k_e = k_i.
    for omega_l in (0.0, 2.0):
        torque = values["kt"] * volts / values["R"] - values["kt"] ** 2 * omega_l / values["R"]
        expected = of.p.k_i / of.p.R * (volts - of.p.k_e * omega_l / of.p.mu) / of.p.mu
        assert torque == pytest.approx(expected, rel=1e-12)
    assert values["armature"] == pytest.approx(of.p.J_m / of.p.mu**2)


def test_bam_needs_the_motor() -> None:
    """A fit of a current alone has neither R nor k_e."""
    model = with_values(load_model("c2_parallel"), BENCH, "c2_parallel", voltage_known=False)
    with pytest.raises(InputError, match="expected R and k_i to export"):
        export(ExportedDrive(model, "x"), "bam")
