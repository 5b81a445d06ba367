"""Scripts loaded by path, and source text run as modules; what a script loads is recorded."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType


@dataclass(frozen=True)
class Script:
    """A script as it was executed.

    Attributes:
        asked: the name or path that was requested.
        path: the file that this resolved to.
        text: the source that was executed; the file may have changed since.
    """

    asked: str
    path: Path
    text: bytes


_executed: dict[Path, set[bytes]] = {}
_loads: dict[Path, dict[str, Path]] = {}
_running: list[Path] = []


def asks(asked: str, path: Path) -> None:
    """Record that the running script, if any, loads another."""
    if _running:
        _loads[_running[-1]][asked] = path


def run_script(path: Path, name: str) -> ModuleType:
    """The module of that name from a script. It is compiled from its source, never from older bytecode.

    The module stays in `sys.modules` unless the script fails: a dataclass with postponed annotations looks
    its module up there. Exceptions of the script propagate.
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
    """The module of that name from source text; `origin` is its name in tracebacks."""
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
    """A script that was executed, and all that it loaded, recursively.

    None if one of them was edited while this process ran, and executed both before and after.
    """
    found: list[Script] = []
    left = [(asked, path)]
    while left:
        asked, path = left.pop()
        if len(_executed[path]) > 1:
            return None
        script = Script(asked, path, *_executed[path])
        if script not in found:
            found.append(script)
            left += _loads[path].items()
    return tuple(found)


def loads_behind(path: Path) -> dict[str, dict[str, str]]:
    """What an executed script loaded, and what that loaded: path -> name or path as requested -> path."""
    found: dict[str, dict[str, str]] = {}
    left = [path]
    while left:
        path = left.pop()
        if str(path) not in found:
            found[str(path)] = {asked: str(other) for asked, other in _loads[path].items()}
            left += _loads[path].values()
    return found


def remember_loads(loads: Mapping[str, Mapping[str, str]]) -> None:
    """Record as executed the scripts of a result that was kept; the argument is that of `loads_behind`."""
    for name, others in loads.items():
        path = Path(name)
        _executed.setdefault(path, set()).add(path.read_bytes())
        _loads[path] = {asked: Path(other) for asked, other in others.items()}
