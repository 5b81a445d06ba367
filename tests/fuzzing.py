"""Inputs for the fuzz of everything that reads a user's files: random, or valid and then damaged.

`TARGETS` names what is fuzzed: a strategy of inputs, and a function that takes one. It returns "accepted" or
"refused", the latter for an InputError of one line; whatever else is raised is a finding.
"""

from __future__ import annotations

import gzip
import json
import math
import tempfile
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hypothesis import strategies as st

from eccentric.core import InputError
from eccentric.logs import evaluate, parse_value, read_log
from eccentric.rigs import CHANNELS, KEYS, KNOWNS, read_arm, read_rig
from tests.damage import NUMBERS, csv_bytes, files, json_bytes, mat73_bytes, mat_bytes, parquet_bytes, texts
from tests.recordings import (
    bag1_bytes,
    bag_bytes,
    blanks_bytes,
    hdf5_bytes,
    mcap_bytes,
    mdf_bytes,
    npy_bytes,
    npz_bytes,
    robot_bytes,
    scope_bytes,
    tdms_bytes,
    trace_bytes,
    ulog_bytes,
    xlsx_bytes,
)

ODD_TEXTS = (
    *("", "estimate", "run", "C1", "C2", "time_s", "1 kg", "0.1 m", "2 ohm", "1e-4 kg m^2", "1/0 m"),
    *("1e999 kg", "nan", "-1 ohm", "0.2 V s/rev", "counts"),
)
ODD_TEXT = st.one_of(st.text(max_size=12), st.sampled_from(ODD_TEXTS))
ODD_NUMBER = st.one_of(st.integers(-(10**400), 10**400), st.integers(-3, 3), st.floats(), st.floats(0.1, 2.0))
ODD_VALUE = st.recursive(
    st.one_of(st.none(), st.booleans(), ODD_NUMBER, ODD_TEXT),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(ODD_TEXT, inner, max_size=3)),
    max_leaves=6,
)
KNOWN_KEY = st.sampled_from(("case", *(k.name for k in KNOWNS), *(k.key for k in KNOWNS)))
PAIR = st.lists(ODD_VALUE, min_size=2, max_size=2)
SOURCE = st.fixed_dictionaries({"column": ODD_TEXT, "unit": ODD_TEXT})
RIGS = st.one_of(
    ODD_VALUE,
    st.fixed_dictionaries(
        {
            "known": st.dictionaries(KNOWN_KEY, ODD_VALUE, max_size=4).map(
                lambda given: {"case": "C2"} | given
            )
        },
        optional={
            "unknown": st.dictionaries(KNOWN_KEY, st.one_of(ODD_VALUE, PAIR), max_size=2),
            "columns": st.dictionaries(
                st.sampled_from(tuple(CHANNELS)), st.one_of(ODD_VALUE, SOURCE), max_size=3
            ),
            **dict.fromkeys(sorted({*KEYS} - {"known", "unknown", "columns"}), ODD_VALUE),
        },
    ),
)
PIECES = st.sampled_from(
    (
        *"+-*/()<>=!`'\"\\.,:;[]{}@#&|~^%0 \n\t",
        *("**", "//", "==", "<=", "and", "or", "not", "in", "is", "if", "else", "lambda"),
        *("time_s", "current_A"),
        *("1e9", "1e999", "0x", "1_0", "1j", "1is", "9" * 5000, "True", "None", "f''", "b''", "...", ":="),
        *("__class__", "µ", "\0"),
    )
)
ARITHMETIC = st.one_of(
    texts(
        b"time_s / 885 * (current_A - 1.5e-3)", b"current_A == 1 and not time_s > 2 or -current_A <= `time_s`"
    ),
    st.text(max_size=40),
    st.lists(PIECES, max_size=14).map(" ".join),
    st.lists(PIECES, max_size=14).map("".join),
)
UNIT_PIECES = (
    *"*/().·1²³^-+ ",
    *("m", "kg", "s", "rad", "N m", "mNm", "V", "rev", "rpm", "counts", "^2", "^99", "^-1", "Ω", "K", "%"),
)
NUMBER_TEXT = st.sampled_from(("", "1", "-0", "1e308", "1/3", "1/0", ".5", "0.2 ", "٣"))
VALUES = st.one_of(
    texts(b"0.2 mN m/(rad)", b"-1/30 kg m^2/s^2"),
    st.text(max_size=20),
    st.builds(
        lambda number, unit: number + "".join(unit), NUMBER_TEXT, st.lists(st.sampled_from(UNIT_PIECES))
    ),
)


CELLS = st.sampled_from(
    (
        *("", "t", "x", "x", "Name", "Unit", "s", "[ms]", "-", "nan", "1e999", "12:00:00", "23:59:59.9"),
        *("2024-01-01", "0", "1", "1", "2.5", "-3,5", "4e5", "9007199254740993", '"', "#", "µ"),
    )
)
TABLES_AS_TEXT = st.tuples(
    st.sampled_from((",", ";", "\t", " ", ", ")), st.lists(st.lists(CELLS, max_size=4), max_size=30)
).map(lambda drawn: "\n".join(drawn[0].join(row) for row in drawn[1]).encode())


def outcome(action: Callable[[], object]) -> str:
    """Run it; an InputError of one line that says something is a refusal."""
    try:
        action()
    except InputError as error:
        said = str(error)
    else:
        return "accepted"
    assert said.strip(), "an empty message"
    assert "\n" not in said, f"more than one line: {said}"
    return "refused"


