"""`rig --check` shares its limits with `fit` and `diagnose`; what it says of constants, forces and units."""

from __future__ import annotations

import tomllib
from types import SimpleNamespace

import numpy as np
import pytest

import eccentric
from eccentric.core import InputError
from eccentric.model import LINEAR
from eccentric.presentation import fit_sentence
from eccentric.rigs import read_rig
from eccentric.signals import beside_the_rig, read_channels

KNOWN = {"case": "C1", "mu": 1, "M": "0 kg", "L": "0 m"}


def motor(seconds: float, step: float = 2e-3, hertz: float = 2.0) -> dict[str, np.ndarray]:
    """A bare motor on a sine that swells, the current with noise: R 0.9 ohm, k_e = k_i = 0.03 V s/rad."""
    t = np.arange(0.0, seconds, step)
    swell = 0.6 + 0.4 * np.sin(0.6 * t)
    angle = -9.0 * swell * np.cos(2.0 * np.pi * hertz * t) / hertz
    speed, rise = np.gradient(angle, step), np.gradient(np.gradient(angle, step), step)
    noise = np.random.default_rng(4).normal(0.0, 5e-3, len(t))
    current = (2e-5 * rise + 8e-3 * np.tanh(speed / 2.0) + 2e-5 * speed) / 0.03 + noise
    return {
        "time_s": t,
        "theta_m_rad": angle,
        "current_A": current,
        "voltage_V": 0.9 * current + 0.03 * speed,
    }


@pytest.mark.parametrize(
    ("R", "k_e", "doubted"),
    [
        (0.9, 0.03, set()),
        (9.0, 0.03, {"R"}),
        (0.9, 0.1, {"k_e"}),
        (0.6, 0.1, {"R", "k_e"}),
        (0.8, 0.03, set()),
    ],
)
def test_a_resistance_and_a_back_emf_that_the_circuit_contradicts_are_doubted(
    R: float, k_e: float, doubted: set[str]
) -> None:
    """Also where every swing is too short for moving blocks; an eighth is a winding that is warm."""
    rig = {
        "drive": "current",
        "known": {**KNOWN, "R": f"{R} ohm", "k_e": f"{k_e} V s/rad", "k_i": "0.03 N m/A"},
    }
    said = eccentric.check_rig(motor(12.0), rig)
    found = {letter for letter in ("R", "k_e") for line in said.doubts if f" {letter} is " in line}

    assert said.complaints == ()
    assert found == doubted


def test_too_few_averages_are_refused_by_all_three_alike() -> None:
    """What a fit cannot determine, a diagnosis has no proof of."""
    log = {name: x for name, x in motor(8.0, 5e-3, 0.5).items() if name != "voltage_V"}
    held = {"holdout_intervals_s": [[1.0, 4.0]], "average_over": "0.3 s"}
    rig = {"drive": "current", **held, "known": {**KNOWN, "k_i": "0.03 N m/A"}}
    messages = [str(line) for line in eccentric.check_rig(log, rig).complaints]
    for command in (eccentric.fit, eccentric.diagnose):
        with pytest.raises(InputError) as refused:
            command(log, rig)
        messages.append(str(refused.value))

    assert len(messages) == 3
    assert len({message.partition("expected ")[0] for message in messages}) == 1
    assert "moving averages over 0.3 s to fit" in messages[0]


# What a draft and a check ask for: nothing that the log has, and nothing that it cannot separate.


def test_a_torque_constant_by_which_a_column_was_computed_is_drafted() -> None:
    """The current and its multiple are logged: the multiple is the constant, and the check asks for none."""
    log = {name: x for name, x in motor(12.0).items() if name != "voltage_V"}
    draft = eccentric.draft_rig(log | {"torque_Nm": 0.03 * log["current_A"]})
    rig = tomllib.loads(draft.text)

    assert rig["known"]["k_i"] == "0.03 Nm/A"
    assert "k_i" not in draft.needed
    assert any(line.startswith("k_i: the torque constant (data sheet)") for line in draft.doubts)
    assert (
        () == eccentric.check_rig(log, rig | {"known": {**rig["known"], "M": "0 kg", "L": "0 m"}}).complaints
    )


