"""Frozen results: what differs is named by file and place, and what is frozen twice agrees."""

from __future__ import annotations

import base64
import gzip
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.compare_frozen import compare, compare_values

ROOT = Path(__file__).resolve().parents[1]
NAN = float("nan")
RESULT = {
    "verdict": "named",
    "rmse": 0.25,
    "floor": NAN,
    "probability": 1,
    "interval": [1.0, 2.0],
    "A": {"value": 0.001, "std_error": 0.5, "interval_95": [0.0, 1.0]},
}
CODE = "static const double table[2] = {0.5, 1.25e-3};\n/* (eccentric 0.1.0, program 3d12681e) */\n"
PLACE = "documents/bench/diagnose"


def folder(at: Path, files: dict[str, str]) -> Path:
    """Write files into a frozen folder."""
    for name, text in files.items():
        (at / name).parent.mkdir(parents=True, exist_ok=True)
        (at / name).write_text(text, encoding="utf-8")
    return at


def differences(tmp_path: Path, name: str, before: str, after: str, **options: Any) -> list[str]:
    """Return what the comparison of two folders with one file says."""
    one, two = folder(tmp_path / "one", {name: before}), folder(tmp_path / "two", {name: after})
    return list(compare(one, two, **options))


@pytest.mark.parametrize(
    ("after", "expected"),
    [
        (RESULT, []),
        ({**RESULT, "rmse": 0.25 * (1 + 0.9e-9)}, []),
        ({**RESULT, "probability": 1.0}, []),
        ({**RESULT, "rmse": 0.25 * (1 - 1.1e-9)}, ["/rmse: 0.25, then 0.249999999725"]),
        ({**RESULT, "rmse": -0.25}, ["/rmse: 0.25, then -0.25"]),
        ({**RESULT, "more": None}, ["/more: only after"]),
        ({k: v for k, v in RESULT.items() if k != "rmse"}, ["/rmse: only before"]),
        ({**RESULT, "interval": [1.0]}, ["/interval: 2 entries, then 1"]),
        ({**RESULT, "interval": [1.0, "2"]}, ["/interval/1: 2.0, then 2"]),
        ({**RESULT, "verdict": "unexplained"}, ["/verdict: named, then unexplained"]),
        ({**RESULT, "probability": True}, ["/probability: 1, then True"]),
        ({**RESULT, "floor": 0.0}, ["/floor: nan, then 0.0"]),
    ],
)
def test_numbers_agree_to_a_billionth_and_texts_exactly(after: dict[str, Any], expected: list[str]) -> None:
    """A relative 1e-9 is the limit; NaN agrees with NaN only, and true is not 1."""
    assert expected == list(compare_values(RESULT, after, 1e-9))


@pytest.mark.parametrize(("key", "number"), [("value", 0.001), ("interval_95", 0.0)])
def test_a_standard_error_is_the_scale_of_the_numbers_beside_it(key: str, number: float) -> None:
    """0.4e-9 is less than 1e-9 of the standard error 0.5 and more than 1e-9 of the number; 0.6e-9 is more."""
    found = []
    for moved in (0.4e-9, 0.6e-9):
        value = number + moved
        changed = {**RESULT["A"], key: [value, 1.0] if key == "interval_95" else value}
        found.append(list(compare_values(RESULT, {**RESULT, "A": changed}, 1e-9)))

    place = f"/A/{key}" + ("/0" if key == "interval_95" else "")
    assert [[], [f"{place}: {number}, then {number + 0.6e-9}"]] == found


def test_a_changed_letter_is_named_by_file_and_line(tmp_path: Path) -> None:
    """Printed lines are compared by bytes, also those of documents."""
    for number, name in enumerate(
        ("help/fit.txt", f"{PLACE}.txt", "emitted/c2_parallel/default/c2_parallel.c")
    ):
        found = differences(tmp_path / str(number), name, "usage\n\nfit a log\n", "usage\n\nfit a lot\n")

        assert [f"{name}: line 3: 'fit a log', then 'fit a lot'"] == found


