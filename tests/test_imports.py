"""Rooms import one way and through their doors; emitted code is self-contained. Read from the sources."""

import sys
from pathlib import Path

import pytest

from tests.import_graph import (
    ROOT,
    circle_in,
    drawn,
    exports_of,
    files_of,
    graph_of,
    levels_of,
    names_imported,
)

# From the bottom to the top: each part may import those above it in this list, and itself.
LAYERS = (
    {"lazy", "import_time", "version"},
    {"core"},
    {"model"},
    {"effects", "derivations", "logs"},
    {"emission", "rigs"},
    {"signals", "paper", "compiled", "arms", "output"},
    {"identification", "adaptation", "exports", "drafting"},
    {"diagnosis", "fleet", "simulation"},
    {"joints", "planning"},
    {"presentation"},
    {"api"},
    {"__init__"},
    {"cli"},
    {"__main__"},
)
MAY_IMPORT = {part: {part}.union(*LAYERS[:height]) for height, parts in enumerate(LAYERS) for part in parts}
# The virtual bench is the truth that the toolkit is tested on: the two share errors, and how files appear.
MAY_IMPORT["virtual_bench"] = {"virtual_bench", "core"}
MAY_IMPORT["api"] |= {"virtual_bench"}
MAY_IMPORT["cli"] |= {"virtual_bench"}

MOST_FLOORS = 9
MOST_LEVELS = 8

FILES = files_of("eccentric")
GRAPH = graph_of(FILES)
PACKAGES = {module for module, path in FILES.items() if path.name == "__init__.py"} - {"eccentric"}
ROOMS = {package for package in PACKAGES if package.count(".") == 1}
# A folder inside a room has a door where its `__init__` says what it exports.
DOORS = ROOMS | {p for p in PACKAGES if exports_of(FILES[p])}


def _parts(path: Path) -> set[str]:
    """Return the parts of eccentric that a file imports."""
    package = path.relative_to(ROOT).parent.parts
    names = [name.split(".") for name in names_imported(path, package)]
    return {name[1] if len(name) > 1 else "__init__" for name in names if name[0] == "eccentric"}


def _sources() -> list[tuple[str, Path]]:
    """Return every source file of the toolkit with the part that it belongs to."""
    return [
        *(
            (path.relative_to(ROOT / "eccentric").parts[0].removesuffix(".py"), path)
            for path in FILES.values()
        ),
        *(("derivations", path) for path in sorted((ROOT / "derivations").glob("*.py"))),
    ]


def _room(module: str) -> str:
    """The part of eccentric that a file belongs to."""
    return module.split(".")[1] if "." in module else "__init__"


def _past_the_door(module: str, other: str) -> bool:
    """Whether a file imports another past a door of a room or folder that it is not in itself."""
    names = other.split(".")
    around = [".".join(names[:k]) for k in range(2, len(names) + 1)]
    door = next((p for p in around if p in DOORS and not f"{module}.".startswith(f"{p}.")), other)
    return other != door


def test_imports_run_one_way() -> None:
    """No file imports a part of eccentric above its own; a new part must be given its place."""
    sources = _sources()

    assert {part for part, _ in sources} - set(MAY_IMPORT) == set(), f"no place in the layers of {__file__}"
    assert {str(path): above for part, path in sources if (above := _parts(path) - MAY_IMPORT[part])} == {}


def test_rooms_are_on_nine_floors() -> None:
    """Each room is one floor above the highest that it imports; `import eccentric` is not counted."""
    names = {room.removeprefix("eccentric.") for room in ROOMS}
    rooms = {name: set[str]() for name in names}
    for module, others in GRAPH.items():
        if _room(module) in names:
            rooms[_room(module)] |= {_room(other) for other in others} & names - {_room(module)}
    floors = levels_of(rooms)

    assert len(floors) <= MOST_FLOORS, drawn(floors, rooms)


@pytest.mark.parametrize("room", sorted(DOORS))
def test_a_room_is_entered_by_its_door(room: str) -> None:
    """Files of other rooms import what a room's `__init__` exports, never one of its files."""
    past = {
        f"{module} imports {other}"
        for module, others in GRAPH.items()
        for other in others
        if other.startswith(f"{room}.") and _past_the_door(module, other)
    }

    assert past == set()


@pytest.mark.parametrize("folder", ["eccentric", "benchmarks", "tests"])
def test_no_files_import_each_other_in_a_circle(folder: str) -> None:
    """No file imports, by way of others, itself."""
    assert circle_in(GRAPH if folder == "eccentric" else graph_of(files_of(folder))) == []


def _place_in(room: str, module: str) -> str:
    """Where a file lies in a room: the folder with a door that it belongs to, else itself."""
    names = module.split(".")
    around = (".".join(names[:k]) for k in range(room.count(".") + 2, len(names) + 1))
    return next((p for p in around if p in DOORS), module)


@pytest.mark.parametrize("room", sorted(DOORS))
def test_a_room_is_eight_levels_at_most(room: str) -> None:
    """What one has to read in a room to understand a file is not deep; of a folder it is the door."""
    inside: dict[str, set[str]] = {}
    for module, others in GRAPH.items():
        if module.startswith(f"{room}."):
            place = _place_in(room, module)
            read = {_place_in(room, other) for other in others if other.startswith(f"{room}.")}
            inside[place] = inside.get(place, set()) | read - {place}
    levels = levels_of(inside)

    assert len(levels) <= MOST_LEVELS, drawn(levels, inside)


@pytest.mark.parametrize("path", sorted((ROOT / "generated").glob("*.py")), ids=lambda path: path.name)
def test_generated_modules_import_numpy_and_the_standard_library_only(path: Path) -> None:
    """An emitted module runs where neither the toolkit nor SymPy is installed."""
    tops = {name.split(".")[0] for name in names_imported(path, ("generated",))}

    assert tops - {"generated", "eccentric_runtime", "numpy"} - sys.stdlib_module_names == set()


def test_a_circle_and_a_floor_are_found() -> None:
    """Three files in a ring are a circle; without the last import they are on three levels."""
    ring = {"a": {"b"}, "b": {"c"}, "c": {"a"}}
    row = {**ring, "c": set[str]()}

    assert {"a", "b", "c"} == set(circle_in(ring))
    assert [["c"], ["b"], ["a"]] == levels_of(row)
    assert [] == circle_in(row)
