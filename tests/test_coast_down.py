"""Coast-downs, each solved in closed form, with the angle as an encoder of 4096 counts shows it."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import eccentric
from eccentric.core import InputError
from tests.logged import SHARED, needs_shared

J = 0.002
KNOWN = {"case": "C1", "mu": 1, "M": "0 kg", "L": "0 m"}
INERTIA = {"J_m": f"{J} kg m^2", "J_l": "0 kg m^2"}
RIG = {"drive": "none", "known": KNOWN}
COUNTS = 4096


def log_of(t: np.ndarray, theta: np.ndarray) -> dict[str, np.ndarray]:
    """Time and angle, rounded to whole counts."""
    step = 2.0 * np.pi / COUNTS
    return {"time_s": t, "theta_m_rad": np.round(theta / step) * step}


def with_viscous(b: float, c: float, start: float, rate: float = 200.0) -> dict[str, np.ndarray]:
    """W' = -c - b w: w = (w_0 + c/b) exp(-b t) - c/b, down to a fiftieth of the start."""
    stop = np.log((start + c / b) / (start / 50.0 + c / b)) / b
    t = np.arange(0.0, stop, 1.0 / rate)
    return log_of(t, (start + c / b) / b * (1.0 - np.exp(-b * t)) - c / b * t)


def with_drag(c: float, d: float, start: float, rate: float = 200.0) -> dict[str, np.ndarray]:
    """W' = -c - d w^2: w = sqrt(c/d) tan(phi - sqrt(c d) t), tan(phi) = w_0 sqrt(d/c)."""
    root, phi = np.sqrt(c * d), np.arctan(start * np.sqrt(d / c))
    stop = (phi - np.arctan(start / 50.0 * np.sqrt(d / c))) / root
    t = np.arange(0.0, stop, 1.0 / rate)
    return log_of(t, np.log(np.cos(phi - root * t) / np.cos(phi)) / d)


def inside(found: eccentric.FitResult, name: str, value: float) -> bool:
    """Whether an interval contains a value, up to the rounding of the angle."""
    low, high = found.estimates[name].interval
    return bool(low - 1e-3 * value <= value <= high + 1e-3 * value)


@pytest.mark.parametrize(("known", "inertia"), [(INERTIA, J), ({}, 1.0)], ids=["J declared", "decelerations"])
def test_coulomb_and_viscous_friction_come_out(known: dict[str, str], inertia: float) -> None:
    """In newton metres with an inertia, else over it: in rad/s^2 and 1/s."""
    found = eccentric.fit(with_viscous(0.05, 0.8, 120.0), {**RIG, "known": {**KNOWN, **known}})

    assert found.estimates["B"].value == pytest.approx(0.05 * inertia, rel=2e-3)
    assert found.estimates["C"].value == pytest.approx(0.8 * inertia, rel=2e-3)
    assert inside(found, "B", 0.05 * inertia)
    assert inside(found, "C", 0.8 * inertia)
    units = {"B": "N m s/rad", "C": "N m"} if known else {"B": "1/s", "C": "rad/s^2"}
    assert {name: found.estimates[name].unit for name in units} == units
    assert found.r_squared["paper"] > 0.999
    assert any("coasting down" in line for line in found.lines)
    assert bool(known) != any("no inertia is declared" in line for line in found.lines)


def test_the_emitted_model_of_a_coast_down_has_its_inertia() -> None:
    """With the declared inertia the emitted friction is in newton metres; without, that of 1 kg m^2."""
    log = with_viscous(0.05, 0.8, 120.0)
    declared = eccentric.fit(log, {**RIG, "known": {**KNOWN, **INERTIA}}).module
    plain = eccentric.fit(log, RIG).module
    for module, inertia in ((declared, J), (plain, 1.0)):
        torque = module.mechanical_friction_torque(50.0)
        assert torque == pytest.approx(inertia * (0.8 + 0.05 * 50.0), rel=2e-3)


def test_the_free_cubic_has_the_drag() -> None:
    """c_0 and c_2 are those of the motion, c_1 and c_3 may be 0; the lines say what it does not separate."""
    found = eccentric.fit(with_drag(0.6, 2e-4, 150.0), RIG)
    cubic = found.document["free_cubic"]

    for name, value in (("c_0", 0.6), ("c_1", 0.0), ("c_2", 2e-4), ("c_3", 0.0)):
        low, high = cubic[name]["interval_95"]
        assert low <= value <= high, name
    assert cubic["c_2"]["value"] == pytest.approx(2e-4, rel=0.05)
    assert any("does not separate air drag" in line for line in found.lines)


