"""`eccentric.bench_fleet`: a small fleet over some months, some of whose joints degrade."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from eccentric.virtual_bench import fleet_plan, write_fleet

__all__ = ["bench_fleet"]


def bench_fleet(
    out: str | os.PathLike[str],
    *,
    joints: int = 12,
    months: int = 6,
    degrading: int = 2,
    bad_sensors: int = 1,
    seconds: float = 40.0,
    rate_hz: float = 200.0,
    seed: int = 1,
    progress: Callable[[float], None] | None = None,
) -> dict[str, str]:
    """Write the logs of a fleet: prescribed motion, friction that follows a season, wear in some joints.

    Args:
        out: a new or empty folder for logs/joint=.../month=.../log.parquet, rigs.csv with its rig files, and
            the sealed truth.json.
        joints, months: how many.
        degrading: joints whose friction changes, in one of five ways by turns.
        bad_sensors: joints with an offset of the current or a stuck temperature, by turns.
        seconds: length of each log.
        rate_hz: rows a second.
        seed: of everything drawn at random; the same arguments give the same fleet.
        progress: told the part that is done.

    Returns:
        Joint -> what becomes of it, of those that change.

    Raises:
        InputError: a number is out of range, the folder holds anything, or pyarrow is not installed.
    """
    plan = fleet_plan(
        joints=joints,
        periods=months,
        degrading=degrading,
        bad_sensors=bad_sensors,
        seconds=seconds,
        rate_hz=rate_hz,
        seed=seed,
    )
    write_fleet(plan, Path(out), progress)
    return {joint.name: joint.way for joint in plan.joints if joint.way}
