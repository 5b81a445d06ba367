"""What `eccentric.compile` finds again instead of deriving it, and that it finds nothing that has changed."""

import ctypes
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import eccentric
from eccentric import import_time
from eccentric.compiled import entry
from eccentric.compiled.entry import local_compiler
from tests.emitted import module

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")

ROOT = Path(__file__).resolve().parent.parent
TORQUE = """
import sys, eccentric
torque = eccentric.compile(sys.argv[1]).friction_torque(30.0)
print(torque, "derived" if "sympy" in sys.modules else "found")
"""
OWN = """
from pathlib import Path
from eccentric.model import load_model
from eccentric.model import with_values
model = with_values(load_model("c1_perpendicular"), {{"C_m": {C_m}}}, {name!r})
"""
LOADS = """
from pathlib import Path
from eccentric.effects import Setting, load_effects
from eccentric.model import load_model
beside = Path(__file__).parent
model = load_model(beside / "own.py")
load_effects(beside / "effects.py", Setting(model, 0.2, {}, 1.0, 90.0, 30.0, 10.0, 1.0))
"""


@pytest.fixture(scope="module", autouse=True)
def cache_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Keep the cache of these tests apart. An edit of the toolkit while they run is none that they test."""
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder))
        patch.setattr(import_time, "imported_at", float("inf"))
        yield folder / "eccentric"


def _own(folder: Path, C_m: str, name: str = "own") -> Path:
    """Write a derivation of one's own: a model with another Coulomb friction."""
    path = folder / f"{name}.py"
    path.write_text(OWN.format(C_m=C_m, name=name))
    return path


def _torque(C_m: float) -> float:
    """Return the friction torque of a derivation of one's own at 30 rad/s."""
    c1 = module("c1_perpendicular")
    return c1.friction_torque(30.0, c1.Parameters(C_m=C_m))


def _is_found(path: Path | str) -> bool:
    return entry.look_up(path, local_compiler()) is not None


