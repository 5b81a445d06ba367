"""Tables in memory are logs: the same columns whatever library holds them, one line for what is no table."""

from __future__ import annotations

import sys
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from eccentric.core import InputError
from eccentric.logs import read_log

COLUMNS: dict[str, list[Any]] = {
    "time_s": [0.0, 0.1, 0.2],
    "counts": [1, None, 3],
    "on": [True, False, True],
    "run": ["a", "b", "b"],
    "stamp": [datetime(1970, 1, 1, 0, 0, 1, 500000, tzinfo=UTC), None, datetime(1970, 1, 2, tzinfo=UTC)],
    "since": [timedelta(milliseconds=250), timedelta(0), None],
}
EXPECTED: dict[str, list[Any]] = {
    "time_s": [0.0, 0.1, 0.2],
    "counts": [1.0, np.nan, 3.0],
    "on": [1.0, 0.0, 1.0],
    "run": ["a", "b", "b"],
    "stamp": [1.5, np.nan, 86400.0],
    "since": [0.25, 0.0, np.nan],
}
WANTED = "expected a path or a table (a dict of arrays, or a table of pandas, polars or pyarrow), got"
COLUMN = "table: column 't'"


class Arrow:
    """A table that has the Arrow PyCapsule interface and nothing else."""

    def __init__(self, table: pa.Table) -> None:
        self.table = table

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        return self.table.__arrow_c_stream__(requested_schema)


class Interchange:
    """A table that has the dataframe interchange protocol and nothing else."""

    def __init__(self, table: pa.Table) -> None:
        self.table = table

    def __dataframe__(self, nan_as_null: bool = False, allow_copy: bool = True) -> Any:
        return self.table.__dataframe__(nan_as_null, allow_copy)


class Named:
    """A table that gives its columns by name and speaks no protocol, as older frames do."""

    def __init__(self, columns: dict[str, Any]) -> None:
        self._columns = columns

    @property
    def columns(self) -> list[str]:
        """Names."""
        return list(self._columns)

    def __getitem__(self, name: str) -> Any:
        return self._columns[name]


def arrays() -> dict[str, Any]:
    """The columns as NumPy holds them: stamps of NumPy, a masked array."""
    stamps = [None if x is None else x.replace(tzinfo=None) for x in COLUMNS["stamp"]]
    return COLUMNS | {
        "counts": np.ma.array([1, 2, 3], mask=[False, True, False]),
        "stamp": np.array(stamps, dtype="datetime64[us]"),
        "since": np.array(COLUMNS["since"], dtype="timedelta64[us]"),
    }


def polars_frame() -> Any:
    """The columns in polars."""
    return pytest.importorskip("polars").DataFrame(COLUMNS)


def pandas_frame() -> Any:
    """The columns in pandas, with its own integers that may be missing."""
    return pytest.importorskip("pandas").DataFrame(COLUMNS).astype({"counts": "Int64"})


TABLES = {
    "dict of arrays": arrays,
    "columns by name": lambda: Named(arrays()),
    "pyarrow": lambda: pa.table(COLUMNS),
    "pyarrow, in batches": lambda: pa.table(COLUMNS).to_reader(),
    "Arrow PyCapsule": lambda: Arrow(pa.table(COLUMNS)),
    "pandas": pandas_frame,
    "polars": polars_frame,
}


def check(table: Any, expected: dict[str, list[Any]]) -> None:
    """Whether a log has these columns, missing values included."""
    log = read_log(table)
    assert list(expected) == list(log.columns)
    for name, values in expected.items():
        np.testing.assert_array_equal(values, log.columns[name], err_msg=name)
        assert log.columns[name].dtype.kind == ("U" if name == "run" else "f"), name
    assert (3, "table", None, ()) == (log.rows, log.path, log.lines, log.notes)


@pytest.mark.parametrize("kind", TABLES)
def test_every_table_gives_the_same_columns(kind: str) -> None:
    """Numbers are float64, missing ones NaN, truth is 1, dates and durations are seconds, text stays text."""
    check(TABLES[kind](), EXPECTED)


def test_the_interchange_protocol_gives_the_same_columns() -> None:
    """Without durations, which the protocol does not know."""
    check(
        Interchange(pa.table(COLUMNS).drop_columns("since")),
        {name: values for name, values in EXPECTED.items() if name != "since"},
    )


