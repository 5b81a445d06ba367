"""Extended models as emitted: neutral at zero, finite everywhere, C as NumPy, hidden states stepped."""

import ctypes
import subprocess
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

from eccentric.emission import load_module
from eccentric.model import load_model
from eccentric.model import vocabulary as v
from tests.emitted import both_precisions
from tests.extended import (
    AT_WORK,
    BASE,
    J_L,
    J_M,
    K_I,
    KNOWN,
    M_L,
    MU,
    Extended,
    G,
    L,
    M,
    R,
    Signals,
    arguments,
    briefly,
    call,
    every_case,
    inputs,
    members,
    some_at_work,
    with_group,
)

J = J_M + MU**2 * J_L
FLAGS = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-Werror")
SAME = (
    "normal_force",
    "mechanical_friction_torque",
    "friction_torque",
    "gravity_torque",
    "voltage",
    "current",
    "mechanical_residual",
    "electrical_residual",
)


@pytest.mark.parametrize("name", some_at_work())
def test_neutral_effects_change_nothing(name: str) -> None:
    """With coefficients 0 and neutral shapes every emitted function gives what the base model gives."""
    case, number = AT_WORK[name]
    given, base, one = inputs(), load_module(load_model(BASE[case])), with_group(case, number)
    for function in SAME:
        expected, actual = call(base, function, given), call(one.module, function, given)
        tolerance = 1e-13 * np.max(np.abs(expected), initial=1.0)
        expected = np.broadcast_to(expected, actual.shape)
        np.testing.assert_allclose(actual, expected, 1e-13, tolerance, err_msg=function)


def test_normal_force_is_the_one_that_friction_hangs_on() -> None:
    """Where a tilt of the plane loads the bearing, F_N is centrifugal force and weight, added as vectors."""
    given, module = inputs(), briefly("C1", "gravity_tilt[load]")
    weight, at = (M + M_L) * G * np.sin(0.2), MU * given["theta_m"] + 0.7
    centrifugal = M * L * (MU * given["omega_m"]) ** 2

    actual = call(module, "normal_force", given, tilt_angle=0.2, tilt_phase=0.7)

    np.testing.assert_allclose(
        actual, np.hypot(centrifugal + weight * np.cos(at), weight * np.sin(at)), 1e-12
    )


@pytest.mark.parametrize("name", some_at_work())
def test_slopes_are_numbers_everywhere(name: str) -> None:
    """Gradient, Jacobian and states are finite for finite input, at rest too, with every coefficient set."""
    given, one = inputs(), with_group(*AT_WORK[name])
    own = {q.name: 0.1 for effect in one.effects for q in effect.coefficients}
    for function in ("friction_torque_gradient", "friction_torque_jacobian", "regressor", "next_state"):
        if hasattr(one.module, function):
            result = call(one.module, function, given, **own)
            assert np.all(np.isfinite(result)), function


