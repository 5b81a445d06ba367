"""The teaching pages are correct: their files are written, their commands run, their output compared."""

from __future__ import annotations

import gzip
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGES = (
    pytest.param("tutorial", marks=pytest.mark.slow),
    pytest.param("tutorial-raw", marks=pytest.mark.slow),
    pytest.param("own-effect", marks=pytest.mark.slow),
    pytest.param("linear-axes", marks=pytest.mark.slow),
    pytest.param("own-derivation", marks=pytest.mark.slow),
    pytest.param("simulate", marks=pytest.mark.slow),
)
BLOCK = re.compile(r"^```(\S+)(?: (\S+))?\n(.*?)^```$", re.DOTALL | re.MULTILINE)
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]\d+)?")
MARK = "-- the next command --"
# The one block that is not run here: it installs what this test runs on.
INSTALL = "make\n. .venv/bin/activate\n"


def blocks(page: str) -> list[tuple[str, str]]:
    """Kind and text of the fenced blocks of a page; the kind of a file is its name."""
    found = []
    for fence, _, text in BLOCK.findall((ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")):
        caption = re.match(r":caption: (\S+)\n\n", text)
        found.append((caption[1], text[caption.end() :]) if caption else (fence, text))
    return found


def commands(kind: str, text: str) -> list[tuple[str, str]]:
    """The commands of a block, each with the output that the page shows below it."""
    if kind == "bash":
        return [(line, "...") for line in text.splitlines()]
    head, *rest = re.split(r"^\$ ", text, flags=re.MULTILINE)
    assert head == "", f"a console block begins with a command, not with {head!r}"
    return [(part.split("\n", 1)[0], part.split("\n", 1)[1]) for part in rest]


def outputs(script: list[str], folder: Path) -> list[str]:
    """Run the commands one after the other in one shell; return what each printed."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    lines = ["set -e", *(line for command in script for line in (command, f"echo '{MARK}'"))]
    done = subprocess.run(
        ["bash", "-c", "\n".join(lines)],
        cwd=folder,
        env=os.environ | {"PATH": path, "OMP_NUM_THREADS": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout
    return done.stdout.split(f"{MARK}\n")[:-1]


def agree(shown: str, real: str) -> bool:
    """Whether two lines are the same: the words exactly, numbers to 2 %, which other computers may round."""
    if NUMBER.sub("#", shown) != NUMBER.sub("#", real):
        return False
    pairs = zip(NUMBER.findall(shown), NUMBER.findall(real), strict=True)
    return all(float(a) == pytest.approx(float(b), rel=0.02) for a, b in pairs)


def first_difference(shown: str, real: str) -> str | None:
    """The first line of the page that the output does not have in its place; "..." means any lines."""
    left, skipped = real.splitlines(), False
    for line in shown.splitlines():
        if line == "...":
            skipped = True
            continue
        place = next((k for k, one in enumerate(left) if agree(line, one)), None)
        if place is None or (place > 0 and not skipped):
            return line
        left, skipped = left[place + 1 :], False
    return left[0] if left and not skipped else None


@pytest.mark.parametrize("page", PAGES)
def test_the_commands_of_the_page_run_as_printed(page: str, tmp_path: Path) -> None:
    """Files are written as the page shows them, commands run in order, the output shown is the real one."""
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    script, shown = [], []
    for kind, text in blocks(page):
        if kind in {"console", "bash"}:
            for command, output in commands(kind, text):
                script.append(command)
                shown.append(output)
        elif "." in kind:
            script.append(f"cat > {kind} <<'END OF {kind}'\n{text}END OF {kind}")
            shown.append("")
        else:
            assert (kind, text) == ("sh", INSTALL)

    real = outputs(script, tmp_path)

    assert len(script) == len(real) > 0
    for command, expected, actual in zip(script, shown, real, strict=True):
        assert first_difference(expected, actual) is None, f"$ {command}\n{actual}"


def test_the_comparison_sees_a_difference() -> None:
    """Another word, a number off by more than 2 %, a line too many or too few: each is found."""
    real = "a 1.00\nb 2\nc\n"
    for same in (real, "a 1.01\n...\n", "...\nc\n", "...\nb 2\n...\n"):
        assert first_difference(same, real) is None
    for other in ("a 1.03\nb 2\nc\n", "b 2\nc\n", "a 1.00\nb 2\n", "a 1.00\nc\n", "...\nd\n", "c\n...\n", ""):
        assert first_difference(other, real) is not None


def test_the_rig_of_the_tutorial_is_the_one_in_examples() -> None:
    """examples/tutorial/arm.toml is the file that the tutorial has one write."""
    assert dict(blocks("tutorial"))["arm.toml"] == (ROOT / "examples/tutorial/arm.toml").read_text("utf-8")


def test_the_log_of_the_tutorial_can_be_made_again(tmp_path: Path) -> None:
    """examples/tutorial/make_log.py writes the log that is there."""
    outputs([f"python {ROOT / 'examples/tutorial/make_log.py'}"], tmp_path)
    again, there = (path / "arm.csv.gz" for path in (tmp_path, ROOT / "examples" / "tutorial"))

    assert gzip.decompress(there.read_bytes()) == gzip.decompress(again.read_bytes())
