"""`eccentric derive`: what it prints is read from top to bottom."""

import re
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Derive all models into a folder `out`; return what is printed."""
    done = subprocess.run(
        [sys.executable, "-m", "eccentric", "derive", "--out", "out"],
        cwd=tmp_path_factory.mktemp("derive"), capture_output=True, text=True, check=True,
    )  # fmt: skip
    return done.stdout


def test_functions_are_told_once_and_before_they_stand_in_a_formula(printed: str) -> None:
    """Every function by a name of its own has its plain formula at the head."""
    legend, rest = re.split(r"^Case C1", printed, maxsplit=1, flags=re.MULTILINE)
    told = dict(re.findall(r"^    (\w+)\(.*?\) = (.*)$", legend, re.MULTILINE))

    assert set(re.findall(r"\b[A-Z][a-z]+[A-Z][a-z]+\b", rest)) <= set(told)
    assert all(name in rest for name in told)
    assert "-cos(x*y/2)" == told["HalfCosine"]
    assert "x**2 - y**2" == told["SquareDifference"]
    assert "sqrt(x**2 + y**2)" == told["Magnitude"]


def test_the_last_line_says_what_was_written(printed: str, tmp_path: Path) -> None:
    """Where, how many models and how many files; as a comment where the rest is LaTeX."""
    assert "out/: 5 models, 31 files" == printed.splitlines()[-1]

    latex = subprocess.run(
        [sys.executable, "-m", "eccentric", "derive", "c1_perpendicular", "--latex", "--out", "out"],
        cwd=tmp_path, capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    files = [path for path in (tmp_path / "out").rglob("*") if path.is_file()]

    assert latex.startswith(r"\section*")
    assert f"% out/: 1 model, {len(files)} files" == latex.splitlines()[-1]