def _start(asked: Path | str, root: Path = ROOT) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", TORQUE, str(asked)],
        cwd=root,
        env=os.environ | {"PYTHONPATH": str(root)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def _fresh(asked: Path | str, root: Path = ROOT) -> tuple[float, str]:
    """Return what a fresh process computes, and whether it derived the model or found it."""
    return _answer(_start(asked, root))


def _answer(process: subprocess.Popen[str]) -> tuple[float, str]:
    said, complaint = process.communicate()
    assert (0, "") == (process.returncode, complaint)
    torque, how = said.split()
    return float(torque), how


@pytest.mark.slow
def test_the_next_process_finds_what_this_one_derived(tmp_path: Path) -> None:
    """It serves the same functions without importing SymPy."""
    own = _own(tmp_path, "0.011")
    eccentric.compile(own)

    assert (_torque(0.011), "found") == _fresh(own)


@pytest.mark.parametrize(
    "changed",
    [*(pytest.param(name, marks=pytest.mark.slow) for name in ("loads.py", "own.py")), "effects.py"],
)
def test_a_changed_script_is_derived_again(changed: str, tmp_path: Path) -> None:
    """That holds for a derivation, for one that it loads and for effects that it loads; back is back."""
    _own(tmp_path, "0.012")
    asked, effects = tmp_path / "loads.py", tmp_path / "effects.py"
    asked.write_text(LOADS)
    effects.write_text("effects = lambda setting: ()\n")
    eccentric.compile(asked)
    assert _is_found(asked)

    before = (tmp_path / changed).read_text()
    (tmp_path / changed).write_text(before + "# a remark\n")
    assert not _is_found(asked)
    (tmp_path / changed).write_text(before)
    assert _is_found(asked)
    (tmp_path / changed).unlink()
    assert not _is_found(asked)


def test_a_process_does_not_pass_off_what_it_loaded_as_what_lies_there_now(tmp_path: Path) -> None:
    """It executes a script once; the next process gets the script as it is."""
    own = _own(tmp_path, "0.012")
    eccentric.compile(own)
    _own(tmp_path, "0.013")

    assert _torque(0.012) == eccentric.compile(own).friction_torque(30.0)
    assert not _is_found(own)
    assert (_torque(0.013), "derived") == _fresh(own)


@pytest.mark.parametrize(
    "line",
    [
        "C_m = float(open('C_m.txt').read())",
        "from pathlib import Path; C_m = float(Path('C_m.txt').read_text())",
        "import numpy as np; C_m = float(np.loadtxt('C_m.txt'))",
        "import os; C_m = float(os.environ['C_m'])",
        "from time import time; C_m = time()",
        "from eccentric import fit",
        "from eccentric.core import read_document",
        "from .beside import C_m",
        "C_m = eval('1 + 1')",
        "def late():\n    import random",
    ],
)
def test_a_script_whose_text_does_not_decide_is_never_found(line: str) -> None:
    """What it reads or imports may be another thing next time."""
    assert not entry._decides(line.encode())


@pytest.mark.parametrize("path", sorted((ROOT / "derivations").glob("*.py")), ids=lambda path: path.stem)
def test_a_script_that_computes_only_may_be_found(path: Path) -> None:
    """So do the derivations that ship: each of them is looked up."""
    assert entry._decides(path.read_bytes())


def test_what_a_script_reads_is_read_every_time(tmp_path: Path) -> None:
    """A derivation with a file of numbers is derived again, whether that has changed or not."""
    numbers = tmp_path / "C_m.txt"
    numbers.write_text("0.014")
    reads = _own(tmp_path, f"float(Path({str(numbers)!r}).read_text())", "reads")

    assert _torque(0.014) == eccentric.compile(reads).friction_torque(30.0)
    assert not _is_found(reads)


@pytest.mark.slow
def test_a_changed_toolkit_derives_again(tmp_path: Path) -> None:
    """Be it a source, a template or a derivation that ships."""
    for name in ("eccentric", "templates", "derivations"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", tmp_path)

    def after(edit: str) -> list[str]:
        path = tmp_path / edit
        path.write_text(path.read_text() + "\n")
        # A process that starts within 50 ms of an edit remembers nothing, to be on the safe side.
        time.sleep(0.2)
        return [_fresh("c1_perpendicular", tmp_path)[1] for _ in range(2)]

    edits = ["eccentric/emission/render.py", "templates/c99/source.c.jinja", "derivations/rotating_link.py"]
    assert {edit: ["derived", "found"] for edit in edits} == {edit: after(edit) for edit in edits}


def test_another_compiler_builds_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What one compiler built is not served if another one, or other options, are requested."""
    own = _own(tmp_path, "0.016")
    eccentric.compile(own)
    assert _is_found(own)

    monkeypatch.setenv("CC", "cc -O1")
    assert not _is_found(own)


def test_a_source_that_is_edited_while_a_process_runs_is_not_what_it_ran(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Then the process remembers nothing: the next one may run other code."""
    own = _own(tmp_path, "0.017")
    monkeypatch.setattr(import_time, "imported_at", 0.0)
    eccentric.compile(own)

    assert not _is_found(own)


def _truncate(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def _flip(path: Path) -> None:
    held = bytearray(path.read_bytes())
    held[len(held) // 2] ^= 1
    path.write_bytes(held)


@pytest.mark.parametrize(
    ("which", "damage"),
    [
        pytest.param(f"damaged_*.{end}", damage, id=f"{end}-{name}", marks=() if few else pytest.mark.slow)
        for end, damage, name, few in (
            ("so", _truncate, "cut off", True),
            ("so", _flip, "one bit", False),
            ("so", Path.unlink, "gone", False),
            ("json", _truncate, "cut off", False),
            ("json", _flip, "one bit", True),
            ("json", Path.unlink, "gone", False),
        )
    ],
)
def test_what_is_damaged_is_made_again(
    which: str, damage: Callable[[Path], None], cache_folder: Path, tmp_path: Path
) -> None:
    """Neither a damaged library nor a damaged record is used, and after one call both are whole again."""
    own = _own(tmp_path, "0.018", "damaged")
    eccentric.compile(own)
    # In place a process that has the library loaded would fall; a damaged disk does not ask.
    damaged = list(cache_folder.glob(which))
    for path in damaged:
        copied = path.with_suffix(".copy")
        shutil.copy(path, copied)
        damage(copied)
        path.unlink()
        if copied.exists():
            copied.rename(path)

    assert damaged
    assert not _is_found(own)
    assert _torque(0.018) == eccentric.compile(own).friction_torque(30.0)
    assert _is_found(own)


def test_a_library_that_cannot_be_loaded_is_built_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As where a home folder is shared with a machine of another kind."""
    own = _own(tmp_path, "0.019")
    eccentric.compile(own)
    load, refused = ctypes.PyDLL, []

    def once(path: str) -> ctypes.PyDLL:
        if not refused:
            refused.append(path)
            raise OSError(path)
        return load(path)

    monkeypatch.setattr(ctypes, "PyDLL", once)
    assert _torque(0.019) == eccentric.compile(own).friction_torque(30.0)
    assert 1 == len(refused)


@pytest.mark.slow
def test_processes_at_the_same_time_do_not_clash(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each receives its module, and the cache they leave is complete, with nothing half-written in it."""
    own = _own(tmp_path, "0.02")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    processes = [_start(own) for _ in range(2)]

    assert [(_torque(0.02), "derived")] * 2 == [_answer(process) for process in processes]
    assert (_torque(0.02), "found") == _fresh(own)
    left = {path.suffix for path in (tmp_path / "cache" / "eccentric").iterdir()}
    assert {".so", ".json", ".derived"} == left
