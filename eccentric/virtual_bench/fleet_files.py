"""FleetPlan -> a folder: logs/joint=.../month=.../log.parquet, rigs.csv, rig files, truth.json (sealed)."""

from __future__ import annotations

import csv
import importlib
import io
import json
from collections.abc import Callable
from pathlib import Path

from eccentric.errors import InputError
from eccentric.output import own_folder, whole_folder
from eccentric.virtual_bench.fleet import FleetPlan

_RIG = """# A kind of joint of the fleet; values of their own are in rigs.csv.
drive = "current"
encoder_counts_per_rev = 32768
low_pass_hz = 25.0

[columns]
time = "time_s"
theta_m = "theta_m_rad"
current = "current_A"
temperature = "temperature_C"

[known]
case = "C2"
g_m_s2 = 9.81
"""
_KEYS = {
    "M": "M_kg",
    "M_l": "M_l_kg",
    "L": "L_m",
    "mu": "mu",
    "k_i": "k_i_Nm_per_A",
    "J_m": "J_m_kgm2",
    "J_l": "J_l_kgm2",
}


def write_fleet(plan: FleetPlan, path: str | Path, progress: Callable[[float], None] | None = None) -> Path:
    """Write a fleet into a new or empty folder, whole or not at all; `progress` is called with the part done.

    Raises InputError if pyarrow is not installed, or the folder holds anything.
    """
    try:
        arrow, parquet = (importlib.import_module(name) for name in ("pyarrow", "pyarrow.parquet"))
    except ImportError:
        raise InputError('fleet: pyarrow is required: pip install "eccentric[fleet]"') from None
    target = own_folder(path)
    if target.exists() and any(target.iterdir()):
        raise InputError(f"{path}: a new or empty folder is required")
    total = len(plan.joints) * len(plan.periods)
    with whole_folder(path, "bench --fleet") as new:
        for done, (joint, period) in enumerate(plan.logs()):
            place = new / "logs" / f"joint={joint.name}" / f"month={plan.periods[period]}" / "log.parquet"
            place.parent.mkdir(parents=True)
            parquet.write_table(arrow.table(plan.log(joint, period)), place)
            if progress is not None and done % 20 == 0:
                progress(done / total)
        for kind in sorted({joint.kind for joint in plan.joints}):
            (new / f"{kind}.toml").write_text(_RIG, encoding="utf-8")
        (new / "rigs.csv").write_text(_table(plan), encoding="utf-8")
        (new / "truth.json").write_text(json.dumps(plan.truth(), indent=1) + "\n", encoding="utf-8")
    if progress is not None:
        progress(1.0)
    return Path(path)


def _table(plan: FleetPlan) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["joint", "rig", *_KEYS.values()])
    for joint in plan.joints:
        values = (f"{joint.known[letter]:.9g}" for letter in _KEYS)
        writer.writerow([joint.name, f"{joint.kind}.toml", *values])
    return text.getvalue()
