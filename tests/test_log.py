"""Logs are read as they were recorded, and a bad file is one line that says what is wrong."""

from __future__ import annotations

import gzip
from typing import TYPE_CHECKING

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.logs import log_names, read_log

if TYPE_CHECKING:
    from pathlib import Path

TEXT = "time_s,run,current_A\n0.0,a,1.5\n0.1,a,\n0.2,b,nan\n"


def test_csv_keeps_numbers_text_and_missing_values(tmp_path: Path) -> None:
    """Numbers become float64 with NaN for empty cells, text stays text, in the order of the header."""
    path = tmp_path / "log.csv"
    path.write_text(TEXT)
    log = read_log(path)
    assert list(log.columns) == ["time_s", "run", "current_A"]
    assert log.rows == 3
    np.testing.assert_array_equal(log.numbers("time_s"), [0.0, 0.1, 0.2])
    np.testing.assert_array_equal(log.numbers("current_A"), [1.5, np.nan, np.nan])
    assert log.text("run").tolist() == ["a", "a", "b"]


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
@pytest.mark.parametrize("suffix", [".csv", ".csv.gz", ".CSV"])
def test_delimiter_and_compression_do_not_change_a_log(tmp_path: Path, delimiter: str, suffix: str) -> None:
    """Comma, semicolon, tab, a byte order mark, line ends of any system and gzip say the same."""
    content = ("\ufeff" + TEXT.replace(",", delimiter).replace("\n", "\r\n")).encode()
    path = tmp_path / f"log{suffix}"
    path.write_bytes(gzip.compress(content) if suffix.endswith("gz") else content)
    log = read_log(path)
    assert list(log.columns) == ["time_s", "run", "current_A"]
    np.testing.assert_array_equal(log.numbers("current_A"), [1.5, np.nan, np.nan])


