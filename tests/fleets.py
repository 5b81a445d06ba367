"""Small fleets for the tests: logs of the virtual bench in Parquet, and their rigs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eccentric.rigs import Rig, read_rig
from eccentric.virtual_bench import FleetJoint, FleetPlan, fleet_plan

COLUMNS = {"time": "time_s", "theta_m": "theta_m_rad", "current": "current_A", "temperature": "temperature_C"}
KEYS = {"M": "M_kg", "M_l": "M_l_kg", "L": "L_m", "mu": "mu", "k_i": "k_i_Nm_per_A"} | {
    "J_m": "J_m_kgm2",
    "J_l": "J_l_kgm2",
}


def one_joint(seconds: float = 40.0, **changes: Any) -> tuple[FleetPlan, FleetJoint]:
    """A plan of one healthy joint, with some of its fields changed."""
    plan = fleet_plan(joints=1, periods=1, degrading=0, seconds=seconds)
    return plan, replace(plan.joints[0], **changes)


def rig_of(joint: FleetJoint, **keys: Any) -> Rig:
    """The rig of a joint, with other keys at the top level, or in [known] or [columns]."""
    known = {"case": "C2", "g_m_s2": 9.81} | {KEYS[k]: joint.known[k] for k in KEYS}
    known |= keys.pop("known", {})
    columns = COLUMNS | keys.pop("columns", {})
    columns = {channel: name for channel, name in columns.items() if name is not None}
    return read_rig({"encoder_counts_per_rev": 32768, "known": known, "columns": columns} | keys)


def write_log(path: Path, columns: dict[str, Any], group: int | None = None) -> Path:
    """Write columns as Parquet, optionally in groups of so many rows."""
    arrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    path.parent.mkdir(parents=True, exist_ok=True)
    parquet.write_table(
        arrow.table({k: np.asarray(x) for k, x in columns.items()}), path, row_group_size=group
    )
    return path
