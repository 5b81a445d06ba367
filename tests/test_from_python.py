"""Pages whose Python blocks run in order, and print what they show."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from eccentric.cli import main
from tests.test_tutorial import first_difference

ROOT = Path(__file__).resolve().parents[1]
BLOCK = re.compile(r"^```(\S+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
MARK = "-- the next block --"
PAGES = {
    "from-python": (),
    "rest": ("emit c2_parallel --backend numpy --backend jax --out out",),
    "jax": (
        "emit c2_parallel --backend jax --out out",
        f"emit {ROOT / 'examples/arms/planar_2r.toml'} --backend jax --out out",
    ),
}
"""The commands that each begins with."""


def steps(page: str) -> list[tuple[str, str]]:
    """Each block of Python with the output shown below it, "" where there is none."""
    found: list[tuple[str, str]] = []
    for kind, text in BLOCK.findall((ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")):
        if kind == "python":
            found.append((text, ""))
        elif kind == "text":
            assert found[-1][1] == "", "an output follows its block"
            found[-1] = (found[-1][0], text)
    return found


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES)
def test_the_blocks_print_what_the_page_shows(page: str, tmp_path: Path) -> None:
    """One process runs all of them, in a folder of its own; words are the same, numbers to 2 %."""
    if shutil.which("cc") is None:
        pytest.skip("not installed: cc")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path)
        assert {main(command.split()) for command in PAGES[page]} <= {0}
    shown = steps(page)
    script = "".join(f"{code}\nprint({MARK!r})\n" for code, _ in shown)
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path / "cache"), "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, *(["-W", "error"] if page == "from-python" else []), "-c", script],
        cwd=tmp_path / "out" if PAGES[page] else tmp_path, env=environment | {"MPLBACKEND": "agg"},
        capture_output=True, text=True, check=False,
    )  # fmt: skip

    assert (0, "") == (done.returncode, done.stderr)
    printed = done.stdout.split(f"{MARK}\n")[:-1]
    assert len(shown) == len(printed)
    for (code, expected), actual in zip(shown, printed, strict=True):
        assert first_difference(expected, actual) is None, f"{code}\n{actual}"
    for name in ("fit.png", "report.html", "firmware/arm.c") if page == "from-python" else ():
        assert (tmp_path / name).stat().st_size > 1000, name
