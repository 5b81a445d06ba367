"""An arm whose joints have effects, as one model: emitted, against the textbook's arm and the joint alone.

The joint alone is called with forces and torques of the textbook, `tests/arm_logs.py`, which uses nothing of
the toolkit; so what the arm adds, loads and torques in the joint's place, has an oracle of its own.
"""

import ctypes
import inspect
import subprocess
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from eccentric.effects import Effect, Setting, library
from eccentric.emission import complete, executed, render
from eccentric.joints.diagnosed import in_an_arm
from eccentric.joints.joint_model import joint_model
from eccentric.model import (
    Change,
    Extension,
    Model,
    Role,
    Sgn,
    Term,
    extended,
    quantity,
    recursion,
    with_values,
)
from eccentric.model import vocabulary as v
from tests.arm_logs import LENGTHS, MASSES, MU, G, moved, planar_arm

STRICT = (
    *("-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion"),
    *("-Werror", "-shared", "-fPIC"),
)
REAL = {"double": np.float64, "float": np.float32}
VALUES = {
    "R": 1.0, "k_i": 0.1, "k_e": 0.1, "B_m": 1e-3, "C_m": 1e-2,
    "B_lN": 1e-4, "C_lN": 2e-3, "B_lT": 1e-4, "C_lT": 1e-3, "B_lM": 1e-4, "C_lM": 1e-3,
}  # fmt: skip
COEFFICIENT, DT = 0.013, 0.01
T = np.arange(0.0, 0.6, DT)
MOVED = moved(T, 3)
BODIES = recursion(planar_arm())
FEW = (
    "stribeck[d=2]",  # an exponential
    "link_harmonic_friction[n=3]",  # the angle of the joint
    "gear_efficiency[gravity,driven]",  # the weight alone, with its sign
    "load_dependent[transmitted]",  # what the gear passes on
    "viscosity_temperature",  # friction scaled by its role
    "wear_runin",  # time
    "presliding",  # a hidden state
    "hidden_thermal_drift",  # one that follows current and torque
    "cogging[n=3]",  # no friction, but torque
    "kt_saturation",  # torque that an ampere lacks
)


def effects() -> dict[str, Effect]:
    """Every effect that a joint of an arm may have; of those with many harmonics the third."""
    found: dict[str, Effect] = {}
    for warm in (30.0, None):
        channels = {"current", "voltage"} | ({"temperature"} if warm else set())
        setting = Setting(
            base=joint_model("joint", "A joint"), mu=MU[1], known={"k_i": 0.1, "R": 1.0},
            w_min=0.1, w_max=100.0, current_max=5.0, duration_s=60.0, mean_loss_W=3.0, mean_force=30.0,
            mean_square_A2=2.0, temperature_mid=warm, channels=frozenset(channels),
        )  # fmt: skip
        found |= {e.id: e for e in library(setting)}
    # The angle of a joint enters its model through effects alone: there is none to be shifted.
    del found["angle_offset"]
    return {name: e for name, e in found.items() if "n=" not in name or "n=3]" in name}


@dataclass(frozen=True)
class Emitted:
    """The arm with an effect in its elbow: its model and module, and the module of the elbow alone."""

    model: Model
    arm: ModuleType
    joint: ModuleType


def with_effect(name: str) -> tuple[Model, Model]:
    """The planar arm with plain friction in its shoulder, and this effect in its elbow; and the elbow."""
    effect, plain = effects()[name], joint_model("joint", "A joint")
    given = {shape.quantity.name: shape.middle for shape in effect.shapes}
    given |= {q.name: COEFFICIENT for q in effect.coefficients}
    elbow = with_values(effect.extend(plain, given), {**VALUES, "mu": MU[1]}, "elbow")
    shoulder = with_values(plain, {**VALUES, "mu": MU[0]}, "shoulder")
    return in_an_arm(BODIES, [shoulder, elbow], "extended", "A planar arm"), elbow


@cache
def emitted(name: str) -> Emitted:
    """Both, emitted."""
    model, elbow = with_effect(name)
    arm = executed(render(model, "a test", "a test", ("numpy",)), "extended")
    return Emitted(model, arm, executed(render(elbow, backends=("numpy",)), "elbow"))


def textbook() -> dict[str, np.ndarray]:
    """What the elbow meets (n,), on the motor side: its motion, torques and loads."""
    weight = MU[1] * MASSES[1] * G * LENGTHS[1] * np.sin(MOVED.q.sum(1))
    zero = np.zeros_like(T)
    return {
        "theta_m": MOVED.q[:, 1] / MU[1],
        "omega_m": MOVED.w[:, 1] / MU[1],
        "alpha_m": MOVED.a[:, 1] / MU[1],
        "T_g": weight,
        "T_d": MU[1] * MOVED.torque[:, 1] - weight,
        "T_r": zero,
        "load_T": zero,
        "load_M": zero,
        "load_N": MOVED.F_N[:, 1],
    }


