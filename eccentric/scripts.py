"""Scripts that are loaded by path, and texts that are run as modules; what a script loaded is on record."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

__all__ = ["Script", "asks", "run_script", "run_text", "scripts_behind"]


@dataclass(frozen=True)
class Script:
    """A script as it was executed.

    Attributes:
        asked: the name or path by which it was asked for.
        path: the file that this meant.
        text: what was executed, which the file may no longer hold.
    """

    asked: str
    path: Path
    text: bytes


_executed: dict[Path, set[bytes]] = {}
_loads: dict[Path, dict[str, Path]] = {}
_running: list[Path] = []


def asks(asked: str, path: Path) -> None:
    """Put on record that the script that is running, if one is, loads another."""
    if _running:
        _loads[_running[-1]][asked] = path


def run_script(path: Path, name: str) -> ModuleType:
    """The module of that name that a script makes. It is compiled from its text, never from older bytecode.

    The module stays in `sys.modules` unless the script fails: a dataclass under postponed annotations looks
    its module up there. Whatever the script raises is raised.
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
    """The module of that name that a text makes; `origin` is what tracebacks call it."""
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
    """A script that was executed, and all that it loaded, and they in turn.

    None if one of them was edited while this process ran, and executed before and after.
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
