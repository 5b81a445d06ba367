"""CSV as it comes: decimal commas, dates, nanoseconds, a row of units, Latin-1, rows of several topics."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from eccentric.cli import main
from eccentric.core import InputError
from eccentric.logs import Log, read_log, stream_log
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from tests.logged import RIG, STANDARD, channels_of, rig_file
from tests.virtual import log_of


@pytest.fixture
def read(tmp_path: Path) -> Callable[[str | bytes], Log]:
    """Return a function that reads a text or bytes as a CSV log."""

    def run(content: str | bytes) -> Log:
        path = tmp_path / "log.csv"
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return read_log(path)

    return run


def test_decimal_commas_between_semicolons(read: Callable[[str], Log]) -> None:
    """As a spreadsheet of half of Europe writes it."""
    log = read("t;i\n0,0;-1,5e-1\n0,1;\n0,2;,5\n")

    np.testing.assert_array_equal([0.0, 0.1, 0.2], log.numbers("t"))
    np.testing.assert_array_equal([-0.15, np.nan, 0.5], log.numbers("i"))


def test_a_row_of_units(read: Callable[[str], Log]) -> None:
    """The row below the header states units and is no data; lines are those of the file."""
    log = read("t,speed,mode\n[s],[rpm],\n0,1,a\n1,2,a\n")

    assert {"t": "s", "speed": "rpm"} == log.units
    assert (2, "line 3") == (log.rows, log.place(0))
    assert [1.0, 2.0] == log.numbers("speed").tolist()


def test_a_row_of_text_is_not_taken_for_units(read: Callable[[str], Log]) -> None:
    """A column of text, and a first row with one value that is none, stay data."""
    assert ["a", "b"] == read("run,mode\na,x\nb,y\n").text("run").tolist()
    assert 3 == read("t,i\n0,x\n1,2\n2,3\n").rows


@pytest.mark.parametrize(
    ("cells", "seconds"),
    [
        (("2024-05-01T12:00:00Z", "2024-05-01T12:00:00.250Z", "2024-05-01T14:00:01+02:00"), [0.0, 0.25, 1.0]),
        (("2024-05-01 23:59:59.5", "2024-05-02 00:00:00", "2024-05-02 00:00:00.75"), [0.0, 0.5, 1.25]),
    ],
)
def test_dates_are_seconds_from_the_first(
    cells: tuple[str, ...], seconds: list[float], read: Callable[[str], Log]
) -> None:
    """ISO 8601, with a zone or without; the column has the unit s and a note says from when."""
    log = read("stamp,i\n" + "".join(f"{cell},1\n" for cell in cells))

    assert seconds == log.numbers("stamp").tolist()
    assert "s" == log.units["stamp"]
    assert any("2024-05-01" in note for note in log.notes)


def test_nanoseconds_since_1970_keep_their_digits(read: Callable[[str], Log]) -> None:
    """As floating point two stamps 100 ns apart would be one."""
    log = read("ns,i\n1700000000000000000,1\n1700000000000000100,2\n1700000000004000000,3\n")

    assert [0.0, 100.0, 4e6] == log.numbers("ns").tolist()
    assert any("1700000000000000000" in note for note in log.notes)


def test_latin_1_is_read_with_a_note(read: Callable[[bytes], Log]) -> None:
    """A degree sign of an old Windows does not stop a log."""
    log = read("Zeit;Winkel [°]\n0;1\n1;2\n".encode("latin-1"))

    assert [1.0, 2.0] == log.numbers("Winkel [°]").tolist()
    assert any("Latin-1" in note for note in log.notes)


T = np.arange(200) / 100.0


def test_rows_that_fill_columns_of_their_own_topic(read: Callable[[str], Log]) -> None:
    """Angle and current in rows of their own, 5 ms apart: on the clock of the angle, the current linearly."""
    rows = [(t, f"{np.sin(t):.9f}", "") for t in T] + [
        (t + 0.005, "", f"{2 * (t + 0.005):.9f}") for t in T[:-1]
    ]
    log = read("t,angle,current\n" + "".join(f"{t:.3f},{a},{i}\n" for t, a, i in sorted(rows)))
    inside = T[1:-1]  # before the first current nothing is known of it

    assert log.numbers("t") + 0.01 == pytest.approx(inside)
    assert log.numbers("angle") == pytest.approx(np.sin(inside), abs=1e-8)
    assert log.numbers("current") == pytest.approx(2.0 * inside, abs=1e-8)
    assert any("current linearly" in note for note in log.notes)


def test_rows_that_name_their_channel(read: Callable[[str], Log]) -> None:
    """Time, name and value in each row; a mode of whole numbers keeps its last value."""
    rows = [(t, "angle", np.sin(t)) for t in T] + [(t + 0.004, "mode", float(t > 1.0)) for t in T[::10]]
    log = read("t;signal;value\n" + "".join(f"{t:.4f};{n};{v:.9f}\n" for t, n, v in sorted(rows)))
    t = log.numbers("t") + 0.01

    assert log.numbers("angle") == pytest.approx(np.sin(t), abs=1e-8)
    assert log.numbers("mode").tolist() == [float(one > 1.104 - 1e-9) for one in t]


def test_two_channels_in_turn_need_few_rows(read: Callable[[str], Log]) -> None:
    """A name that differs from that of the row before counts, not one that differs from the first."""
    rows = [f"{k / 100.0};{'ab'[k % 2]};{k}\n" for k in range(16)]
    log = read("t;signal;value\n" + "".join(rows))

    assert {"t", "a", "b"} == set(log.columns)


def test_a_log_that_lost_values_is_not_several_topics(read: Callable[[str], Log]) -> None:
    """Columns that are filled together in some rows belong to one table, gaps and all."""
    lines = (f"{t},{'' if k % 3 == 0 else 1},{'' if k % 3 == 1 else 2}\n" for k, t in enumerate(T))
    log = read("t,a,b\n" + "".join(lines))

    assert len(T) == log.rows
    assert np.count_nonzero(np.isnan(log.numbers("a"))) == 67


def test_runs_of_two_logs_keep_names_that_differ(tmp_path: Path) -> None:
    """`holdout_runs` of the rig file matches them; runs of one name are told apart by their log."""
    path, rig_path = log_of(tmp_path, 3, seconds=15.0)
    log = read_log(path)
    rig = {**__import__("json").loads(rig_path.read_text())}
    rig.pop("holdout_intervals_s")
    rig["columns"] = [*rig["columns"], "run"]
    half = log.rows // 2

    def part(name: str, rows: slice, file: str) -> Log:
        columns = {c: x[rows] for c, x in log.columns.items()}
        count = len(columns["time_s"])
        return Log(file, {**columns, "run": np.full(count, name)}, count)

    logs = [part("a", slice(0, half), "one/data.csv"), part("b", slice(half, None), "two/data.csv")]
    channels = read_channels(logs, read_rig({**rig, "holdout_runs": ["b"]}))
    assert ("a", "b") == channels.time.run_names
    assert set(channels.time.run[channels.selection.held_out].tolist()) == {1}

    alike = [logs[0], part("a", slice(half, None), "two/data.csv")]
    channels = read_channels(alike, read_rig({**rig, "holdout_runs": ["two/data/*"]}))
    assert ("one/data/a", "two/data/a") == channels.time.run_names


NUMBERED = "no header: columns are numbered from 1; name them in the file or map column_1 ... in [columns]"
COLUMNS = {"column_1": [0.5, 0.75, 1.0], "column_2": [-1.0, 2.0, 3.5], "column_3": [7.0, 7.0, 8.0]}
HEADLESS = {
    "commas": "0.5,-1,7\n0.75,2,7\n1.0,3.5,8\n",
    "blanks": "0.5  -1 7\n 0.75 2 7\n1.0 3.5 8\n",
    "decimal commas": "0,5;-1;7\n0,75;2;7\n1,0;3,5;8\n",
    "below settings": "Device: X\nRate: 100 Hz\n0.5\t-1\t7\n0.75\t2\t7\n1.0\t3.5\t8\n",
    "below a comment": "# by hand\n0.5,-1,7\n0.75,2,7\n1.0,3.5,8\n",
    "with a delimiter at the end": "0.5,-1,7,\n0.75,2,7,\n1.0,3.5,8,\n",
}


DELIMITERS = {"blanks": "blanks", "decimal commas": "semicolon", "below settings": "tab"}


@pytest.mark.parametrize("name", HEADLESS)
def test_a_table_without_a_header_has_numbered_columns(name: str, read: Callable[[str], Log]) -> None:
    """All of its rows are values; notes give the names, the delimiter and the decimal sign; so in batches."""
    log = read(HEADLESS[name])

    assert COLUMNS == {column: log.numbers(column).tolist() for column in log.columns}
    sign = "comma" if name == "decimal commas" else "point"
    assert (NUMBERED, f"delimiter: {DELIMITERS.get(name, 'comma')}; decimal {sign}") == log.read_as
    assert list(COLUMNS) == list(stream_log(log.path).read().columns)


def test_a_row_that_begins_late_in_a_table_without_a_header_is_missing(read: Callable[[str], Log]) -> None:
    """A logger that starts in the middle of a line loses one row."""
    log = read("75\n" + "".join(f"{k}.5,{k}.25\n" for k in range(200)))

    assert (201, "line 1") == (log.rows, log.place(0))
    assert [0] == np.flatnonzero(np.isnan(log.numbers("column_1"))).tolist()


EITHER = {
    "numbers that count": (
        "0,1,2\n0.5,1,7\n0.75,2,7\n1,3,8\n",
        "'0,1,2' in line 1, which may be names or values",
    ),
    "an index without a name": (
        ",1,2\n1,1,7\n2,2,7\n3,3,8\n",
        "',1,2' in line 1, which may be names or values",
    ),
    "speeds above decimals": ("10,20\n0.5,1.5\n0.6,1.75\n0.7,2.5\n", "'10,20' in line 1, which may be names"),
    "two rows": (
        "0.5 1.5\n0.75 2.5\n",
        "'0.5 1.5' in line 1, which may be names or values: write a line of 2",
    ),
    "a decimal comma": (
        "1,25\n1,50\n1,75\n",
        "'1,25' in line 1, which may be one number with a decimal comma: write",
    ),
    "a name in the first row": ("run,0.5,1.5\nstop,0.75,2.5\nrun,1.5,3.5\n", "'run,0.5,1.5' in line 1"),
}


@pytest.mark.parametrize("name", EITHER)
def test_a_first_row_that_may_be_names_is_not_taken_for_values(name: str, read: Callable[[str], Log]) -> None:
    """Such a file is refused, with the line and what to write above it."""
    content, got = EITHER[name]

    with pytest.raises(InputError, match=f"expected a header row with column names.* got {re.escape(got)}"):
        read(content)


def test_numbered_columns_are_described_and_mapped(
    read: Callable[[str], Log], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """`doctor FILE` shows them; a rig that maps them gives the channels of the log with a header."""
    lines = [",".join(map(str, row)) for row in zip(*STANDARD.values(), strict=True)]
    numbered = read("\n".join(lines))
    names = {"time": "time_s", "theta_m": "theta_m_rad", "current": "current_A"}
    mapped = {c: f"column_{list(STANDARD).index(name) + 1}" for c, name in names.items()}
    table = "\n[columns]\n" + "".join(f'{c} = "{name}"\n' for c, name in mapped.items())

    assert 0 == main(["doctor", numbered.path])
    shown = capsys.readouterr().out
    assert NUMBERED in shown
    assert "  column_3: " in shown
    channels = read_channels([numbered], rig_file(tmp_path, RIG + table))
    expected = channels_of(tmp_path, {name: STANDARD[name] for name in names.values()})
    np.testing.assert_array_equal(channels.motion.alpha_m, expected.motion.alpha_m)
    np.testing.assert_array_equal(channels.motor.measured, expected.motor.measured)


@pytest.mark.parametrize(
    ("content", "values"),
    [
        ('t,i\n"0,5","1,25"\n"1,0","2"\n', {"t": [0.5, 1.0], "i": [1.25, 2.0]}),
        ('t,n\n998,1\n999.5,"2,345.5"\n"1,000",0\n', {"t": [998.0, 999.5, 1000.0], "n": [1.0, 2345.5, 0.0]}),
        ("t;n;i\n98;-9,5;0,5\n99;-1.234,5;1,0\n", {"t": [98, 99], "n": [-9.5, -1234.5], "i": [0.5, 1]}),
        ("t;n\n0;0\n1;47,488\n", {"t": [0.0, 1.0], "n": [0.0, 47.488]}),
        ('t,n\n"0,003",0\n"0,004","1,203"\n', {"t": [0.003, 0.004], "n": [0.0, 1.203]}),
        ("t;n\n0.125;1.234.567\n0.250;2.000\n", {"t": [0.125, 0.25], "n": [1234567.0, 2000.0]}),
        ("t;i\n0,125;1,500\n0,250;2,125\n", {"t": [0.125, 0.25], "i": [1.5, 2.125]}),
        ("t;i\n0.125;1.500\n0.250;2.125\n", {"t": [0.125, 0.25], "i": [1.5, 2.125]}),
        ("t,i\n0.5 sec,12 mA\n1 sec,13.5 mA\n", {"t": [0.5, 1.0], "i": [12.0, 13.5]}),
    ],
)  # fmt: skip
def test_numbers_as_spreadsheets_write_them(
    content: str, values: dict[str, list[float]], read: Callable[[str], Log]
) -> None:
    """Decimal commas in quotation marks, separators of thousands, and a unit in every cell."""
    log = read(content)

    assert {name: log.numbers(name).tolist() for name in log.columns} == values
    assert log.units == ({"t": "s", "i": "mA"} if "sec" in content else {})


@pytest.mark.parametrize(
    ("content", "column", "shown"),
    [
        ('t,i\n0,"1,234"\n1,"2,345"\n', "i", "'1.234 or 1234'"),
        ('t,i\n0,0\n1,"2,345"\n', "i", "'2.345 or 2345'"),
        ("t;i\n1.001;0,01\n1.002;0,02\n", "t", "'1.001 or 1001'"),
        ("t;i\n98;0,01\n1.002;0,02\n", "t", "'1.002 or 1002'"),
        ("t;i\n999;1\n1,000;2\n", "t", "'1.000 or 1000'"),
        ("t\ti\n0.25\t1,234\n0.5\t2,345\n", "i", "'1.234 or 1234'"),
    ],
)
def test_thousands_or_decimals_are_not_guessed(
    content: str, column: str, shown: str, read: Callable[[str], Log]
) -> None:
    """Every sign has three digits behind it, and no other number shows which one it is."""
    log = read(content)

    with pytest.raises(InputError, match=shown):
        log.numbers(column)
    assert any(shown.strip("'") in note for note in log.notes)


@pytest.mark.parametrize(
    "comment",
    [
        "# Motor test with an arm",
        "# date 2020-01-02, gain 3, x, y",
        "# rate: 100 Hz, a, b",
        "# recorded by the robot",
    ],
)
def test_the_words_of_a_comment_are_no_names(comment: str, read: Callable[[str], Log]) -> None:
    """As many words as columns, above rows without a header."""
    rows = "".join(f"{0.1 * k:.1f} {k % 7}.5 {k}.25 {k % 3}.5 1.5\n" for k in range(9))
    width = 5 if comment.count(" ") > 4 else 4
    rows = "".join(" ".join(line.split()[:width]) + "\n" for line in rows.splitlines())

    assert list(read(f"{comment}\n{rows}").columns) == [f"column_{k + 1}" for k in range(width)]


@pytest.mark.parametrize(
    ("key", "first"), [("joint", "hip"), ("motor id", "motor 1"), ("node_id", "node 1"), ("id", "joint 1")]
)
@pytest.mark.parametrize(("lost", "apart"), [(0, 0.0), (1, 0.0), (0, 0.5)])
def test_a_row_for_every_joint_at_every_time(
    key: str, first: str, lost: int, apart: float, read: Callable[[str], Log]
) -> None:
    """Long tables become a column for each joint and value; a mode that alternates stays one.

    Also where the logger was stopped before the last row, or every row has a time of its own.
    """
    names = ["hip", "knee"] if key == "joint" else ["1", "2"]
    rows = [f"{k + apart * j},{names[j]},{10 * k + j},{k}\n" for k in range(20) for j in range(2)]
    log = read(f"t,{key},q,i\n{''.join(rows[: 40 - lost])}")

    # The first of the first joint is before the others', the last of the last without one.
    first_at, whole = int(apart > 0.0), 20 - max(lost, apart > 0.0)
    assert log.numbers(f"{first}/q").tolist() == [10.0 * (k + first_at) for k in range(whole)]
    assert {name.rpartition("/")[2] for name in log.columns} == {"t", "q", "i"}
    assert log.rows == whole
    steps = "".join(f"{k},{k},{k % 3}.25\n" for k in range(40))
    assert list(read(f"t,q,motor speed\n{steps}").columns) == ["t", "q", "motor speed"]

    modes = "".join(f"{k},{'ab'[k % 2]},{k},{k}\n" for k in range(40))
    assert list(read(f"t,mode,q,i\n{modes}").columns) == ["t", "mode", "q", "i"]


@pytest.mark.parametrize(
    ("above", "row"),
    [
        ("# t, angle of link, motor:speed\n", "{:.1f},{}.5,{}.25\n"),
        ("# t, angle of link, motor:speed\n", "{:.1f} {}.5 {}.25\n"),
        ("| t | angle of link | motor:speed |\n|---|:--:|--:|\n", "| {:.1f} | {}.5 | {}.25 |\n"),
    ],
)
def test_names_in_a_comment_or_in_markdown(above: str, row: str, read: Callable[[str], Log]) -> None:
    """As `numpy.savetxt` and tables of notes write them; names may have words of sentences."""
    log = read(above + "".join(row.format(0.1 * k, k, k % 5) for k in range(30)))

    assert list(log.columns) == ["t", "angle of link", "motor:speed"]
    assert log.rows == 30
    assert not log.units


def test_settings_of_two_cells_above_a_wider_table(read: Callable[[str], Log]) -> None:
    """As LabVIEW writes them: the first lines look like a table of their own."""
    above = "Writer\t\nVersion\t2\nReader\t2\nColumns\t3\n***End***\t\n\t\nX_Value\tAngle\tCurrent\tComment\n"
    rows = "".join(f"{0.1 * k:.1f}\t{k}.5\t{k % 4}.25\t\n" for k in range(30))

    assert list(read(above + rows).columns)[:3] == ["X_Value", "Angle", "Current"]


def test_one_row_of_numbers_is_no_header(read: Callable[[str], Log]) -> None:
    """The message shows the line and says what is expected."""
    with pytest.raises(InputError, match=r"expected a header row with column names.*'0\.0 2.5 3' in line 1"):
        read("0.0 2.5 3\n")


@pytest.mark.parametrize(
    "above",
    [
        "Motor test 17,,\n,,\nOperator,AB,\nTime (s),Angle (deg),Current (A)\n",
        "Time (s)   Angle (deg)   Current (A)\n",
        "Time (s)|Angle (deg)|Current (A)\n",
    ],
)
def test_names_with_units_are_the_header(above: str, read: Callable[[str], Log]) -> None:
    """Below a title, with blanks in the names, and between bars."""
    mark = next(mark for mark in (",", "|", "   ") if mark in above)
    rows = "".join(mark.join((f"{0.1 * k:.1f}", f"{k}.5", f"{k % 4}.25")) + "\n" for k in range(30))

    assert list(read(above + rows).columns) == ["Time (s)", "Angle (deg)", "Current (A)"]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 123\n", "git lfs pull"),
        ("<!DOCTYPE html>\n<html><body>404</body></html>\n", "download the raw file"),
        ("t,i,i\n0,1,2\n1,2,3\n", "a name of its own"),
    ],
)
def test_a_refusal_says_what_to_do(content: str, said: str, read: Callable[[str], Log]) -> None:
    """Files that stand in place of a log, and names that are given twice."""
    with pytest.raises(InputError, match=said):
        read(content)


def test_chinese_names_in_their_own_encoding(tmp_path: Path) -> None:
    """Words in GB 2312 are read as such, umlauts in Latin-1 stay what they are."""
    path = tmp_path / "log.csv"
    path.write_bytes("时间(s),角度(deg)\n0,1\n1,2\n".encode("gb2312"))
    assert list(read_log(path).columns) == ["时间(s)", "角度(deg)"]

    path.write_bytes("µµ,²²\n0,1\n1,2\n".encode("latin-1"))
    assert list(read_log(path).columns) == ["µµ", "²²"]

    path.write_bytes("Größe,Öl für Äste °\n0,1\n1,2\n".encode("latin-1"))
    assert list(read_log(path).columns) == ["Größe", "Öl für Äste °"]


@pytest.mark.parametrize(
    ("row", "same"),
    [
        (lambda k: f"{k / 1000:.3f};0,{k % 10}5", True),
        (lambda k: f'{k + 0.5:,};"{k % 7}"', True),
        (lambda k: f"{k / 8}".replace(".", ",") + f";{k:,}".replace(",", "."), False),
        (lambda k: f"{k};{k * 1000:,}".replace(",", "."), False),
        (lambda k: f"{k};" + ("0" if k < 2000 else f"{k * 1000:,}".replace(",", ".")), False),
    ],
    ids=["milliseconds", "point", "other columns", "later groups", "zeros first"],
)
def test_thousands_are_read_alike_in_parts(row: Callable[[int], str], same: bool, tmp_path: Path) -> None:
    """Where the first rows do not show how a column is written, it is refused, and never read otherwise."""
    path = tmp_path / "log.csv"
    path.write_text("t;i\n" + "".join(f"{row(k)}\n" for k in range(3000)))
    whole, parts = read_log(path), stream_log(path)

    for name in whole.columns:
        found = []
        for log in (whole, parts.read([name])):
            with suppress(InputError):
                found.append(log.numbers(name).tolist())
        assert found == found[:1] * len(found)
        assert len(found) == 2 or not same
