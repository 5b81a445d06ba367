"""Simulated motion agrees with closed forms, with an event-driven solution, and with the bundled log."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import eccentric
from eccentric.cli import main
from eccentric.effects import library
from eccentric.model import load_model
from eccentric.simulation import DrivePlant, Law, Recording, Spans, integrate, together, whole_runs, windows
from eccentric.simulation.plant import complete
from tests.extended import setting

ROOT = Path(__file__).resolve().parents[1]
LOG, RIG = (ROOT / "examples" / "bench" / name for name in ("bench.csv.gz", "bench.toml"))
ABSENT = ("M_l", "B_lN", "C_lN", "B_m", "C_m", "k_e", "B_lT", "C_lT", "F_T")
NONE: dict[str, Any] = {"R": 1.0, **dict.fromkeys(ABSENT, 0.0)}


def recording(t: np.ndarray, signal: np.ndarray | float, **changes: Any) -> Recording:
    """A log of one run that starts at rest at 0, driven by a signal."""
    zero, row = np.zeros(len(t)), np.zeros(len(t), np.int64)
    no = np.zeros(len(t), bool)
    inputs = {"signal": zero + signal, "t": t}
    given = {"theta_m": zero, "omega_m": zero, "alpha_m": zero, "measured": zero, **changes}
    return Recording(t=t, segment=row, run=row, inputs=inputs, off=no, held_out=~no, wanted=~no, **given)


def plant(model: str, gain: float = 1.0, damping: float = 0.0, **values: float) -> DrivePlant:
    """A plant of a shipped model; its signal is a torque unless there is a gain."""
    parameters = {**NONE, "M": 0.0, "L": 0.1, "mu": 1.0, "k_i": 1.0, "g": 9.81, "J_l": 0.0, **values}
    model_of = load_model(model)
    names = {q.name for q in model_of.parameters}
    return DrivePlant(Law(model_of), {k: x for k, x in parameters.items() if k in names}, gain, damping)


def run(drive: DrivePlant, log: Recording, **more: Any) -> np.ndarray:
    """The simulated angle of a whole log."""
    return integrate(drive, log, whole_runs(log), **more).theta_m


@pytest.mark.parametrize("step", [1e-3, 2.5e-4])
def test_a_coast_down_stops_when_coulomb_friction_has_taken_its_momentum(step: float) -> None:
    """From omega_0 it stops after omega_0 J/C, at omega_0^2 J/(2 C), and then not one bit moves."""
    J, C, omega_0 = 2e-3, 0.01, 3.0
    t = np.arange(0.0, 1.0, 2e-3)
    log = recording(t, 0.0, omega_m=np.full(len(t), omega_0))

    theta = run(plant("c1_perpendicular", J_m=J, C_m=C), log, longest_step_s=step)

    stops = omega_0 * J / C
    assert theta[-1] == pytest.approx(omega_0 * stops / 2.0, rel=2.0 * step / stops)
    assert len({*theta[t > stops + 2e-3].tolist()}) == 1
    moving = t < stops
    expected = omega_0 * t[moving] - 0.5 * C / J * t[moving] ** 2
    assert np.max(np.abs(theta[moving] - expected)) < omega_0 * step


def test_a_drive_within_its_levels_does_not_move() -> None:
    """Torques drawn anew in every row, within the Coulomb level less gravity, move nothing at all."""
    t = np.arange(0.0, 2.0, 1e-3)
    drive = plant("c2_parallel", J_m=1e-3, M=0.2, J_l=2e-3, C_m=0.05)
    hanging = 0.2 * 9.81 * 0.1 * np.sin(0.1)
    torque = hanging + np.random.default_rng(1).uniform(-0.049, 0.049, len(t))
    start = np.full(len(t), 0.1)

    theta = run(drive, recording(t, torque, theta_m=start))

    assert np.all(theta == 0.1)


def test_viscous_friction_and_back_emf_decay_exponentially() -> None:
    """J dw/dt = -(B + k_i k_e/R) w: the angle tends to omega_0 J/(B + k_i k_e/R)."""
    J, B, emf, omega_0 = 1e-3, 4e-3, 6e-3, 5.0
    t = np.arange(0.0, 1.0, 5e-3)
    log = recording(t, 0.0, omega_m=np.full(len(t), omega_0))

    theta = run(plant("c1_perpendicular", 1.0, emf, J_m=J, B_m=B), log, longest_step_s=1e-4)

    rate = (B + emf) / J
    expected = omega_0 / rate * (1.0 - np.exp(-rate * t))
    assert np.max(np.abs(theta - expected)) < 1e-3 * expected[-1]


def _swing(J: float, M: float, L: float, B: float, C: float, C_lN: float, theta_0: float) -> Any:
    """A pendulum with Coulomb friction that follows its bearing's load, event by event, in SciPy."""
    weight = M * 9.81

    def level(theta: float, omega: float) -> float:
        force = np.hypot(M * L * omega**2 + weight * np.cos(theta), weight * np.sin(theta))
        return C + C_lN * force

    t, y, sign, parts = 0.0, np.array([theta_0, 0.0]), -np.sign(np.sin(theta_0)), []
    while abs(weight * L * np.sin(y[0])) > level(y[0], 0.0):

        def slope(_: float, y: np.ndarray, sign: float = sign) -> list[float]:
            torque = -weight * L * np.sin(y[0]) - B * y[1] - sign * level(y[0], y[1])
            return [y[1], torque / J]

        def stops(_: float, y: np.ndarray, sign: float = sign) -> float:
            return sign * y[1] if _ > 0.0 else 1.0

        stops.terminal, stops.direction = True, -1  # pyright: ignore[reportFunctionMemberAccess]
        y = np.array([y[0], sign * 1e-12])
        part = solve_ivp(slope, (t, 20.0), y, events=stops, rtol=1e-10, atol=1e-12, dense_output=True)
        parts.append((t, part))
        t, y, sign = part.t[-1], part.y[:, -1], -sign
    return parts, t, y[0]


