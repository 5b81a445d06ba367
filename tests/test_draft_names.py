"""Names go before values, and of several joints that which moves is drafted; ripple is no gravity."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

import eccentric
from benchmarks.decoys import decoyed
from benchmarks.disguised import Column, judged
from eccentric.api.drafted import RigDraft
from eccentric.core import InputError
from eccentric.drafting import draft_of
from eccentric.drafting.words import read_name
from eccentric.logs import Log

STEP = 4e-3
Array = np.ndarray


def bare(seconds: float = 20.0) -> dict[str, Array]:
    """A bare motor on two sines: time, angle, speed, and the torque of inertia and friction with noise."""
    t = np.arange(0.0, seconds, STEP)
    angle = 4.0 * np.sin(1.9 * t) + 1.5 * np.sin(4.3 * t + 0.4)
    speed = 7.6 * np.cos(1.9 * t) + 6.45 * np.cos(4.3 * t + 0.4)
    rise = -14.44 * np.sin(1.9 * t) - 27.735 * np.sin(4.3 * t + 0.4)
    noise = np.random.default_rng(5).normal(0.0, 0.01, len(t))
    torque = 0.12 * np.tanh(speed / 0.1) + 0.01 * speed + 4e-3 * rise + noise
    return {"time": t, "angle": angle, "speed": speed, "rise": rise, "torque": torque}


def channels(draft: RigDraft) -> dict[str, str]:
    """Channel -> column of a draft."""
    table = tomllib.loads(draft.text)["columns"]
    return {k: v["column"] if isinstance(v, dict) else v for k, v in table.items()}


@pytest.mark.parametrize(
    "computed", ["tau_rigid", "tau_pred", "torque_ff", "friction_est", "tau_model", "tau_d", "torque_cmd"]
)
def test_what_is_computed_or_set_fits_better_and_is_not_taken(computed: str) -> None:
    """A model's torque has no noise, so that motion explains all of it; the measured one is the drive."""
    b = bare()
    smooth = 0.12 * np.tanh(b["speed"] / 0.1) + 0.01 * b["speed"] + 4e-3 * b["rise"]
    log = {"t_s": b["time"], "q": b["angle"], "qd": b["speed"], computed: smooth, "tau": b["torque"]}

    assert channels(eccentric.draft_rig(log))["torque"] == "tau"


@pytest.mark.parametrize("name", ["Stribeck", "PINN", "ch7", "ee_quat_w"])
def test_a_named_drive_is_not_joined_by_another_column(name: str) -> None:
    """What has no name of a drive is left out beside one that has."""
    b = bare()
    other = 0.11 * np.tanh(b["speed"] / 0.1)
    log = {"t_s": b["time"], "q": b["angle"], "dq": b["speed"], "tau_measured": b["torque"], name: other}
    draft = eccentric.draft_rig(log)

    assert set(channels(draft)) == {"time", "theta_m", "omega_m", "torque"}
    assert name in draft.left_out


def test_letters_give_way_to_the_slope() -> None:
    """V is the slope of x, no voltage; F drives it."""
    b = bare()
    log = {"t": b["time"], "x": b["angle"], "v": b["speed"], "F": b["torque"]}
    draft = eccentric.draft_rig(log)

    assert channels(draft) == {"time": "t", "position": "x", "velocity": "v", "force": "F"}
    assert any(doubt.startswith("kind:") for doubt in draft.doubts)


def test_a_stamp_is_no_drive_and_a_constant_command_is_told() -> None:
    """Turning in one direction, a clock goes with the angle."""
    t = np.arange(0.0, 8.0, STEP)
    speed = 6.0 * (1.0 - np.exp(-t / 0.5))
    log = {
        "__time": t,
        "/joint_states/joint0/position": np.cumsum(speed) * STEP,
        "/joint_states/joint0/velocity": speed,
        "/tf/header/stamp": 1.7e9 + t + 1e-4 * np.random.default_rng(1).random(len(t)),
        "/effort_control/data.0": np.full(len(t), 0.57),
    }
    draft = eccentric.draft_rig(log)

    assert not {"current", "torque", "voltage", "torque_l"} & set(channels(draft))
    assert draft.left_out["/effort_control/data.0"] == "it is constant"
    assert "current" in draft.needed


