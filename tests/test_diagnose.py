"""Close the loop: effects are found and added, a control is left alone, the unknown stays unnamed."""

import ast
import importlib.util
import inspect
import json
import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import cffi
import numpy as np
import pytest

from eccentric.bench import random_scenario, simulate, write
from eccentric.bench.effects.record import Effect, simply
from eccentric.cli import main
from eccentric.identify.channels import read_channels
from eccentric.identify.diagnose import diagnose
from eccentric.identify.rig import read_rig

ROOT = Path(__file__).resolve().parent.parent
LOG, RIG = ROOT / "examples" / "bench" / "bench.csv.gz", ROOT / "examples" / "bench" / "bench.json"
SHARED = ROOT.parent / "shared" / "data" / "examples"
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-Werror"]


@pytest.fixture(scope="module")
def bundled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that `eccentric diagnose` writes for the bundled log."""
    out = tmp_path_factory.mktemp("diagnosis") / "bench"
    assert 0 == main(["diagnose", str(LOG), "--rig", str(RIG), "--out", str(out)])
    return out


@pytest.fixture(scope="module")
def said(bundled: Path) -> dict[str, Any]:
    """Its diagnosis.json."""
    return json.loads((bundled / "diagnosis.json").read_text(encoding="utf-8"))


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
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    return module


def held_out_inputs(log: Path, rig: Path) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """All rows by the names of the emitted inputs, and which of them are held out."""
    channels = read_channels([log], read_rig(rig))
    assert channels.current is not None
    inputs = {
        "theta_m": channels.theta_m,
        "omega_m": channels.omega_m,
        "i": channels.current,
        "t": channels.t - channels.t[0],
        "alpha_m": channels.alpha_m,
    }
    if channels.temperature is not None:
        inputs["temperature"] = channels.temperature
    if channels.voltage is not None:
        inputs["u"] = channels.voltage
    return inputs, channels.score_rows


def rmse(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.asarray(values, float) ** 2)))


def test_emitted_numpy_reproduces_the_reported_error(bundled: Path, said: dict[str, Any]) -> None:
    """The emitted module of the extended model, run on the held-out rows, gives the reported error after."""
    module = module_of(bundled)
    inputs, rows = held_out_inputs(LOG, RIG)
    names = ("theta_m", "omega_m", "i", "alpha_m")
    residual = module.mechanical_residual(*(inputs[n][rows] for n in names))

    assert np.isclose(rmse(residual), said["rmse_holdout_Nm"]["mechanical"]["extended"], rtol=1e-9)


@pytest.mark.parametrize(
    ("real", "dtype", "tolerance"), [("double", np.float64, 1e-9), ("float", np.float32, 1e-3)]
)
def test_emitted_c_reproduces_the_reported_error(
    bundled: Path, said: dict[str, Any], tmp_path: Path, real: str, dtype: type, tolerance: float
) -> None:
    """The emitted C of the extended model, in both precisions, gives the reported error after."""
    source = next(bundled.glob("*_extended.c"))
    library = tmp_path / "extended.so"
    flags = [*STRICT, f"-DECCENTRIC_REAL={real}", "-O2", "-shared", "-fPIC"]
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


def test_model_script_prints_the_extended_derivation(bundled: Path) -> None:
    """model.py is a derivation: it runs by itself, and the effect is its last equation."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}
    command = [sys.executable, str(bundled / "model.py")]
    printed = subprocess.run(
        command, capture_output=True, text=True, check=True, env=environment, cwd=bundled
    ).stdout

    assert "link_harmonic_friction[n=2]" in printed.splitlines()[0]
    assert "Effect link_harmonic_friction[n=2]" in printed


def test_model_script_lists_its_channels_in_order(bundled: Path) -> None:
    """A set prints in another order in every run of Python; model.py is the same in all."""
    (channels,) = re.findall(
        r"channels=frozenset\((.*)\)", (bundled / "model.py").read_text(encoding="utf-8")
    )

    assert ["current", "voltage"] == ast.literal_eval(channels)


