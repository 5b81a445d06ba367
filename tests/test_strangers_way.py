"""A stranger's way with a simulated log of a known drive: draft, check and fit, as each says to go on."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import eccentric
from eccentric.api.drafted import RigDraft, draft_rig
from eccentric.core import InputError
from eccentric.drafting.words import read_name
from eccentric.logs import read_log
from eccentric.signals.clock import far_from_others

TURN = 2.0 * np.pi
T = np.arange(4000) * 0.01
Q = 60.0 * np.sin(0.9 * T + 0.3) + 20.0 * np.sin(2.3 * T + 1.0)
DQ = 54.0 * np.cos(0.9 * T + 0.3) + 46.0 * np.cos(2.3 * T + 1.0)
DDQ = -48.6 * np.sin(0.9 * T + 0.3) - 105.8 * np.sin(2.3 * T + 1.0)
NOISE = 0.003 * np.random.default_rng(3).standard_normal(len(T))
J, C, B, K, GRAVITY, GEAR = 2e-4, 0.02, 2e-4, 0.05, 1.15, 20
TYPED = {"M": '"0.42 kg"', "L": '"0.28 m"', "M_l": '"0 kg"', "k_i": '"0.05 N m/A"'}
TRUTH = {"J": J, "C": C, "B": B, "C_m": C, "B_m": B}


def current(gravity: float = 0.0) -> np.ndarray:
    """The motor's current [A]; a gravity torque [N m] at the link hangs behind the gear."""
    return (J * DDQ + C * np.sign(DQ) + B * DQ + gravity / GEAR * np.sin(Q / GEAR)) / K + NOISE


def written(path: Path, columns: dict[str, np.ndarray], *, units: str = "", apart: str = ",") -> Path:
    """A text file, with a row of units if there are any."""
    rows = [apart.join(f"{x:.9g}" for x in row) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join([apart.join(columns), *([units] if units else []), *rows]) + "\n")
    return path


def proposed(drafted: RigDraft) -> dict[str, str]:
    """Channel -> column as the rig file has it."""
    return {p.channel: p.column for p in drafted.proposals}


def filled(drafted: RigDraft, path: Path) -> Path:
    """The draft with the asked values typed in, as its comments say."""
    text = re.sub(r"^k_i = \[.*\n", "", drafted.text, flags=re.MULTILINE)
    asked = {key: value for key, value in TYPED.items() if re.search(rf"^#\? {key} = ", text, re.MULTILINE)}
    for key, value in asked.items():
        text = re.sub(rf"^#\? {key} = .*$", f"{key} = {value}", text, flags=re.MULTILINE)
    if "k_i" not in asked:
        text = text.replace("[known]\n", f"[known]\nk_i = {TYPED['k_i']}\n")
    path.write_text(text)
    return path


def require_truth(log: Path, drafted: RigDraft) -> None:
    """No complaint about the draft; estimates, that of J among them, within 5 % of what made the log."""
    rig = filled(drafted, log.with_suffix(".toml"))
    found = eccentric.fit(log, rig)

    assert [] == list(eccentric.check_rig(log, rig=rig).complaints)
    assert "J" in found.estimates
    for name, one in found.estimates.items():
        if name in TRUTH:
            assert one.value == pytest.approx(TRUTH[name], rel=0.05), name


def test_a_row_of_units_in_another_language(tmp_path: Path) -> None:
    """Half of its cells are units of SI; the angle is that of the link, the speed that of the motor."""
    columns = {"Zeit": 1000 * T, "Winkel": np.degrees(Q) / GEAR, "Drehzahl": DQ * 60 / TURN}
    columns["Strom"] = 1000 * current(GRAVITY)
    log = written(tmp_path / "log.csv", columns, units="ms;Grad;U/min;mA", apart=";")
    drafted = draft_rig(log)

    assert list(columns) == list(read_log(log).columns)
    assert {"time": "Zeit", "theta_l": "Winkel", "omega_m": "Drehzahl", "current": "Strom"} == proposed(
        drafted
    )
    require_truth(log, drafted)


