"""The digest of an emitted program: another one for everything that the code follows from, else the same."""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import TypeVar

import pytest
import sympy as sp

from eccentric.emission import build_program, render_program
from eccentric.emission.backends.c99 import view as c99
from eccentric.emission.backends.python import module as python_module
from eccentric.emission.program import Helper, Program, Routine
from eccentric.model import load_model
from tests.extended import effects

Part = TypeVar("Part", Program, Routine, Helper)


@cache
def program() -> Program:
    """Return a program with a hidden state."""
    (effect,) = (e for e in effects("C2").values() if e.id == "magnetic_hysteresis[play]")
    return build_program(effect.extend(load_model("c2_parallel")))


def digests(changed: Program, origin: str = "there", command: str = "make derive") -> set[str]:
    """Return the digests that the banners of the three files name."""
    files = render_program(changed, origin, command).values()
    return {found for text in files for found in re.findall(r", program ([0-9a-f]{8})\)", text)}


def with_parameter(name: str, **changes: object) -> Program:
    """Return the program, one parameter of it changed."""
    parameters = program().parameters
    return replace(
        program(), parameters=tuple(replace(q, **changes) if q.name == name else q for q in parameters)
    )


def with_state(initial: int) -> Program:
    """Return the program, its state begun elsewhere."""
    ((state, _),) = program().states
    return replace(program(), states=((state, sp.Integer(initial)),))


def with_routine(change: Callable[[Routine], Routine]) -> Program:
    """Return the program, its last routine changed."""
    *others, last = program().routines
    return replace(program(), routines=(*others, change(last)))


def doubled(part: Part, field: str) -> Part:
    """Return the part, the value of its first assignment doubled."""
    first, *rest = getattr(part, field)
    return replace(part, **{field: (replace(first, value=2 * first.value), *rest)})


CHANGES = {
    "initial value of a state": lambda: with_state(1),
    "domain": lambda: with_parameter("M", domain="positive"),
    "default": lambda: with_parameter("M", default=sp.Rational(3, 7)),
    "default in the last digit": lambda: with_parameter(
        "M", default=sp.Rational(1, 2) + sp.Rational(2) ** -53
    ),
    "unit": lambda: with_parameter("M", unit="g"),
    "prepared value": lambda: doubled(program(), "prepare"),
    "operation of a routine": lambda: with_routine(lambda r: doubled(r, "assignments")),
    "order of routines": lambda: replace(program(), routines=program().routines[::-1]),
    "helper": lambda: replace(
        program(), helpers=(doubled(program().helpers[0], "assignments"), *program().helpers[1:])
    ),
    "constants": lambda: replace(program(), constants=(("REGRESSOR", ("a",)), *program().constants[1:])),
    "promise": lambda: replace(program(), promises=("nothing",)),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_what_the_code_follows_from_changes_the_digest(change: Callable[[], Program]) -> None:
    """Any part of the program changed, all files carry one other digest."""
    (before,), (after,) = digests(program()), digests(change())

    assert before != after


@pytest.mark.parametrize("single", [True, False], ids=["single", "double"])
def test_polynomials_change_the_digest(monkeypatch: pytest.MonkeyPatch, *, single: bool) -> None:
    """A coefficient of the polynomials in its last digit, in either precision, is another program."""
    before, exact = digests(program()), c99.polynomial

    def changed(name: str, precision: bool) -> object:
        found = exact(name, precision)
        if precision != single:
            return found
        first, *rest = found.coefficients
        return replace(found, coefficients=(first.replace("e", "1e"), *rest))

    monkeypatch.setattr(c99, "polynomial", changed)
    monkeypatch.setattr(python_module, "polynomial", changed)

    assert before != digests(program())


def test_who_emits_does_not_change_the_digest() -> None:
    """The same program has one digest, by whatever command and from wherever it is emitted."""
    assert digests(program()) == digests(program(), origin="elsewhere", command="eccentric emit")


def test_header_and_source_name_the_digest() -> None:
    """The number by which the C source knows its header is the digest of the banner."""
    files = render_program(program(), "there", "make derive")
    (digest,) = digests(program())

    assert f"_PROGRAM 0x{digest}UL" in files["c2_parallel.h"]
    assert f"_PROGRAM != 0x{digest}UL" in files["c2_parallel.c"]
