"""The emitted estimator computes the same in C and in Python, to the bit, whatever comes in."""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eccentric.api.inputs import model_of
from eccentric.emission import inputs_of
from tests.adapted import Estimator, current, emitted, module, motion, python_bits
from tests.emitted import quick
from tests.hosts import lacking

MODELS = ("c1_perpendicular", "c2_parallel", "c2_asymmetric", "rotating_link")


def log(python: Any, count: int, seed: int, dtype: Any) -> list[np.ndarray]:
    """A log of the model's inputs with noise, rows that no estimator may use, friction that jumps."""
    generator = np.random.default_rng(seed)
    moved = motion(count, seed)
    taken: dict[str, Any] = dict(zip(("theta_m", "omega_m", "alpha_m"), moved, strict=True))
    friction = python.model.mechanical_friction_torque(
        *(taken[name] for name in inputs_of(python.model.mechanical_friction_torque))
    )
    friction = np.abs(friction) + 0.08 * (np.arange(count) > 2 * count // 3)
    driven = current(python.model, moved, friction, generator.normal(0, 0.01, count))
    inputs = dict(zip(("theta_m", "omega_m", "alpha_m", "i"), [*moved, driven], strict=True))
    for x in inputs.values():
        x[generator.integers(0, count, 12)] = generator.choice([np.nan, np.inf, -np.inf, 1e30, -3e38], 12)
    driven[generator.integers(0, count, 40)] *= -7.0
    with np.errstate(over="ignore"):
        return [inputs[name].astype(dtype) for name in python.INPUTS]


@pytest.fixture(scope="module")
def folder_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return what gives the folder of a model with its estimator, which is emitted once."""
    return cache(lambda name: emitted(tmp_path_factory.mktemp(name), name))


FEW = {("c1_perpendicular", np.float64), ("c2_parallel", np.float32)}
"""What `make test` has."""


@pytest.mark.parametrize(
    ("name", "dtype", "compiler"),
    [
        pytest.param(
            *(name, dtype, compiler),
            id=f"{name}-{dtype.__name__}-{compiler}",
            marks=() if (name, dtype) in FEW and compiler == "gcc" else pytest.mark.slow,
        )
        for j, name in enumerate(MODELS)
        for k, dtype in enumerate((np.float32, np.float64))
        for n, compiler in enumerate(("gcc", "clang"))
        if n == 0 or (j + k) % 2
    ],
)
def test_same_bits(folder_of: Callable[[str], Path], name: str, dtype: Any, compiler: str) -> None:
    """Flags and every number of the state agree, over rests, reversals, outliers, NaN and infinities."""
    if why := lacking(compiler):
        pytest.skip(why)
    folder = folder_of(name)
    python, c = module(folder, name), Estimator(folder, name, dtype, compiler)
    state = python.init(dtype)
    rows = log(python, 9000, 3, dtype)

    with np.errstate(all="ignore"):
        for start in range(0, 9000, 3000):
            part = [x[start : start + 3000] for x in rows]
            expected = python.replay(*part, state)["flags"].tolist()
            assert expected == c.learn(part)
            assert python_bits(state) == c.bits()
            assert float(python.gain(state)) == c["adapt_gain"](c.state)
    assert state.calls == 9000
    assert np.all(np.isfinite(python_bits(state)))


def test_every_flag_occurs(folder_of: Callable[[str], Path]) -> None:
    """The log of the comparison reaches every branch: each flag is set somewhere."""
    folder = folder_of("c2_parallel")
    python = module(folder, "c2_parallel")

    with np.errstate(all="ignore"):
        rows = log(python, 9000, 3, np.float64)
        seen = np.bitwise_or.reduce(python.replay(*rows, python.init())["flags"])

    flags = ("UPDATED", "STILL", "RANGE", "MORE", "BOUND")
    assert [] == [flag for flag in flags if not seen & getattr(python, flag)]


@pytest.mark.parametrize("name", quick(MODELS, {"c2_parallel"}))
def test_the_models_own_files_stay(folder_of: Callable[[str], Path], name: str) -> None:
    """With the estimator, the model's own files are those without, letter by letter."""
    from eccentric.emission import complete, with_fitted
    from eccentric.emission.defaults import read_parameters
    from tests.adapted import DRIVE

    model = model_of(name)
    plain = complete(with_fitted(model, read_parameters({"parameters": DRIVE}), name), "eccentric emit")

    folder = folder_of(name)

    assert plain == {file: (folder / file).read_text(encoding="utf-8") for file in plain}


def least(k: Any) -> tuple[Any, Any]:
    """A speed, and the least variance of the viscous friction with which a row there is of the least size."""
    for speed in map(k.real, range(5, 50)):
        f = speed * k.SCALE_2
        d = k.LEAST_ZETA / (f * f) * k.real(1.0 - 4.0 * np.finfo(k.real).eps)
        while f * (d * f) < k.LEAST_ZETA:
            d = np.nextafter(d, k.ONE)
        if f * (d * f) == k.LEAST_ZETA:
            return speed, k.real(d)
    raise AssertionError("no such row")


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_row_counts_from_the_same_size_on(folder_of: Callable[[str], Path], dtype: Any) -> None:
    """One of exactly the least size is learned from in C and in Python; the next smaller one in neither."""
    folder = folder_of("c2_parallel")
    python, c = module(folder, "c2_parallel"), Estimator(folder, "c2_parallel", dtype)
    k = python.init(dtype).constants
    speed, variance = least(k)
    learned = []
    for d in (k.real(np.nextafter(variance, k.ZERO)), variance):
        state = python.init(dtype)
        c["adapt_init"](c.state)
        for one in (state, c.state):
            one.settled, one.forward, one.d = 20, 1, [k.ZERO, k.ZERO, d, k.ZERO]
        row = [np.array([x], dtype) for x in (0.3, speed, 0.0, 2.0)]
        flags = python.replay(*row, state)["flags"].tolist()
        assert flags == c.learn(row)
        assert python_bits(state) == c.bits()
        learned.append(bool(flags[0] & python.UPDATED))

    assert [False, True] == learned