def test_both_ends_of_a_gear_without_units(tmp_path: Path) -> None:
    """A speed that cannot be the slope of the angle is the motor's, and the gear a doubt."""
    columns = {"time": T, "angle": np.degrees(Q) / GEAR, "speed": DQ * 60 / TURN, "current": current(GRAVITY)}
    drafted = draft_rig(written(tmp_path / "log.csv", columns))

    assert {"theta_l", "omega_m"} < proposed(drafted).keys()
    assert any(doubt.startswith("mu:") for doubt in drafted.doubts)


def test_a_speed_of_the_other_sign_is_turned(tmp_path: Path) -> None:
    """The drive as well: both then agree with the angle."""
    columns = {"t": T, "encoder_rad": -Q, "speed_rad_s": DQ, "i_A": current()}
    log = written(tmp_path / "log.csv", columns)
    drafted = draft_rig(log)

    assert "-speed_rad_s" == proposed(drafted)["omega_m"]
    assert "-i_A" == proposed(drafted)["current"]
    require_truth(log, drafted)


def test_turns_and_their_times_ask_for_revolutions(tmp_path: Path) -> None:
    """The key of the rig file is in the message, and does what it says."""
    turns = np.arange(1, 250)
    times = -20.0 * np.log(1.0 - turns / 300.0)
    log = written(tmp_path / "log.csv", {"rev": turns, "time_s": times})
    with pytest.raises(InputError, match='events = "revolution"'):
        draft_rig(log)

    rig = {"drive": "none", "events": "revolution", "columns": {"time": "time_s"}}
    known = {"case": "C1", "mu": 1, "M": "0 kg", "L": "0 m", "J_m": "0.02 kg m^2", "J_l": "0 kg m^2"}
    assert eccentric.fit(log, rig | {"known": known}).estimates["B"].value == pytest.approx(1e-3, rel=1e-2)


def test_numbered_letters_say_nothing(tmp_path: Path) -> None:
    """V1 to V4, as R calls columns without names: no voltages."""
    log = written(tmp_path / "log.csv", {"V1": T, "V2": Q, "V3": DQ, "V4": current()})

    assert {"time": "V1", "theta_m": "V2", "omega_m": "V3", "current": "V4"} == proposed(draft_rig(log))


def test_a_part_of_a_rated_torque_is_multiplied_as_the_doubt_says(tmp_path: Path) -> None:
    """Per mille of 1.27 N m: the arithmetic in the doubt, put into the rig file, gives newton metres."""
    columns = {"t_s": T, "pos_rad": Q, "Torque actual value [0.1%]": K * current() / 1.27e-3}
    log = written(tmp_path / "log.csv", columns)
    drafted = draft_rig(log)
    (said,) = (doubt for doubt in drafted.doubts if "rated value" in doubt)
    line = re.search(r'write "(.*?)"', said)
    assert line is not None
    rig = filled(drafted, tmp_path / "log.toml")
    rig.write_text(re.sub(r"^torque = .*$", f'torque = "{line[1]}"', rig.read_text(), flags=re.MULTILINE))

    assert eccentric.fit(log, rig).estimates["J"].value == pytest.approx(J, rel=0.02)


@pytest.mark.parametrize(("k_i", "doubted"), [("0.05 N m/A", False), ("0.3 N m/A", True)])
def test_a_torque_beside_the_current_shows_its_constant(k_i: str, doubted: bool, tmp_path: Path) -> None:
    """Without gravity and inertia in the rig, nothing else does."""
    log = written(tmp_path / "log.csv", {"t": T, "q": Q, "i": current(), "tau": K * current() + NOISE / 9})
    rig = {"drive": "current", "columns": {"time": "t", "theta_m": "q", "current": "i", "torque": "tau"}}
    known = {"case": "C1", "mu": 1, "M": "0 kg", "L": "0 m", "k_i": k_i}
    found = eccentric.check_rig(log, rig=rig | {"known": known})

    assert doubted == any("k_i is 0.05 N m/A in the log" in doubt for doubt in found.doubts)


