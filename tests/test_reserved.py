"""Names are checked where a quantity is made: what is accepted compiles and stays itself."""

import keyword
import re
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.emission import render
from eccentric.emission.program.build import OF_COEFFICIENTS
from eccentric.model import Change, Extension, Model, Role, Term, extended, load_model, quantity
from eccentric.model import vocabulary as v
from generated.eccentric_runtime import Coefficients
from tests.hosts import need

TRIED = (
    *keyword.kwlist,
    *"""
    int double float real bool register restrict typeof nullptr size_t main class new this true operator xor
    co_await char8_t wchar_t requires mutable NAN INFINITY HUGE_VAL DBL_MAX FLT_MAX M_PI M_SQRT2 NULL unix
    linux MAXFLOAT a*/b a-b 1a a.b " theta B_m print E I complex errno EOF self np c out x1
    """.split(),  # noqa: SIM905 - words are easier to read than a list
    *("x y", "", "\N{LATIN SMALL LETTER U WITH DIAERESIS}", "a\nb", "x" * 64, "x" * 63),
)


def accepted(name: str) -> bool:
    """Return whether a quantity can have the name."""
    try:
        quantity(name, "N m", "something")
    except InputError:
        return False
    return True


NAMES = [name for name in TRIED if accepted(name)]


@pytest.mark.parametrize(
    "command", ["gcc -std=c99", "gcc -std=gnu2x", "g++ -std=gnu++20", "clang", "clang++"]
)
def test_accepted_names_are_members_of_a_structure(tmp_path: Path, command: str) -> None:
    """No dialect of C or C++ has taken a name that a quantity can have."""
    need(command.split(maxsplit=1)[0])
    language = "c++" if "++" in command else "c"
    source = tmp_path / "members.c"
    included = ("complex", "errno", "float", "math", "stddef", "stdio")
    headers = "".join(f"#include <{name}.h>\n" for name in included)
    source.write_text(f"{headers}struct s {{ {' '.join(f'double {name};' for name in NAMES)} }};\n")

    done = subprocess.run(
        [*command.split(), "-fsyntax-only", "-x", language, source],
        capture_output=True,
        text=True,
        check=False,
    )

    assert "" == done.stderr


def test_accepted_names_are_attributes_in_python() -> None:
    """Python takes each as the name of a field; the paper's own are accepted."""
    compile("class C:\n" + "".join(f"    {name}: float\n" for name in NAMES), "fields", "exec")

    assert {"theta", "B_m", "E", "x" * 63} <= set(NAMES)
    assert not {*keyword.kwlist, "int", "class", "NAN", "M_PI", "I", "EOF", "x y", "", "x" * 64} & set(NAMES)


@pytest.mark.parametrize("name", ["int", "x y", "a*/b", "__class__", "lambda", "DBL_DIG"])
def test_a_refusal_is_one_line_with_the_name(name: str) -> None:
    """It says what is required of a name, and which came."""
    came = re.escape(repr(name))
    with pytest.raises(InputError, match=rf"^quantity: expected a name .*, got {came}") as refused:
        quantity(name, "N m", "something")

    assert "\n" not in str(refused.value)


def with_drag(name: str) -> Model:
    """Return case C2 with a drag whose coefficient has this name."""
    q = quantity(name, "N m s^4/rad^4", "drag", "", "nonnegative", "0.01")
    basis = v.omega_m.symbol**3 * abs(v.omega_m.symbol)
    term = Term("drag_of_ones_own", "friction", q.symbol, basis, "", (0, None), role=Role.DRAG)
    change = Extension("own", Change({"mechanical": (term,)}), (q,))
    return replace(extended(load_model("c2_parallel"), change), name="tried")


@pytest.mark.parametrize(
    "name",
    [
        *("rest", "load", "part_1", "c", "invalid"),
        *(
            pytest.param(one, marks=pytest.mark.slow)
            for one in ("turns", "size", "q", "chord", "from_top", "rounder", "single", "leading", "p")
        ),
    ],
)
def test_values_of_the_code_are_not_confused_with_a_quantity(name: str) -> None:
    """A parameter with the name of an intermediate value took its place in C without a word."""
    with pytest.raises(InputError, match=f"model tried: expected a quantity .* got '{name}': rename it$"):
        render(with_drag(name))


def test_the_names_of_the_coefficients_object_are_known() -> None:
    """What the runtime's object has beside the coefficients is refused as a name of one of them."""
    own = vars(Coefficients(np.float32)).keys() | {x for x in vars(Coefficients) if not x.startswith("_")}

    assert own == OF_COEFFICIENTS


def test_another_name_is_emitted() -> None:
    """The same drag under a free name is a member of the parameters."""
    assert "double drag_4;" in render(with_drag("drag_4"))["tried.h"]
