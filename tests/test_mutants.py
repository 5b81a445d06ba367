"""`make mutants` changes sources in small ways, and tells which changes no test notices."""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks import mutants, mutations
from benchmarks.mutations import KINDS, drawn

ROOT = Path(__file__).resolve().parent.parent
LAW = '''"""Friction: 1 + 1 in a docstring is text."""

from math import exp

__all__ = ["torque"]
LIMIT: "int | 3" = 5


def torque(speed, load: float = 0.5):
    """Return a - b."""
    if speed < 0.0 and not load:
        raise ValueError(f"{speed - 1} is not at least {0 + 1}", 1)
    return max(speed, -load) * exp(load, LIMIT)  # 1 - 1
'''
EXPECTED = {
    ("constant", 'LIMIT: "int | 3" = 6'),
    ("constant", "def torque(speed, load: float = 1.0):"),
    ("return", "return None\nif speed < 0.0 and not load:"),
    ("return", "return speed\nif speed < 0.0 and not load:"),
    ("bound", "if speed <= 0.0 and not load:"),
    ("constant", "if speed < 1.0 and not load:"),
    ("operator", "if speed < 0.0 or not load:"),
    ("operator", "if speed < 0.0 and load:"),
    ("bound", "return min(speed, -load) * exp(load, LIMIT)  # 1 - 1"),
    ("sign", "return max(speed, +load) * exp(load, LIMIT)  # 1 - 1"),
    ("operator", "return max(speed, -load) / exp(load, LIMIT)  # 1 - 1"),
    ("arguments", "return max(speed, -load) * exp(LIMIT, load)  # 1 - 1"),
    ("sign", "return -(max(speed, -load) * exp(load, LIMIT))  # 1 - 1"),
}


def test_python_is_changed_in_code_only() -> None:
    """Each kind of change, and none in texts, annotations, imports and refusals."""
    found = mutations.mutants("law.py", LAW.encode())
    texts = [mutant.applied(LAW.encode()).decode() for mutant in found]

    assert EXPECTED == {(mutant.kind, mutant.shown(LAW.encode())[1]) for mutant in found}
    assert len(EXPECTED) == len(found)
    assert [] == [text for text in texts if ast.dump(ast.parse(text)) == ast.dump(ast.parse(LAW))]
    assert set(KINDS) == {mutant.kind for mutant in found}


def test_templates_are_changed_in_conditions_and_in_the_code_they_write() -> None:
    """Comments and literal texts stay, in the template and in what it writes."""
    text = '{# 1 + 1 #}\n{% if fixed %}\n/* 2 - 2 */\nx = a * -{{ b[0] }}; puts("3 < 4");\n{% endif %}\n'
    found = mutations.mutants("templates/c99/law.c.jinja", text.encode())
    expected = {
        ("operator", "{% if not (fixed) %}"),
        ("operator", 'x = a / -{{ b[0] }}; puts("3 < 4");'),
        ("sign", 'x = a * +{{ b[0] }}; puts("3 < 4");'),
        ("constant", 'x = a * -{{ b[1] }}; puts("3 < 4");'),
    }

    assert expected == {(mutant.kind, mutant.shown(text.encode())[1]) for mutant in found}


def _project(root: Path) -> Path:
    """Two rooms, one with three times the lines of the other and hardly tested."""
    (root / "eccentric" / "small").mkdir(parents=True)
    (root / "eccentric" / "large").mkdir()
    (root / "tests").mkdir()
    (root / "pyproject.toml").write_text('[tool.pytest]\npythonpath = ["."]\nmarkers = ["slow: long"]\n')
    law = "def {}(a, b):\n    c = a * b\n    return c - 1\n"
    (root / "eccentric" / "small" / "law.py").write_text(law.format("seen"))
    (root / "eccentric" / "large" / "law.py").write_text("".join(law.format(f"unseen_{k}") for k in range(3)))
    (root / "tests" / "test_law.py").write_text(
        "from eccentric.large import law\nfrom eccentric.small.law import seen\n\n\n"
        "def test_seen():\n    assert seen(2, 3) == 5\n\n\n"
        "def test_unseen():\n    law.unseen_0(2, 3)\n"
    )
    return root


def test_a_draw_follows_from_its_seed_and_from_the_lines(tmp_path: Path) -> None:
    """Three lines and nine give one mutant of four and three of four; more mutants begin with the same."""
    root = _project(tmp_path)
    rooms = [room for room, _ in drawn(root, 4, 1)]

    assert ["large", "large", "large", "small"] == sorted(rooms)
    assert drawn(root, 8, 1)[:4] == drawn(root, 4, 1)
    assert drawn(root, 8, 1) != drawn(root, 8, 2)
    assert ["small"] == [room for room, _ in drawn(root, 4, 1, {"small"})]


def test_what_a_test_sees_is_killed(tmp_path: Path) -> None:
    """Wrong code dies where a test compares, survives where it only runs, or is not reached."""
    root = _project(tmp_path)
    command = [sys.executable, str(ROOT / "benchmarks" / "mutants.py"), "--root", str(root), "--number", "4"]
    environment = os.environ | {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    run = subprocess.run(
        [*command, "--jobs", "1"], capture_output=True, text=True, check=True, env=environment
    )
    lines = (root / "build" / "mutants" / "seed-1.jsonl").read_text().splitlines()
    found = [(r["room"], r["line"], r["outcome"]) for r in map(json.loads, lines)]
    reached = {"small": "killed", "large": "survived"}

    assert [reached[room] if line <= 3 else "unreached" for room, line, _ in found] == [
        o for _, _, o in found
    ]
    assert {"killed", "survived", "unreached"} == {outcome for _, _, outcome in found}
    assert "| small | 1 | 0 | 1 | 0 | 100 % |" in run.stdout


@pytest.mark.parametrize(("why", "left"), [({}, 1), ({("a", "b"): "both are 0"}, 0)])
def test_an_equivalent_mutant_is_not_counted(why: dict[tuple[str, str], str], left: int) -> None:
    """Argued, it is in its own column; not argued, it survives."""
    results = [
        mutants.Result("search", "law.py", 3, "sign", "a", "b", "survived"),
        mutants.Result("search", "law.py", 4, "sign", "a", "c", "killed", "tests/test_law.py::test_one"),
    ]
    share = 100 / (1 + left)

    assert f"| search | 2 | {1 - left} | 1 | {left} | {share:.0f} % |" in mutants.table(results, why)
