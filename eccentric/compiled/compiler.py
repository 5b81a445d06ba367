"""The local C compiler: its identity, and shared libraries built by it."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from eccentric.errors import InputError

# None of these changes a bit of the results: no product is fused with a sum, nothing is re-associated.
_FLAGS = (
    *("-std=c99", "-O3", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math", "-march=native"),
    "-fPIC",
)
# The symbols of Python exist when the library is loaded; only this linker has to allow that.
_LINK = ("-shared", *(("-undefined", "dynamic_lookup") if sys.platform == "darwin" else ()))


@dataclass(frozen=True)
class Compiler:
    """A compiler of C.

    Attributes:
        command: its path, and options that CC has.
        identity: what determines a library besides its sources: the compiler, its options, the processor.
    """

    command: tuple[str, ...]
    identity: str

    def build(self, sources: Mapping[str, str], unit: str, folder: Path) -> Path:
        """The shared library of one of the C sources, name -> text, in both precisions; built in the folder.

        Raises:
            InputError: it does not compile.
        """
        for name, text in sources.items():
            (folder / name).write_text(text, encoding="utf-8")
        command = [*self.command, *_FLAGS]
        objects = [f"{real}.o" for real in ("float", "double")]
        compiling = [
            _start([*command, f"-DECCENTRIC_REAL={made.removesuffix('.o')}", "-c", "-o", made, unit], folder)
            for made in objects
        ]
        for process in compiling:
            _finish(process)
        _finish(_start([*command, *_LINK, "-o", "library.so", *objects, "-lm"], folder))
        return folder / "library.so"


def local_compiler() -> Compiler:
    """The command in CC, options included, as in make; else the first of cc, gcc and clang.

    Raises:
        InputError: there is no compiler, CC names a missing one, or it does not work.
    """
    command = _command()
    # Its predefined macros identify its version and the target processor.
    macros = _finish(_start([*command, *_FLAGS, "-dM", "-E", "-x", "c", os.devnull]))
    file = Path(command[0]).resolve().stat()
    stamp = f"{file.st_mtime_ns} {file.st_size}"
    return Compiler(tuple(command), "\0".join((*command, *_FLAGS, *_LINK, stamp, macros)))


def _command() -> list[str]:
    given = os.environ.get("CC", "")
    try:
        commands = [command] if (command := shlex.split(given)) else [["cc"], ["gcc"], ["clang"]]
    except ValueError as error:
        raise InputError(
            f"compile: CC: a command with its options is required, received {given!r}: {error}"
        ) from None
    for command in commands:
        if path := shutil.which(command[0]):
            return [path, *command[1:]]
    if given.strip():
        raise InputError(f"compile: CC: a C compiler that is installed is required, received {given!r}")
    raise InputError("compile: a C compiler (CC, cc, gcc or clang) is required, received none")


def _start(command: Sequence[str], folder: Path | None = None) -> subprocess.Popen[str]:
    pipe = subprocess.PIPE
    return subprocess.Popen(
        command, cwd=folder, stdin=subprocess.DEVNULL, stdout=pipe, stderr=pipe, text=True
    )


def _finish(process: subprocess.Popen[str]) -> str:
    output, complaint = process.communicate()
    if process.returncode:
        command = process.args[0] if isinstance(process.args, list) else process.args
        said = (complaint.strip() or f"exit status {process.returncode}").splitlines()[0]
        raise InputError(
            f"compile: {command}: a C99 compiler that takes {' '.join(_FLAGS)} is required, received {said}"
        )
    return output
