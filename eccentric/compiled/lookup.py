"""Look up before deriving: find the cache entry of a derivation from the sources that determine it.

A derivation takes a second, and importing SymPy half a second. So the cache records, for each compiled
derivation, the scripts that it loaded, and the toolkit, the libraries and the compiler that were used.
If none of them has changed, the library would be built the same way again.

That holds for a script whose source alone determines the model. One that opens files, or imports a module
that is neither ours nor known to compute only, may give a different model next time: it is always derived.
"""

from __future__ import annotations

import ast
import hashlib
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from itertools import chain
from pathlib import Path, PurePath

from eccentric import started
from eccentric.compiled.compiler import Compiler
from eccentric.compiled.entry import CacheEntry, read_entry, read_record, write_record
from eccentric.output import digest
from eccentric.places import derivation, folder
from eccentric.scripts import scripts_behind

_ROOMS = ("output", "model", "effects", "emission", "compiled")
_LIBRARIES = ("sympy", "mpmath", "jinja2")
_OURS = ("eccentric.model", "eccentric.effects", "eccentric.errors", "eccentric.output")
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
    if max(path.stat().st_ctime for path in _toolkit()) > started.imported_at - 0.05:
        return
    behind = [(script.asked, str(script.path), _contents(script.text)) for script in scripts]
    write_record(_name(asked, compiler), {"scripts": behind, "entry": entry})


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