@pytest.mark.parametrize(("step", "bound"), [(1e-3, 4e-3), (1e-4, 4e-4)])
def test_a_swing_down_follows_an_event_driven_solution(step: float, bound: float) -> None:
    """Swings and the place of rest are those of SciPy with events, to first order in the step."""
    M, L, B, C, C_lN, theta_0 = 0.4, 0.2, 2e-3, 0.01, 0.01, 1.2
    J = M * L**2 + 1e-3
    parts, end, rest = _swing(J, M, L, B, C, C_lN, theta_0)
    t = np.arange(0.0, end + 1.0, 1e-2)
    log = recording(t, 0.0, theta_m=np.full(len(t), theta_0))

    theta = run(
        plant("c2_parallel", J_m=1e-3, J_l=M * L**2, M=M, L=L, B_m=B, C_m=C, C_lN=C_lN),
        log,
        longest_step_s=step,
    )

    expected = np.full(len(t), rest)
    for start, part in parts:
        inside = (t >= start) & (t <= part.t[-1])
        expected[inside] = part.sol(t[inside])[0]
    assert len(parts) > 4
    assert np.max(np.abs(theta - expected)) < bound * theta_0
    assert np.all(theta[t > end + 0.1] == theta[-1])


def test_parameter_sets_at_once_are_each_of_them_alone() -> None:
    """Three sets and several spans in one integration have the angles of nine integrations."""
    t = np.arange(0.0, 1.0, 4e-3)
    torque = 0.3 * np.sin(5.0 * t)
    values = {"J_m": 2e-3, "J_l": 4e-3, "M": 0.2}
    sets = [plant("c2_parallel", C_m=c, B_m=b, **values) for c, b in ((0.0, 0.01), (0.05, 0.0), (0.1, 0.01))]
    log = recording(t, torque)
    spans = Spans(np.array([0, 50, 10]), np.array([100, 199, 7]))

    found = integrate(together(sets), log, spans)

    for k, one in enumerate(sets):
        for span in range(3):
            alone = integrate(one, log, spans.chosen(np.arange(3) == span)).theta_m
            assert found.theta_m[k, found.span == span].tolist() == alone.tolist()


@pytest.mark.parametrize(
    "effect", ["stribeck[d=0.5]", "presliding[lugre]", "magnetic_hysteresis[play]", "viscosity_temperature"]
)
def test_a_span_alone_has_the_bits_of_one_of_many(effect: str) -> None:
    """Numbers and arrays: powers, exponentials, hidden states, bristles."""
    base = setting("C2", warm=True)
    (own,) = (one for one in library(base) if one.id == effect)
    model = own.extend(base.base)
    law, added = Law(model), {q.name: 0.003 for q in model.parameters if q not in base.base.parameters}
    shapes = {s.quantity.name: 0.5 * (s.low + s.high) for s in own.shapes}
    values = complete(model, {"J_m": 2e-4, "J_l": 0.035, **added, **shapes})
    t = np.arange(0.0, 0.5, 4e-3)
    log = recording(t, 0.6 * np.sin(9.0 * t))
    states = {name: np.full(len(t), x) for name, x in law.initial.items()}
    log = dataclasses.replace(log, inputs={**log.inputs, "temperature": 30.0 + t}, states=states)
    spans = Spans(np.zeros(9, int), np.full(9, len(t) - 1))

    alone, many = (
        integrate(DrivePlant(law, values, 1.0, 0.0), log, s).theta_m
        for s in (spans.chosen(np.zeros(1, int)), spans)
    )

    assert np.ptp(alone) > 0.1
    assert many.tolist() == [*alone.tolist()] * 9


