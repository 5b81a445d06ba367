"""Logs are read as they were recorded; a bad file, or one beyond the memory, is one line that says why."""

from __future__ import annotations

import gzip
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.logs import Log, foreign, log_names, read_log

TEXT = "time_s,run,current_A\n0.0,a,1.5\n0.1,a,\n0.2,b,nan\n"


def as_csv(folder: Path, text: str) -> Log:
    """Write a text as a CSV log and read it."""
    (folder / "log.csv").write_text(text)
    return read_log(folder / "log.csv")


def test_csv_keeps_numbers_text_and_missing_values(tmp_path: Path) -> None:
    """Numbers become float64 with NaN for empty cells, text stays text, in the order of the header."""
    log = as_csv(tmp_path, TEXT)
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
    "log.odt": (
        b"PK",
        "log.odt: expected a log such as .csv, .mat or .parquet (docs/rig-reference.md lists all formats),",
    ),
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
    log = as_csv(tmp_path, "time_s,current_A\n0.0,1.0\n0.1,oops\n0.2,1.0\n")
    with pytest.raises(
        InputError, match=r"log\.csv: line 3, column 'current_A': expected a number, .* 'oops'"
    ):
        log.numbers("current_A")


def test_lines_are_those_of_an_editor(tmp_path: Path) -> None:
    """Comments and empty lines at the head are skipped and counted, as are empty lines between rows."""
    log = as_csv(tmp_path, "# recorded at 250 Hz\n\ntime_s,current_A\n0.0,1.0\n\n0.1,oops\n")
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
    log = as_csv(tmp_path, "time_s;current_A\n0,0;1,5\n0,1;2,5\n0,2;x,5\n")
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


ROWS = 1000


def _csv(path: Path) -> None:
    path.write_bytes(gzip.compress(b"t,i\n" + b"1,2\n" * ROWS))


def _empty_lines(path: Path) -> None:
    path.write_text("t,i\n" + "1,2\n" * 10 + "\n" * ROWS)


def _json(path: Path) -> None:
    path.write_text(json.dumps({"entries": [{"t": 1, "i": 2}] * ROWS}))


def _json_by_columns(path: Path) -> None:
    path.write_text(json.dumps({"mass": 1.0, "t": [1] * ROWS, "i": [2] * ROWS}))


def _json_with_lists(path: Path) -> None:
    path.write_text(json.dumps([{"t": 1, "i": 2, "q": [3, 4]}] * ROWS))


def _mat(path: Path) -> None:
    from scipy.io import savemat

    savemat(path, {"log": {"t": np.zeros(ROWS, np.int8), "i": np.zeros(ROWS)}}, do_compression=True)


def _mat_7_3(path: Path) -> None:
    h5py = pytest.importorskip("h5py", exc_type=ImportError)
    with h5py.File(path, "w", userblock_size=512) as file:
        for name in "ti":
            file.create_dataset(f"log/{name}", data=np.zeros((1, ROWS)), compression="gzip")
    with path.open("r+b") as head:
        head.write(b"MATLAB 7.3".ljust(124) + b"\x00\x02IM")


def _parquet(path: Path) -> None:
    arrow, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    parquet.write_table(arrow.table({"t": np.zeros(ROWS), "i": np.zeros(ROWS)}), path)


