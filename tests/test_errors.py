"""An error is a record: its line is made of its fields, and whoever passes it on changes a field."""

import pickle

import pytest

from eccentric.cli.arguments import options
from eccentric.core import InputError, MissingValueError, together

VALUE = InputError("rig.toml: [known] mu", "a number", "'x'", why=", as in mu = 0.2")
PROBLEM = InputError("log.csv", problem="not a valid CSV file", hint="is it a workbook?")


@pytest.mark.parametrize(
    ("error", "line"),
    [
        (VALUE, "rig.toml: [known] mu: expected a number, as in mu = 0.2, got 'x'"),
        (PROBLEM, "log.csv: not a valid CSV file; is it a workbook?"),
        (InputError("", "rows", 3, why="to fit"), "expected rows to fit, got 3"),
        (InputError("one line"), "one line"),
        (MissingValueError("rig", "k_i", "none", letter="k_i"), "rig: expected k_i, got none"),
    ],
)
def test_the_line_is_made_of_the_fields(error: InputError, line: str) -> None:
    """Place, what was expected and what came; or the problem; then what helps. It survives a process."""
    assert line == str(error)
    assert vars(error) == vars(pickle.loads(pickle.dumps(error)))  # noqa: S301 - our own bytes
    assert line == str(error.but())


@pytest.mark.parametrize("error", [VALUE, PROBLEM])
def test_a_place_goes_before_its_own_and_off_again(error: InputError) -> None:
    """Within a place and inside it undo each other; the other fields stay."""
    outer = error.within("joint 2")

    assert f"joint 2: {error}" == str(outer)
    assert error.fields == outer.inside("joint 2").fields
    assert error.fields | {"place": ""} == error.inside(error.place).fields


def test_hints_and_errors_add_up() -> None:
    """One hint after another; several errors of one file as one, each with its own place in it."""
    assert str(PROBLEM.hinted("or empty?")) == f"{PROBLEM}; or empty?"
    both = together("limits", [InputError("speed", "a number", "'x'"), InputError("", "time_s", "none")])

    line = "limits: speed: expected a number, got 'x'; expected time_s, got none"
    assert line == str(both)


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        ("prefix", "--prefix"),
        ("effect slip", "--effect slip"),
        ("prefix.json", "prefix.json"),
        ("effects.py: 3", "effects.py: 3"),
        ("", ""),
    ],
)
def test_an_argument_is_called_by_its_option_and_a_file_is_not(place: str, expected: str) -> None:
    """A file whose name begins like an argument keeps its name."""
    with pytest.raises(InputError) as caught, options("prefix", "effect"):
        raise InputError(place, "another value", "this")

    assert expected == caught.value.place