def logged() -> dict[str, Any]:
    """What a log has of both joints besides their motion (n, 2), the time and its step."""
    phase = np.array([0.0, 1.0])
    wave = np.sin(9 * T[:, None] + phase)
    return {"i": 2 * wave, "u": 5 * wave, "temperature": 30 + 8 * wave, "t": T, "dt": DT}


def of_arm(real: Any = np.float64) -> dict[str, Any]:
    """The inputs of the arm."""
    motion = dict(zip(("theta_m", "omega_m", "alpha_m"), (MOVED.q, MOVED.w, MOVED.a), strict=True))
    each = {name: x / np.array(MU) for name, x in motion.items()} | logged()
    return {name: np.asarray(x, real) for name, x in each.items()}


def of_elbow() -> dict[str, Any]:
    """The inputs of the elbow alone."""
    return {name: x[:, 1] if np.ndim(x) == 2 else x for name, x in logged().items()} | textbook()


def taken(function: Any) -> list[str]:
    """The names of its inputs."""
    return [name for name in inspect.signature(function).parameters if name not in {"parameters", "out"}]


def called(module: ModuleType, name: str, given: dict[str, Any]) -> np.ndarray:
    """The values of a function."""
    function = getattr(module, name)
    return function(*(given[x] for x in taken(function)))


def followed(module: ModuleType, given: dict[str, Any]) -> dict[str, Any]:
    """The inputs with the hidden states along the log, if there are any."""
    if not hasattr(module, "STATES"):
        return given
    states = called(module, "follow_states", given)
    return given | dict(zip(module.STATES, states.T, strict=True))


def torques(name: str) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Friction of the elbow and the torque of its motor, in the arm and of the elbow alone."""
    found = emitted(name)
    arm, elbow = followed(found.arm, of_arm()), followed(found.joint, of_elbow())
    pairs = {
        function: (called(found.arm, function, arm)[:, 1], called(found.joint, function, elbow))
        for function in ("mechanical_friction_torque", "friction_torque")
    }
    alone = VALUES["k_i"] * called(found.joint, "current", elbow)
    return pairs | {"motor_torque": (called(found.arm, "motor_torque", arm)[:, 1], alone)}


def some(few: tuple[str, ...]) -> list[Any]:
    """These effects, and the rest of `FEW` among the slow tests."""
    return [name if name in few else pytest.param(name, marks=pytest.mark.slow) for name in FEW]


QUICK = ("stribeck[d=2]", "viscosity_temperature", "hidden_thermal_drift")
IN_C = {"stribeck[d=2]": "double", "hidden_thermal_drift": "float"}
"""What `make test` has."""


@pytest.mark.parametrize("name", some(QUICK))
def test_the_elbow_is_that_of_its_own_model(name: str) -> None:
    """With the loads and torques of the textbook."""
    for function, (in_arm, alone) in torques(name).items():
        np.testing.assert_allclose(in_arm, alone, 1e-9, 1e-11, err_msg=function)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(set(effects()) - set(FEW)))
def test_every_effect_is_that_of_its_own_model(name: str) -> None:
    """The whole library."""
    for function, (in_arm, alone) in torques(name).items():
        np.testing.assert_allclose(in_arm, alone, 1e-9, 1e-11, err_msg=function)


@pytest.mark.parametrize("name", ["stribeck[d=2]", pytest.param("cogging[n=3]", marks=pytest.mark.slow)])
def test_the_shoulder_keeps_its_own_friction(name: str) -> None:
    """C_m sgn w + B_m w and by the normal force, written out."""
    found, w = emitted(name), MOVED.w[:, 0] / MU[0]
    force = MU[0] * MOVED.F_N[:, 0]
    expected = (VALUES["C_m"] + VALUES["C_lN"] * force) * np.sign(w)
    expected += (VALUES["B_m"] + MU[0] * VALUES["B_lN"] * force) * w

    np.testing.assert_allclose(
        called(found.arm, "mechanical_friction_torque", of_arm())[:, 0], expected, 1e-9, 1e-11
    )


def test_a_letter_of_the_recursion_is_free_for_an_effect() -> None:
    """T_1 is what the gear of joint 1 passes on, and stays that; the effect's own T has another name."""
    size = quantity("T", "N m", "Coulomb friction of a seal", "", "nonnegative", "0.02")
    basis = Sgn(v.omega_m.symbol)
    seal = Term("seal", "friction", size.symbol, basis, "a test", role=Role.COULOMB)
    plain = [with_values(joint_model("joint", "A joint"), VALUES | {"mu": mu}, "joint") for mu in MU]
    sealed = extended(plain[1], Extension("seal", Change({"mechanical": (seal,)}), (size,)))
    model = in_an_arm(BODIES, [plain[0], sealed], "extended", "A planar arm")
    arm = executed(render(model, "a test", "a test", ("numpy",)), "extended")
    given = of_arm()
    motion = [given[name] for name in taken(arm.mechanical_friction_torque)]
    added = arm.mechanical_friction_torque(*motion)
    added = added - arm.mechanical_friction_torque(*motion, arm.Parameters(effect_T_1=0.0))
    without = emitted("stribeck[d=2]").arm

    assert 0.02 == arm.Parameters().effect_T_1
    assert arm.BEARING_LOADS == without.BEARING_LOADS
    np.testing.assert_array_equal(
        called(arm, "bearing_loads", given), called(without, "bearing_loads", given)
    )
    np.testing.assert_allclose(added[:, 1], 0.02 * np.sign(MOVED.w[:, 1]), 1e-9, 1e-12)


