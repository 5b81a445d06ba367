"""The residuals of a log, with the columns that a sparse regression can have of the library's effects.

What has a hidden state (backlash, presliding, magnetic hysteresis) has no column; shapes are on a grid.
"""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks import environment
from eccentric.diagnosis import Diagnosis
from eccentric.identification import base_columns

Array = np.ndarray
ORDERS = range(1, 13)
PEER = Path(__file__).resolve().with_name("sparse_peer.py")


def write(found: Diagnosis, path: Path) -> None:
    """Write residuals of the paper's model, its own columns, those of effects, and which rows are fitted."""
    rows, own = found.data.rows, found.models.paper.residuals
    signals = {name: rows.mean(x) for name, x in found.data.signals.values.items()}
    signals["gravity"] = rows.mean(found.data.gravity)
    signals["inertia"] = signals["alpha_m"] * _inertia(found)
    content: dict[str, Array] = {"train": rows.train, "score": rows.score}
    for balance, columns in (("mechanical", _mechanical), ("electrical", _electrical)):
        if balance in own:
            families, values = zip(*columns(signals, found.data.signals.known["mu"]), strict=True)
            content |= {
                f"{balance}_families": np.array(families),
                f"{balance}_columns": np.column_stack(values),
            }
            content[f"{balance}_residual"] = own[balance]
    content["mechanical_base"] = rows.mean(base_columns(found.models.base, found.data.signals))
    content["electrical_base"] = np.empty((len(rows.train), 0))
    np.savez(path, **content)  # pyright: ignore[reportArgumentType]


def answers(folder: Path) -> dict[str, dict]:
    """What PySINDy says of every log in a folder: name -> {"ranked": families, "rmse": balance -> N m}.

    Raises:
        RuntimeError: it cannot be installed, or fails.
    """
    if reasons := environment.absent("numpy", "pysindy"):
        raise RuntimeError("; ".join(f"{package}: left out, {reason}" for package, reason in reasons.items()))
    done = subprocess.run(
        [environment.PYTHON, PEER, folder],
        env=os.environ | {"OMP_NUM_THREADS": "1"},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode:
        raise RuntimeError((done.stderr.strip().splitlines() or ["PySINDy: no result"])[-1])
    return json.loads(done.stdout.splitlines()[-1])


def _inertia(found: Diagnosis) -> float:
    known = found.data.signals.known
    return known["J_m"] + known["mu"] ** 2 * known["J_l"]


def _mechanical(x: dict[str, Array], mu: float) -> Iterator[tuple[str, Array]]:
    w, motor, link, i, t = x["omega_m"], x["theta_m"], mu * x["theta_m"], x["i"], x["t"] / x["t"].max()
    sign, size, top = np.sign(w), np.abs(w), np.abs(w).max()
    load = x["gravity"] + x["inertia"]
    for part in (0.02, 0.05, 0.1, 0.2):
        yield "stribeck", sign * np.exp(-size / (part * top))
    yield from (("quadratic_drag", w * size), ("cubic_drag", w**3), ("viscous_asymmetry", size))
    yield from (("oneway_windage", w * size * (w > 0)), ("coulomb_asymmetry", np.ones_like(w)))
    for part in (0.1, 0.3):
        yield "eddy_current", w / (1 + (w / (part * top)) ** 2)
        yield "hidden_thermal_drift", w * np.exp(-t / part)
        yield "wear_runin", sign * np.exp(-t / part)
    yield "time_drift", sign * t
    if "temperature" in x:
        warm = x["temperature"] - x["temperature"].mean()
        yield from (("viscosity_temperature", w * warm), ("coulomb_temperature", sign * warm))
    for k in ORDERS:
        for wave in (np.cos, np.sin):
            yield from (("cogging", wave(k * motor)), ("kt_ripple", i * wave(k * motor)))
            yield "link_harmonic_friction", sign * wave(k * link)
    for place in np.linspace(0, 2 * np.pi, 12, endpoint=False):
        yield "local_defect", sign * np.exp((np.cos(link - place) - 1) / 0.3**2)
    yield from (("cable_spring", link), ("gravity_tilt", np.cos(link)), ("mass_mismatch", np.sin(link)))
    yield from (("inertia_mismatch", x["inertia"]), ("kt_saturation", i**3))
    yield from (("load_dependent", sign * np.abs(x["gravity"])), ("load_dependent", sign * np.abs(load)))
    yield "gear_efficiency", sign * np.abs(load) * (load * w > 0)


def _electrical(x: dict[str, Array], _: float) -> Iterator[tuple[str, Array]]:
    i = x["i"]
    yield from (
        ("current_bias", np.ones_like(i)),
        ("inverter_deadtime", np.sign(i)),
        ("ke_mismatch", x["omega_m"]),
    )
    yield "sensor_delay", np.gradient(i, x["t"])
    if "temperature" in x:
        yield "resistance_temperature", i * (x["temperature"] - x["temperature"].mean())
