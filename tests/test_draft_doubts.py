"""What a short swing does not show is doubted, in the draft and in the check; a unit goes before per cent."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable

import numpy as np
import pytest

import eccentric

TURN = 2.0 * np.pi
TYPED = {"M": "0.3 kg", "M_l": "0.1 kg", "L": "0.1 m"}


def swing(angle: str, scale: float, *, counts: bool = False, turns: float = 1.0) -> dict[str, np.ndarray]:
    """A link that swings by a fifth of a turn: the angle times `scale` in this column, whole if in counts.

    What looks like gravity repeats after these turns.
    """
    t = np.arange(0.0, 30.0, 0.004)
    ways = [(0.55, 0.4), (0.15, 1.1)]
    theta = np.sum([a * np.sin(TURN * f * t) for a, f in ways], axis=0)
    omega = np.sum([a * TURN * f * np.cos(TURN * f * t) for a, f in ways], axis=0)
    alpha = np.sum([-a * (TURN * f) ** 2 * np.sin(TURN * f * t) for a, f in ways], axis=0)
    torque = 0.004 * alpha + 0.02 * np.sign(omega) + 0.01 * omega + 0.33 * np.sin(theta / turns)
    noise = 0.002 * np.random.default_rng(1).standard_normal(len(t))
    shown = theta * scale
    return {"t_s": t, angle: np.round(shown) if counts else shown, "torque_Nm": torque + noise}


def test_a_gear_that_a_part_of_a_period_would_need_is_not_taken() -> None:
    """What looks like gravity repeats after 1.6 turns: it may be a spring as well."""
    draft = eccentric.draft_rig(swing("q_rad", 1.0, turns=1.6))

    assert 1 == tomllib.loads(draft.text)["known"]["mu"]
    assert any(line.startswith("mu: less than one period of gravity") for line in draft.doubts)


@pytest.mark.parametrize(("own", "doubted"), [({}, True), ({"encoder_counts_per_rev": 2001}, False)])
def test_counts_by_a_part_of_a_period_are_told_as_a_guess_by_the_check(
    own: dict[str, int], doubted: bool
) -> None:
    """Unless they are not the draft's: somebody has looked."""
    log = swing("q_counts", 2000.0 / TURN, counts=True)
    draft = eccentric.draft_rig(log)
    rig = tomllib.loads(draft.text)
    rig["known"] |= TYPED
    found = eccentric.check_rig(log, rig | own)

    assert any(line.startswith("encoder_counts_per_rev: less than one period") for line in draft.doubts)
    assert () == found.complaints
    assert doubted == any("encoder_counts_per_rev" in line for line in found.doubts)


@pytest.mark.parametrize(("every", "kept"), [(5000, True), (3, False)])
def test_a_column_with_a_text_in_it_is_told_with_the_place(every: int, kept: bool) -> None:
    """Here and there it costs its rows, which the fit counts; in a third of them, the column."""
    log = swing("q_rad", 1.0)
    spoilt = np.asarray(np.char.mod("%.6g", 2.0 * log["torque_Nm"]), dtype="<U12")
    spoilt[1000::every] = "ERR"
    draft = eccentric.draft_rig({**log, "u_V": spoilt, "mode": np.where(log["t_s"] < 5.0, "a", "b")})

    assert kept != ("'ERR'" in draft.left_out.get("u_V", ""))
    assert "mode" not in draft.left_out
    if not kept:
        return
    columns = {"time": "t_s", "theta_m": "q_rad", "torque": "u_V"}
    rig = {"columns": columns, "known": {"case": "C2", "mu": 1, **TYPED}}
    found = eccentric.fit({"t_s": log["t_s"], "q_rad": log["q_rad"], "u_V": spoilt}, rig)
    count = len(range(1000, len(spoilt), every))
    place = "(first: row 1001, 'ERR'; most: 'u_V'): such rows are dropped"
    assert any(f"no number in {count} of {len(spoilt)} rows {place}" in line for line in found.warnings)


