"""Small inputs that once failed: each is run as its `about.toml` says, and its answer held against what is wanted."""

from __future__ import annotations

import fnmatch
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.record import progress

ROOT = Path(__file__).resolve().parent.parent


@dataclass(frozen=True)
class Answer:
    """Whether an input is answered as wanted, what is missing, and all that was said."""

    name: str
    as_wanted: bool
    why: str
    said: str


Check = Callable[[str, Path], str]
"""What is missing in an answer, "" if nothing: of the output of all commands, and the folder with their files."""


def _says(*patterns: str, never: Sequence[str] = ()) -> Check:
    def check(said: str, _: Path) -> str:
        text = " ".join(said.split())
        missing = [p for p in patterns if not re.search(p, text, re.IGNORECASE)]
        there = [p for p in never if re.search(p, text, re.IGNORECASE)]
        return "; ".join([*(f"does not say {p!r}" for p in missing), *(f"says {p!r}" for p in there)])

    return check


def _drafts(
    *rigs: str,
    columns: dict[str, str],
    absent: Sequence[str] = (),
    known: Mapping[str, object] | None = None,
    says: Sequence[str] = (),
) -> Check:
    """A draft whose channels have the columns that a pattern matches, and no `absent` channels or keys.

    `known` are values of [known]; `says` is in what is printed or in the comments.
    """

    def check(said: str, folder: Path) -> str:
        wrong = []
        for rig in rigs:
            path = folder / rig
            if not path.exists():
                return f"{rig} is not drafted: {said.strip()[-200:]}"
            content = tomllib.loads(path.read_text(encoding="utf-8"))
            channels = {k: v["column"] if isinstance(v, dict) else v for k, v in content["columns"].items()}
            wrong += [
                f"{rig}: no {channel} that matches {pattern}"
                for channel, pattern in columns.items()
                if not any(re.match(channel, c) and re.search(pattern, v) for c, v in channels.items())
            ]
            everything = {**content, **channels}
            wrong += [f"{rig}: {c} = {everything[c]}" for c in absent if c in everything]
            table = content.get("known", {})
            wrong += [f"{rig}: {k} = {table.get(k)}" for k, v in (known or {}).items() if table.get(k) != v]
            text = path.read_text(encoding="utf-8")
            wrong += [
                f"{rig}: does not say {p!r}"
                for p in says
                if not re.search(p, " ".join((said + text).replace("#", " ").split()), re.IGNORECASE)
            ]
        return "; ".join(wrong)

    return check


def _value(pattern: str, right: float, tolerance: float) -> Check:
    def check(said: str, _: Path) -> str:
        found = re.search(pattern + r"\D{0,3}?([-+]?\d[\d.]*(?:e[-+]?\d+)?)", said)
        if found is None:
            return f"no value of {pattern}"
        value = float(found[1])
        near = math.isclose(value, right, rel_tol=tolerance)
        return "" if near else f"{pattern} {value:g}, {right:g} is right"

    return check


def _all(*checks: Check) -> Check:
    return lambda said, folder: "; ".join(filter(None, (check(said, folder) for check in checks)))


