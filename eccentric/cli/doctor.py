"""`eccentric doctor`: what is installed, what is missing, and what that costs; what a file is."""

import argparse
import os
import platform
import shlex
import shutil
import subprocess
import sys
import webbrowser
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import eccentric
from eccentric.cli.arguments import coloured
from eccentric.core import TARGETS, InputError
from eccentric.version import __version__

NAME = "doctor"
HELP = "show what is installed and how to install what is missing; given files, how each is read as a log"
EXAMPLE = """eccentric doctor
eccentric doctor my_log.csv"""

_CORE = ("numpy", "sympy", "scipy", "jinja2")
_BROWSERS = ("firefox", "chromium", "chromium-browser", "google-chrome", "microsoft-edge", "epiphany")
_EXTRAS = {
    "figures": (("matplotlib",), "figures of a fit and of the paper"),
    "report": (("matplotlib", "bokeh"), "figures in the report of a diagnosis"),
    "arms": (("yourdfpy",), "arms in URDF files"),
    "arms-bench": (("mujoco-core",), "the virtual bench for arms"),
    "exports": (("mujoco-core", "fmpy"), "running exports (mujoco-core: mjcf, budget, urdf; fmpy: fmu)"),
    "fleet": (("dask", "distributed", "pyarrow"), "the logs of a fleet"),
    **{t.extra: (t.packages, f"the {t.meaning}") for t in TARGETS.values() if t.extra},
    "completion": (("argcomplete",), "shell completion"),
}
"""Extra of `pyproject.toml` other than those of log formats: its packages, and what it is for."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `doctor` to `parser`."""
    parser.add_argument(
        "files",
        metavar="FILE",
        nargs="*",
        help="logs to describe: format, columns and sampling rate",
    )


def run(args: argparse.Namespace) -> int:
    """Print what is installed, or what the files are; return 1 if part of the core, or a log, is missing."""
    if args.files:
        return max([_described(file) for file in args.files])
    print(
        f"eccentric {__version__}, Python {platform.python_version()}"
        f" on {platform.system()} {platform.machine()}"
    )
    missing = [package for package in _CORE if _version(package) is None]
    print("core: " + ", ".join(f"{package} {_version(package) or 'MISSING'}" for package in _CORE))
    print(f"C compiler: {_compiler()}")
    print(f"browser for --open: {_browser()}")
    extras = _of_formats() | _EXTRAS
    width = max(map(len, extras))
    for extra, (packages, purpose) in extras.items():
        found = {package: _version(package) for package in packages}
        said = [f"{package} {number}" for package, number in found.items() if number]
        if absent := [package for package, number in found.items() if not number]:
            fix = f'{" and ".join(absent)} missing: pip install "eccentric[{extra}]"'
            said.append(coloured(fix, "warning"))
        print(f"{extra:{width}}  {purpose}: {', '.join(said)}")
    return 1 if missing else 0


def _described(file: str) -> int:
    """Print what a file is; 1 if it cannot be read as a log."""
    from eccentric.logs import format_of

    try:
        print(eccentric.describe_log(file).summary())
    except InputError as error:
        with suppress(InputError, OSError):
            print(f"{file}: not readable: {format_of(Path(file)).title}")
            error = error.inside(file)
        print(coloured(str(error), "error"))
        return 1
    return 0


def _of_formats() -> dict[str, tuple[tuple[str, ...], str]]:
    """The extras that formats of logs need, with the packages, and the suffixes that they are for."""
    from eccentric.logs import FORMATS

    found: dict[str, tuple[tuple[str, ...], str]] = {}
    for one in (one for one in FORMATS if one.extra):
        packages, purpose = found.get(one.extra, ((), "logs in "))
        suffixes = f"{', '.join(one.suffixes)}{f' of {one.extra_for}' if one.extra_for else ''}"
        purpose += suffixes if not packages else f", {suffixes}"
        found[one.extra] = tuple(dict.fromkeys((*packages, *one.packages))), purpose
    return found


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _compiler() -> str:
    """As `compile` finds it: CC, else cc, gcc or clang."""
    given = shlex.split(os.environ.get("CC", ""))[:1]
    path = next(filter(None, map(shutil.which, given or ["cc", "gcc", "clang"])), None)
    if path is None:
        return f"none ({given[0]} in CC is not installed)" if given else "none: compile and adapt need one"
    done = subprocess.run([path, "--version"], capture_output=True, text=True, check=False)
    return (done.stdout.splitlines() or [path])[0]


def _browser() -> str:
    if sys.platform.startswith("linux") and not {"DISPLAY", "WAYLAND_DISPLAY"} & set(os.environ):
        there = next(filter(shutil.which, _BROWSERS), None)
        found = f"{there}, but there is no display" if there else "none, and no display"
        return f"{found}: copy report.html, a single file, to a computer that has one"
    try:
        return str(getattr(webbrowser.get(), "name", "that of the system"))
    except webbrowser.Error:
        return "none found: open report.html in any browser"