def test_a_line_drawn_below_the_header(tmp_path: Path) -> None:
    """Of a report in columns, with a title and units."""
    rows = "".join(f"{t:10.3f} {q:10.3f} {i:10.4f}\n" for t, q, i in zip(T, Q, current(), strict=True))
    head = "Motor test 3\n\n  Time   Angle   Current\n  [s]   [rad]   [A]\n-------------------\n"
    (tmp_path / "log.txt").write_text(head + rows)
    log = read_log(tmp_path / "log.txt")

    assert {"Time": "s", "Angle": "rad", "Current": "A"} == dict(log.units)


def test_a_floating_point_number_is_no_force() -> None:
    """By its prefix."""
    assert "torque" != read_name("fLoad").quantity
    assert "torque" == read_name("f_x").quantity


def test_gravity_over_a_part_of_a_turn_is_a_doubt(tmp_path: Path) -> None:
    """It is too little to tell gravity from a spring, and more than a light mass."""
    q, w, a = (x / 120.0 for x in (Q, DQ, DDQ))
    torque = 1.2 * a + 8.0 * np.sign(w) + 5.0 * w + 12.0 * np.sin(q)
    log = {"t": T, "q_rad": q, "dq_rad_s": w, "tau_Nm": torque}
    bare = log | {"tau_Nm": torque - 12.0 * np.sin(q)}

    for name, columns, follows in (("a.csv", log, True), ("b.csv", bare, False)):
        doubts = draft_rig(written(tmp_path / name, columns)).doubts
        assert follows == any("follows the angle" in doubt for doubt in doubts)


@pytest.mark.parametrize("row", [0, 1700, 3999])
@pytest.mark.parametrize("channel", ["pos_rad", "vel_rad_s"])
def test_a_damaged_row_is_dropped(row: int, channel: str, tmp_path: Path) -> None:
    """The first, left from before; one in the middle; the last, cut short. It is counted and named."""
    columns = {"t": T, "pos_rad": Q.copy(), "vel_rad_s": DQ.copy(), "cur_A": current()}
    columns[channel][row] = 6553.5
    log = written(tmp_path / "log.csv", columns)
    drafted = draft_rig(log)

    assert not any("does not follow" in doubt for doubt in drafted.doubts)
    require_truth(log, drafted)
    warnings = eccentric.fit(log, tmp_path / "log.toml").warnings
    assert [f"1 row with an angle or a speed far from its neighbours (first: line {row + 2})"] == [
        one.split("log.csv: ")[1].split(": such")[0] for one in warnings if "far from" in one
    ]


@pytest.mark.parametrize(
    "x",
    [
        np.r_[np.linspace(0.0, 359.9, 400), 0.1, 359.9, np.linspace(0.1, 350.0, 400)],
        np.r_[np.zeros(100), np.ones(300), np.zeros(200)],
        np.round(5.0 * np.sin(np.arange(600) / 50.0)),
        np.tile(np.r_[np.linspace(0.0, 9.0, 50), 500.0], 12),
        np.zeros(300),
        np.r_[np.zeros(90), 1.0, np.tile(np.r_[np.zeros(99), 30.0], 20), 0.0],
        np.r_[
            np.tile([0.0, 1.0], 100),
            100.0,
            190.0,
            260.0,
            300.0,
            260.0,
            190.0,
            100.0,
            np.tile([0.0, 1.0], 100),
        ],
        np.r_[359.9, np.linspace(0.0, 90.0, 300)],
    ],
    ids=["wraps", "steps", "counts", "often", "rest", "stick and slip", "there and back", "first row"],
)
def test_what_a_signal_does_is_no_damage(x: np.ndarray) -> None:
    """An angle at its wrap, a speed that is switched, an encoder of few counts, what happens often."""
    assert not np.any(far_from_others(x))
