"""What the cache stores for a model: its shared library, and all that is needed to call it from Python.

A library is named after its content, so that processes which build one at the same time store the same.
"""

from __future__ import annotations

import ast
import hashlib
import json
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.util import find_spec
from itertools import chain
from pathlib import Path, PurePath
from typing import Any

from eccentric import import_time
from eccentric.core import (
    OURS_ALONE,
    InputError,
    cache_folder,
    derivation,
    digest,
    folder,
    own_bytes,
    own_cache,
    read_cached,
    scripts_behind,
    workshop,
    write_cached,
)


@dataclass(frozen=True)
class Signature:
    """A function as called from Python.

    Attributes:
        name: in the module.
        inputs: their names.
        width: numbers per sample; 0 for a single number that is not a row.
        requires: parameters without a default that are needed where the last input is not zero.
        length: entries of every input along its last axis; 0 where inputs are numbers.
        steps: whether friction may take no more of an acceleration than the inertia.
    """

    name: str
    inputs: tuple[str, ...]
    width: int
    requires: tuple[str, ...]
    length: int
    steps: bool


@dataclass(frozen=True)
class CacheEntry:
    """A model that has been built.

    Attributes:
        name: of the model.
        module: text of its emitted NumPy module.
        functions: in the order of the library.
        single, double: names of the coefficients in each precision, in the order of the C struct.
        library: file name of the library, which contains the digest of its content.
    """

    name: str
    module: str
    functions: tuple[Signature, ...]
    single: tuple[str, ...]
    double: tuple[str, ...]
    library: str


def read_entry(name: str, key: str) -> CacheEntry | None:
    """The entry of a model for that key, its library verified; None if there is none, or it is damaged."""
    found = read_record(f"{name}_{key}")
    if found is None:
        return None
    called = [
        Signature(f["name"], tuple(f["inputs"]), f["width"], tuple(f["requires"]), f["length"], f["steps"])
        for f in found["functions"]
    ]
    coefficients = tuple(found["single"]), tuple(found["double"])
    entry = CacheEntry(found["name"], found["module"], tuple(called), *coefficients, found["library"])
    held = own_bytes(cache_folder() / entry.library)
    return entry if held is not None and entry.library == _library_name(name, held) else None


def write_entry(key: str, entry: CacheEntry) -> None:
    """Store an entry for that key; its library is already in the cache."""
    _write(f"{entry.name}_{key}", asdict(entry))


def keep_library(name: str, build: Callable[[Path], Path]) -> str:
    """Move the library that `build` makes in a folder into the cache; return its file name there.

    Raises:
        InputError: the cache cannot be written, or what `build` raises.
    """
    with workshop(own_cache()) as place:
        made = build(place)
        file = _library_name(name, made.read_bytes())
        made.chmod(OURS_ALONE)
        made.replace(cache_folder() / file)
    return file


def read_record(name: str) -> dict[str, Any] | None:
    """The content of the cache for a name; None if there is none, or it is damaged."""
    found = read_cached(f"{name}.json")
    return None if found is None else json.loads(found)


def _write(name: str, content: dict[str, Any]) -> None:
    write_cached(f"{name}.json", json.dumps(content).encode())


def _library_name(name: str, held: bytes) -> str:
    return f"{name}_{digest([held])}.so"


# The local C compiler: its identity, and shared libraries built by it.


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
        raise InputError("compile: CC", "a command with its options", f"{given!r}: {error}") from None
    for command in commands:
        if path := shutil.which(command[0]):
            return [path, *command[1:]]
    if given.strip():
        raise InputError("compile: CC", "a C compiler that is installed", f"{given!r}")
    raise InputError("compile", "a C compiler (CC, cc, gcc or clang)", "none")


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
        raise InputError(f"compile: {command}", f"a C99 compiler that takes {' '.join(_FLAGS)}", said)
    return output


# Look up before deriving: find the cache entry of a derivation from the sources that determine it.
#
# A derivation takes a second, and importing SymPy half a second. So the cache records, for each compiled
# derivation, the scripts that it loaded, and the toolkit, the libraries and the compiler that were used.
# If none of them has changed, the library would be built the same way again.
#
# That holds for a script whose source alone determines the model. One that opens files, or imports a module
# that is neither ours nor known to compute only, may give a different model next time: it is always derived.


