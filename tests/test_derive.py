"""`eccentric derive`: what it prints is read from top to bottom."""

import contextlib
import io
import re
from pathlib import Path

import pytest

from eccentric.cli import main


def derived(folder: Path, *arguments: str) -> str:
    """What `eccentric derive` prints that writes into a folder `out` there."""
    printed = io.StringIO()
    with contextlib.chdir(folder), contextlib.redirect_stdout(printed):
        assert 0 == main(["derive", *arguments, "--out", "out"])
    return printed.getvalue()


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Derive the two models that have every such function; return what is printed."""
    return derived(tmp_path_factory.mktemp("derive"), "c1_perpendicular", "rotating_link")


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
    assert printed.splitlines()[-1].startswith("out/: 2 models, ")

    latex = derived(tmp_path, "c1_perpendicular", "--latex")
    files = [path for path in (tmp_path / "out").rglob("*") if path.is_file()]

    assert latex.startswith(r"\section*")
    assert f"% out/: 1 model, {len(files)} files" == latex.splitlines()[-1]
