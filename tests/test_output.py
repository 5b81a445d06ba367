"""Output files appear whole or not at all, and a second run touches its own files in a folder only."""

import subprocess
from contextlib import nullcontext
from pathlib import Path

import pytest

from eccentric import cli
from eccentric.core import MARKER, InputError, own_folder, whole_file, whole_folder


def test_a_folder_is_replaced_as_a_whole(tmp_path: Path) -> None:
    """A second run replaces all files of the first, those that it does not write again included."""
    out = tmp_path / "new" / "out"
    for names in (("a", "b/c"), ("a",)):
        with whole_folder(out, "fit") as new:
            for name in names:
                (new / name).parent.mkdir(exist_ok=True)
                (new / name).write_text(str(names))

    assert sorted(path.name for path in out.iterdir()) == [MARKER, "a"]
    assert (out / "a").read_text() == "('a',)"
    assert [path.name for path in out.parent.iterdir()] == ["out"]


@pytest.mark.parametrize("error", [ValueError(), KeyboardInterrupt()], ids=["error", "interrupt"])
def test_nothing_half_written_stays(error: BaseException, tmp_path: Path) -> None:
    """After an exception, an interrupt included, folder and file are unchanged and nothing else is left."""
    out, log = tmp_path / "out", tmp_path / "log.csv"
    with whole_folder(out, "fit") as new, whole_file(log) as file:
        (new / "a").write_text("first")
        file.write_text("first")

    with pytest.raises(type(error)), whole_folder(out, "fit") as new:  # noqa: PT012 -- the failure is the point
        (new / "a").write_text("second")
        raise error
    with pytest.raises(type(error)), whole_file(log) as file:  # noqa: PT012
        file.write_text("second")
        raise error

    assert ["first", "first"] == [(out / "a").read_text(), log.read_text()]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["log.csv", "out"]


def test_files_of_others_are_kept(tmp_path: Path) -> None:
    """What someone adds to an output folder outlives the next run."""
    for text in ("first", "second"):
        with whole_folder(tmp_path / "out", "fit") as new:
            (new / "a").write_text(text)
        (tmp_path / "out/mine").mkdir(exist_ok=True)
        (tmp_path / "out/mine/notes").write_text("mine")

    with whole_folder(tmp_path / "out", "fit") as new:
        (new / "a").write_text("third")

    assert ["third", "mine"] == [(tmp_path / f"out/{name}").read_text() for name in ("a", "mine/notes")]


def test_a_command_replaces_what_it_wrote_itself(tmp_path: Path) -> None:
    """Two commands share a folder: each renews its own files, and what the other wrote stays."""
    runs = (("fit", "a b"), ("emit arm", "check/c d"), ("fit", "a"), ("emit leg", "e"))
    for command, names in runs:
        with whole_folder(tmp_path / "out", command) as new:
            for name in names.split():
                (new / name).parent.mkdir(exist_ok=True)
                (new / name).write_text(command)

    there = {p.relative_to(tmp_path / "out").as_posix() for p in (tmp_path / "out").rglob("*") if p.is_file()}
    assert there == {MARKER, "a", "check/c", "d", "e"}


def test_files_of_another_command_are_not_overwritten(tmp_path: Path) -> None:
    """A new file whose name another command's file has is refused; the message says whose it is."""
    with whole_folder(tmp_path / "out", "diagnose") as new:
        (new / "arm.c").write_text("first")

    said = r"out: expected the name arm\.c to be free, got a file that `eccentric diagnose` wrote; choose "
    with pytest.raises(InputError, match=said), whole_folder(tmp_path / "out", "emit arm") as new:
        (new / "arm.c").write_text("second")

    assert (tmp_path / "out/arm.c").read_text() == "first"


@pytest.mark.parametrize("command", ["fit", "diagnose"])
def test_a_folder_that_cannot_be_is_told_before_the_work(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """One line says what is wrong with --out, before the log is opened, and nothing is made."""
    (tmp_path / "file").write_text("")
    (tmp_path / "full").mkdir()
    (tmp_path / "full/thesis.tex").write_text("")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    own = "expected a folder of its own for the output, such as build/out, got"
    wrong = {
        "/": f"/: {own} one with the working directory in it",
        "": f".: {own} the working directory",
        "../file": "../file: expected a folder to write, got a file",
        "../file/a/b": f"../file/a/b: expected a place that can be written, but {tmp_path}/file is a file",
        "../full": "../full: expected a new or empty folder, or one that eccentric wrote"
        " (it holds .eccentric), got a folder with other files",
    }
    for out, said in wrong.items():
        assert cli.main([command, "no.csv", "--rig", "no.toml", "--out", out]) == 2
        assert capsys.readouterr() == ("", f"eccentric: error: {said}\n")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "full", "here"]


