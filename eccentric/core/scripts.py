"""Scripts loaded by path and source text executed as modules; the scripts they load are recorded."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType


@dataclass(frozen=True)
class Script:
    """An executed script.

    Attributes:
        asked: the requested name or path.
        path: the file it resolved to.
        text: the executed source; the file may have changed since.
    """

    asked: str
    path: Path
    text: bytes


_executed: dict[Path, set[bytes]] = {}
_loads: dict[Path, dict[str, Path]] = {}
_running: list[Path] = []


def asks(name: str, path: Path) -> None:
    """Record that the running script, if any, loads another."""
    if _running:
        _loads[_running[-1]][name] = path


def run_script(path: Path, name: str) -> ModuleType:
    """Execute a script as the module `name`, compiled from its source, never from cached bytecode.

    The module stays in `sys.modules` unless the script fails, since a dataclass with postponed annotations
    looks its module up there. Exceptions of the script propagate.
    """
    text = path.read_bytes()
    _executed.setdefault(path, set()).add(text)
    _loads.setdefault(path, {})
    _running.append(path)
    try:
        return run_text(text, name, str(path))
    finally:
        _running.pop()


def run_text(text: str | bytes, name: str, origin: str) -> ModuleType:
    """Execute source text as the module `name`; `origin` is its file name in tracebacks."""
    module = ModuleType(name)
    module.__file__ = origin
    sys.modules[name] = module
    try:
        exec(compile(text, origin, "exec", dont_inherit=True), module.__dict__)  # noqa: S102
    except BaseException:
        del sys.modules[name]
        raise
    return module


def scripts_behind(asked: str, path: Path) -> tuple[Script, ...] | None:
    """An executed script and all scripts it loaded, recursively.

    None if one of them was executed in two versions, that is, edited while this process ran.
    """
    scripts: list[Script] = []
    pending = [(asked, path)]
    while pending:
        asked, path = pending.pop()
        if len(_executed[path]) > 1:
            return None
        script = Script(asked, path, *_executed[path])
        if script not in scripts:
            scripts.append(script)
            pending += _loads[path].items()
    return tuple(scripts)


def loads_behind(path: Path) -> dict[str, dict[str, str]]:
    """The scripts loaded by an executed script, recursively: path -> requested name or path -> path."""
    loads: dict[str, dict[str, str]] = {}
    pending = [path]
    while pending:
        path = pending.pop()
        if str(path) not in loads:
            loads[str(path)] = {name: str(other) for name, other in _loads[path].items()}
            pending += _loads[path].values()
    return loads


def remember_loads(loads: Mapping[str, Mapping[str, str]]) -> None:
    """Record the scripts of a cached result as executed; `loads` is as returned by `loads_behind`."""
    for name, others in loads.items():
        path = Path(name)
        _executed.setdefault(path, set()).add(path.read_bytes())
        _loads[path] = {requested: Path(other) for requested, other in others.items()}
