"""An arm with the bodies that a fit found: the same torques, if they are its own."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import eccentric
from eccentric.core import InputError
from eccentric.emission import executed
from eccentric.model import identity_of, with_bodies, with_numbers
from eccentric.rigs import read_arm
from tests.import_graph import ROOT
from tests.test_arm_functions import moments

ARM = ROOT / "examples" / "arms" / "planar_2r.toml"


def of_file() -> dict[str, float]:
    """The moments of mass of the bodies of the file, the payload with the last one."""
    chain = with_numbers(read_arm(ARM))
    values = {name: x for name, x in moments(chain).items() if not name.startswith("J_m")}
    if chain.payload is None:
        return values
    held, last = chain.payload.moments, len(chain.joints) - 1
    values[f"mass_{last}"] += float(held.mass)
    for k, axis in enumerate("xyz"):
        values[f"h_{last}_{axis}"] += float(held.first[k])
        for i in range(k, 3):
            values[f"Sigma_{last}_{axis}{'xyz'[i]}"] += float(held.second[k, i])
    return values


def test_its_own_bodies_change_nothing(tmp_path: Path) -> None:
    """The torque of the file's arm and of one with its bodies from a fit; a lighter one falls short."""
    values = of_file()
    light = {name: x / 2 if "_1" in name else x for name, x in values.items()}
    motion = np.random.default_rng(71).normal(size=(3, 20, 2)) * 20
    torques = []
    for name, given in (("file", None), ("own", values), ("light", light)):
        document = {"model": "planar_2r", "parameters": {"C_m_0": 0.01}, "bodies": {"values": given}}
        paths = eccentric.emit(ARM, tmp_path / name, parameters=document, backend="numpy")
        module = executed({path.name: path.read_text(encoding="utf-8") for path in paths}, "planar_2r")
        torques.append(module.motor_torque(*motion))

    assert np.allclose(torques[0], torques[1], rtol=1e-12, atol=1e-12)
    assert not np.allclose(torques[0], torques[2], rtol=0.1)


def test_a_body_too_few_is_refused() -> None:
    """The fit of another arm."""
    values = {name: value for name, value in of_file().items() if "_1" not in name}

    with pytest.raises(InputError, match="bodies: expected mass_1 for the 2 joints of planar_2r"):
        with_bodies(read_arm(ARM), values)


def test_friction_of_another_arm_is_refused(tmp_path: Path) -> None:
    """By the name that the fit has for it, or by a coefficient that the arm lacks; nothing is written."""
    for document, said in (
        ({"model": "other", "parameters": {"C_m_0": 0.01}}, "expected a fit of planar_2r, got one of other"),
        ({"parameters": {"C_m_2": 0.01}}, "C_m_2: planar_2r has no such parameter"),
    ):
        with pytest.raises(InputError, match=said):
            eccentric.emit(ARM, tmp_path / "out", parameters=document)
        assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({}, ""),
        ({"mu": 1 / 22}, "mu of elbow is 0.0454545, not 0.166667"),
        ({"name": "wrist"}, "it has the joints shoulder, wrist, not shoulder, elbow"),
        ({"position": [0.0, -0.4, 0.0]}, r"position of elbow is \(0, -0.4, 0\), not \(0, -0.3, 0.025\)"),
        ({"position": None}, "position of elbow is None, not"),
    ],
)
def test_the_fit_of_another_arm_of_the_same_name_is_refused(
    tmp_path: Path, change: dict[str, object], said: str
) -> None:
    """One line says in what it differs; nothing is written. What is printed with fewer digits is the same."""
    file = tomllib.loads(ARM.read_text(encoding="utf-8"))
    joints = identity_of(read_arm(ARM))["joints"]
    assert [joint["name"] for joint in file["joint"]] == [joint["name"] for joint in joints]
    joints[1] = {**joints[1], "mu": 0.16666666666, **change}
    document = {"parameters": {"C_m_0": 0.01}, "chain": {"gravity": [0, -9.81, 0], "joints": joints}}

    if not said:
        assert eccentric.emit(ARM, tmp_path / "out", parameters=document, backend="numpy")
        return
    with pytest.raises(InputError, match=f"expected a fit of the arm in planar_2r.toml, .*: {said}"):
        eccentric.emit(ARM, tmp_path / "out", parameters=document)
    assert not (tmp_path / "out").exists()


