"""A pendulum for MuJoCo: its friction, inertia and gravity in the engine are those of the model."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from eccentric.cli import main
from eccentric.exports import ExportedDrive, export
from eccentric.exports.drive import nearest
from eccentric.exports.export import decimal
from tests.exports import BENCH, BENCH_UNEQUAL, STEADY, drive, link_states

mujoco = pytest.importorskip("mujoco", reason="MuJoCo (mujoco-core) is not installed")


def loaded(of: ExportedDrive) -> tuple[Any, Any]:
    """Return the exported model as MuJoCo reads it, and its state."""
    model = mujoco.MjModel.from_xml_string(export(of, "mjcf").files[f"{of.name}.xml"])
    return model, mujoco.MjData(model)


def torque_of(model: Any, data: Any, angle: float, velocity: float) -> float:
    """Return the torque of friction that MuJoCo applies in a state, a constant one included."""
    data.qpos[0], data.qvel[0] = angle, velocity
    mujoco.mj_forward(model, data)
    return -float(data.qfrc_passive[0] + data.qfrc_constraint[0] + data.qfrc_actuator[0])


@pytest.mark.parametrize(
    ("name", "values"),
    [("c1_perpendicular", {}), ("c1_asymmetric", {}), ("c1_asymmetric", {"C_m_neg": 0.011})],
    ids=["c1", "equal sides", "unequal levels"],
)
def test_c1_is_exact(name: str, values: dict[str, float]) -> None:
    """Friction of case C1 is a polynomial, as that of a joint is: to 1e-12 of the emitted torque."""
    of = drive(name, None, **values)
    model, data = loaded(of)
    for angle, velocity in zip(*link_states(), strict=True):
        omega_m = velocity / of.p.mu
        expected = float(of.module.mechanical_friction_torque(omega_m, of.p)) / of.p.mu
        assert torque_of(model, data, angle, velocity) == pytest.approx(expected, rel=1e-12)
    assert nearest(of).exact


def test_c1_has_the_papers_coefficients() -> None:
    """With Table 1, by the paper's (12) and (13) without the back-EMF, on the link side."""
    of = drive("c1_perpendicular")
    law, p = nearest(of), of.p
    force, weight = p.M * p.L, p.M_l * p.g  # F_N = M L w^2, F_T as in Table 1
    expected = [
        p.C_m / p.mu + p.C_lT * weight,
        p.B_m / p.mu**2 + p.B_lT * weight,
        p.C_lN * force,
        p.B_lN * force,
    ]

    assert [law.level, *law.damping] == pytest.approx(expected, rel=1e-10)


def test_the_nearest_law_is_that_of_another_solver() -> None:
    """Bounded least squares by a trust region, over a whole grid: same coefficients, same error."""
    of = drive("c2_asymmetric", BENCH_UNEQUAL)
    low, high = of.link_speeds
    angle, speed = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 240, endpoint=False), np.linspace(low, high, 64))
    v = np.concatenate([speed.ravel(), -speed.ravel()])
    theta_m = np.tile(angle.ravel(), 2) / of.p.mu
    torque = of.module.mechanical_friction_torque(theta_m, v / of.p.mu, of.p) / of.p.mu
    columns = np.column_stack([v > 0.0, -1.0 * (v < 0.0), v, v * np.abs(v), v**3])
    found = lsq_linear(columns, torque, (0.0, np.inf), tol=1e-14)
    error = torque - columns @ found.x
    law = nearest(of)

    assert [law.upper, law.lower, *law.damping] == pytest.approx(found.x, rel=1e-4, abs=1e-5)
    assert law.error_rms == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-4)
    assert law.error_max == pytest.approx(np.abs(error).max(), rel=2e-2)


def test_what_friction_holds_stays() -> None:
    """A link that friction holds has not moved after 5 s, not by one bit; more torque moves it."""
    of = drive("c2_parallel", BENCH)
    model, data = loaded(of)
    data.qpos[0] = STEADY
    mujoco.mj_step(model, data, 2500)
    assert data.qpos[0] == STEADY
    assert abs(data.qvel[0]) < 1e-15

    gravity = float(of.module.gravity_torque(STEADY / of.p.mu, of.p))
    for share, moves in ((0.999, False), (1.001, True)):
        mujoco.mj_resetData(model, data)
        data.qpos[0], data.ctrl[0] = STEADY, gravity + share * nearest(of).level * of.p.mu
        mujoco.mj_step(model, data, 500)
        assert moves == (data.qpos[0] != STEADY)