def test_a_constant_duty_has_no_offset() -> None:
    """Nothing can be estimated from a drive that does not vary."""
    t = np.arange(0.0, 4.0, 0.02)
    log = {"time_ms": 1e3 * t, "pwm": np.full(len(t), 255.0), "rpm": np.round(300.0 * (1.0 - np.exp(-t)))}
    draft = eccentric.draft_rig(log)

    assert "voltage_offset_V" not in tomllib.loads(draft.text)
    assert any("constant, 255 in all rows" in doubt for doubt in draft.doubts)


def test_a_duty_without_a_sign_is_told_and_a_target_is_no_voltage() -> None:
    """The target follows the motion as well as any drive; the duty turns both ways without a sign."""
    b = bare()
    duty = np.abs(np.round(200.0 * b["torque"] / np.max(np.abs(b["torque"]))))
    log = {
        "Timestamp": np.round(1e3 * b["time"]),
        "Target": np.roll(np.round(400.0 * b["angle"]), -20),
        "MotorPWM": duty,
        "Encoder": np.round(400.0 * b["angle"]),
    }
    draft = eccentric.draft_rig(log)

    assert "MotorPWM" in channels(draft)["voltage"]
    assert "set point" in draft.left_out["Target"]
    assert any("its sign is missing" in doubt for doubt in draft.doubts)


@pytest.mark.parametrize(
    ("name", "factor", "said"),
    [
        ("Torque actual value", 1000.0, "thousandths of a rated value"),
        ("torque [‰]", 1000.0, "parts per thousand"),
        ("torque [%]", 100.0, "percent of a rated value"),
        ("motor current", 2048.0, "counts of a converter"),
    ],
)
def test_a_part_of_a_rated_value_is_told(name: str, factor: float, said: str) -> None:
    """The log does not hold what the numbers are parts of."""
    b = bare()
    log = {"t_s": b["time"], "q_rad": b["angle"], name: np.round(factor * b["torque"])}

    assert any(said in doubt for doubt in eccentric.draft_rig(log).doubts)


def test_a_supply_is_no_voltage_of_the_motor() -> None:
    """It hardly varies while the speed does, beside a current."""
    b = bare()
    voltage = 36.0 - 0.5 * np.abs(b["torque"])
    log = {"t_s": b["time"], "q_rad": b["angle"], "current_A": b["torque"], "voltage [V]": voltage}
    draft = eccentric.draft_rig(log)

    assert "voltage" not in channels(draft)
    assert "voltage [V]" in draft.left_out


def test_a_torque_by_a_constant_is_the_current_again() -> None:
    """A controller's torque is its current times k_t: two drives would be one."""
    b = bare()
    log = {"t_s": b["time"], "q_rad": b["angle"], "iq_A": b["torque"], "torque_Nm": 0.11 * b["torque"]}
    draft = eccentric.draft_rig(log)

    assert channels(draft)["current"] == "iq_A"
    assert draft.left_out["torque_Nm"].startswith("0.11 times iq_A")


def test_columns_left_out_for_one_reason_share_a_line() -> None:
    """A long list is folded; what a reader needs is the reason."""
    b = bare()
    models = {f"tau_model_{k}": (1.0 + 0.1 * k) * b["torque"] for k in range(9)}
    draft = eccentric.draft_rig({"t_s": b["time"], "q_rad": b["angle"], "tau_Nm": b["torque"], **models})

    assert "9 columns (tau_model_0, tau_model_1, " in draft.text
    assert draft.summary().count("left out:") == 1