@pytest.mark.parametrize("spans", [1, 9])
def test_a_motion_without_end_is_silent(spans: int) -> None:
    """A sine of an angle beyond all numbers is no number, in numbers and in arrays, without a warning."""
    t = np.arange(0.0, 0.1, 4e-3)
    law = Law(load_model("c2_parallel"))
    values = complete(load_model("c2_parallel"), {"J_m": 2e-4, "J_l": 0.035})

    many = Spans(np.zeros(spans, int), np.full(spans, len(t) - 1))
    found = integrate(DrivePlant(law, values, 1.0, 0.0), recording(t, np.full(len(t), 1e307)), many)

    assert not np.isfinite(found.theta_m[-1])


def test_windows_start_every_half_horizon_inside_the_held_out_part() -> None:
    """1 s held out of 3 s at 100 Hz: windows of 0.5 s at 1.00, 1.25 and 1.50 s, of 0.1 s every 0.05 s."""
    t = np.round(np.arange(0.0, 3.0, 0.01), 9)
    held = (t > 0.995) & (t < 2.005)
    log = dataclasses.replace(recording(t, 0.0), held_out=held)

    found, short = windows(log, 0.5, held), windows(log, 0.1, held)

    assert t[found.start].tolist() == [1.0, 1.25, 1.5]
    assert np.all(found.steps == 50)
    assert (19, 10) == (len(short), int(short.steps.max()))
    assert len(windows(log, 1.5, held)) == 0


def test_the_simulated_error_of_the_bundled_log_falls_to_a_fifth(tmp_path: Path) -> None:
    """Extended over paper is at most 0.2 at 0.1, 0.5 and 2 s; the files have what the table shows."""
    out = tmp_path / "simulated"

    assert main(["simulate", str(LOG), "--rig", str(RIG), "--out", str(out)]) == 0

    said = json.loads((out / "simulation.json").read_text(encoding="utf-8"))
    assert [0.1, 0.5, 2.0] == [one["horizon_s"] for one in said["horizons"]]
    for one in said["horizons"]:
        assert one["windows"] > 0
        assert one["errors"]["extended"] <= 0.2 * one["errors"]["paper"]
        assert one["errors"]["paper"] < one["errors"]["linear"]
    assert {"simulation.json", "simulation.png", "simulation.svg"} <= {path.name for path in out.iterdir()}


def test_compare_and_diagnose_have_the_same_figures() -> None:
    """The errors of a model over the horizons are those of `simulate`, in `compare` and in the report."""
    effect = "c2_parallel+link_harmonic_friction[n=2]"
    simulated = eccentric.simulate(LOG, RIG, ["c2_parallel", effect])
    compared = eccentric.compare(LOG, RIG, ["c2_parallel", effect])
    found = eccentric.diagnose(LOG, RIG, only="link_harmonic_friction")

    errors = [one["errors"] for one in simulated.document["horizons"]]
    assert errors == [one["errors"] for one in compared.document["simulated"]]
    by_diagnosis = [one["errors"] for one in found.document["simulated"]]
    for own, its in zip(errors, by_diagnosis, strict=True):
        assert own["c2_parallel"] == pytest.approx(its["paper"], rel=1e-6)
        assert own[effect] == pytest.approx(its["extended"], rel=1e-3)
    (bars,) = [e for e in found.data.errors.further if e.name.startswith("simulated") and "2 s" in e.name]
    assert dict(bars.rmse) == by_diagnosis[2]
    assert simulated.table()["model"] == ["Coulomb + viscous", "c2_parallel", effect]


