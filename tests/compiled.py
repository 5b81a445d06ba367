"""The emitted C99, compiled and called through cffi."""

import hashlib
import re
import shutil
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import cffi
import numpy as np

import eccentric
from tests.emitted import width
from tests.paper import Parameters

GENERATED = Path(__file__).resolve().parent.parent / "generated"
FLAGS = [
    "-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-Werror"
]  # fmt: skip
REAL = {np.float64: "double", np.float32: "float"}
Real = type[np.floating]
CData = Any  # cffi gives its objects no type


def run(*command: str | Path, source: str | None = None) -> str:
    """Run a tool and return what it prints; what it complains of becomes the failure."""
    done = subprocess.run(command, input=source, capture_output=True, text=True, check=False)
    assert (0, "") == (done.returncode, done.stderr), done.stderr
    return done.stdout


@cache
def _kept() -> TemporaryDirectory[str]:
    """A folder that lasts as long as this process."""
    return TemporaryDirectory(prefix="emitted-")


def emitted_once(folder: Path, model: Any, **asked: Any) -> Path:
    """Emit a model into `folder`; one with a name is a copy of what this process has emitted so before."""
    if not isinstance(model, str):
        eccentric.emit(model, folder, **asked)
        return folder
    kept = Path(_kept().name) / hashlib.sha256(repr((model, asked)).encode()).hexdigest()
    if not kept.is_dir():
        eccentric.emit(model, kept, **asked)
    return Path(shutil.copytree(kept, folder))


def declarations(name: str, real: str) -> str:
    """Return the header as cffi reads it: preprocessed, nothing of the system's, constants as variables."""
    text = re.sub(r"^#\s*include\s*<.*$", "", (GENERATED / f"{name}.h").read_text(), flags=re.MULTILINE)
    plain = run("gcc", "-E", "-P", f"-DECCENTRIC_REAL={real}", "-", source=text)
    return plain.replace("extern const", "extern")


class Library:
    """One model, compiled in one precision; further options of the compiler may define macros."""

    def __init__(self, name: str, dtype: Real, folder: Path, *options: str) -> None:
        self.name, self.dtype, self.real = name, dtype, REAL[dtype]
        path = folder / f"{name}_{self.real}.so"
        run(
            "gcc",
            *FLAGS,
            *options,
            "-shared",
            "-fPIC",
            f"-DECCENTRIC_REAL={self.real}",
            "-o",
            path,
            GENERATED / f"{name}.c",
            "-lm",
        )
        self.ffi = cffi.FFI()
        self.declarations = declarations(name, self.real)
        self.ffi.cdef(self.declarations)
        self.lib: Any = self.ffi.dlopen(str(path))

    def __getitem__(self, function: str) -> Callable[..., Any]:
        """Return the C function without its prefix, and without the precision that its name ends in."""
        return getattr(self.lib, f"{self.name}_{function}_{self.real}")

    def names(self) -> set[str]:
        """Return the names of the functions, without prefix and precision."""
        return set(re.findall(rf"\b{self.name}_(\w+)_{self.real}\s*\(", self.declarations))

    def coefficients(self, values: Parameters = None) -> CData:
        """Return the prepared coefficients of a NumPy Parameters; None is the default set."""
        if values is None:
            return self.ffi.addressof(self.lib, f"{self.name}_default_{self.real}")
        given_values = self.ffi.new(f"{self.name}_parameters *")
        for field in dir(given_values):
            value = getattr(values, field)
            absent = values.M_l * values.g if field == "F_T" else float("nan")
            setattr(given_values, field, absent if value is None else value)
        prepared = self.ffi.new(f"{self.name}_coefficients *")
        self["prepare"](given_values, prepared)
        return prepared

    def pointer(self, array: np.ndarray) -> CData:
        """Return a C pointer to an array of the library's precision."""
        return self.ffi.from_buffer(f"{self.real}[]", array.data)

    def one(self, function: str, states: list[Any], coefficients: CData) -> np.ndarray:
        """Call the function of one sample."""
        shape, numbers = width(self.name, function), [float(x) for x in states]
        if not shape:
            return np.asarray(self[function](*numbers, coefficients), self.dtype)
        out = np.full(shape, np.nan, self.dtype)
        self[function](*numbers, self.pointer(out), coefficients)
        return out

    def call(self, function: str, states: list[np.ndarray], coefficients: CData) -> np.ndarray:
        """Call the function of n samples, or where there is nothing to sample that of none."""
        return (self.many if states else self.one)(function, states, coefficients)

    def many(self, function: str, states: list[np.ndarray], coefficients: CData) -> np.ndarray:
        """Call the function of n samples."""
        out = np.full((len(states[0]), *width(self.name, function)), np.nan, self.dtype)
        pointers = [self.pointer(np.ascontiguousarray(x)) for x in states]
        self[function + "_n"](len(states[0]), *pointers, self.pointer(out), coefficients)
        return out
