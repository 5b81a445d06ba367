"""The learning firmware of the example, on a computer: every sample in motion of ten million."""

import subprocess
from pathlib import Path
from typing import Any

import numpy as np

import eccentric
from tests.adapted import module
from tests.compiled import run

FIRMWARE = Path(__file__).resolve().parent.parent / "examples" / "firmware"
SAMPLES = 10_000_000
ROW = np.dtype([
    ("sample", "u4"), ("flags", "u4"), ("inputs", "f4", 4), ("learned", "f4", 4), ("real", "f4", 4)
])  # fmt: skip


def learned(folder: Path) -> tuple[str, np.ndarray, Any]:
    """Return what the firmware prints, its rows, and the emitted Python of its estimator."""
    out = folder / "learning"
    eccentric.emit("c2_parallel", out, parameters=FIRMWARE / "learn.json", adapt=True, settle=60)
    program, rows = folder / "learn", folder / "rows"
    sources = [FIRMWARE / "learn_on_a_computer.c", FIRMWARE / "learn.c"]
    sources += [out / "c2_parallel.c", out / "c2_parallel_adapt.c"]
    options = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror"]
    options += ["-DLEARN_ON_A_COMPUTER", "-DECCENTRIC_REAL=float"]
    run("gcc", *options, f"-I{FIRMWARE}", f"-I{out}", "-o", program, *sources, "-lm")
    done = subprocess.run([program, rows], capture_output=True, text=True, check=True)
    return done.stdout, np.fromfile(rows, ROW), module(out, "c2_parallel")


def errors(rows: np.ndarray, python: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return rms errors of the coefficients, learned and of weighted least squares over the same window."""
    rows = rows[(rows["flags"] & python.UPDATED > 0) & (rows["sample"] < SAMPLES)]
    theta, omega, alpha, i = (rows["inputs"][:, k].astype(float) for k in range(4))
    columns = np.asarray(python.model.regressor(theta, omega))
    own = np.asarray(python.model.friction_coefficients())
    torque = np.asarray(python.model.mechanical_residual(theta, omega, i, alpha)) + columns @ own
    weight = np.sqrt(0.999 ** np.arange(8000)[::-1])
    fitted, found = [], []
    for end in range(20_000, len(rows), 3163):
        window = slice(end - 8000, end)
        weighted = columns[window] * weight[:, None]
        size = np.linalg.norm(weighted, axis=0)
        best = np.linalg.lstsq(weighted / size, torque[window] * weight, rcond=None)[0] / size
        true = rows["real"][end - 1]
        fitted.append(best / true - 1)
        found.append(rows["learned"][end - 1] / true - 1)

    assert len(found) > 200
    error, least = (np.sqrt(np.mean(np.square(x), axis=0)) for x in (found, fitted))
    return error, least
