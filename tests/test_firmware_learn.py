"""The learning firmware: a drive whose grease warms over ten million samples, 90 % of them at rest."""

import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.asked import CODE
from benchmarks.cortex_m4 import TOOLS, missing
from tests.learning import FIRMWARE, SAMPLES, errors, learned

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def on_a_computer(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, np.ndarray, Any]:
    """Return what the firmware says on a computer, its rows, and the emitted Python."""
    return learned(tmp_path_factory.mktemp("learning"))


def test_it_learns_as_well_as_a_fit(on_a_computer: Any) -> None:
    """Errors are at most twice those of weighted least squares over the same forgetting window."""
    error, least = errors(*on_a_computer[1:])

    print("rms error of the coefficients, learned and fitted:", error, least)
    assert CODE["learned"].reached(float(np.max(error / least)))


def test_the_grease_warms(on_a_computer: Any) -> None:
    """The drive is what is said of it: viscous friction falls to less than 0.4, and it rests for 90 %."""
    _, rows, _ = on_a_computer
    viscous = rows["real"][:, 0]

    assert np.min(viscous) < 0.4 * viscous[0]
    assert np.count_nonzero(rows["sample"] < SAMPLES) < 0.1 * SAMPLES


@pytest.fixture(scope="module")
def under_qemu(tmp_path_factory: pytest.TempPathFactory) -> subprocess.CompletedProcess[str]:
    """Build the firmware without a warning and run it on a Cortex-M4F."""
    if absent := missing((*TOOLS, "make")):
        pytest.skip(f"not installed: {', '.join(absent)}")
    folder = tmp_path_factory.mktemp("firmware")
    places = [
        f"BUILD={folder / 'build'}",
        f"LEARNING={folder / 'learning'}",
        f"ECCENTRIC={eccentric_command()}",
    ]
    command = ["make", "-s", "-C", str(FIRMWARE), *places, "learn"]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)


def eccentric_command() -> str:
    """Return the command beside this Python."""
    import sys

    return str(Path(sys.executable).with_name("eccentric"))


def test_on_the_target(under_qemu: Any, on_a_computer: Any) -> None:
    """No number breaks, one false alarm at most, the step is announced; it learns as on a computer."""
    said = under_qemu.stdout + under_qemu.stderr
    assert 0 == under_qemu.returncode, said
    ((alarms, broken),) = re.findall(r"(\d+) false alarms, (\d+) numbers that are not finite", said)
    ((announced),) = re.findall(r"announced after (\d+) samples in motion", said)
    assert CODE["false alarms of friction"].reached(int(alarms))
    assert CODE["broken"].reached(int(broken))
    assert 0 < int(announced) < 100

    def at(text: str, sample: int) -> np.ndarray:
        (line,) = re.findall(rf"^{sample}: (.*)$", text, re.MULTILINE)
        return np.array([float(x.split("/")[0]) for x in line.split(", ")])

    # Sine and cosine of the simulated drive are of another library: the same motion, not the same bits.
    np.testing.assert_allclose(at(said, 1_000_000), at(on_a_computer[0], 1_000_000), rtol=0.1, atol=30)


def test_readme_shows_what_it_prints(under_qemu: Any) -> None:
    """The last lines are those of the README."""
    readme = (FIRMWARE / "README.md").read_text(encoding="utf-8")
    last = (under_qemu.stdout + under_qemu.stderr).splitlines()[-3:]

    assert "\n".join(last) in readme
