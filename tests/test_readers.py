"""Every format gives the same columns; whatever else a file holds is named, never dropped silently."""

from __future__ import annotations

import errno
import gzip
import json
import sys
from datetime import UTC, datetime, timedelta
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.logs import Log, limits, read_log
from eccentric.logs.foreign import reading

ENTRIES = [
    {"timestamp": 0.0, "position": -0.5, "load": 0, "torque_enable": True, "note": "ok"},
    {"timestamp": 0.1, "position": 1, "torque_enable": False, "load": None},
    {"timestamp": 0.2, "position": 1.5, "load": 7, "torque_enable": True, "note": "ok", "raw": [1, 2]},
]
HEAD = {"mass": 0.49, "kp": 100, "motor": "xl330", "homed": True, "operator": None}


def json_log(tmp_path: Path, content: object) -> Log:
    """Write a JSON log and read it."""
    (tmp_path / "log.json").write_text(json.dumps(content), encoding="utf-8")
    return read_log(tmp_path / "log.json")


def columns(log: Log) -> dict[str, list[Any]]:
    """Columns as lists, for comparison."""
    return {name: values.tolist() for name, values in log.columns.items()}


# JSON


@pytest.mark.parametrize("suffix", [".json", ".json.gz", ".JSON"])
def test_entries_of_a_recorder_are_rows_and_its_settings_say_the_same_in_each(
    tmp_path: Path, suffix: str
) -> None:
    """A missing key or null is NaN, true is 1; numbers and texts of the head are constants."""
    content = json.dumps(HEAD | {"entries": ENTRIES}).encode()
    path = tmp_path / f"log{suffix}"
    path.write_bytes(gzip.compress(content) if suffix.endswith("gz") else content)
    log = read_log(path)
    np.testing.assert_array_equal(log.numbers("timestamp"), [0.0, 0.1, 0.2])
    np.testing.assert_array_equal(log.numbers("load"), [0.0, np.nan, 7.0])
    np.testing.assert_array_equal(log.numbers("torque_enable"), [1.0, 0.0, 1.0])
    np.testing.assert_array_equal(log.numbers("mass"), [0.49, 0.49, 0.49])
    np.testing.assert_array_equal(log.numbers("homed"), [1.0, 1.0, 1.0])
    assert log.text("motor").tolist() == ["xl330"] * 3
    assert log.text("note").tolist() == ["ok", "", "ok"]
    assert "operator" not in log.columns
    assert (log.rows, log.place(1)) == (3, "row 2")
    assert log.notes == ("left out, since most variables have 3 rows: raw (2)",)


def test_a_setting_named_like_a_key_of_the_rows_goes_by_its_full_name(tmp_path: Path) -> None:
    """Neither hides the other: the setting keeps its name, the column is `entries.kp`."""
    log = json_log(tmp_path, {"kp": 3, "entries": [{"t": 0.0, "kp": 1.0}, {"t": 0.1, "kp": 2.0}]})
    assert columns(log) == {"kp": [3.0, 3.0], "t": [0.0, 0.1], "entries.kp": [1.0, 2.0]}


@pytest.mark.parametrize(
    "content", [[{"t": 0.0, "i": 1.0}, {"t": 0.1, "i": 2.0}], {"t": [0.0, 0.1], "i": [1, 2]}]
)
def test_a_list_of_rows_and_a_list_for_each_column_are_logs(tmp_path: Path, content: object) -> None:
    """The two other ways in which a table is written as JSON give the same columns."""
    assert columns(json_log(tmp_path, content)) == {"t": [0.0, 0.1], "i": [1.0, 2.0]}


BAD_JSON = {
    "rig": (
        '{"known": {"case": "C1"}, "columns": {}}',
        "expected a JSON log with a list of entries, got keys 'known', 'columns'",
    ),
    "empty": ('{"entries": []}', "expected a JSON log with a list of entries, got keys 'entries'"),
    "number": ("3", "expected a JSON object with a list of entries, got 3"),
    "cut": ('{"entries": [{"t": 1', "line 1, column 21: expected valid JSON, got the end of the file"),
    "cut line": (
        '{"t": 1}\n{"t": 2}\n{"t": 3}\n{"t":',
        "line 4, column 6: expected valid JSON, an object in each line, got the end of the line (cut off?)",
    ),
    "deep": ("[" * 100_000, "with a list of entries, got lists nested too deep"),
    "digits": (
        '{"entries": [{"t": ' + "1" * 5000 + "}]}",
        "expected numbers of at most 4,300 digits, got a longer one",
    ),
}


