"""Files of one set are never of two runs, whenever a run is killed or interrupted, and no set is lost."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from eccentric.core import MARKER, whole_folder
from eccentric.emission import write
from tests.kills import at_each_step, left_by

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals are those of POSIX")

NAMES = ("arm.py", "arm.h", "arm.c", "check/arm_selftest.c")
FOLDER = "with whole_folder(into, 'emit arm') as new: fill(new)"
FILES = "with whole_files(into) as new: fill(new)"


def written(folder: Path, text: str, *names: str) -> None:
    """Write files with this text by one command."""
    with whole_folder(folder, "emit arm") as new:
        for name in names:
            (new / name).parent.mkdir(exist_ok=True)
            (new / name).write_text(text)


def texts(folder: Path) -> dict[str, str]:
    """What a reader sees: files by name, hidden ones excluded."""
    paths = (path for path in folder.rglob("*") if path.is_file())
    names = {path.relative_to(folder).as_posix(): path for path in paths}
    return {name: path.read_text() for name, path in names.items() if not name.startswith(".")}


@pytest.mark.parametrize("write_by", [FOLDER, FILES], ids=["folder", "files"])
def test_a_killed_run_never_leaves_files_of_two_runs(write_by: str, tmp_path: Path) -> None:
    """SIGKILL before each single step: what is there is of one run. The next run finds the whole set."""
    out, mine = tmp_path / "out", {"notes.txt": "mine"}
    gone = {} if write_by == FILES else {"gone.c": "first"}
    written(out, "first", *NAMES, *gone)
    (out / "notes.txt").write_text("mine")
    first, second = (dict.fromkeys(NAMES, text) for text in ("first", "second"))

    for killed in at_each_step("kill", write_by, out, "second", *NAMES):
        seen = texts(killed)
        runs = {text for name, text in seen.items() if name not in mine}
        assert len(runs) <= 1, (killed, seen)
        assert seen.items() >= mine.items()
        # Another command writes there: it finds one of the two sets, and the temporary folders are gone.
        with whole_folder(killed, "fit") as new:
            (new / "fit.json").write_text("{}")
        assert texts(killed) in [mine | {"fit.json": "{}"} | s for s in (first | gone, second)]
        assert [] == left_by(killed)
        assert (killed / MARKER).is_file()


def test_a_run_that_is_killed_while_it_repairs_is_repaired_as_well(tmp_path: Path) -> None:
    """Killed in the middle, and the run after it before each of its steps: the first set is still there."""
    out, names = tmp_path / "out", NAMES[:2]  # a step more is a folder more
    written(out, "first", *names)
    copies = at_each_step("kill", FOLDER, out, "second", *names)
    torn = next(copy for copy in copies if 0 < len(texts(copy)) < len(names))

    for killed in at_each_step("kill", FOLDER, torn, "third", *names):
        assert len(set(texts(killed).values())) <= 1
        with whole_folder(killed, "fit"):
            pass
        assert texts(killed) in [dict.fromkeys(names, text) for text in ("first", "third")]


@pytest.mark.parametrize("write_by", [FOLDER, FILES], ids=["folder", "files"])
def test_interrupts_that_do_not_end_leave_a_whole_set_and_nothing_else(write_by: str, tmp_path: Path) -> None:
    """Ctrl-C before a step and before all that follow, those of putting back and cleaning up included."""
    out = tmp_path / "out"
    written(out, "first", *NAMES)
    sets = [dict.fromkeys(NAMES, text) for text in ("first", "second")]

    for interrupted in at_each_step("interrupt", write_by, out, "second", *NAMES):
        assert texts(interrupted) in sets
        assert [] == left_by(interrupted)


def test_a_move_that_fails_is_undone_and_one_that_fails_for_good_is_kept_for_the_next_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A disk that fails in the middle, and again while the old files are put back: the next run has them."""
    out, replace, left = tmp_path / "out", Path.replace, [4]
    written(out, "first", *NAMES)

    def broken(self: Path, target: Path) -> Path:
        left[0] -= 1
        if left[0] < 0:
            raise OSError(5, "Input/output error")
        return replace(self, target)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", broken)
        with pytest.raises(OSError, match="Input/output error"):
            written(out, "second", *NAMES)
    assert texts(out).items() < dict.fromkeys(NAMES, "first").items()

    with whole_folder(out, "fit"):
        pass
    assert dict.fromkeys(NAMES, "first") == texts(out)


def test_rendered_files_are_written_as_a_set(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of `eccentric derive`, without a marker: a failure at any file leaves them as they were."""
    write(dict.fromkeys(NAMES, "first"), tmp_path)
    replace = Path.replace
    for moves in range(2 * len(NAMES) + 1):
        left = [moves]

        def broken(self: Path, target: Path, left: list[int] = left) -> Path:
            left[0] -= 1
            if left[0] == -1:
                raise OSError(28, "No space left on device")
            return replace(self, target)

        with monkeypatch.context() as patch:
            patch.setattr(Path, "replace", broken)
            with pytest.raises(OSError, match="No space left"):
                write(dict.fromkeys(NAMES, "second"), tmp_path)
        assert dict.fromkeys(NAMES, "first") == texts(tmp_path)
        assert {path.name for path in tmp_path.iterdir()} == {"arm.py", "arm.h", "arm.c", "check"}


def test_a_fresh_file_is_not_touched(tmp_path: Path) -> None:
    """Of a set, only what differs is replaced: `make` does not build the rest again."""
    write({"a.h": "same", "a.c": "first"}, tmp_path)
    before = (tmp_path / "a.h").stat()
    write({"a.h": "same", "a.c": "second"}, tmp_path)

    assert {"a.h": "same", "a.c": "second"} == texts(tmp_path)
    after = (tmp_path / "a.h").stat()
    assert (before.st_ino, before.st_mtime_ns) == (after.st_ino, after.st_mtime_ns)
