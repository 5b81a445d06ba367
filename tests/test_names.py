"""One name for one thing, and one grammar of errors, read from the sources."""

import ast
import re
from collections import defaultdict

from tests.import_graph import ROOT, files_of


def test_no_two_public_classes_share_a_name() -> None:
    """A class is found by its name alone, whichever room it is in."""
    places = defaultdict[str, list[str]](list)
    for module, path in files_of("eccentric").items():
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places[node.name].append(module)

    shared = {name: modules for name, modules in places.items() if len(modules) > 1}

    assert {} == shared


def test_errors_say_what_is_required_then_what_was_received() -> None:
    """Every message has the form "place: expected X, got Y": X first, and a comma between them."""
    other = re.compile(r"""[:;"'] required (?!in\b)|"required |; received|received:""")
    sources = [*files_of("eccentric").values(), *sorted((ROOT / "templates").rglob("*.py.jinja"))]

    raised = {
        f"{path.relative_to(ROOT)}: {line.strip()}"
        for path in sources
        for line in path.read_text(encoding="utf-8").splitlines()
        if '"' in line and other.search(line)
    }

    assert set() == raised


DECIDING = ("diagnosis", "identification", "joints", "logs", "rigs", "signals")
# Numbers that are no thresholds: a turn, the exponent and padding of a method, the width of a line.
NO_THRESHOLDS = {"COUNT", "TURN", "_TURN", "_POWER", "_PADDING", "_WIDTH"}


def test_thresholds_of_a_room_are_in_its_limits() -> None:
    """Named numbers of a room that decides are in `limits.py`; literals in a formula are not seen."""
    outside = {
        f"{module}.{name}"
        for room in DECIDING
        for module, path in files_of(f"eccentric/{room}").items()
        if path.name not in {"limits.py", "mat_file.py"}
        for name in _numbers(path.read_text(encoding="utf-8"))
    }

    assert set() == {name for name in outside if name.rpartition(".")[2] not in NO_THRESHOLDS}


def _numbers(source: str) -> set[str]:
    """Names of a module that are made of numbers alone."""
    found = set[str]()
    for node in ast.parse(source).body:
        if isinstance(node, ast.Assign) and any(
            isinstance(part, ast.Constant) and type(part.value) in {int, float}
            for part in (node.value, *getattr(node.value, "elts", ()))
        ):
            found |= {
                part.id for target in node.targets for part in ast.walk(target) if isinstance(part, ast.Name)
            }
    return found
