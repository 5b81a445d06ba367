"""Files as strangers publish them: lines above the header, blanks, several clocks, lists, no table."""

from __future__ import annotations

import io
import json
import struct
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

import eccentric
from eccentric import cli
from eccentric.core import InputError
from eccentric.logs import FORMATS, Log, format_of, read_log
from tests.recordings import bag1_bytes, wpilog_bytes

T = np.arange(40) * 0.002
X = np.round(np.sin(3.0 * T), 6)
V = np.round(3.0 * np.cos(3.0 * T), 6)


@pytest.fixture
def read(tmp_path: Path) -> Callable[..., Log]:
    """Return a function that reads a text, by default as .csv."""

    def run(content: str, suffix: str = ".csv") -> Log:
        path = tmp_path / f"log{suffix}"
        path.write_text(content, encoding="utf-8")
        return read_log(path)

    return run


def rows(delimiter: str, *columns: np.ndarray, comma: bool = False) -> str:
    """The rows of a table as text."""
    lines = (delimiter.join(f"{value:.10g}" for value in row) for row in zip(*columns, strict=True))
    text = "".join(f"{line}\n" for line in lines)
    return text.replace(".", ",") if comma else text


def same(log: Log, **columns: np.ndarray) -> None:
    """Compare the columns of a log, and that there are no others."""
    assert list(columns) == list(log.columns)
    for name, values in columns.items():
        np.testing.assert_allclose(log.numbers(name), values, rtol=1e-9, atol=1e-12)


TABLES = {
    "lines of settings": ("Scope,3\nStart,12:00\nt,x,v\n", ",", False),
    "a date above": ("Axis1\n2024-05-01 12:00:00\n\nt,x,v\n", ",", False),
    "settings of the width of the table": ("Axis,1,2\nSamples,40,3\nt,x,v\n", ",", False),
    "comments above": ("# made by a drive\n# version, 3\nt,x,v\n", ",", False),
    "the header in a comment, among blanks": ("# t x v\n", " ", False),
    "blanks": ("t x v\n", " ", False),
    "many blanks": ("  t    x   v\n", "    ", False),
    "tabs and decimal commas": ("t\tx\tv\n", "\t", True),
    "settings, tabs and decimal commas": ("Name\tscope\nt\tx\tv\n", "\t", True),
    "blanks and decimal commas": ("t x v\n", " ", True),
    "a blank after every comma": ("t, x, v\n", ", ", False),
}


@pytest.mark.parametrize("name", TABLES)
def test_a_table_below_whatever_its_logger_writes(name: str, read: Callable[..., Log]) -> None:
    """The header is the last line of text that names every column, and all rows are read."""
    above, delimiter, comma = TABLES[name]

    same(read(above + rows(delimiter, T, X, V, comma=comma)), t=T, x=X, v=V)


@pytest.mark.parametrize("suffix", [".txt", ".dat", ".tsv", ".log", ".asc", ".scope", ""])
def test_a_table_under_any_suffix_of_text(suffix: str, read: Callable[..., Log]) -> None:
    """What the file is called does not matter where its content is a table."""
    same(read("t\tx\tv\n" + rows("\t", T, X, V), suffix), t=T, x=X, v=V)


def test_units_and_meanings_below_the_header(read: Callable[..., Log]) -> None:
    """A row of units is taken whole; of a row of meanings, in which names repeat, what is a unit."""
    units = read("Scope,3\nt,x,v\ns,mm,mm/s\n" + rows(",", T, X, V))
    meanings = read("Axis1\nSamples,40\nt,x,v\nms,Not selected,Not selected\n" + rows(",", T, X, V))

    assert {"t": "s", "x": "mm", "v": "mm/s"} == units.units
    assert "ms" == meanings.units["t"]
    assert ("line 4", "line 5") == (units.place(0), meanings.place(0))
    assert ((), ("the header is line 2", "delimiter: comma; decimal point")) == (units.notes, units.read_as)


def test_missing_values_in_the_first_rows_stay(read: Callable[..., Log]) -> None:
    """Rows with "nan", "NA" and empty cells below lines of settings are rows."""
    x = np.where(T < T[6], np.nan, X)
    text = "Scope,3\nt,x,v\n" + rows(",", T, x, V).replace("nan", "NA", 2)
    log = read(text.replace("nan", "", 2))

    assert "line 3" == log.place(0)
    same(log, t=T, x=x, v=V)


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-be"])
def test_a_table_in_utf_16(encoding: str, tmp_path: Path) -> None:
    """As tools of Windows write it, with a mark of the order of bytes."""
    text = "\ufeff" * encoding.endswith("be") + "t\tx\tv\n" + rows("\t", T, X, V)
    (tmp_path / "log.csv").write_bytes(text.encode(encoding))

    same(read_log(tmp_path / "log.csv"), t=T, x=X, v=V)


