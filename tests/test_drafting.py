"""A log that nobody described becomes a rig file: what it says is right or doubted, and it fits."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import eccentric
from benchmarks.disguised import Column, disguised, judged
from eccentric.api.simulated import BenchResult
from eccentric.core import InputError
from eccentric.drafting import draft_of, toml_of
from eccentric.drafting.columns import Grid, nice_counts, step_of, wrap_of
from eccentric.drafting.columns import LoggedColumn as Values
from eccentric.drafting.units import find_runs
from eccentric.drafting.words import Name, read_name
from eccentric.logs import Log
from eccentric.signals import beside_the_rig, read_channels

BENCH = {
    "time_s": Column("time", "s"),
    "theta_m_rad": Column("angle", "rad"),
    "omega_m_rad_s": Column("speed", "rad/s"),
    "voltage_V": Column("voltage", "V"),
    "current_A": Column("current", "A"),
}


def bench_log(
    seed: int, case: str = "C2", mu: float = 0.2, log_type: str = "traj", seconds: float = 30.0
) -> BenchResult:
    """A log of the virtual bench."""
    return eccentric.bench([], case=case, mu=mu, log_type=log_type, seconds=seconds, seed=seed)


@pytest.fixture(scope="module")
def arm() -> BenchResult:
    """A log with gravity behind a gear of 5:1."""
    return bench_log(11)


def renamed(log: Log, names: dict[str, str], factors: dict[str, float]) -> Log:
    """A log with other names, its columns multiplied."""
    columns = {new: log.columns[old] * factors.get(old, 1.0) for old, new in names.items()}
    return Log("log.csv", columns, log.rows)


@pytest.mark.parametrize("seed", range(4))
def test_a_disguised_log_is_read_right_or_doubted(seed: int, arm: BenchResult) -> None:
    """Whatever the columns are called and in whichever unit, nothing is wrong without a doubt."""
    counts = arm.rig.log.counts_per_rev or 0.0
    known = {
        c: Column(k.quantity, k.unit, counts if k.quantity == "angle" else 0.0) for c, k in BENCH.items()
    }
    given = disguised(arm.log, known, np.random.default_rng(seed))
    found = judged(draft_of(given.log), given)

    assert [one for one in found if not one.right and not one.doubted] == []
    if given.style != "no name":
        assert sum(one.right for one in found) >= 4


def test_a_confidence_is_a_probability(arm: BenchResult) -> None:
    """Of every column, whether its name says what it is or the log alone does."""
    names = {"time_s": "t", "theta_m_rad": "a", "omega_m_rad_s": "b", "voltage_V": "c", "current_A": "d"}
    found = [one for log in (arm.log, renamed(arm.log, names, {})) for one in draft_of(log).proposals]

    assert {"voltage"} == {one.channel for one in found if one.source == "c"}
    assert [] == [one for one in found if not 0.0 < one.confidence <= 1.0]


def test_of_two_columns_in_blocks_the_one_that_is_called_run_names_the_runs() -> None:
    """A mode that changes twice is as much in blocks, and comes first."""
    texts = {"mode": np.repeat(["a", "b", "c"], 20), "run": np.repeat(["first", "second"], 30)}

    proposal, changes = find_runs({}, texts, 60)

    assert proposal is not None
    assert ("run", "run") == (proposal.channel, proposal.column)
    assert [29] == np.flatnonzero(changes).tolist()


def test_a_voltage_without_a_name_is_asked_about_beside_a_named_current(arm: BenchResult) -> None:
    """The relation of the circuit speaks for it, but so it does for what a model predicts."""
    names = {"time_s": "time_s", "theta_m_rad": "theta_m_rad", "current_A": "current_A", "voltage_V": "c"}
    draft = draft_of(renamed(arm.log, names, {}))

    assert [p.channel for p in draft.proposals] == ["time", "theta_m", "current"]
    assert "is it the voltage?" in draft.left_out["c"]


def test_units_without_names_follow_from_physics(arm: BenchResult) -> None:
    """Degrees and rpm under plain words: the slope fixes their ratio, gravity and the encoder the degrees."""
    names = {"time_s": "t", "theta_m_rad": "position", "omega_m_rad_s": "velocity", "current_A": "Iq"}
    turned = renamed(arm.log, names, {"theta_m_rad": 180.0 / math.pi, "omega_m_rad_s": 30.0 / math.pi})
    draft = draft_of(turned)
    units = {p.channel: p.unit for p in draft.proposals}

    assert {"time": "s", "theta_m": "deg", "omega_m": "rpm"} == {
        c: units[c] for c in ("time", "theta_m", "omega_m")
    }


@pytest.mark.parametrize(("case", "mu"), [("C2", 0.2), ("C2", 1.0), ("C2", 0.1), ("C1", 0.2)])
def test_case_and_gear_are_those_of_the_bench(case: str, mu: float) -> None:
    """Gravity repeats once per turn of the link, which shows case and gear; without it there is no gear."""
    draft = draft_of(bench_log(21, case, mu, seconds=20.0).log)
    said = {e.key: e for e in draft.entries}
    over, _, under = said["mu"].value.strip('"').partition("/")

    assert f'"{case}"' == said["case"].value
    if case == "C2":
        assert pytest.approx(mu) == float(over) / float(under or 1.0)
    else:
        assert "does not reveal the gear" in said["mu"].doubt


def test_friction_that_grows_faster_than_the_speed_does_not_turn_a_sign() -> None:
    """Beside a linear term, that of the sign of the speed is then negative; the power that is lost is not."""
    t = np.arange(0.0, 40.0, 0.01)
    w = 30.0 * np.sin(0.7 * t) + 12.0 * np.sin(1.9 * t)
    current = 0.1 * np.sign(w) + 4e-5 * w**3 + 0.02 * np.gradient(w, t)
    angle = np.round(np.cumsum(w) * 0.01 * 1e4) / 1e4
    speed_and_sign = np.column_stack([np.sign(w), w, np.gradient(w, t)])
    assert np.linalg.lstsq(speed_and_sign, current, rcond=None)[0][0] < 0.0

    for sign in (1.0, -1.0):
        noisy = sign * (current + 0.01 * np.random.default_rng(1).standard_normal(len(t)))
        draft = draft_of(Log("log.csv", {"time [s]": t, "angle [rad]": angle, "current [A]": noisy}, len(t)))
        (found,) = [p for p in draft.proposals if p.channel == "current"]

        assert (sign < 0.0) == found.turned


def test_in_one_direction_an_offset_does_not_turn_a_sign() -> None:
    """A load that drives, or an offset of the sensor, looks like negative friction there; inertia decides."""
    t = np.arange(0.0, 40.0, 0.01)
    w = 20.0 + 10.0 * np.sin(0.7 * t) + 5.0 * np.sin(1.9 * t)
    current = -1.0 + 0.01 * w + 0.02 * np.gradient(w, t)
    noisy = current + 0.01 * np.random.default_rng(1).standard_normal(len(t))
    angle = np.round(np.cumsum(w) * 0.01 * 1e4) / 1e4
    draft = draft_of(Log("log.csv", {"time [s]": t, "angle [rad]": angle, "current [A]": noisy}, len(t)))
    (found,) = [p for p in draft.proposals if p.channel == "current"]

    assert not found.turned


def test_a_turned_current_is_turned_back(arm: BenchResult) -> None:
    """Friction and inertia need a current to rise with them; one that falls has its sign turned."""
    names = {"time_s": "time_s", "theta_m_rad": "theta_m_rad", "current_A": "current_A"}
    draft = draft_of(renamed(arm.log, names, {"current_A": -1.0}))
    (current,) = (p for p in draft.proposals if p.channel == "current")

    assert "-current_A" == current.column
    assert any("sign" in said for said in current.evidence)


def test_a_size_alone_is_doubted(arm: BenchResult) -> None:
    """Nothing in a log shows whether a current is in A or mA: the draft says that it goes by the size."""
    names = {"time_s": "time_s", "theta_m_rad": "theta_m_rad", "current_A": "current"}
    draft = draft_of(renamed(arm.log, names, {}))

    assert any(doubt.startswith("current = current: A only from its size") for doubt in draft.doubts)


def test_a_draft_with_three_values_fits(arm: BenchResult, tmp_path: Path) -> None:
    """The drafted file, with M, L and M_l from the bench typed, is fitted as the bench's own rig is."""
    draft = eccentric.draft_rig(arm.log)
    known = arm.rig.known
    text = draft.text
    for letter, unit in (("M", "kg"), ("L", "m"), ("M_l", "kg")):
        typical = next(e.value for e in draft.questions if e.key == letter)
        text = text.replace(f"#? {letter} = {typical}", f'{letter} = "{known[letter]!r} {unit}"')
    path = tmp_path / "rig.toml"
    path.write_text(text, encoding="utf-8")
    found = eccentric.fit(arm.log, path)
    own = eccentric.fit(arm.log, arm.rig)

    assert ("M", "L", "M_l") == draft.needed
    # k_i is found from gravity: the drive torque is explained as well as with the bench's own constants.
    assert found.r_squared["paper"] == pytest.approx(own.r_squared["paper"], abs=0.02)
    assert found.fits_the_rig