def test_quadratic_drag_is_diagnosed(tmp_path: Path) -> None:
    """Without a viscous part; one direction does not show whether the other has the drag as well.

    The tie goes with the model: into its script, and into the header.
    """
    parts = [with_drag(0.6, 2e-4, start) for start in (150.0, 120.0, 140.0, 130.0, 145.0)]
    log = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    log["run"] = np.repeat(np.arange(5.0), [len(part["time_s"]) for part in parts])
    found = eccentric.diagnose(log, {**RIG, "known": {**KNOWN, **INERTIA}})

    assert found.verdict == "not_identifiable"
    assert {"quadratic_drag", "oneway_windage"} == set(found.document["tied"])
    leading = found.document["candidates"][:2]
    assert [one["probability"] for one in leading] == pytest.approx([0.5, 0.5], abs=0.01)
    found.write(tmp_path / "out")
    loaded = eccentric.load_model(tmp_path / "out" / "model.py")
    assert loaded.caution == found.model.caution
    assert all(family in loaded.caution for family in found.document["tied"])
    (header,) = (tmp_path / "out").glob("*.h")
    assert f" * Caution: {loaded.caution}.\n" in header.read_text(encoding="utf-8")


def test_what_sped_it_up_is_left_out() -> None:
    """A spin-up before the coast-down has other torques: the coefficients stay those of the coast-down."""
    log = with_viscous(0.05, 0.8, 120.0)
    t = np.arange(0.0, 10.0, 0.005)
    up = log_of(t, 6.0 * t**2)
    log = {
        "time_s": np.concatenate([up["time_s"], 10.0 + log["time_s"]]),
        "theta_m_rad": np.concatenate([up["theta_m_rad"], 600.0 + log["theta_m_rad"]]),
    }
    found = eccentric.fit(log, RIG)

    assert found.estimates["B"].value == pytest.approx(0.05, rel=0.02)
    assert found.estimates["C"].value == pytest.approx(0.8, rel=0.02)


def test_gravity_gives_the_inertia_of_a_pendulum() -> None:
    """A large swing that nothing drives, from a known M g L; the motion is that of SciPy's integrator."""
    t = np.arange(0.0, 40.0, 0.004)
    mass, arm, inertia, damping = 0.4, 0.25, 0.03, 0.004

    def slope(_: float, state: np.ndarray) -> list[float]:
        return [state[1], -(mass * 9.81 * arm * np.sin(state[0]) + damping * state[1]) / inertia]

    swing = solve_ivp(slope, (0.0, t[-1]), [2.6, 0.0], t_eval=t, rtol=1e-10, atol=1e-10)
    known = {"case": "C2", "mu": 1, "M": f"{mass} kg", "L": f"{arm} m", "M_l": "0 kg"}
    log = {"time_s": t, "theta_m_rad": swing.y[0]}
    found = eccentric.fit(log, {"drive": "none", "known": known})

    assert found.estimates["J"].value == pytest.approx(inertia, rel=0.01)


def test_a_log_that_slows_down_is_drafted_as_a_coast_down() -> None:
    """The supply that idles beside it is no drive; with the mass the draft can be fitted as it stands."""
    log = with_viscous(0.05, 0.8, 120.0)
    up = np.arange(0.0, 10.0, 0.005)
    time = np.concatenate([up, 10.0 + log["time_s"]])
    angle = np.concatenate([6.0 * up**2, 600.0 + log["theta_m_rad"]])
    speed = np.gradient(angle, time) * 30.0 / np.pi
    log = {"time_s": time, "theta_m_rad": angle, "supply_V": np.full(len(time), 29.98), "speed_rpm": speed}
    draft = eccentric.draft_rig(log)
    rig = tomllib.loads(draft.text)
    rig["known"] |= KNOWN

    assert rig["drive"] == "none"
    assert "supply_V" in draft.left_out
    assert () == eccentric.check_rig(log, rig).complaints
    assert eccentric.fit(log, rig).estimates["C"].value == pytest.approx(0.8, rel=0.05)


def test_a_speed_along_the_rim_is_no_speed_of_the_shaft() -> None:
    """Turns and km/h are logged: without the radius the shaft's speed is the slope of the turns."""
    log = with_viscous(0.05, 0.8, 120.0)
    speed = np.gradient(log["theta_m_rad"], log["time_s"])
    named = {
        "time_s": log["time_s"],
        "drum_turns": log["theta_m_rad"] / (2.0 * np.pi),
        "speed_kmh": 0.6 * speed,
    }
    draft = eccentric.draft_rig(named)
    rig = tomllib.loads(draft.text)

    assert rig["columns"]["theta_m"] == {"column": "drum_turns", "unit": "rev"}
    assert "speed_kmh" in draft.left_out
    assert "kind" not in rig


def test_a_drive_that_is_none_of_these_is_refused() -> None:
    """The message lists "none" with the others."""
    with pytest.raises(InputError, match="one of current, voltage, torque, none"):
        eccentric.fit(with_viscous(0.05, 0.8, 120.0), {**RIG, "drive": "nothing"})


TURNS = {**RIG, "events": "revolution"}
DATA = SHARED / "field" / "logs"


def turn_times(c: float, start: float, extra: float = 0.0) -> np.ndarray:
    """Times of turns under w' = -c from w_0, shifted by a part of a turn: w_0 t - c t^2/2 = 2 pi k."""
    k = np.arange(extra, start**2 / (4.0 * np.pi * c) * 0.99)
    return 2.0 * (2.0 * np.pi * k) / (start + np.sqrt(start**2 - 4.0 * np.pi * c * k))