@pytest.mark.parametrize(("case", "bound"), [("C1", 0.5), ("C2", 0.2)])
def test_a_model_of_the_virtual_bench_moves_as_its_plant(case: str, bound: float, tmp_path: Path) -> None:
    """Without effects the paper's model predicts 0.5 s far better than Coulomb + viscous friction."""
    eccentric.bench(case=case, seconds=30.0, seed=4, out=tmp_path / "log.csv.gz")
    model = {"C1": "c1_perpendicular", "C2": "c2_parallel"}[case]

    errors = eccentric.simulate(tmp_path / "log.csv.gz", tmp_path / "log.json", model).errors

    linear, paper = (m.horizons[1] for m in errors.models)
    assert linear is not None
    assert paper is not None
    assert paper < bound * linear


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["simulate", "no.csv", "--rig", str(RIG)], "no.csv"),
        (["simulate", str(LOG), "--rig", str(RIG), "c3_parallel"], "c3_parallel"),
    ],
)
def test_bad_input_is_one_line(arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    """A missing log and an unknown model are refused with status 2 and a line that names them."""
    assert main(arguments) == 2

    (line,) = capsys.readouterr().err.strip().splitlines()
    assert said in line


# What a controller makes is what drives, whatever the log has.


def swing_of_a_servo(drive: DrivePlant, logged: float) -> np.ndarray:
    """The angle of a drive whose controller always asks for 2 V, on a log of another voltage."""
    t = np.linspace(0.0, 0.3, 301)
    log = recording(t, logged)
    log = dataclasses.replace(log, inputs={**log.inputs, "u": log.inputs["signal"]}, by_voltage=True)
    return run(drive, log, feedback=_Constant(2.0))


@dataclasses.dataclass(frozen=True)
class _Constant:
    """A controller that always asks for the same."""

    value: float

    def signal(self, rows: np.ndarray, at: float, theta: np.ndarray, omega: np.ndarray) -> np.ndarray:
        """The value, whatever the state."""
        del rows, at, theta
        return np.full(np.shape(omega), self.value)


def with_armature(drive: DrivePlant) -> DrivePlant:
    """The same with a law that has the torque of changes in the armature."""
    return dataclasses.replace(drive, law=Law(drive.law.model, armature=True))


@pytest.mark.parametrize("armature", [False, True])
def test_a_controller_drives_whatever_was_logged(armature: bool) -> None:
    """Its voltage is that of the armature as well: two logs, one motion, of theta = k_i u t^2/(2 R J)."""
    drive = plant("c1_perpendicular", gain=0.1, k_i=0.1, R=1.0, k_e=0.0, J_m=0.02)
    drive = with_armature(drive) if armature else drive

    first, second = (swing_of_a_servo(drive, logged) for logged in (0.0, 5.0))

    assert np.array_equal(first, second)
    assert first[-1] == pytest.approx(0.1 * 2.0 * 0.3**2 / 2.0 / 0.02, rel=0.01)


@pytest.mark.parametrize("armature", [False, True])
def test_an_offset_of_the_signal_is_no_voltage(armature: bool) -> None:
    """A log that is off by 0.5 V moves the drive as one without it that has 0.5 V less."""
    drive = plant("c1_perpendicular", gain=0.1, k_i=0.1, R=1.0, k_e=0.0, J_m=0.02)
    drive = with_armature(drive) if armature else drive
    t = np.linspace(0.0, 0.3, 301)

    def moved(by: float, offset: float) -> np.ndarray:
        log = recording(t, by)
        log = dataclasses.replace(log, inputs={**log.inputs, "u": log.inputs["signal"]}, by_voltage=True)
        return run(dataclasses.replace(drive, offset=offset), log)

    assert moved(2.0, 0.5) == pytest.approx(moved(1.5, 0.0), rel=1e-12)


@pytest.mark.parametrize("closed", [False, True])
def test_a_load_acts_with_and_without_a_controller_and_with_the_motor_off(closed: bool) -> None:
    """0.05 N m less than 0.2 N m of the motor; alone where the motor is off."""
    drive = plant("c1_perpendicular", gain=0.1, k_i=0.1, R=1.0, k_e=0.0, J_m=0.02)
    drive = dataclasses.replace(drive, load=0.05)
    t = np.linspace(0.0, 0.3, 301)
    on = recording(t, 2.0)
    off = dataclasses.replace(on, off=np.ones(len(t), bool))
    feedback = {"feedback": _Constant(2.0)} if closed else {}

    assert run(drive, on, **feedback)[-1] == pytest.approx(0.15 * 0.3**2 / 2.0 / 0.02, rel=0.01)
    assert run(drive, off, **feedback)[-1] == pytest.approx(-0.05 * 0.3**2 / 2.0 / 0.02, rel=0.01)
