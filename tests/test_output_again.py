"""A second run into a folder touches its own files there and nothing else; one that fails touches nothing."""

import subprocess
from contextlib import nullcontext
from pathlib import Path

import pytest

from eccentric.core import MARKER, InputError, own_folder, whole_folder


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