def test_a_changed_coefficient_of_emitted_code_is_found(tmp_path: Path) -> None:
    """Base models agree by bytes; fitted ones to 1e-9, without the digest that follows from them."""
    near, far = CODE.replace("1.25e-3", "0.0012500000000001"), CODE.replace("1.25e-3", "1.2500001e-3")
    named = "static const double table[2] = {0.5, "
    base, fitted = "emitted/c2_parallel/default/c2_parallel.c", f"{PLACE}/c2_parallel_extended.c"

    changed = [f"{base}: line 1: '{named}1.25e-3}};', then '{named}0.0012500000000001}};'"]
    assert changed == differences(tmp_path, base, CODE, near)
    assert [] == differences(tmp_path / "near", fitted, CODE, near.replace("3d12681e", "00000000"))
    moved = [f"{fitted}: line 1: '{named}1.25e-3}};', then '{named}1.2500001e-3}};'"]
    assert moved == differences(tmp_path / "far", fitted, CODE, far)


def test_figures_of_a_page_are_compared_as_numbers(tmp_path: Path) -> None:
    """Packed arrays of 32 bits agree to their last place; the text of a page by bytes."""

    def page(numbers: list[float], title: str) -> str:
        data = base64.b64encode(gzip.compress(np.array(numbers, "<f4").tobytes())).decode()
        array = {"type": "bytes", "data": data}
        figures = json.dumps({"x": {"type": "ndarray", "array": array, "dtype": "float32", "shape": [2]}})
        return f'<h1>{title}</h1>\n<script type="application/json" id="f">{figures}</script>\n'

    name, one = f"{PLACE}/report.html", page([1.0, 2.0], "A")
    last = float(np.nextafter(np.float32(2), np.float32(3)))
    for other, expected in (
        (page([1.0, last], "A"), []),
        (page([1.0, 2.5], "A"), [f"{name}: script 1 /x/1: 2.0, then 2.5"]),
        (page([1.0, 2.0], "B"), [f"{name}: line 1: '<h1>A</h1>', then '<h1>B</h1>'"]),
    ):
        assert expected == differences(tmp_path, name, one, other)


def test_renamed_names_agree_by_their_map(tmp_path: Path) -> None:
    """Without the map both names are differences; a map of another name does not help."""
    name = "api/signatures.json"
    before = json.dumps({"fit": "function (logs) -> 'FitResult'", "fit_arm": "function (logs)"})
    after = json.dumps({"identify": "function (logs) -> 'FitResult'", "fit_arm": "function (logs)"})
    both = [f"{name}: /fit: only before", f"{name}: /identify: only after"]

    assert both == differences(tmp_path, name, before, after)
    assert [] == differences(tmp_path, name, before, after, names={"fit": "identify"})
    assert both == differences(tmp_path, name, before, after, names={"plan": "design"})


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    """On either side."""
    one = folder(tmp_path / "one", {"help/fit.txt": "a", "help/plan.txt": "b"})
    two = folder(tmp_path / "two", {"help/fit.txt": "a", "help/new.txt": "b"})

    assert ["help/new.txt: only after", "help/plan.txt: only before"] == list(compare(one, two))


def test_a_part_that_is_frozen_twice_agrees(tmp_path: Path) -> None:
    """Help and refusals of commands; the comparison as a command says so and returns 0."""
    only = "^(help/fit|refusals/options_(none|audit))"
    folders = [tmp_path / name for name in ("one", "two")]
    for out in folders:
        script = [sys.executable, "benchmarks/freeze.py", "--out", str(out), "--only", only]
        subprocess.run(script, cwd=ROOT, check=True, capture_output=True)
    compared = subprocess.run(
        [sys.executable, "benchmarks/compare_frozen.py", *map(str, folders)],
        cwd=ROOT,
        check=False,
        capture_output=True,
        text=True,
    )
    names = {str(path.relative_to(folders[0])) for path in folders[0].rglob("*") if path.is_file()}
    refused = (folders[0] / "refusals/options_audit.txt").read_text(encoding="utf-8")

    assert {"help/fit.txt", "refusals/options_none.txt", "inputs/rig.json"} <= names
    assert (0, f"{len(names)} files compared, 0 differences in 0 files\n") == (
        compared.returncode,
        compared.stdout,
    )
    assert 2 == refused.count("--- status 2\n") == refused.count("$ eccentric audit ")
