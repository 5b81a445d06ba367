"""The estimator learns friction: its update, its bounds, and what rest and little excitation do to it."""

from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from eccentric.emission.adapt.prior import extreme, joint_deviations
from tests.adapted import Estimator, columns, current, emitted, module, motion
from tests.hosts import need

TRUE = np.array([0.004, 0.08, 0.0004, 0.008]) * [1.2, 0.8, 1.3, 0.9]
NOISE = 0.007  # N m, as the prior assumes: 5 % of the mean friction
FORGETTING = 0.999


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return where the estimator of case C2 is."""
    return emitted(tmp_path_factory.mktemp("adapt"))


@pytest.fixture(scope="module")
def python(folder: Path) -> ModuleType:
    """Return the emitted Python of it."""
    return module(folder, "c2_parallel")


def factors(state: Any) -> np.ndarray:
    """Return P = U diag(d) U' of a state."""
    n = len(state.d)
    U = np.eye(n)
    U.T[np.tril_indices(n, -1)] = state.u
    return U @ np.diag(state.d) @ U.T


def driven(python: ModuleType, moved: Any, coefficients: np.ndarray, seed: int = 0) -> np.ndarray:
    """Return the current of a drive with these coefficients, and noise."""
    noise = np.random.default_rng(seed).normal(0, NOISE, len(moved[0]))
    return current(python.model, moved, np.abs(columns(python.model, moved) @ coefficients), noise)


def test_an_update_is_that_of_the_information(python: ModuleType) -> None:
    """Rows change P and coefficients as forgetting by direction says, in the information matrix."""
    moved = motion(3000, 2, still=0.0)
    inputs = [*moved, driven(python, moved, TRUE)]
    state = python.init()
    first = python.replay(*(x[:2500] for x in inputs), state)["flags"]
    assert first[-1] == python.UPDATED  # well within a swing
    own = columns(python.model, moved) @ TRUE
    p = python.model.Parameters()
    theta, _, alpha, i = inputs
    torque = p.k_i * i - (p.J_m + p.mu**2 * p.J_l) * alpha - p.mu * p.M * p.g * p.L * np.sin(p.mu * theta)
    assert np.std(torque - own) == pytest.approx(NOISE, rel=0.05)
    sigma, spread = 1 / python._DOUBLE.PER_NOISE, np.array(python._DOUBLE.step)
    rows = columns(python.model, moved) * spread / sigma

    for k in range(2500, 2600):
        # The next coefficient in turn is forgotten a little in any case.
        state.d[state.turn] *= 1 + 4 * (1 - FORGETTING) / 16
        P, x = factors(state), np.array(state.coefficient)
        state.d[state.turn] /= 1 + 4 * (1 - FORGETTING) / 16
        row, zeta = rows[k], rows[k] @ P @ rows[k]
        information = np.linalg.inv(P) + (FORGETTING - (1 - FORGETTING) / zeta) * np.outer(row, row)
        e = (torque[k] - columns(python.model, moved)[k] @ x) / sigma
        flags = python.adapt(*(c[k] for c in inputs), state)
        if not flags & python.UPDATED:
            continue
        np.testing.assert_allclose(factors(state), np.linalg.inv(information), rtol=1e-9, atol=1e-15)
        np.testing.assert_allclose(state.coefficient, x + spread * (P @ row) * e / (1 + zeta), rtol=1e-9)


@pytest.mark.parametrize("j", range(4))
def test_a_bound_is_kept_at_the_least_error(python: ModuleType, j: int) -> None:
    """If coefficient j is put on its bound, the others become what then has the least error, with j given."""
    moved = motion(1500, 2, still=0.0)
    state = python.init()
    python.replay(*moved, driven(python, moved, TRUE), state)
    spread = np.array(python._DOUBLE.step)
    x = np.array(state.coefficient)
    x[j] = -0.1 * spread[j]

    python._project(state, state.constants, x.tolist(), j)

    information = np.linalg.inv(factors(state))
    free = np.arange(4) != j
    shift = -np.linalg.solve(information[np.ix_(free, free)], information[free, j]) * 0.1
    assert state.coefficient[j] == pytest.approx(0.0, abs=1e-15)
    assert np.array(state.coefficient)[free] == pytest.approx(x[free] + spread[free] * shift, rel=1e-9)


