"""The emitted C99, compiled and called through cffi."""

import hashlib
import re
import shutil
import subprocess
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

import cffi
import numpy as np

import eccentric
from eccentric.emission import executed, executed_beside
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


def declarations(name: str, real: str, folder: Path = GENERATED) -> str:
    """Return the header as cffi reads it: preprocessed, nothing of the system's, constants as variables."""
    texts = [(folder / f"{name}.h").read_text()]
    texts += [path.read_text() for path in folder.glob(f"{name}_*.h")]
    text = re.sub(r"^#\s*include.*$", "", "\n".join(texts), flags=re.MULTILINE)
    plain = run("gcc", "-E", "-P", f"-DECCENTRIC_REAL={real}", "-", source=text)
    return plain.replace("extern const", "extern")


class CFunctions:
    """The C of a model, and what was emitted beside it, compiled in one precision."""

    def __init__(
        self, name: str, dtype: Real, library: Path, source: Path, *options: str, compiler: str = "gcc"
    ) -> None:
        self.name, self.dtype, self.real = name, dtype, REAL[dtype]
        files = [source / f"{name}.c", *source.glob(f"{name}_*.c")]
        define = f"-DECCENTRIC_REAL={self.real}"
        run(compiler, *FLAGS, *options, "-shared", "-fPIC", define, "-o", library, *files, "-lm")
        self.ffi = cffi.FFI()
        self.declarations = declarations(name, self.real, source)
        self.ffi.cdef(self.declarations)
        self.lib: Any = self.ffi.dlopen(str(library))

    def __getitem__(self, function: str) -> Any:
        """Return what C calls so, without the prefix and the precision that its name ends in."""
        return getattr(self.lib, f"{self.name}_{function}_{self.real}")


class EmittedBeside(CFunctions):
    """A model with what was emitted beside it, an estimator or a compensation, and its default parameters.

    As Python has them: the constants of the C are rounded from 50 digits, and may differ in the last bit.
    """

    def __init__(self, folder: Path, name: str, dtype: Real, compiler: str = "gcc") -> None:
        library = folder.parent / f"{name}_{REAL[dtype]}_{compiler}.so"
        super().__init__(name, dtype, library, folder, compiler=compiler)
        self.parameters: Any = self.ffi.new(f"{name}_parameters *", self["default_parameters"])
        if hasattr(self.parameters, "F_T"):  # Python multiplies its default; C has it from 50 digits
            self.parameters.F_T = self.parameters.M_l * self.parameters.g
        self.coefficients: Any = self.ffi.new(f"{name}_coefficients *")
        assert 0 == self["prepare"](self.parameters, self.coefficients)


def python_beside(folder: Path, name: str, part: str) -> ModuleType:
    """The emitted Python of that part, executed with the model beside it."""
    files = {path.name: path.read_text(encoding="utf-8") for path in folder.glob("*.py")}
    return executed_beside(executed(files, name), name, files[f"{name}_{part}.py"])


class Library(CFunctions):
    """A committed model, compiled in one precision; further options of the compiler may define macros."""

    def __init__(self, name: str, dtype: Real, folder: Path, *options: str) -> None:
        super().__init__(name, dtype, folder / f"{name}_{REAL[dtype]}.so", GENERATED, *options)

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
