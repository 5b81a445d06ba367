"""A run writes into its own folder and nowhere else, and an interrupted one leaves nothing half written."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from eccentric import DiagnosisResult
from eccentric.cli import main
from eccentric.core import whole_folder

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture
def inputs(tmp_path: Path) -> tuple[Path, Path]:
    """Copies of the bundled log and its rig."""
    folder = ROOT / "examples" / "bench"
    log, rig = (shutil.copy(folder / name, tmp_path) for name in ("bench.csv.gz", "bench.json"))
    return Path(log), Path(rig)


def test_a_run_leaves_the_log_as_it_was(inputs: tuple[Path, Path], tmp_path: Path) -> None:
    """A fit writes beside the log and the rig, and into neither."""
    log, rig = inputs
    before = [(path.read_bytes(), path.stat().st_mtime_ns) for path in inputs]
    assert main(["fit", str(log), "--rig", str(rig), "--out", str(tmp_path / "out")]) == 0
    assert [(path.read_bytes(), path.stat().st_mtime_ns) for path in inputs] == before


@pytest.mark.parametrize("earlier", [False, True], ids=["new", "earlier result"])
def test_an_interrupt_while_writing_leaves_what_was_there(
    earlier: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An interrupt between two files of a diagnosis leaves no folder, or the one of the run before."""
    out = tmp_path / "out"
    if earlier:
        out.mkdir()
        (out / "report.html").write_text("earlier")
        (out / ".eccentric").write_text("notice\ndiagnose: report.html\n")

    def interrupted(_: object, folder: Path) -> None:
        (folder / "report.html").write_text("half")
        raise KeyboardInterrupt

    found = DiagnosisResult.__new__(DiagnosisResult)
    monkeypatch.setattr("eccentric.diagnose", lambda *_, **__: found)
    monkeypatch.setattr(DiagnosisResult, "fill", interrupted)
    assert main(["diagnose", "log.csv", "--rig", "rig.json", "--out", str(out)]) == 130
    assert [path.name for path in tmp_path.iterdir()] == (["out"] if earlier else [])
    if earlier:
        assert (out / "report.html").read_text() == "earlier"
        assert sorted(path.name for path in out.iterdir()) == [".eccentric", "report.html"]


@pytest.mark.parametrize("earlier", [False, True], ids=["new", "earlier result"])
def test_an_interrupt_as_the_temporary_folder_is_made_leaves_none(
    earlier: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The folder is on the disk, the statement that made it not yet over."""
    out, make = tmp_path / "out", os.mkdir
    if earlier:
        out.mkdir()
    there = sorted(tmp_path.rglob("*"))

    def interrupted(path: str | os.PathLike[str], *others: int) -> None:
        make(path, *others)
        if Path(path).name.startswith(".eccentric-"):
            raise KeyboardInterrupt

    monkeypatch.setattr("os.mkdir", interrupted)
    with pytest.raises(KeyboardInterrupt), whole_folder(out, "fit"):
        pass
    assert sorted(tmp_path.rglob("*")) == there


AT_THE_LAST_STEP = """
import os, sys, time
from eccentric.cli import main

rename = os.rename

def late(source, target, **named):
    if str(target) == sys.argv[-1]:
        print("now", flush=True)
        time.sleep(60)
    rename(source, target, **named)

os.rename = late
sys.exit(main())
"""
"""The command, which waits before the folder of its result gets its name."""


@pytest.mark.skipif(os.name != "posix", reason="signals are those of POSIX")
def test_an_interrupted_process_leaves_no_folder(tmp_path: Path) -> None:
    """Ctrl-C at the moment when a result is being written: status 130, and nothing of it is left."""
    command = ["emit", "c1_perpendicular", "--backend", "numpy", "--out", tmp_path / "out"]
    process = subprocess.Popen(
        [sys.executable, "-c", AT_THE_LAST_STEP, *map(str, command)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT,
    )  # fmt: skip
    assert process.stdout is not None
    for line in process.stdout:
        if line == "now\n":
            process.send_signal(signal.SIGINT)
            break
    _, error = process.communicate(timeout=60)
    assert (process.returncode, error) == (130, "eccentric: interrupted\n")
    assert [*tmp_path.iterdir()] == []
