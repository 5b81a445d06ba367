"""The compiled module of an arm: the bits, shapes and refusals of its NumPy module."""

from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import eccentric
from eccentric.emission import executed
from tests.import_graph import ROOT

ARM = ROOT / "examples" / "arms" / "planar_2r.toml"
rng = np.random.default_rng(41)
MOTION = [rng.normal(size=(4, 3, 2)) * scale for scale in (20, 30, 50)]


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    """The shipped arm of two joints, built by the local compiler."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        return eccentric.compile(ARM)


@pytest.fixture(scope="module")
def emitted(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    """Its NumPy module."""
    paths = eccentric.emit(ARM, tmp_path_factory.mktemp("arm") / "out", backend="numpy")
    return executed({path.name: path.read_text(encoding="utf-8") for path in paths}, "planar_2r")


def names(module: ModuleType) -> list[str]:
    """Its functions."""
    return [name for name in module.__all__ if name.islower()]


@pytest.mark.parametrize("real", [np.float32, np.float64])
def test_bits_and_shapes_are_those_of_numpy(compiled: ModuleType, emitted: ModuleType, real: type) -> None:
    """All functions, on one sample, on rows, on two axes of samples and on strided ones, with parameters."""
    values = {"payload_mass": 0.8, "C_lN_0": 0.01, "B_m_1": 0.002}
    for name in names(emitted):
        ours, theirs = getattr(compiled, name), getattr(emitted, name)
        for part in (np.s_[1, 1], np.s_[0], np.s_[:], np.s_[::2, 1:]):
            given = [
                x[part].astype(real)
                for x in MOTION[: 1 if name in {"gravity_torque", "breakaway_torque", "mass_matrix"} else 3]
            ]
            found = ours(*given, compiled.Parameters(**values))

            assert np.array_equal(found, theirs(*given, emitted.Parameters(**values)), equal_nan=True), name
            assert found.dtype == real


def test_samples_broadcast_and_results_go_into_out(compiled: ModuleType, emitted: ModuleType) -> None:
    """One velocity for many angles; lists; an array for the results, or part of one."""
    q, w, a = MOTION[0], [0.5, -2.0], np.zeros(2)
    expected, wide = emitted.motor_torque(q, w, a), np.zeros((4, 3, 4))

    assert np.array_equal(expected, compiled.motor_torque(q, w, a))
    assert compiled.motor_torque(q, w, a, out=wide[..., ::2]) is not None
    assert np.array_equal(expected, wide[..., ::2])


@pytest.mark.parametrize("length", [1, 3])
def test_vectors_of_another_length_are_refused(
    compiled: ModuleType, emitted: ModuleType, length: int
) -> None:
    """Not spread, cut or taken for other joints, by either module."""
    for module in (compiled, emitted):
        with pytest.raises(ValueError, match=rf"^omega_m: expected 2 values .* shape \(4, {length}\)"):
            module.inverse_dynamics(np.zeros((4, 2)), np.zeros((4, length)), np.zeros((4, 2)))
        with pytest.raises(ValueError, match=r"^theta_m: expected 2 values .* shape \(\)"):
            module.gravity_torque(0.5)


def test_an_arm_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    """As by `emit`."""
    with pytest.raises(eccentric.InputError, match=r"no_arm\.toml: no such file"):
        eccentric.compile(tmp_path / "no_arm.toml")
