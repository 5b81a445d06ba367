"""The page on simulators: its commands and its block print what it shows."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from eccentric.cli import main
from eccentric.core import EXPORTS
from tests.test_tutorial import first_difference

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs" / "exports.md").read_text(encoding="utf-8")


def test_commands_and_block(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """From the bundled log to a link at rest in MuJoCo; of the fit the page shows nothing."""
    pytest.importorskip("mujoco", reason="MuJoCo (mujoco-core) is not installed")
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    blocks = re.findall(r"^```console\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path)
        for command, shown in re.findall(
            r"^\$ eccentric (.*)\n((?:[^$].*\n)*)", "".join(blocks), re.MULTILINE
        ):
            assert main(command.split()) == 0
            printed = capsys.readouterr().out
            assert not shown or first_difference(shown, printed) is None

    (code,) = re.findall(r"^```python\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    (text,) = re.findall(r"^```text\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    run = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path / "build" / "pendulum",
        env=os.environ | {"PYTHONPATH": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.stderr == ""
    assert first_difference(text, run.stdout) is None


def test_the_page_has_every_target() -> None:
    """The table has the targets of the command, each once."""
    assert sorted(EXPORTS) == sorted(re.findall(r"^\| `(\w+)` \|", PAGE, re.MULTILINE))