@pytest.mark.parametrize("kind", ["dict of arrays", "columns by name", "polars", "pandas"])
def test_pyarrow_is_not_needed(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where pyarrow is not installed, columns are taken by their names."""
    table = TABLES[kind]()
    if kind == "pandas":
        # Without pyarrow, a zone makes a column of objects: pandas has then its own class for stamps.
        table["stamp"] = table["stamp"].dt.tz_localize(None)
    if kind == "polars":
        table = table.with_columns(table["stamp"].dt.replace_time_zone(None))
    without_pyarrow(monkeypatch)

    check(table, EXPECTED)


def test_a_table_that_only_pyarrow_reads_names_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without pyarrow, a table that speaks Arrow alone is refused with what has to be installed."""
    table = Arrow(pa.table(COLUMNS))
    without_pyarrow(monkeypatch)

    said = 'table: pyarrow is required for a table of type Arrow: pip install "eccentric[parquet]"'
    assert said == refused(table)


def without_pyarrow(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make `import pyarrow` fail, as where it is not installed."""
    for name in [name for name in sys.modules if name.split(".")[0] == "pyarrow"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "pyarrow", None)


def test_a_structured_array_is_a_table() -> None:
    """The fields of a structured array are its columns."""
    log = read_log(np.array([(0.0, 1), (0.5, 2)], dtype=[("t", float), ("n", int)]))

    assert {"t": [0.0, 0.5], "n": [1.0, 2.0]} == {name: x.tolist() for name, x in log.columns.items()}


def test_a_single_value_is_a_column_that_says_it_in_every_row() -> None:
    """So that arithmetic in the rig can use the voltage of a supply, or a run have a name."""
    log = read_log({"t": [0.0, 1.0], "supply_V": 12, "run": "cold"}, name="monday")

    assert ([12.0, 12.0], ["cold", "cold"]) == (log.numbers("supply_V").tolist(), log.text("run").tolist())
    assert "monday" == log.path


def test_columns_of_other_things_are_left_out_with_a_note() -> None:
    """Lists and complex numbers are no signals: the log says which columns it left out."""
    notes = [
        read_log({"t": [0.0, 1.0], "z": np.array([1j, 2.0]), "pair": Named({})}).notes,
        read_log(pa.table({"t": [0.0, 1.0], "pair": [b"1", b"2"]})).notes,
    ]

    left_out = "left out, since they are neither numbers nor text:"
    assert [(f"{left_out} z, pair",), (f"{left_out} pair (binary)",)] == notes


def test_the_log_is_a_copy() -> None:
    """What happens to the array later does not happen to the log."""
    t = np.array([0.0, 1.0])
    log = read_log({"t": t})
    t[0] = 5.0

    assert [0.0, 1.0] == log.numbers("t").tolist()


def test_a_log_is_its_own_log() -> None:
    """What was read once is not read again."""
    log = read_log({"t": [0.0]})

    assert log is read_log(log)


@pytest.mark.parametrize(
    ("table", "line"),
    [
        ([1.0, 2.0], f"table: {WANTED} list of float"),
        ([{"t": 0.0}], f"table: {WANTED} list of dict"),
        (3, f"table: {WANTED} int"),
        (None, f"table: {WANTED} NoneType"),
        (np.zeros(3), f"table: {WANTED} ndarray"),
        ({}, "table: expected a log with rows, got none"),
        ({"t": []}, "table: expected a log with rows, got none"),
        ({"t": 1.0}, "table: expected columns, each an array of numbers, got single values"),
        ({"t": [0, 1, 2], "i": [1, 2]}, "table: column 'i': expected 3 rows, as in 't', got 2"),
        ({"t": np.zeros((4, 2))}, f"{COLUMN}: expected one dimension, got shape (4, 2)"),
        (
            {"t": [[1], [1, 2]]},
            f"{COLUMN}: expected numbers (n,), got a list that NumPy makes no array of",
        ),
        ({0: [1.0]}, "table: expected column names of type str, got 0"),
        (
            pa.table([[1.0], [2.0]], names=["t", "t"]),
            "table: expected unique column names, got 't' 2x",
        ),
    ],
    ids=[
        *(
            "list",
            "records",
            "number",
            "nothing",
            "array without names",
            "no columns",
            "no rows",
            "no arrays",
        ),
        *("ragged", "matrix", "nested", "name that is no text", "name twice"),
    ],
)
def test_what_is_no_log_is_refused_in_one_line(table: Any, line: str) -> None:
    """The line names the table, the column, what is required and what was received."""
    assert line == refused(table)


def test_the_name_of_a_table_begins_its_messages() -> None:
    """Where a table has a name, messages use it."""
    with pytest.raises(InputError) as error:
        read_log({"t": 1.0}, name="monday")

    assert str(error.value).startswith("monday: ")


def refused(table: Any) -> str:
    """The line that reading ends with."""
    with pytest.raises(InputError) as error:
        read_log(table)
    return str(error.value)