def carriage(both: bool) -> dict[str, np.ndarray]:
    """A carriage of 20 kg with 5 N and 30 N s/m, there and back or in one direction."""
    t = np.arange(0.0, 20.0, 0.004)
    velocity = (0.0 if both else 0.3) + 0.2 * np.sin(1.3 * t)
    position = (0.0 if both else 0.3) * t - 0.2 / 1.3 * np.cos(1.3 * t)
    force = 20.0 * 0.26 * np.cos(1.3 * t) + 5.0 * np.sign(velocity) + 30.0 * velocity
    noise = 0.05 * np.random.default_rng(2).standard_normal(len(t))
    return {"t_s": t, "x_m": position, "v_m_s": velocity, "force_N": force + noise}


def test_a_constant_force_is_proposed_only_where_both_directions_separate_it() -> None:
    """In one direction it is Coulomb friction: a fit of the draft as it stands works in both cases."""
    for both in (True, False):
        log = carriage(both)
        draft = eccentric.draft_rig(log)
        rig = tomllib.loads(draft.text)

        assert both == ("F_load" in rig.get("unknown", {}))
        assert () == eccentric.check_rig(log, rig).complaints


def test_a_drive_of_one_sign_in_both_directions_is_not_cured_by_another_sign() -> None:
    """A hanging load of more than the friction: of the two, it alone is wrong, and both signs say so."""
    rng, rows = np.random.default_rng(1), np.arange(250)
    ways = [(1.0 if k % 2 == 0 else -1.0) * np.radians(60.0 + 5.0 * k) for k in range(20)]
    speed = np.repeat(ways, 250)
    log = {
        "run": np.repeat(np.arange(20.0), 250),
        "time_s": np.tile(rows * 0.008, 20),
        "theta_m_rad": np.concatenate([w * rows * 0.008 for w in ways]),
        # Lifting takes less here than lowering: with this sign friction is negative.
        "current_A": 0.6 - 0.25 * np.sign(speed) + 0.02 * rng.standard_normal(5000),
    }
    rig = {"drive": "current", "moving_threshold_rad_s": 0.3, "known": {**KNOWN, "k_i": "1 N m/A"}}
    (line,) = eccentric.check_rig(log, rig).complaints

    assert "positive in both directions" in line
    assert "T_load" in line
    assert "minus" not in line


@pytest.mark.parametrize(
    ("percent", "interval", "said"),
    [
        (-0.01, (-0.02, -0.001), "about the same held-out error as"),
        (-0.3, (-0.5, -0.1), "only slightly higher"),
    ],
)
def test_what_rounds_to_nothing_is_neither_better_nor_worse(
    percent: float, interval: tuple[float, float], said: str
) -> None:
    """A gain of -0.01 % would be printed as 0.0 % worse."""
    fit = SimpleNamespace(
        problem=SimpleNamespace(
            is_baseline=False, rig=SimpleNamespace(axis=LINEAR), model=SimpleNamespace(name="linear_axis")
        ),
        fits_the_rig=True,
        percent=percent,
        percent_interval=interval,
    )

    assert said in fit_sentence(fit)  # pyright: ignore[reportArgumentType]


def test_a_unit_in_the_name_of_a_column_is_not_printed_twice() -> None:
    """It is what the draft took; one that the name spells otherwise is printed behind it."""
    log = carriage(both=True)
    names = {"time [s]": "t_s", "x [m]": "x_m", "v [mm/s]": "v_m_s", "force (N)": "force_N"}
    renamed = {name: log[old] for name, old in names.items()} | {"v [mm/s]": 1e3 * log["v_m_s"]}
    summary = eccentric.draft_rig(renamed).summary()

    assert "time [s] [s]" not in summary
    assert "x [m] [m]" not in summary
    assert "force (N) [N]" not in summary
    described = eccentric.describe_log(renamed).summary()
    assert "clock: time [s], " in described
    assert "\n  x [m]: " in described


