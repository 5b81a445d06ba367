"""Writes the project's results into a folder: emitted text, derivations, documents, help, refusals, signatures.

    python benchmarks/freeze.py [--part core|all] [--tree TREE | --rev COMMIT] [--data DATA] [--out FOLDER]
    python benchmarks/compare_frozen.py BEFORE AFTER

TREE is the tree whose results are written, by default this one; `--rev` takes a commit from a temporary worktree, so
that both sides of a comparison come from one machine and one script.  DATA has the open logs, in the folders
`examples`, `controls` and `measured`; what is absent is left out.  FOLDER is new and outside the tree.

A result is what a command of `eccentric` prints and writes.  Commands run inside FOLDER with relative paths, each in
a process of its own that is forked from one that has imported the tree: imports are paid once, and no command sees
what another one has cached.  Figures as PNG and tables as Parquet are removed; logs are unpacked.
"""

from __future__ import annotations

import argparse
import gc
import gzip
import importlib
import inspect
import json
import os
import pkgutil
import re
import runpy
import shutil
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

sys.path.append(str(Path(__file__).resolve().parents[1]))  # at the end: the tree that is frozen comes first
from benchmarks.measured_logs import SETS
from benchmarks.refusals import CALLS, commands, prepare

ROOT = Path(__file__).resolve().parents[1]
Command = tuple[str, ...]
Step = Command | Callable[[], object]
"""Arguments of `eccentric`, or a function of this process."""
PARTS = ("core", "all")
INPUTS = "inputs"
"""Folder of what the commands read, written by this script."""
DRIVES = {"C1": "c1_perpendicular", "C2": "c2_parallel"}
FIVE = (
    "stribeck[d=1]",
    "link_harmonic_friction[n=2]",
    "viscosity_temperature",
    "gear_efficiency[transmitted]",
    "backlash",
)
"""Effects that every option of `emit` is frozen with: a shape, a harmonic, a temperature, a load, a state."""
FITTED: Mapping[str, Mapping[str, float]] = {
    "turning": {"J_m": 1e-4, "J_l": 0.04},
    "linear_axis": {"mass": 95.0, "R": 1.0, "k_f": 5.0, "k_e": 5.0, "B": 200.0, "C": 20.0},
    "screw_axis": {"mass": 95.0, "R": 1.0, "k_f": 5.0, "k_e": 5.0, "kappa": 628.0, "B": 200.0, "C": 20.0},
    "planar_2r": {"R_0": 1.0, "k_i_0": 0.05, "k_e_0": 0.05, "R_1": 1.0, "k_i_1": 0.05, "k_e_1": 0.05},
}
"""What `--adapt` and `--fixed` need beside the defaults, by model; all others turn."""
OPTIONS: Mapping[str, str] = {
    "default": "",
    "functions": "--functions ONE",
    "arrays": "--functions ONE --arrays",
    "small": "--functions ONE --fixed",
    "fixed": "--fixed --parameters FITTED",
    "single": "--backend numpy --single-file",
    "jax": "--backend jax",
    "c99": "--backend c99 --prefix firmware",
    "adapt": "--adapt --parameters FITTED",
    "settled": "--adapt --parameters FITTED --forgetting 0.99 --false-alarms 1e5 --settle 5",
}
"""Options of `emit`; ONE is the friction that a drive compensates."""


@dataclass(frozen=True)
class Job:
    """Commands that run one after the other.

    Attributes:
        name: of the file NAME.txt with what they print, and of the folder for what they write.
        commands: what it runs.
        core: whether PART=core has it.
        seconds: roughly how long it takes; long ones start first.
    """

    name: str
    commands: Sequence[Step]
    core: bool = False
    seconds: float = 1.0


# The frozen tree is called through `eccentric.cli.main`, the public names, and the scripts of the next function.


def effect_script(model: str, effect: str | None) -> str:
    """The derivation of a model with an effect, or with `effects` by name alone if there is none.

    The only text that uses names below `eccentric`: those of the scripts that `diagnose` has written as model.py,
    which have to run as long as there are such files.  If a room is renamed, give the new name here beside the old.
    """
    chosen = "" if effect is None else f"model = effects[{effect!r}].extend(base, {{}})\n"
    return f'''"""An effect with its default values."""

from eccentric.effects import Setting, library
from eccentric.model import load_model

base = load_model({model!r})
setting = Setting(
    base=base, mu=0.2, known={{}}, w_min=0.5, w_max=80.0, current_max=15.0, duration_s=60.0, mean_loss_W=20.0,
    temperature_mid=25.0, channels=frozenset({{"current", "voltage", "temperature"}}),
    friction={{quantity.name: 0.01 for quantity in base.parameters}}, turns=40.0, orders=(3.57,),
)
effects = {{effect.id: effect for effect in library(setting)}}
{chosen}'''


