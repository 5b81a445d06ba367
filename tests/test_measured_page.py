"""The page of measured rigs says what the last run on their logs gave; no log is needed to check it."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

import eccentric
from tests.logged import RIGS, SHARED, needs_shared

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE = (DOCS / "measured-rigs.md").read_text(encoding="utf-8")
RESULTS: dict[str, Any] = json.loads((DOCS / "measured" / "results.json").read_text(encoding="utf-8"))
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


def sections() -> dict[str, str]:
    """Rig -> its section of the page: the one whose command names its rig file."""
    found = {}
    for text in re.split(r"^## ", PAGE, flags=re.MULTILINE)[1:]:
        rigs = set(re.findall(r"--rig examples/rigs/(\w+)\.toml", text))
        if rigs:
            (name,) = rigs
            assert name not in found
            found[name] = text
    return found


def tables(text: str) -> list[dict[str, Any]]:
    """Markdown tables in the form of results.json, cells as text."""
    found = []
    for block in re.findall(r"(?:^\|.*\n)+", text, flags=re.MULTILINE):
        head, _, *rows = [
            [cell.strip() for cell in line.strip("| \n").split(" | ")] for line in block.splitlines()
        ]
        found.append({"columns": head, "rows": {label: cells for label, *cells in rows}})
    return found


def is_rounded(shown: str, value: float | list[float] | None) -> bool:
    """Whether a cell shows its value, or both ends of its interval, rounded to two digits or more."""
    if value is None:
        return shown == "-"
    values = value if isinstance(value, list) else [value]
    pattern = " to ".join([NUMBER.pattern] * len(values))
    if not re.fullmatch(pattern, shown):
        return False
    for text, exact in zip(NUMBER.findall(shown), values, strict=True):
        last_digit = 10.0 ** -len(text.partition(".")[2])
        error = abs(float(text) - exact)
        if error > 0.5 * last_digit + 1e-9 or error > 0.05 * abs(exact):
            return False
    return True


def test_every_rig_has_its_section() -> None:
    """The page has one section for each rig of the results."""
    assert set(RESULTS) == set(sections())


@pytest.mark.parametrize("name", RESULTS)
def test_tables_are_the_results_rounded(name: str) -> None:
    """Tables have the columns and rows of the results, and every cell its value after rounding."""
    shown = tables(sections()[name])
    assert len(RESULTS[name]["tables"]) == len(shown)
    for expected, actual in zip(RESULTS[name]["tables"], shown, strict=True):
        assert expected["columns"] == actual["columns"]
        assert list(expected["rows"]) == list(actual["rows"])
        for label, values in expected["rows"].items():
            cells = actual["rows"][label]
            wrong = [
                (cell, value)
                for cell, value in zip(cells, values, strict=True)
                if not is_rounded(cell, value)
            ]
            assert [] == wrong, (name, label)


@pytest.mark.parametrize("name", RESULTS)
def test_what_the_terminal_shows_is_the_result(name: str) -> None:
    """The section shows the command and every line that it printed."""
    (block,) = re.findall(r"```console\n(.*?)```", sections()[name], flags=re.DOTALL)
    command, *lines, files = block.splitlines()
    assert f"$ eccentric diagnose data.csv.gz --rig examples/rigs/{name}.toml --out build/{name}" == command
    assert RESULTS[name]["console"] == lines
    assert files.startswith(f"build/{name}: report.html")


def test_every_drive_has_a_line_with_what_a_specialist_would_object() -> None:
    """One row for each remark, in their order; its other cells are those that the last run gave."""
    remarks = tomllib.loads((DOCS / "measured" / "remarks.toml").read_text(encoding="utf-8"))["line"]
    lines = json.loads((DOCS / "measured" / "lines.json").read_text(encoding="utf-8"))
    (shown,) = re.findall(r"<!-- lines -->\n(.*?)<!-- end -->", PAGE, flags=re.DOTALL)
    rows = [[cell.strip() for cell in row.strip("| ").split(" | ")] for row in shown.splitlines()[2:]]

    assert set(lines) == {one["name"] for one in remarks}
    assert [
        [
            one["drive"],
            *(lines[one["name"]][key] for key in ("made of", "cause", "ranges", "says")),
            one["objection"],
        ]
        for one in remarks
    ] == rows


def test_pictures_are_there_small_and_used() -> None:
    """The page shows every picture of its folder, with a text for who does not see it, each below 150 kB."""
    shown = re.findall(r"!\[([^\]]+)\]\(measured/([\w.]+)\)", PAGE)
    assert {path.name for path in (DOCS / "measured").glob("*.[sp][vn]g")} == {name for _, name in shown}
    assert [] == [name for _, name in shown if (DOCS / "measured" / name).stat().st_size > 150_000]


@needs_shared
@pytest.mark.slow
def test_the_page_on_the_normal_force_is_that_of_its_logs() -> None:
    """Bounds and z of a drive are those of a fit today, and the page stays short."""
    page = (DOCS / "normal-force.md").read_text(encoding="utf-8")
    name = "dfki_ak80_pendulum"
    found = eccentric.fit(SHARED / "measured" / name / "data.csv.gz", RIGS / f"{name}.toml").document
    row = tables(page)[0]["rows"]["quasi-direct drive, pendulum"]
    said = found["undetected"]
    shown = [said[k][x] for k in ("C_lN", "B_lN") for x in ("upper_95", "z")]

    assert [row[k] for k in (1, 3, 4, 6)] == [f"{x:.3g}" for x in shown]
    assert len(page.splitlines()) < 120
