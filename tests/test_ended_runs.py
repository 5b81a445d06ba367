"""What a run leaves that is ended by a signal: nothing, or what the next run that writes there removes."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from eccentric import cli
from eccentric.core import InputError, transaction, whole_file, whole_folder, workshop
from eccentric.virtual_bench import write
from tests.kills import ROOT, at_each_step, left_by

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals are those of POSIX")

# A command of the command line that writes, says so and waits, until it is ended.
WAITS = """
import sys, time
from types import SimpleNamespace
from eccentric import cli

def draw(folder):
    (folder / "half").write_text("half")
    print(folder, flush=True)
    while True:
        time.sleep(60)

sys.modules["eccentric.paper"] = SimpleNamespace(draw=draw)  # the real one takes seconds
sys.exit(cli.main(["figures", "--out", sys.argv[1]]))
"""


def waiting(out: Path, *before: str) -> tuple[subprocess.Popen[str], Path]:
    """A run that is writing into the folder, and its temporary folder."""
    process = subprocess.Popen(
        [*before, sys.executable, "-c", WAITS, str(out)],
        cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    assert process.stdout is not None
    return process, Path(process.stdout.readline().strip())


def stopped(process: subprocess.Popen[str], number: int) -> tuple[int, str]:
    """Send a signal; return the exit status and what was said on stderr."""
    process.send_signal(number)
    _, said = process.communicate(timeout=60)
    return process.returncode, said


@pytest.mark.parametrize("earlier", [False, True], ids=["new", "earlier result"])
@pytest.mark.parametrize(
    ("number", "status", "said"),
    [
        (signal.SIGINT, 130, "interrupted"),
        (signal.SIGTERM, 143, "ended by SIGTERM"),
        (signal.SIGHUP, 129, "ended by SIGHUP"),
    ],
)
def test_a_signal_leaves_nothing(number: int, status: int, said: str, earlier: bool, tmp_path: Path) -> None:
    """Status 128 + the signal's number as in a shell, one line, and no file more than before."""
    out = tmp_path / "out"
    if earlier:
        with whole_folder(out, "figures") as new:
            (new / "fig2.svg").write_text("first")
    before = sorted(tmp_path.rglob("*"))
    process, own = waiting(out)

    assert own.is_dir()
    assert (status, f"eccentric: {said}\n") == stopped(process, number)
    assert before == sorted(tmp_path.rglob("*"))


def test_a_hangup_that_is_ignored_stays_ignored(tmp_path: Path) -> None:
    """Under nohup a run goes on when its terminal closes."""
    process, own = waiting(tmp_path / "out", "sh", "-c", "trap '' HUP; exec \"$@\"", "sh")
    process.send_signal(signal.SIGHUP)

    assert own.is_dir()
    assert (143, "eccentric: ended by SIGTERM\n") == stopped(process, signal.SIGTERM)


def test_handlers_are_those_from_before(capsys: pytest.CaptureFixture[str]) -> None:
    """A program that calls the command line keeps its own."""
    numbers = signal.SIGTERM, signal.SIGHUP, signal.SIGINT
    before = [signal.getsignal(number) for number in numbers]
    assert cli.main(["unknown"]) == 2
    assert before == [signal.getsignal(number) for number in numbers]
    assert capsys.readouterr().err


@pytest.mark.parametrize("earlier", [False, True], ids=["new", "earlier result"])
def test_the_next_run_removes_what_a_killed_one_left(earlier: bool, tmp_path: Path) -> None:
    """SIGKILL leaves a temporary folder. It stays while its run lives; the next run removes it."""
    out = tmp_path / "out"
    if earlier:
        with whole_folder(out, "figures") as new:
            (new / "fig2.svg").write_text("first")
    process, own = waiting(out)
    place = own.parents[1]

    def next_run() -> None:
        with whole_file(place / "next.txt") as file:
            file.write_text("next")

    next_run()
    assert (own / "half").read_text() == "half"
    stopped(process, signal.SIGKILL)
    assert (own / "half").read_text() == "half"
    next_run()
    assert [] == left_by(tmp_path)
    assert (place / "next.txt").read_text() == "next"


def test_a_folder_that_is_no_temporary_one_is_not_removed(tmp_path: Path) -> None:
    """Only names that we give are ours: 16 digits; a link with such a name is not followed."""
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere/mine").write_text("mine")
    (tmp_path / ".eccentric-0123456789abcdef").symlink_to(tmp_path / "elsewhere")
    (tmp_path / ".eccentric-notes").mkdir()
    before = sorted(tmp_path.rglob("*"))
    with workshop(tmp_path):
        pass
    assert before == sorted(tmp_path.rglob("*"))