def log_of(tmp_path: Path, seed: int, *effects: tuple[str, float], **given: Any) -> tuple[Path, Path]:
    """A short log of the virtual bench; the sealed truth is deleted."""
    options = {"case": "C2", "mu": 0.2, "log_type": "runs", "noise": 0.006, "seconds": 40.0} | given
    scenario = random_scenario(np.random.default_rng(seed), effects=effects, **options)
    log, rig, truth = write(simulate(scenario), tmp_path / f"log{seed}.csv.gz")
    truth.unlink()
    return log, rig


@pytest.mark.parametrize(
    ("seed", "effect", "options"),
    [
        (9001, "stribeck", {}),
        (9002, "current_bias", {"case": "C1"}),
        (9003, "viscosity_temperature", {"temperature": True, "seconds": 60.0}),
    ],
    ids=["friction", "electrical", "temperature"],
)
def test_finds_effects_of_several_kinds(
    tmp_path: Path, seed: int, effect: str, options: dict[str, Any]
) -> None:
    """A torque, a bias in the electrical balance and a replaced coefficient are each named."""
    found = diagnose(*_listed(log_of(tmp_path, seed, (effect, 0.15), **options)))

    assert ("named", [effect]) == (found.attribution.verdict, [e.family for e, _ in found.effects])


def _listed(paths: tuple[Path, Path]) -> tuple[list[Path], Path]:
    return [paths[0]], paths[1]


def test_hidden_state_is_emitted_as_a_step(tmp_path: Path) -> None:
    """Unlogged heating is named; its state, stepped by the emitted code, gives the error after."""
    log, rig = log_of(tmp_path, 9007, ("hidden_thermal_drift", 0.2), seconds=60.0)
    out = tmp_path / "out"
    assert 0 == main(["diagnose", str(log), "--rig", str(rig), "--out", str(out)])
    said = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    module = module_of(out)
    inputs, rows = held_out_inputs(log, rig)
    inputs["dt"] = np.diff(inputs["t"], append=inputs["t"][-1] + 0.004)
    states = module.follow_states(*(inputs[n] for n in names_of(module.follow_states)))
    inputs |= dict(zip(module.STATES, states.T, strict=True))
    residual = module.mechanical_residual(*(inputs[n][rows] for n in names_of(module.mechanical_residual)))

    assert ["hidden_thermal_drift"] == [e["family"] for e in said["effects"]]
    # The diagnosis ran the state on the smoothed current, firmware runs it on the measured one.
    assert np.isclose(rmse(residual), said["rmse_holdout_Nm"]["mechanical"]["extended"], rtol=0.01)
    name = next(out.glob("*_extended.c")).stem
    ffi = cffi.FFI()
    given = names_of(module.follow_states)
    ffi.cdef(f"typedef struct {{ {' '.join(f'double {s};' for s in module.STATES)} }} {name}_state;"
             f"extern const {name}_state {name}_initial_state_double; extern char {name}_default_double;"
             f"void {name}_step_double({name}_state *, {'double, ' * len(given)} const void *);")  # fmt: skip
    subprocess.run(
        ["gcc", *STRICT, "-shared", "-fPIC", f"{name}.c", "-o", "step.so", "-lm"], check=True, cwd=out
    )
    compiled: Any = ffi.dlopen(str(out / "step.so"))
    state = ffi.new(f"{name}_state *", [0.0] * len(module.STATES))
    for k in range(1000):
        assert np.allclose([getattr(state, s) for s in module.STATES], states[k], rtol=1e-12, atol=0)
        step = getattr(compiled, f"{name}_step_double")
        step(state, *(float(inputs[n][k]) for n in given), ffi.addressof(compiled, f"{name}_default_double"))


def names_of(function: Any) -> list[str]:
    """The inputs of an emitted function, in order."""
    return [n for n in inspect.signature(function).parameters if n not in {"parameters", "out"}]


