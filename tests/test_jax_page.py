"""The page of the JAX module: its blocks print what it shows, and its count of lines is right."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from eccentric.cli import main
from tests.test_tutorial import first_difference

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs" / "jax.md").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_blocks_print_what_the_page_shows(tmp_path: Path) -> None:
    """Run in order beside the emitted files, they print the numbers below them."""
    for model in ("c2_parallel", str(ROOT / "examples/arms/planar_2r.toml")):
        assert 0 == main(["emit", model, "--backend", "jax", "--out", str(tmp_path / "out")])
    blocks = re.findall(r"^```python\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    shown = re.findall(r"^```text\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    run = subprocess.run(
        [sys.executable, "-c", "".join(blocks)],
        cwd=tmp_path / "out",
        capture_output=True,
        text=True,
        check=False,
    )

    assert "" == run.stderr
    assert None is first_difference("".join(shown), run.stdout)


def test_the_back_end_has_as_many_lines_as_the_page_says() -> None:
    """Code, templates, and the line that registers it."""
    files = [*(ROOT / "eccentric/emission/backends/jax").glob("*.py"), *(ROOT / "templates/jax").iterdir()]
    count = sum(len(file.read_text(encoding="utf-8").splitlines()) for file in files) + 1

    assert [str(count)] == re.findall(r"(\d+) lines in all", PAGE)