_TIME = {"time": "."}
CHECKS: dict[str, Check] = {
    "J_zero_misleading": _says(
        r"delay.*(inertia|J)\b.*(told apart|one and the same|declare)", never=[r"signs of voltage"]
    ),
    "check_refuses_diagnose_answers": _says(
        r"(averages|windows|repeat)", never=[r"nothing_missing", r"well above the 0 N m"]
    ),
    "check_silent_on_R_and_k_e": _says(
        r"\bR\b.{0,60}0\.[67]\d*", r"k_e.{0,60}0\.018", never=["no problems found"]
    ),
    "coarse_voltage_quarter_row": _value(r"J\*R/k_i +", 0.0095 / (2.0 * math.pi), 0.01),
    "cogging_order_above_24": _says(r"cogging.{0,12}n ?= ?84|84 (per|times a|times per) turn"),
    "cogging_refused_low_r2": _says(r"cogging.{0,12}n ?= ?12", never=[r"does not fit the rig"]),
    "crash_current_max": _says(r"sign", never=["Traceback", "current_max"]),
    "draft_cogging_as_gear": _drafts("rig.toml", columns=_TIME, known={"mu": 1, "case": "C1"}),
    "draft_computed_torque_over_measured": _drafts(
        "rig.toml", "rig7.toml", columns={"torque": "tau_measured"}
    ),
    "draft_const_duty_offset": _all(
        _drafts("rig.toml", columns=_TIME, absent=("voltage_offset_V",), says=["constant"]),
        _says(never=[r"\d{10}"]),
    ),
    "draft_joint_index_mismatch": _drafts(
        "rig.toml", columns={"theta": r"\(:,5\)", "omega": r"\(:,5\)", "torque": r"tau_measured\(:,5\)"}
    ),
    "draft_stamp_as_current": _drafts(
        "rig.toml", columns=_TIME, absent=("current", "torque", "torque_l"), says=["constant"]
    ),
    "draft_target_as_voltage": _drafts(
        "rig.toml", columns={"voltage": "MotorPWM"}, says=["both (ways|directions)|sign"]
    ),
    "draft_txvF": _drafts(
        "rig.toml",
        columns={"(omega|velocity)": "^v$", "(torque|force)": "^F$"},
        absent=("voltage", "current"),
    ),
    "draft_unnamed_over_named": _drafts("rig.toml", columns={"torque": "."}, absent=("voltage", "current")),
    "name_I_complex_h": _says(r"\bI\b.*(reserved|macro|complex|name)", never=["error: expected"]),
    "parquet_lists": _drafts("rig.toml", columns={"(theta|omega)": r"observation\.state\(:,\d\)"}),
    "refuse_clock_time": _drafts("rig.toml", columns={"time": "Time"}),
    "refuse_duplicate_stamps": _says(r"(8 rows|packet|share|same stamp|one stamp)"),
    "refuse_no_time": _says(r"sample_rate_hz"),
    "refuse_preamble": _drafts("rig.toml", columns=_TIME),
    "refuse_restart": _says(r"(again|restart|starts over)", r"\brun"),
    "refuse_whitespace": _drafts("rig.toml", columns={"time": "time", "torque": "torque"}),
    "short_runs_blame_units": _says(
        r"(shorter|ends|0\.5\d* s|mass)", never=["units of time and position right"]
    ),
    "threshold_blames_units": _says(
        r"(moving_threshold_rad_s|\bB\b)", never=["units of time and angle right"]
    ),
}


def answers(faults: Path, patterns: Sequence[str] = ()) -> list[Answer]:
    """The answer to every input, run in a copy of its folder."""
    found = []
    with tempfile.TemporaryDirectory() as place:
        work = Path(place) / "faults"
        shutil.copytree(faults, work, copy_function=shutil.copyfile)
        for folder in [work, *work.iterdir()]:
            folder.chmod(0o755)
        for about in sorted(work.glob("*/about.toml")):
            name = about.parent.name
            if patterns and not any(fnmatch.fnmatch(name, f"*{one}*") for one in patterns):
                continue
            progress(f"strangers: {name}")
            content = tomllib.loads(about.read_text(encoding="utf-8"))
            said = "".join(_run(command, about.parent) for command in content["command"])
            if "Traceback (most recent call last)" in said:
                why = "a traceback"
            else:
                why = CHECKS[name](said, about.parent)
            found.append(Answer(name, not why, why, said))
    return found


def _run(command: str, folder: Path) -> str:
    """Output of an `eccentric` command; one in words is left out."""
    if not command.startswith("eccentric "):
        return ""
    words = [sys.executable, "-m", "eccentric", *shlex.split(command)[1:]]
    done = subprocess.run(
        words,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    return f"$ {command}\n{done.stdout}{done.stderr}"
