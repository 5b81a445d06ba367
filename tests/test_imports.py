"""Imports run one way, and what is emitted stands by itself. Read from the sources: nothing is executed."""

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

# From the bottom to the top: each part may import those above it in this list, and itself.
LAYERS = (
    {"__init__", "__version__", "errors"},
    {"places", "output"},
    {"model"},
    {"effects", "derivations"},
    {"emission", "logs"},
    {"rigs", "audit", "figures"},
    {"signals"},
    {"fitting"},
    {"search"},
    {"diagnosis"},
    {"report"},
    {"cli"},
    {"__main__"},
)
MAY_IMPORT = {part: {part}.union(*LAYERS[:height]) for height, parts in enumerate(LAYERS) for part in parts}
MAY_IMPORT["__init__"] = {"emission"}  # where eccentric.compile is asked for
# The virtual bench is the truth that the toolkit is tested on: the two share nothing but their errors.
MAY_IMPORT["virtual_bench"] = {"virtual_bench", "errors"}
MAY_IMPORT["cli"] |= {"virtual_bench"}


def _imports(path: Path, package: tuple[str, ...]) -> Iterator[str]:
    """Yield the absolute dotted names that a file imports; `package` is where relative imports start."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) + 1 - node.level] if node.level else ()
            yield from (".".join([*base, *filter(None, [node.module]), alias.name]) for alias in node.names)


def _parts(path: Path) -> set[str]:
    """Return the parts of eccentric that a file imports."""
    package = path.relative_to(ROOT).parent.parts
    names = [name.split(".") for name in _imports(path, package)]
    return {name[1] if len(name) > 1 else "__init__" for name in names if name[0] == "eccentric"}


def _sources() -> list[tuple[str, Path]]:
    """Return every source file of the toolkit with the part that it belongs to."""
    files = sorted((ROOT / "eccentric").rglob("*.py"))
    return [
        *((path.relative_to(ROOT / "eccentric").parts[0].removesuffix(".py"), path) for path in files),
        *(("derivations", path) for path in sorted((ROOT / "derivations").glob("*.py"))),
    ]


@pytest.mark.parametrize(
    ("part", "path"), [pytest.param(*source, id=str(source[1].relative_to(ROOT))) for source in _sources()]
)
def test_imports_run_one_way(part: str, path: Path) -> None:
    """No file imports a part of eccentric that stands higher than its own; a new part is given its place."""
    assert part in MAY_IMPORT, f"{part} has no place in the layers of {Path(__file__).name}"

    assert _parts(path) - MAY_IMPORT[part] == set()


@pytest.mark.parametrize("path", sorted((ROOT / "generated").glob("*.py")), ids=lambda path: path.name)
def test_generated_modules_import_numpy_and_the_standard_library_only(path: Path) -> None:
    """An emitted module runs where neither the toolkit nor SymPy is installed."""
    tops = {name.split(".")[0] for name in _imports(path, ("generated",))}

    assert tops - {"generated", "numpy"} - sys.stdlib_module_names == set()


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("import eccentric.emission.program as p", {"eccentric.emission.program"}),
        ("from eccentric import cli", {"eccentric.cli"}),
        ("from .. import emission", {"eccentric.emission"}),
        ("from .load import load_model", {"eccentric.model.load.load_model"}),
        ("def f():\n    from ..fitting.fit import fit", {"eccentric.fitting.fit.fit"}),
    ],
    ids=["plain", "from the package", "relative", "sibling", "inside a function"],
)
def test_every_form_of_import_is_seen(source: str, expected: set[str], tmp_path: Path) -> None:
    """The reader of imports overlooks none of their forms."""
    file = tmp_path / "file.py"
    file.write_text(source)

    assert expected == set(_imports(file, ("eccentric", "model")))
