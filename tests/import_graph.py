"""The graph of imports of a folder of Python files, read from the sources: nothing is executed."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

Graph = Mapping[str, set[str]]


@cache
def tree_of(path: Path) -> ast.Module:
    """The syntax tree of a file, parsed once."""
    return ast.parse(path.read_text(encoding="utf-8"))


def names_imported(path: Path, package: tuple[str, ...]) -> Iterator[str]:
    """Yield the absolute dotted names that a file imports; `package` is where relative imports start.

    Imports inside functions and those for types only count as well: they are knowledge of the other file.
    """
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) + 1 - node.level] if node.level else ()
            yield from (".".join([*base, *filter(None, [node.module]), alias.name]) for alias in node.names)


def module_of(path: Path) -> str:
    """The dotted name of a file; that of its package for a door, `__init__.py`."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def files_of(folder: str) -> dict[str, Path]:
    """Every Python file below a top-level folder, by its dotted name."""
    return {module_of(path): path for path in sorted((ROOT / folder).rglob("*.py"))}


def graph_of(files: Mapping[str, Path]) -> dict[str, set[str]]:
    """File -> those of the files that it imports; of a name that a door exports, the door."""
    exported = {f"{door}.{name}" for door, path in files.items() for name in exports_of(path)}
    return {module: set(_found(module, path, files, exported)) - {module} for module, path in files.items()}


def exports_of(path: Path) -> set[str]:
    """What a door exports: its `__all__`, else the names that it imports from its own files; else nothing."""
    if path.name != "__init__.py":
        return set()
    inside, body = f"{module_of(path)}.", tree_of(path).body
    for node in body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            return set(ast.literal_eval(node.value))
    return {
        alias.asname or alias.name
        for node in body
        if isinstance(node, ast.ImportFrom) and f"{node.module}.".startswith(inside)
        for alias in node.names
    }


def _found(module: str, path: Path, files: Mapping[str, Path], exported: set[str]) -> Iterator[str]:
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    for name in names_imported(path, tuple(package.split("."))):
        parts = name.split(".")
        through_door = name in exported and not module.startswith(f"{'.'.join(parts[:-1])}.")
        outward = (".".join(parts[:k]) for k in range(len(parts) - through_door, 0, -1))
        if found := next((candidate for candidate in outward if candidate in files), None):
            yield found


def circle_in(graph: Graph) -> list[str]:
    """A circle of imports, empty if there is none."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def levels_of(graph: Graph) -> list[list[str]]:
    """The nodes by level, from those that import nothing: each is one above the highest that it imports."""
    level: dict[str, int] = {}
    for node in TopologicalSorter(graph).static_order():
        level[node] = 1 + max((level[other] for other in graph.get(node, ())), default=-1)
    return [sorted(n for n in level if level[n] == k) for k in range(max(level.values(), default=-1) + 1)]


def drawn(levels: list[list[str]], graph: Graph) -> str:
    """The levels, the highest first, each node with what it imports."""
    lines: list[str] = []
    for k, nodes in reversed(list(enumerate(levels, start=1))):
        lines += [f"{k}: {node:12} <- {', '.join(sorted(graph.get(node, ()))) or '-'}" for node in nodes]
    return "\n".join(lines)