def test_a_draft_is_a_rig_file_with_its_evidence(arm: BenchResult) -> None:
    """Every channel has a comment above it, and the file is TOML as it stands."""
    draft = draft_of(arm.log)
    lines = toml_of(draft, "arm").splitlines()

    content = tomllib.loads("\n".join(lines))
    assert set(content["columns"]) == {p.channel for p in draft.proposals}
    for proposal in draft.proposals:
        at = next(k for k, line in enumerate(lines) if line.startswith(f"{proposal.channel} = "))
        assert lines[at - 1].startswith("#")
    said = " ".join(line.removeprefix("#").strip() for line in lines)
    assert (
        ", acceleration 0."
        in said.split("current by its name")[1].split("shares of its standard deviation: ")[1]
    )


def test_no_name_breaks_a_draft(arm: BenchResult) -> None:
    """Line breaks, control characters and quotes in a header, of a channel or of none, are escaped."""
    odd = 'Supply\n[V] \x01\x7f "\\'
    names = {name: name for name in arm.log.columns} | {"time_s": "time\n[s]\x7f"}
    log = renamed(arm.log, names, {})
    log = Log(log.path, {**log.columns, odd: np.full(log.rows, 24.0)}, log.rows)
    content = tomllib.loads(toml_of(draft_of(log), 'arm "\U0001f600\n'))

    assert ('arm "\U0001f600\n', "time\n[s]\x7f") == (content["name"], content["columns"]["time"])
    assert {"name", "columns"} <= set(content)
    assert "V" not in content