def test_without_locks_only_what_is_old_is_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On Windows, or a network disk without locks, nobody knows who lives: an hour must have passed."""
    monkeypatch.setattr(transaction, "fcntl", None)
    names = old, young = ".eccentric-" + 16 * "0", ".eccentric-" + 16 * "1"
    for name in names:
        (tmp_path / name).mkdir()
        (tmp_path / name / "half").write_text("half")
    for path in (tmp_path / old, tmp_path / old / "half"):
        past = path.stat().st_mtime - 3601.0
        os.utime(path, (past, past))

    with whole_file(tmp_path / "file") as file:
        file.write_text("next")
    assert ["file", young] == sorted((p.name for p in tmp_path.iterdir()), reverse=True)


def test_the_last_of_two_runs_into_a_new_folder_wins(tmp_path: Path) -> None:
    """The folder appears while the slower run works: it replaces the files of the faster one."""
    out = tmp_path / "out"
    with whole_folder(out, "fit") as slower:
        (slower / "fit.json").write_text("slower")
        with whole_folder(out, "fit") as faster:
            (faster / "fit.json").write_text("faster")
            (faster / "fit.svg").write_text("faster")
        assert (out / "fit.json").read_text() == "faster"
        (out / "mine").write_text("mine")

    there = {path.name: path.read_text() for path in out.iterdir()}
    assert {"fit.json": "slower", "mine": "mine"} == {k: v for k, v in there.items() if k != ".eccentric"}
    assert "fit: fit.json" in there[".eccentric"].splitlines()
    assert ["out"] == [path.name for path in tmp_path.iterdir()]


def test_the_later_of_two_runs_waits_until_the_first_has_moved_its_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two sets are moved one after the other: one that comes while another is in the middle does not mix."""
    out, replace = tmp_path / "out", Path.replace
    middle, go = threading.Event(), threading.Event()

    def run(text: str) -> None:
        with whole_folder(out, "fit") as new:
            for name in ("fit.json", "fit.png", "fit.svg"):
                (new / name).write_text(text)

    def halting(self: Path, target: Path) -> Path:
        if threading.current_thread() is first and self.name == "fit.png" and not go.is_set():
            middle.set()
            assert go.wait(60)
        return replace(self, target)

    run("before")
    monkeypatch.setattr(Path, "replace", halting)
    first, second = (threading.Thread(target=run, args=(text,)) for text in ("first", "second"))
    first.start()
    assert middle.wait(60)
    second.start()
    second.join(0.3)
    assert second.is_alive()
    go.set()
    first.join()
    second.join()
    assert {"second"} == {path.read_text() for path in out.glob("fit.*")}
    assert [] == left_by(tmp_path)


def test_without_locks_a_run_does_not_meddle_with_one_that_may_live(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A journal younger than an hour is in the way, with one line; an older one is undone."""
    monkeypatch.setattr(transaction, "fcntl", None)
    out, other = tmp_path / "out", tmp_path / "out" / (".eccentric-" + 16 * "0")
    with whole_folder(out, "fit") as new:
        (new / "fit.json").write_text("first")
    (other / "new").mkdir(parents=True)
    (other / "old").mkdir()
    (out / "fit.json").rename(other / "old" / "fit.json")
    plan = {"names": ["fit.json"], "leaving": ["fit.json"], "made": [], "fresh": False}
    (other / "journal").write_text(json.dumps(plan))

    with pytest.raises(
        InputError, match=r"expected a folder that no other run is writing; .* again in an hour$"
    ):
        fill(out)
    for path in (other, *other.rglob("*")):
        past = path.stat().st_mtime - 3601.0
        os.utime(path, (past, past))
    fill(out)
    assert {"fit.json": "first", "a": "a"} == {p.name: p.read_text() for p in out.glob("[!.]*")}
    assert [] == left_by(tmp_path)


def fill(out: Path) -> None:
    """Write one file by a command of its own."""
    with whole_folder(out, "emit arm") as new:
        (new / "a").write_text("a")


IMPORTS = """
import numpy as np
from types import SimpleNamespace
from eccentric.virtual_bench import write

bench = SimpleNamespace(columns={"time_s": np.zeros(3)}, rig={}, truth={})
"""


@pytest.mark.parametrize("act", ["kill", "interrupt"])
def test_an_ended_bench_leaves_no_log_without_its_rig(act: str, tmp_path: Path) -> None:
    """Log, rig and truth are there, or none, after the next run that writes there; nothing else is left.

    The same name is free unless all three files are there: a part of them is not in the way.
    """
    (tmp_path / "out").mkdir()
    names = {"log.csv.gz", "log.json", "log.truth.json"}
    run: Any = SimpleNamespace(columns={"time_s": np.zeros(3)}, rig={}, truth={})

    for copy in at_each_step(act, "write(bench, into / 'log.csv.gz')", tmp_path / "out", "", imports=IMPORTS):
        again = Path(shutil.copytree(copy, tmp_path / "again", symlinks=True))
        if not names <= {path.name for path in again.iterdir()}:
            write(run, again / "log.csv.gz")
        assert names <= {path.name for path in again.iterdir()}
        shutil.rmtree(again)

        with whole_file(copy / "next") as file:
            file.touch()
        assert {path.name for path in copy.iterdir()} - {"next"} in (set(), names)