def effects_of(model: str) -> list[str]:
    """Names of the effects of a model."""
    space: dict[str, Any] = {}
    exec(effect_script(model, None), space)  # noqa: S102 - the text above
    return list(space["effects"])


# The jobs.


def jobs(data: Path | None, *, every: bool) -> Iterator[Job]:
    """What is frozen, from inside the folder; the jobs of PART=core are marked, not chosen."""
    tree = Path(str(importlib.import_module("eccentric").__file__)).parents[1]
    names = [path.stem for path in sorted((tree / "derivations").glob("*.py"))]
    yield from _emitted([name for name in names if name != "serial_chain"], every=every)
    yield from _derivations(tree)
    yield from _documents(data)
    yield Job("help/eccentric", [("--help",), ("--version",)], core=True)
    for name in importlib.import_module("eccentric.cli").COMMANDS:
        yield Job(f"help/{name}", [(name, "--help")], core=True)
    for group, rows in commands().items():
        yield Job(f"refusals/{group}", rows, core=True, seconds=0.2 * len(rows))
    yield Job("refusals/python", [partial(_refused_call, line) for line in CALLS], core=True, seconds=15)
    yield Job("api/signatures", [lambda: _write("api/signatures.json", _signatures())], core=True)


def _emitted(drives: Sequence[str], *, every: bool) -> Iterator[Job]:
    """Base models, arms and five effects with all options; with `every`, each effect of each model."""
    for kind, values in FITTED.items():
        _write(f"{INPUTS}/fitted_{kind}.json", {"parameters": values})
    for name in drives:
        yield from _all_options(f"emitted/{name}", name, core=True)
    for path in sorted(Path("examples/arms").iterdir()):
        seconds = 20.0 if path.stem in {"six_joints", "ur10e"} else 3.0
        for job in _all_options(f"emitted/arms/{path.stem}", str(path), core=seconds < 20, seconds=seconds):
            few = path.stem != "planar_2r" and not job.name.endswith("default")
            yield replace(job, core=job.core and not few)
    for effect in FIVE:
        name, script = _effect("c2_parallel", effect)
        yield from _all_options(name, script, core=effect in FIVE[:2])
    for model in drives if every else ():
        for effect in effects_of(model):
            # Of effects that differ by their order alone, one model has all.
            order = re.search(r"\[n=(\d+)\]", effect)
            if model == "c2_parallel" or not order or int(order[1]) <= 2:
                name, script = _effect(model, effect)
                if model != "c2_parallel" or effect not in FIVE:
                    yield Job(name, [("emit", script, "--out", name)])


def _effect(model: str, effect: str) -> tuple[str, str]:
    """Name of the jobs and path of the script of a model with an effect, which is written."""
    place = re.sub(r"[^\w.+-]+", "_", effect).strip("_")
    script = Path(INPUTS, "effects", model, f"{place}.py")
    script.parent.mkdir(parents=True, exist_ok=True)
    script.write_text(effect_script(model, effect), encoding="utf-8")
    return f"emitted/effects/{model}/{place}", str(script)


def _all_options(name: str, model: str, *, core: bool, seconds: float = 1.0) -> Iterator[Job]:
    """A model with each of the options."""
    kind = Path(model).stem if Path(model).stem in FITTED else "turning"
    one = "mechanical_friction_force" if kind.endswith("_axis") else "mechanical_friction_torque"
    for option, words in OPTIONS.items():
        arguments = words.replace("ONE", one).replace("FITTED", f"{INPUTS}/fitted_{kind}.json").split()
        place = f"{name}/{option}"
        yield Job(place, [("emit", model, *arguments, "--out", place)], core, seconds)


