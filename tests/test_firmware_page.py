"""docs/firmware.md and the head comments that it points to: their commands run as printed."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from eccentric.emission import render_check
from tests import extended

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs" / "firmware.md").read_text(encoding="utf-8")
BLOCKS = [
    block for block in re.findall(r"^```\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE) if "cc " in block
]


def shell(command: str, folder: Path) -> str:
    """Run a command in the folder; return what it prints."""
    if shutil.which("gcc") is None or shutil.which("cc") is None:
        pytest.skip("not installed: gcc, cc")
    done = subprocess.run(
        ["sh", "-ec", command], cwd=folder, env=os.environ, capture_output=True, text=True, check=False
    )
    assert (0, "") == (done.returncode, done.stderr)
    return done.stdout


@pytest.mark.parametrize("block", BLOCKS, ids=["compile", "self-test"])
def test_commands_of_the_page(tmp_path: Path, block: str) -> None:
    """From the root of the clone each block runs; the self-test says that it holds."""
    shutil.copytree(ROOT / "generated", tmp_path / "generated")
    (tmp_path / "build").mkdir()

    said = shell(block, tmp_path)

    assert ("c2_parallel: ok" in said) == ("selftest" in block)


def test_a_self_test_with_an_exponential(tmp_path: Path) -> None:
    """The page has the command of its head comment, which runs in the folder `check`."""
    one = extended.with_effect("C2", "hidden_thermal_drift")
    name = one.model.name
    for file, text in (one.texts | render_check(one.model, one.texts)).items():
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_text(text, encoding="utf-8")
    head = (tmp_path / "check" / f"{name}_selftest.c").read_text(encoding="utf-8").split("*/")[0]
    (command,) = re.findall(r"^ \*   (cc .*? -lm)\b", head, re.MULTILINE)

    assert command.replace(name, "NAME") in PAGE
    assert f"{name}: ok" in shell(f"{command} && ./a.out", tmp_path / "check")


def test_the_range_of_the_page_is_that_of_the_driver() -> None:
    """The option by which a proof gets ranges of one's own is the same there, where another test runs it."""
    driver = (ROOT / "generated" / "check" / "c2_parallel_proof.c").read_text(encoding="utf-8")
    (option,) = re.findall(r"-DRANGE_\S+$", driver, re.MULTILINE)

    assert f'-I.. {option}"' in PAGE
