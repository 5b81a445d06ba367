"""Bad input for every command, as a table of mutations: what `benchmarks/freeze.py` freezes the answers to.

`prepare` writes the broken files, `commands` lists the command lines by group, and CALLS the calls from Python.  A
mutation that is accepted is frozen like any other: its answer is the result.
"""

from __future__ import annotations

import copy
import gzip
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

HERE = "inputs"
FILES = {"LOG": f"{HERE}/log.csv", "RIG": f"{HERE}/rig.json"}
ABSENT = object()
"""Instead of a value: the key is removed."""
ROWS = 1200

BASE: dict[str, Any] = {
    "name": "small",
    "drive": "current",
    "encoder_counts_per_rev": 32768,
    "moving_threshold_rad_s": 0.8,
    "holdout_intervals_s": [[3.0, 4.0]],
    "columns": {
        "time": "time_s",
        "theta_m": "theta_m_rad",
        "omega_m": "omega_m_rad_s",
        "voltage": "voltage_V",
        "current": "current_A",
    },
    "known": {
        "case": "C2",
        "M": "489 g",
        "M_l": "181 g",
        "L": "27.9 cm",
        "mu": "1/5",
        "R": "1 ohm",
        "k_i": "63 mNm/A",
        "k_e": "0.063 V s/rad",
        "J_m": "1000 g cm^2",
        "J_l": "0.04276066 kg m^2",
    },
}
WRONG = {
    "text": "many",
    "unit": "3 parsec",
    "dimension": "3 K",
    "negative": "-1",
    "bare": 3,
    "list": [1, 2],
    "none": None,
}
QUANTITIES = ("M", "M_l", "L", "mu", "R", "k_i", "k_e", "J_m", "J_l", "g")
NUMBERS = (
    "encoder_counts_per_rev",
    "moving_threshold_rad_s",
    "sample_rate_hz",
    "low_pass_hz",
    "input_delay_s",
    "theta_zero_rad",
    "voltage_offset_V",
)
RIG_ROWS: Mapping[str, tuple[str, object]] = {
    **{f"known.{key}={kind}": (f"known.{key}", value) for key in QUANTITIES for kind, value in WRONG.items()},
    **{f"known.{key}=absent": (f"known.{key}", ABSENT) for key in ("M", "L", "mu", "k_i", "case")},
    **{f"{key}={value!r}": (key, value) for key in NUMBERS for value in ("fast", -1, [3], True)},
    **{f"columns.{key}=absent": (f"columns.{key}", ABSENT) for key in BASE["columns"]},
    **{f"columns.{key}=other": (f"columns.{key}", "nothing") for key in BASE["columns"]},
    **{
        f"columns.{key}=unit": (f"columns.{key}", {"column": column, "unit": "kg"})
        for key, column in BASE["columns"].items()
    },
    "columns.current=1/0": ("columns.current", "current_A / 0"),
    "columns.current=code": ("columns.current", "__import__('os')"),
    "columns.current=open": ("columns.current", "(current_A + 1"),
    "columns.current=key": ("columns.current", {"column": "current_A", "units": "A"}),
    "columns.current=number": ("columns.current", 5),
    "columns.curent": ("columns.curent", "current_A"),
    "columns=list": ("columns", ["time_s", "nothing"]),
    "columns=text": ("columns", "time_s"),
    "columns=absent": ("columns", ABSENT),
    "known=absent": ("known", ABSENT),
    "known=text": ("known", "C2"),
    "known.case=C3": ("known.case", "C3"),
    "known.case=2": ("known.case", 2),
    "known.phi": ("known.phi", "30 deg"),
    "known.kt": ("known.kt", "63 mNm/A"),
    "known.M_g": ("known.M_g", 489),
    "known.M_kg": ("known.M_kg", 0.489),
    "known.mu=0": ("known.mu", 0),
    "known.mu=inf": ("known.mu", "inf"),
    "unknown.k_i": ("unknown", {"k_i": ["10 mNm/A", "90 mNm/A"]}),
    "unknown.M=order": ("unknown", {"M_l": ["0.2 kg", "0.1 kg"]}),
    "unknown.x": ("unknown", {"friction": ["0 N", "1 N"]}),
    "unknown.L=one": ("unknown", {"L": ["1 m"]}),
    "drive=pedal": ("drive", "pedal"),
    "drive=torque": ("drive", "torque"),
    "drive=number": ("drive", 1),
    "kind=linear": ("kind", "linear"),
    "kind=flat": ("kind", "flat"),
    "name=number": ("name", 3),
    "average_over=row": ("average_over", "row"),
    "average_over=0": ("average_over", "0 s"),
    "average_over=kg": ("average_over", "1 kg"),
    "runs=none": ("runs", ["nothing*"]),
    "runs=text": ("runs", "all"),
    "holdout_runs=none": ("holdout_runs", ["nothing*"]),
    "holdout=order": ("holdout_intervals_s", [[4.0, 3.0]]),
    "holdout=outside": ("holdout_intervals_s", [[400.0, 500.0]]),
    "holdout=all": ("holdout_intervals_s", [[0.0, 500.0]]),
    "holdout=flat": ("holdout_intervals_s", [3.0, 4.0]),
    "holdout=text": ("holdout_intervals_s", "late"),
    "added=none": ("added", {"nothing": "0.2 kg"}),
    "added=unit": ("added", {"log": "0.2 m"}),
    "added=text": ("added", "0.2 kg"),
    "threshold=all": ("moving_threshold_rad_s", 1e6),
    "misspelled": ("moving_treshold_rad_s", 0.8),
    "unknown_key": ("colour", "red"),
    "arm=none": ("arm", "nothing.toml"),
    "joints": ("joints", {"first": 1}),
    "drives": ("drives", {"k_i": "0.1 Nm/A"}),
}
RIG_TEXTS = {
    "empty.json": "",
    "open.json": '{"known": {',
    "list.json": "[1, 2]",
    "twice.json": '{"name": "a", "name": "b"}',
    "open.toml": "[known\nM = 3",
    "twice.toml": 'name = "a"\nname = "b"',
    "latin.toml": "name = \xff",
    "empty.toml": "",
    "rig.yaml": "name: small",
}