def test_times_of_turns_are_a_coast_down() -> None:
    """One row a turn and no angle: the deceleration of the closed form comes out, and no viscous part."""
    found = eccentric.fit({"time_s": turn_times(0.5, 60.0)}, TURNS)

    assert found.estimates["C"].value == pytest.approx(0.5, rel=1e-3)
    assert found.estimates["B"].interval[0] <= 1e-5
    assert found.document["rows"]["read"] == len(turn_times(0.5, 60.0))


@pytest.mark.parametrize("late", [False, True])
def test_rows_of_two_shafts_with_missed_and_double_events(late: bool) -> None:
    """A row for the turn of either, with both counts, before or after it; each shaft has its own."""
    c, speeds = {"slow": 0.4, "fast": 0.9}, {"slow": 50.0, "fast": 113.0}
    times = {name: turn_times(c[name], speeds[name], extra=0.3) for name in c}
    times["slow"] = np.delete(times["slow"], [40, 90])
    times["fast"] = np.sort(np.append(times["fast"], times["fast"][60] + 0.3 * np.diff(times["fast"])[60]))
    t = np.concatenate(list(times.values()))
    own = np.repeat([0, 1], [len(x) for x in times.values()])[np.argsort(t)]
    log = {"time_s": np.sort(t)}
    for k, name in enumerate(times):
        turns = np.cumsum(own == k).astype(float)
        log[name] = np.concatenate([[0.0], turns[:-1]]) if late else turns
    for name, value in c.items():
        column = {"time": "time_s", "theta_m": {"column": name, "unit": "rev"}}
        found = eccentric.fit(log, {**TURNS, "columns": column})

        assert found.estimates["C"].value == pytest.approx(value, rel=2e-3), name
        assert late == any("counts late" in line for line in found.warnings)
        mended = "2 missed" if name == "slow" else "1 doubled"
        assert any(mended in line for line in found.warnings), name


def test_what_turns_cannot_be_is_refused() -> None:
    """One clear error for another event, and for a run with too few turns."""
    with pytest.raises(InputError, match='events: expected "revolution", or nothing'):
        eccentric.fit({"time_s": turn_times(0.5, 60.0)}, {**RIG, "events": "pulse"})
    with pytest.raises(InputError, match=r"expected at least 8 turns .*, got 5"):
        eccentric.fit({"time_s": np.arange(5.0)}, TURNS)


@needs_shared
def test_a_drum_and_the_tyre_on_it_slow_down_together() -> None:
    """Measured: both decelerations are those of the plain periods, in the ratio of the speeds."""
    rows = np.loadtxt(next(DATA.glob("17-*/*.csv")), delimiter=",")
    log = {"time_us": rows[:, 0], "drum": rows[:, 2], "tyre": rows[:, 4]}
    slowed = {}
    for name in ("drum", "tyre"):
        columns = {"time": {"column": "time_us", "unit": "us"}, "theta_m": {"column": name, "unit": "rev"}}
        found = eccentric.fit(log, {**TURNS, "columns": columns})
        events = 1e-6 * log["time_us"][:-1][np.diff(log[name]) > 0.0]
        period = np.diff(events)
        fastest = int(np.argmin(period))
        middle = 0.5 * (events[1:] + events[:-1])[fastest:]
        speed = 2.0 * np.pi / period[fastest:]
        part = (speed > 0.4 * speed[0]) & (speed < 0.6 * speed[0])
        part &= np.abs(np.diff(speed, prepend=speed[0])) < 0.05 * speed  # a turn that was missed
        slope = np.polyfit(middle[part], speed[part], 1)[0]
        cubic = [one["value"] for one in found.document["free_cubic"].values()]
        slowed[name] = float(np.polyval(cubic[::-1], np.mean(speed[part])))

        assert slowed[name] == pytest.approx(-slope, rel=0.03), name
    assert slowed["tyre"] / slowed["drum"] == pytest.approx(86.7 / 34.6, rel=0.05)


@needs_shared
def test_the_published_cubic_of_a_flywheel() -> None:
    """Measured: the four coefficients that its authors published are in the intervals of the free cubic."""
    folder = next(DATA.glob("16-*"))
    about = tomllib.loads((folder / "about.toml").read_text(encoding="utf-8"))
    published = next(one["value"] for one in about["published"] if "deceleration" in one["quantity"])
    rows = np.loadtxt(folder / about["logs"][0]["file"])
    log = {"time_ms": rows[:, 5], "speed": rows[:, 3]}
    columns = {"time": {"column": "time_ms", "unit": "ms"}, "omega_m": {"column": "speed", "unit": "rpm"}}
    found = eccentric.fit(log, {**RIG, "columns": columns})

    for name, value in zip(("c_0", "c_1", "c_2", "c_3"), published, strict=True):
        low, high = found.document["free_cubic"][name]["interval_95"]
        assert low <= value <= high, name
