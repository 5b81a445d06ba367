"""A log in parts: the same rows as whole, only the columns asked for, and errors that name the row."""

from __future__ import annotations

import gzip
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.logs import LogStream, limits, read_log, stream_log
from eccentric.logs.formats import FORMATS as KNOWN

ROWS = 1000
NUMBERS = np.random.default_rng(7).normal(size=(ROWS, 3))
RUNS = np.repeat(["first", "second"], ROWS // 2)
SPANS = [(0, 3), (250, 251), (399, 402), (640, 990)]


def columns() -> dict[str, Any]:
    """Three columns of numbers and one of text."""
    return dict(zip(("time_s", "current_A", "unused"), NUMBERS.T, strict=True)) | {"run": RUNS}


def as_csv(folder: Path) -> Path:
    """With a remark above the header, and a missing value."""
    path = folder / "log.csv"
    rows = [",".join([*map(repr, map(float, row)), run]) for row, run in zip(NUMBERS, RUNS, strict=True)]
    path.write_text("\n".join(["# a remark", "time_s,current_A,unused,run", *rows]) + "\n")
    return path


def as_csv_gz(folder: Path) -> Path:
    """The same, packed."""
    path = folder / "log.csv.gz"
    path.write_bytes(gzip.compress(as_csv(folder).read_bytes()))
    return path


def as_parquet(folder: Path) -> Path:
    """Row groups of 300 rows."""
    arrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    parquet.write_table(arrow.table(columns()), folder / "log.parquet", row_group_size=300)
    return folder / "log.parquet"


def as_mat(folder: Path) -> Path:
    """Version 5, which is read whole."""
    from scipy.io import savemat

    numbers = {name: x for name, x in columns().items() if name != "run"}
    savemat(folder / "log.mat", numbers)
    return folder / "log.mat"


def as_mat_7_3(folder: Path) -> Path:
    """A vector along either axis, a column of a structure, a matrix of integers, text and a parameter."""
    h5py = pytest.importorskip("h5py")
    path = folder / "log.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["time_s"] = NUMBERS[:, :1].T
        file["current_A"] = NUMBERS[:, 1:2]
        file["out/signal"] = NUMBERS[:, 2:].T
        file["two"] = np.arange(2 * ROWS).reshape(2, ROWS)
        file["wide"] = np.arange(2 * ROWS, dtype=float).reshape(ROWS, 2)
        file["gear"] = np.array([[0.2]])
    head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
    with path.open("r+b") as file:
        file.write(head)
    return path


FORMATS = {
    "csv": as_csv,
    "csv.gz": as_csv_gz,
    "parquet": as_parquet,
    "mat": as_mat,
    "mat 7.3": as_mat_7_3,
    "in memory": lambda _: columns(),
}


@pytest.fixture(autouse=True)
def small_batches(monkeypatch: pytest.MonkeyPatch) -> None:
    """Batches of 128 rows, so that a thousand rows are several."""
    monkeypatch.setattr(limits, "BATCH_ROWS", 128)


@pytest.fixture(params=FORMATS)
def source(request: pytest.FixtureRequest, tmp_path: Path) -> Any:
    """A log in each format."""
    return FORMATS[request.param](tmp_path)


def test_the_batches_together_are_the_log(source: Any) -> None:
    """Names, values, order and the place of every row are those of the log that is read whole."""
    whole, stream = read_log(source), stream_log(source)
    batches = list(stream.batches())

    assert tuple(whole.columns) == stream.names
    assert len(batches) > 1
    for name, values in whole.columns.items():
        np.testing.assert_array_equal(values, np.concatenate([b.columns[name] for b in batches]), name)
    places = [batch.place(row) for batch in batches for row in range(batch.rows)]
    assert [whole.place(row) for row in range(whole.rows)] == places


def test_spans_of_rows_are_those_of_the_log(source: Any) -> None:
    """Rows of some spans, of two columns, are these rows of the log, and know their places."""
    whole, stream = read_log(source), stream_log(source)
    chosen = np.concatenate([np.arange(*span) for span in SPANS])
    read = stream.read(["current_A", "time_s"], SPANS)

    assert {"current_A", "time_s"} == set(read.columns)
    for name, values in read.columns.items():
        np.testing.assert_array_equal(whole.columns[name][chosen], values, name)
    assert [whole.place(int(row)) for row in chosen] == [read.place(row) for row in range(read.rows)]


def test_rows_are_counted_before_they_are_read(source: Any) -> None:
    """The number of rows is exact, but for a text file, where empty lines count."""
    rows = stream_log(source).rows

    assert ROWS <= rows <= ROWS + 1


def test_a_column_that_is_missing_is_named(source: Any) -> None:
    """As when the log is read whole."""
    with pytest.raises(InputError, match=r"expected column 'torque', but the log has .*current_A"):
        list(stream_log(source).batches(["torque"]))


def test_columns_that_are_not_asked_for_are_not_read(tmp_path: Path) -> None:
    """A Parquet file whose unused column is damaged gives the others."""
    path = as_parquet(tmp_path)
    parquet = pytest.importorskip("pyarrow.parquet")
    with parquet.ParquetFile(path) as file:
        chunk = file.metadata.row_group(1).column(2)
    data = bytearray(path.read_bytes())
    data[chunk.data_page_offset : chunk.data_page_offset + 200] = bytes(200)
    path.write_bytes(bytes(data))

    np.testing.assert_array_equal(NUMBERS[:, 1], stream_log(path).read(["current_A"]).columns["current_A"])
    with pytest.raises(
        InputError, match=r"log\.parquet: expected a valid Parquet file, got one that is damaged"
    ):
        stream_log(path).read()


def cut_off(path: Path) -> None:
    """Keep the first half of a file."""
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


@pytest.mark.parametrize("kind", ["csv.gz", "parquet", "mat 7.3"])
def test_a_file_that_is_cut_off_is_one_error(kind: str, tmp_path: Path) -> None:
    """InputError that names the file, when it is opened or while it is read."""
    path = FORMATS[kind](tmp_path)
    cut_off(path)

    with pytest.raises(InputError, match=rf"{path.name}: (the compressed file is|expected a valid)"):
        stream_log(path).read()


def damaged(change: Callable[[list[str]], None], folder: Path) -> LogStream:
    """The CSV log with some lines changed."""
    path = as_csv(folder)
    lines = path.read_text().split("\n")
    change(lines)
    path.write_text("\n".join(lines))
    return stream_log(path)


def test_a_row_with_too_few_values_is_missing(tmp_path: Path) -> None:
    """One of thousands, as a logger that is switched off leaves it: its line is one without numbers."""

    def change(lines: list[str]) -> None:
        lines[700] = "1.0,2.0"

    read = damaged(change, tmp_path).read(["time_s"])

    assert ["line 701"] == [read.place(int(k)) for k in np.flatnonzero(np.isnan(read.numbers("time_s")))]


def test_many_rows_with_too_few_values_are_refused(tmp_path: Path) -> None:
    """The first of them is named, by the line that an editor shows."""

    def change(lines: list[str]) -> None:
        lines[700:1700] = ["1.0,2.0"] * 1000

    with pytest.raises(InputError, match=r"log\.csv: line 701: expected 4 values, got 2"):
        damaged(change, tmp_path).read(["time_s"])


def test_a_text_among_numbers_is_named(tmp_path: Path) -> None:
    """As the one row without a number of its batch, which says in which line."""

    def change(lines: list[str]) -> None:
        lines[700] = "1.0,off,2.0,second"

    stream = damaged(change, tmp_path)

    assert ROWS == stream.read(["time_s"]).rows
    batch = stream.read(["current_A"])
    (row,) = np.flatnonzero(np.isnan(batch.numbers("current_A"))).tolist()
    assert batch.place(row) == "line 701"
    assert batch.spoilt("current_A", row) == ", 'off'"


def test_decimal_commas_deep_in_a_file_are_numbers(tmp_path: Path) -> None:
    """Whole numbers in the first 1200 rows, decimal commas from then on: in batches as whole."""
    rows = [f"{k};{'0' if k < 1200 else '0,5'}" for k in range(2000)]
    (tmp_path / "log.csv").write_text("\n".join(["t;x", *rows, ""]))
    stream = stream_log(tmp_path / "log.csv")

    for found in (read_log(tmp_path / "log.csv"), stream.read(), stream.read(["x"], [(0, 2000)])):
        np.testing.assert_array_equal(found.numbers("x"), np.where(np.arange(2000) < 1200, 0.0, 0.5))


@pytest.mark.parametrize("suffix", [".csv", ".csv.gz"])
def test_a_byte_that_is_not_utf_8_deep_in_a_file_makes_it_latin_1(suffix: str, tmp_path: Path) -> None:
    """As it does where the file is read whole, with the same note."""
    rows = [b"%d,%s" % (k, b"ok" if k < 19_000 else b"\xfcber") for k in range(20_000)]
    content = b"\n".join([b"t,note", *rows, b""])
    path = tmp_path / f"log{suffix}"
    path.write_bytes(gzip.compress(content) if suffix.endswith(".gz") else content)
    found = stream_log(path).read()

    assert ("über", 20_000) == (found.text("note")[-1], found.rows)
    assert any("Latin-1" in note for note in found.notes)


def test_the_manual_says_of_every_format_whether_it_is_read_in_parts() -> None:
    """The table of docs/long-logs.md has a row for every suffix, and what is read in parts agrees."""
    page = Path(__file__).resolve().parents[1] / "docs" / "long-logs.md"
    rows = re.findall(r"^\| (`\..*?) \| (.*?) \|", page.read_text(encoding="utf-8"), re.MULTILINE)
    said = {how != "no": set() for _, how in rows}
    for formats, how in rows:
        said[how != "no"] |= set(re.findall(r"`(\.[a-z0-9.]+)`", formats))

    in_parts = {suffix for one in KNOWN if one.parts for suffix in one.endings}
    assert {suffix for one in KNOWN for suffix in one.endings} == said[True] | said[False]
    assert in_parts == said[True]