def _cells(table: list[list[str]], column: int, value: str, first: int = 1, step: int = 1) -> list[list[str]]:
    """The table with a value in some cells of a column."""
    changed = copy.deepcopy(table)
    for row in changed[first::step]:
        row[column] = value
    return changed


def _broken_logs(rows: list[str]) -> dict[str, bytes]:
    """File name -> content; `rows` are the lines of a good log, the first one its header."""
    table = [row.split(",") for row in rows]
    tables = {
        "header_only": table[:1],
        "one_row": table[:2],
        "ten_rows": table[:11],
        "no_time": [row[1:] for row in table],
        "no_current": [row[:-1] for row in table],
        "text_cell": _cells(table, 4, "high", 50, 10_000),
        "text_column": _cells(table, 4, "high"),
        "few_nan": _cells(table, 4, "nan", 1, 10),
        "many_nan": _cells(table, 4, "nan", 1, 3),
        "all_nan": _cells(table, 4, "nan"),
        "infinite": _cells(table, 4, "inf", 1, 3),
        "huge": _cells(table, 4, "1e300"),
        "time_constant": _cells(table, 0, "1.0"),
        "time_backwards": [table[0], *reversed(table[1:])],
        "time_text": _cells(table, 0, "noon"),
        "time_gap": [table[0], *table[1:300], *table[900:]],
        "standing": _cells(_cells(table, 1, "0"), 2, "0"),
        "current_zero": _cells(table, 4, "0"),
        "twice": [[*row, row[-1]] for row in table],
        "ragged": [row[: 3 if number == 40 else 5] for number, row in enumerate(table)],
        "long_row": [row + (["1"] if number == 40 else []) for number, row in enumerate(table)],
        "no_header": table[1:],
        "unit_row": [table[0], ["s", "rad", "rad/s", "V", "kg"], *table[1:]],
        "shuffled": [table[0], *table[600:], *table[1:600]],
    }
    logs = {f"{name}.csv": "\n".join(map(",".join, rows)).encode() for name, rows in tables.items()}
    good = "\n".join(rows).encode()
    suffixes = (
        "parquet",
        "mat",
        "json",
        "npz",
        "h5",
        "mf4",
        "db3",
        "mcap",
        "ulg",
        "tdms",
        "csv.gz",
        "xlsx",
        "txt",
        "json.gz",
    )
    logs |= {f"csv_inside.{suffix}": good for suffix in suffixes}
    cut = gzip.compress(good, mtime=0)
    return logs | {
        "empty.csv": b"",
        "binary.csv": bytes(range(256)) * 8,
        "nulls.csv": b"\0" * 300,
        "cut.csv.gz": cut[:-200],
    }


