"""Tables of results, and how they come into docs/measured-rigs.md: tables and terminal blocks are replaced, the prose stays."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

TABLE = re.compile(r"(?:^\|.*\n)+", re.MULTILINE)
TERMINAL = re.compile(r"```console\n.*?```", re.DOTALL)


Cell = float | list[float] | None
Table = dict[str, Any]


def table(columns: list[str], rows: Mapping[str, Sequence[Cell]]) -> Table:
    """A table, its numbers with six digits."""
    return {
        "columns": columns,
        "rows": {label: [_short(cell) for cell in row] for label, row in rows.items()},
    }


def _short(cell: Cell) -> Cell:
    if isinstance(cell, list):
        return [float(f"{x:.6g}") for x in cell]
    return None if cell is None else float(f"{cell:.6g}")


def write(path: Path, results: dict[str, Any]) -> None:
    """Put results into the page: the tables of a rig's section in their order, and what its command printed.

    SystemExit where a section is missing or has another number of tables.
    """
    parts = re.split(r"(?m)^(?=## )", path.read_text(encoding="utf-8"))
    for name, found in results.items():
        own = [k for k, part in enumerate(parts) if f"--rig examples/rigs/{name}.toml" in part]
        if len(own) != 1 or len(TABLE.findall(parts[own[0]])) != len(found["tables"]):
            raise SystemExit(f"{path}: expected one section with {len(found['tables'])} tables for {name}")
        rendered = iter(map(markdown, found["tables"]))
        text = TABLE.sub(lambda _, tables=rendered: next(tables), parts[own[0]])
        block = "\n".join(
            ["```console", command(name), *found["console"], f"build/{name}: report.html, ...", "```"]
        )
        parts[own[0]] = TERMINAL.sub(lambda _, block=block: block, text)
    path.write_text("".join(parts), encoding="utf-8")


def command(name: str) -> str:
    """The command of a rig, as the page shows it."""
    return f"$ eccentric diagnose data.csv.gz --rig examples/rigs/{name}.toml --out build/{name}"


def markdown(table: dict[str, Any]) -> str:
    """A table with three digits a number."""
    lines = [table["columns"], ["---", *["--:"] * (len(table["columns"]) - 1)]]
    lines += [[label, *map(_cell, row)] for label, row in table["rows"].items()]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _cell(value: float | list[float] | None) -> str:
    if value is None:
        return "-"
    return " to ".join(f"{x:.3g}" for x in (value if isinstance(value, list) else [value]))
