"""What `eccentric diagnose` writes: its figures, and code that gives the error it reports."""

import ast
import inspect
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import cffi
import numpy as np
import pytest

from eccentric.cli import main
from eccentric.diagnosis import Diagnosis
from eccentric.emission import executed
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from tests.compiled import FLAGS
from tests.virtual import log_of

ROOT = Path(__file__).resolve().parent.parent
LOG, RIG = ROOT / "examples" / "bench" / "bench.csv.gz", ROOT / "examples" / "bench" / "bench.json"


@pytest.fixture(scope="module")
def written(bundled: tuple[Diagnosis, Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that `eccentric diagnose` writes for the bundled log: a copy, in which scripts may run."""
    return shutil.copytree(bundled[1], tmp_path_factory.mktemp("diagnosis") / "bench")


@pytest.fixture(scope="module")
def said(written: Path) -> dict[str, Any]:
    """Its diagnosis.json."""
    return json.loads((written / "diagnosis.json").read_text(encoding="utf-8"))


def test_names_the_undeclared_effect_of_the_bundled_log(said: dict[str, Any]) -> None:
    """The sealed truth of the bundled log is what is named, its amplitude within three standard errors."""
    truth = json.loads((ROOT / "examples" / "bench" / "bench.truth.json").read_text(encoding="utf-8"))[
        "effects"
    ]
    (effect,) = said["effects"]
    amplitude = np.hypot(*(p["value"] for p in effect["parameters"].values()))
    error = np.hypot(*(p["std_error"] for p in effect["parameters"].values()))

    assert ("named", [e["family"] for e in truth]) == (said["verdict"], [effect["family"]])
    assert abs(amplitude - truth[0]["amplitude"]) <= 3 * error + 0.02 * truth[0]["amplitude"]
    assert "link_angle" == said["residual_depends_on"][0]


def test_held_out_error_falls_to_the_noise_of_the_sensors(said: dict[str, Any]) -> None:
    """With the effect the held-out error is that of the sensors; the interval excludes no gain."""
    errors = said["rmse_holdout_Nm"]["mechanical"]

    assert errors["extended"] < 1.05 * said["noise_floor_Nm"] < errors["paper"] < errors["linear"]
    assert np.isclose(said["improvement"]["percent"], 100 * (1 - errors["extended"] / errors["paper"]))
    assert 0 < said["improvement"]["interval_95"][0] < said["improvement"]["percent"]


def test_json_has_the_documented_keys(said: dict[str, Any]) -> None:
    """The format is stable: every documented key is there."""
    keys = {"format", "verdict", "effects", "candidates", "residual_depends_on", "next_measurement"}
    keys |= {"rmse_holdout_Nm", "improvement", "noise_floor_Nm", "holdout", "rows"}

    assert said["format"] == "eccentric-diagnosis/1"
    assert keys <= set(said)
    assert {"id", "family", "balance", "equation", "parameters", "share_of_friction_rms", "aliases"} <= set(
        said["effects"][0]
    )
    assert {"id", "family", "rmse_cross_validated", "probability"} <= set(said["candidates"][0])
    assert {"read", "used", "held_out", "rejected"} == set(said["rows"])


def module_of(folder: Path) -> ModuleType:
    """The emitted NumPy module of a diagnosis."""
    path = next(p for p in folder.glob("*_extended.py"))
    files = {p.name: p.read_text(encoding="utf-8") for p in (path, folder / "eccentric_runtime.py")}
    return executed(files, path.stem)


def held_out_inputs(log: Path, rig: Path) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """All rows by the names of the emitted inputs, and which of them are held out."""
    channels = read_channels([log], read_rig(rig))
    assert channels.motor.current is not None
    inputs = {
        "theta_m": channels.motion.theta_m,
        "omega_m": channels.motion.omega_m,
        "i": channels.motor.current,
        "t": channels.time.t - channels.time.t[0],
        "alpha_m": channels.motion.alpha_m,
    }
    if channels.temperature is not None:
        inputs["temperature"] = channels.temperature
    if channels.motor.voltage is not None:
        inputs["u"] = channels.motor.voltage
    return inputs, channels.selection.score_rows


def rmse(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.asarray(values, float) ** 2)))


def names_of(function: Any) -> list[str]:
    """The inputs of an emitted function, in order."""
    return [n for n in inspect.signature(function).parameters if n not in {"parameters", "out"}]


def test_emitted_numpy_reproduces_the_reported_error(written: Path, said: dict[str, Any]) -> None:
    """The emitted module of the extended model, run on the held-out rows, gives the reported error after."""
    module = module_of(written)
    inputs, rows = held_out_inputs(LOG, RIG)
    names = ("theta_m", "omega_m", "i", "alpha_m")
    residual = module.mechanical_residual(*(inputs[n][rows] for n in names))

    assert np.isclose(rmse(residual), said["rmse_holdout_Nm"]["mechanical"]["extended"], rtol=1e-9)


@pytest.mark.parametrize(
    ("real", "dtype", "tolerance"), [("double", np.float64, 1e-9), ("float", np.float32, 1e-3)]
)
def test_emitted_c_reproduces_the_reported_error(
    written: Path, said: dict[str, Any], tmp_path: Path, real: str, dtype: type, tolerance: float
) -> None:
    """The emitted C of the extended model, in both precisions, gives the reported error after."""
    source = next(written.glob("*_extended.c"))
    library = tmp_path / "extended.so"
    flags = [*FLAGS, f"-DECCENTRIC_REAL={real}", "-shared", "-fPIC"]
    subprocess.run(["gcc", *flags, str(source), "-o", str(library), "-lm"], check=True)
    ffi = cffi.FFI()
    name = source.stem
    ffi.cdef(f"extern char {name}_default_{real};"
             f"void {name}_mechanical_residual_n_{real}(size_t n, const {real} *a,"
             f" const {real} *b, const {real} *c, const {real} *d, {real} *out, const void *k);")  # fmt: skip
    compiled: Any = ffi.dlopen(str(library))
    inputs, rows = held_out_inputs(LOG, RIG)
    columns = [np.ascontiguousarray(inputs[n][rows], dtype) for n in ("theta_m", "omega_m", "i", "alpha_m")]
    out = np.empty(len(columns[0]), dtype)
    pointers = [ffi.cast(f"{real} *", x.ctypes.data) for x in (*columns, out)]
    function = getattr(compiled, f"{name}_mechanical_residual_n_{real}")
    function(len(out), *pointers, ffi.addressof(compiled, f"{name}_default_{real}"))

    assert np.isclose(rmse(out), said["rmse_holdout_Nm"]["mechanical"]["extended"], rtol=tolerance)


def test_model_script_prints_the_extended_derivation(written: Path) -> None:
    """model.py is a derivation: it runs by itself, and the effect is its last equation."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}
    command = [sys.executable, str(written / "model.py")]
    printed = subprocess.run(
        command, capture_output=True, text=True, check=True, env=environment, cwd=written
    ).stdout

    assert "link_harmonic_friction[n=2]" in printed.splitlines()[0]
    assert "Effect link_harmonic_friction[n=2]" in printed


def test_model_script_lists_its_channels_in_order(written: Path) -> None:
    """A set prints in another order in every run of Python; model.py is the same in all."""
    (channels,) = re.findall(
        r"channels=frozenset\((.*)\)", (written / "model.py").read_text(encoding="utf-8")
    )

    assert ["current", "voltage"] == ast.literal_eval(channels)


@pytest.mark.slow
def test_hidden_state_is_emitted_as_a_step(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Unlogged heating is named; its state, stepped by the emitted code, gives the error after.

    The summary and the header name the step and what it advances.
    """
    log, rig = log_of(tmp_path, 9007, ("hidden_thermal_drift", 0.2), seconds=60.0)
    out = tmp_path / "out"
    assert 0 == main(["diagnose", str(log), "--rig", str(rig), "--out", str(out)])
    said = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    module = module_of(out)
    shown = capsys.readouterr().out
    ((torque, step),) = re.findall(r"to call in every cycle.*\n(.*)\n(.*)", shown)
    (state,) = module.STATES
    name = next(out.glob("*_extended.c")).stem
    assert torque.startswith(f"  {name}_mechanical_friction_torque(theta_m, omega_m, state.{state}")
    assert step.startswith(f"  {name}_step(&state, ")
    header = (out / f"{name}.h").read_text(encoding="utf-8")
    assert f"call {name}_step in every cycle: it advances" in header.split("#ifndef")[0]
    assert re.search(rf"@param\[in\]  {state}  .*, a hidden state, which {name}_step advances", header)
    inputs, rows = held_out_inputs(log, rig)
    inputs["dt"] = np.diff(inputs["t"], append=inputs["t"][-1] + 0.004)
    states = module.follow_states(*(inputs[n] for n in names_of(module.follow_states)))
    inputs |= dict(zip(module.STATES, states.T, strict=True))
    residual = module.mechanical_residual(*(inputs[n][rows] for n in names_of(module.mechanical_residual)))

    assert ["hidden_thermal_drift"] == [e["family"] for e in said["effects"]]
    # The diagnosis ran the state on the smoothed current, firmware runs it on the measured one.
    assert np.isclose(rmse(residual), said["rmse_holdout_Nm"]["mechanical"]["extended"], rtol=0.01)
    ffi = cffi.FFI()
    given = names_of(module.follow_states)
    ffi.cdef(f"typedef struct {{ {' '.join(f'double {s};' for s in module.STATES)} }} {name}_state;"
             f"extern const {name}_state {name}_initial_state_double; extern char {name}_default_double;"
             f"void {name}_step_double({name}_state *, {'double, ' * len(given)} const void *);")  # fmt: skip
    subprocess.run(
        ["gcc", *FLAGS, "-shared", "-fPIC", f"{name}.c", "-o", "step.so", "-lm"], check=True, cwd=out
    )
    compiled: Any = ffi.dlopen(str(out / "step.so"))
    state = ffi.new(f"{name}_state *", [0.0] * len(module.STATES))
    for k in range(1000):
        assert np.allclose([getattr(state, s) for s in module.STATES], states[k], rtol=1e-12, atol=0)
        step = getattr(compiled, f"{name}_step_double")
        step(state, *(float(inputs[n][k]) for n in given), ffi.addressof(compiled, f"{name}_default_double"))