def test_rows_with_a_delimiter_at_their_ends(read: Callable[..., Log]) -> None:
    """Some loggers end every row with a comma, and not the header."""
    same(read("t,x,v\n" + rows(",", T, X, V).replace("\n", ",\n")), t=T, x=X, v=V)


def test_pairs_of_one_clock_are_columns(read: Callable[..., Log]) -> None:
    """A label before each channel, and the same time in each pair: one time, no interpolation."""
    head = "Timestamp,2020-03-16,Timestamp,2020-03-16\nInterval,0.002,Interval,0.002\n"
    log = read(f'{head}Channel name,"F",Channel name,"p"\nUnit,"N",Unit,"mm"\n' + rows(",", T, X, T, V))

    same(log, time=T, F=X, p=V)
    assert {"F": "N", "p": "mm"} == log.units


def test_groups_of_a_scope_with_clocks_of_their_own(read: Callable[..., Log]) -> None:
    """Groups at two rates and of two lengths: the slower, a line in time, is interpolated and said to be."""
    slow = T[::4]
    fast = [f"{1e3 * t:g}\t{x:.6f}" for t, x in zip(T, X, strict=True)]
    other = [f"\t{1e3 * t:g}\t{2.0 * t + 1.0:.6f}" for t in slow]
    body = [a + b for a, b in zip(fast, [*other, *[""] * (len(fast) - len(other))], strict=True)]
    head = (
        "Name\tmy scope\nName\tx\tName\tu\nSampleTime[ms]\t2\tSampleTime[ms]\t8\nUnit\t(mm)\tUnit\t(None)\n"
    )
    log = read(head + "\n" + "\n".join(body).replace(".", ",") + "\n", ".txt")
    t = T[T <= slow[-1]]

    same(log, time=t, x=X[: len(t)], u=2.0 * t + 1.0)
    assert {"time": "s", "x": "mm"} == log.units
    assert "2 groups of columns, each with a time of its own" in log.notes


def test_a_trace_of_blocks(read: Callable[..., Log]) -> None:
    """CODESYS writes keys, then a block of time and value for each variable, in a file called .csv."""
    head = "[key]; [value]\nVersion; 0x03050000\nName; A.Trace\n"
    blocks = [
        f"{k}.Variable; A.{name}\n{k}.Class; 14\n{k}.Data; \n" + rows("; ", 1e3 * T, x).replace("\n", "\n; ")
        for k, (name, x) in enumerate({"x": X, "v": V}.items())
    ]
    text = head + "".join(b.replace("Data; \n", "Data; \n; ").removesuffix("; ") for b in blocks)

    same(read(text), **{"time": 1e3 * T, "A.x": X, "A.v": V})


CLOCKS = {
    "milliseconds": ("14:05:00.000", "14:05:00.250", "14:05:01.500", [0.0, 0.25, 1.5]),
    "past midnight": ("23:59:59.5", "00:00:00", "00:00:01,25", [0.0, 0.5, 1.75]),
    "halves of the day": ("11:59:59 AM", "12:00:00 PM", "1:00:00 PM", [0.0, 1.0, 3601.0]),
    "a date that is not ISO": (
        "31.12.2024 23:59:59",
        "01.01.2025 00:00:00",
        "01.01.2025 00:00:02",
        [0, 1, 3],
    ),
    "minutes": ("08:00", "08:01", "08:03", [0.0, 60.0, 180.0]),
}


@pytest.mark.parametrize("name", CLOCKS)
def test_times_of_day_are_seconds_from_the_first(name: str, read: Callable[..., Log]) -> None:
    """With fractions, past midnight, with AM and PM, and below a date of any order."""
    *cells, seconds = CLOCKS[name]
    log = read("Time;x\n" + "".join(f"{cell};1\n" for cell in cells))

    np.testing.assert_allclose(log.numbers("Time"), seconds, atol=1e-9)
    assert "s" == log.units["Time"]


def test_a_few_broken_rows_are_missing(read: Callable[..., Log]) -> None:
    """A row of 200 that the logger did not finish has no numbers, and its line; one of three is refused."""
    lines = ["t,x"] + [f"{k},{2 * k}" for k in range(200)]
    lines[120] = "119,"[:3]
    log = read("\n".join([*lines, "200"]) + "\n")

    assert ["line 121", "line 202"] == [log.place(int(k)) for k in np.flatnonzero(np.isnan(log.numbers("t")))]
    with pytest.raises(InputError, match="line 3: expected 2 values, got 1"):
        read("t,x\n1,2\n3\n4\n")