def _derivations(tree: Path) -> Iterator[Job]:
    """Each derivation as text and LaTeX; audit and figures of the paper."""
    for path in sorted((tree / "derivations").glob("*.py")):
        name, place = path.stem, f"derivations/{path.stem}"
        rows: list[Step] = [("derive", name, "--out", place), ("derive", name, "--latex", "--out", place)]
        if name == "serial_chain":  # no model by itself: arms are made from it
            rows = [partial(runpy.run_path, str(path), run_name="__main__")]
        yield Job(place, rows, core=True, seconds=2)
    yield Job("derivations/all", [("derive", "--out", "derivations/all")], seconds=4)
    yield Job("derivations/audit", [("audit",)], core=True, seconds=2)
    yield Job("derivations/figures", [("figures", "--out", "derivations/figures")], seconds=4)


@dataclass(frozen=True)
class Drive:
    """A log of one drive, and its rig."""

    name: str
    log: str
    rig: str
    core: tuple[str, ...] = ()
    every: tuple[str, ...] = ("fit", "diagnose")
    seconds: float = 12.0


FULL = ("fit", "diagnose", "compare", "rig", "adapt", "plan")


def _drives(data: Path | None) -> Iterator[Drive]:
    """The bundled logs and, where they are, the open ones."""
    yield Drive("bench", "examples/bench/bench.csv.gz", "examples/bench/bench.json", FULL, FULL)
    yield Drive(
        "bench_toml",
        "examples/bench/bench.csv.gz",
        "examples/bench/bench.toml",
        (),
        ("fit", "diagnose", "rig"),
    )
    yield Drive("slide", "examples/slide/slide.csv.gz", "examples/slide/slide.toml", ("fit", "rig"), FULL)
    yield Drive("tutorial", "examples/tutorial/arm.csv.gz", "examples/tutorial/arm.toml", (), FULL)
    if data is None:
        return
    for folder, core in (("examples", {"example1", "example3"}), ("controls", set[str]())):
        for log in sorted(Path("data", folder).glob("*.csv.gz")):
            name = log.name.partition(".")[0]
            every = FULL if folder == "examples" else ("fit", "diagnose")
            yield Drive(
                name,
                str(log),
                str(log.with_name(f"{name}.json")),
                ("diagnose",) if name in core else (),
                every,
            )
    for name, folder in SETS.items():
        log = Path("data", "measured", folder, "data.csv.gz")
        if log.is_file():
            yield Drive(name, str(log), f"examples/rigs/{name}.toml", (), ("fit", "diagnose", "rig"), 40.0)


def _documents(data: Path | None) -> Iterator[Job]:
    for drive in _drives(data):
        yield from _of_a_drive(drive)
    yield from _of_arms(data)
    fleet, place = f"{INPUTS}/fleet", "documents/fleet"
    simulated = ("bench", "--fleet", "--out", fleet, "--joints", "3", "--months", "3")
    reduced = ("fleet", f"{fleet}/logs", "--rigs", f"{fleet}/rigs.csv", "--workers", "1", "--out", place)
    yield Job(place, [simulated, reduced], seconds=40)
    for case in DRIVES:
        place = f"documents/virtual_{case}"
        run = ("bench", "--case", case, "--seconds", "20", "--effect", "stribeck=0.15", "--temperature")
        yield Job(
            place, [("bench", "--list-effects"), (*run, "--out", f"{place}/log.csv.gz")], core=True, seconds=3
        )


