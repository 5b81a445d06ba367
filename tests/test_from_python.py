"""The page that goes from an array to C: its blocks run in order, and print what it shows."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.test_tutorial import first_difference

pytestmark = pytest.mark.slow

PAGE = Path(__file__).resolve().parents[1] / "docs" / "from-python.md"
BLOCK = re.compile(r"^```(\S+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
MARK = "-- the next block --"


def steps() -> list[tuple[str, str]]:
    """Each block of Python with the output shown below it, "" where there is none."""
    found: list[tuple[str, str]] = []
    for kind, text in BLOCK.findall(PAGE.read_text(encoding="utf-8")):
        if kind == "python":
            found.append((text, ""))
        else:
            assert (kind, found[-1][1]) == ("text", ""), "an output follows its block"
            found[-1] = (found[-1][0], text)
    return found


def test_the_blocks_print_what_the_page_shows(tmp_path: Path) -> None:
    """One process runs all of them, in a folder of its own; words are the same, numbers to 2 %."""
    if shutil.which("cc") is None:
        pytest.skip("not installed: cc")
    shown = steps()
    script = "".join(f"{code}\nprint({MARK!r})\n" for code, _ in shown)
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path / "cache"), "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", script],
        cwd=tmp_path, env=environment | {"MPLBACKEND": "agg"}, capture_output=True, text=True, check=False,
    )  # fmt: skip

    assert (0, "") == (done.returncode, done.stderr)
    printed = done.stdout.split(f"{MARK}\n")[:-1]
    assert len(shown) == len(printed)
    for (code, expected), actual in zip(shown, printed, strict=True):
        assert first_difference(expected, actual) is None, f"{code}\n{actual}"
    for name in ("fit.png", "report.html", "firmware/arm.c"):
        assert (tmp_path / name).stat().st_size > 1000, name
