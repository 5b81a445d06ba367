"""The firmware example, built from its own Makefile and run under QEMU."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.cortex_m4 import TOOLS, missing

ROOT = Path(__file__).resolve().parent.parent
FIRMWARE = ROOT / "examples" / "firmware"


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> subprocess.CompletedProcess[str]:
    """Build the firmware without a warning and run it."""
    if absent := missing((*TOOLS, "make")):
        pytest.skip(f"not installed: {', '.join(absent)}")
    folder = tmp_path_factory.mktemp("firmware")
    places = [f"BUILD={folder}", f"MODEL={folder / 'model'}", f"ECCENTRIC={sys.executable} -m eccentric"]
    return subprocess.run(
        ["make", "-s", "-C", str(FIRMWARE), *places, "run"],
        env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip


def test_friction_compensation_reduces_the_tracking_error(ran: subprocess.CompletedProcess[str]) -> None:
    """Swing and creep are tracked at least five times as well, and at rest it adds nothing to the torque."""
    lines = re.findall(r"^(\w+ \w+) +([\d.]+) +([\d.]+) +([\d.]+)$", ran.stdout + ran.stderr, re.MULTILINE)
    found = {name: [float(x) for x in numbers] for name, *numbers in lines}

    assert 0 == ran.returncode
    assert list(found) == ["no compensation", "measured velocity", "reference velocity"]
    none, measured, reference = found.values()
    assert 0 < 5 * reference[0] <= none[0]
    assert 0 < 5 * reference[1] <= none[1]
    assert reference[2] == none[2]
    assert measured[2] > 5 * none[2]


def test_readme_shows_what_it_prints(ran: subprocess.CompletedProcess[str]) -> None:
    """What the README shows is what the firmware prints, letter by letter."""
    readme = (FIRMWARE / "README.md").read_text(encoding="utf-8")

    assert f"```\n{ran.stdout}{ran.stderr}```" in readme


FIT, MY_LOOP = "../../build/my_fit/fit.json", "../../build/my_loop"
EMIT = f"eccentric emit c2_parallel --parameters {FIT} --compensation --out {MY_LOOP}"
RUN = "make run GENERATED=../../build/my_loop"
RENAME = "sed -i 's/c2_parallel/my_arm/g' Makefile *.c *.h"
# An arm twice as heavy on a stronger drive, with other friction: nothing of it is the paper's.
ARM = {
    "M": 1.0, "M_l": 0.3, "L": 0.3, "mu": 0.25, "R": 1.0, "k_i": 0.06, "k_e": 0.06, "J_m": 2e-4, "J_l": 0.12,
    "B_lN": 0.005, "C_lN": 0.07, "B_m": 8e-4, "C_m": 0.03,
}  # fmt: skip


@pytest.fixture
def own(tmp_path: Path) -> Path:
    """Return a copy of the example in a tree of its own, with a fit beside it."""
    if absent := missing((*TOOLS, "make", "sed")):
        pytest.skip(f"not installed: {', '.join(absent)}")
    folder = tmp_path / "examples" / "firmware"
    shutil.copytree(FIRMWARE, folder)
    (tmp_path / "build" / "my_fit").mkdir(parents=True)
    (tmp_path / "build" / "my_fit" / "fit.json").write_text(json.dumps({"parameters": ARM}), encoding="utf-8")
    return folder


def shell(folder: Path, *commands: str) -> subprocess.CompletedProcess[str]:
    """Run commands one after the other in the folder, up to the first that fails."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    return subprocess.run(
        ["sh", "-ec", "\n".join(commands)], cwd=folder,
        env=os.environ | {"PATH": path, "PYTHONPATH": str(ROOT), "ECCENTRIC": "eccentric"},
        capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip


@pytest.mark.parametrize(
    "renamed", [pytest.param(False, id="as it is"), pytest.param(True, id="by another name")]
)
@pytest.mark.slow
def test_the_arm_of_a_fit(own: Path, renamed: bool) -> None:
    """By the README's commands the firmware runs with the parameters of a fit, under any name."""
    readme = (FIRMWARE / "README.md").read_text(encoding="utf-8")
    assert f"```\n{EMIT}\n{RUN}\n```" in readme
    assert f"`{RENAME}`" in readme
    prefixed = [f"{EMIT} --prefix my_arm", RENAME, RUN]

    done = shell(own, *(prefixed if renamed else [EMIT, RUN]))

    assert 0 == done.returncode, done.stdout + done.stderr


@pytest.mark.slow
def test_a_failure_says_why(own: Path) -> None:
    """A drive with twice the friction of the emitted model is reported, with a hint where to look."""
    drive = (own / "drive.c").read_text(encoding="utf-8")
    (own / "drive.c").write_text(drive.replace("TRUE_C_lN 0.95f", "TRUE_C_lN 1.9f"), encoding="utf-8")

    done = shell(own, "make run")

    assert 0 != done.returncode
    assert "failed: the compensation gains less than a factor of 5." in done.stdout + done.stderr
    assert "is not the one that c2_parallel was emitted for" in done.stdout + done.stderr
