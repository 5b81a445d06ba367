"""What `diagnose` takes besides the bundled rig, and what it refuses in one line."""

import ast
import gzip
import inspect
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import cffi
import numpy as np
import pytest

from eccentric.cli import main
from eccentric.diagnosis import Diagnosis, SearchRequest, diagnose
from eccentric.emission import executed
from eccentric.presentation import diagnosis_document, diagnosis_lines, diagnosis_sentence
from eccentric.presentation.html.gather import report_data
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from tests import screw
from tests.compiled import FLAGS
from tests.virtual import log_of

ROOT = Path(__file__).resolve().parent.parent
LOG, RIG, TOML = (ROOT / "examples" / "bench" / f"bench.{end}" for end in ("csv.gz", "json", "toml"))


def rig_with(tmp_path: Path, *changes: tuple[str, str]) -> Path:
    """The bundled rig with lines changed."""
    text = TOML.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "rig.toml").write_text(text, encoding="utf-8")
    return tmp_path / "rig.toml"


DRIVEN = {
    "a torque without motor constants": (
        ('drive = "current"', 'drive = "torque"'),
        ('voltage = "voltage_V"\ncurrent = "current_A"', 'torque = "current_A * 0.063"'),
        ('R = "1 ohm"\n', ""),
        ('k_i = "63 mNm/A"\n', ""),
        ('k_e = "0.063 V s/rad"\n', ""),
    ),
    "a voltage": (('drive = "current"', 'drive = "voltage"'), ('\ncurrent = "current_A"', "")),
    "a current, the zero angle open": (
        ('drive = "current"', 'drive = "current"\ntheta_zero_rad = "estimate"'),
        ('voltage = "voltage_V"\n', ""),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("by", DRIVEN)
def test_one_signal_alone_names_the_same_effect(by: str, tmp_path: Path) -> None:
    """In newton metres, and nothing is said of the armature."""
    found = diagnose([LOG], rig_with(tmp_path, *DRIVEN[by]))

    assert ["link_harmonic_friction"] == [effect.family for effect, _ in found.effects]
    assert ("N m", {"mechanical"}) == (found.unit, set(found.score.rmse))


@pytest.mark.slow
def test_zero_angle_and_offset_are_told_once_as_they_were_planted(tmp_path: Path) -> None:
    """Both are in the result once, under the rig's names; their intervals hold what was added to the log.

    The effect is named beside them.
    """
    rig = rig_with(
        tmp_path,
        (
            'drive = "current"',
            'drive = "voltage"\ntheta_zero_rad = "estimate"\nvoltage_offset_V = "estimate"',
        ),
        ('theta_m = "theta_m_rad"', 'theta_m = "theta_m_rad + 0.25"'),
        ('voltage = "voltage_V"\ncurrent = "current_A"', 'voltage = "voltage_V + 0.3"'),
    )
    found = diagnose([LOG], rig)
    assert ["link_harmonic_friction"] == [effect.family for effect, _ in found.effects]
    said = diagnosis_document(found)["rig_identified"]
    shown = {fact.name: fact.value for fact in report_data(found).log.facts}

    assert {"theta_zero_rad", "voltage_offset_V"} == set(said)
    # 0.25 rad at the motor are a fifth of that at the link.
    for name, label, planted in (
        ("theta_zero_rad", "zero angle", 0.25 / 5),
        ("voltage_offset_V", "voltage offset", 0.3),
    ):
        low, high = said[name]["interval_95"]
        assert low <= planted <= high
        assert f"{said[name]['value']:.4g}" == shown[label].split()[0]


@pytest.mark.slow
def test_logs_may_begin_at_any_time(tmp_path: Path) -> None:
    """Two logs, the later one with earlier time stamps, are two runs and not an error."""
    rig = rig_with(tmp_path, ("holdout_intervals_s", "# holdout_intervals_s"))

    lines = gzip.decompress(LOG.read_bytes()).decode().splitlines()
    shifted = [
        lines[0],
        *(f"{float(line.split(',')[0]) + 1000:.3f},{line.split(',', 1)[1]}" for line in lines[1:]),
    ]
    (tmp_path / "late.csv").write_text("\n".join(shifted[:9000]) + "\n", encoding="utf-8")
    (tmp_path / "early.csv").write_text("\n".join([lines[0], *lines[6000:]]) + "\n", encoding="utf-8")
    found = diagnose([tmp_path / "late.csv", tmp_path / "early.csv"], rig)

    assert ["link_harmonic_friction"] == [effect.family for effect, _ in found.effects]
    assert found.setting.duration_s < 61.0


def refused(command: str, arguments: Sequence[object], out: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """The one line with which a command ends, with status 2, before it writes anything."""
    status = main([command, *map(str, arguments), "--out", str(out)])
    error = [line for line in capsys.readouterr().err.splitlines() if "warning" not in line]

    assert (2, 1, False) == (status, len(error), out.exists())
    return error[0]


BENCH = (str(LOG), "--rig", str(TOML))
TWO = ("no.csv", "--rig", "no.toml", "--effects", "{tmp}/a/x.py", "--model", "{tmp}/b/x.py")
CHAIN = (
    "eccentric: error: model serial_chain: expected a mechanical balance of one drive,"
    " got mechanical_0, electrical_0, mechanical_1, electrical_1"
)
REFUSED = {
    "a name that is taken": (("diagnose",), (*BENCH, "--effects", "{tmp}/model.py"), "a name that no file"),
    "no effects there": (("diagnose",), (*BENCH, "--effects", "{tmp}/missing.py"), "missing.py"),
    # Both would be copied into the result by this name; the log is not even opened.
    "two scripts of a name": (
        ("diagnose",),
        TWO,
        "error: --effects and --model: expected files of different names, got x.py twice",
    ),
    "a model of another case": (
        ("fit", "diagnose"),
        (*BENCH, "--model", "c1_perpendicular"),
        f"error: {TOML}: model c1_perpendicular requires case C1, got case C2; c2_parallel fits it",
    ),
    # Its balances are one for each joint: that of a drive is what is missing.
    "a chain": (("fit", "diagnose"), (*BENCH, "--model", "serial_chain"), CHAIN),
    "a chain, compared": (("compare",), (*BENCH, "serial_chain"), CHAIN),
}


@pytest.mark.parametrize(
    ("command", "why"), [(command, why) for why, (commands, *_) in REFUSED.items() for command in commands]
)
def test_what_cannot_be_diagnosed_is_one_line(
    command: str, why: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The same from every command that takes it."""
    _, arguments, said = REFUSED[why]

    assert said in refused(command, [a.format(tmp=tmp_path) for a in arguments], tmp_path / "out", capsys)


@pytest.mark.parametrize("command", ["fit", "diagnose"])
def test_one_run_is_too_little_to_hold_out(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The error on one whole run has no interval: both commands require a second one with the same line."""
    rig, log = tmp_path / "rig.toml", screw.write_log(tmp_path / "log.csv", {})
    rig.write_text('holdout_runs = ["speed_6"]\n' + screw.RIG, encoding="utf-8")

    assert refused(command, [log, "--rig", rig], tmp_path / "out", capsys) == (
        "eccentric: error: log.csv: expected at least 2 moving whole runs to hold out, got 1:"
        f' in {rig}, a time, such as "0.1 s" as average_over gives more'
    )


@pytest.mark.parametrize("k_e", ["0.05", pytest.param("0.03", marks=pytest.mark.slow)])
def test_a_wrong_constant_of_the_rig_is_told_as_what_it_is(tmp_path: Path, k_e: str) -> None:
    """The sentence gives the quantity, its value by the log and that of the rig, and says it once."""
    rig = rig_with(tmp_path, ('k_e = "0.063 V s/rad"', f'k_e = "{k_e} V s/rad"'))
    mismatches = "ke_mismatch", "resistance_mismatch", "ki_mismatch", "mass_mismatch", "inertia_mismatch"
    few = SearchRequest(only=(*mismatches, "link_harmonic_friction", "kt_ripple", "stribeck", "cogging"))
    found = diagnose([LOG], rig, request=few if k_e == "0.05" else None)
    said = diagnosis_sentence(found)
    (value,) = re.findall(
        rf"k_e should be (\S+) V s/rad; the rig file has {k_e} V s/rad \(ke_mismatch,", said
    )

    # The bench has 0.063 V s/rad; its encoder and its low pass cost some per mille.
    assert float(value) == pytest.approx(0.063, rel=5e-3)
    assert 1 == said.lower().count("k_e")
    start, times = f'to correct in the rig file: k_e = "{value} V s/rad", ', " times the declared value"
    (line,) = (line for line in diagnosis_lines(found) if line.startswith(start))
    assert float(line[len(start) :].removesuffix(times)) == pytest.approx(float(value) / float(k_e), rel=1e-3)


# What `eccentric diagnose` writes: its figures, and code that gives the error it reports.


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
    ((torque, step),) = re.findall(r"then call in every cycle.*\n(.*)\n(.*)", shown)
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
