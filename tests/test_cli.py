"""The command line and its output folders: one line on bad input, whole output or none."""

import subprocess
import sys
import types
import warnings
from collections.abc import Callable
from pathlib import Path

import pytest

from eccentric import cli
from eccentric.errors import InputError
from eccentric.output import MARKER, whole_file, whole_folder
from eccentric.places import folder

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch) -> Callable[[Callable[[], int]], int]:
    """Return a function that runs the command line with a command `fit` that does what it is told."""

    def run(action: Callable[[], int]) -> int:
        module = types.ModuleType("eccentric.cli.fit")
        module.__dict__.update(
            NAME="fit",
            HELP="100 % told what to do",
            EXAMPLE="eccentric fit",
            configure=lambda parser: parser.add_argument("--number", type=int),
            run=lambda _: action(),
        )
        monkeypatch.setitem(sys.modules, "eccentric.cli.fit", module)
        return cli.main(["fit"])

    return run


def _raise(error: BaseException) -> int:
    raise error


@pytest.mark.parametrize(
    ("error", "status", "line"),
    [
        (InputError("a.csv: row 3,\ncolumn i"), 2, "eccentric: error: a.csv: row 3, column i"),
        (OSError(28, "No space left on device", "out"), 2, "eccentric: error: out: No space left on device"),
        (KeyboardInterrupt(), 130, "eccentric: interrupted"),
    ],
    ids=["bad input", "full disk", "interrupt"],
)
def test_failures_are_one_line(
    error: BaseException,
    status: int,
    line: str,
    command: Callable[[Callable[[], int]], int],
    capsys: pytest.CaptureFixture[str],
) -> None:
    """What goes wrong outside the program is one line on stderr and a status that is not zero."""
    returned = command(lambda: _raise(error))

    assert (status, "", line + "\n") == (returned, *capsys.readouterr())


def test_errors_of_the_program_are_not_hidden(command: Callable[[Callable[[], int]], int]) -> None:
    """An exception that is no fault of the input keeps its traceback."""
    with pytest.raises(ZeroDivisionError):
        command(lambda: _raise(ZeroDivisionError()))


def test_a_commands_status_is_returned(command: Callable[[Callable[[], int]], int]) -> None:
    """What `run` returns is the exit status."""
    assert command(lambda: 3) == 3


def test_warnings_are_one_line(command: Callable[[Callable[[], int]], int]) -> None:
    """A warning is shown as one line without a source line; outside the format is left as it was."""
    before, shown = warnings.formatwarning, []

    def warn() -> int:
        shown.append(warnings.formatwarning("mu > 1:\na step-up drive", UserWarning, "rig.py", 1))
        return 0

    command(warn)

    assert ["eccentric: warning: mu > 1: a step-up drive\n"] == shown
    assert warnings.formatwarning is before


