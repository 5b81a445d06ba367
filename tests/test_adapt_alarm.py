"""The alarm of the estimator: as rare as asked, and as quick as can be."""

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.signal import lfilter

from eccentric.core import InputError
from eccentric.emission.adapt import alarm_of, run_length, threshold_of
from tests.adapted import Estimator, columns, current, emitted, module, motion
from tests.emitted import quick

NOISE = 0.007
ASKED = 1e4


@pytest.mark.parametrize(
    ("threshold", "shift", "printed"),
    [(4, 0.0, 168), (5, 0.0, 465), (4, 1.0, 8.38), (5, 1.0, 10.4), (4, 2.0, 3.34), (5, 3.0, 2.57)],
)
def test_run_lengths_are_those_of_the_tables(threshold: float, shift: float, printed: float) -> None:
    """For k = 1/2 they are Montgomery's (Statistical Quality Control, table 9.3), of both sums."""
    up, down = run_length(0.5, threshold, shift), run_length(0.5, threshold, -shift)

    assert 1 / (1 / up + 1 / down) == pytest.approx(printed, rel=4e-3)


def test_a_run_length_is_that_of_a_simulation() -> None:
    """20,000 simulated runs take as long as the integral equation says, within 4 standard errors."""
    generator, runs = np.random.default_rng(2), 20_000
    total, length, alive = np.zeros(runs), np.zeros(runs), np.ones(runs, bool)
    while np.any(alive):
        total = np.maximum(0.0, total + generator.normal(0.3, 1, runs) - 0.7)
        length += alive
        alive &= total <= 3.0

    assert np.mean(length) == pytest.approx(run_length(0.7, 3.0, 0.3), abs=4 * np.std(length) / runs**0.5)


@pytest.mark.parametrize(
    ("asked", "shift"),
    quick(itertools.product((1e3, 1e7, 1e10), (0.5, 1.0, 2.0)), {(1e3, 0.5), (1e7, 1.0), (1e10, 2.0)}),
)
def test_the_threshold_has_what_is_asked(shift: float, asked: float) -> None:
    """False alarms are as rare as asked; two sums need ln 2 over the information of a row more than one."""
    found = alarm_of(shift, asked)

    assert found.between == pytest.approx(asked, rel=1e-4)
    assert found.delay - found.bound == pytest.approx(2 * np.log(2) / shift**2, rel=0.05)


@pytest.mark.parametrize("shift", quick((0.5, 1.0, 2.0), {0.5}))
def test_no_sum_of_the_same_rate_is_below_the_bound(shift: float) -> None:
    """Sums with another reference have greater delays from 0, their worst moment: Moustakides' theorem."""
    bound = alarm_of(shift, 1e4).bound

    for reference in np.array([0.2, 0.4, 0.48, 0.52, 0.6, 0.8]) * shift:
        own = run_length(reference, threshold_of(reference, 1e4), shift)
        assert own > bound


@pytest.mark.parametrize("shift", quick((0.5, 1.0, 2.0), {1.0}))
def test_the_bound_grows_as_lordens(shift: float) -> None:
    """What they differ by stays, so that their ratio tends to 1."""
    rare, rarer = alarm_of(shift, 1e6), alarm_of(shift, 1e10)

    assert rare.lorden == pytest.approx(2 * np.log(1e6) / shift**2)
    assert rarer.bound - rare.bound == pytest.approx(rarer.lorden - rare.lorden, rel=1e-2)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return where an estimator is that may give an alarm in 10,000 samples."""
    return emitted(tmp_path_factory.mktemp("alarm"), false_alarms=ASKED)


def learned(folder: Path, count: int, colour: float, size: float, step: float = 0.0) -> Any:
    """Return flags of a drive with such noise; Coulomb friction steps at half time."""
    python = module(folder, "c2_parallel")
    moved = motion(count, 1, still=0.0)
    friction = columns(python.model, moved) @ python.model.friction_coefficients()
    friction = np.abs(friction) + step * (np.arange(count) >= count // 2)
    white = np.random.default_rng(5).normal(0, size, count)
    noise = lfilter([np.sqrt(1 - colour**2)], [1, -colour], white)
    c = Estimator(folder, "c2_parallel", np.float32)
    inputs = [*moved, current(python.model, moved, friction, noise)]
    return python, np.array(c.learn([x.astype(np.float32) for x in inputs]))


@pytest.mark.slow
@pytest.mark.parametrize(("colour", "size"), [(0.0, 1.0), (0.8, 1.0), (0.5, 2.0)])
def test_false_alarms_are_as_rare_as_asked(folder: Path, colour: float, size: float) -> None:
    """In the whole estimator, with noise of other colour and size: within 3 standard errors."""
    python, flags = learned(folder, 1_500_000, colour, size * NOISE)

    rows = np.count_nonzero(~(flags & (python.STILL | python.RANGE)).astype(bool))
    alarms = np.count_nonzero(flags & (python.MORE | python.LESS))
    expected = rows / ASKED
    assert abs(alarms - expected) < 3 * expected**0.5


def test_a_step_of_friction_is_announced(folder: Path) -> None:
    """More friction by 20 % of Coulomb's is announced as more, within five mean delays."""
    step = 0.2 * 0.118
    python, flags = learned(folder, 60_400, 0.0, NOISE, step)

    after = flags[30_200:]
    rows = np.flatnonzero(~(after & (python.STILL | python.RANGE)).astype(bool))
    announced = np.flatnonzero(after & python.MORE)
    assert 0 == np.count_nonzero(after[: announced[0]] & python.LESS)
    assert np.searchsorted(rows, announced[0]) < 5 * python.ALARM["delay"]


def test_a_rate_out_of_range_is_refused() -> None:
    """False alarms in every sample, or none ever, cannot be asked for, and forgetting has its range too."""
    from eccentric.emission import Adaptation

    refused: list[dict[str, Any]] = [
        {"false_alarms": 1.0},
        {"false_alarms": float("inf")},
        {"forgetting": 1.0},
        {"forgetting": 0.1},
    ]
    for wrong in refused:
        with pytest.raises(InputError, match=r"expected a number .*, got"):
            Adaptation(**wrong)