@pytest.mark.parametrize(
    ("text", "quantity", "role"),
    [
        ("Iq_setpoint", "current", "set"),
        ("/joint_cmds/joint1/position", "angle", "set"),
        ("q_d", "speed", "set"),
        ("0x6077", "torque", "measured"),
        ("6071h", "torque", "set"),
        ("Position actual value (6064h)", "angle", "measured"),
        ("pos_estimate", "angle", "estimated"),
        ("pos_estimate_filtered", "angle", "filtered"),
        ("ee_quat_w", "speed", "other"),
        ("observed torque constant [Nm/A]", "other", "other"),
        ("M_ist", "torque", "measured"),
        ("actual_main_voltage", "supply", "measured"),
        ("c1 vel [Hz]", "speed", ""),
        ("LuGre", "", "computed"),
        ("Drehzahlsollwert", "speed", "set"),
        ("motorcurrent", "current", ""),
        ("cmdvel", "speed", "set"),
        ("observation.effort(:,2)", "torque", "measured"),
        ("d_axis_current", "current", "other"),
        ("input_voltage", "supply", ""),
        ("torque_feed_forward", "torque", "computed"),
        ("current_position", "angle", ""),
        ("current motor speed", "speed", ""),
        ("current time", "time", ""),
        ("torque current", "current", ""),
        ("rotation speed", "speed", ""),
        ("axis0.encoder.vel_estimate", "speed", "estimated"),
        ("axis0.controller.input_vel", "speed", "set"),
        ("DC bus current [A]", "supply", ""),
        ("eRPM", "speed", "electrical"),
        ("实际位置(deg)", "angle", "measured"),
        ("Stellgröße", "voltage", ""),
        ("Drehrichtung", "direction", ""),
        ("x direction position", "angle", ""),
        ("direction speed", "speed", ""),
        ("z-direction force", "torque", ""),
        ("forward direction current", "current", ""),
        ("motor direction", "direction", ""),
        ("AxisTor_A1", "torque", ""),
        ("Axis.StatusDrive.ActualTorque", "torque", "measured"),
        ("torque_status", "torque", "other"),
        ("T_des", "", "set"),
        ("MotT", "", ""),
        ("ms_today", "time", ""),
        ("speed_ms", "speed", ""),
        ("%time", "time", ""),
        ("ActualPower", "", "other"),
        ("Id_measured", "", "other"),
        ("phase_current", "current", ""),
        ("phase_current_A", "current", "other"),
        ("I_C", "current", ""),
        ("T_C", "temperature", ""),
        ("el_deg", "angle", ""),
        ("qfrc_bias", "torque", "computed"),
        ("line_current", "current", ""),
        ("vbus_sampled", "supply", ""),
        ("us_left", "", ""),
        ("motor tick [ms]", "time", ""),
        ("Consigne (rad)", "angle", "set"),
        ("theta_ddot", "acceleration", ""),
        ("U_A", "voltage", ""),
        ("bat_voltage", "supply", ""),
        ("I_in", "supply", ""),
        ("EL_ANGLE", "angle", "electrical"),
        ("ticks_left", "angle", ""),
        ("Drehgeber [Inkr]", "angle", ""),
        ("prędkość", "speed", ""),
        ("snelheid", "speed", ""),
        ("토크", "torque", ""),
    ],
)
def test_a_name_says_where_a_column_comes_from(text: str, quantity: str, role: str) -> None:
    """Names of drives, topics, robots and scopes."""
    name = read_name(text)

    assert (name.quantity, name.role) == (quantity, role)


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("Velocity [cnt/sec]", "counts/s"),
        ("Position actual value [inc]", "counts"),
        ("转矩(N·m)", "N m"),
        ("acc_ms2", "m/s^2"),
        ("ms_today", "ms"),
        ("speed (% of rated)", "%"),
        ("AxisPos_A1", ""),
        ("i_A2", "A"),
        ("speed_ms", ""),
        ("theta_deg2", "deg"),
    ],
)
def test_a_name_says_its_unit(text: str, unit: str) -> None:
    """A number behind it may be that of an axis, a power of the unit or one of several columns."""
    assert read_name(text).unit == unit


@pytest.mark.parametrize(
    ("names", "wanted"),
    [
        ({"angle": "axis0.encoder.pos", "speed": "axis0.encoder.vel"}, ("angle", "speed")),
        ({"angle": "a1 pos [rad]", "turns": "c1 pos [rev]", "hz": "c1 vel [Hz]", "speed": "a1 vel [rad/s]"},
         ("angle", "speed")),
        ({"electrical": "eRPM", "rpm": "RPM"}, ("", "rpm")),
        ({"angle": "deg", "speed": "rad/s"}, ("angle", "speed")),
        ({"angle": "theta", "electrical": "erpm"}, ("angle", "")),
        ({"mrad": "theta_mrad", "mrad_s": "omega_mrad_s"}, ("mrad", "mrad_s")),
        ({"speed": "speed_rad_s", "krpm": "set speed [krpm]"}, ("", "speed")),
        ({"krpm": "n [krpm]"}, ("", "krpm")),
    ],
)  # fmt: skip
def test_angle_and_speed_are_of_one_sensor(names: dict[str, str], wanted: tuple[str, str]) -> None:
    """Columns of one prefix and of the shaft itself, in units that no other test has."""
    b = bare()
    rpm = b["speed"] * 30.0 / np.pi
    b |= {
        "turns": b["angle"] / (2.0 * np.pi),
        "hz": b["speed"] / (2.0 * np.pi),
        "rpm": rpm,
        "krpm": rpm / 1e3,
    }
    b |= {"electrical": 7.0 * rpm, "mrad": 1e3 * b["angle"], "mrad_s": 1e3 * b["speed"]}
    # The speed of a filter of its own: it follows the other angle worse.
    b["speed"] = b["speed"] + np.random.default_rng(3).normal(0.0, 0.05, len(b["time"]))
    draft = eccentric.draft_rig(
        {"time_s": b["time"]} | {n: b[k] for k, n in names.items()} | {"torque_Nm": b["torque"]}
    )

    found = channels(draft)
    told = tuple(next((c for k, c in found.items() if k.startswith(what)), "") for what in ("theta", "omega"))
    assert told == tuple(names.get(what, "") for what in wanted)