def test_a_draft_never_replaces_a_file(arm: BenchResult, tmp_path: Path) -> None:
    """What someone wrote into a rig file stays."""
    path = tmp_path / "rig.toml"
    path.write_text("mine")
    with pytest.raises(InputError, match="expected a new file, but this one exists"):
        eccentric.draft_rig(arm.log).write(path)

    assert "mine" == path.read_text()


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        (
            {"a": np.sin(np.arange(200.0)), "b": np.cos(np.arange(200.0))},
            "a column that rises from row to row",
        ),
        ({"t": np.arange(10.0), "b": np.cos(np.arange(10.0))}, "expected at least 50 rows"),
        (
            {"t": np.arange(400.0) / 100, "b": np.random.default_rng(1).normal(size=400)},
            "expected an angle or a speed",
        ),
    ],
)
def test_what_shows_no_motion_is_refused(columns: dict[str, np.ndarray], said: str) -> None:
    """Without a clock, with few rows, or with noise alone there is nothing to draft from."""
    with pytest.raises(InputError, match=said):
        draft_of(Log("log.csv", columns, len(next(iter(columns.values())))))


@pytest.mark.parametrize(
    ("text", "quantity", "unit", "side"),
    [
        ("Speed [rpm]", "speed", "rpm", ""),
        ("Iq (mA)", "current", "mA", ""),
        ("q_rad_3", "angle", "rad", ""),
        ("w_in_rad_s", "speed", "rad/s", "m"),
        ("linkAngleDeg", "angle", "deg", "l"),
        ("Drehzahl in 1/min", "speed", "rpm", ""),
        ("n_mot/rpm", "speed", "rpm", "m"),
        ("n/min-1", "speed", "rpm", ""),
        ("I_q/mA", "current", "mA", ""),
        ("omega rad/s", "speed", "rad/s", ""),
        ("torque_mNm", "torque", "mNm", ""),
        ("Timestamp (ns)", "time", "ns", ""),
        ("supply_V", "supply", "V", ""),
        ("torque_enable", "on", "", ""),
        ("r78[1]: Stromistwert [Aeff]", "current", "A", ""),
        ("omega_mrad_s", "speed", "mrad/s", ""),
        ("torque [oz-in]", "torque", "ozfin", ""),
        ("Time [h]", "time", "h", ""),
        ("mA", "current", "mA", ""),
        ("min", "", "", ""),
        ("iq_pu", "current", "pu", ""),
        ("out.theta.signals.values", "angle", "", ""),
        ("Velocity (degrees/sec)", "speed", "deg/s", ""),
        ("Position (revolutions)", "angle", "rev", ""),
        ("Torque (Newton-meters)", "torque", "N m", ""),
        ("Torque (in-lbs)", "torque", "lbfin", ""),
        ("n [min⁻¹]", "speed", "rpm", ""),
        ("power meter", "", "", ""),
        ("ω", "speed", "", ""),
        ("ch3", "", "", ""),
    ],
)
def test_names_say_quantity_unit_and_side(text: str, quantity: str, unit: str, side: str) -> None:
    """Units in brackets and as suffixes, words of a few languages, sides of the gear."""
    name = read_name(text)

    assert (quantity, unit, side) == (name.quantity, name.unit, name.side)


