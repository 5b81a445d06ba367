"""The command line: one line on bad input, quiet if nobody reads its output."""

import argparse
import os
import re
import subprocess
import sys
import types
import warnings
from collections.abc import Callable
from importlib import import_module
from inspect import signature
from pathlib import Path
from typing import Any

import pytest

import eccentric
from eccentric import cli
from eccentric.cli.bench import _OF_A_FLEET
from eccentric.core import InputError, folder
from eccentric.emission import Adaptation

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch) -> Callable[[Callable[[], int]], int]:
    """Return a function that runs the command line with a command `fit` that does as instructed."""

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


_FLEET = {n: p.default for n, p in signature(eccentric.bench_fleet).parameters.items() if n in _OF_A_FLEET}
_STATED = {"adapt": vars(Adaptation()), "emit": vars(Adaptation()), "bench": _FLEET}


@pytest.mark.parametrize("name", cli.COMMANDS)
def test_help_has_one_style(name: str) -> None:
    """No article, no capital, no full stop; a default reads "(default: X)" and is the one that is used."""
    parser = argparse.ArgumentParser()
    import_module(f"eccentric.cli.{name}").configure(parser)
    actions = [action for action in parser._actions if action.dest != "help"]
    stated: dict[str, Any] = {}
    for action in actions:
        text = str(action.help) % {"default": action.default}
        found = re.findall(r"\(default: (.+?)\)", text)
        stated |= dict.fromkeys([action.dest], *found)

        assert text.count("default:") + text.count("by default") == len(found) <= 1, text
        assert not re.match(r"(?!Python|Dask)[A-Z][a-z]|(an?|the|what) ", text), text
        assert not text.endswith("."), text

    used = {a.dest: a.default for a in actions if type(a.default) in {int, float}} | _STATED.get(name, {})
    assert used == {dest: float(stated[dest]) for dest in used}


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
        (["fitt"], "unknown command 'fitt'; did you mean 'fit'?"),
        (["--versio"], "required: COMMAND"),
        (["fit"], "required"),
    ],
    ids=["nothing", "unknown command", "abbreviated option", "command without its log"],
)
def test_wrong_usage_is_one_line(
    arguments: list[str], complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """A wrong command line ends with status 2 and one line that says where help is."""
    with pytest.raises(SystemExit) as stop:
        sys.exit(cli.main(arguments))
    said = capsys.readouterr()

    assert (stop.value.code, said.out, said.err.count("\n")) == (2, "", 1)
    assert said.err.startswith("eccentric: error: ")
    assert complaint in said.err
    assert "--help" in said.err


LISTED = ("-m", "eccentric", "bench", "--list-effects")
PRINTING = {"eccentric": LISTED} | {path.stem: (str(path),) for path in (ROOT / "derivations").glob("*.py")}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[] if name in {"eccentric", "c2_parallel"} else [pytest.mark.slow])
        for name in sorted(PRINTING)
    ],
)
def test_a_reader_that_leaves_is_no_error(name: str) -> None:
    """Output into a pipe that nobody reads ends quietly, as it does for other programs."""
    command = [sys.executable, *PRINTING[name]]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.close()

    complaint = process.stderr.read()
    process.stderr.close()

    assert (process.wait(), complaint) == (141, b"")


def test_a_reader_that_leaves_leaves_the_files(tmp_path: Path) -> None:
    """`eccentric derive | head` has written what it derived."""
    command = ["-m", "eccentric", "derive", "c1_perpendicular", "--out", str(tmp_path / "out")]
    process = subprocess.Popen([sys.executable, *command], cwd=ROOT, stdout=subprocess.PIPE)
    assert process.stdout is not None
    process.stdout.close()

    assert process.wait() == 141
    there = {path.name for path in (tmp_path / "out").iterdir()}
    assert there >= {f"c1_perpendicular{ending}" for ending in (".py", ".h", ".c")}


@pytest.mark.skipif(os.name != "posix", reason="closed with a shell")
def test_no_stdout_at_all_is_no_error() -> None:
    """Started with stdout closed, as some services do, a command works and says nothing."""
    line = f'"{sys.executable}" {" ".join(LISTED)} >&-'
    done = subprocess.run(["sh", "-c", line], cwd=ROOT, capture_output=True, check=False)

    assert (done.returncode, done.stdout, done.stderr) == (0, b"", b"")


def test_places_are_found_beside_the_package() -> None:
    """In a clone the derivations and templates are the top-level folders."""
    assert [ROOT / "derivations", ROOT / "templates"] == [folder("derivations"), folder("templates")]


def test_a_place_that_is_not_there_is_named() -> None:
    """An incomplete installation says which folder is missing."""
    with pytest.raises(InputError, match="nonsense: expected a folder"):
        folder("nonsense")


def _python(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, check=False, timeout=120
    )


@pytest.mark.parametrize(
    ("given", "close"),
    [
        (["fitt"], "fit"),
        (["emit", "c2_paralel", "--out", "out"], "c2_parallel"),
        (["bench", "--out", "a.csv.gz", "--effect", "stribek"], "stribeck"),
    ],
)
def test_a_misspelt_name_is_answered_with_the_closest_one(
    given: list[str], close: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Commands, models and effects: one letter off is enough of a hint."""
    assert 2 == cli.main(given)
    assert f"; did you mean '{close}'?" in capsys.readouterr().err
