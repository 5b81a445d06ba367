"""Does a draft read a log that nobody described? Measured logs and examples, renamed and rescaled at random.

    python benchmarks/drafted.py DATA [--variants N]

DATA holds the folders `measured` and `examples` of logs. For each variant: which columns have the right channel
and unit, and whether what is wrong is doubted; then the questions are answered with what the shipped rig file
knows, and the log is fitted.
"""

from __future__ import annotations

import argparse
import collections
import json
import sys
import tomllib
import warnings
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from benchmarks.decoys import decoyed
from benchmarks.disguised import Column, Disguised, Judged, disguised, judged
from benchmarks.measured_logs import SETS, measured_log
from benchmarks.record import Measured, Part, progress
from eccentric.core import InputError
from eccentric.drafting import Draft, draft_of, toml_of
from eccentric.identification import fit
from eccentric.logs import Log, read_log
from eccentric.model import load_model
from eccentric.rigs import read_rig
from eccentric.signals import read_channels

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
VARIANTS = 200
Disguise = Callable[[Log, Mapping[str, Column], np.random.Generator], Disguised]
TYPED = 3
"""Values that a person types at most."""
EXAMPLES = ("example1", "example2", "example3", "example4")
_EXAMPLE = {
    "time_s": Column("time", "s"),
    "theta_m_rad": Column("angle", "rad"),
    "omega_m_rad_s": Column("speed", "rad/s"),
    "voltage_V": Column("voltage", "V"),
    "current_A": Column("current", "A"),
    "temperature_C": Column("temperature", "degC"),
}
_SCREW = {
    "run": Column("run"),
    "t_s": Column("time", "s"),
    "speed_rpm": Column("speed", "rpm", same="w_in_rad_s"),
    "w_in_rad_s": Column("speed", "rad/s", same="speed_rpm"),
    "torque_mNm": Column("torque", "mNm"),
    "restored": Column("bad"),
}
KNOWN: dict[str, dict[str, Column]] = {
    "bam_xl330_pendulum": {
        "run": Column("run"), "t_s": Column("time", "s"), "q_rad": Column("angle", "rad", 4096),
        "w_rad_s": Column("speed", "rad/s"), "pwm_counts": Column("duty"), "supply_V": Column("supply", "V"),
        "temp_C": Column("temperature", "degC"), "goal_rad": Column("set angle", "rad"),
        "torque_enable": Column("on"),
    },
    "dfki_ak80_pendulum": {
        "run": Column("run"), "t_s": Column("time", "s"), "q_rad": Column("angle", "rad"),
        "w_rad_s": Column("speed", "rad/s"), "torque_Nm": Column("torque", "N m"),
        "disturbance_suspect": Column("bad"),
    },
    "tue_unbalanced_disc": {
        "t_s": Column("time", "s"), "u_V": Column("voltage", "V"), "q_counts": Column("angle", "counts", 2000),
    },
    "tro2021_drive1": _SCREW,
    "tro2021_drive3": _SCREW,
}  # fmt: skip
"""What the columns of the measured logs are, by their own descriptions."""


def logs(data: Path) -> Iterator[tuple[str, Log, dict[str, Column], dict[str, Any]]]:
    """Name, log, columns and rig file of every log, with the rows of one rig each."""
    for name in SETS:
        path, rig = measured_log(data / "measured", name)
        content = tomllib.loads(rig.read_text(encoding="utf-8"))
        yield name, _of_runs(read_log(path), content.get("runs", [])), KNOWN[name], content
    for name in EXAMPLES:
        log = read_log(data / "examples" / f"{name}.csv.gz")
        content = json.loads((data / "examples" / f"{name}.json").read_text(encoding="utf-8"))
        counts = float(content["encoder_counts_per_rev"])
        known = {
            c: Column(k.quantity, k.unit, counts if k.quantity == "angle" else 0.0)
            for c, k in _EXAMPLE.items()
            if c in log.columns
        }
        yield name, log, known, content


def _of_runs(log: Log, runs: list[str]) -> Log:
    if not runs:
        return log
    prefix = runs[0].rstrip("*")
    rows = np.char.startswith(log.text("run").astype(str), prefix)
    return Log(log.path, {c: x[rows] for c, x in log.columns.items()}, int(np.count_nonzero(rows)))


def typed(draft: Draft, rig: Mapping[str, Any]) -> tuple[str, int]:
    """The draft with its questions answered as far as the fit needs it, and how many values that took."""
    told = read_rig({"known": rig["known"], "unknown": rig.get("unknown", {})})
    answers = {**{k: f"{v:.9g}" for k, v in told.known.items()}}
    units = {"M": "kg", "M_l": "kg", "L": "m", "k_i": "N m/A"}
    lines, count = [], 0
    for line in toml_of(draft, "draft").splitlines():
        key = line.removeprefix("#? ").split(" =")[0]
        if line.startswith("#? ") and key in units:
            value = answers.get(key)
            # What the shipped file has as a range is typed as its middle.
            value = value or f"{sum(told.unknown[key]) / 2:.9g}" if key in told.unknown or value else "0.1"
            lines.append(f'{key} = "{value} {units[key]}"')
            count += 1
        elif line.startswith("#? ") and key == "encoder_counts_per_rev":
            lines.append(f"{key} = 4096")
            count += 1
        else:
            lines.append(line)
    return "\n".join(lines), count


