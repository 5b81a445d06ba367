"""One name for one thing: no two public classes of the toolkit share a name."""

import ast
from collections import defaultdict

from tests.import_graph import files_of


def test_no_two_public_classes_share_a_name() -> None:
    """A class is found by its name alone, whichever room it is in."""
    places = defaultdict[str, list[str]](list)
    for module, path in files_of("eccentric").items():
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places[node.name].append(module)

    shared = {name: modules for name, modules in places.items() if len(modules) > 1}

    assert {} == shared
