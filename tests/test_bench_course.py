"""The reference speed of the virtual bench, and what of it is held out, against closed forms."""

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.virtual_bench import on_reference, random_scenario, simulate
from eccentric.virtual_bench.scenario import Course, speed_runs, sum_of_sines

SEEDS = range(200)
TOP = 30.0
"""Greatest reference speed [rad/s]."""


def test_constant_speeds_are_joined_by_smooth_ramps() -> None:
    """Between two speeds the course is 3 x^2 - 2 x^3 of the way, x the share of the ramp that has passed."""
    course = Course("runs", 6.0, (), (4.0, -2.0), starts=(0.0, 3.0), ramp_s=0.4)
    x = 0.25

    expected = [0.0, 4.0 * (3 * x**2 - 2 * x**3), 2.0, 4.0, 4.0, 4.0 - 6.0 * (3 * x**2 - 2 * x**3), -2.0]
    assert expected == pytest.approx(
        course.reference(np.array([0.0, 0.1, 0.2, 0.4, 3.0, 3.1, 3.4])), abs=1e-12
    )


def test_a_trajectory_is_the_sum_of_its_sines_after_a_second() -> None:
    """A cosine of 2 rad/s and 0.5 Hz and a sine of 1 rad/s and 0.25 Hz, faded in over the first second."""
    course = Course("traj", 10.0, (), (2.0, 1.0), frequencies=(0.5, 0.25), phases=(np.pi / 2, 0.0))
    time = np.array([0.0, 0.5, 1.0, 2.0, 7.0])

    whole = 2.0 * np.cos(np.pi * time) + np.sin(0.5 * np.pi * time)
    assert whole * [0.0, 0.5, 1.0, 1.0, 1.0] == pytest.approx(course.reference(time), abs=1e-12)


def test_speed_runs_fill_the_log_and_the_range() -> None:
    """Runs of 1.5 to 4.5 s from the start on; speeds of either sign from 7 to 100 % of the top speed."""
    for seed in SEEDS:
        course = speed_runs(np.random.default_rng(seed), 60.0, TOP)
        lengths, sizes = np.diff([*course.starts, 60.0]), np.abs(course.speeds)

        assert 0.0 == course.starts[0]
        assert len(course.starts) == len(course.speeds) == 22
        assert 1.5 < lengths.min() < lengths.max() < 4.5
        assert 0.92 * 0.94 * 0.08 * TOP - 1e-3 <= sizes.min() < 0.1 * TOP
        assert 0.9 * TOP < sizes.max() <= TOP


def test_held_out_runs_are_one_of_each_fifth_and_never_the_first_or_the_fastest() -> None:
    """Five whole runs; the first, from rest, and the fastest of either direction are trained on."""
    for seed in SEEDS:
        course = speed_runs(np.random.default_rng(seed), 60.0, TOP)
        edges = [*course.starts, 60.0]
        held = [edges.index(low) for low, _ in course.holdout]

        assert [(edges[k], edges[k + 1]) for k in held] == list(course.holdout)
        assert [0, 1, 2, 3, 4] == [next(f for f in range(5) if k < (f + 1) * 22 // 5) for k in held]
        assert set() == {0, int(np.argmax(course.speeds)), int(np.argmin(course.speeds))} & set(held)


def test_held_out_blocks_of_a_trajectory_are_one_of_each_fifth_and_never_the_first() -> None:
    """Blocks of 4 % of the log; all but the first, where the motion fades in, are held out in some log."""
    seen = set()
    for seed in SEEDS:
        blocks = [
            (round(low * 25 / 60), round(high * 25 / 60))
            for low, high in sum_of_sines(np.random.default_rng(seed), 60.0, TOP).holdout
        ]
        assert [0, 1, 2, 3, 4] == [low // 5 for low, _ in blocks]
        assert {1} == {high - low for low, high in blocks}
        seen |= {low for low, _ in blocks}

    assert set(range(1, 25)) == seen


def test_sines_go_from_slow_to_fast_below_the_top_speed() -> None:
    """Six sines from about 0.06 to about 1.1 Hz whose amplitudes sum to the top speed over 0.85."""
    for seed in SEEDS:
        course = sum_of_sines(np.random.default_rng(seed), 60.0, TOP)
        slow, *_, fast = course.frequencies

        assert 6 == len(course.speeds) == len(course.phases)
        assert 0.05 < slow < 0.07
        assert 0.9 < fast < 1.25
        assert TOP / 0.85 == pytest.approx(sum(course.speeds), abs=0.01)
        assert min(course.speeds) > 0.59 * max(course.speeds)


def test_a_reference_is_driven_by_the_same_drive() -> None:
    """Friction, effect and its amplitude are those of the first run; the speed is that of the reference."""
    rng = np.random.default_rng(4)
    first = simulate(
        random_scenario(rng, case="C1", mu=0.2, log_type="runs", effects=["stribeck"], seconds=15.0)
    )
    time = np.linspace(0.0, 15.0, 301)
    speed = 12.0 * np.sin(0.8 * time)
    again = simulate(on_reference(first.scenario, time, speed, 0.5), again=True)
    log = again.columns
    late = log["time_s"] > 2.0

    assert first.scenario.effects == again.scenario.effects
    assert first.truth["hidden_parameters"] == again.truth["hidden_parameters"]
    assert first.rig["known"] == again.rig["known"]
    assert log["theta_m_rad"][0] == pytest.approx(0.5, abs=0.01)
    expected = np.interp(log["time_s"], time, speed)[late]
    # A loop of some hertz follows 0.13 Hz within a few per cent, but for reversals, where it sticks.
    assert np.median(np.abs(log["omega_m_rad_s"][late] - expected)) < 0.05 * 12.0


@pytest.mark.parametrize(
    ("time", "speed", "said"),
    [
        ([0.0, 1.0], [1.0], "as many speeds as times"),
        ([1.0, 2.0], [1.0, 2.0], "times that rise from 0"),
        ([0.0, 1.0], [1.0, np.nan], "finite speeds"),
    ],
)
def test_a_reference_that_is_none_is_refused(time: list[float], speed: list[float], said: str) -> None:
    """What a drive cannot follow."""
    scenario = random_scenario(np.random.default_rng(1), case="C1", mu=0.2, log_type="runs", seconds=15.0)
    with pytest.raises(InputError, match=said):
        on_reference(scenario, np.array(time), np.array(speed), 0.0)