@pytest.mark.parametrize("name", cli.COMMANDS)
def test_a_command_documents_itself(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The help of every command holds its one-line description and an example that starts with its name."""
    module = __import__(f"eccentric.cli.{name}", fromlist=["HELP"])

    with pytest.raises(SystemExit) as stop:
        cli.main([name, "--help"])

    shown = capsys.readouterr().out
    assert stop.value.code == 0
    assert module.NAME == name
    assert "\n" not in module.HELP
    assert " ".join(module.HELP.split()) in " ".join(shown.split())
    assert f"example:\n  eccentric {name}" in shown


def test_help_lists_every_command_without_importing_sympy() -> None:
    """`eccentric --help` names all commands and imports neither SymPy nor NumPy, so it is there at once."""
    program = (
        "import sys; from eccentric.cli import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: print(sorted({'sympy', 'numpy', 'scipy'} & set(sys.modules)))"
    )

    shown = _python("-c", program).stdout

    assert shown.splitlines()[-1] == "[]"
    assert [name for name in cli.COMMANDS if f"\n    {name} " not in shown] == []


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ([], "the following arguments are required: COMMAND"),
        (["fitt"], "invalid choice: 'fitt'"),
        (["--versio"], "required: COMMAND"),
        (["fit"], "required"),
    ],
    ids=["nothing", "unknown command", "abbreviated option", "command without its log"],
)
def test_wrong_usage_is_one_line(arguments: list[str], complaint: str) -> None:
    """A wrong command line ends with status 2 and one line that says where help is."""
    done = _python("-m", "eccentric", *arguments)

    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert done.stderr.startswith("eccentric: error: ")
    assert complaint in done.stderr
    assert "--help" in done.stderr


def test_a_reader_that_leaves_is_no_error() -> None:
    """Output into a pipe that nobody reads ends quietly, as it does for other programs."""
    command = [sys.executable, "-m", "eccentric", "audit"]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.close()

    complaint = process.stderr.read()
    process.stderr.close()

    assert (process.wait(), complaint) == (141, b"")


def test_places_are_found_beside_the_package() -> None:
    """In a clone the derivations and templates are the top-level folders."""
    assert [ROOT / "derivations", ROOT / "templates"] == [folder("derivations"), folder("templates")]


def test_a_place_that_is_not_there_is_named() -> None:
    """An incomplete installation says which folder is missing."""
    with pytest.raises(InputError, match="nonsense: required a folder"):
        folder("nonsense")


def test_a_folder_is_replaced_as_a_whole(tmp_path: Path) -> None:
    """A second run replaces all files of the first, those that it does not write again included."""
    out = tmp_path / "new" / "out"
    for names in (("a", "b/c"), ("a",)):
        with whole_folder(out) as new:
            for name in names:
                (new / name).parent.mkdir(exist_ok=True)
                (new / name).write_text(str(names))

    assert sorted(path.name for path in out.iterdir()) == [MARKER, "a"]
    assert (out / "a").read_text() == "('a',)"
    assert [path.name for path in out.parent.iterdir()] == ["out"]


@pytest.mark.parametrize("error", [ValueError(), KeyboardInterrupt()], ids=["error", "interrupt"])
def test_nothing_half_written_stays(error: BaseException, tmp_path: Path) -> None:
    """After an exception, an interrupt included, folder and file are what they were and nothing is beside."""
    out, log = tmp_path / "out", tmp_path / "log.csv"
    with whole_folder(out) as new, whole_file(log) as file:
        (new / "a").write_text("first")
        file.write_text("first")

    with pytest.raises(type(error)), whole_folder(out) as new:  # noqa: PT012 -- the failure is the point
        (new / "a").write_text("second")
        raise error
    with pytest.raises(type(error)), whole_file(log) as file:  # noqa: PT012
        file.write_text("second")
        raise error

    assert ["first", "first"] == [(out / "a").read_text(), log.read_text()]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["log.csv", "out"]


def test_the_old_folder_returns_if_the_new_one_cannot_take_its_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A failure between the two renames leaves the earlier output where it was."""
    out = tmp_path / "out"
    with whole_folder(out) as new:
        (new / "a").write_text("first")
    rename = Path.rename

    def fail_for_the_new_one(self: Path, target: Path) -> Path:
        if self.name == target.name == "out":
            raise KeyboardInterrupt
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", fail_for_the_new_one)
    with pytest.raises(KeyboardInterrupt), whole_folder(out) as new:
        (new / "a").write_text("second")

    assert (out / "a").read_text() == "first"


def test_files_of_others_are_kept(tmp_path: Path) -> None:
    """What someone adds to an output folder outlives the next run."""
    for text in ("first", "second"):
        with whole_folder(tmp_path / "out") as new:
            (new / "a").write_text(text)
        (tmp_path / "out/mine").mkdir(exist_ok=True)
        (tmp_path / "out/mine/notes").write_text("mine")

    with whole_folder(tmp_path / "out") as new:
        (new / "a").write_text("third")

    assert ["third", "mine"] == [(tmp_path / f"out/{name}").read_text() for name in ("a", "mine/notes")]


def test_files_of_others_are_not_overwritten(tmp_path: Path) -> None:
    """A new file whose name someone else's file has is refused, and theirs stays."""
    with whole_folder(tmp_path / "out"):
        pass
    (tmp_path / "out/a").write_text("mine")

    with (
        pytest.raises(InputError, match="out: required to be free: a;"),
        whole_folder(tmp_path / "out") as new,
    ):
        (new / "a").write_text("ours")

    assert (tmp_path / "out/a").read_text() == "mine"


def test_a_folder_of_others_is_refused(tmp_path: Path) -> None:
    """A folder that holds files and was not written by eccentric is refused before any work is done."""
    (tmp_path / "thesis.tex").write_text("mine")

    with pytest.raises(InputError, match="received a folder with other files"), whole_folder(tmp_path):
        pytest.fail("the block must not be entered")

    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_targets_of_the_wrong_kind_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file for a folder, the reverse, the working directory and a file as parent are refused."""
    (tmp_path / "file").write_text("")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")

    with pytest.raises(InputError, match="received a file"), whole_folder(tmp_path / "file"):
        pass
    with (
        pytest.raises(InputError, match="received something that is not a regular file"),
        whole_file(tmp_path),
    ):
        pass
    with pytest.raises(InputError, match="received the working directory"), whole_folder("."):
        pass
    with pytest.raises(InputError, match="required a place that can be written"), whole_file("../file/log"):
        pass


def _python(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, check=False, timeout=120
    )
