"""How heavy the project is to change: lines, files, floors, and what a diagnosis runs through.

python benchmarks/weight.py
"""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))

from tests.import_graph import Graph, circle_in, files_of, graph_of, levels_of  # noqa: E402 - found by the line above

STAGES = {"logs", "signals", "identification", "diagnosis"}
"""The rooms that a row of a log passes on its way to the verdict."""

_RUN = """
import sys
executed = set()
sys.setprofile(lambda frame, event, _: executed.add(frame.f_code.co_filename)
               if event == "call" and frame.f_code.co_name != "<module>" else None)
import tempfile
from eccentric.cli import main
with tempfile.TemporaryDirectory() as folder:
    log = "diagnose examples/bench/bench.csv.gz --rig examples/bench/bench.json --out"
    main([*log.split(), folder + "/out"])
sys.setprofile(None)
print("\\n".join(sorted(filter(None, executed))))
"""


def room(module: str) -> str:
    """The room that a file is in; files beside the rooms are none."""
    return module.split(".")[1] if module.count(".") else ""


def rooms(graph: Graph, folders: set[str]) -> dict[str, set[str]]:
    """The imports between rooms."""
    found: dict[str, set[str]] = {name: set() for name in folders}
    for module, others in graph.items():
        if room(module) in folders:
            found[room(module)] |= {room(other) for other in others} & folders - {room(module)}
    return found


def lines(paths: list[Path]) -> int:
    """The lines of files."""
    return sum(len(path.read_text(encoding="utf-8").splitlines()) for path in paths)


def imported(path: Path) -> int:
    """The lines of a file that are imports."""
    nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    return sum(
        (node.end_lineno or node.lineno) - node.lineno + 1
        for node in nodes
        if isinstance(node, ast.Import | ast.ImportFrom)
    )


def executed() -> list[str]:
    """The files of the stages that have a function which runs while the bundled log is diagnosed."""
    done = subprocess.run([sys.executable, "-c", _RUN], cwd=ROOT, capture_output=True, text=True, check=True)
    inside = ROOT / "eccentric"
    paths = [Path(line) for line in done.stdout.splitlines()]
    return [
        str(path.relative_to(inside))
        for path in paths
        if path.is_relative_to(inside) and path.relative_to(inside).parts[0] in STAGES
    ]


def main() -> int:
    """Print the measures as rows of a table."""
    files = files_of("eccentric")
    graph = graph_of(files)
    folders = {room(module) for module, path in files.items() if path.name == "__init__.py"} - {""}
    between = rooms(graph, folders)
    circle = circle_in(between)
    levels = [] if circle else levels_of(between)
    own = [*files.values()]
    total = lines(own)
    rows = [
        ("lines of Python in eccentric/", f"{total:,}"),
        ("files", f"{len(own)}"),
        ("lines of a file, median", f"{sorted(lines([p]) for p in own)[len(own) // 2]}"),
        ("rooms", f"{len(folders)}"),
        ("floors over all rooms", f"{len(levels) or 'none: a circle'}"),
        ("circle", " -> ".join(circle) or "none"),
        ("files of the stages that run during diagnose", f"{len(executed())}"),
        ("templates", f"{len([*(ROOT / 'templates').rglob('*.jinja')])}"),
        ("lines of tests", f"{lines(sorted((ROOT / 'tests').glob('*.py'))):,}"),
        ("share of import lines", f"{100.0 * sum(map(imported, own)) / total:.1f} %"),
    ]
    print("| measure | value |\n|---|---|")
    print("\n".join(f"| {name} | {value} |" for name, value in rows))
    for level, names in reversed([*enumerate(levels, 1)]):
        print(f"{level:2}  {', '.join(names)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
