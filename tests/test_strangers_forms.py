"""Forms in which tools and people print logs: what is read from each, and what a draft says of its units."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

from eccentric.api.drafted import RigDraft, draft_rig
from eccentric.core import InputError
from eccentric.drafting.words import read_name
from eccentric.logs import Log, parse_unit, read_log, stream_log

TURN = 2.0 * np.pi
T = np.arange(3000) * 0.005
Q = 6.0 * np.sin(1.9 * T + 0.3) + np.sin(7.1 * T + 1.0) + 0.2 * np.sin(17.0 * T)
DQ = 11.4 * np.cos(1.9 * T + 0.3) + 7.1 * np.cos(7.1 * T + 1.0) + 3.4 * np.cos(17.0 * T)
DDQ = -21.66 * np.sin(1.9 * T + 0.3) - 50.41 * np.sin(7.1 * T + 1.0) - 57.8 * np.sin(17.0 * T)
CURRENT = 0.02 * DDQ + 0.04 * DQ + 0.5 * np.sign(DQ) + 0.01 * np.sin(1000.0 * T)
X, V = T[:40], np.round(np.sin(3.0 * T[:40]), 4)


@pytest.fixture
def read(tmp_path: Path) -> Callable[..., Log]:
    """Return a function that reads the content of a text file."""

    def run(content: str | bytes, suffix: str = ".csv") -> Log:
        path = tmp_path / f"log{suffix}"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_log(path)

    return run


@pytest.fixture
def draft(tmp_path: Path) -> Callable[..., RigDraft]:
    """Return a function that drafts the rig of columns."""

    def run(**columns: np.ndarray) -> RigDraft:
        path = tmp_path / "log.csv"
        rows = zip(*columns.values(), strict=True)
        lines = [",".join(columns), *(",".join(f"{value:.8g}" for value in row) for row in rows)]
        path.write_text("\n".join(lines) + "\n")
        return draft_rig(path)

    return run


def proposed(drafted: RigDraft) -> dict[str, tuple[str, str, str]]:
    """Channel -> column, unit and doubt."""
    return {p.channel: (p.column, p.unit, p.doubt) for p in drafted.proposals}


def lines(pattern: str, *columns: Any) -> str:
    """A line for each row."""
    return "".join(pattern % row + "\n" for row in zip(*columns, strict=True))


CLOCK = [f"12:00:{k // 10:02d}.{k % 10}00" for k in range(40)]
TABLES = {
    "labels": (lines("t:%.3f x:%.4f", X, V), {"t": "", "x": ""}),
    "labels with blanks": (lines("t: %.3f x: %.4f", X, V), {"t": "", "x": ""}),
    "labels with equal signs": (lines("t=%.3f,x=%.4f", X, V), {"t": "", "x": ""}),
    "labels with units": (lines("t: %.3f s, x: %.4f rad", X, V), {"t": "s", "x": "rad"}),
    "labels in a message": (lines('[INFO] {"t": %.3f, "x": %.4f}', X, V), {"t": "", "x": ""}),
    "labels below other lines": ("boot\nready\n" + lines("t:%.3f\tx:%.4f", X, V), {"t": "", "x": ""}),
    "labels after the time of day": (
        lines("%s -> t:%.3f x:%.4f", CLOCK, X, V),
        {"time": "s", "t": "", "x": ""},
    ),
    "labels after a stamp in brackets": (
        lines("[INFO] [%d.5] [node]: t: %.3f, x: %.4f", range(40), X, V),
        {"column 1": "", "t": "", "x": ""},
    ),
    "labels after a tag and a stamp": (
        lines("I (%d) motor: t=%.3f x=%.4f", range(40), X, V),
        {"column 1": "", "t": "", "x": ""},
    ),
    "labels after a stamp with a unit": (
        lines("[%d ms] t: %.3f x: %.4f", range(40), X, V),
        {"column 1": "ms", "t": "", "x": ""},
    ),
    "labels after the time with a label": (
        lines("Time: %s t: %.3f x: %.4f", CLOCK, X, V),
        {"time": "s", "t": "", "x": ""},
    ),
    "labels after the level of a message": (
        lines("INFO:root:t: %.3f x: %.4f", X, V),
        {"t": "", "x": ""},
    ),
    "labels with units between blanks": (
        lines("T: %.1f °C t: %.3f s x: %.4f rad", V, X, V),
        {"T": "°C", "t": "s", "x": "rad"},
    ),
    "labels after units of several words": (
        lines("tau: %.4f N m J: %.4f kg*m^2 t: %.3f s x: %.4f", V, V, X, V),
        {"tau": "N m", "J": "kg*m^2", "t": "s", "x": ""},
    ),
    "labels of several words": (
        lines("max v: %.1f m/s - motor t: %.3f min x: %.4f", V, X, V),
        {"max v": "m/s", "motor t": "", "min x": ""},
    ),
    "exponents of Fortran": (
        "t,x\n" + lines("%.8e,%.8e", X, V).replace("e", "D"),
        {"t": "", "x": ""},
    ),
    "a minus sign": ("t,x\n" + lines("%.3f,%.4f", X, V).replace("-", "\u2212"), {"t": "", "x": ""}),
    "numbers with their unit": ("t,x\n" + lines("%.3fs,%.4f A", X, V), {"t": "s", "x": "A"}),
    "labels before names and units": (
        "format,csv\ntrace_names,t,x\ntrace_units,s,rad\ntrace_values\n" + lines("%.3f,%.4f", X, V),
        {"t": "s", "x": "rad"},
    ),
    "units of LabVIEW": (
        "LabVIEW Measurement\t\nWriter_Version\t2\n***End_of_Header***\t\n\t\nChannels\t1\t\n"
        "Y_Unit_Label\trad\t\nDelta_X\t0.005\t\n***End_of_Header***\t\t\nX_Value\tx\tComment\n"
        + lines("%.3f\t%.4f", X, V),
        {"X_Value": "", "x": "rad"},
    ),
    "an empty time of LabVIEW": (
        "LabVIEW Measurement\t\nX_Columns\tNo\n***End_of_Header***\t\n\t\nChannels\t1\t\n"
        "Y_Unit_Label\trad\t\nX0\t0.0\t\nDelta_X\t0.005\t\n***End_of_Header***\t\t\nX_Value\tx\tComment\n"
        + lines("\t%.4f", V),
        {"X_Value": "s", "x": "rad"},
    ),
    "a time of LabVIEW with its start and step": (
        "LabVIEW Measurement\t\n***End_of_Header***\t\nX0\t0.0\t\nDelta_X\t0.005\t\n***End_of_Header***\t\t\n"
        "X_Value\tx\tComment\n" + lines("%.3f\t%.4f", X, V),
        {"X_Value": "", "x": ""},
    ),
    "start and step of LabVIEW with decimal commas": (
        "LabVIEW Measurement\t\n***End_of_Header***\t\nX0\t0,0\t\nDelta_X\t0,005\t\n***End_of_Header***\t\t\n"
        "X_Value\tx\tComment\n" + lines("\t%.4f", V),
        {"X_Value": "s", "x": ""},
    ),
    "start and increment without a count": (
        "CH1,Start,Increment\nVolt,0.0,5e-3\n" + lines("%.4f", V),
        {"time": "s", "CH1": "V"},
    ),
    "Start and Increment as columns": (
        "Start,Increment,t,x\n" + lines("%d,%d,%.3f,%.4f", range(40), range(40), X, V),
        {"Start": "", "Increment": "", "t": "", "x": ""},
    ),
    "rows of a scope of which one of two is left out": (
        "X,CH1,Start,Increment,\nSequence,Volt,0.0,2.5e-3\n" + lines("%d,%.4f,", range(0, 80, 2), V),
        {"X": "s", "CH1": "V"},
    ),
    "start and increment of a scope": (
        "X,CH1,Start,Increment,\nSequence,Volt,0.0,5e-3\n" + lines("%d,%.4f,", range(40), V),
        {"X": "s", "CH1": "V"},
    ),
    "channels of a scope by their numbers": (
        "x-axis,1\nsecond,Volt\n" + lines("%.3f,%.4f", X, V),
        {"x-axis": "s", "channel 1": "V"},
    ),
    "settings of a scope beside the first rows": (
        lines("%s,%.3f,%.4f", ["Record Length,40", "Units,V", *[","] * 38], X, V),
        {"column_1": "", "column_2": "", "column_3": "", "column_4": ""},
    ),
    "lists of Python": (lines("[%.3f, %.4f]", X, V), {"column_1": "", "column_2": ""}),
    "tuples below a header": ("t, x\n" + lines("(%.3f, %.4f),", X, V), {"t": "", "x": ""}),
    "rows with a checksum": (
        lines("$MOT,%d,%.3f,%.4f*4A", range(40), X, V),
        {"column_1": "", "column_2": "", "column_3": "", "column_4": ""},
    ),
    "rows with a name and without a header": (
        lines("%d,base_link,%.3f,%.4f", range(40), X, V),
        {"column_1": "", "column_2": "", "column_3": "", "column_4": ""},
    ),
    "a table with borders": (
        "+---+---+\n| t | x |\n+---+---+\n" + lines("| %.3f | %.4f |", X, V) + "+---+---+\n",
        {"t": "", "x": ""},
    ),
    "a table with a border on one side": (
        "| t | x\n|---|---\n" + lines("| %.3f | %.4f", X, V),
        {"t": "", "x": ""},
    ),
    "comments of MATLAB": ("% bench 3\n% t x\n" + lines("%.3f %.4f", X, V), {"t": "", "x": ""}),
}  # fmt: skip


@pytest.mark.parametrize("name", TABLES)
def test_a_form_of_text_is_read(name: str, read: Callable[..., Log]) -> None:
    """Names, values and the units that the file states."""
    content, units = TABLES[name]
    log = read(content)
    x, t = (log.numbers(one) for one in list(log.columns)[:-3:-1])

    assert list(units) == list(log.columns)
    assert {n: u for n, u in units.items() if u} == dict(log.units)
    np.testing.assert_allclose(t, X, atol=1e-9)
    np.testing.assert_allclose(x, V, atol=1e-9)


@pytest.mark.parametrize(
    "line",
    ["t=0,010; pos=1,5; cur=0,2; end=1", "t:1,000 x:0 y:0", "t=1.5.3 x=2 y=3", "x: 1 2 3 y: 4",
     "state:IDLE t:1 x:2", "state: IDLE t:1 x:2", "t:1 state:IDLE x:2", "t:1 x:2 state:IDLE",
     '{"state": "IDLE", "x": 1, "y": 3}', "pos: [1] vel: 3 x: 4", "phase: 0 A current: 1 B current: 2",
     "q: 0 deg A current: 1 B current: 2",
     "1,kp=1.5 ki=0.2,9", "(1) [2] x: 3 y: 4"],
)  # fmt: skip
def test_labels_do_not_hide_other_values(line: str, read: Callable[..., Log]) -> None:
    """Decimal commas, text after a label, lists and cells of a table are not read in part."""
    with pytest.raises(InputError, match="header row with column names"):
        read(f"{line}\n" * 40)


def test_other_words_before_labels_are_in_a_note(read: Callable[..., Log]) -> None:
    """A state that changes is no column, and is not dropped unsaid."""
    log = read("IDLE, t:0, x:2\n" * 20 + "RUN, t:0, x:2\n" * 20)

    assert ("not read: IDLE, RUN",) == log.notes


@pytest.mark.parametrize(
    ("header", "row"),
    [
        ("t,note,cur", "%d,kp=1.5 ki=0.2,9"),
        ("t,pose,cur", "%d,\"{'x': 1.5, 'y': 2.5}\",9"),
        ("t,pose", "%d,\"{'x': 1.5, 'y': 2.5}\""),
        ("t,note,cur", '%d,"pos: 3 limit: 5",9'),
        ("t,a,b", "%d,A:1,B:2"),
    ],
)
def test_labels_within_the_cells_of_a_table_are_text(header: str, row: str, read: Callable[..., Log]) -> None:
    """The columns are those of the header."""
    log = read(f"{header}\n" + lines(row, range(500)))

    assert header.split(",") == list(log.columns)
    np.testing.assert_array_equal(log.numbers("t"), np.arange(500))


@pytest.mark.parametrize("number", ["\u22121.5", "-1.5D+00", "-1\u2009500.5"])
@pytest.mark.parametrize("at", [0, 500, 2500])
def test_numbers_in_print_are_read_in_parts(number: str, at: int, tmp_path: Path) -> None:
    """As in the whole, wherever the first of them is."""
    path = tmp_path / "log.csv"
    path.write_text("t,x\n" + "".join(f"{k},{number if k == at else k / 8}\n" for k in range(3000)))
    whole, parts = read_log(path).numbers("x"), stream_log(path).read(["x"]).numbers("x")

    assert whole[at] in (-1.5, -1500.5)
    np.testing.assert_array_equal(whole, parts)


def test_blanks_between_thousands(read: Callable[..., Log]) -> None:
    """As Excel writes them in French."""
    log = read("t;x\n" + "".join(f"{k};1\u202f{k:03d},5\n" for k in range(40)))

    np.testing.assert_array_equal(log.numbers("x"), 1000.5 + np.arange(40))


@pytest.mark.parametrize("text", [f"[{v}, {2 * v}]" for v in (0.5,)] + ["(0.5, 1.0,)", "array([0.5 1.0])"])
def test_lists_in_cells_are_columns(text: str, read: Callable[..., Log]) -> None:
    """One column for each number of the list."""
    log = read("t;q\n" + "".join(f"{k};{text}\n" for k in range(20)))

    assert ["t", "q(:,1)", "q(:,2)"] == list(log.columns)
    assert {0.5} == set(log.numbers("q(:,1)"))


def test_a_text_among_the_counts_of_a_scope(read: Callable[..., Log]) -> None:
    """Its row has no time; all others keep theirs."""
    rows = lines("%s,%.4f,", [*range(39), "end"], V)
    log = read("X,CH1,Start,Increment,\nSequence,Volt,0.0,5e-3\n" + rows)

    np.testing.assert_allclose(log.numbers("X"), [*X[:39], np.nan], atol=1e-9)


def test_numbers_in_hexadecimal(read: Callable[..., Log]) -> None:
    """Registers as a controller prints them, with a note."""
    log = read("t,x\n" + lines("%.3f,0x%04X", X, range(40)))

    assert (("x: hexadecimal, unsigned",), [*range(40)]) == (log.notes, log.numbers("x").tolist())


def test_dictionaries_of_python_in_a_text_file(read: Callable[..., Log]) -> None:
    """They begin as JSON does, with other quotation marks."""
    log = read(lines("{'t': %.3f, 'x': %.4f}", X, V), ".txt")

    np.testing.assert_allclose([log.numbers("t"), log.numbers("x")], [X, V], atol=1e-9)


@pytest.mark.parametrize(
    ("start", "kind"),
    [("header:\n  stamp:\n    sec: 1\n---\nheader:\n  stamp:\n    sec: 2\n---\n", "YAML"),
     ("FMT, 128, 89, FMT, BBnNZ, Type,Length\nFMT, 64, 30, M, Qf, TimeUS,Pos\nM, 1, 0.5\n", "ArduPilot"),
     ("H Product:Blackbox flight data recorder\nH I interval:32\n", "Betaflight")],
)  # fmt: skip
def test_other_kinds_of_text_are_named(start: str, kind: str, read: Callable[..., Log]) -> None:
    """The message says what the file is and how to get a table."""
    with pytest.raises(InputError, match=f"a table of text, got .*{kind}"):
        read(start)


@pytest.mark.parametrize("text", ["(0.5)", "(1,234)", "(1,5)", "(1,234.5)"])
def test_a_number_in_parentheses_is_no_list(text: str, read: Callable[..., Log]) -> None:
    """It may be negative, as in accounts."""
    assert {text} == set(read("t;q\n" + f"1;{text}\n" * 20).columns["q"].tolist())


def test_a_list_of_one_number_is_a_column(read: Callable[..., Log]) -> None:
    """Brackets are no sign."""
    assert {0.5} == set(read("t;q\n" + "1;[0.5]\n" * 20).numbers("q(:,1)"))


def test_nested_objects_in_lines_are_columns(read: Callable[..., Log]) -> None:
    """Objects within, and lists of one length."""
    rows = [{"t": k, "motor": {"pos": 2 * k}, "q": [0, 3 * k]} for k in range(40)]
    log = read("".join(json.dumps(row) + "\n" for row in rows), ".jsonl")

    np.testing.assert_array_equal(log.numbers("pos"), 2 * np.arange(40))
    np.testing.assert_array_equal(log.numbers("q(:,2)"), 3 * np.arange(40))


def test_records_with_a_label_keep_their_columns(read: Callable[..., Log]) -> None:
    """They are no signals: each has fewer values than there are records."""
    rows = [{"t": k, "label": f"r{k}", "values": [1, 2, 3 * k]} for k in range(40)]
    log = read("".join(json.dumps(row) + "\n" for row in rows), ".jsonl")

    np.testing.assert_array_equal(log.numbers("t"), np.arange(40))
    np.testing.assert_array_equal(log.numbers("values(:,3)"), 3 * np.arange(40))


def test_signals_of_ragged_lists_are_left_out(read: Callable[..., Log]) -> None:
    """With a note, as other lists that are no columns."""
    ragged = [{"label": name, "values": [[1], [1, 2]]} for name in "ab"]
    log = read(json.dumps({"t": list(range(40)), "s": ragged}), ".json")

    assert "t" in log.columns
    assert any("neither numbers nor text" in note for note in log.notes)


@pytest.mark.parametrize(
    "signals",
    [
        {
            "Y": [
                {"Name": '"Model Root"/"pos"', "Data": Q, "Unit": "rad"},
                {"Name": "i", "Data": CURRENT, "Unit": "A"},
            ]
        },
        {"scope": {"signals": [{"label": "pos [rad]", "values": Q}, {"label": "i [A]", "values": CURRENT}]}},
    ],
    ids=["dSPACE", "Simulink"],
)  # fmt: skip
def test_signals_that_hold_their_name(signals: dict[str, Any], tmp_path: Path) -> None:
    """The names are those of the columns, and no model is in them."""
    savemat(tmp_path / "log.mat", {"time": T, **signals})
    log = read_log(tmp_path / "log.mat")
    position, current = list(log.columns)[1:]

    assert ("angle", "rad", "") == ((n := read_name(position)).quantity, n.unit, n.role)
    assert ("current", "A") == ((n := read_name(current)).quantity, n.unit)


@pytest.mark.parametrize(
    ("text", "encoding"),
    [("時間,角度", "cp932"), ("Время,Угол", "cp1251"), ("时间,角度", "gb2312"), ("Zeit,für [°]", "cp1252"),
     ("時間(秒),角度(°)", "cp932"), ("時間 s,電流A,温度[℃]", "cp932"), ("t,für,Ä,²", "cp1252"),
     ("Время [с],Угол [рад],Ток [А]", "cp1251"), ("Время_с,Скорость (об/мин),Угол °", "cp1251")],
)  # fmt: skip
def test_the_encoding_is_that_of_whole_words(text: str, encoding: str, read: Callable[..., Log]) -> None:
    """Of files that are no UTF-8."""
    names = text.split(",")
    rows = lines(",".join(["%d"] * len(names)), *[range(3)] * len(names))

    assert names == list(read(f"{text}\n{rows}".encode(encoding)).columns)


@pytest.mark.parametrize(
    ("header", "encoding"),
    [("Время, с;Угол, рад;Ток, А", "cp1251"), ("t, s;q, rad;i, A", "ascii"), ("t, s\tq, rad\ti, A", "ascii")],
)
def test_units_after_commas_between_semicolons(header: str, encoding: str, read: Callable[..., Log]) -> None:
    """Commas in the header, and decimal ones in the rows, part no columns; nor between tabs."""
    apart = "\t" if "\t" in header else ";"
    log = read((f"{header}\n" + apart.join(["0,5", "1,5", "2,5\n"]) * 20).encode(encoding))

    assert header.split(apart) == list(log.columns)
    assert [0.5, 1.5, 2.5] == [log.numbers(name)[0] for name in log.columns]


def test_tabs_after_commas(read: Callable[..., Log]) -> None:
    """Whole numbers between commas that a tab follows are no decimal commas."""
    assert ["t", "x"] == list(read("t,\tx\n" + lines("%d,\t%d", range(20), range(20))).columns)


@pytest.mark.parametrize("row", ["1,2;3", "0.1,1;2;3"])
def test_semicolons_in_cells_between_commas(row: str, read: Callable[..., Log]) -> None:
    """The header decides."""
    assert {row.split(",")[1]} == set(read("t,list\n" + f"{row}\n" * 20).columns["list"].tolist())


@pytest.mark.parametrize(
    "line",
    ["(1.5) can0 141#A100", " can0  141   [2]  A1 00", ";$FILEVERSION=1.1",
     "date Sat Nov 28 10:00:00.000 am 2026", "date Sat Nov 28 10:00:00.000 am 2026\r"],
)  # fmt: skip
def test_frames_of_a_bus_are_no_table(line: str, read: Callable[..., Log]) -> None:
    """What to do is in the message."""
    with pytest.raises(InputError, match="decode them"):
        read(f"{line}\n" * 30, ".log")


def test_a_resolution_is_a_unit() -> None:
    """As drives state it: 0.1 rpm for each step."""
    assert parse_unit("0.1rpm", "").factor == pytest.approx(TURN / 600.0)
    assert parse_unit("0.01 A", "").factor == pytest.approx(0.01)
    assert parse_unit("0.1 K", "").to_si(2981.5) == pytest.approx(25.0)
    assert parse_unit("0.1 °C", "").to_si(250.0) == pytest.approx(25.0)
    with pytest.raises(InputError):
        parse_unit("10 A", "")


@pytest.mark.parametrize(
    ("name", "quantity", "unit", "role"),
    [
        ("velocity_turns_s", "speed", "rev/s", ""), ("vel_mrads", "speed", "mrad/s", ""),
        ("Velocity [cnt/sec]", "speed", "counts/s", ""), ("phase_current", "current", "", ""),
        ("phase_current_a", "current", "", "other"), ("psu_current_A", "supply", "A", ""),
        ("Axis_1.StatusDrive.ActualTorque", "torque", "", "measured"), ("simout(:,1)", "", "", ""),
        ("Prędkość", "speed", "", ""), ("hız", "speed", "", ""), ("전류", "current", "", ""),
        ("omega_e", "speed", "", "electrical"), ("counts", "angle", "counts", ""),
        ("Torque actual value [per thousand]", "torque", "‰", "measured"),
    ],
)  # fmt: skip
def test_names_of_tools_and_languages(name: str, quantity: str, unit: str, role: str) -> None:
    """Quantity, unit and where a column comes from."""
    found = read_name(name)

    assert (quantity, unit, role) == (found.quantity, found.unit, found.role)


def test_turns_by_the_names_of_their_controller(draft: Callable[..., RigDraft]) -> None:
    """ODrive and moteus log turns; that only their names say so is a doubt."""
    odrive = proposed(draft(t=T, pos_estimate=Q / TURN, vel_estimate=DQ / TURN, Iq_measured=CURRENT))
    moteus = proposed(draft(t=T, position=Q / TURN, velocity=DQ / TURN, q_current=CURRENT))

    for found in (odrive, moteus):
        assert ("rev", "rev/s") == (found["theta_m"][1], found["omega_m"][1])
        assert all("s unit)" in found[channel][2] for channel in ("theta_m", "omega_m"))


def test_turns_without_a_unit_are_a_doubt(draft: Callable[..., RigDraft]) -> None:
    """An angle and its slope are in turns as well as in radians, as far as a log shows."""
    found = proposed(draft(t=T, position=Q, velocity=DQ, torque=CURRENT))

    assert "rev (" in found["theta_m"][2]
    assert "rev/s (" in found["omega_m"][2]
    assert "counts" not in found["omega_m"][2]


def test_the_current_of_a_supply_is_no_drive(draft: Callable[..., RigDraft]) -> None:
    """It is left out beside that of the motor, asked about alone, and doubted where its name says nothing."""
    bus = draft(t=T, pos_deg=57.3 * Q, bus_current=0.2 * CURRENT * DQ, phase_current=CURRENT)
    alone = draft(t=T, pos_deg=57.3 * Q, bus_current=0.2 * CURRENT * DQ)
    unnamed = draft(t=T, pos_deg=57.3 * Q, Voltage=24.0 + 0.01 * DQ, Current=CURRENT)
    motor = draft(t=T, pos_deg=57.3 * Q, Voltage=24.0 + 0.01 * DQ, Iq=CURRENT)

    assert "phase_current" == proposed(bus)["current"][0]
    assert "current" not in proposed(alone)
    assert "bus_current: the current of the supply" in alone.text
    assert "supply current" in proposed(unnamed)["current"][2]
    assert "supply current" not in proposed(motor)["current"][2]


def test_counts_by_an_electrical_speed_are_electrical(draft: Callable[..., RigDraft]) -> None:
    """A tachometer of steps of commutation has no counts per turn of the shaft."""
    found = proposed(
        draft(t=T, tachometer=np.round(Q / TURN * 700), erpm=DQ * 7 * 60 / TURN, motor_current=CURRENT)
    )

    assert all("pole pairs" in found[channel][2] for channel in ("theta_m", "omega_m"))


def test_tenths_of_counts_per_second(draft: Callable[..., RigDraft]) -> None:
    """The unit of the speed, as its name says it, agrees with counts of the angle."""
    counts = {
        "Position (counts)": np.round(8000 / TURN * Q),
        "Velocity (0.1 counts/s)": np.round(8e4 / TURN * DQ),
    }
    drafted = draft(t_s=T, **counts, **{"Current (A)": CURRENT})

    units = {column: unit for column, unit, _ in proposed(drafted).values()}
    assert (units["Position (counts)"], units["Velocity (0.1 counts/s)"]) == ("counts", "0.1 counts/s")


@pytest.mark.parametrize("parts", [1000, 1_000_000, 1_000_000_000])
def test_seconds_and_their_parts_without_names(parts: int, tmp_path: Path) -> None:
    """Rows without a header, as of `ros2 topic echo --csv`: two columns are the time."""
    stamp = np.round(T * parts).astype(np.int64)
    table = zip(1_700_000_000 + stamp // parts, stamp % parts, Q, DQ, CURRENT, strict=True)
    path = tmp_path / "log.csv"
    path.write_text("".join(f"{s},{n},base,{q:.6f},{dq:.6f},{i:.6f}\n" for s, n, q, dq, i in table))

    columns = {p.channel: p.source for p in draft_rig(path).proposals}
    assert columns["time"] == f"column_1 + column_2 / {parts}"
    assert (columns["theta_m"], columns["omega_m"], columns["current"]) == (
        "column_4",
        "column_5",
        "column_6",
    )


@pytest.mark.parametrize(
    ("first", "second"),
    [("block", "counter"), ("run", "t_ms"), ("turns", "counts")],
)
def test_named_columns_are_no_seconds_with_their_parts(first: str, second: str) -> None:
    """A counter that starts again, the time within a run, and counts within a turn fill theirs as well."""
    rows = np.arange(3000)
    log = {"time_s": T, first: rows // 1000, second: rows % 1000, "q_rad": Q, "i_A": CURRENT}
    drafted = draft_rig({name: np.asarray(column, float) for name, column in log.items()})

    assert not any("/" in p.source for p in drafted.proposals)


def test_a_counter_that_overflows_may_be_no_turn(draft: Callable[..., RigDraft]) -> None:
    """At 65536 counts; at 4096 an angle restarts after a turn."""
    wide = draft(t=T, encoder=np.round(Q / TURN * 50000) % 65536 - 32768, current=CURRENT)
    turn = draft(t=T, encoder=np.round(Q / TURN * 4096) % 4096, current=CURRENT)

    assert "16-bit overflow" in proposed(wide)["theta_m"][2]
    assert "overflow" not in proposed(turn)["theta_m"][2]


def test_a_clipped_drive_is_a_doubt(draft: Callable[..., RigDraft]) -> None:
    """Many rows at the ends of its range."""
    clipped = draft(t=T, theta=Q, current=np.clip(CURRENT, -1.0, 1.0))

    assert "clipped in" in proposed(clipped)["current"][2]
    assert "clipped in" not in proposed(draft(t=T, theta=Q, current=CURRENT))["current"][2]


def test_a_column_of_masses_names_the_runs(draft: Callable[..., RigDraft]) -> None:
    """What each carries beyond the least is asked under [added]."""
    found = draft(t=T, theta=Q, current=CURRENT, mass_kg=np.repeat([0.5, 1.0, 1.5], 1000))

    assert "mass_kg" == proposed(found)["run"][0]
    assert ['#? "1" = "0.5 kg"', '#? "1.5" = "1 kg"'] == found.text.split("[added]\n")[1].splitlines()[1::2]
