"""`eccentric rig` and `eccentric doctor` at a terminal: files, lines and exit statuses."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from eccentric import cli

BENCH = Path(__file__).resolve().parents[1] / "examples" / "bench"
LOG = str(BENCH / "bench.csv.gz")


def test_a_draft_is_written_and_what_it_lacks_is_listed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """`--out` writes a rig file and says what is still to fill in; `--check` asks for it with status 1."""
    out = tmp_path / "rig.toml"

    assert 0 == cli.main(["rig", LOG, "--out", str(out)])
    assert (
        "still to fill in: M, L, M_l; to diagnose, also R, k_e; preferably also k_i\n"
        in capsys.readouterr().out
    )
    assert "theta_m_rad" == tomllib.loads(out.read_text(encoding="utf-8"))["columns"]["theta_m"]
    assert 1 == cli.main(["rig", LOG, "--check", str(out)])
    assert 3 == len(capsys.readouterr().out.splitlines())


def test_a_file_that_is_there_is_not_replaced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One line and status 2."""
    out = tmp_path / "rig.toml"
    out.write_text("mine")

    assert 2 == cli.main(["rig", LOG, "--out", str(out)])
    assert "expected a new file" in capsys.readouterr().err
    assert "mine" == out.read_text()


def test_the_doctor_names_versions_and_what_is_missing(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A missing package is named with its extra; without one of the core the status is 1."""
    from eccentric.cli import doctor

    absent = {"asammdf", "scipy", "fmpy"}
    monkeypatch.setattr(doctor, "_version", lambda p: None if p in absent else "1.0")

    assert 1 == cli.main(["doctor"])
    said = capsys.readouterr().out
    assert "scipy MISSING" in said
    assert ': asammdf missing: pip install "eccentric[mdf]"' in said
    assert ': mujoco-core 1.0, fmpy missing: pip install "eccentric[exports]"' in said
    assert f"Python {sys.version_info.major}.{sys.version_info.minor}" in said


def test_the_doctor_knows_every_extra_and_its_packages() -> None:
    """As `pyproject.toml` has them; "logs" is several of them, and the others are for work on the project."""
    from eccentric.cli import doctor

    text = (BENCH.parents[1] / "pyproject.toml").read_text(encoding="utf-8")
    extras = tomllib.loads(text)["project"]["optional-dependencies"]

    def packages(extra: str) -> set[str]:
        found = set[str]()
        for required in extras[extra]:
            name, inner = re.findall(r"^([\w-]+)(?:\[(.*)\])?", required)[0]
            found |= set().union(*map(packages, inner.split(","))) if name == "eccentric" else {name.lower()}
        return found

    expected = {
        extra: packages(extra)
        for extra in extras
        if extra not in {"logs", "docs", "test", "lint", "all", "peers-bench"}
    }

    known = doctor._EXTRAS | doctor._of_formats()
    assert {extra: set(names) for extra, (names, _) in known.items()} == expected


@pytest.mark.skipif(sys.platform == "win32", reason="the shell's protocol needs file descriptors")
@pytest.mark.parametrize(
    ("line", "expected"), [("eccentric di", "diagnose"), ("eccentric rig --ch", "--check")]
)
def test_the_shell_completes_commands_and_options(line: str, expected: str, tmp_path: Path) -> None:
    """The protocol of argcomplete: the line in the environment, completions in a file."""
    pytest.importorskip("argcomplete", reason="argcomplete is not installed")
    found = tmp_path / "found"
    environment = os.environ | {
        "_ARGCOMPLETE": "1",
        "_ARGCOMPLETE_STDOUT_FILENAME": str(found),
        "COMP_LINE": line,
        "COMP_POINT": str(len(line)),
        "COMP_TYPE": "9",
    }
    program = "import sys; from eccentric.cli import main; sys.argv = ['eccentric']; main()"
    subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, check=True)

    assert expected == found.read_text().strip()