def test_an_effect_of_the_circuit_alone_leaves_no_trace() -> None:
    """No function of an arm has a voltage: neither its hidden state nor its parameter is there."""
    model = with_effect("resistance_temperature[hidden]")[0]

    assert () == tuple(model.states)
    assert "resistance_rise_1" not in {q.name for q in model.parameters}


@pytest.mark.parametrize("name", some(QUICK))
def test_friction_is_its_regressor_times_coefficients(name: str) -> None:
    """Every column belongs to the joint that its label names."""
    found = emitted(name)
    given, p = followed(found.arm, of_arm()), found.arm.Parameters()
    columns = called(found.arm, "regressor", given) * [getattr(p, label) for label in found.arm.REGRESSOR]
    joints = np.array([int(label.rpartition("_")[2]) for label in found.arm.REGRESSOR])
    expected = np.stack([columns[:, joints == j].sum(1) for j in (0, 1)], 1)
    actual = called(found.arm, "mechanical_friction_torque", given)

    np.testing.assert_allclose(actual, expected, 1e-9, 1e-12)


@pytest.mark.parametrize(
    ("name", "precision"),
    [
        pytest.param(name, precision, marks=() if IN_C.get(name) == precision else pytest.mark.slow)
        for name in FEW
        for precision in REAL
    ],
)
def test_c_is_silent_and_gives_what_numpy_does(name: str, precision: str, tmp_path: Path) -> None:
    """Every function, sample by sample, hidden states stepped by the C itself."""
    found, real = emitted(name), REAL[precision]
    number = ctypes.c_double if precision == "double" else ctypes.c_float
    for file, text in render(found.model, "a test", "a test", ("c99",)).items():
        (tmp_path / file).write_text(text, encoding="utf-8")
    option = f"-DECCENTRIC_REAL={precision}"
    subprocess.run(["gcc", *STRICT, option, "extended.c", "-o", "e.so", "-lm"], check=True, cwd=tmp_path)
    in_cpp = ["g++", "-Wall", "-Wextra", "-Werror", option, "-x", "c++", "-fsyntax-only", "extended.h"]
    subprocess.run(in_cpp, check=True, cwd=tmp_path)
    library = ctypes.CDLL(str(tmp_path / "e.so"))
    coefficients = ctypes.byref(ctypes.c_char.in_dll(library, f"extended_default_{precision}"))
    given, states = of_arm(real), getattr(found.arm, "STATES", ())
    state = (number * max(len(states), 1))()

    def argument(name: str, k: int) -> Any:
        if name in states:
            return number(state[states.index(name)])
        x = given[name][k] if given[name].ndim else given[name]
        if not x.ndim:
            return number(float(x))
        return np.ascontiguousarray(x).ctypes.data_as(ctypes.c_void_p)

    names = [x for x in found.arm.__all__ if x.islower() and x != "follow_states"]
    along = followed(found.arm, {x: v.astype(np.float64) for x, v in given.items()})
    actual = {x: np.empty((len(T), np.shape(called(found.arm, x, along))[-1]), real) for x in names}
    for k in range(len(T)):
        for x in names:
            out = actual[x][k].ctypes.data_as(ctypes.c_void_p)
            arguments = [argument(one, k) for one in taken(getattr(found.arm, x))]
            getattr(library, f"extended_{x}_{precision}")(*arguments, out, coefficients)
        if states:
            inputs = [x for x in taken(found.arm.follow_states) if x != "parameters"]
            step = getattr(library, f"extended_step_{precision}")
            step(ctypes.byref(state), *(argument(x, k) for x in inputs), coefficients)
    for x in names:
        expected = called(found.arm, x, along)
        near = 1e-12 if precision == "double" else 2e-5
        scale = np.max(np.abs(expected), initial=1.0)
        np.testing.assert_allclose(actual[x], expected, 0, near * scale, err_msg=x)


@pytest.mark.parametrize("name", some(("viscosity_temperature",)))
def test_the_selftest_holds(name: str, tmp_path: Path) -> None:
    """With an exponential, and with an input beside the motion; there is none with states or time."""
    model = emitted(name).model
    files = complete(model, "a test", "a test")
    for file, text in files.items():
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_text(text, encoding="utf-8")

    if model.states or name == "wear_runin":
        assert not [file for file in files if file.startswith("check/")]
        return
    own = [] if "exp(" in files["extended.c"] else ["extended.c"]
    for precision in REAL:
        option = f"-DECCENTRIC_REAL={precision}"
        command = ["gcc", "-std=c99", "-O2", option, "-I.", "check/extended_selftest.c", *own]
        subprocess.run([*command, "-o", "selftest", "-lm"], check=True, cwd=tmp_path)
        done = subprocess.run(["./selftest"], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (0, "") == (done.returncode, done.stderr), done.stdout