CUT_OFF = gzip.compress(TEXT.encode() * 100)[:-20]
BAD = {
    "empty.csv": (b"", "empty.csv: expected a header row with column names, got an empty file"),
    "header.csv": (b"time_s,current_A\n", "header.csv: expected a log with rows, got none"),
    "numbers.csv": (
        b"0.0,1.0\n0.1,1.0\n",
        "numbers.csv: expected a header row with column names, got '0.0,1.0' in line 1, which may be names",
    ),
    "ragged.csv": (b"a,b\n1,2\n3\n", "ragged.csv: line 3: expected 2 values, got 1"),
    "commas.csv": (
        b"a,b\n1,2,3,4\n",
        "commas.csv: line 2: expected 2 values, got 4; expected a decimal point",
    ),
    "comments.csv": (b"# made by hand\n\n", "comments.csv: expected a header row with column names"),
    "twice.csv": (b"a,b,a\n1,2,3\n", "twice.csv: expected unique column names, got 'a' 2x"),
    "bytes.csv": (b"t,\x01\xe4\n1,2\n", "bytes.csv: expected UTF-8 text, but byte 3 is not"),
    "cut.csv.gz": (CUT_OFF, "cut.csv.gz: the compressed file is damaged or cut off"),
    "plain.csv.gz": (TEXT.encode(), "plain.csv.gz: the compressed file is damaged or cut off"),
    "log.odt": (b"PK", "log.odt: expected a log of .csv, .txt, .dat, .tsv, .log, .asc, .csv.gz,"),
    "noise.mat": (b"x" * 200, "noise.mat: expected a valid MAT file, got a text that begins with 'xxxxx"),
    "noise.parquet": (
        b"x" * 200,
        "noise.parquet: expected a valid Parquet file, got a text that begins with 'xxxxx",
    ),
    "noise.json": (
        b"x" * 200,
        "noise.json: line 1, column 1: expected valid JSON, got 'xxxxxxxxxxxxxxxxxxxx'",
    ),
    "field.csv": (
        b"a,b\n1," + b"2" * 200_000 + b"\n",
        "field.csv: expected values of at most 131,072 characters, got a longer one",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_file_is_refused_in_one_line(tmp_path: Path, name: str) -> None:
    """What cannot be read as a log is an InputError of one line with file and reason."""
    content, expected = BAD[name]
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_log(path)
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


def test_missing_file_and_directory_are_refused(tmp_path: Path) -> None:
    """A path without file and a directory are named as what they are."""
    with pytest.raises(InputError, match=r"none\.csv: no such file"):
        read_log(tmp_path / "none.csv")
    with pytest.raises(InputError, match="expected a regular file, got a directory"):
        read_log(tmp_path)


def test_text_in_a_numeric_column_is_named_with_row_and_column(tmp_path: Path) -> None:
    """Text is refused only where numbers are required, with its first row."""
    path = tmp_path / "log.csv"
    path.write_text("time_s,current_A\n0.0,1.0\n0.1,oops\n0.2,1.0\n")
    log = read_log(path)
    with pytest.raises(
        InputError, match=r"log\.csv: line 3, column 'current_A': expected a number, .* 'oops'"
    ):
        log.numbers("current_A")


def test_lines_are_those_of_an_editor(tmp_path: Path) -> None:
    """Comments and empty lines at the head are skipped and counted, as are empty lines between rows."""
    path = tmp_path / "log.csv"
    path.write_text("# recorded at 250 Hz\n\ntime_s,current_A\n0.0,1.0\n\n0.1,oops\n")
    log = read_log(path)
    assert (log.rows, log.place(0), log.place(1)) == (2, "line 4", "line 6")
    with pytest.raises(InputError, match=r"log\.csv: line 6, column 'current_A'"):
        log.numbers("current_A")


@pytest.mark.parametrize("delimiter", [",", " , ", ";", "\t", " "])
def test_column_names_in_the_last_comment_are_the_header(tmp_path: Path, delimiter: str) -> None:
    """numpy.savetxt writes its header as a comment; names parted by spaces will do, too."""
    path = tmp_path / "log.csv"
    np.savetxt(path, [[0.0, 1.5], [0.1, 2.5]], delimiter=delimiter.strip(" ") or ",", header=f"t{delimiter}i")
    log = read_log(path)
    assert list(log.columns) == ["t", "i"]
    np.testing.assert_array_equal(log.numbers("i"), [1.5, 2.5])
    assert log.place(0) == "line 2"


def test_a_cell_that_is_no_number_is_named_beside_decimal_commas(tmp_path: Path) -> None:
    """Between semicolons a comma is a decimal one; what is no number even so is named with its line."""
    path = tmp_path / "log.csv"
    path.write_text("time_s;current_A\n0,0;1,5\n0,1;2,5\n0,2;x,5\n")
    log = read_log(path)
    assert [0.0, 0.1, 0.2] == log.numbers("time_s").tolist()
    with pytest.raises(InputError, match=r"line 4, column 'current_A': expected a number, got 'x,5'"):
        log.numbers("current_A")


def test_missing_column_lists_the_columns(tmp_path: Path) -> None:
    """A column that is not there is answered with those that are."""
    path = tmp_path / "log.csv"
    path.write_text(TEXT)
    with pytest.raises(InputError, match="expected column 'speed', but the log has time_s, run, current_A"):
        read_log(path).numbers("speed")
    with pytest.raises(InputError, match="the log has time_s, run, current_A; did you mean 'current_A'"):
        read_log(path).numbers("curent_A")


def test_logs_of_one_name_are_told_apart_by_their_folders(tmp_path: Path) -> None:
    """A file is called by its name; beside another of that name, by as many folders as make a difference."""
    paths = [tmp_path / at / "log.csv" for at in ("may/one", "june/one", "june/two")]
    for path in paths:
        path.parent.mkdir(parents=True)
        path.write_text(TEXT)
    first, second, third = (read_log(path) for path in paths)
    assert log_names([first]) == ("log.csv",)
    assert log_names([second, third]) == ("one/log.csv", "two/log.csv")
    assert log_names([first, second]) == ("may/one/log.csv", "june/one/log.csv")
