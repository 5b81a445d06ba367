"""Whatever a user's file contains, it is read or refused in one line: no other exception, no hang."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from datetime import timedelta
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

import eccentric
from tests.fuzzing import TARGETS

EXTRAS = {
    ".parquet": "pyarrow",
    ".mat (7.3)": "h5py",
    ".h5": "h5py",
    ".mf4": "asammdf",
    ".db3": "rosbags",
    ".mcap": "mcap",
    ".ulg": "pyulog",
    ".tdms": "nptdms",
    ".bag": "rosbags",
    ".xlsx": "openpyxl",
    "arm .urdf": "yourdfpy",
}


@pytest.mark.parametrize("name", TARGETS)
@pytest.mark.filterwarnings("ignore::SyntaxWarning")  # Python's parser on odd arithmetic
@settings(
    max_examples=30,
    deadline=timedelta(seconds=5),
    phases=(Phase.generate,),
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_random_and_damaged_input_is_read_or_refused(name: str, data: st.DataObject) -> None:
    """Bytes, damaged files, odd rigs and odd arithmetic end in a value or in an InputError of one line."""
    if name in EXTRAS:
        pytest.importorskip(EXTRAS[name], reason=f"{EXTRAS[name]} is not installed")
    target = TARGETS[name]
    assert target.take(data.draw(target.inputs)) in {"accepted", "refused"}


ODD_RIGS = {
    "digits.json": b'{"known": {"M_kg": ' + b"1" * 5000 + b"}}",
    "digits.toml": b"[known]\nM_kg = " + b"1" * 5000,
    "deep.json": b"[" * 100_000,
    "deep.toml": b"a = " + b"[" * 100_000,
}


@pytest.mark.parametrize("name", ODD_RIGS)
def test_a_rig_that_is_too_much_for_its_parser_is_refused(name: str) -> None:
    """Numbers of thousands of digits and endless brackets are one line, too."""
    suffix = name[name.index(".") :]
    assert TARGETS[f"rig {suffix}"].take(ODD_RIGS[name]) == "refused"


def test_a_rig_with_a_byte_order_mark_is_read() -> None:
    """Editors of Windows write one; it says nothing."""
    assert TARGETS["rig .toml"].take(b"\xef\xbb\xbf[known]\ncase = 'C2'\n") == "accepted"


@pytest.mark.slow
@pytest.mark.parametrize("name", TARGETS)
def test_the_fuzz_reaches_both_ends(name: str) -> None:
    """Of the inputs of each target some are accepted and some refused."""
    if name in EXTRAS:
        pytest.importorskip(EXTRAS[name], reason=f"{EXTRAS[name]} is not installed")
    found: set[str] = set()

    @settings(max_examples=300, phases=(Phase.generate,), deadline=None)
    @given(TARGETS[name].inputs)
    def look(content: object) -> None:
        if found != {"accepted", "refused"}:
            found.add(TARGETS[name].take(content))

    look()
    assert found == {"accepted", "refused"}


# Whatever the columns of a log contain, `fit` and `diagnose` end in a result or in one line.


EXAMPLE = Path(__file__).parents[1] / "examples" / "bench"
COLUMNS = ("time_s", "theta_m_rad", "omega_m_rad_s", "voltage_V", "current_A")
ROWS = 600
VALUES = (float("inf"), float("nan"), 1e308, 1e-310)

Column = np.ndarray


def at_one_row(value: object) -> Callable[[Column], list[Any]]:
    """The column with another value in one row."""
    return lambda x: [*x[:500], value, *x[501:]]


DAMAGES: dict[str, Callable[[Column], Any]] = {
    **{f"{value} in one row": at_one_row(value) for value in VALUES},
    **{f"{value} in every row": lambda x, v=value: np.full_like(x, v) for value in VALUES},
    "-inf in a tenth": lambda x: np.where(np.arange(len(x)) % 10 == 3, -np.inf, x),
    **{f"times {factor:g}": lambda x, f=factor: f * x for factor in (-1.0, 1e-9, 1e9, 1e100)},
    "text in one row": at_one_row("fast"),
    "empty text in one row": at_one_row(""),
    "empty text": lambda x: [""] * len(x),
    "text": lambda x: ["fast"] * len(x),
    "backwards": lambda x: x[::-1],
    "shuffled": lambda x: np.random.default_rng(1).permutation(x),
    "backwards in the middle": lambda x: np.r_[x[:400], x[400:600][::-1], x[600:]],
    "repeated": lambda x: np.repeat(x[::2], 2),
    "a jump": lambda x: x + np.where(np.arange(len(x)) < 500, 0.0, 1e6),
    "alternating signs": lambda x: x * (-1.0) ** np.arange(len(x)),
    "noise": lambda x: np.random.default_rng(2).normal(0.0, 1.0, len(x)),
}
LENGTHS = (0, 1, 2, 3, 10, 30, 100, 260)


@pytest.fixture(scope="module")
def plain() -> dict[str, Column]:
    """The first seconds of the bundled log."""
    log = eccentric.read_log(EXAMPLE / "bench.csv.gz")
    return {name: log.numbers(name)[:ROWS] for name in COLUMNS}


@pytest.fixture(scope="module")
def rig() -> dict[str, Any]:
    """Its rig, without the intervals that it holds out: they are later."""
    content = tomllib.loads((EXAMPLE / "bench.toml").read_text(encoding="utf-8"))
    return {key: value for key, value in content.items() if not key.startswith("holdout")}


def outcomes(table: dict[str, Any], rig: dict[str, Any]) -> list[str]:
    """What both commands say of a table: "" for a result, else their one line."""
    said = []
    for command in (eccentric.fit, partial(eccentric.diagnose, only="cubic_drag")):
        try:
            command(table, rig)
        except eccentric.InputError as error:
            said.append(str(error))
        else:
            said.append("")
    return said


@pytest.mark.parametrize(
    ("column", "damage"),
    [
        # Every damage, and every column, in a sixth of the pairs; slow in half of them.
        pytest.param(column, damage, marks=() if (c + d) % 6 == 0 else pytest.mark.slow)
        for c, column in enumerate(COLUMNS)
        for d, damage in enumerate(DAMAGES)
        if (c + d) % 2 == 0
    ],
)
def test_an_odd_column_ends_in_a_result_or_in_one_line(
    column: str, damage: str, plain: dict[str, Column], rig: dict[str, Any]
) -> None:
    """Infinite, huge, tiny and missing values, text, and clocks that run backwards."""
    for said in outcomes({**plain, column: DAMAGES[damage](plain[column])}, rig):
        assert "\n" not in said


@pytest.mark.parametrize("length", LENGTHS)
def test_a_short_log_ends_in_a_result_or_in_one_line(
    length: int, plain: dict[str, Column], rig: dict[str, Any]
) -> None:
    """Without rows, with one, and with up to a second of them, which a fit can do with."""
    for said in outcomes({name: x[:length] for name, x in plain.items()}, rig):
        assert said or length == LENGTHS[-1]
        assert "\n" not in said
