"""Logs and rigs as files, and the channels that are read from them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from eccentric.rigs import Rig, read_rig
from eccentric.signals import Channels, read_channels

SHARED = Path(__file__).parents[1] / ".." / "shared" / "data"
RIGS = Path(__file__).parents[1] / "examples" / "rigs"
needs_shared = pytest.mark.skipif(not SHARED.exists(), reason="the shared logs are not beside this clone")

RATE = 250.0
T = np.arange(0.0, 12.0, 1.0 / RATE)
SWING = 2.0 * math.pi * 0.5
PHASE = 0.3
"""Keeps reversals off the sampling grid, where their side would be a matter of rounding."""
STANDARD = {
    "time_s": T,
    "theta_m_rad": 8.0 * np.sin(SWING * T + PHASE),
    "voltage_V": 3.0 * T,
    "current_A": np.cos(SWING * T),
}
RIG = '[known]\ncase = "C2"\nmu = 0.2\n'


def log_file(path: Path, columns: Mapping[str, Sequence[object] | NDArray[np.float64]]) -> Path:
    """Write columns as a CSV log, numbers to full precision."""
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(columns), *(",".join(str(value) for value in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n")
    return path


def rig_file(tmp_path: Path, text: str = RIG) -> Rig:
    """Write and read a rig."""
    path = tmp_path / "rig.toml"
    path.write_text(text)
    return read_rig(path)


def channels_of(tmp_path: Path, columns: Mapping[str, NDArray[np.float64]], rig: str = RIG) -> Channels:
    """Write a log and a rig and read the channels."""
    return read_channels([log_file(tmp_path / "log.csv", columns)], rig_file(tmp_path, rig))


MAPPED = '[columns]\ntime = "time_s"\ntheta_m = "theta_m_rad"\n'