@pytest.mark.parametrize("counts", [1000, 4096, 16384])
@pytest.mark.parametrize("speed", [0.4, 40.0])
def test_the_step_of_an_encoder_is_seen(counts: int, speed: float) -> None:
    """Also where no two values are one step apart, and rounded to five digits; noise has no step."""
    rng = np.random.default_rng(counts)
    angle = speed * np.cumsum(rng.normal(size=8000)) * 0.01
    step = 2.0 * math.pi / counts
    read = np.round(np.round(angle / step) * step, 5)

    assert nice_counts(2.0 * math.pi / step_of(Values(Name("x"), read)), 1e-3) == counts
    assert step_of(Values(Name("x"), angle)) == 0.0


def test_a_wrap_is_told_from_a_square_wave() -> None:
    """An angle that restarts passes all values in between; a set value that jumps does not."""
    t = np.arange(4000) / 100.0
    breaks = np.zeros(len(t) - 1, dtype=bool)
    square = Values(Name("x"), np.sign(np.sin(t)) + 1e-3 * np.sin(37.0 * t))

    assert wrap_of(Values(Name("x"), np.degrees(3.0 * t) % 360.0), breaks) == 360.0
    assert wrap_of(square, breaks) == 0.0


BROKEN = """
drive = "curent"
low_pas_hz = 25
[columns]
time = "tme_s"
theta_m = { column = "theta_m_rad", unit = "deg" }
omega_m = { column = "omega_m_rad_s", unit = "rmp" }
current = "voltage_V"
[known]
case = "C1"
phi = "20 deg"
M = "489"
L = "-2 m"
mu = "1:5"
"""
WRONG = (
    "drive: expected one of current, voltage, torque, none, got 'curent'; did you mean 'current'?",
    "unknown key 'low_pas_hz'; did you mean 'low_pass_hz'?",
    "unknown unit 'rmp'",
    "[known] M: expected a unit",
    "[known] L: expected a value at least 0 m",
    "[known] mu: expected a ratio with '/'",
    "[known] case C1 means phi = 90 deg; remove one",
    "[columns] time: no column 'tme_s' in",
    "'theta_m_rad' is read in deg, the log shows rad",
    'current = "voltage_V": the log shows voltage there',
    '[known] case C1: the log shows "C2"',
)


def test_all_that_is_wrong_is_listed_at_once(arm: BenchResult, tmp_path: Path) -> None:
    """Eleven mistakes in a file are eleven lines, each with the file, the place and the mend."""
    path = tmp_path / "rig.toml"
    path.write_text(BROKEN)
    found = eccentric.check_rig(arm.log, path).complaints

    assert [said for said in WRONG if not any(said in line for line in found)] == []
    assert len(WRONG) == len(found)
    assert all(line.startswith(str(path)) for line in found)


