"""A run writes into its own folder and nowhere else, and an interrupted one leaves nothing half written."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
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


@pytest.mark.skipif(os.name != "posix", reason="signals are those of POSIX")
def test_an_interrupted_process_leaves_no_folder(inputs: tuple[Path, Path], tmp_path: Path) -> None:
    """Ctrl-C at the moment when a result is being written: status 130, and nothing of it is left."""
    log, rig = inputs
    there = {path.name for path in inputs}
    command = [sys.executable, "-m", "eccentric", "fit", str(log), "--rig", str(rig)]
    status, error = 0, ""
    for attempt in range(25):
        out = tmp_path / f"out{attempt}"
        process = subprocess.Popen(
            [*command, "--out", str(out)],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, cwd=ROOT,
        )  # fmt: skip
        deadline = time.monotonic() + 120.0
        while process.poll() is None and time.monotonic() < deadline:
            if {path.name for path in tmp_path.iterdir()} - there:
                process.send_signal(signal.SIGINT)
                break
            time.sleep(0.005)
        _, error = process.communicate(timeout=60)
        status = process.returncode
        if status:
            break
        # On a busy machine the result may be whole before the signal is seen.
        there.add(out.name)
    # Where the interrupt met an exec(), CPython ends by the signal itself; a shell calls both 130.
    assert status in (130, -signal.SIGINT)
    assert error == "eccentric: interrupted\n"
    assert {path.name for path in tmp_path.iterdir()} == there
