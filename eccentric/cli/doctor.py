"""`eccentric doctor`: what is installed, what is missing, and what that costs."""

import argparse
import os
import platform
import shlex
import shutil
import subprocess
import sys
import webbrowser
from importlib.metadata import PackageNotFoundError, version

from eccentric.cli.arguments import coloured
from eccentric.version import __version__

NAME = "doctor"
HELP = "show Python, packages, compiler and browser, and what to install for what is missing"
EXAMPLE = "eccentric doctor"

_CORE = ("numpy", "sympy", "scipy", "jinja2")
_BROWSERS = ("firefox", "chromium", "chromium-browser", "google-chrome", "microsoft-edge", "epiphany")
_EXTRAS = {
    "figures": (("matplotlib",), "figures of a fit and of the paper"),
    "report": (("matplotlib", "bokeh"), "figures in the report of a diagnosis"),
    "parquet": (("pyarrow",), "logs in .parquet, and tables of pandas or polars"),
    "mat73": (("h5py",), "logs in .mat of version 7.3"),
    "hdf5": (("h5py",), "logs in .h5"),
    "mdf": (("asammdf",), "logs in .mf4 and .mdf"),
    "rosbag": (("rosbags",), "ROS 2 bags .db3"),
    "mcap": (("mcap", "rosbags"), "recordings in .mcap"),
    "ulog": (("pyulog",), "logs of PX4, .ulg"),
    "tdms": (("nptdms",), "logs of LabVIEW, .tdms"),
    "arms": (("yourdfpy",), "arms by URDF"),
    "arms-bench": (("mujoco-core",), "the virtual bench of an arm"),
    "fleet": (("dask", "distributed", "pyarrow"), "the logs of a fleet"),
    "jax": (("jax",), "the JAX module"),
    "completion": (("argcomplete",), "completion in the shell"),
}
"""Extra of `pyproject.toml`: its packages, and what it is for."""


def configure(parser: argparse.ArgumentParser) -> None:
    """`doctor` has no arguments of its own."""


def run(_: argparse.Namespace) -> int:
    """Print a line for each; return 1 if something of the core is missing."""
    print(
        f"eccentric {__version__}, Python {platform.python_version()}"
        f" on {platform.system()} {platform.machine()}"
    )
    missing = [package for package in _CORE if _version(package) is None]
    print("core: " + ", ".join(f"{package} {_version(package) or 'MISSING'}" for package in _CORE))
    print(f"C compiler: {_compiler()}")
    print(f"browser for --open: {_browser()}")
    width = max(map(len, _EXTRAS))
    for extra, (packages, purpose) in _EXTRAS.items():
        found = {package: _version(package) for package in packages}
        said = (
            ", ".join(f"{package} {number}" for package, number in found.items())
            if all(found.values())
            else coloured(f'missing: pip install "eccentric[{extra}]"', "warning")
        )
        print(f"{extra:{width}}  {purpose}: {said}")
    return 1 if missing else 0


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
