"""Regenerate arm.csv.gz: a log of the virtual test bench, in the columns and units of a drive's recorder.

Run it in this folder: python make_log.py
"""

import gzip
from pathlib import Path

import numpy as np

from eccentric.virtual_bench import random_scenario, simulate

COUNTS = 8192

scenario = random_scenario(
    np.random.default_rng(3), case="C2", mu=0.1, log_type="runs", effects=[("stribeck", 0.25)], seconds=40.0
)
log = simulate(scenario).columns
columns = (
    1e3 * log["time_s"],
    np.rint(log["theta_m_rad"] * COUNTS / (2 * np.pi)),
    log["omega_m_rad_s"] * 30 / np.pi,
    1e3 * log["current_A"],
)
rows = "".join(f"{t:.0f},{enc:.0f},{rpm:.1f},{mA:.0f}\n" for t, enc, rpm, mA in zip(*columns, strict=True))
Path("arm.csv.gz").write_bytes(
    gzip.compress(("Time (ms),Enc,Speed (rpm),Iq (mA)\n" + rows).encode(), mtime=0)
)