ARM: dict[str, Any] = {
    "name": "two",
    "gravity": [0, "-9.81 m/s^2", 0],
    "joint": [
        {
            "name": "a",
            "axis": [0, 0, 1],
            "mu": "1/9",
            "J_m": "600 g cm^2",
            "body": {"mass": "1 kg", "centre": [0, "-0.2 m", 0]},
        },
        {
            "name": "b",
            "position": [0, "-0.3 m", 0],
            "mu": "1/6",
            "body": {"mass": "0.4 kg", "centre": [0, "-0.1 m", 0]},
        },
    ],
}
ARM_ROWS: Mapping[str, tuple[str, object]] = {
    "name=absent": ("name", ABSENT),
    "name=space": ("name", "my arm"),
    "name=keyword": ("name", "int"),
    "name=number": ("name", 2),
    "gravity=two": ("gravity", [0, 1]),
    "gravity=bare": ("gravity", [0, -9.81, 0]),
    "gravity=unit": ("gravity", [0, "-9.81 m", 0]),
    "joint=absent": ("joint", ABSENT),
    "joint=empty": ("joint", []),
    "joint=text": ("joint", "a"),
    "axis=0": ("joint.0.axis", [0, 0, 0]),
    "axis=long": ("joint.0.axis", [0, 0, 2]),
    "axis=text": ("joint.0.axis", "z"),
    "kind": ("joint.0.kind", "ball"),
    "mu=0": ("joint.0.mu", 0),
    "mu=text": ("joint.0.mu", "fast"),
    "J_m=negative": ("joint.0.J_m", "-1 kg m^2"),
    "J_m=unit": ("joint.0.J_m", "1 kg"),
    "name=twice": ("joint.1.name", "a"),
    "name_of_joint=absent": ("joint.1.name", ABSENT),
    "body=absent": ("joint.1.body", ABSENT),
    "body=text": ("joint.1.body", "heavy"),
    "mass=absent": ("joint.1.body.mass", ABSENT),
    "mass=negative": ("joint.1.body.mass", "-1 kg"),
    "mass=0": ("joint.1.body.mass", 0),
    "mass=bare": ("joint.1.body.mass", 3),
    "centre=two": ("joint.1.body.centre", [0, 0]),
    "inertia=one": ("joint.1.body.inertia", "1 kg m^2"),
    "inertia=triangle": ("joint.1.body.inertia", {"xx": "1 kg m^2", "yy": "1 kg m^2", "zz": "5 kg m^2"}),
    "rpy=degrees": ("joint.1.rpy", [0, 0, 90]),
    "dh=both": ("joint.1.dh", {"a": "1 m"}),
    "rotation": ("joint.1.rotation", [[1, 0, 0], [0, 1, 0], [0, 0, 2]]),
    "symbolic=none": ("symbolic", ["payload.colour"]),
    "symbolic=text": ("symbolic", "payload"),
    "payload=empty": ("payload", {}),
    "urdf=none": ("urdf", "nothing.urdf"),
    "unknown_key": ("colour", "red"),
    "misspelled": ("joint.0.axes", [0, 0, 1]),
}
FIT_TEXTS = {
    "empty.json": "",
    "open.json": "{",
    "list.json": "[]",
    "nothing.json": "{}",
    "text.json": '{"M": "heavy"}',
    "unknown.json": '{"M": 0.5, "colour": 1}',
    "negative.json": '{"M": -0.5}',
    "zero.json": '{"mu": 0}',
    "infinite.json": '{"M": 1e999}',
    "nan.json": '{"M": NaN}',
    "null.json": '{"M": null}',
    "true.json": '{"M": true}',
    "format.json": '{"format": "eccentric-fit/99"}',
    "fit.json": '{"format": "eccentric-fit/1", "model": "c1_perpendicular"}',
    "parameters.json": '{"format": "eccentric-fit/1", "model": "c2_parallel", "parameters": 3}',
}
SCRIPTS = {
    "syntax.py": "def effects(setting:\n",
    "nothing.py": "x = 1\n",
    "raises.py": "raise ValueError('on purpose')\n",
    "exits.py": "import sys\nsys.exit(3)\n",
    "imports.py": "import no_such_package\n",
    "number.py": "model = 3\neffects = 3\n",
    "none.py": "model = None\n\n\ndef effects(setting):\n    return None\n",
    "text.py": "model = 'c2_parallel'\n\n\ndef effects(setting):\n    return ['stribeck']\n",
    "arguments.py": "def effects():\n    return []\n",
    "inside.py": "def effects(setting):\n    return [setting.colour]\n",
    "empty.py": "def effects(setting):\n    return []\n",
}
LIMITS = {"speed_rad_s": 30, "acceleration_rad_s2": 200, "current_A": 8, "time_s": 20}
LIMIT_ROWS: Mapping[str, tuple[str, object]] = {
    **{f"{key}=absent": (key, ABSENT) for key in LIMITS},
    **{f"{key}=text": (key, "fast") for key in LIMITS},
    **{f"{key}=negative": (key, -1) for key in LIMITS},
    "speed=0": ("speed_rad_s", 0),
    "time=short": ("time_s", 0.01),
    "angle=text": ("angle_rad", "wide"),
    "linear": ("speed_m_s", 1),
    "unknown_key": ("colour", 1),
    "misspelled": ("sped_rad_s", 1),
}
OPTIONS: Mapping[str, str] = {
    "emit": (
        "|c2_paralel|nothing.py|nothing.toml|nothing.urdf|examples|inputs/arm.xacro|inputs/arm.xml|C2|c2_parallel c1_perpendicular"
        "|c2_parallel --out .|c2_parallel --out inputs/rig.json|c2_parallel --out inputs/rig.json/x|serial_chain"
        "|c2_parallel --backend fortran|c2_parallel --backend c98|c2_parallel --functions nothing|c2_parallel --functions ,"
        "|c2_parallel --functions friction_torqe|c2_parallel --functions polynomial|c2_parallel --functions voltage,nothing"
        "|c2_parallel --prefix 1x|c2_parallel --prefix a-b|c2_parallel --prefix int|c2_parallel --prefix lambda"
        "|c2_parallel --prefix eccentric_runtime|c2_parallel --prefix x/y"
        "|c2_parallel --single-file --backend c99|c2_parallel --fixed --backend numpy|c2_parallel --forgetting 0.9"
        "|c2_parallel --adapt|c2_parallel --adapt --forgetting 2|c2_parallel --adapt --forgetting x"
        "|c2_parallel --adapt --false-alarms 0|c2_parallel --adapt --settle -1|c2_parallel --adapt --settle 1.5"
        "|c2_parallel --adapt --backend jax|c2_parallel --adapt --fixed|c2_parallel --parameters nothing.json"
        "|c2_parallel --parameters examples|c2_parallel --nothing|examples/arms/planar_2r.toml --adapt"
        "|examples/arms/planar_2r.toml --functions friction_torque|examples/arms/two_links.urdf#nothing"
    ),
    "derive": "nothing|c2_paralel|nothing.py|--out inputs/rig.json|--latx|examples",
    "figures": "--out .|--out inputs/rig.json|--nothing|",
    "audit": "now|--nothing",
    "doctor": "now|--nothing",
    "fit": (
        "LOG|--rig RIG|LOG --rig|LOG --rig nothing.toml|LOG --rig examples|nothing.csv --rig RIG|examples --rig RIG|LOG LOG --rig RIG"
        "|LOG --rig RIG --model nothing|LOG --rig RIG --model c2_paralel|LOG --rig RIG --model screw_axis"
        "|LOG --rig RIG --model nothing.py|LOG --rig RIG --model serial_chain|LOG --rig RIG --mode x|LOG --rig LOG"
        "|LOG --rig RIG --out .|LOG --rig RIG --out inputs/rig.json"
    ),
    "diagnose": (
        "LOG|LOG --rig nothing.toml|nothing.csv --rig RIG|LOG --rig RIG --with nothing|LOG --rig RIG --with strbeck"
        "|LOG --rig RIG --without nothing|LOG --rig RIG --only nothing"
        "|LOG --rig RIG --only stribeck --without stribeck"
        "|LOG --rig RIG --with cogging[n=99]|LOG --rig RIG --with viscosity_temperature|LOG --rig RIG --effects nothing.py"
        "|LOG --rig RIG --effects RIG|LOG --rig RIG --effects examples|LOG --rig RIG --model nothing|LOG --rig RIG --out ."
        "|LOG --rig RIG --model screw_axis|LOG LOG --rig RIG|LOG --rig RIG --opn"
    ),
    "compare": (
        "LOG --rig RIG|LOG c2_parallel|nothing.csv --rig RIG c2_parallel|LOG --rig nothing.json c2_parallel|LOG --rig RIG nothing"
        "|LOG --rig RIG c2_paralel|LOG --rig RIG c2_parallel+nothing|LOG --rig RIG c2_parallel+strbeck|LOG --rig RIG c2_parallel+"
        "|LOG --rig RIG +stribeck|LOG --rig RIG c2_parallel++stribeck|LOG --rig RIG c2_parallel+stribeck+stribeck"
        "|LOG --rig RIG c2_parallel+cogging[n=99]|LOG --rig RIG screw_axis|LOG --rig RIG serial_chain|LOG --rig RIG nothing.py"
        "|LOG --rig RIG c2_parallel c2_parallel|LOG --rig RIG c2_parallel --effects nothing.py|LOG --rig RIG c2_parallel --out ."
    ),
    "plan": (
        "LOG --rig RIG|LOG --rig RIG --limits nothing.toml|LOG --rig RIG --limits examples|LOG --rig RIG --limits LOG"
        "|LOG --rig RIG --limits inputs/limits.json --diagnosis nothing.json|LOG --rig RIG --limits inputs/limits.json --diagnosis RIG"
        "|LOG --rig RIG --limits inputs/limits.json --added heavy|LOG --rig RIG --limits inputs/limits.json --added 2"
        "|LOG --rig RIG --limits inputs/limits.json --added -1kg|LOG --rig RIG --limits inputs/limits.json --model nothing"
        "|nothing.csv --rig RIG --limits inputs/limits.json|LOG --rig nothing.json --limits inputs/limits.json"
    ),
    "adapt": (
        "LOG|nothing.csv --rig RIG|LOG --rig nothing.toml|LOG --rig RIG --forgetting 0|LOG --rig RIG --forgetting 2"
        "|LOG --rig RIG --forgetting x|LOG --rig RIG --false-alarms 0|LOG --rig RIG --false-alarms x|LOG --rig RIG --settle -1"
        "|LOG --rig RIG --settle x|LOG --rig RIG --parameters nothing.json|LOG --rig RIG --parameters RIG|LOG --rig RIG --model nothing"
        "|LOG --rig RIG --out ."
    ),
    "fleet": (
        "|nothing --rigs RIG|inputs/none --rigs RIG|inputs/fleet_logs|inputs/fleet_logs --rigs nothing.csv|inputs/fleet_logs --rigs LOG"
        "|inputs/fleet_logs --rigs RIG --rate 2|inputs/fleet_logs --rigs RIG --rate 0|inputs/fleet_logs --rigs RIG --rate x"
        "|inputs/fleet_logs --rigs RIG --workers 0|inputs/fleet_logs --rigs RIG --workers x|inputs/fleet_logs --rigs RIG --pattern x"
        "|inputs/fleet_logs --rigs RIG --pattern {joint}|inputs/fleet_logs --rigs RIG --pattern {month}_{joint}"
        "|inputs/fleet_logs --rigs RIG --out .|inputs/fleet_logs --rigs examples"
    ),
    "bench": (
        "|--case C3|--mu 0|--mu 5|--mu x|--seconds 1|--seconds 1e9|--seconds x|--noise -1|--noise 2|--noise x|--seed x|--seed -1"
        "|--effect nothing|--effect strbeck|--effect stribeck=2|--effect stribeck=0|--effect stribeck=x|--effect stribeck@2"
        "|--effect cogging[n=99]|--effect stribeck --effect stribeck|--effect viscosity_temperature|--log-type x|--drive x"
        "|--arm 4|--arm 2r --runs 1|--arm 2r --rate 100|--arm 2r --measured x|--arm 2r --mu 0.5|--arm 2r --effect stribeck@9"
        "|--arm 2r --effect nothing|--arm 2r --case C1|--runs 5|--rate 500|--fleet --joints 0|--fleet --months 0"
        "|--fleet --degrading 99|--fleet --bad-sensors -1|--fleet --arm 2r|--joints 5|--fleet --seconds 1|--nothing"
        "|--out inputs/log.csv|--out inputs/log.txt|--out inputs|--out nothing/log.csv"
    ),
    "rig": (
        "|nothing.csv|examples|LOG --check nothing.toml|LOG --check examples|LOG --check RIG --out inputs/new.toml|LOG --out RIG"
        "|LOG --out inputs/new.yaml|LOG --out inputs/rig.json/new.toml|LOG --arm nothing.toml|LOG --arm RIG|LOG --arm examples/arms/planar_2r.toml"
        "|LOG --nothing"
    ),
    "": "|nothing|diagnos|--nothing|-x|fit diagnose|Fit",
}
"""Command -> its bad arguments, separated by bars; where they name no --out, a fresh folder is added."""
NEEDS_OUT = {"emit", "fit", "diagnose", "plan", "adapt", "fleet"}

