"""The firmware example, built from its own Makefile and run under QEMU."""

import re
import subprocess
from pathlib import Path

import pytest

from benchmarks.cortex_m4 import TOOLS, missing

FIRMWARE = Path(__file__).resolve().parent.parent / "examples" / "firmware"


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> subprocess.CompletedProcess[str]:
    """Build the firmware without a warning and run it."""
    if absent := missing((*TOOLS, "make")):
        pytest.skip(f"not installed: {', '.join(absent)}")
    command = ["make", "-s", "-C", str(FIRMWARE), f"BUILD={tmp_path_factory.mktemp('firmware')}", "run"]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)


def test_friction_compensation_reduces_the_tracking_error(ran: subprocess.CompletedProcess[str]) -> None:
    """The firmware says so by its status, and the error it prints is at most a fifth with compensation."""
    errors = [float(x) for x in re.findall(r"compensation: +(\d+\.\d+) mrad rms", ran.stdout + ran.stderr)]

    assert 0 == ran.returncode
    assert 2 == len(errors)
    assert 0 < 5 * errors[1] <= errors[0]


def test_readme_shows_what_it_prints(ran: subprocess.CompletedProcess[str]) -> None:
    """What the README shows is what the firmware prints, letter by letter."""
    readme = (FIRMWARE / "README.md").read_text(encoding="utf-8")

    assert f"```\n{ran.stdout}{ran.stderr}```" in readme