def test_no_coefficient_leaves_its_bounds(python: ModuleType) -> None:
    """On a drive with one coefficient below zero it is often at its bound, and never below."""
    moved = motion(6000, 2, still=0.0)
    state = python.init()

    course = python.replay(*moved, driven(python, moved, TRUE * [1, 1, 1, -4]), state)

    assert np.min(course["coefficients"]) == 0.0
    assert np.count_nonzero(course["flags"] & python.BOUND) > 100


STEPS, HALF = 400_000, 20_000


@pytest.fixture(scope="module")
def in_turns() -> tuple[np.ndarray, ...]:
    """Return 400 s at 1 kHz: 20 s of motion and 20 s of rest in turn, the encoder trembling at rest."""
    _, omega, alpha = motion(STEPS, 1, still=0.0)
    moving = np.arange(STEPS) % (2 * HALF) < HALF
    tremble = np.random.default_rng(8).normal(0, 1e-3, STEPS) * ~moving
    return np.cumsum(omega * moving) * 1e-3, omega * moving + tremble, alpha * moving


def plain_covariance(rows: np.ndarray, torque: np.ndarray, start: np.ndarray) -> int | None:
    """Return the step at which a variance turns negative in plain least squares, in single precision."""
    real = np.float32
    P, x, forgetting = np.eye(4, dtype=real), start.astype(real), real(FORGETTING)
    for k, (row, y) in enumerate(zip(rows.astype(real), torque.astype(real), strict=True)):
        gain = P @ row
        zeta = row @ gain
        if zeta < 0 or np.min(np.diag(P)) < 0:
            return k
        x += gain * (y - row @ x) / (forgetting + zeta)
        P = (P - np.outer(gain, gain) / (forgetting + zeta)) / forgetting
    return None