@pytest.mark.parametrize(
    ("name", "make"),
    [
        ("log.csv.gz", _csv),
        ("empty.csv", _empty_lines),
        ("log.json", _json),
        ("columns.json", _json_by_columns),
        ("lists.json", _json_with_lists),
        ("log.mat", _mat),
        ("log73.mat", _mat_7_3),
        ("log.parquet", _parquet),
    ],
    ids=["csv", "empty lines", "json", "json by columns", "json with lists", "mat", "mat 7.3", "parquet"],
)
def test_a_log_that_memory_does_not_hold_is_one_line(
    name: str, make: Callable[[Path], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 1,000 rows a tenth of the memory for them holds a tenth; with enough of it the log is read."""
    make(tmp_path / name)
    assert read_log(tmp_path / name).rows >= 10
    monkeypatch.setattr(foreign, "free_memory", lambda: 30_000)

    with pytest.raises(InputError) as refused:
        read_log(tmp_path / name)
    said = str(refused.value).removeprefix(f"{tmp_path / name}: ")
    most = int(said.removeprefix("expected at most ").split()[0].replace(",", ""))
    assert "rows of this kind, for which the 3e-05 GB of free memory suffice, got 1,0" in said
    assert 10 < most < ROWS / 5


def test_rows_are_counted_before_they_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two million short rows are refused within a fraction of the time that reading them takes."""
    path = tmp_path / "log.csv.gz"
    path.write_bytes(gzip.compress(b"t\n" + b"1\n" * 2_000_000))
    monkeypatch.setattr("csv.reader", lambda *_, **__: pytest.fail("a row must not be read"))
    monkeypatch.setattr(foreign, "free_memory", lambda: 100_000_000)

    with pytest.raises(InputError, match=r"got 2,000,00\d rows with 2,000,00\d values, for about"):
        read_log(path)


def _system(root: Path, **files: str) -> Path:
    """A root folder with these files of the system."""
    paths = {
        "meminfo": "proc/meminfo",
        "groups": "proc/self/cgroup",
        "top": "sys/fs/cgroup/memory.max",
        "job": "sys/fs/cgroup/batch/job/memory.max",
        "used": "sys/fs/cgroup/batch/job/memory.current",
        "kinds": "sys/fs/cgroup/batch/job/memory.stat",
        "v1": "sys/fs/cgroup/memory/memory.limit_in_bytes",
        "v1_used": "sys/fs/cgroup/memory/memory.usage_in_bytes",
        "v1_kinds": "sys/fs/cgroup/memory/memory.stat",
    }
    for name, text in files.items():
        (root / paths[name]).parent.mkdir(parents=True, exist_ok=True)
        (root / paths[name]).write_text(text)
    return root


MACHINE = {"meminfo": "MemTotal:  9000 kB\nMemFree:  1000 kB\nMemAvailable:  5000 kB\n"}
GROUP = {
    "groups": "0::/batch/job\n",
    "top": "max\n",
    "used": "3000000\n",
    "kinds": "anon 1000000\ninactive_file 500000\n",
}


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        (MACHINE, 5_120_000),
        (MACHINE | GROUP | {"job": "4000000\n"}, 1_500_000),
        (MACHINE | GROUP | {"job": "max\n"}, 5_120_000),
        (MACHINE | GROUP | {"job": "1000000\n"}, 0),
        (MACHINE | {"v1": "4000000", "v1_used": "3000000", "v1_kinds": "inactive_file 0\n"}, 1_000_000),
    ],
    ids=["machine", "group", "group without a limit", "group that is full", "group of version 1"],
)
def test_the_least_of_all_limits_counts(files: dict[str, str], expected: int, tmp_path: Path) -> None:
    """What the machine has available, in 1024 bytes, or what the control group of the process leaves."""
    assert expected == foreign.free_memory(_system(tmp_path, **files))


def test_the_limit_of_the_process_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """After `ulimit -v` it is what has not been taken of that, in pages."""
    resource = pytest.importorskip("resource")
    _system(tmp_path, **MACHINE)
    (tmp_path / "proc/self").mkdir()
    (tmp_path / "proc/self/statm").write_text("100 50 10 1 0 20 0\n")
    page = resource.getpagesize()
    monkeypatch.setattr(resource, "getrlimit", lambda _: (101 * page, 101 * page))

    assert page == foreign.free_memory(tmp_path)


def test_a_system_that_says_nothing_has_some(tmp_path: Path) -> None:
    """Without the files of Linux it is the memory that is built in."""
    assert 1e8 < foreign.free_memory(tmp_path)