def test_a_torque_in_newton_metres_goes_before_one_in_per_cent() -> None:
    """Both are the same signal; the log does not say of what the per cent are."""
    log = swing("q_rad", 1.0)
    torque = log.pop("torque_Nm")
    log |= {"torque_pct": 50.0 * torque, "torque_mNm": 1e3 * torque + 0.5 * np.sin(7.0 * log["t_s"])}
    columns = tomllib.loads(eccentric.draft_rig(log).text)["columns"]

    assert columns["torque"] == {"column": "torque_mNm", "unit": "mNm"}


@pytest.mark.parametrize(("name", "doubted"), [("position", True), ("position_rad", False)])
def test_a_unit_by_nothing_but_the_size_is_doubted(name: str, doubted: bool) -> None:
    """A controller that counts turns writes columns that look the same."""
    log = swing(name, 1.0)
    log["torque_Nm"] -= 0.33 * np.sin(log[name])  # gravity would show the turn
    about = [d for d in eccentric.draft_rig(log).doubts if d.startswith("theta_m")]

    assert doubted == any("size" in d or "could also be" in d for d in about)


def test_a_speed_in_parts_of_a_rated_one_is_left_out_and_one_in_counts_shows_their_number() -> None:
    """The slope of the angle gives the speed anyway; what a count is follows from it."""
    log = swing("q_deg", 180.0 / np.pi)
    speed = np.gradient(log["q_deg"], log["t_s"])
    in_parts, in_counts = (
        tomllib.loads(eccentric.draft_rig(log | {name: speed * factor}).text)
        for name, factor in (("speed (% of rated)", 0.1), ("speed (cnt/s)", 2048 / 360))
    )

    assert not [channel for channel in in_parts["columns"] if channel.startswith("omega")]
    assert in_counts["encoder_counts_per_rev"] == 2048


@pytest.mark.parametrize(("shown", "doubted"), [(np.abs, True), (np.asarray, False), (np.square, False)])
def test_a_speed_that_bounces_off_zero_has_lost_its_sign(
    shown: Callable[[np.ndarray], np.ndarray], doubted: bool
) -> None:
    """One that only turns one way slows down towards zero, as the square of a sine does."""
    t = np.arange(0.0, 30.0, 0.004)
    speed = shown(20.0 * np.sin(TURN * 0.4 * t))
    log = {"t_s": t, "speed_rpm": speed, "current_A": 0.1 * speed + 0.02 * np.gradient(speed, t)}

    assert doubted == any("sign is missing" in doubt for doubt in eccentric.draft_rig(log).doubts)


@pytest.mark.parametrize("velocity", ["present_velocity", "Present Velocity(128)"])
def test_the_registers_of_a_servo_are_read_by_their_ratio(velocity: str) -> None:
    """One of the speed is 0.229 rpm, which makes 4096 counts a turn; the supply is in tenths of a volt."""
    log = swing("present_position", 4096 / TURN, counts=True)
    omega = np.gradient(log["present_position"] * TURN / 4096, log["t_s"])
    log[velocity] = np.round(omega * 60 / TURN / 0.229)
    log |= {
        "present_pwm": np.round(200 * log["torque_Nm"]),
        "present_input_voltage": np.full(len(omega), 120.0),
    }
    del log["torque_Nm"]
    draft = eccentric.draft_rig(log)
    rig = tomllib.loads(draft.text)
    moving = {channel: c for channel, c in rig["columns"].items() if channel.startswith("omega")}

    assert rig["encoder_counts_per_rev"] == 4096
    source = velocity if velocity.isidentifier() else f"`{velocity}`"
    assert [*moving.values()] == [{"column": f"{source} * 0.229", "unit": "rpm"}]
    assert any("tenths of a volt" in doubt for doubt in draft.doubts)


@pytest.mark.parametrize("counts", [1632.67, 979.6, 2048.0])
def test_counts_behind_a_gear_are_not_rounded(counts: float) -> None:
    """48 counts at the motor and 34.014:1 are no number of an encoder."""
    log = swing("q_deg", 180.0 / np.pi)
    log["speed (cnt/s)"] = np.gradient(log["q_deg"], log["t_s"]) * counts / 360.0
    rig = tomllib.loads(eccentric.draft_rig(log).text)

    assert rig["encoder_counts_per_rev"] == pytest.approx(counts, rel=2e-3)