def plain_factors(rows: np.ndarray, torque: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Return the course of least squares with forgetting in U-D factors, textbook form (Bierman 1977)."""
    n = 4
    U, d, x = np.eye(n), np.ones(n), start.copy()
    course = np.empty((len(rows), n))
    for k, (row, y) in enumerate(zip(rows, torque, strict=True)):
        f = U.T @ row
        v = d * f
        alpha, gain = FORGETTING, np.zeros(n)
        for j in range(n):
            before, alpha = alpha, alpha + v[j] * f[j]
            d[j] *= before / alpha / FORGETTING
            old = U[:j, j].copy()
            U[:j, j] -= gain[:j] * f[j] / before
            gain[:j] += v[j] * old
            gain[j] = v[j]
        x += gain * (y - row @ x) / alpha
        course[k] = x
    return course


def test_rest_does_not_wind_it_up(folder: Path, python: ModuleType, in_turns: Any) -> None:
    """At rest no bit of the coefficients changes; in motion they stay within 6 standard deviations."""
    c = Estimator(folder, "c2_parallel", np.float32)
    inputs = [x.astype(np.float32) for x in [*in_turns, driven(python, in_turns, TRUE)]]
    previous = list(c.state.coefficient)

    for start in range(0, STEPS, HALF):
        c.learn([x[start : start + HALF] for x in inputs])
        deviation = np.array([c["adapt_deviation"](c.state, j) for j in range(4)])
        found = np.array(list(c.state.coefficient))
        assert np.all(np.abs(found - TRUE) < 6 * deviation)
        assert np.all(deviation < TRUE / 2)
        if start // HALF % 2:
            assert previous == list(c.state.coefficient)
            assert c["adapt_unseen"](c.state, 0) == pytest.approx(HALF, abs=50)
        previous = list(c.state.coefficient)


@pytest.mark.slow
def test_plain_least_squares_winds_up(python: ModuleType, in_turns: Any) -> None:
    """On this log the plain covariance turns negative after the first rest, and plain U-D drifts off."""
    sigma, spread = 1 / python._DOUBLE.PER_NOISE, np.array(python._DOUBLE.step)
    first = slice(0, 5 * HALF)
    rows = columns(python.model, [x[first] for x in in_turns]) * spread / sigma
    rows[np.abs(in_turns[1][first]) < 0.01] = 0.0  # an encoder that stands still
    noise = np.random.default_rng(0).normal(0, 1, STEPS)[first]
    torque = rows @ (TRUE / spread) + noise
    start = np.array(python._DOUBLE.start) / spread

    negative = plain_covariance(rows, torque, start)
    course = plain_factors(rows, torque, start) * spread

    assert negative is not None
    assert 2 * HALF < negative < 2 * HALF + 100
    wandered = np.max(np.abs(course[HALF : 2 * HALF + 500] - TRUE), axis=0)
    assert np.all(wandered / TRUE > 3)


# The gain for a compensation: how much of the learned friction is there for sure.


def states(python: ModuleType, angles: int, speeds: int) -> np.ndarray:
    """The regressor (m, 4) over a turn and both directions, 1 to 40 rad/s, times the sign of the motion."""
    turn = np.linspace(0.0, 2.0 * np.pi / python.model.Parameters().mu, angles, endpoint=False)
    speed = np.geomspace(1.0, 40.0, speeds)
    theta, omega = (x.ravel() for x in np.meshgrid(turn, np.concatenate((-speed, speed))))
    return columns(python.model, (theta, omega, 0.0 * omega)) * np.sign(omega)[:, None]


def test_the_gain_is_the_bound_at_the_worst_state(python: ModuleType) -> None:
    """One less so many standard deviations of the friction over it: of P, at the worst of 2,304 states."""
    moved = motion(4000, 5)
    state = python.init()
    python.replay(*moved, driven(python, moved, TRUE), state)
    deviation = np.array(python._DOUBLE.step)
    rows = states(python, 48, 24)
    P = factors(state) * np.outer(deviation, deviation) * state.square * (1 + state.rho) / (1 - state.rho)
    over = np.sqrt(np.einsum("ki,ij,kj->k", rows, P, rows)) / (rows @ state.coefficient)
    expected = 1.0 - python._DOUBLE.DEVIATIONS * over.max()

    assert 0.7 < expected < 0.95
    assert python.gain(state) == pytest.approx(expected, abs=5e-3)


def test_so_much_friction_is_there(folder: Path, python: ModuleType) -> None:
    """Of 200 drives drawn from the prior, at three moments, at most 2.5 % have less than it anywhere."""
    need("gcc")
    c = Estimator(folder, "c2_parallel", np.float64)
    k, rows, missed, gains = python._DOUBLE, states(python, 24, 12), 0, []
    for seed in range(200):
        random = np.random.default_rng(seed)
        true = np.clip(random.normal(k.start, k.step), 0.02 * np.array(k.start), k.highest)
        moved = motion(3000, 1000 + seed)
        friction, noise = np.abs(columns(python.model, moved) @ true), random.normal(0, NOISE, 3000)
        i = current(python.model, moved, friction, noise)
        c["adapt_init"](c.state)
        for start, end in ((0, 500), (500, 1000), (1000, 3000)):
            c.learn([x[start:end] for x in (*moved, i)])
            gains.append(c["adapt_gain"](c.state))
            learned = rows @ np.array(list(c.state.coefficient))
            missed += bool(np.any(rows @ true < gains[-1] * learned))

    assert missed <= 0.025 * len(gains)
    assert np.median(gains[2::3]) > 0.75


def test_what_is_not_known_is_not_compensated(python: ModuleType) -> None:
    """At the prior little is sure; noise beyond it, or innovations that are all alike, leave nothing."""
    state = python.init()
    assert 0.0 < python.gain(state) < 0.5
    state.square = 100.0
    assert python.gain(state) == 0.0
    state.square, state.rho = 1.0, 0.96875
    assert python.gain(state) == 0.0


def test_rows_between_others_bound_nothing_more() -> None:
    """Of rows over their friction those that are sums of others are left out; so are doubles."""
    values = np.array([1.0, 1.0])
    rows = np.array([[1.0, 0.0], [0.0, 2.0], [3.0, 3.0], [0.2, 0.1], [2.0, 0.0]])

    assert sorted(map(tuple, extreme(rows, values))) == [(0.0, 1.0), (1.0, 0.0)]


def test_all_states_together_take_more_deviations() -> None:
    """One row has a one-sided quantile; many rows have at most the ellipsoid, by a chi squared."""
    assert joint_deviations(1, 4) == pytest.approx(1.959964, rel=1e-6)
    assert joint_deviations(5, 4) == pytest.approx(2.575829, rel=1e-6)  # 0.5 %
    assert joint_deviations(10**6, 2) == pytest.approx(np.sqrt(-2 * np.log(0.025)), rel=1e-12)
