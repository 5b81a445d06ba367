"""The fitting stack against closed forms and other solvers: linear inside, search or iteration outside."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.optimize import curve_fit, lsq_linear

from eccentric.identification import (
    Coefficient,
    Design,
    Nonlinear,
    Signals,
    iterate,
    profile,
    r_squared,
    search,
    slopes_between,
)
from eccentric.identification.drive import Machine
from eccentric.identification.expressions import state_series
from eccentric.model import load_model
from eccentric.model import vocabulary as v
from tests.extended import KNOWN, W_MAX, effects

RNG = np.random.default_rng(11)
ROWS = 200
TRAIN = np.arange(ROWS) % 4 != 0
WEIGHTS = RNG.uniform(0.5, 2.0, ROWS)
COLUMNS = RNG.standard_normal((ROWS, 3))
TARGET = COLUMNS @ [1.0, -2.0, 0.5] + 0.1 * RNG.standard_normal(ROWS)
FREE = tuple(Coefficient(name, "friction", "N m") for name in "abc")


def design(coefficients: tuple[Coefficient, ...] = FREE) -> Design:
    """A design of three columns, a quarter of its rows left out."""
    return Design(coefficients, TARGET, COLUMNS, TRAIN, WEIGHTS)


def test_a_free_design_has_the_solution_of_the_normal_equations() -> None:
    """Without bounds: (X' W X)^-1 X' W y on the fitted rows, and no bound active."""
    x, w, y = COLUMNS[TRAIN], WEIGHTS[TRAIN], TARGET[TRAIN]
    solution = design().solve()
    left = TARGET - COLUMNS @ solution.values

    np.testing.assert_allclose(
        np.linalg.solve(x.T @ (w[:, None] * x), x.T @ (w * y)), solution.values, rtol=1e-10
    )
    np.testing.assert_array_equal(0, solution.active)
    np.testing.assert_allclose(left, solution.residual, rtol=1e-12)
    assert np.sum(w * left[TRAIN] ** 2) == pytest.approx(solution.cost, rel=1e-12)


def test_a_bounded_design_has_the_solution_of_another_algorithm() -> None:
    """Held at zero from below and at 0.8 from above, as a trust-region algorithm finds it, exactly."""
    bounds = ((0.0, 0.8), (0.0, math.inf), (-math.inf, math.inf))
    held = tuple(replace(c, lower=low, upper=high) for c, (low, high) in zip(FREE, bounds, strict=True))
    solution = design(held).solve()
    root = np.sqrt(WEIGHTS[TRAIN])
    other = lsq_linear(
        COLUMNS[TRAIN] * root[:, None],
        TARGET[TRAIN] * root,
        tuple(zip(*bounds, strict=True)),
        method="trf",
        tol=1e-15,
    )

    np.testing.assert_allclose(other.x, solution.values, atol=1e-6)
    np.testing.assert_array_equal([1, -1, 0], solution.active)
    np.testing.assert_array_equal([0.8, 0.0], solution.values[:2])


def test_bounds_of_a_role_can_stay() -> None:
    """Freed of its bounds, a design keeps those of the roles that are excepted."""
    held = (Coefficient("a", "friction", "", 0.0), Coefficient("J_m", "inertia", "", 0.0))
    freed = design(held).without_bounds(but={"inertia"})

    assert [(-math.inf, math.inf), (0.0, math.inf)] == [(c.lower, c.upper) for c in freed.coefficients]
    assert [-math.inf, -math.inf] == list(design(held).without_bounds().lower)


T = np.linspace(0.0, 4.0, ROWS)
DECAY = 3.0 * np.exp(-0.7 * T) + 0.4 + 0.01 * np.random.default_rng(1).standard_normal(ROWS)
RATE = Nonlinear("rate", "1/s", 0.05, 5.0, (4.0, 0.1), 0.1)


@dataclass(frozen=True)
class Decay:
    """A decay to a level: two coefficients, and a rate that does not enter linearly."""

    nonlinear: tuple[Nonlinear, ...] = (RATE,)

    def design(self, at: Mapping[str, float]) -> Design:
        """The design at a rate."""
        columns = np.column_stack([np.exp(-at["rate"] * T), np.ones(ROWS)])
        every = np.ones(ROWS, dtype=bool)
        return Design(FREE[:2], DECAY, columns, every, np.ones(ROWS))


def test_a_search_finds_what_a_nonlinear_fit_of_all_values_finds() -> None:
    """Variable projection and Levenberg-Marquardt on all three values have one minimum, and its errors."""
    found = search(Decay())
    expected, covariance = curve_fit(lambda t, a, c, r: a * np.exp(-r * t) + c, T, DECAY, p0=(1.0, 0.0, 1.0))

    np.testing.assert_allclose(expected, [*found.values, found.at["rate"]], rtol=1e-4)
    # The columns and the slope span what the covariance of all three is made of.
    assert found.slopes is not None
    jacobian = np.column_stack([found.design.columns, found.slopes])
    textbook = np.linalg.inv(jacobian.T @ jacobian) * found.cost / (ROWS - 3)
    np.testing.assert_allclose(np.sqrt(np.diag(covariance)), np.sqrt(np.diag(textbook)), rtol=1e-3)


def test_a_search_begins_at_the_better_start_and_stays_where_it_is_held() -> None:
    """Of two starts the search takes the one with the smaller cost; a fixed value is not searched."""
    at = search(Decay()).at["rate"]

    assert at == pytest.approx(search(Decay(), start={"rate": 1.0}).at["rate"], rel=1e-4)
    assert search(Decay(), fixed={"rate": 2.0}).at == {"rate": 2.0}


def test_what_comes_near_the_end_of_its_range_is_at_its_end() -> None:
    """With the truth outside of the range the value is the end itself, and that end is reported."""
    narrow = replace(RATE, lower=1.0, starts=(3.0,))
    found = search(Decay((narrow,)))

    assert found.at == {"rate": 1.0}
    assert (-1, 0, 1) == tuple(narrow.end_at(value) for value in (1.0, 2.0, 5.0))


def test_a_profile_is_lowest_beside_the_minimum() -> None:
    """Over nine points of the range the error is smallest at the one nearest to the solution."""
    near = replace(RATE, lower=0.3, upper=1.1, starts=(0.5,))
    solution = search(Decay((near,)))
    found = profile(Decay((near,)), solution, near)

    assert len(found.values) == len(found.rmse) == 9
    nearest = int(np.argmin(np.abs(np.array(found.values) - solution.at["rate"])))
    assert nearest == int(np.argmin(found.rmse))
    assert min(found.rmse) >= math.sqrt(solution.cost / ROWS)


def test_slopes_of_a_linear_function_are_its_coefficients() -> None:
    """Each slope is the rise between its two ends, other values held."""
    slopes = slopes_between(
        lambda at: at["a"] * COLUMNS[:, 0] + at["b"] * COLUMNS[:, 1],
        {"a": 1.0, "b": 2.0},
        {"a": (0.5, 1.5), "b": (2.0, 2.25)},
    )

    np.testing.assert_allclose(COLUMNS[:, :2], slopes, atol=1e-12)
    assert slopes_between(lambda _: T, {}, {}).shape == (ROWS, 0)


def test_an_iteration_ends_where_nothing_changes_or_at_its_limit() -> None:
    """The cosine's fixed point is found to the tolerance; with three steps allowed it is three cosines."""

    def cosine(x: float) -> tuple[float, float]:
        return math.cos(x), abs(math.cos(x) - x)

    point, change = iterate(cosine, 1.0, 200, 1e-12)
    assert point == pytest.approx(0.7390851332151607, abs=1e-11)
    assert change < 1e-12
    assert iterate(cosine, 1.0, 3, 1e-12)[0] == math.cos(math.cos(math.cos(1.0)))


LETTERS = {"k_i": 0.05, "k_e": 0.04, "R": 2.0, "J_m": 1e-4, "J_l": 3e-3, "mu": 0.2}


def test_the_machine_of_a_model_is_the_motor_of_the_paper() -> None:
    """Torque k_i i, current (u - k_e w)/R, voltage R i + k_e w, damping k_i k_e/R, inertia J_m + mu^2 J_l."""
    machine = Machine(load_model("c2_parallel"))
    omega, u = np.array([-3.0, 10.0]), np.array([1.0, 6.0])

    np.testing.assert_allclose((u - 0.04 * omega) / 2.0, machine.current(LETTERS, u, omega), rtol=1e-14)
    np.testing.assert_allclose(0.05 * u, machine.torque(LETTERS, u), rtol=1e-14)
    np.testing.assert_allclose(u, machine.current_of_torque(LETTERS, machine.torque(LETTERS, u)), rtol=1e-14)
    np.testing.assert_allclose(2.0 * u + 0.04 * omega, machine.voltage(LETTERS, u, omega), rtol=1e-14)
    assert 1e-4 + 0.2**2 * 3e-3 == pytest.approx(machine.inertia(LETTERS), rel=1e-14)
    assert (1.0, 0.2**2) == pytest.approx([machine.inertia_per(letter, LETTERS) for letter in ("J_m", "J_l")])
    assert str(machine.back_emf_damping) == "k_e*k_i/R"


def test_the_parts_of_an_inertia_are_distinguished_by_what_they_do() -> None:
    """The rotor counts as it is, the link by mu^2: with their letters exchanged, their roles are as well."""
    base, exchanged = load_model("c2_parallel"), {v.J_m.symbol: v.J_l.symbol, v.J_l.symbol: v.J_m.symbol}
    definitions = (replace(d, value=d.value.xreplace(exchanged)) for d in base.definitions)
    other = Machine(replace(base, definitions=tuple(definitions)))

    assert ("J_m", "J_l") == (Machine(base).rotor, Machine(base).link)
    assert ("J_l", "J_m") == (other.rotor, other.link)


def test_r_squared_is_about_zero_torque_not_about_the_mean() -> None:
    """Nothing predicted is 0, all of it 1, a constant predicted to a tenth 0.99: its variance is none."""
    whole = np.full(10, 3.0)

    assert r_squared(whole, whole) == 0.0
    assert r_squared(0.0 * whole, whole) == 1.0
    assert r_squared(0.1 * whole, whole) == pytest.approx(0.99, rel=1e-12)


# Hidden states along a log: skipping samples that change nothing loses none that do.


DT, GAP = 0.01, 0.4  # s, rad


def left_open(omega: np.ndarray) -> list[float]:
    """Return what is left of the gap by its definition: opened by a change of side, closed by the motor.

    A drive stands below a hundredth of the top speed.
    """
    side, left, found = 0.0, 0.0, []
    for w in omega:
        found.append(left)
        now = np.sign(w) if abs(w) > 0.01 * W_MAX else 0.0
        changed = 1.0 if now * side < 0.0 else 0.0
        left = max(0.0, abs(changed - left) - abs(w) * DT / GAP)
        side = now or side
    return found


def test_a_gap_opens_and_closes_as_it_is_defined() -> None:
    """Two runs of swings with rests; the gap closes, is left open at a rest, and opens again half closed."""
    t = DT * np.arange(3000)
    omega = np.where(np.sin(0.7 * t) > 0.9, 0.0, 12.0 * np.sin(2.1 * t) * np.sin(0.4 * t))
    start = 1234  # of the second run, where the side is not known yet
    values = {name: np.zeros_like(t) for name in ("theta_m", "alpha_m", "i", "u")} | {
        "omega_m": omega,
        "t": t,
    }
    model = effects("C1")["backlash"].extend(load_model("c1_perpendicular"))
    signals = Signals(values, np.full_like(t, DT), (0, start), KNOWN)

    actual = state_series(model, signals, {"backlash_gap": GAP})["backlash_left"]
    expected = [*left_open(omega[:start]), *left_open(omega[start:])]

    assert expected == pytest.approx(actual, rel=1e-12, abs=1e-14)
    opened = np.count_nonzero((actual[1:] > 0.0) & (actual[:-1] == 0.0))
    assert opened > 10
    assert 0.2 < np.mean(actual == 0.0) < 0.9


def test_noise_of_a_standing_drive_opens_no_gap() -> None:
    """A speed of random sign before the first motion, small beside the top speed, decides on no side."""
    noise = 0.002 * W_MAX * np.random.default_rng(1).standard_normal(300)
    omega = np.r_[noise, np.full(300, 0.2 * W_MAX), noise, np.full(300, -0.2 * W_MAX)]
    values = {name: np.zeros_like(omega) for name in ("theta_m", "alpha_m", "i", "u", "t")}
    signals = Signals({**values, "omega_m": omega}, np.full_like(omega, DT), (0,), KNOWN)
    model = effects("C1")["backlash"].extend(load_model("c1_perpendicular"))

    left = state_series(model, signals, {"backlash_gap": GAP})["backlash_left"]

    assert not np.any(left[:901])
    assert left[901] > 0.5