def test_a_signal_and_a_filtered_copy_without_names_are_no_voltage_and_current() -> None:
    """A voltage has a part of the speed that the current has not."""
    log = swing("q_rad", 1.0)
    torque = log.pop("torque_Nm")
    log |= {"ch_a": torque, "ch_b": np.convolve(torque, np.full(5, 0.2), "same")}

    assert tomllib.loads(eccentric.draft_rig(log).text)["columns"].keys() & {"voltage", "current"} == {
        "current"
    }


def test_tenths_of_a_degree_are_not_taken_for_kelvin_without_a_doubt() -> None:
    """A converter often logs 304 for 30.4 degC."""
    log = swing("q_rad", 1.0)
    log["front_temp"] = 300.0 + np.round(np.linspace(0.0, 8.0, len(log["t_s"])))

    assert any(d.startswith("temperature") and "size" in d for d in eccentric.draft_rig(log).doubts)


@pytest.mark.parametrize(("factor", "doubted"), [(1.0, False), (1.2, True)])
def test_a_torque_constant_that_gravity_does_not_allow_is_doubted(factor: float, doubted: bool) -> None:
    """A fifth too much can be fitted: the check says that nothing else in the log agrees with it."""
    log = swing("q_rad", 1.0)
    log["current_A"] = log.pop("torque_Nm") / 0.06
    gravity = {"M": "0.25 kg", "M_l": "0.1 kg", "L": f"{0.33 / 0.25 / 9.81} m"}
    known = {**gravity, "case": "C2", "mu": 1.0, "k_i": f"{0.06 * factor} N m/A"}
    columns = {"time": "t_s", "theta_m": "q_rad", "current": "current_A"}
    found = eccentric.check_rig(log, {"columns": columns, "known": known})

    assert () == found.complaints
    assert [doubted] == [bool(found.doubts)] == ["see 1 doubt" in found.summary()]
    assert all("N m/A from gravity and 0.072 in the rig file" in line for line in found.doubts)


@pytest.mark.parametrize(("k_i", "heavier"), [(1.4, 1.0), (0.75, 1.0), (1.0, 1.4)])
def test_a_doubt_is_about_what_differs(k_i: float, heavier: float) -> None:
    """Inertia and gravity that are off by one factor are the constant's; gravity alone is the mass's."""
    log = swing("q_rad", 1.0)
    log["current_A"] = log.pop("torque_Nm") / 0.06
    gravity = {"M": f"{0.25 * heavier} kg", "M_l": "0.1 kg", "L": f"{0.33 / 0.25 / 9.81} m"}
    inertia = {"J_m": "1e-9 kg m^2", "J_l": "0.004 kg m^2"}
    known = {**gravity, **inertia, "case": "C2", "mu": 1.0, "k_i": f"{0.06 * k_i} N m/A"}
    columns = {"time": "t_s", "theta_m": "q_rad", "current": "current_A"}
    (doubt,) = eccentric.check_rig(log, {"columns": columns, "known": known}).doubts

    written = [float(value) for value in re.findall(r'write k_i = "([\d.]+) N m/A"', doubt)]
    assert written == ([] if k_i == 1.0 else [pytest.approx(0.06, rel=0.01)])
    assert ("check M and L" in doubt) == (heavier != 1.0)
    assert ("k_i" in doubt) == (k_i != 1.0)


@pytest.mark.parametrize(
    ("R", "k_e", "told"), [(0.8, 0.12, False), (1.0, 0.12, False), (1.0, 0.06, True), (0.8, 0.06, True)]
)
def test_a_wrong_resistance_makes_no_wrong_constant(R: float, k_e: float, told: bool) -> None:
    """At 0.8 ohm and 0.12 V s/rad, what another R leaves of the voltage is no back-EMF."""
    log = swing("q_rad", 1.0)
    log["current_A"] = log.pop("torque_Nm") / 0.12
    log["voltage_V"] = 0.8 * log["current_A"] + 0.12 * np.gradient(log["q_rad"], log["t_s"])
    known = {"M": "0.25 kg", "M_l": "0.1 kg", "L": f"{0.33 / 0.25 / 9.81} m", "case": "C2", "mu": 1.0}
    known |= {"k_i": "0.12 N m/A", "R": f"{R} ohm", "k_e": f"{k_e} V s/rad"}
    columns = {"time": "t_s", "theta_m": "q_rad", "current": "current_A", "voltage": "voltage_V"}
    said = str(eccentric.check_rig(log, {"columns": columns, "known": known, "drive": "current"}))

    assert told == ("k_e is 0.12 V s/rad in the log and 0.06 in the rig file; correct the rig" in said)
    assert told == ("correct the rig" in said)


