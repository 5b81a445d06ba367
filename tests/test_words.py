"""Facts inside, words at the edge: where sentences may be made, that nothing below reads one, and names."""

import ast
import re
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.import_graph import ROOT, files_of, tree_of

THREE_WORDS = re.compile(r"\b[A-Za-z]{2,}[,;:]? [A-Za-z]{2,}[,;:]? [A-Za-z]{2,}")
ERRORS = {"InputError", "MissingValueError", "AssertionError"}
"""Calls whose texts are the fields of an error."""
FREE = {
    *("text", "said", "sentence", "message", "note", "notes", "remark", "why", "hint", "reason", "problem"),
    *("warnings", "doubt", "doubts", "complaints", "evidence", "facts", "missed", "differing", "excerpt"),
    *("headline", "title", "meaning", "description", "mend"),
}
"""Names of fields that hold a sentence or a part of one."""


def _below() -> dict[str, Path]:
    """The files of the toolkit outside `presentation`, by their path below `eccentric/`."""
    paths = {path.relative_to(ROOT / "eccentric").as_posix(): path for path in files_of("eccentric").values()}
    return {name: path for name, path in sorted(paths.items()) if not name.startswith("presentation/")}


def _not_text(tree: ast.Module) -> Iterator[int]:
    """The ids of constants that are docstrings, comments on a name, or the fields of an error."""
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        for x in body if isinstance(body, list) else []:
            if isinstance(x, ast.Expr) and isinstance(x.value, ast.Constant):
                yield id(x.value)
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") in ERRORS:
            yield from map(id, ast.walk(node))


def sentences_in(tree: ast.Module) -> int:
    """How many literals have three words in a row."""
    left_out = set(_not_text(tree))
    return sum(
        isinstance(node, ast.Constant)
        and isinstance(node.value, str)
        and id(node) not in left_out
        and THREE_WORDS.search(node.value) is not None
        for node in ast.walk(tree)
    )


def errors_read_in(tree: ast.Module) -> int:
    """How often the line or the arguments of a caught error of ours are read.

    What a library says of an error is passed on as the reason: no record has it.
    """
    count = 0
    for handler in (x for x in ast.walk(tree) if isinstance(x, ast.ExceptHandler) and x.name):
        kinds = ast.unparse(handler.type) if handler.type else ""
        if "InputError" in kinds or "MissingValueError" in kinds:
            count += sum(_reads(node, handler.name or "") for node in ast.walk(handler))
    return count


def _reads(node: ast.AST, name: str) -> bool:
    if isinstance(node, ast.Call) and getattr(node.func, "id", "") in {"str", "repr"}:
        return any(isinstance(x, ast.Name) and x.id == name for x in ast.walk(node))
    value = node.value if isinstance(node, ast.FormattedValue) else None
    value = node.value if isinstance(node, ast.Attribute) and node.attr == "args" else value
    return isinstance(value, ast.Name) and value.id == name


def free_texts_in(tree: ast.Module) -> set[str]:
    """The fields of records that hold a text by their name and type, as "Record.field"."""
    return {
        f"{record.name}.{field.target.id}"
        for record in ast.walk(tree)
        if isinstance(record, ast.ClassDef)
        and any("dataclass" in ast.unparse(decorator) for decorator in record.decorator_list)
        for field in record.body
        if isinstance(field, ast.AnnAssign)
        and isinstance(field.target, ast.Name)
        and field.target.id in FREE
        and "str" in ast.unparse(field.annotation)
    }


# What is left, each with a reason. These lists may only shrink.


