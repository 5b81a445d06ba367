"""Shared libraries of the emitted C, built by the local compiler and kept under what they were built from."""

from __future__ import annotations

import hashlib
import os
import shlex
import shutil
import subprocess
import sysconfig
from collections.abc import Mapping
from pathlib import Path

from eccentric.errors import InputError
from eccentric.output import folder_to_write, workshop

SHIM = "python-shim.c"
"""The file that calls the sources from Python: a name that no model has, whose names are identifiers of C."""

# None of these changes a bit: no product is fused with a sum, nothing is re-associated.
_FLAGS = ("-std=c99", "-O3", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math", "-march=native")


def python_headers() -> str | None:
    """The folder of Python's own headers, if they are installed."""
    folder = sysconfig.get_paths()["include"]
    return folder if (Path(folder) / "Python.h").exists() else None


def built(name: str, files: Mapping[str, str], real: str) -> Path:
    """The shared library of all C sources among the files, in one precision; from the cache where it has it.

    Raises:
        InputError: there is no C compiler, or not the one that CC names; it does not compile, or the cache
            cannot be written.
    """
    command = [*_compiler(), *_FLAGS, f"-DECCENTRIC_REAL={real}"]
    sources = {file: text for file, text in files.items() if file.endswith((".c", ".h"))}
    python = SHIM in files
    # What the compiler predefines tells its version and the processor that it builds for.
    machine = _run([*command, "-dM", "-E", "-x", "c", os.devnull])
    own = str(sysconfig.get_config_var("SOABI")) if python else ""
    key = "\0".join((*command, machine, own, *(f"{file}\0{text}" for file, text in sources.items())))
    folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "eccentric"
    library = folder / f"{name}_{real}_{hashlib.sha256(key.encode()).hexdigest()[:32]}.so"
    if not library.exists():
        with workshop(folder_to_write(folder)) as place:
            for file, text in sources.items():
                (place / file).write_text(text, encoding="utf-8")
            made = place / library.name
            included = [f"-I{python_headers()}"] if python else []
            paths = [str(place / file) for file in sources if file.endswith(".c")]
            _run([*command, "-shared", "-fPIC", *included, "-o", str(made), *paths, "-lm"])
            made.replace(library)
    return library


def _compiler() -> list[str]:
    """The command that CC is, options included, as make takes it; else the first of cc, gcc and clang."""
    given = os.environ.get("CC", "")
    try:
        commands = [command] if (command := shlex.split(given)) else [["cc"], ["gcc"], ["clang"]]
    except ValueError as error:
        raise InputError(
            f"compile: CC: required a command with its options, got {given!r}: {error}"
        ) from None
    for command in commands:
        if path := shutil.which(command[0]):
            return [path, *command[1:]]
    if given.strip():
        raise InputError(f"compile: CC: required a C compiler that is installed, got {given!r}")
    raise InputError("compile: required a C compiler (CC, cc, gcc or clang), found none")


def _run(command: list[str]) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        told = (done.stderr.strip() or f"exit status {done.returncode}").splitlines()[0]
        raise InputError(
            f"compile: {command[0]}: required a C99 compiler that takes {' '.join(_FLAGS)}, got: {told}"
        )
    return done.stdout
