"""Look before deriving: which entry of the cache a derivation stands for, by the texts that it was made of.

A derivation takes a second, and SymPy half of one to import. So the cache keeps, for each derivation that was
compiled, the scripts that it loaded, and the toolkit, the libraries and the compiler that it went through.
If none of them has changed, what it was built into is what it would be built into.

That holds for a script whose text decides what model it is. One that opens files, or imports what is neither
ours nor known to compute only, may give another model tomorrow: it is derived every time.
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
from eccentric.compiled.entry import Entry, digest, read_entry, read_record, write_record
from eccentric.places import derivation, folder
from eccentric.scripts import scripts_behind

_ROOMS = ("model", "effects", "emission", "compiled")
_LIBRARIES = ("sympy", "mpmath", "jinja2")
_OURS = ("eccentric.model", "eccentric.effects", "eccentric.errors", "eccentric.output")
_COMPUTES = (
    *("__future__", "abc", "cmath", "collections", "dataclasses", "decimal", "enum", "fractions"),
    *("functools", "itertools", "math", "mpmath", "numbers", "operator", "pathlib", "re", "string"),
    *("sympy", "typing"),
)
_READS = {"open", "exec", "eval", "compile", "__import__", "input"} | (
    # What a path does beyond putting names together. Models are `replace`d, too.
    set(dir(Path)) - set(dir(PurePath)) - {"absolute", "resolve", "replace"}
)


def look_up(asked: str | Path, compiler: Compiler) -> Entry | None:
    """The entry that a derivation, by name or path, was built into; None if it has to be derived."""
    record = read_record(_name(asked, compiler))
    if record is None or not all(_is_same(*script) for script in record["scripts"]):
        return None
    return read_entry(*record["entry"])


def remember(asked: str | Path, compiler: Compiler, entry: tuple[str, str]) -> None:
    """Keep which entry, by name and key, a derivation that was just loaded was built into.

    Nothing is kept that may be wrong: where a script's text does not decide, or where a source was changed
    while this process ran, which then holds other code than the files do.
    """
    scripts = scripts_behind(str(asked), derivation(asked))
    if scripts is None or not all(_decides(script.text) for script in scripts):
        return
    # A file's time stamp comes from a clock that may be some milliseconds late.
    if max(path.stat().st_ctime for path in _toolkit()) > started.imported_at - 0.05:
        return
    behind = [(script.asked, str(script.path), _contents(script.text)) for script in scripts]
    write_record(_name(asked, compiler), {"scripts": behind, "entry": entry})


def _name(asked: str | Path, compiler: Compiler) -> str:
    """Under which name a derivation is looked up: its place, and all that every derivation goes through."""
    path = derivation(asked)
    parts = [str(path), str(Path.cwd()), sys.version, compiler.identity]
    parts += [_stamp(spec.origin) for spec in map(find_spec, _LIBRARIES) if spec and spec.origin]
    texts = (part for source in _toolkit() for part in (str(source), source.read_bytes()))
    return f"{path.stem}_{digest(chain(parts, texts))}"


def _toolkit() -> Iterator[Path]:
    """The sources of all that a derivation goes through."""
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
    """Whether a script brings in nothing that its text does not tell, but for what it loads on record."""
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