REFUSED = {
    "words before every value, other ones in each line": (
        "".join(f"Time: {k} Position: {5 * k}\nTime: {k} Speed: {k}\nt: 1 I: 3\n" for k in range(30)),
        "expected a header row with column names, and values between commas below it, got 'Time: 0",
    ),
    "names that repeat": ("a,b,b\n1,2,3\n4,5,6\n", "expected unique column names, got 'b' 2x"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_table_says_what_to_write(name: str, read: Callable[..., Log]) -> None:
    """The line, what it has, and what is wanted."""
    content, said = REFUSED[name]

    with pytest.raises(InputError, match=said):
        read(content)


def test_nested_json_is_no_table(read: Callable[..., Log]) -> None:
    """Runs with lists of their own lengths are named; one list for each column stays a log."""
    runs = [{"kind": "step", "set": [0.0] * n, "angle": [1.0] * n} for n in (50, 70)]

    with pytest.raises(
        InputError, match=r"2 objects in 'data', .*\(set, angle\) of a length .* 50 to 70: write"
    ):
        read(json.dumps({"data": runs}), ".json")
    assert 50 == read(json.dumps({"set": [0.0] * 50, "angle": [1.0] * 50}), ".json").rows


def test_lists_in_parquet_are_columns(tmp_path: Path) -> None:
    """Lists of one length in every row, of fixed size or not, are columns; others are left out."""
    arrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    both = np.column_stack([X, V]).tolist()
    table = arrow.table(
        {
            "t": T,
            "state": arrow.array([None, *both[1:]], arrow.list_(arrow.float32())),
            "fixed": arrow.array(both, arrow.list_(arrow.float64(), 2)),
            "uneven": [[0.0] * (1 + k % 2) for k in range(len(T))],
        }
    )
    parquet.write_table(table, tmp_path / "log.parquet")
    log = read_log(tmp_path / "log.parquet")

    assert ["t", "state(:,1)", "state(:,2)", "fixed(:,1)", "fixed(:,2)"] == list(log.columns)
    np.testing.assert_allclose(log.numbers("state(:,2)")[1:], V[1:], rtol=1e-6)
    assert np.isnan(log.numbers("state(:,2)")[0])
    np.testing.assert_array_equal(V, log.numbers("fixed(:,2)"))
    assert ["uneven"] == [note.split(": ")[1].split(" ")[0] for note in log.notes]


def test_a_single_array_is_a_log(tmp_path: Path) -> None:
    """The columns of a matrix, or the fields of a structured array."""
    np.save(tmp_path / "plain.npy", np.column_stack([T, X]))
    fields = np.empty(len(T), dtype=[("t", "f8"), ("x", "f8")])
    fields["t"], fields["x"] = T, X
    np.save(tmp_path / "fields.npy", fields)

    same(read_log(tmp_path / "plain.npy"), **{"array(:,1)": T, "array(:,2)": X})
    same(read_log(tmp_path / "fields.npy"), t=T, x=X)


def test_a_workbook(tmp_path: Path) -> None:
    """Its longest sheet, below lines of settings, with a row of units and stamps as dates."""
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.append(["made by", "a spreadsheet"])
    sheet = book.create_sheet("data")
    for row in (["Scope", 3], ["t", "x", "when"], ["s", "mm", None]):
        sheet.append(row)
    for k, (t, x) in enumerate(zip(T, X, strict=True)):
        sheet.append([t, x, datetime(2024, 5, 1, 12, 0, k)])  # noqa: DTZ001 - a workbook has no zones
    book.save(tmp_path / "log.xlsx")
    log = read_log(tmp_path / "log.xlsx")

    same(log, t=T, x=X, when=np.arange(40.0))
    assert {"t": "s", "x": "mm", "when": "s"} == log.units
    assert ("the header is line 2",) == log.read_as


def test_a_data_log_of_wpilib(tmp_path: Path) -> None:
    """Numbers, lists and truth values by entry; what breaks off in its last record is read up to it."""
    times = [1_000_000 + 2000 * k for k in range(40)]
    content = wpilog_bytes(
        ("/drive/x", "double", [(t, struct.pack("<d", x)) for t, x in zip(times, X, strict=True)]),
        (
            "NT:/drive/both",
            "double[]",
            [(t, struct.pack("<2d", x, v)) for t, x, v in zip(times, X, V, strict=True)],
        ),
        ("on", "boolean", [(t, b"\1") for t in times]),
        ("pose", "struct:Pose2d", [(t, b"\0" * 24) for t in times]),
    )
    (tmp_path / "log.wpilog").write_bytes(content + b"\x7c\1")
    log = read_log(tmp_path / "log.wpilog")

    same(log, **{"time_s": T, "drive/x": X, "drive/both(1)": X, "drive/both(2)": V, "on": np.ones(40)})
    assert any("pose (struct:Pose2d)" in note for note in log.notes)
    assert any("breaks off" in note for note in log.notes)


def test_a_bag_of_ros_1(tmp_path: Path) -> None:
    """Joint states by the names of the joints, on the clock of their headers."""
    pytest.importorskip("rosbags")
    (tmp_path / "log.bag").write_bytes(bag1_bytes(X, V))
    log = read_log(tmp_path / "log.bag")

    same(log, **{"time_s": T, "joints.position.elbow": X, "joints.velocity.elbow": V})


def test_content_decides_under_a_suffix_of_text(tmp_path: Path) -> None:
    """An archive and a workbook are zip files, a data log is none: each is what it begins with."""
    archive = io.BytesIO()
    np.savez(archive, t=T, x=X)
    (tmp_path / "a.dat").write_bytes(archive.getvalue())
    (tmp_path / "b.log").write_bytes(wpilog_bytes(("x", "double", [])))
    (tmp_path / "c.txt").write_text('{"t": [1, 2]}')
    (tmp_path / "d.unknown").write_bytes(b"\x93NUMPY")

    named = [format_of(tmp_path / name).suffixes[0] for name in ("a.dat", "b.log", "c.txt", "d.unknown")]
    assert [".npz", ".wpilog", ".json", ".npy"] == named
    same(read_log(tmp_path / "a.dat"), t=T, x=X)


def test_every_format_is_found_by_its_suffix(tmp_path: Path) -> None:
    """No two formats share one, and the registry has each once."""
    suffixes = [suffix for one in FORMATS for suffix in one.endings]

    assert len(set(suffixes)) == len(suffixes)
    for one in FORMATS:
        for suffix in one.endings:
            (tmp_path / f"x{suffix}").write_bytes(b"t,x\n")
            assert format_of(tmp_path / f"x{suffix}") is one


def test_the_doctor_says_what_a_file_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Format, delimiter, rows, clock, units, text, what is missing; and the reason where it is no log."""
    path = tmp_path / "log.txt"
    path.write_text(
        "Scope,3\nTime,x,v,mode\nms,mm,,\n"
        + "".join(f"{2 * k},{k % 7},{'' if k == 5 else 1},{'ab'[k % 2]}\n" for k in range(50))
    )
    (tmp_path / "no.txt").write_text("dear diary\n")
    found = eccentric.describe_log(path)

    assert ("Time", "ms", 500.0) == found.clock
    assert {"Time": ("ms", 0.0, 98.0, 0), "x": ("mm", 0.0, 6.0, 0), "v": ("", 1.0, 1.0, 1)} == found.numbers
    assert {"mode": 2} == found.texts
    assert 1 == cli.main(["doctor", str(path), str(tmp_path / "no.txt")])
    shown = capsys.readouterr().out
    for said in ("50 rows, 4 columns", "clock: Time [ms], 500 rows/s", "v: 1 throughout, 1 missing"):
        assert said in shown
    assert "mode: text, 2 different" in shown
    assert "the header is line 2\n  delimiter: comma\n" in shown
    assert "no.txt: not readable: delimited text" in shown
    assert "\nexpected a log with rows" in shown


def test_a_table_in_memory_is_described_as_a_file_is(tmp_path: Path) -> None:
    """A table of arrays, a Log and the file have the same columns and clock; only the format differs."""
    table = {"t_s": 0.01 * np.arange(50), "x": np.arange(50.0) % 7}
    path = tmp_path / "log.csv"
    np.savetxt(path, np.column_stack(list(table.values())), delimiter=",", header="t_s,x", comments="")
    in_file, read, here = (eccentric.describe_log(x) for x in (path, eccentric.read_log(path), table))

    assert ("t_s", "s", pytest.approx(100.0)) == here.clock == read.clock == in_file.clock
    assert in_file.table() == read.table() == here.table()
    assert ("in memory", "in memory") == (read.format, here.format)
    assert here.summary().startswith("table: in memory\n  50 rows, 2 columns")
    with pytest.raises(InputError, match="expected a path or a table"):
        eccentric.describe_log(3)  # type: ignore[arg-type]


def test_another_date_is_the_next_day(read: Callable[..., Log]) -> None:
    """Times that go on a day later are a day later; an hour above 23 is no time of day."""
    lines = ["01.02.2024 10:00:00", "01.02.2024 10:00:01", "02.02.2024 10:00:02", "02.02.2024 10:00:03"]
    found = read("t,x,v\n" + "".join(f"{t},{k},{k}\n" for k, t in enumerate(lines)))
    odd = read("t,x,v\n" + "".join(f"{t},1,2\n" for t in ("23:00", "24:30", "30:00")))

    assert [0.0, 1.0, 86402.0, 86403.0] == found.numbers("t").tolist()
    assert "24:30" in odd.text("t").tolist()