@pytest.mark.parametrize("command", ["fit", "diagnose"])
def test_a_log_that_is_given_twice_is_refused(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Rows that count twice would make standard errors look smaller than they are."""
    log, out = tmp_path / "a.csv", tmp_path / "out"
    again = tmp_path / "x" / ".." / "a.csv"
    assert cli.main([command, str(log), str(again), "--rig", "no.toml", "--out", str(out)]) == 2
    said = f"eccentric: error: {again}: expected each log only once, got it twice\n"
    assert capsys.readouterr() == ("", said)


def test_files_of_others_are_not_overwritten(tmp_path: Path) -> None:
    """A new file whose name someone else's file has is refused, and theirs stays."""
    with whole_folder(tmp_path / "out", "fit"):
        pass
    (tmp_path / "out/a").write_text("mine")

    with (
        pytest.raises(InputError, match="out: expected the name a to be free, "),
        whole_folder(tmp_path / "out", "fit") as new,
    ):
        (new / "a").write_text("ours")

    assert (tmp_path / "out/a").read_text() == "mine"


def test_a_folder_of_others_is_refused(tmp_path: Path) -> None:
    """A folder that holds files and was not written by eccentric is refused before any work is done."""
    (tmp_path / "thesis.tex").write_text("mine")

    with pytest.raises(InputError, match="got a folder with other files"), whole_folder(tmp_path, "fit"):
        pytest.fail("the block must not be entered")

    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_targets_of_the_wrong_kind_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file for a folder, the reverse, the working directory and a file as parent are refused."""
    (tmp_path / "file").write_text("")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")

    with pytest.raises(InputError, match="got a file"), whole_folder(tmp_path / "file", "fit"):
        pass
    with pytest.raises(InputError, match="got one that is not a regular file"), whole_file(tmp_path):
        pass
    with pytest.raises(InputError, match="got the working directory"), whole_folder(".", "fit"):
        pass
    with pytest.raises(InputError, match="a place that can be written"), whole_file("../file/log"):
        pass


# A second run into a folder.


def written(out: Path, *names: str, command: str = "fit") -> None:
    """Write files of these names by a command; each holds the names of all."""
    with whole_folder(out, command) as new:
        for name in names:
            (new / name).parent.mkdir(parents=True, exist_ok=True)
            (new / name).write_text(" ".join(names))


def tree(folder: Path) -> dict[str, object]:
    """Everything below a folder by name: the text of a file, the place of a link, None for a folder."""

    def content(path: Path) -> object:
        return path.readlink() if path.is_symlink() else path.read_text() if path.is_file() else None

    return {path.relative_to(folder).as_posix(): content(path) for path in sorted(folder.rglob("*"))}


def test_folders_links_and_modes_stay(tmp_path: Path) -> None:
    """Empty folders, symbolic links, and the mode and identity of the folder are those from before."""
    out = tmp_path / "out"
    written(out, "a", "b/c")
    (out / "empty/inner").mkdir(parents=True)
    (out / "link").symlink_to("nowhere")
    (out / "b/link").symlink_to(tmp_path)
    out.chmod(0o2775)
    before = tree(out), out.stat().st_mode, out.stat().st_ino

    written(out, "a", "b/c")

    assert before == (tree(out), out.stat().st_mode, out.stat().st_ino)


def test_a_repository_in_the_folder_outlives_a_run(tmp_path: Path) -> None:
    """Git calls a folder a repository only with its empty `refs/`, which packing leaves."""
    out = tmp_path / "out"
    written(out, "a")

    def git(*words: str) -> str:
        who = ("-c", "user.name=n", "-c", "user.email=e@example.org")
        return subprocess.run(
            ["git", "-C", str(out), *who, *words], check=True, capture_output=True, text=True
        ).stdout

    try:
        git("init")
    except FileNotFoundError:
        pytest.skip("needs git")
    git("add", "-A")
    git("commit", "-m", "first")
    git("pack-refs", "--all")
    written(out, "a", "d")

    assert git("status", "--porcelain").split() == ["M", MARKER, "M", "a", "??", "d"]


@pytest.mark.parametrize(
    ("mine", "new", "said"),
    [
        ("check", "check/c", "check to be free, got a file that eccentric did not write"),
        ("a/x", "a", "a to be free, got a folder"),
        ("a/x/y", "a/x", "a/x to be free, got a folder"),
    ],
    ids=["file for a folder", "folder for a file", "deeper"],
)
def test_what_stands_where_a_new_file_has_to_is_refused(
    mine: str, new: str, said: str, tmp_path: Path
) -> None:
    """A file cannot be a folder too: the run is refused, and nothing is moved."""
    out = tmp_path / "out"
    written(out, "first")
    (out / mine).parent.mkdir(parents=True, exist_ok=True)
    (out / mine).write_text("mine")
    before = tree(tmp_path)

    with pytest.raises(InputError, match=f"out: expected the name {said}; choose another folder"):
        written(out, "b", new, command="emit arm")

    assert before == tree(tmp_path)


def test_an_empty_folder_and_a_link_count_as_well(tmp_path: Path) -> None:
    """A file does not take the place of an empty folder, and none is written through a link."""
    out = tmp_path / "out"
    written(out, "first")
    (out / "a").mkdir()
    (tmp_path / "elsewhere").mkdir()
    (out / "check").symlink_to(tmp_path / "elsewhere")
    before = tree(tmp_path)

    with pytest.raises(InputError, match="expected the name a to be free, got a folder"):
        written(out, "a")
    with pytest.raises(InputError, match="expected the name check to be free, got a file that"):
        written(out, "check/c")

    assert before == tree(tmp_path)


@pytest.mark.parametrize("moves", range(9))
def test_a_failure_between_two_files_is_undone(
    moves: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whenever an interrupt comes while the files are put in their place, the folder is what it was."""
    out = tmp_path / "out"
    written(out, "a", "gone/b", "gone/c")
    (out / "mine").mkdir()
    before = tree(out)
    replace, left = Path.replace, [moves]

    def interrupted(self: Path, target: Path) -> Path:
        left[0] -= 1
        if left[0] == -1:
            raise KeyboardInterrupt
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", interrupted)
    # The plan, the marker, three old files that leave, three new ones; the ninth move there is not.
    expected = pytest.raises(KeyboardInterrupt) if moves < 8 else nullcontext()
    with expected:
        written(out, "a", "mine/c", "new/d")

    assert (before == tree(out)) == (moves < 8)


def test_only_the_folder_itself_is_written(tmp_path: Path) -> None:
    """Beside a folder that is there nothing is made, so that the place above it may be protected."""
    out = tmp_path / "out"
    written(out, "a")
    with whole_folder(out, "fit") as new:
        assert [path.name for path in tmp_path.iterdir()] == ["out"]
        assert new.is_relative_to(out)


@pytest.mark.parametrize("ask", [own_folder, lambda out: written(out, "a")], ids=["asked", "written"])
def test_a_marker_that_is_no_text_is_one_clear_line(ask, tmp_path: Path) -> None:  # noqa: ANN001
    """It is reported when the folder is requested, before the work, and the folder is not touched."""
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / MARKER).write_bytes(b"notice\n\xfffit: a\n")

    with pytest.raises(InputError, match=r"out/\.eccentric: expected UTF-8 text .*, but byte 7 is not$"):
        ask(tmp_path / "out")

    assert [path.name for path in (tmp_path / "out").iterdir()] == [MARKER]


def test_what_a_killed_run_left_is_in_nobodys_way(tmp_path: Path) -> None:
    """A folder that holds nothing but the workshop of a run that was killed can be written."""
    (tmp_path / "out" / ".eccentric-a1b2").mkdir(parents=True)
    with whole_folder(tmp_path / "out", "fit") as folder:
        (folder / "fit.json").write_text("{}", encoding="utf-8")

    assert "{}" == (tmp_path / "out" / "fit.json").read_text(encoding="utf-8")