def compiled(name: str, real: str, folder: Path, *options: str) -> None:
    """Compile an emitted source; what the compiler complains of becomes the failure."""
    command = ["gcc", *FLAGS, f"-DECCENTRIC_REAL={real}", *options, f"{name}.c"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (0, "") == (done.returncode, done.stderr), done.stderr


def shared(one: Extended, folder: Path) -> ctypes.CDLL:
    """Compile an extended model in double precision and load it."""
    name = one.model.name
    for file, text in one.texts.items():
        (folder / file).write_text(text)
    compiled(name, "double", folder, "-O0", "-shared", "-fPIC", "-o", f"{name}.so")
    return ctypes.CDLL(str(folder / f"{name}.so"))


@pytest.mark.parametrize("name", some_at_work())
def test_the_c_of_extended_models_compiles_and_agrees(name: str, tmp_path: Path) -> None:
    """Strict C99 in both precisions; in double precision the mechanical residual is that of NumPy."""
    given, one = inputs(), with_group(*AT_WORK[name])
    own = {q.name: 0.1 for effect in one.effects for q in effect.coefficients}
    library = shared(one, tmp_path)
    compiled(name, "float", tmp_path, "-fsyntax-only")
    defaults = {q.name: getattr(one.module.Parameters(), q.name) for q in one.model.parameters}
    values = {**defaults, **KNOWN, "F_T": KNOWN["M_l"] * G, **own}
    numbers = [values[q.name] for q in one.model.parameters]
    coefficients = ctypes.create_string_buffer(1 << 16)
    getattr(library, f"{name}_prepare_double")((ctypes.c_double * len(numbers))(*numbers), coefficients)
    residual = getattr(library, f"{name}_mechanical_residual_double")
    residual.restype = ctypes.c_double
    asked = [given[n][:8] for n in arguments(one.module, "mechanical_residual")]
    actual = [residual(*map(ctypes.c_double, row), coefficients) for row in zip(*asked, strict=True)]
    expected = call(one.module, "mechanical_residual", given, **own)[:8]

    np.testing.assert_allclose(actual, expected, rtol=1e-12, atol=1e-14)


def stepped(case: str, effect_id: str, given: Signals, **values: float) -> Signals:
    """Run the hidden states of an effect by the emitted `next_state`: name -> values from the start."""
    module = briefly(case, effect_id)
    names = list(module.STATES)
    now = dict.fromkeys(names, 0.0)
    series = {name: [0.0] for name in names}
    for k in range(len(given["omega_m"])):
        sample = {name: np.array([column[k]]) for name, column in given.items()}
        sample |= {name: np.array([value]) for name, value in now.items()}
        after = np.ravel(call(module, "next_state", sample, **values))
        now = dict(zip(names, map(float, after), strict=True))
        for name in names:
            series[name].append(now[name])
    return {name: np.array(column) for name, column in series.items()}


def motion(**columns: np.ndarray | float) -> Signals:
    """Return inputs of 200 samples 1 ms apart, 0 where not given."""
    names = ("theta_m", "omega_m", "i", "u", "alpha_m", "t", "temperature")
    base = {name: np.zeros(200) for name in names} | {"dt": np.full(200, 1e-3)}
    return base | {name: np.broadcast_to(np.asarray(value, float), 200) for name, value in columns.items()}


def is_timed(name: str) -> bool:
    """Whether hidden states of an extended model are stepped by a time step."""
    states = [state for effect in members(name) for state in effect.change.states]
    return any(v.dt.symbol in sp.sympify(state.update).free_symbols for state in states)


timed = pytest.mark.parametrize("name", [one for one in some_at_work() if is_timed(str(one.values[0]))])


@pytest.mark.parametrize("name", some_at_work())
def test_these_are_timed(name: str) -> None:
    """The step of the others takes no time step."""
    module = with_group(*AT_WORK[name]).module

    assert is_timed(name) == (hasattr(module, "next_state") and "dt" in arguments(module, "next_state"))


@both_precisions
@timed
def test_no_time_changes_no_state(name: str, dtype: type[np.floating]) -> None:
    """A time step of 0, below 0 or below a nanosecond leaves the hidden states as they are, bit for bit."""
    given, one = {x: column.astype(dtype) for x, column in inputs().items()}, with_group(*AT_WORK[name])
    for dt in (0.0, -0.0, -1e-3, -1e30, np.finfo(dtype).smallest_subnormal, 9e-10):
        given["dt"] = np.full(40, dt, dtype)
        before = [given[state.quantity.name] for state in one.model.states]

        after = call(one.module, "next_state", given)

        assert np.stack(before, axis=-1).tobytes() == after.tobytes(), dt


@both_precisions
@timed
def test_every_time_step_gives_finite_states(name: str, dtype: type[np.floating]) -> None:
    """From the smallest number above 0 to 30 years, what the states become is finite."""
    given, one = {x: column.astype(dtype) for x, column in inputs().items()}, with_group(*AT_WORK[name])
    for dt in (np.finfo(dtype).smallest_subnormal, *np.logspace(-40, 9, 99)):
        given["dt"] = np.full(40, dt, dtype)
        assert np.all(np.isfinite(call(one.module, "next_state", given))), dt


@timed
def test_no_time_changes_no_state_in_c(name: str, tmp_path: Path) -> None:
    """`step` of the emitted C leaves the caller's states as they are where no time has passed."""
    one = with_group(*AT_WORK[name])
    states = [state.quantity.name for state in one.model.states]
    library = shared(one, tmp_path)
    coefficients = ctypes.byref(ctypes.c_char.in_dll(library, f"{name}_default_double"))
    asked = [x for x in arguments(one.module, "next_state") if x not in states]
    for dt in (0.0, -1e-3, 5e-324):
        given = {x: float(column[0]) for x, column in inputs().items()} | {"dt": dt}
        own = (ctypes.c_double * len(states))(*(given[state] for state in states))

        step = getattr(library, f"{name}_step_double")
        step(own, *(ctypes.c_double(given[x]) for x in asked), coefficients)

        assert [given[state] for state in states] == list(own), dt


@every_case
def test_heat_is_the_averaged_loss(case: str) -> None:
    """Friction power plus R i^2 through a first-order lag, from signals and known parameters alone."""
    x = motion(theta_m=2.0, omega_m=30.0, i=5.0, alpha_m=12.0)
    gravity = 0.0 if case == "C1" else MU * M * G * L * np.sin(0.4)
    power = (K_I * 5 - J * 12 - gravity) * 30 + R * 25

    actual = stepped(case, "hidden_thermal_drift", x, heat_tau=0.1)["heat_P"]

    np.testing.assert_allclose(actual, power * (1 - (1 + 1e-3 / 0.1) ** -np.arange(201.0)), rtol=1e-10)


def test_bristles_follow_the_travelled_angle() -> None:
    """Dahl's state is 1 - exp(-angle/x) after a start from rest, whatever the speed on the way."""
    speed = np.linspace(1.0, 40.0, 200)
    angle = np.concatenate([[0.0], np.cumsum(speed * 1e-3)])

    actual = stepped("C1", "presliding", motion(omega_m=speed), presliding_x=0.5)["presliding_z"]

    np.testing.assert_allclose(actual, 1 - np.exp(-angle / 0.5), rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("middle", [0.0, 0.9])
def test_the_link_lags_on_the_side_of_its_load(middle: float) -> None:
    """Two masses with a dead zone, by SciPy: about 0 the link changes sides, about 0.9 rad it does not."""
    gap, stiff, damping, dry = 0.02, 4e3, 4.0, 0.02  # rad, N m/rad, N m s/rad, N m at the link
    rate = 2.0 * np.pi * 0.5

    def contact(t: float, angle: float, speed: float) -> float:
        bent = middle + 0.6 * np.sin(rate * t) - angle
        past = bent - np.clip(bent, -gap / 2, gap / 2)
        return stiff * past + (damping * (0.6 * rate * np.cos(rate * t) - speed) if past else 0.0)

    def motion_of(t: float, x: np.ndarray) -> list[float]:
        friction = dry * np.tanh(x[1] / 1e-2) + 0.02 * x[1]
        return [x[1], (contact(t, *x) - M * G * L * np.sin(x[0]) - friction) / J_L]

    time = 2e-3 * np.arange(2001)
    start = [middle - (gap / 2 + M * G * L * np.sin(middle) / stiff), 0.6 * rate]
    angle = solve_ivp(motion_of, (0.0, 4.0), start, "LSODA", time, max_step=1e-3, rtol=1e-7).y[0]
    link = middle + 0.6 * np.sin(rate * time)
    expected = np.sign(np.where(np.abs(link - angle) > 0.4 * gap, link - angle, 0.0))

    given = {name: np.zeros(2001) for name in motion()} | {"dt": np.full(2001, 2e-3)}
    given |= {"theta_m": link / MU, "omega_m": 0.6 * rate * np.cos(rate * time) / MU}
    at = {"backlash_gap": gap / MU, "backlash_arm": dry / ((M + M_L) * G)}
    states = stepped("C2", "backlash[lag]", given, **at)
    actual = (states["backlash_side"] * (1 - 2 * states["backlash_left"]))[:-1]

    known = (expected != 0.0) & (time > 0.5)
    assert np.mean(known[time > 0.5]) > 0.8
    assert np.mean(np.sign(actual[known]) == expected[known]) > 0.95
    assert (middle == 0.0) == (np.min(expected[known]) < 0.0)


def test_lugre_is_that_of_its_paper() -> None:
    """Along swings with reversals, torque and bristles are those of its equations by SciPy, to 1 %."""
    C, S, sigma_0, sigma_1, v_s = 0.02, 0.012, 0.05, 0.003, 4.0

    def speed(t: np.ndarray | float) -> np.ndarray:
        return 6.0 * np.sin(9.0 * np.asarray(t)) + 4.0 * np.sin(23.0 * np.asarray(t) + 0.4)

    def rate(t: np.ndarray | float, z: np.ndarray) -> np.ndarray:
        w = speed(t)
        return w - sigma_0 * np.abs(w) * z / (C + S * np.exp(-((w / v_s) ** 2)))

    time = 1e-3 * np.arange(1001)
    z = solve_ivp(rate, (0.0, 1.0), [0.0], t_eval=time, rtol=1e-9, atol=1e-12, max_step=1e-3).y[0]
    expected = sigma_0 * z + sigma_1 * rate(time, z)

    given = dict.fromkeys(inputs(), np.zeros(1001)) | {"omega_m": speed(time), "dt": np.full(1001, 1e-3)}
    values = {"presliding_x": C / sigma_0, "presliding_v": v_s, "presliding_r": S / C}
    bristles = stepped("C1", "presliding[lugre]", given, **values)["presliding_z"][:-1]
    module = briefly("C1", "presliding[lugre]")
    with_it, without = (
        call(module, "mechanical_friction_torque", given | {"presliding_z": bristles}, **values, **own)
        for own in ({"presliding_A": C, "presliding_D": sigma_1}, {})
    )
    actual = with_it - without + C * np.sign(speed(time))

    for found, wanted in ((actual, expected), (bristles * C / sigma_0, z)):
        assert np.sqrt(np.mean((found - wanted) ** 2)) < 0.01 * np.sqrt(np.mean(wanted**2))


def test_play_follows_with_a_gap() -> None:
    """The play of a current that goes 0, 3, -3, 3 half widths ends one half width behind each turn."""
    current = 2.0 * np.concatenate([np.linspace(0, 3, 50), np.linspace(3, -3, 75), np.linspace(-3, 3, 75)])

    actual = stepped("C1", "magnetic_hysteresis[play]", motion(i=current), hysteresis_i=2.0)["hysteresis_p"]

    np.testing.assert_allclose(actual[[50, 125, 200]], [2.0, -2.0, 2.0], atol=1e-12)


def test_hysteresis_has_two_branches() -> None:
    """Duhem's state is 1 - exp(-rise/width) on a rise from 0, and tends to -1 on a fall."""
    current = np.concatenate([np.linspace(0, 4, 100), np.linspace(4, -40, 100)])

    actual = stepped("C1", "magnetic_hysteresis", motion(i=current), hysteresis_i=2.0)["hysteresis_z"]

    np.testing.assert_allclose(actual[[100, 200]], [1 - np.exp(-2.0), -1.0], atol=1e-8)


def test_gap_opens_when_the_load_changes_its_side() -> None:
    """After a reversal the share of the gap left falls with the angle, and nothing is left in between."""
    speed = np.r_[np.full(100, 50.0), np.full(100, -20.0)]

    actual = stepped("C1", "backlash", motion(omega_m=speed), backlash_gap=0.1)["backlash_left"]

    np.testing.assert_array_equal(actual[:101], 0.0)
    np.testing.assert_allclose(actual[101:106], [0.8, 0.6, 0.4, 0.2, 0.0], atol=1e-12)
    np.testing.assert_array_equal(actual[106:], 0.0)


def test_a_load_that_comes_back_inside_the_gap_has_as_far_to_go_as_it_came() -> None:
    """Three tenths of the gap crossed, then back: three tenths are open, however small the steps."""
    speed = np.r_[np.full(10, 50.0), np.full(30, -1.0), np.zeros(5), np.full(155, 1.0)]

    actual = stepped("C1", "backlash", motion(omega_m=speed), backlash_gap=0.1)["backlash_left"]

    np.testing.assert_allclose(actual[40:46], 0.7, atol=1e-12)
    np.testing.assert_allclose(actual[46:76], 0.3 - 0.01 * np.arange(1, 31), atol=1e-12)
    np.testing.assert_allclose(actual[76:], 0.0, atol=1e-12)


def test_slope_of_the_current_is_its_difference_quotient() -> None:
    """A ramp of the current has its slope as state, from the second sample on."""
    actual = stepped("C1", "sensor_delay", motion(i=7.0 * np.arange(200) * 1e-3))["delay_slope"]

    np.testing.assert_allclose(actual[2:], 7.0, rtol=1e-9)


def test_travel_counts_both_ways() -> None:
    """The travelled angle is the sum of |w| dt."""
    speed = np.r_[np.full(100, 50.0), np.full(100, -20.0)]

    assert pytest.approx(7.0) == stepped("C1", "wear_runin[travel]", motion(omega_m=speed))["wear_s"][-1]