def _of_a_drive(drive: Drive) -> Iterator[Job]:
    """The commands on the log of one drive; `adapt` and `plan` go on from what was fitted and diagnosed."""
    place, given = f"documents/{drive.name}", (drive.log, "--rig", drive.rig)
    text = Path(drive.rig).read_text(encoding="utf-8")
    case = re.search(r'case"?\s*[=:]\s*"(C\d)"', text)
    base = DRIVES[case[1]] if case else "screw_axis"
    others = {"C1": "c1_asymmetric", "C2": "c2_asymmetric"}.get(case[1] if case else "", "linear_axis")
    units = ("speed_rad_s = 30", "acceleration_rad_s2 = 200", "current_A = 8", "time_s = 20")
    slide = ("speed_m_s = 0.3", "acceleration_m_s2 = 3", "force_N = 100", "time_s = 20")
    limits = Path(INPUTS, f"{drive.name}_limits.toml")
    limits.write_text("\n".join(units if case else slide) + "\n", encoding="utf-8")
    fitted, found = f"{place}/fit", f"{place}/diagnose"
    every: dict[str, list[Command]] = {
        "fit": [("fit", *given, "--out", fitted)],
        "diagnose": [("diagnose", *given, "--out", found)],
        "compare": [
            ("compare", *given, base, others, f"{base}+stribeck[d=1]+cogging", "--out", f"{place}/compare")
        ],
        "rig": [
            ("rig", drive.log, "--out", f"{place}/rig/draft.toml"),
            ("rig", drive.log, "--check", drive.rig),
        ],
        "adapt": [("adapt", *given, "--parameters", f"{fitted}/fit.json", "--out", f"{place}/adapt")],
        "plan": [
            (
                "plan",
                *given,
                "--limits",
                str(limits),
                "--diagnosis",
                f"{found}/diagnosis.json",
                "--out",
                f"{place}/plan",
            )
        ],
    }
    for head, tail, share in (
        ("fit", "adapt", 0.5),
        ("diagnose", "plan", 1.5),
        ("compare", "", 0.5),
        ("rig", "", 0.4),
    ):
        if head in drive.every:
            rows = every[head] + (every[tail] if tail in drive.every else [])
            yield Job(f"{place}/{head}", rows, head in drive.core, share * drive.seconds)


def _of_arms(data: Path | None) -> Iterator[Job]:
    """Fit, diagnosis and draft of arms: one of the virtual bench, three measured."""
    place = "documents/arm"
    log, rig = f"{place}/log.csv.gz", f"{place}/log.toml"
    made = (
        "bench",
        "--arm",
        "2r",
        "--seconds",
        "15",
        "--runs",
        "3",
        "--effect",
        "gear_efficiency@2=0.2",
        "--out",
        log,
    )
    draft = ("rig", log, "--arm", f"{place}/log.arm.toml", "--out", f"{place}/draft.toml")
    rows = [
        made,
        draft,
        ("rig", log, "--check", rig),
        ("fit", log, "--rig", rig, "--out", f"{place}/fit"),
        ("diagnose", log, "--rig", rig, "--out", f"{place}/diagnose"),
    ]
    yield Job(place, rows, seconds=90)
    if data is None:
        return
    for folder, names in {
        "dfki_double_pendulum": ("dfki_double_pendulum_a", "dfki_double_pendulum_c"),
        "ur10e_arm": ("ur10e_arm",),
    }.items():
        log = f"data/measured/{folder}/data.csv.gz"
        if Path(log).is_file():
            for name in names:
                place, rig = f"documents/{name}", f"examples/rigs/{name}.toml"
                rows = [
                    (command, log, "--rig", rig, "--out", f"{place}/{command}")
                    for command in ("fit", "diagnose")
                ]
                yield Job(place, rows, seconds=500 if name == "ur10e_arm" else 150)


def _refused_call(line: str) -> None:
    """Call a public name with bad arguments, as a line of Python says, and print what comes of it."""
    print(f">>> {line}")
    space: dict[str, Any] = {"eccentric": importlib.import_module("eccentric")}
    space["LOG"], space["RIG"] = "examples/bench/bench.csv.gz", "examples/bench/bench.json"
    print("accepted:", type(eval(line, space)).__name__)  # noqa: S307 - a line of the table of refusals


def _signatures() -> dict[str, str]:
    """Public names with their signatures, those of methods and fields included."""
    package = importlib.import_module("eccentric")
    found: dict[str, str] = {}
    for name in sorted(set(dir(package))):
        value = getattr(package, name)
        if name.startswith("_") or isinstance(value, ModuleType):
            continue
        found[name] = _signature(value)
        if inspect.isclass(value):
            for member in sorted(set(dir(value))):
                if not member.startswith("_"):
                    found[f"{name}.{member}"] = _signature(inspect.getattr_static(value, member))
            for field, kind in getattr(value, "__annotations__", {}).items():
                if not field.startswith("_"):
                    found[f"{name}.{field}"] = str(kind)
    return found


def _signature(value: object) -> str:
    """How a name is called, or what kind of thing it is; without addresses."""
    function = value.fget if isinstance(value, property) else getattr(value, "__func__", value)
    kind = type(value).__name__
    with suppress(TypeError, ValueError):
        return f"{kind} {re.sub(r' at 0x[0-9a-f]+', '', str(inspect.signature(function)))}"  # type: ignore[arg-type]
    return kind


# Running them.