@pytest.mark.parametrize(
    ("levels", "factor"),
    [
        ((0, 1), "(2 * dir - 1)"),
        ((1, 2), "(2 * (dir - 1) - 1)"),
        ((-2, 2), "(0.5 * (dir + 2) - 1)"),
        ((-1, 1), "dir"),
    ],
)
def test_a_speed_and_a_drive_without_signs_beside_a_direction(levels: tuple[int, int], factor: str) -> None:
    """The doubt gives the arithmetic that puts the sign back: -1 for the lower level, 1 for the upper one."""
    b = bare()
    log = {
        "t_s": b["time"],
        "rad/s": abs(b["speed"]),
        "dir": np.where(b["speed"] > 0.0, levels[1], levels[0]).astype(float),
        "mA": 1e3 * abs(b["torque"]),
    }
    draft = eccentric.draft_rig(log)

    (doubt,) = [p.doubt for p in draft.proposals if p.channel.startswith("omega")]
    assert f'"`rad/s` * {factor}"' in doubt
    assert [-1.0, 1.0] == [eval(factor, {"dir": float(level)}) for level in levels]  # noqa: S307
    assert any("its sign is missing" in p.doubt for p in draft.proposals if p.channel == "current")


def test_the_temperature_is_that_of_the_motor_and_of_its_joint() -> None:
    """Not the first one: a converter and another joint have one too."""
    b = bare()
    warm = 30.0 + 5.0 * (1.0 - np.exp(-b["time"] / 9.0))
    alone = {"t_s": b["time"], "q_rad": b["angle"], "i_A": b["torque"]}
    alone |= {"temp_mosfet": warm + 9.0, "temp_motor": warm}
    assert channels(eccentric.draft_rig(alone))["temperature"] == "temp_motor"

    still = 1e-5 * np.sin(40.0 * b["time"])
    two = {"t_s": b["time"], "q_1": still, "q_2": b["angle"], "tau_1": still + 1.0, "tau_2": b["torque"]}
    two |= {"temperature_1": warm + 9.0, "temperature_2": warm}
    assert channels(eccentric.draft_rig(two))["temperature"] == "temperature_2"

    american = {
        "t_s": b["time"],
        "q_rad": b["angle"],
        "i_A": b["torque"],
        "Motor Temp (F)": 1.8 * warm + 32.0,
    }
    assert channels(eccentric.draft_rig(american))["temperature"] == "(`Motor Temp (F)` - 32) / 1.8"
    filtered = {("temp_f" if name == "Motor Temp (F)" else name): x for name, x in american.items()}
    assert channels(eccentric.draft_rig(filtered))["temperature"] == "temp_f"


@pytest.mark.parametrize("name", ["tick", "ticks", "clock"])
def test_a_counter_is_no_time_beside_a_rate(name: str) -> None:
    """Alone it may be one, with a doubt; a column that is called a time leaves no place for a rate."""
    b = bare()
    log = {name: np.arange(len(b["time"])) * 1.0, "q_rad": b["angle"], "i_A": b["torque"]}

    rated = eccentric.draft_rig(log, rate_hz=250.0)
    assert (250.0, False) == (tomllib.loads(rated.text)["sample_rate_hz"], "time" in channels(rated))
    (time,) = [p for p in eccentric.draft_rig(log).proposals if p.channel == "time"]
    assert "counter" in time.doubt
    for other in ("t", "time", "tick_ms"):
        with pytest.raises(InputError, match="leave the rate out"):
            eccentric.draft_rig({other: log[name], **log}, rate_hz=250.0)


