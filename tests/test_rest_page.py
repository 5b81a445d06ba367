"""The page on friction at rest: its blocks print what it shows."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from eccentric.cli import main
from tests.test_tutorial import first_difference

PAGE = (Path(__file__).resolve().parents[1] / "docs" / "rest.md").read_text(encoding="utf-8")


def test_the_blocks_print_what_the_page_shows(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Run in order beside the files that its command writes, they print the numbers below them."""
    pytest.importorskip("jax")
    out = tmp_path / "build" / "rest"
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path)
        shown = re.search(r"^\$ eccentric (emit .*)\n(.*)$", PAGE, re.MULTILINE)
        assert shown is not None
        assert main(shown[1].split()) == 0
    assert shown[2] == capsys.readouterr().out.splitlines()[0]

    blocks = re.findall(r"^```python\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    printed = re.findall(r"^```text\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    run = subprocess.run(
        [sys.executable, "-c", "".join(blocks)], cwd=out, capture_output=True, text=True, check=False
    )

    assert run.stderr == ""
    assert first_difference("".join(printed), run.stdout) is None
