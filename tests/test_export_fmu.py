"""The FMU: FMPy validates, builds and runs it, and it moves as `friction_step` does."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from eccentric.exports import ExportedDrive, export
from tests.exports import BENCH, STEADY, drive, swing_down, written

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed")
pytestmark = pytest.mark.skipif(
    shutil.which("cmake") is None, reason="CMake, by which FMPy builds, is missing"
)


@pytest.fixture(scope="module")
def of() -> ExportedDrive:
    """A fit of the bundled log."""
    return drive("c2_parallel", BENCH)


def built(of: ExportedDrive, folder: Path) -> Path:
    """Return the folder of the FMU, with the library that FMPy built from its sources."""
    from fmpy.build import build_platform_binary

    archive = written(export(of, "fmu").files, folder) / f"{of.name}.fmu"
    unpacked = Path(fmpy.extract(str(archive), str(folder / "unpacked")))
    (folder / "build").mkdir()
    build_platform_binary(unpacked, folder / "build")
    return unpacked


@pytest.fixture(scope="module")
def unpacked(of: ExportedDrive, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the built FMU."""
    return built(of, tmp_path_factory.mktemp("fmu"))


@pytest.fixture(scope="module")
def run(unpacked: Path) -> Callable[..., Any]:
    """Simulate the built FMU."""
    return lambda **more: fmpy.simulate_fmu(
        str(unpacked),
        output=["theta_m", "omega_m", "friction"],
        **{"step_size": 0.01, "output_interval": 0.01, **more},
    )


def test_it_is_valid(of: ExportedDrive, tmp_path: Path) -> None:
    """FMPy finds nothing wrong with the description, and the same export is the same file."""
    from fmpy.validation import validate_fmu

    first, second = (written(export(of, "fmu").files, tmp_path / x) / f"{of.name}.fmu" for x in "ab")

    assert validate_fmu(str(first)) == []
    assert first.read_bytes() == second.read_bytes()


def test_what_friction_holds_stays(run: Callable[..., Any], of: ExportedDrive) -> None:
    """A drive at rest within the levels has not moved after 5 s; friction is what gravity takes, reversed."""
    theta_m = STEADY / of.p.mu
    end = run(stop_time=5.0, start_values={"theta_m": theta_m})[-1]

    assert (end["theta_m"], end["omega_m"]) == (theta_m, 0.0)
    assert end["friction"] == pytest.approx(-float(of.module.gravity_torque(theta_m, of.p)), rel=1e-12)


def test_friction_is_there_before_the_start(of: ExportedDrive, unpacked: Path) -> None:
    """Read in initialisation mode it is that of the first step, for the values that are set by then."""
    description = fmpy.read_model_description(str(unpacked))
    at = {x.name: x.valueReference for x in description.modelVariables}
    unit = fmpy.instantiate_fmu(str(unpacked), description, fmi_type="CoSimulation")
    unit.enterInitializationMode()
    unit.setFloat64([at["theta_m"]], [STEADY / of.p.mu])
    (before,) = unit.getFloat64([at["friction"]])
    unit.exitInitializationMode()
    (after,) = unit.getFloat64([at["friction"]])
    unit.terminate()
    unit.freeInstance()

    assert before == after != 0.0
    assert before == pytest.approx(-float(of.module.gravity_torque(STEADY / of.p.mu, of.p)), rel=1e-12)


def test_it_swings_down_as_friction_step_does(run: Callable[..., Any], of: ExportedDrive) -> None:
    """The same steps in NumPy end at the same angle."""
    end = run(stop_time=6.0, start_values={"theta_m": 2.1 / of.p.mu})[-1]

    assert end["omega_m"] == 0.0
    assert end["theta_m"] * of.p.mu == pytest.approx(swing_down(of, 2.1), abs=1e-9)


def test_a_longer_communication_step_changes_little(run: Callable[..., Any], of: ExportedDrive) -> None:
    """Internal steps are no longer than `step`, whatever the communication step."""
    ends = [
        run(stop_time=6.0, step_size=x, output_interval=x, start_values={"theta_m": 2.1 / of.p.mu})[-1]
        for x in (0.01, 0.3)
    ]

    assert ends[0]["theta_m"] == pytest.approx(ends[1]["theta_m"], abs=1e-9)


def test_parameters_can_be_set(run: Callable[..., Any], of: ExportedDrive) -> None:
    """Without friction and gravity it accelerates by torque over inertia; an invalid parameter is refused."""
    none = dict.fromkeys(("B_lN", "C_lN", "B_m", "C_m", "g"), 0.0)
    torque = 0.01
    signals = _constant("torque", torque)
    end = run(stop_time=1.0, start_values=none, input=signals)[-1]

    inertia = of.p.J_m + of.p.mu**2 * of.p.J_l
    assert end["omega_m"] == pytest.approx(torque / inertia, rel=1e-9)
    with pytest.raises(Exception, match="fmi3ExitInitializationMode"):
        run(stop_time=1.0, start_values={"mu": -1.0})


def _constant(name: str, value: float) -> Any:
    import numpy as np

    return np.array([(0.0, value), (10.0, value)], [("time", float), (name, float)])


def test_friction_that_follows_the_acceleration(tmp_path: Path) -> None:
    """`rotating_link` takes that of the step before: it comes to rest near the drive without it."""
    of = drive("rotating_link", BENCH)
    unpacked = built(of, tmp_path)
    end = fmpy.simulate_fmu(
        str(unpacked),
        stop_time=6.0,
        step_size=0.01,
        start_values={"theta_m": 10.5},
        output=["theta_m", "omega_m"],
    )[-1]
    theta_m, omega_m, alpha_m, dt, p = 10.5, 0.0, 0.0, 1e-4, of.p
    for _ in range(60_000):
        torque = -of.module.gravity_torque(theta_m, p)
        after = float(of.module.friction_step(theta_m, omega_m, alpha_m, torque, dt, p)[0])
        theta_m, omega_m, alpha_m = theta_m + dt * after, after, (after - omega_m) / dt

    assert end["omega_m"] == 0.0
    assert end["theta_m"] == pytest.approx(theta_m, abs=1e-9)