def test_leaves_a_control_alone(tmp_path: Path) -> None:
    """Without an undeclared effect nothing is missing, and the emitted model is the paper's."""
    found = diagnose(*_listed(log_of(tmp_path, 9004)))

    assert "nothing_missing" == found.attribution.verdict
    assert () == found.effects
    assert found.rmse["mechanical"]["paper"] == found.rmse["mechanical"]["extended"]


def test_leaves_the_unknown_unnamed(tmp_path: Path) -> None:
    """A friction that no library holds (a band of speed that resonates) gets no name, but its variable."""
    scenario = random_scenario(
        np.random.default_rng(9005),
        case="C2",
        mu=0.2,
        log_type="traj",
        effects=[("stribeck", 0.12)],
        noise=0.006,
    )
    top = 6.2 / 0.2

    def band(state: Any, amplitude: float) -> float:
        return amplitude * (1.0 if 0.35 * top < abs(state.w_mid) < 0.6 * top else 0.0)

    effect = Effect(
        "band", "band", 2 * scenario.effects[0].amplitude, simply(dry=band), ("velocity",), strength=0.12
    )
    log, rig, _ = write(simulate(replace(scenario, effects=(effect,))), tmp_path / "band.csv.gz")
    found = diagnose([log], rig)

    assert ("unexplained", ()) == (found.attribution.verdict, found.effects)
    assert "velocity" == found.attribution.depends_on[0]


def test_takes_an_effect_of_the_users_own(tmp_path: Path) -> None:
    """An effect in a user's file competes with the library, is named, and travels with the result."""
    own = tmp_path / "my_effects.py"
    own.write_text(
        '''"""A fourth-power drag."""
import sympy as sp
from eccentric.effects import Effect
from eccentric.model import Term, quantity, vocabulary as v

w = v.omega_m.symbol
D = quantity("my_drag_D", "N m s^4/rad^4", "fourth-power drag", "", "nonnegative")


def effects(setting):
    term = Term("my_drag", "friction", D.symbol, w**3 * sp.Abs(w), "own")
    return (Effect(id="my_drag", family="my_drag", balance="mechanical", depends_on=("velocity",),
                   formula="D w^3 |w|", reference="own", coefficients=(D,), bounds=((0.0, None),),
                   terms={"mechanical": (term,)}),)
''',
        encoding="utf-8",
    )
    scenario = random_scenario(
        np.random.default_rng(9006),
        case="C2",
        mu=0.2,
        log_type="runs",
        effects=[("stribeck", 0.12)],
        noise=0.004,
    )
    top = 7.5 / 0.2

    def fourth(state: Any, amplitude: float) -> float:
        return amplitude * (abs(state.w_mid) / top) ** 4

    effect = Effect(
        "fourth", "fourth", 4 * scenario.effects[0].amplitude, simply(dry=fourth), ("velocity",), strength=0.3
    )
    log, rig, _ = write(simulate(replace(scenario, effects=(effect,))), tmp_path / "fourth.csv.gz")
    out = tmp_path / "out"
    assert 0 == main(["diagnose", str(log), "--rig", str(rig), "--effects", str(own), "--out", str(out)])
    said = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))

    assert "my_drag" in [c["id"] for c in said["candidates"][:2]]
    assert (out / "my_effects.py").read_text(encoding="utf-8") == own.read_text(encoding="utf-8")
    assert (out / "model.py").is_file()


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_shared_examples_come_out_as_their_truth(number: int) -> None:
    """The development logs are diagnosed as their sealed truth says."""
    log = SHARED / f"example{number}.csv.gz"
    if not log.is_file():
        pytest.skip("the shared example logs are not beside this clone")
    truth = json.loads((SHARED / "truth.json").read_text(encoding="utf-8"))[f"example{number}"]["effects"]
    found = diagnose([log], SHARED / f"example{number}.json")

    assert {e["family"] for e in truth} == {e.family for e, _ in found.effects}
    assert ("named" if truth else "nothing_missing") == found.attribution.verdict