def test_a_payload_that_is_set_at_run_time_stays(tmp_path: Path) -> None:
    """Its default is part of the identified body; twice of it is the file's arm with twice of it."""
    document = {"parameters": {"C_m_0": 0.01}, "bodies": {"values": of_file()}}
    motion, modules = np.random.default_rng(72).normal(size=(3, 20, 2)) * 20, []
    for name, given in (("file", {"parameters": {"C_m_0": 0.01}}), ("fitted", document)):
        paths = eccentric.emit(ARM, tmp_path / name, parameters=given, backend="numpy")
        modules.append(executed({p.name: p.read_text(encoding="utf-8") for p in paths}, "planar_2r"))
    heavy = [module.motor_torque(*motion, module.Parameters(payload_mass=1.0)) for module in modules]

    assert np.allclose(*heavy, rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"mass_0": -1.0}, "expected moments that a mass can have of body 0"),
        ({"Sigma_1_yy": -1e-3}, "expected moments that a mass can have of body 1"),
        ({"mass_2": 1.0}, "mass_2 is of no body of planar_2r"),
    ],
)
def test_bodies_that_cannot_be_are_refused(change: dict[str, float], said: str) -> None:
    """Nothing is emitted of them."""
    with pytest.raises(InputError, match=said):
        with_bodies(read_arm(ARM), of_file() | change)


@pytest.mark.parametrize(
    ("document", "said"),
    [
        ({"chain": [1]}, "chain: expected an object with a list `joints` of objects"),
        ({"chain": {"joints": [1]}}, "chain: expected an object with a list `joints` of objects"),
        ({"bodies": [1]}, "bodies: expected an object `values` of finite numbers"),
        ({"bodies": {"values": {"mass_0": "1"}}}, "bodies: expected an object `values` of finite numbers"),
        ({"bodies": {"values": {}, "possible": False}}, "accept_misfit: needed"),
        ({"joints_without_scale": ["elbow"]}, "expected friction in N m of every joint, got that of elbow"),
    ],
)
def test_a_fit_that_is_no_use_is_refused(tmp_path: Path, document: dict, said: str) -> None:
    """One line each, and nothing is written."""
    with pytest.raises(InputError, match=said):
        eccentric.emit(ARM, tmp_path / "out", parameters={"parameters": {"C_m_0": 0.01}} | document)
    assert not (tmp_path / "out").exists()


def test_what_rounding_leaves_of_a_zero_is_none(tmp_path: Path) -> None:
    """Of two pendulums in one plane nothing bends the bearings: noise of 1e-17 changes no byte of the C."""
    pendulum = {"mass_0": 1.3, "h_0_y": -0.3, "Sigma_0_yy": 0.1}
    pendulum |= {"mass_1": 0.8, "h_1_y": -0.2, "Sigma_1_yy": 0.06}
    none = dict.fromkeys(of_file(), 0.0) | pendulum
    noise = np.random.default_rng(73).normal(size=len(none)) * 1e-17
    noisy = {name: x or float(e) for (name, x), e in zip(none.items(), noise, strict=True)}
    file = tmp_path / "flat.toml"
    file.write_text(
        """gravity = [0, "-9.81 m/s^2", 0]
[[joint]]
name = "shoulder"
body = { mass = "1 kg" }
[[joint]]
name = "elbow"
position = [0, "-0.3 m", 0]
body = { mass = "1 kg" }
""",
        encoding="utf-8",
    )
    written = []
    for name, values in (
        ("none", none),
        ("noisy", noisy),
        ("bent", none | {"h_1_z": 1e-3, "Sigma_1_zz": 1e-3}),
    ):
        document = {"parameters": {"C_m_0": 0.01}, "bodies": {"values": values}}
        paths = eccentric.emit(file, tmp_path / name, parameters=document, backend="c99")
        written.append("".join(path.read_text(encoding="utf-8") for path in paths))

    assert written[0] == written[1]
    assert "C_lM_0" not in written[1]
    assert "C_lM_0" in written[2]