CALLS = (
    "eccentric.nothing",
    "eccentric.read_log(3)",
    "eccentric.read_log('nothing.csv')",
    "eccentric.read_log({})",
    "eccentric.read_log({'time_s': [0.0, 1.0], 'current_A': [1.0]})",
    "eccentric.read_log({'time_s': ['a', 'b']})",
    "eccentric.read_rig(3)",
    "eccentric.read_rig({})",
    "eccentric.read_rig({'known': 3})",
    "eccentric.read_rig({'known': {'M': '3 parsec'}})",
    "eccentric.read_rig('nothing.toml')",
    "eccentric.read_arm_rig({})",
    "eccentric.read_arm_rig('nothing.toml')",
    "eccentric.load_model('c2_paralel')",
    "eccentric.load_model(3)",
    "eccentric.load_model('nothing.py')",
    "eccentric.emit('c2_paralel', 'inputs/out/a')",
    "eccentric.emit(3, 'inputs/out/b')",
    "eccentric.emit('c2_parallel', 3)",
    "eccentric.emit('c2_parallel', 'inputs/out/c', backend='fortran')",
    "eccentric.emit('c2_parallel', 'inputs/out/d', functions='voltage')",
    "eccentric.emit('c2_parallel', 'inputs/out/e', functions=['nothing'])",
    "eccentric.emit('c2_parallel', 'inputs/out/f', parameters={'M': -1})",
    "eccentric.emit('c2_parallel', 'inputs/out/g', parameters=3)",
    "eccentric.emit('c2_parallel', 'inputs/out/h', prefix='int')",
    "eccentric.emit('c2_parallel', 'inputs/out/i', settle=3)",
    "eccentric.fit(3, RIG)",
    "eccentric.fit([], RIG)",
    "eccentric.fit(LOG, 3)",
    "eccentric.fit(LOG, RIG, model=3)",
    "eccentric.fit(LOG, RIG, model='nothing')",
    "eccentric.diagnose(LOG, RIG, effects=3)",
    "eccentric.diagnose(LOG, RIG, effects='nothing.py')",
    "eccentric.diagnose('nothing.csv', RIG)",
    "eccentric.fit_arm(LOG, RIG)",
    "eccentric.diagnose_arm(LOG, RIG)",
    "eccentric.compare(LOG, RIG, [])",
    "eccentric.compare(LOG, RIG, ['nothing'])",
    "eccentric.compare(LOG, RIG, 3)",
    "eccentric.plan(LOG, RIG, {})",
    "eccentric.plan(LOG, RIG, {'speed_rad_s': -1})",
    "eccentric.plan(LOG, RIG, 3)",
    "eccentric.adapt(LOG, RIG, forgetting=2)",
    "eccentric.adapt(LOG, RIG, parameters=3)",
    "eccentric.draft_rig(3)",
    "eccentric.draft_rig([])",
    "eccentric.check_rig(LOG, {})",
    "eccentric.check_rig(LOG, 3)",
    "eccentric.bench(case='C3')",
    "eccentric.bench(effects=['nothing'])",
    "eccentric.bench(seconds=-1)",
    "eccentric.bench_arm('4')",
    "eccentric.bench_fleet(3)",
    "eccentric.diagnose_fleet('nothing', RIG, 'inputs/out/j')",
    "eccentric.compile('nothing')",
    "eccentric.compile(3)",
)
"""Lines of Python; LOG and RIG are those of the bundled log."""