def _write(name: str, content: object) -> None:
    path = Path(name)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content, indent=1, sort_keys=True) + "\n", encoding="utf-8")


def _forked(run: Callable[[], int]) -> int:
    """Run in a child process; return its status."""
    sys.stdout.flush()
    sys.stderr.flush()
    child = os.fork()
    if child == 0:
        status = 70
        try:
            status = run()
            sys.stdout.flush()
            sys.stderr.flush()
        finally:
            os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _recorded(command: Step) -> str:
    """What a command prints, and its status, as one text."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:

        def run() -> int:
            os.dup2(out.fileno(), 1)
            os.dup2(err.fileno(), 2)
            try:
                if callable(command):
                    command()
                    return 0
                return importlib.import_module("eccentric.cli").main(list(command))
            except SystemExit as end:
                return int(end.code or 0)
            except Exception as error:  # noqa: BLE001 - no traceback: it has the paths of the tree
                print(f"{type(error).__name__}: {error}", file=sys.stderr)
                return 2 if callable(command) else 70

        status, texts = _forked(run), []
        for name, file in (("stdout", out), ("stderr", err)):
            file.seek(0)
            if text := file.read().decode("utf-8", "replace"):
                # Two texts that differ from run to run: the path of this folder, and addresses of objects.
                text = re.sub(r" at 0x[0-9a-f]{6,}", " at 0x...", text.replace(str(Path.cwd()), "."))
                texts.append(f"--- {name}\n{text}" + ("" if text.endswith("\n") else "\n"))
    said = "" if callable(command) else f"$ eccentric {' '.join(command)}\n"
    return f"{said}--- status {status}\n{''.join(texts)}\n"


def _run(job: Job) -> int:
    """Run a job and write NAME.txt; 1 if a command has ended with an exception."""
    folder, printed = Path(job.name), Path(f"{job.name}.txt")
    printed.parent.mkdir(parents=True, exist_ok=True)
    if job.name.startswith("documents/"):
        folder.mkdir(parents=True, exist_ok=True)  # where a command writes beside others, it makes no folder
    text = "".join(map(_recorded, job.commands))
    printed.write_text(text, encoding="utf-8")
    return int("--- status 70" in text)


def run_all(chosen: Iterable[Job], processes: int) -> list[str]:
    """Run jobs, the longest first, a few at a time; return the names of those with an exception."""
    waiting = sorted(chosen, key=lambda job: -job.seconds)
    total, running, failed, done = len(waiting), dict[int, tuple[Job, float]](), list[str](), 0
    while waiting or running:
        while waiting and len(running) < processes:
            job = waiting.pop(0)
            child = os.fork()
            if child == 0:
                status = 1
                try:
                    status = _run(job)
                finally:
                    os._exit(status)
            running[child] = (job, time.monotonic())
        child, status = os.wait()
        job, start = running.pop(child)
        done += 1
        if status:
            failed.append(job.name)
        if sys.stderr.isatty():
            print(f"{done}/{total} {job.name} {time.monotonic() - start:.1f} s", file=sys.stderr)
    return failed


def _preload() -> None:
    """Import the tree and what it computes with, before anything is forked."""
    package = importlib.import_module("eccentric")
    for module in pkgutil.walk_packages(package.__path__, "eccentric."):
        if not module.name.endswith("__main__"):
            with suppress(ImportError), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                importlib.import_module(module.name)
    for name in (
        "scipy.optimize",
        "scipy.signal",
        "matplotlib.figure",
        "matplotlib.backends.backend_agg",
        "bokeh.plotting",
    ):
        with suppress(ImportError):
            importlib.import_module(name)


def _inside(arguments: argparse.Namespace) -> int:
    """The part that runs in the folder, with the tree's code."""
    if not arguments.only:
        _preload()
    gc.freeze()  # a collection in a forked process would copy every page of this one
    prepare(Path(INPUTS))
    every = arguments.part == "all"
    wanted = re.compile(arguments.only)
    chosen = [
        job for job in jobs(arguments.data, every=every) if (every or job.core) and wanted.search(job.name)
    ]
    failed = run_all(chosen, arguments.processes)
    for name in sorted(failed):
        print(f"{name}: a command ended with an exception, see {name}.txt")
    return int(bool(failed))


# From outside.