@pytest.mark.parametrize(
    ("name", "phi"), [("c2_parallel", 0.0), ("rotating_link", 0.7), ("c1_perpendicular", np.pi / 2)]
)
def test_inertia_and_gravity(name: str, phi: float) -> None:
    """J_l + J_m/mu^2 at the joint, gravity M g L cos(phi) sin(angle), and the motor's torque over mu."""
    of = drive(name, None, **({"phi": phi} if name == "rotating_link" else {}))
    p, (model, data) = of.p, loaded(of)
    data.qpos[0], data.ctrl[0] = 1.1, 0.3
    mujoco.mj_forward(model, data)
    inertia = np.zeros((1, 1))
    mujoco.mj_fullM(model, data, inertia)

    assert inertia[0, 0] == pytest.approx(p.J_l + p.J_m / p.mu**2, rel=1e-12)
    assert data.qfrc_bias[0] == pytest.approx(
        p.M * p.g * p.L * np.cos(phi) * np.sin(1.1), rel=1e-12, abs=1e-14
    )
    assert data.qfrc_actuator[0] == pytest.approx(0.3 / p.mu, rel=1e-12)
    assert model.body_mass[1] == pytest.approx(p.M + p.M_l, rel=1e-12)


def refused(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """Return the one line that a command is refused with."""
    assert main(["export", *arguments]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.splitlines()) == 1
    return said.err


@pytest.mark.parametrize(
    ("source", "more", "said"),
    [
        ("c2_parallel", [], r"c2_parallel: J_m, J_l: expected values from --parameters"),
        ("linear_axis", [], r"a turning drive .* got a linear axis"),
        ("examples/arms/planar_2r.toml", [], r"--to: expected budget for an arm, got 'mjcf'"),
        ("c2_parallel", ["--speeds", "5", "5"], r"--speeds: expected motor speeds 0 < LOW < HIGH"),
        ("nothing_of_that_name", [], r"expected a model, .* or the folder of a fit .*, got none"),
        ("docs", [], r"docs: expected the folder of a fit or a diagnosis"),
    ],
)
def test_what_cannot_be_exported(
    source: str, more: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """One line says what is required; nothing is written."""
    line = refused([source, "--to", "mjcf", "--out", str(tmp_path / "out"), *more], capsys)

    assert re.search(said, line), line
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("x", ""),
        ("MuJoCo", "; did you mean mjcf or budget?"),
        ("isaac", "; did you mean usd?"),
        ("fmi", "; did you mean fmu?"),
    ],
)
def test_an_unknown_target(name: str, hint: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The known ones are named, and the one that is meant where a simulator or a format is."""
    line = refused(["c2_parallel", "--to", name, "--out", str(tmp_path / "out")], capsys)

    assert "--to: expected one of mjcf, budget" in line
    assert line.rstrip().endswith(f"got {name!r}{hint}")


@pytest.mark.parametrize(
    ("value", "text"),
    [(1e-4 / 0.2**2, "0.0025"), (0.1 + 0.2, "0.3"), (1.0 / 3.0, "0.3333333333333333"), (-0.0, "0.0")],
)
def test_a_quotient_of_typed_numbers_is_typed_again(value: float, text: str) -> None:
    """The rounding of one operation is not printed; what has that many digits keeps all of them."""
    assert text == decimal(value)


def test_an_inertia_that_no_such_body_has() -> None:
    """J_l is about the axis, M L^2 included: less than that of the masses alone is refused."""
    with pytest.raises(Exception, match=r"J_l: expected at least 0\.02778"):
        export(drive("c2_parallel", BENCH, J_l=0.02), "mjcf")


@pytest.mark.parametrize("rounding", [-1e-12, 0.0, 1e-12])
def test_a_point_mass_swings_as_one(rounding: float) -> None:
    """J_l = M L^2, within rounding, is legal although engines require an inertia about the centre of mass."""
    J_l = BENCH["M"] * BENCH["L"] ** 2 * (1.0 + rounding)
    of = drive("c2_parallel", BENCH, M_l=0.0, J_l=J_l)
    model, data = loaded(of)
    mujoco.mj_forward(model, data)
    inertia = np.zeros((1, 1))
    mujoco.mj_fullM(model, data, inertia)

    assert inertia[0, 0] == pytest.approx(J_l + of.p.J_m / of.p.mu**2, rel=1e-9)