def test_a_column_that_is_constant_in_each_run_is_hinted_at() -> None:
    """A load that hangs differs from run to run: the draft says how it is subtracted, and that works."""
    log = {name: x for name, x in motor(12.0).items() if name != "voltage_V"}
    load = np.repeat([0.0, 100.0, 250.0], len(log["time_s"]) // 3)
    run = np.repeat(["a", "b", "c"], len(load) // 3)
    log = {name: x[: len(load)] for name, x in log.items()}
    log |= {"run": run, "load_g": load, "current_A": log["current_A"] + load * 1e-4 / 0.03}
    draft = eccentric.draft_rig(log)

    assert "constant in each run" in draft.left_out["load_g"]
    columns = {"time": "time_s", "theta_m": "theta_m_rad", "run": "run"}
    columns["torque"] = "0.03 * current_A - load_g * 1e-4"
    found = eccentric.fit(log, {"drive": "torque", "columns": columns, "known": KNOWN})
    assert found.estimates["J"].value == pytest.approx(2e-5, rel=0.02)


@pytest.mark.parametrize(("travel", "named"), [(0.2, False), (1.2, True)])
def test_gravity_is_judged_within_the_travel(travel: float, named: bool) -> None:
    """Over 0.4 rad a load that falls with the angle fits as gravity of 10 N m, of which 0.2 N m was seen."""
    t = np.arange(0.0, 40.0, 4e-3)
    angle = travel * np.sin(0.9 * t) + 0.1 * travel * np.sin(3.1 * t)
    speed = np.gradient(angle, t)
    load = 10.0 * (np.cos(angle) - 1.0) if not named else 1.5 * np.sin(angle)
    noise = np.random.default_rng(2).normal(0.0, 2e-3, len(t))
    torque = 0.05 * np.tanh(speed / 0.01) + 0.02 * speed + load + noise
    log = {"time_s": t, "theta_m_rad": angle, "torque_Nm": torque}
    said = eccentric.check_rig(log, {"drive": "torque", "known": KNOWN})

    assert named == any("contains a gravity torque of 1.5 N m" in str(line) for line in said.complaints)
    assert len(said.complaints) == named
    assert named or "taken from the rig file: M, L, mu" in said.summary()


def test_gravity_is_told_of_a_link_that_turns_far_in_a_block() -> None:
    """At up to 20 rad/s the link turns by 3 rad in the 0.15 s of a mean: its torque comes out to 0.5 %."""
    t = np.arange(0.0, 60.0, 5e-3)
    motor_angle = 4.0 * (2.0 * t - 30.0 * np.cos(0.6 * t) + 0.4 * np.sin(2.1 * t))
    speed, rise = np.gradient(motor_angle, t), np.gradient(np.gradient(motor_angle, t), t)
    noise = np.random.default_rng(5).normal(0.0, 1e-3, len(t))
    torque = 0.011 * np.sign(speed) + 3e-4 * speed + 8e-4 * rise + 0.15 * np.sin(motor_angle / 4.0) + noise
    log = {"time_s": t, "theta_m_rad": motor_angle, "torque_Nm": torque}
    mass = {"case": "C2", "mu": "1/4", "M": "0.38 kg", "L": f"{0.6 / 0.38 / 9.80665:.9f} m"}
    rig = read_rig({"drive": "torque", "known": mass})

    gravity = next(r for r in beside_the_rig(read_channels([log], rig), rig) if r.name == "M g L")

    assert gravity.value == pytest.approx(1.0, abs=5e-3)
    assert gravity.low < 1.0 < gravity.high