def log_of(suffix: str) -> Callable[[bytes], str]:
    """Read bytes as a log of that suffix, and all of its columns as numbers."""

    def run(content: bytes) -> str:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"log{suffix}"
            path.write_bytes(content)
            found: list[Any] = []
            said = outcome(lambda: found.append(read_log(path)))
            for log in found:
                for name in log.columns:
                    assert len(log.text(name)) == log.rows
                    outcome(lambda: log.numbers(name))  # noqa: B023 - run at once
            return said

    return run


def file_of(read: Callable[[Path], object], suffix: str) -> Callable[[bytes], str]:
    """Read bytes as a rig or an arm of that suffix."""

    def run(content: bytes) -> str:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"file{suffix}"
            path.write_bytes(content)
            return outcome(lambda: read(path))

    return run


def column(name: str) -> Any:
    """The columns that arithmetic sees."""
    if name not in NUMBERS:
        raise InputError(f"no column {name!r}")
    return NUMBERS[name]


def toml_of(value: Any) -> str:
    """Write a value as TOML, as well as TOML can say it."""
    match value:
        case dict():
            return "{" + ", ".join(f"{json.dumps(str(k))} = {toml_of(v)}" for k, v in value.items()) + "}"
        case list():
            return "[" + ", ".join(map(toml_of, value)) + "]"
        case None:
            return '""'
        case float() if not math.isfinite(value):
            return "nan" if math.isnan(value) else "inf"
    return json.dumps(value)


def toml_bytes(value: Any) -> bytes:
    """Write a rig as TOML, a value that is no table under a key of its own."""
    content = value if isinstance(value, dict) else {"known": value}
    lines = (f"{json.dumps(str(k))} = {toml_of(v)}\n" for k, v in content.items())
    return "".join(lines).encode(errors="replace")


EXAMPLE = Path(__file__).parents[1] / "examples" / "bench"
ARM_FILE = (EXAMPLE.parent / "arms" / "planar_2r.toml").read_bytes()
URDF = b"""<?xml version="1.0"?>
<robot name="arm">
  <link name="base"/>
  <joint name="turn" type="revolute">
    <parent link="base"/><child link="hand"/><origin xyz="0 0.1 0" rpy="0 0 1.5"/><axis xyz="0 0 1"/>
  </joint>
  <link name="hand"><inertial><origin xyz="0.1 0 0"/><mass value="2"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
</robot>
"""


@dataclass(frozen=True)
class Target:
    """What is fuzzed: inputs, and what takes one and says "accepted" or "refused"."""

    inputs: st.SearchStrategy[Any]
    take: Callable[[Any], str]


TARGETS = {
    ".csv": Target(files(csv_bytes()), log_of(".csv")),
    ".csv.gz": Target(files(gzip.compress(csv_bytes(), mtime=0)), log_of(".csv.gz")),
    ".json": Target(files(json_bytes()), log_of(".json")),
    ".json.gz": Target(files(gzip.compress(json_bytes(), mtime=0)), log_of(".json.gz")),
    ".mat (5)": Target(files(mat_bytes(compressed=False)), log_of(".mat")),
    ".mat (7)": Target(files(mat_bytes(compressed=True)), log_of(".mat")),
    ".mat (7.3)": Target(st.deferred(lambda: files(mat73_bytes())), log_of(".mat")),
    ".parquet": Target(st.deferred(lambda: files(parquet_bytes())), log_of(".parquet")),
    ".npz": Target(st.deferred(lambda: files(npz_bytes())), log_of(".npz")),
    ".h5": Target(st.deferred(lambda: files(hdf5_bytes())), log_of(".h5")),
    ".mf4": Target(st.deferred(lambda: files(mdf_bytes())), log_of(".mf4")),
    ".db3": Target(st.deferred(lambda: files(bag_bytes())), log_of(".db3")),
    ".mcap": Target(st.deferred(lambda: files(mcap_bytes())), log_of(".mcap")),
    ".ulg": Target(st.deferred(lambda: files(ulog_bytes())), log_of(".ulg")),
    ".tdms": Target(st.deferred(lambda: files(tdms_bytes())), log_of(".tdms")),
    "scope .txt": Target(files(scope_bytes()), log_of(".txt")),
    "blanks .dat": Target(files(blanks_bytes()), log_of(".dat")),
    "trace .csv": Target(files(trace_bytes()), log_of(".csv")),
    "texts": Target(st.deferred(lambda: TABLES_AS_TEXT), log_of(".log")),
    ".npy": Target(files(npy_bytes()), log_of(".npy")),
    ".wpilog": Target(files(robot_bytes()), log_of(".wpilog")),
    ".bag": Target(st.deferred(lambda: files(bag1_bytes())), log_of(".bag")),
    ".xlsx": Target(st.deferred(lambda: files(xlsx_bytes())), log_of(".xlsx")),
    "rig .toml": Target(
        st.one_of(files((EXAMPLE / "bench.toml").read_bytes()), RIGS.map(toml_bytes)),
        file_of(read_rig, ".toml"),
    ),
    "arm .toml": Target(files(ARM_FILE), file_of(read_arm, ".toml")),
    "arm .json": Target(
        files(json.dumps(tomllib.loads(ARM_FILE.decode())).encode()), file_of(read_arm, ".json")
    ),
    "arm .urdf": Target(files(URDF), file_of(read_arm, ".urdf")),
    "rig .json": Target(
        st.one_of(
            files((EXAMPLE / "bench.json").read_bytes()), RIGS.map(lambda rig: json.dumps(rig).encode())
        ),
        file_of(read_rig, ".json"),
    ),
    "arithmetic": Target(ARITHMETIC, lambda text: outcome(lambda: evaluate(text, column, "rig"))),
    "value with unit": Target(VALUES, lambda text: outcome(lambda: parse_value(text, "N m", "rig"))),
}