def test_a_torque_sensor_of_no_joint_is_asked_about() -> None:
    """A joint with a current of its own, and a sensor beside it: the draft names it."""
    b = bare()
    other = b["torque"] + np.random.default_rng(8).normal(0.0, 0.05, len(b["time"]))
    log = {"t_s": b["time"], "a1 q [rad]": b["angle"], "a2 q [rad]": 0.0 * b["angle"] + 1e-6 * b["speed"]}
    log |= {"a1 i [A]": b["torque"], "a2 i [A]": 0.01 * np.sin(b["time"]), "sensor torque [Nm]": other}
    draft = eccentric.draft_rig(log)

    (current,) = [p for p in draft.proposals if p.channel == "current"]
    assert current.column == "a1 i [A]"
    assert "sensor torque [Nm]" in current.doubt


KNOWN = {
    "time": Column("time", "s"),
    "angle": Column("angle", "rad"),
    "speed": Column("speed", "rad/s"),
    "torque": Column("torque", "N m"),
}


@pytest.mark.parametrize("seed", range(12))
def test_among_decoys_nothing_is_wrong_without_a_doubt(seed: int) -> None:
    """Real names, shuffled and rescaled, with set values, results, errors, stamps and copies among them."""
    b = bare()
    given = decoyed(
        Log("log.csv", {c: b[c] for c in KNOWN}, len(b["time"])), KNOWN, np.random.default_rng(seed)
    )
    found = judged(draft_of(given.log), given)

    assert [one for one in found if not one.right and not one.doubted] == []


def test_set_values_alone_are_no_log() -> None:
    """Nothing measured: the error says what the columns are."""
    b = bare()
    with pytest.raises(InputError, match="expected an angle or a speed"):
        eccentric.draft_rig(
            {"t_s": b["time"], "q_ref": b["angle"], "qd_ref": b["speed"], "tau_cmd": b["torque"]}
        )


@pytest.mark.parametrize(
    ("speed", "duty"), [("speed_rad_s", "duty"), ("speed_rpm", "pwm_%"), ("v_mm_s", "duty")]
)
def test_a_duty_cycle_that_repeats_shows_no_gravity_without_an_angle(speed: str, duty: str) -> None:
    """The angle is an integrated speed, which has no turn: nothing is said of a gear, and nothing fails."""
    t = np.arange(0.0, 20.0, STEP)
    omega = 12.0 + 2.0 * np.sin(0.7 * t)
    turned = np.cumsum(omega) * STEP
    part = 0.3 + 0.02 * omega + 0.1 * np.sin(turned) + np.random.default_rng(2).normal(0.0, 1e-3, len(t))
    scale = 100.0 if "%" in duty else 1.0
    log = {
        "time_s": t,
        speed: omega * (9.55 if "rpm" in speed else 1.0),
        duty: scale * part,
        "vbus": 24.0 + 0.0 * t,
    }

    text = eccentric.draft_rig(log).text
    assert "times per turn" not in text
    assert 'case = "C2"' not in text


# Of several joints a draft has one: that which moves, with its own drive; and ripple is no gravity.


@pytest.mark.parametrize(
    ("pattern", "keys"),
    [
        ("{what}_{key}", ("1", "2", "3")),
        ("{what}(:,{key})", ("4", "5", "6")),
        ("/joint_states/{key}/{what}", ("shoulder_pan_joint", "elbow_joint")),
        ("{key}_{what}", ("left", "right")),
    ],
)
def test_all_channels_are_of_the_joint_that_moves(pattern: str, keys: tuple[str, ...]) -> None:
    """The others jitter, and one of them has a torque that goes with the motion better than its own."""
    b = bare()
    rng = np.random.default_rng(2)
    log = {"t_s": b["time"]}
    for key in keys:
        moves = key == keys[1]
        noise = rng.normal(0.0, 1e-3, len(b["time"]))
        log[pattern.format(what="position", key=key)] = b["angle"] if moves else noise
        log[pattern.format(what="velocity", key=key)] = b["speed"] if moves else np.gradient(noise, STEP)
        log[pattern.format(what="torque", key=key)] = b["torque"] + 30.0 * noise if moves else b["torque"]
    draft = eccentric.draft_rig(log)
    found = channels(draft)

    assert {v for k, v in found.items() if k != "time"} == {
        pattern.format(what=what, key=keys[1]) for what in ("position", "velocity", "torque")
    }
    assert not any("move" in doubt for doubt in draft.doubts)