DATA = {
    "effects": "the words of an effect belong to it: what it is, where it comes from, what to measure",
    "model": "meanings of quantities, titles and origins of equations, terms of an axis",
    "virtual_bench": "independent of the toolkit: its effects, files and help",
    "paper": "findings about the paper, printed by the audit, and titles of its figures",
    "emission": "meanings and promises of emitted functions, comments of emitted code",
    "compiled": "comments of the emitted module",
    "cli": "help pages",
    "core": "reasons within an error, help on how to mend a file",
    "lazy.py": "an error of Python's own",
}
"""Rooms whose sentences are data of their owner, or help."""
LEFT = {
    "api": (52, "complaints and doubts about a rig, why a joint of a fleet is a suspect, headings of tables"),
    "diagnosis": (
        32,
        "progress, comments and the caution of the emitted script, runs that differ, why a log does not fit",
    ),
    "drafting": (
        251,
        "evidence, doubts and questions of a draft; foreign words for names of columns",
    ),
    "fleet": (37, "problems of logs and joints as they are stored in problems.csv, progress"),
    "identification": (24, "warnings of a fit, what its rows are, the remark of k_e"),
    "joints": (29, "warnings of an arm, why it is not emitted, meanings of a joint's quantities"),
    "logs": (84, "what a reader says of a file: read in part, converted, left out"),
    "planning": (11, "what a piece of the motion does, progress"),
    "rigs": (18, "reasons within an error, warnings about a rig"),
    "signals": (190, "findings, in sentences that errors of a fit have for a hint"),
}
"""Rooms with sentences composed below `presentation`: how many, and which."""
READ = {
    "api/drafted.py": "an error of a rig is a line of its check",
    "api/fleet.py": "why a joint was not diagnosed",
    "cli/__init__.py": "the line that is printed",
    "cli/doctor.py": "what is wrong with a file is a line of its description",
    "drafting/against.py": "an error of a column is a line of the check",
    "drafting/draft.py": "why a column is no signal",
    "fleet/gathered.py": "why a joint has no rig, for problems.csv",
    "fleet/work.py": "why a log cannot be used, for problems.csv",
}
"""Files that put the line of an error of ours into a record for a person."""
TEXTS = {
    # Data of its owner: of a model, an effect, a program, a draft that is a file.
    *("Words.headline", "Words.hint", "Words.meaning", "Words.title", "Rival.headline"),
    *("Model.title", "Quantity.meaning", "Variable.meaning", "_Followed.meaning"),
    *("_Fitted.notes", "_Fitted.title"),
    *("Output.meaning", "Routine.meaning", "Helper.meaning", "Assignment.note"),
    *("Program.notes", "Program.title", "Target.meaning", "Format.title"),
    *("FittedValues.notes", "RigDraft.text"),
    # Text that is no sentence: of a unit, a column, a line of code, a name.
    *("Unit.text", "ColumnSource.text", "Line.text", "Line.note", "Name.text"),
    # What a person is told at the end, made of what follows.
    *("RigCheck.complaints", "RigCheck.doubts", "RigCheck.warnings", "RigDraft.doubts", "Printed.warnings"),
    # Findings and warnings in sentences: an error of a fit has them for a hint, problems.csv stores them.
    *("Finding.text", "Finding.mend", "Cause.text", "Ratio.text", "Rows.description", "Intake.warnings"),
    *("Drive.warnings", "Problem.warnings", "Fit.warnings", "Contest.warnings", "Contest.excerpt"),
    *("Diagnosis.differing", "Stage.differing", "Rig.warnings", "Complaint.text"),
    *("Layout.notes", "LogDescription.notes", "JointColumns.doubt"),
    *("Read.notes", "InParts.notes", "LogStream.notes", "Log.notes", "Excerpt.note", "Excerpt.missed"),
    *("FleetProblem.text", "Examined.said"),
    *("Draft.facts", "Driven.doubt", "Driven.evidence", "Proposal.doubt", "Proposal.evidence"),
    *("RigLine.doubt", "RigLine.evidence", "Reading.why"),
}
"""Fields of records that hold a text."""


def test_sentences_are_made_in_presentation() -> None:
    """Elsewhere no literal has three words, but docstrings, errors, data of their owner, and what is left."""
    counted = Counter[str]()
    for name, path in _below().items():
        counted[name.split("/")[0]] += sentences_in(tree_of(path))
    more = {room: n for room, n in counted.items() if room not in DATA and n > LEFT.get(room, (0, ""))[0]}

    assert more == {}


def test_the_line_of_an_error_is_for_people() -> None:
    """Code goes by the fields of an error; its line is only passed on, and where is known."""
    found = {name for name, path in _below().items() if errors_read_in(tree_of(path))}

    assert found == READ.keys()


def test_records_hold_values() -> None:
    """No record below `presentation` has a field for a text, but those listed."""
    found = set[str]().union(*(free_texts_in(tree_of(path)) for path in _below().values()))

    assert found == TEXTS


def test_nothing_translates_a_finished_text() -> None:
    """`AxisKind.text` is for texts as they stand in a file: no call of it has a name of a person's in it."""
    calls = {
        ast.unparse(node.args[0])
        for path in files_of("eccentric").values()
        for node in ast.walk(tree_of(path))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr == "text"
        and ast.unparse(node.func.value).endswith("axis")
        and node.args
    }

    assert [call for call in sorted(calls) if re.search(r"error|logs|path|rig\.name|warning", call)] == []


@pytest.mark.parametrize(
    ("source", "sentences", "ours", "texts"),
    [
        ('"""A docstring of three words."""', 0, 0, set()),
        ('x = "one two three"', 1, 0, set()),
        ('x = "N m s/rad"', 0, 0, set()),
        ('raise InputError("a", "one two three", why=f"for four five {x}")', 0, 0, set()),
        (
            "try:\n    f()\nexcept InputError as error:\n    g(str(error), f'{error}', error.args)",
            0,
            3,
            set(),
        ),
        ("try:\n    f()\nexcept ValueError as error:\n    g(str(error))", 0, 0, set()),
        ("@dataclass\nclass A:\n    text: str\n    texts: int", 0, 0, {"A.text"}),
    ],
)
def test_the_rule_sees_what_it_is_about(source: str, sentences: int, ours: int, texts: set[str]) -> None:
    """Docstrings, units and the fields of errors are no sentences; a library's error is not one of ours."""
    tree = ast.parse(source)

    assert (sentences_in(tree), errors_read_in(tree)) == (sentences, ours)
    assert free_texts_in(tree) == texts


# Names: one for one thing, and where numbers that decide are.


def test_no_two_public_classes_share_a_name() -> None:
    """A class is found by its name alone, whichever room it is in."""
    places = defaultdict[str, list[str]](list)
    for module, path in files_of("eccentric").items():
        for node in tree_of(path).body:
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
        for name in _numbers(tree_of(path))
    }

    assert set() == {name for name in outside if name.rpartition(".")[2] not in NO_THRESHOLDS}


def _numbers(tree: ast.Module) -> set[str]:
    """Names of a module that are made of numbers alone."""
    found = set[str]()
    for node in tree.body:
        if isinstance(node, ast.Assign) and any(
            isinstance(part, ast.Constant) and type(part.value) in {int, float}
            for part in (node.value, *getattr(node.value, "elts", ()))
        ):
            found |= {
                part.id for target in node.targets for part in ast.walk(target) if isinstance(part, ast.Name)
            }
    return found