def test_what_is_missing_is_asked_for_at_once(arm: BenchResult, tmp_path: Path) -> None:
    """A draft without its questions answered lacks three values, each named with a typical one."""
    path = eccentric.draft_rig(arm.log).write(tmp_path / "rig.toml")
    found = eccentric.check_rig(arm.log, path).complaints

    assert {"M", "L", "M_l"} == {line.split("expected [known] ")[1].split(",")[0] for line in found}


def test_a_good_rig_has_no_complaint() -> None:
    """The bench's own rig: nothing is wrong, and what the log determines is listed with its interval."""
    path = Path(__file__).resolve().parents[1] / "examples" / "bench" / "bench.toml"
    found = eccentric.check_rig(path.with_name("bench.csv.gz"), path)

    assert () == found.complaints
    assert any(line.startswith("C_m = ") and "95 % interval" in line for line in found.estimated)


def test_a_check_holds_declared_values_beside_the_log(arm: BenchResult) -> None:
    """A torque constant of twice the true one stands beside the log's own."""
    known = arm.rig.known
    twice = replace(arm.rig, known={**known, "k_i": 2.0 * known["k_i"]})
    channels = read_channels([arm.log], twice)

    ratios = {ratio.name: ratio for ratio in beside_the_rig(channels, twice)}

    assert ratios["k_i"].value == pytest.approx(0.5, abs=0.06)
    assert ratios["k_i"].found == pytest.approx(known["k_i"], rel=0.12)
    assert ratios["R"].value == pytest.approx(1.0, abs=0.02)
    assert ratios["M g L"].value == pytest.approx(2.0, rel=0.12)


def test_a_log_without_a_drive_asks_for_one_first(arm: BenchResult) -> None:
    """Nothing can be fitted without a current, a torque or a voltage: that is the first question."""
    draft = eccentric.draft_rig(renamed(arm.log, {"time_s": "time_s", "theta_m_rad": "theta_m_rad"}, {}))

    assert draft.needed[0] == "current"
    assert '#? current = "its column"' in draft.text
    assert "current" not in tomllib.loads(draft.text)["columns"]


def test_a_voltage_that_is_asked_for_is_no_copy_of_the_current(arm: BenchResult) -> None:
    """At low speed the two are alike, and "soll" marks a set value: a voltage drives the motor anyway."""
    names = {"time_s": "t_s", "theta_m_rad": "EncPos", "current_A": "I_ist"}
    log = renamed(arm.log, names, {})
    voltage = 0.9 * np.asarray(arm.log.columns["current_A"]) + 1e-3 * np.asarray(
        arm.log.columns["omega_m_rad_s"]
    )
    log = Log(log.path, {**log.columns, "U_soll": voltage}, log.rows)

    draft = eccentric.draft_rig(log)

    assert "U_soll" not in draft.left_out
    assert "U_soll" in str(tomllib.loads(draft.text)["columns"]["voltage"])


def test_a_check_says_what_a_diagnosis_requires_beyond_a_fit(arm: BenchResult, tmp_path: Path) -> None:
    """Current and voltage are mapped, R and k_e are not given: fit can, diagnose cannot."""
    known = {letter: f"{arm.rig.known[letter]!r} {unit}" for letter, unit in (("M", "kg"), ("L", "m"))}
    rig = tmp_path / "rig.toml"
    text = eccentric.draft_rig(arm.log).text
    for letter, value in {**known, "M_l": f"{arm.rig.known['M_l']!r} kg"}.items():
        text = "\n".join(
            f'{letter} = "{value}"' if line.startswith(f"#? {letter} =") else line
            for line in text.splitlines()
        )
    rig.write_text(text, encoding="utf-8")

    found = eccentric.check_rig(arm.log, rig)

    assert found.complaints == ()
    assert any("diagnose also requires [known] R and k_e" in line for line in found.warnings)
    with pytest.raises(InputError, match=r"expected \[known\] R and k_e"):
        eccentric.diagnose(arm.log, rig)


def test_an_angle_that_restarts_is_put_together_again() -> None:
    """Turns to and fro, logged within one turn, are the angle that was turned."""
    angle = 40.0 * np.sin(np.linspace(0.0, 3.0, 2000))
    logged = Values(read_name("angle", "rad"), np.mod(angle, 2.0 * np.pi))
    found = Grid([], np.zeros(1999, dtype=bool)).unwrapped(logged)

    assert angle == pytest.approx(found, abs=1e-9)