def _mutated(document: Any, key: str, value: object) -> Any:
    """A document with one value replaced, added or removed; a key such as joint.0.axis leads into it."""
    changed = copy.deepcopy(document)
    *way, last = key.split(".")
    place = changed
    for step in way:
        place = place[int(step)] if step.isdigit() else place[step]
    if value is ABSENT:
        del place[last]
    else:
        place[last] = value
    return changed


_TABLES = {"rigs": (BASE, RIG_ROWS), "arms": (ARM, ARM_ROWS), "limits": (LIMITS, LIMIT_ROWS)}
_TEXTS = {"rig_texts": RIG_TEXTS, "fits": FIT_TEXTS, "scripts": SCRIPTS}


def safe(name: str) -> str:
    """The name of a mutation as that of a file."""
    return "".join(letter if letter.isalnum() or letter in "._=+-" else "_" for letter in name)


def prepare(folder: Path) -> None:
    """Write every broken file below the folder, and the good ones that the broken ones are made of."""
    log = gzip.decompress(Path("examples/bench/bench.csv.gz").read_bytes()).decode().splitlines()[: ROWS + 1]
    good = {"log.csv": "\n".join(log) + "\n", "rig.json": json.dumps(BASE), "limits.json": json.dumps(LIMITS)}
    good |= {
        "arm.xacro": "<robot/>",
        "arm.xml": "<robot/>",
        "none/readme.txt": "no log",
        "fleet_logs/log.csv": "a,b\n1,2\n",
    }
    files: dict[str, bytes] = {name: text.encode() for name, text in good.items()}
    for place, texts in _TEXTS.items():
        files |= {f"{place}/{name}": text.encode("latin-1") for name, text in texts.items()}
    for place, (document, rows) in _TABLES.items():
        for name, (key, value) in rows.items():
            files[f"{place}/{safe(name)}.json"] = json.dumps(
                _mutated(document, key, value), indent=1
            ).encode()
    files |= {f"logs/{name}": content for name, content in _broken_logs(log[:ROWS]).items()}
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def commands() -> dict[str, list[str]]:
    """Group -> command lines that should be refused, after `prepare`; each group writes into its own folder."""
    rigs = [f"{HERE}/rigs/{safe(name)}.json" for name in RIG_ROWS]
    rigs += [f"{HERE}/rig_texts/{name}" for name in RIG_TEXTS]
    logs = sorted(str(path) for path in Path(HERE, "logs").iterdir())
    scripts = [f"{HERE}/scripts/{name}" for name in SCRIPTS]
    limits = [f"{HERE}/limits/{safe(name)}.json" for name in LIMIT_ROWS]
    groups = {
        "rig_check": [f"rig LOG --check {rig}" for rig in rigs[::12]],  # each tries a fit: seconds
        "rig_fit": [f"fit LOG --rig {rig} --out OUT" for rig in rigs],
        "log_fit": [f"fit {log} --rig RIG --out OUT" for log in logs],
        "log_rig": [f"rig {log}" for log in logs],
        "arm": [f"emit {HERE}/arms/{safe(name)}.json --out OUT" for name in ARM_ROWS],
        "limits": [f"plan LOG --rig RIG --limits {path} --out OUT" for path in limits],
        "fits": [f"emit c2_parallel --parameters {HERE}/fits/{name} --out OUT" for name in FIT_TEXTS],
        "scripts": [f"emit {script} --out OUT" for script in scripts],
        "effects": [
            f"diagnose LOG --rig RIG --effects {script} --out OUT"
            for script in scripts
            if "empty" not in script
        ],
    }
    for command, text in OPTIONS.items():
        rows = [f"{command} {words}" for words in text.split("|")]
        out = " --out OUT" if command in NEEDS_OUT else ""
        groups[f"options_{command or 'none'}"] = [row if "--out" in row else row + out for row in rows]
    return {
        name: [
            re.sub(r"\b(LOG|RIG|OUT)\b", lambda word: {**FILES, "OUT": f"{HERE}/out/{name}"}[word[0]], row)  # noqa: B023
            for row in rows
        ]
        for name, rows in groups.items()
    }
