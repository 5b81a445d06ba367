"""Writes the project's results into a folder: emitted text, derivations, documents, help, refusals, signatures.

    python benchmarks/freeze.py [--part core|all] [--tree TREE | --rev COMMIT] [--data DATA] [--out FOLDER]
    python benchmarks/compare_frozen.py BEFORE AFTER

TREE is the tree whose results are written, by default this one; `--rev` takes a commit from a temporary worktree, so
that both sides of a comparison come from one machine and one script.  DATA has the open logs, in the folders
`examples`, `controls` and `measured`; what is absent is left out.  FOLDER is new and outside the tree.

A result is what a command of `eccentric` prints and writes.  Commands run inside FOLDER with relative paths, each in
a process of its own that is forked from one that has imported the tree (and loaded a model, for refusals): imports
are paid once, and no command sees what another one has cached.  Figures as PNG and tables as Parquet are removed; logs are unpacked.
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
Step = str | Callable[[], object]
"""Arguments of `eccentric`, separated by blanks, or a function of this process."""
PARTS = ("core", "all")
EXCEPTION = 3
"""Status of a job with a command that ended with an exception, which is frozen like any answer."""
INPUTS = "inputs"
"""Folder of what the commands read, written by this script."""
ARMS = {
    "ur10e_arm": "ur10e_arm",
    "dfki_double_pendulum_a": "dfki_double_pendulum",
    "dfki_double_pendulum_c": "dfki_double_pendulum",
}
"""Rig file of a measured arm -> folder of its log; of one drive: `SETS`."""
SPEEDS = {"speed_rad_s": 30.0, "acceleration_rad_s2": 200.0, "current_A": 8.0, "time_s": 20.0}
"""Limits of a planned motion."""
API = ("eccentric", "eccentric.model", "eccentric.effects")
"""Packages that scripts import: the door, and what derivations and effects are written in."""
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


def jobs(tree: Path, data: Path | None, *, every: bool) -> Iterator[Job]:
    """What is frozen, from inside the folder; the jobs of PART=core are marked, not chosen."""
    names = [path.stem for path in sorted((tree / "derivations").glob("*.py"))]
    yield from _emitted([name for name in names if name != "serial_chain"], every=every)
    yield from _derivations(tree)
    yield from _documents(data)
    yield Job("help/eccentric", ["--help", "--version"], core=True)
    for name in importlib.import_module("eccentric.cli").COMMANDS:
        yield Job(f"help/{name}", [f"{name} --help"], core=True)
    for group, rows in commands().items():
        yield Job(f"refusals/{group}", rows, core=True, seconds=0.2 * len(rows))
    yield Job("refusals/python", [partial(_refused_call, line) for line in CALLS], core=True, seconds=15)
    for name in API:
        yield Job(f"api/{name}", [partial(_write_signatures, name)], core=True)


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
        yield from _all_options(name, script, core=effect == FIVE[0])
    for model in drives if every else ():
        for effect in effects_of(model):
            # Of effects that differ by their order alone, one model has all.
            order = re.search(r"\[n=(\d+)\]", effect)
            if model == "c2_parallel" or not order or int(order[1]) <= 2:
                name, script = _effect(model, effect)
                if model != "c2_parallel" or effect not in FIVE:
                    yield Job(name, [f"emit {script} --out {name}"])


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
        arguments = words.replace("ONE", one).replace("FITTED", f"{INPUTS}/fitted_{kind}.json")
        place = f"{name}/{option}"
        yield Job(place, [f"emit {model} {arguments} --out {place}"], core, seconds)


def _derivations(tree: Path) -> Iterator[Job]:
    """Each derivation as text and LaTeX; audit and figures of the paper."""
    for path in sorted((tree / "derivations").glob("*.py")):
        name, place = path.stem, f"derivations/{path.stem}"
        rows: list[Step] = [f"derive {name} --out {place}", f"derive {name} --latex --out {place}"]
        if name == "serial_chain":  # no model by itself: arms are made from it
            rows = [partial(runpy.run_path, str(path), run_name="__main__")]
        yield Job(place, rows, core=True, seconds=2)
    yield Job("derivations/all", ["derive --out derivations/all"], seconds=4)
    yield Job("derivations/audit", ["audit"], core=True, seconds=2)
    yield Job("derivations/figures", ["figures --out derivations/figures"], seconds=4)


FULL = ("fit", "diagnose", "compare", "rig")


@dataclass(frozen=True)
class Drive:
    """A log of one drive and its rig file: what is frozen of it, and what of that in PART=core."""

    name: str
    log: str
    rig: str
    every: tuple[str, ...] = FULL
    core: tuple[str, ...] = ()
    seconds: float = 12.0


def _drives(data: Path | None) -> Iterator[Drive]:
    """The bundled logs and, where they are, the open ones."""
    bench, slide, tutorial = (f"examples/{name}" for name in ("bench/bench", "slide/slide", "tutorial/arm"))
    yield Drive("bench", f"{bench}.csv.gz", f"{bench}.json", core=FULL)
    yield Drive("bench_toml", f"{bench}.csv.gz", f"{bench}.toml", ("fit", "diagnose", "rig"))
    yield Drive("slide", f"{slide}.csv.gz", f"{slide}.toml", core=("fit", "rig"))
    yield Drive("tutorial", f"{tutorial}.csv.gz", f"{tutorial}.toml")
    if data is None:
        return
    for log in sorted(Path("data/examples").glob("*.csv.gz")):
        name = log.name.partition(".")[0]
        core = ("diagnose",) if name in {"example1", "example3"} else ()
        yield Drive(name, str(log), f"data/examples/{name}.json", core=core)
    for log in sorted(Path("data/controls").glob("*.csv.gz")):
        name = log.name.partition(".")[0]
        yield Drive(name, str(log), f"data/controls/{name}.json", ("fit", "diagnose"))
    for name, folder in SETS.items():
        log = Path("data/measured", folder, "data.csv.gz")
        if log.is_file():
            yield Drive(name, str(log), f"examples/rigs/{name}.toml", ("fit", "diagnose", "rig"), seconds=40)


def _documents(data: Path | None) -> Iterator[Job]:
    """Logs of one drive, arms, a fleet and two logs of the virtual bench."""
    for drive in _drives(data):
        yield from _drive_documents(drive)
    yield from _arm_documents(data)
    fleet, place = f"{INPUTS}/fleet", "documents/fleet"
    rows: list[Step] = [
        f"bench --fleet --out {fleet} --joints 4 --months 6",
        partial(_one_time, fleet),
        f"fleet {fleet}/logs --rigs {fleet}/rigs.csv --workers 1 --out {place}",
    ]
    yield Job(place, rows, seconds=40)
    for case in DRIVES:
        place = f"documents/virtual_{case}"
        run = (
            f"bench --case {case} --seconds 20 --effect stribeck=0.15 --temperature --out {place}/log.csv.gz"
        )
        yield Job(place, ["bench --list-effects", run], core=True, seconds=3)


def _one_time(folder: str) -> None:
    """Give all files one time of change, which the results of a fleet note of its logs."""
    for path in Path(folder).rglob("*"):
        os.utime(path, (1e9, 1e9))


def _drive_documents(drive: Drive) -> Iterator[Job]:
    """The commands on the log of one drive; `adapt` starts from its fit, and `plan` from its diagnosis."""
    place, source = f"documents/{drive.name}", f"{drive.log} --rig {drive.rig}"
    found = re.search(r'case"?\s*[=:]\s*"(C\d)"', Path(drive.rig).read_text(encoding="utf-8"))
    base, other = (
        (DRIVES[found[1]], f"{found[1].lower()}_asymmetric") if found else ("screw_axis", "linear_axis")
    )
    limits = (
        SPEEDS if found else {"speed_m_s": 0.3, "acceleration_m_s2": 3.0, "force_N": 100.0, "time_s": 20.0}
    )
    _write(f"{INPUTS}/{drive.name}_limits.json", limits)
    planned = f"--limits {INPUTS}/{drive.name}_limits.json --diagnosis {place}/diagnose/diagnosis.json"
    rows = {
        "fit": [f"fit {source} --out {place}/fit"],
        "diagnose": [f"diagnose {source} --out {place}/diagnose"],
        "compare": [f"compare {source} {base} {other} {base}+stribeck[d=1]+cogging --out {place}/compare"],
        "rig": [f"rig {drive.log} --out {place}/rig/draft.toml", f"rig {drive.log} --check {drive.rig}"],
    }
    if drive.every == FULL:
        rows["fit"].append(f"adapt {source} --parameters {place}/fit/fit.json --out {place}/adapt")
        rows["diagnose"].append(f"plan {source} {planned} --out {place}/plan")
    for name in drive.every:
        seconds = drive.seconds * (1.5 if name == "diagnose" else 0.5)
        yield Job(f"{place}/{name}", rows[name], name in drive.core, seconds)


def _arm_documents(data: Path | None) -> Iterator[Job]:
    """Fit, diagnosis and draft of arms: one of the virtual bench, three measured."""
    place = "documents/arm"
    log, rig = f"{place}/log.csv.gz", f"{place}/log.toml"
    rows = [
        f"bench --arm 2r --seconds 15 --runs 3 --effect gear_efficiency@2=0.2 --out {log}",
        f"rig {log} --arm {place}/log.arm.toml --out {place}/draft.toml",
        f"rig {log} --check {rig}",
        f"fit {log} --rig {rig} --out {place}/fit",
        f"diagnose {log} --rig {rig} --out {place}/diagnose",
    ]
    yield Job(place, rows, seconds=90)
    for name, folder in ARMS.items() if data is not None else ():
        source = f"data/measured/{folder}/data.csv.gz --rig examples/rigs/{name}.toml"
        if Path(source.partition(" ")[0]).is_file():
            place = f"documents/{name}"
            rows = [f"{command} {source} --out {place}/{command}" for command in ("fit", "diagnose")]
            yield Job(place, rows, seconds=500 if name == "ur10e_arm" else 100)


def _refused_call(line: str) -> None:
    """Call a public name with bad arguments, as a line of Python says, and print what comes of it."""
    print(f">>> {line}")
    space: dict[str, Any] = {"eccentric": importlib.import_module("eccentric")}
    space["LOG"], space["RIG"] = "examples/bench/bench.csv.gz", "examples/bench/bench.json"
    print("accepted:", type(eval(line, space)).__name__)  # noqa: S307 - a line of the table of refusals


def _signatures(package_name: str) -> dict[str, str]:
    """Public names of a package with their signatures, those of methods and fields included."""
    package, found = importlib.import_module(package_name), dict[str, str]()
    for name in sorted(set(getattr(package, "__all__", dir(package)))):
        value = getattr(package, name)
        if name.startswith("_") or isinstance(value, ModuleType):
            continue
        found[name] = _signature(value)
        for base in value.__mro__ if inspect.isclass(value) else ():
            if base.__module__.startswith("eccentric"):  # not what it inherits from SymPy
                members = {key: _signature(member) for key, member in vars(base).items()}
                members |= {key: str(kind) for key, kind in vars(base).get("__annotations__", {}).items()}
                found |= {f"{name}.{key}": text for key, text in members.items() if not key.startswith("_")}
    return found


def _write_signatures(name: str) -> None:
    _write(f"api/{name}.json", _signatures(name))


def _signature(value: object) -> str:
    """How a name is called, or what kind of thing it is; without addresses, and with sets in order."""
    function = value.fget if isinstance(value, property) else getattr(value, "__func__", value)
    kind = type(value).__name__
    with suppress(TypeError, ValueError):
        text = re.sub(r" at 0x[0-9a-f]+", "", str(inspect.signature(function)))  # type: ignore[arg-type]
        return f"{kind} " + re.sub(
            r"(?<=set\(\{)[^}]*", lambda some: ", ".join(sorted(some[0].split(", "))), text
        )
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
                return importlib.import_module("eccentric.cli").main(command.split())
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
    line = "" if callable(command) else f"$ eccentric {' '.join(command.split())}\n"
    return f"{line}--- status {status}\n{''.join(texts)}\n"


def _run(job: Job) -> int:
    """Run a job and write NAME.txt; 3 if a command has ended with an exception."""
    folder, printed = Path(job.name), Path(f"{job.name}.txt")
    printed.parent.mkdir(parents=True, exist_ok=True)
    if job.name.startswith("documents/"):
        folder.mkdir(parents=True, exist_ok=True)  # where a command writes beside others, it makes no folder
    if job.name.startswith("refusals/") and len(job.commands) > 10:
        importlib.import_module("eccentric").load_model("c2_parallel")  # once, not before each refusal
    text = "".join(map(_recorded, job.commands))
    printed.write_text(text, encoding="utf-8")
    return EXCEPTION if "--- status 70" in text else 0


def run_all(chosen: Iterable[Job], processes: int) -> dict[str, int]:
    """Run jobs, the longest first, a few at a time; return the status of those that have one."""
    waiting = sorted(chosen, key=lambda job: -job.seconds)
    total, running, failed, done = len(waiting), dict[int, tuple[Job, float]](), dict[str, int](), 0
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
            failed[job.name] = os.waitstatus_to_exitcode(status)
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
    for name in ("scipy.optimize", "scipy.signal", "matplotlib.backends.backend_agg", "bokeh.plotting"):
        with suppress(ImportError):
            importlib.import_module(name)


def _inside(arguments: argparse.Namespace) -> int:
    """The part that runs in the folder, with the tree's code."""
    package = Path(str(importlib.import_module("eccentric").__file__))
    if not package.is_relative_to(arguments.tree):
        print(f"{package}: expected the package of {arguments.tree}")
        return 1
    prepare(Path(INPUTS))
    every = arguments.part == "all"
    wanted = re.compile(arguments.only)
    chosen = [
        job
        for job in jobs(arguments.tree, arguments.data, every=every)
        if (every or job.core) and wanted.search(job.name)
    ]
    if sum(len(job.commands) for job in chosen) > 20:  # imports take as long as twenty short commands
        _preload()
    gc.freeze()  # a collection in a forked process would copy every page of this one
    failed = run_all(chosen, arguments.processes)
    for name, status in sorted(failed.items()):
        reason = (
            "a command ended with an exception" if status == EXCEPTION else f"not frozen, status {status}"
        )
        print(f"{name}: {reason}, see {name}.txt")
    return int(any(status != EXCEPTION for status in failed.values()))


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
    settings = {"ECCENTRIC_PROGRESS": "off", "NO_COLOR": "1", "COLUMNS": "100", "OMP_NUM_THREADS": "1"}
    settings |= {"PYTHONUTF8": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    settings["PYTHONPATH"] = os.pathsep.join([str(tree.resolve()), str(ROOT)])
    run = [sys.executable, "-P", str(Path(__file__).resolve()), "--inside", "--tree", str(tree.resolve())]
    run += ["--part", arguments.part, "--only", arguments.only, "--processes", str(arguments.processes)]
    run += [] if arguments.data is None else ["--data", "data"]
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
        if out / INPUTS in path.parents:
            continue
        if path.suffix in {".png", ".parquet"}:
            path.unlink()
        elif path.suffix == ".gz":
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
    """Freeze; status 1 if something could not be frozen, 2 if nothing was started."""
    layout = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=layout)
    parser.add_argument("--part", choices=PARTS, default="core", help="core takes two minutes (default)")
    parser.add_argument("--tree", type=Path, default=ROOT, help="the tree that is frozen (this one)")
    parser.add_argument("--rev", help="a commit instead of the tree as it is, from a temporary worktree")
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
    name = f"{_named(arguments.tree, arguments.rev)}-{arguments.part}"
    out = arguments.out or ROOT.parent / "frozen" / name
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
