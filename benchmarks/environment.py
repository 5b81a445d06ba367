"""The environment of the peers: build/bench-env, separate from the project's own."""

from __future__ import annotations

import subprocess
import venv
from pathlib import Path

FOLDER = Path(__file__).resolve().parent.parent / "build" / "bench-env"
PYTHON = FOLDER / "bin" / "python"
_ABSENT = "import importlib.util, sys; print(*(p for p in sys.argv[1:] if not importlib.util.find_spec(p)))"
_VERSIONS = (
    "import importlib.metadata as m, sys; print(*(f'{p} {m.version(p)}' for p in sys.argv[1:]), sep=', ')"
)


def absent(*packages: str) -> dict[str, str]:
    """Install the missing packages; package -> reason, for those that cannot be installed."""
    if not PYTHON.exists():
        venv.create(FOLDER, with_pip=True)
    reasons = {}
    for package in _said(_ABSENT, *packages).split():
        command = [PYTHON, "-m", "pip", "install", "-q", "--disable-pip-version-check", package]
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
        except subprocess.TimeoutExpired:
            reasons[package] = "its installation takes more than ten minutes"
            continue
        if done.returncode:
            errors = [line for line in done.stderr.splitlines() if line.startswith("ERROR: ")]
            reasons[package] = (errors or ["pip fails"])[-1].removeprefix("ERROR: ")
    return reasons


def versions(*packages: str) -> str:
    """The versions of installed packages, in one line."""
    return _said(_VERSIONS, *packages).strip()


def _said(code: str, *arguments: str) -> str:
    return subprocess.run([PYTHON, "-c", code, *arguments], capture_output=True, text=True, check=True).stdout