@pytest.mark.parametrize(("mu", "doubted"), [(1.0, False), (0.02, True)])
def test_friction_at_a_radius_longer_than_the_link_is_doubted(mu: float, doubted: bool) -> None:
    """In a level plane, with a gear that is wrong by 50, friction needs a bearing larger than the link."""
    log = swing("q_rad", 1.0)
    omega = np.gradient(log["q_rad"], log["t_s"])
    normal = 0.35 * 9.81 + 0.25 * 0.1 * omega**2
    log["torque_Nm"] = 0.004 * np.gradient(omega, log["t_s"]) + (0.002 + 0.01 * normal) * np.sign(omega)
    log["torque_Nm"] += 1e-4 * np.random.default_rng(1).standard_normal(len(omega))
    known = {"M": "0.25 kg", "M_l": "0.1 kg", "L": "0.1 m", "case": "C1", "mu": mu}
    columns = {"time": "t_s", "theta_m": "q_rad", "torque": "torque_Nm"}
    found = eccentric.check_rig(log, {"columns": columns, "known": known})

    assert doubted == any("longer than the link of 0.1 m" in line for line in found.doubts)


@pytest.mark.parametrize(("counts", "contradicted"), [(2000, False), (4096, True)])
def test_the_step_of_the_angle_contradicts_other_counts(counts: int, contradicted: bool) -> None:
    """Steps of a turn over 2000 are no encoder of 4096."""
    log = swing("q_rad", 1.0)
    log["q_rad"] = np.round(log["q_rad"] * 2000.0 / TURN) * TURN / 2000.0
    rig = tomllib.loads(eccentric.draft_rig(log).text)
    rig["known"] |= TYPED
    found = eccentric.check_rig(log, rig | {"encoder_counts_per_rev": counts}).complaints

    assert contradicted == bool(found)
    assert all("encoder_counts_per_rev = 4096: the log shows 2000" in line for line in found)


@pytest.mark.slow
def test_another_column_of_the_angle_has_counts_of_its_own() -> None:
    """The draft takes one of two; the step of that one says nothing of the other."""
    log = swing("q_rad", 1.0)
    fine, coarse = (np.round(log["q_rad"] * n / TURN) * TURN / n for n in (4096.0, 2000.0))
    log |= {"q_rad": fine, "link_rad": coarse}
    rig = tomllib.loads(eccentric.draft_rig(log).text)
    rig["known"] |= TYPED
    for column, counts in (("q_rad", 4096), ("link_rad", 2000)):
        rig["columns"]["theta_m"], rig["encoder_counts_per_rev"] = column, counts
        assert [] == [line for line in eccentric.check_rig(log, rig).complaints if "encoder" in line]


@pytest.mark.parametrize(("counts", "gear"), [(4096, 16), (500, 4), (1000, 100)])
def test_counts_behind_a_gear_are_not_contradicted_by_gravity(counts: int, gear: int) -> None:
    """The log shows their product; neither is refused."""
    t = np.arange(0.0, 30.0, 0.004)
    theta = 9.0 * np.sin(0.7 * t) + 2.0 * np.sin(2.9 * t)
    omega = 9.0 * 0.7 * np.cos(0.7 * t) + 2.0 * 2.9 * np.cos(2.9 * t)
    torque = 0.02 * np.sign(omega) + 0.01 * omega + 0.33 * np.sin(theta)
    log = {"t_s": t, "q_counts": np.round(theta * counts * gear / TURN), "torque_Nm": torque / gear}
    columns = {"time": "t_s", "theta_m": {"column": "q_counts", "unit": "counts"}, "torque": "torque_Nm"}
    known = {**TYPED, "case": "C2", "mu": f"1/{gear}"}
    found = eccentric.check_rig(
        log, {"columns": columns, "known": known, "encoder_counts_per_rev": counts}
    ).complaints

    assert [] == [line for line in found if "encoder" in line or "mu" in line]