def runs(given: Disguised, draft: Draft, rig: Mapping[str, Any]) -> tuple[bool, int, str]:
    """Whether a fit runs on the draft, how many values were typed, and why it did not run."""
    text, count = typed(draft, rig)
    try:
        found = read_rig(tomllib.loads(text))
        channels = read_channels([given.log], found)
        fit(channels, channels.rig, load_model(channels.rig.model), "log")
    except InputError as error:
        return False, count, str(error)
    return True, count, ""


def measure(
    data: Path, variants: int, *, disguise: Disguise = disguised, show: bool = False
) -> tuple[list[tuple[str, str, list[Judged]]], list[tuple[bool, int, str]]]:
    """The judged columns of every variant with log and style, and of every variant whether a fit ran."""
    found, fitted = [], []
    all_logs = list(logs(data))
    for k in range(variants):
        name, log, known, rig = all_logs[k % len(all_logs)]
        rng = np.random.default_rng([2026, k])
        given = disguise(log, known, rng)
        progress(f"drafts: {k + 1} of {variants}, {name}")
        try:
            draft = draft_of(given.log)
        except InputError as error:
            found.append(
                (
                    name,
                    given.style,
                    [Judged(c, x.quantity, False, True, f"refused: {error}") for c, x in given.truth.items()],
                )
            )
            fitted.append((False, 0, str(error)))
        else:
            found.append((name, given.style, judged(draft, given)))
            fitted.append(runs(given, draft, rig))
        if show:
            for one in found[-1][2]:
                if not one.right:
                    print(
                        f"{k} {name}, {given.style}: {one.quantity} {one.name!r} -> {one.said}{'' if one.doubted else ' NOT DOUBTED'}",
                        flush=True,
                    )
            if not fitted[-1][0]:
                print(f"{k} {name}, {given.style}: no fit: {fitted[-1][2]}", flush=True)
    return found, fitted


def part(
    found: list[tuple[str, str, list[Judged]]],
    fitted: list[tuple[bool, int, str]],
    among: list[tuple[str, str, list[Judged]]],
) -> Part:
    """The figures and tables of the page; `among` are the logs with decoys, which are not fitted."""
    columns = [one for _, _, judgements in found for one in judgements]
    right = sum(one.right for one in columns)
    silent = sum(not one.right and not one.doubted for one in columns)
    ran = [count for ok, count, _ in fitted if ok]
    easy = sum(count <= TYPED for count in ran)
    lines = [
        f"{len(found)} variants of {len({name for name, _, _ in found})} logs: columns renamed, rescaled and shuffled"
        " at random; names with their unit, words alone, or numbers.",
        "The last row is of other variants: real names of loggers, with set points, results of models, errors,"
        " supplies, stamps and copies among them.",
        "A unit is right to one part in a thousand. A column that is no channel is right if it is left out.",
        "",
        "| names | columns | right | wrong, doubted | wrong, not doubted | right, but doubted |",
        "|---|--:|--:|--:|--:|--:|",
    ]
    by_style = collections.defaultdict(list)
    for _, style, judgements in found:
        by_style[style] += judgements
    decoys = [one for _, _, judgements in among for one in judgements]
    for style, all_of in [*sorted(by_style.items()), ("all", columns), ("real, with decoys", decoys)]:
        good = [one for one in all_of if one.right]
        bad = [one for one in all_of if not one.right]
        lines.append(
            f"| {style} | {len(all_of)} | {len(good) / len(all_of):.1%} | {sum(o.doubted for o in bad)} |"
            f" {sum(not o.doubted for o in bad)} | {sum(o.doubted for o in good)} |"
        )
    lines += [
        "",
        f"With the questions answered, {len(ran)} of {len(fitted)} logs were fitted, {easy} of them with at most {TYPED} values typed.",
    ]
    return Part(
        {
            "drafted": Measured(100.0 * right / len(columns), f"{100.0 * right / len(columns):.1f} %"),
            "drafted silently wrong": Measured(silent, f"{silent} of {len(columns):,}"),
            "drafted decoys": Measured(
                taken := sum(not one.right and not one.doubted for one in decoys),
                f"{taken} of {len(decoys):,}",
            ),
            "drafted fits": Measured(100.0 * easy / len(fitted), f"{100.0 * easy / len(fitted):.1f} %"),
        },
        lines,
    )


def measured(quick: bool) -> Part:
    """All variants, or 18 if quick."""
    if not DATA.is_dir():
        return Part({}, ["Not measured: the logs are not bundled."])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        count = 18 if quick else VARIANTS
        return part(*measure(DATA, count), measure(DATA, count, disguise=decoyed)[0])


def main() -> None:
    """Measure, print what is wrong and the tables."""
    parser = argparse.ArgumentParser(description="Drafts of renamed and rescaled logs.")
    parser.add_argument("data", type=Path, help="folder of the logs")
    parser.add_argument("--variants", type=int, default=VARIANTS)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    found = measure(given.data, given.variants, show=True)
    among = measure(given.data, given.variants, disguise=decoyed, show=True)[0]
    print("\n".join(part(*found, among).details))


if __name__ == "__main__":
    main()