def test_where_two_joints_move_a_draft_asks() -> None:
    """Either could be meant; the arm has a rig of its own."""
    b = bare()
    log = {"t_s": b["time"]}
    for key, phase in (("1", 0), ("2", 700)):
        log |= {f"q_{key}": np.roll(b["angle"], phase), f"tau_{key}": np.roll(b["torque"], phase)}

    assert any("--arm reads all joints" in doubt for doubt in eccentric.draft_rig(log).doubts)


@pytest.mark.parametrize(("one", "other"), [("L_", "R_"), ("Motor A ", "Motor B "), ("inner ", "outer ")])
def test_of_two_machines_a_draft_asks(one: str, other: str) -> None:
    """Two that move in ways of their own, whatever tells their names apart."""
    b, still = bare(), np.arange(0.0, 20.0, STEP)
    log = {"t_s": b["time"], f"{one}angle [rad]": b["angle"], f"{other}angle [rad]": np.sin(2.9 * still)}
    draft = eccentric.draft_rig(log | {f"{one}torque [Nm]": b["torque"]})

    (angle,) = [p for p in draft.proposals if p.channel.startswith("theta")]
    assert angle.column == f"{one}angle [rad]"
    assert "moves" in angle.doubt


def test_a_drive_of_no_joint_goes_to_the_joint_that_explains_it() -> None:
    """A driven arm and a free pendulum: the command has no number."""
    b = bare()
    log = {
        "t_s": b["time"],
        "/joint_states/joint0/position": b["angle"],
        "/joint_states/joint1/position": 5.0 * np.sin(2.7 * b["time"] + 0.4) + 2.0 * np.sin(0.3 * b["time"]),
        "/command/data.0": b["torque"],
        "motor_current": b["torque"] + 0.01 * np.sin(40.0 * b["time"]),
    }

    assert "/joint_states/joint0/position" in channels(eccentric.draft_rig(log)).values()


def test_three_phases_are_no_joints() -> None:
    """Currents with numbers beside one angle."""
    b = bare()
    log = {"t_s": b["time"], "theta": b["angle"], "iq_A": b["torque"]}
    log |= {f"u{k}": np.sin(11.0 * b["angle"] + 2.1 * k) for k in (1, 2, 3)}
    draft = eccentric.draft_rig(log)

    assert channels(draft)["current"] == "iq_A"
    assert "joint" not in " ".join(draft.left_out.values())


@pytest.mark.parametrize("times", [12, 36])
@pytest.mark.parametrize("both", [True, False])
def test_what_repeats_within_a_turn_is_ripple(times: int, both: bool) -> None:
    """Cogging of slots and poles, seen at one speed or both ways: the gear stays 1 and the plane level."""
    t = np.arange(0.0, 40.0, STEP)
    speed = (np.sign(np.sin(0.4 * t)) if both else 1.0) + 0.1 * np.sin(2.1 * t)
    angle = np.cumsum(speed) * STEP
    current = 0.2 * np.sign(speed) + 0.05 * speed + 0.12 * np.sin(times * angle)
    draft = eccentric.draft_rig({"t_s": t, "theta_rad": angle, "omega_rad_s": speed, "current_A": current})
    known = tomllib.loads(draft.text)["known"]

    assert (known["case"], known["mu"]) == ("C1", 1)
    assert "ripple" in draft.text


def test_gravity_is_found_below_a_stronger_ripple() -> None:
    """Once per turn, in both directions: a link on the shaft."""
    t = np.arange(0.0, 60.0, STEP)
    angle = 5.0 * np.sin(0.7 * t) + 2.0 * np.sin(1.7 * t)
    speed, rise = np.gradient(angle, STEP), np.gradient(np.gradient(angle, STEP), STEP)
    current = 0.1 * np.sign(speed) + 0.02 * rise + 0.4 * np.sin(angle) + 0.6 * np.sin(24.0 * angle)
    draft = eccentric.draft_rig({"t_s": t, "theta_rad": angle, "current_A": current})
    known = tomllib.loads(draft.text)["known"]

    assert (known["case"], known["mu"]) == ("C2", 1)


def test_an_integrated_speed_shows_no_gravity() -> None:
    """Without an angle none lasts: a drift of the integral would do as well."""
    t = np.arange(0.0, 40.0, STEP)
    angle = 5.0 * np.sin(0.7 * t) + 2.0 * np.sin(1.7 * t)
    speed = np.gradient(angle, STEP)
    log = {"t_s": t, "omega_rad_s": speed, "current_A": 0.1 * np.sign(speed) + 0.4 * np.sin(angle)}

    assert tomllib.loads(eccentric.draft_rig(log).text)["known"]["case"] == "C1"