def freeze(arguments: argparse.Namespace, tree: Path, out: Path) -> int:
    """Write the results of a tree into a new folder."""
    out.mkdir(parents=True)
    inputs = out / INPUTS
    inputs.mkdir()
    links = {out / "examples": tree / "examples"}
    if arguments.data is not None:
        links[out / "data"] = arguments.data
    for link, target in links.items():
        link.symlink_to(target.resolve(), target_is_directory=True)
    settings = {
        "ECCENTRIC_PROGRESS": "off",
        "NO_COLOR": "1",
        "COLUMNS": "100",
        "OMP_NUM_THREADS": "1",
        "PYTHONUTF8": "1",
    }
    settings |= {
        "PYTHONPATH": os.pathsep.join([str(tree.resolve()), str(ROOT)]),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    options = [
        "--inside",
        "--part",
        arguments.part,
        "--processes",
        str(arguments.processes),
        "--only",
        arguments.only,
    ]
    options += [] if arguments.data is None else ["--data", "data"]
    run = [sys.executable, "-P", str(Path(__file__).resolve()), *options]
    try:
        return subprocess.run(run, cwd=out, env={**os.environ, **settings}, check=False).returncode
    finally:
        for link in links:
            link.unlink()
        _tidy(out)


def _tidy(out: Path) -> None:
    """Remove pictures, binary tables, and inputs that are not needed to read a refusal; unpack logs."""
    for name in ("effects", "out", "fleet"):
        shutil.rmtree(out / INPUTS / name, ignore_errors=True)
    for path in sorted(out.rglob("*")):
        if path.suffix in {".png", ".parquet", ".pyc"}:
            path.unlink()
        elif path.suffix == ".gz" and out / INPUTS not in path.parents:
            path.with_suffix("").write_bytes(gzip.decompress(path.read_bytes()))
            path.unlink()


@contextmanager
def _tree_of(commit: str | None, tree: Path) -> Iterator[Path]:
    """The tree itself, or that of a commit in a temporary worktree."""
    if commit is None:
        yield tree
        return
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder, "tree")
        git = ["git", "-C", str(tree), "worktree"]
        subprocess.run([*git, "add", "--quiet", "--detach", str(place), commit], check=True)
        try:
            yield place
        finally:
            subprocess.run([*git, "remove", "--force", str(place)], check=True)


def _named(tree: Path, commit: str | None) -> str:
    """Short name of a commit, or "tree" for one with changes."""

    def git(*words: str) -> str:
        done = subprocess.run(["git", "-C", str(tree), *words], capture_output=True, text=True, check=False)
        return done.stdout.strip()

    if commit is None and git("status", "--porcelain"):
        return "tree"
    return git("rev-parse", "--short", commit or "HEAD") or "tree"


def main() -> int:
    """Freeze; status 1 if a command ended with an exception, 2 if nothing was started."""
    layout = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=layout)
    parser.add_argument("--part", choices=PARTS, default="core", help="core takes two minutes (default)")
    parser.add_argument("--tree", type=Path, default=ROOT, help="the tree that is frozen (this one)")
    parser.add_argument(
        "--rev", help="a commit, taken from a temporary worktree, instead of the tree as it is"
    )
    parser.add_argument("--data", type=Path, help="folder of the logs that are not bundled")
    parser.add_argument("--out", type=Path, help="a new folder (../frozen/COMMIT-PART beside this tree)")
    parser.add_argument("--only", default="", help="only the jobs whose name this pattern finds")
    parser.add_argument("--processes", type=int, default=os.cpu_count(), help="at a time (one per processor)")
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.inside:
        return _inside(arguments)
    if arguments.data is not None and not arguments.data.is_dir():
        parser.error(f"{arguments.data}: no such folder")
    out = (
        arguments.out or ROOT.parent / "frozen" / f"{_named(arguments.tree, arguments.rev)}-{arguments.part}"
    )
    if out.exists():
        parser.error(f"{out}: expected a new folder, and it exists")
    if out.resolve().is_relative_to(arguments.tree.resolve()):
        parser.error(f"{out}: expected a folder outside the tree {arguments.tree}")
    start = time.monotonic()
    with _tree_of(arguments.rev, arguments.tree) as tree:
        status = freeze(arguments, tree, out)
    count = sum(path.is_file() for path in out.rglob("*"))
    print(f"{out}: {count} files in {time.monotonic() - start:.0f} s")
    return status


if __name__ == "__main__":
    sys.exit(main())
