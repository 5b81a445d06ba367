"""The simulated carriage of examples/slide, which shares no code with the model, and a rig of it."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

SLIDE = Path(__file__).resolve().parents[1] / "examples" / "slide"
_made = runpy.run_path(str(SLIDE / "make_log.py"))
Carriage: Any = _made["Carriage"]
logged: Any = _made["logged"]

RIG: dict[str, Any] = {
    "kind": "linear",
    "name": "slide",
    "unknown": {"F_load_N": [-50, 50]},
    "columns": {"time": "t_s", "run": "run", "position": "q_m", "force": {"column": "u_V", "gain": "35 N/V"}},
}
TRUTH = {"mass": 95.0, "B": 203.0, "C": 20.0, "F_load": -3.0}
GIVEN = {**TRUTH, "R": 1.0, "k_f": 35.0, "k_e": 0.0}
"""Every parameter of its model."""