_ROOMS = ("core", "model", "effects", "emission", "compiled")
_LIBRARIES = ("sympy", "mpmath", "jinja2")
_OURS = ("eccentric.model", "eccentric.effects", "eccentric.output")
_OF_CORE = {"InputError", "show"}
"""Names of `eccentric.core` that read nothing."""
_COMPUTES = (
    *("__future__", "abc", "cmath", "collections", "dataclasses", "decimal", "enum", "fractions"),
    *("functools", "itertools", "math", "mpmath", "numbers", "operator", "pathlib", "re", "string"),
    *("sympy", "typing"),
)
_READS = {"open", "exec", "eval", "compile", "__import__", "input"} | (
    # Methods of a path that touch the file system. `replace` is omitted, since models have it as well.
    set(dir(Path)) - set(dir(PurePath)) - {"absolute", "resolve", "replace"}
)


def look_up(asked: str | Path, compiler: Compiler) -> CacheEntry | None:
    """The entry of a derivation, given by name or path; None if it has to be derived."""
    record = read_record(_name(asked, compiler))
    if record is None or not all(_is_same(*script) for script in record["scripts"]):
        return None
    return read_entry(*record["entry"])


def remember(asked: str | Path, compiler: Compiler, entry: tuple[str, str]) -> None:
    """Record the entry, by name and key, of a derivation that was just loaded.

    Nothing is recorded that may be wrong: if a script's source does not determine the model, or if a source
    was changed while this process ran, so that it runs different code than the files contain.
    """
    scripts = scripts_behind(str(asked), derivation(asked))
    if scripts is None or not all(_decides(script.text) for script in scripts):
        return
    # A file's time stamp comes from a clock that may lag by some milliseconds.
    if max(path.stat().st_ctime for path in _toolkit()) > import_time.imported_at - 0.05:
        return
    behind = [(script.asked, str(script.path), _contents(script.text)) for script in scripts]
    _write(_name(asked, compiler), {"scripts": behind, "entry": entry})


def _name(asked: str | Path, compiler: Compiler) -> str:
    """The name for looking up a derivation: its path, and everything that all derivations depend on."""
    path = derivation(asked)
    parts = [str(path), str(Path.cwd()), sys.version, compiler.identity]
    parts += [_stamp(spec.origin) for spec in map(find_spec, _LIBRARIES) if spec and spec.origin]
    texts = (part for source in _toolkit() for part in (str(source), source.read_bytes()))
    return f"{path.stem}_{digest(chain(parts, texts))}"


def _toolkit() -> Iterator[Path]:
    """The sources of everything that a derivation depends on."""
    package = Path(__file__).parents[1]
    yield from sorted(package.glob("*.py"))
    for room in _ROOMS:
        yield from sorted((package / room).rglob("*.py"))
    yield from sorted(folder("derivations").glob("*.py"))
    yield from sorted(folder("templates").rglob("*.jinja"))


def _stamp(file: str) -> str:
    found = Path(file).stat()
    return f"{file} {found.st_mtime_ns} {found.st_size}"


def _contents(text: bytes) -> str:
    return hashlib.sha256(text).hexdigest()


def _is_same(asked: str, path: str, contents: str) -> bool:
    try:
        return str(derivation(asked)) == path and _contents(Path(path).read_bytes()) == contents
    except OSError:
        return False


def _decides(text: bytes) -> bool:
    """Whether a script depends on nothing but its source and the scripts that it is recorded to load."""
    for node in ast.walk(ast.parse(text)):
        match node:
            case ast.Import(names=names):
                known = all(_is_known(alias.name) for alias in names)
            case ast.ImportFrom(module="eccentric", names=names, level=0):
                known = {alias.name for alias in names} <= {"load_model"}
            case ast.ImportFrom(module="eccentric.core", names=names, level=0):
                known = {alias.name for alias in names} <= _OF_CORE
            case ast.ImportFrom(module=str(module), level=0):
                known = _is_known(module)
            case ast.ImportFrom():
                known = False
            case ast.Name(id=name) | ast.Attribute(attr=name):
                known = name not in _READS
            case _:
                known = True
        if not known:
            return False
    return True


def _is_known(module: str) -> bool:
    return module.partition(".")[0] in _COMPUTES or any(
        module == ours or module.startswith(f"{ours}.") for ours in _OURS
    )