@pytest.mark.parametrize("name", BAD_JSON)
def test_json_that_is_no_log_is_refused(tmp_path: Path, name: str) -> None:
    """One line says what is required and what came."""
    content, expected = BAD_JSON[name]
    (tmp_path / "log.json").write_text(content, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_log(tmp_path / "log.json")
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_separator_inside_a_text_ends_no_line_of_json(tmp_path: Path) -> None:
    """U+2028 ends a line of Unicode, and none of a file."""
    (tmp_path / "log.json").write_text('{"t": 1, "s": "a\u2028b"}\n{"t": 2, "s": "c"}\n', encoding="utf-8")

    assert read_log(tmp_path / "log.json").numbers("t").tolist() == [1.0, 2.0]


# Parquet


def parquet_log(tmp_path: Path, table: dict[str, Any], folder: str = "") -> Log:
    """Write a Parquet table and read it."""
    arrow = pytest.importorskip("pyarrow", reason="the extra parquet is not installed")
    parquet = pytest.importorskip("pyarrow.parquet")
    path = tmp_path / folder / "log.parquet"
    path.parent.mkdir(exist_ok=True)
    parquet.write_table(arrow.table(table), path)
    return read_log(path)


def test_parquet_gives_the_same_columns_as_csv(tmp_path: Path) -> None:
    """Numbers, truth values, decimals, text and nulls of a Parquet table arrive as those of a CSV file."""
    log = parquet_log(
        tmp_path,
        {
            "time_s": [0.0, 0.1],
            "current_A": [1, None],
            "on": [True, None],
            "supply": [Decimal("24.5"), None],
            "run": ["a", None],
            "digits": ["1.5", "2"],
        },
        folder="run=3",
    )
    assert list(log.columns) == ["time_s", "current_A", "on", "supply", "run", "digits"]
    np.testing.assert_array_equal(log.numbers("current_A"), [1.0, np.nan])
    np.testing.assert_array_equal(log.numbers("on"), [1.0, np.nan])
    np.testing.assert_array_equal(log.numbers("supply"), [24.5, np.nan])
    np.testing.assert_array_equal(log.numbers("digits"), [1.5, 2.0])
    assert log.text("run").tolist() == ["a", ""]


def test_parquet_stamps_are_seconds_and_lists_are_named(tmp_path: Path) -> None:
    """Stamps count from 1970 (UTC), durations from zero; lists of text are left out with their type."""
    start = datetime(1970, 1, 2, tzinfo=UTC)
    log = parquet_log(
        tmp_path,
        {
            "stamp": [start, start + timedelta(milliseconds=4)],
            "since": [timedelta(seconds=1.5), None],
            "raw": [[1], [2]],
            "names": [["a"], ["b"]],
        },
    )
    np.testing.assert_allclose(log.numbers("stamp"), [86400.0, 86400.004], rtol=1e-12)
    np.testing.assert_array_equal(log.numbers("since"), [1.5, np.nan])
    (note,) = log.notes
    assert note.startswith("left out, since they are neither numbers nor text: names (list<")
    assert [1.0, 2.0] == log.numbers("raw(:,1)").tolist()


def test_parquet_without_its_extra_names_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without pyarrow, a Parquet log says what to install."""
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    path = tmp_path / "log.parquet"
    path.write_bytes(b"PAR1")
    with pytest.raises(
        InputError, match=r'pyarrow is required for \.parquet: pip install "eccentric\[parquet\]"'
    ):
        read_log(path)


# Size


def test_a_log_above_the_limit_is_refused_without_unpacking_all_of_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A gzip file that unfolds to more than the limit is one line."""
    monkeypatch.setattr(limits, "MOST_CHARACTERS", 1000)
    path = tmp_path / "log.csv.gz"
    path.write_bytes(gzip.compress(b"a,b\n" + b"1,2\n" * 1000))
    with pytest.raises(InputError, match="expected at most 1,000 characters, got more"):
        read_log(path)


def test_json_with_an_object_in_each_line(tmp_path: Path) -> None:
    """Rows as loggers append them; a key may be missing."""
    path = tmp_path / "log.json"
    path.write_text('{"t": 0.0, "q": 1.5}\n{"t": 0.1, "q": 2.5}\n\n{"t": 0.2}\n')
    log = read_log(path)

    assert log.numbers("t").tolist() == [0.0, 0.1, 0.2]
    assert log.numbers("q")[:2].tolist() == [1.5, 2.5]


def test_a_file_that_is_not_read_is_not_called_damaged(tmp_path: Path) -> None:
    """What the system refuses says nothing of the content."""
    path = tmp_path / "log.xyz"
    path.write_bytes(b"\0\1")
    with pytest.raises(IsADirectoryError), reading(path, "workbook"):
        raise IsADirectoryError(errno.EISDIR, "is a directory")
    with pytest.raises(InputError, match="damaged"), reading(path, "workbook"):
        raise OSError("unable to open file: truncated")
