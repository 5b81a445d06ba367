"""What is drawn: bins and traces hold all rows, add up, and say how many rows a point represents."""

from dataclasses import replace

import numpy as np
import pytest

from eccentric.presentation.html.arrays import BalanceResiduals, Channel
from eccentric.presentation.html.panels import (
    POINTS,
    Panel,
    friction_panel,
    leading_panel,
    residual_panel,
    trace,
)
from tests.reported import balance_of, rows_of


def drawn_over(balance: BalanceResiduals, key: str) -> Panel:
    """The panel of the residual over a channel."""
    channel = balance.rows.channel(key)
    assert channel is not None
    panel = residual_panel(balance, channel)
    assert panel is not None
    return panel


@pytest.mark.parametrize("n", [50, 5000, 40000])
@pytest.mark.parametrize("key", ["velocity", "link_angle", "current", "time"])
def test_every_moving_row_is_in_a_bin_or_counted(n: int, key: str) -> None:
    """The rows of the marks and those left out are all the rows, fitted and held out."""
    panel = drawn_over(balance_of(rows_of(n)), key)

    assert n == panel.rows.sum() + panel.left_out


def test_the_leading_panel_is_over_one_period_where_the_effect_has_one() -> None:
    """Sixty bins of a turn blur 24 periods; a bump at one angle is only seen over the whole turn."""
    rows = rows_of(40000)
    turn = rows.channels[1]
    part = replace(turn, period=2 * np.pi / 24)
    ripple, bump = np.sin(24 * turn.values), np.exp(20 * (np.cos(turn.values - 2.0) - 1.0))

    for effect, expected in ((ripple, part), (bump, turn)):
        balance = replace(balance_of(rows), paper=effect, extended=0.0 * effect)
        panel = leading_panel(balance, (turn, part))
        assert panel is not None
        assert panel.channel == expected
    none = replace(rows, train=np.zeros(40000, bool), held_out=np.zeros(40000, bool))
    assert leading_panel(replace(balance_of(rows), rows=none), (turn, part)) is None


def test_bars_are_quantiles_of_the_rows_of_their_bin() -> None:
    """By `numpy.quantile`, for an angle in sixty bins of a turn; the mean is NumPy's too."""
    balance = balance_of(rows_of(5000))
    velocity = balance.rows.channels[0]
    panel = drawn_over(balance, "link_angle")
    place = np.floor(np.mod(panel.channel.values, 2 * np.pi) / (2 * np.pi) * 60).astype(int)

    assert 60 == len(panel.at)
    facing = balance.paper * np.sign(velocity.values)
    for k in range(60):
        own, drawn = facing[place == k], panel.curves["before"]
        expected = (np.quantile(own, 0.1), np.mean(own), np.quantile(own, 0.9))
        assert np.allclose(expected, (drawn.low[k], drawn.middle[k], drawn.high[k]), rtol=1e-12)


def test_before_is_after_plus_effect_in_every_bin() -> None:
    """The fitted effect that is drawn is what lies between the two residuals."""
    balance = balance_of(rows_of(5000))
    for channel in balance.rows.channels:
        means = {name: curve.middle for name, curve in drawn_over(balance, channel.key).curves.items()}

        assert np.allclose(means["before"], means["after"] + means["effect"], atol=1e-15, equal_nan=True)


def test_the_curve_over_velocity_is_broken_at_zero() -> None:
    """Friction of 0.1 N m jumps by 0.2 there; no point is a mean of both directions."""
    omega = np.random.default_rng(3).uniform(-5.0, 8.0, 5000)
    rows = replace(rows_of(5000), channels=(Channel("velocity", "velocity", "rad/s", omega),))
    balance = replace(balance_of(rows_of(5000)), rows=rows, measured=0.1 * np.sign(omega))
    panel = friction_panel(balance, rows.channels[0])
    assert panel is not None
    gap = np.flatnonzero(np.isnan(panel.at))

    assert 1 == len(gap)
    assert panel.at[gap[0] - 1] < 0.0 < panel.at[gap[0] + 1]
    np.testing.assert_allclose(panel.curves["measured"].middle, 0.1 * np.sign(panel.at), rtol=1e-12)


def test_a_mean_of_a_line_lies_on_the_line() -> None:
    """Friction that is linear in a channel is drawn on that line, without a shift by the bins."""
    rows = rows_of(5000)
    x = np.random.default_rng(3).exponential(2.0, 5000)
    rows = replace(rows, channels=(Channel("acceleration", "a", "rad/s²", x),))
    balance = replace(balance_of(rows_of(5000)), rows=rows, measured=0.5 - 0.25 * x)
    panel = friction_panel(balance, rows.channels[0])

    assert panel is not None
    assert np.allclose(0.5 - 0.25 * panel.at, panel.curves["measured"].middle, equal_nan=True)


def test_an_angle_is_drawn_over_one_turn() -> None:
    """0.03 sin(2 theta_l), planted against the motion, comes out over the wrapped link angle."""
    panel = drawn_over(balance_of(rows_of(40000)), "link_angle")

    assert np.ptp(panel.channel.values) > 2 * np.pi
    assert panel.against_motion
    assert 0.0 <= np.nanmin(panel.at) < np.nanmax(panel.at) < 2 * np.pi
    # A bin is a sixtieth of a turn wide: its mean is within the square of that of the value in the middle.
    assert np.allclose(
        0.03 * np.sin(2 * panel.at), panel.curves["effect"].middle, atol=0.03 * (2 * np.pi / 60) ** 2
    )


def test_a_load_that_does_not_turn_with_the_motion_is_drawn_as_it_is() -> None:
    """A residual that keeps its sign at reversal is not counted against the motion."""
    balance = balance_of(rows_of(5000))
    channel = balance.rows.channel("time")
    assert channel is not None
    panel = residual_panel(replace(balance, paper=0.02 * channel.values, extended=None), channel)

    assert panel is not None
    assert not panel.against_motion
    assert {"before"} == set(panel.curves)


def test_rows_that_are_not_numbers_are_left_out() -> None:
    """NaN in a channel takes its row out of that panel and of no other."""
    balance = balance_of(rows_of(5000))
    values = balance.rows.channels[2].values.copy()
    values[:700] = np.nan
    panel = residual_panel(balance, replace(balance.rows.channels[2], values=values))

    assert panel is not None
    assert 4300 == panel.rows.sum() + panel.left_out


@pytest.mark.parametrize(("n", "runs", "decimated"), [(600, 1, False), (5000, 1, False), (99999, 3, True)])
def test_a_trace_holds_every_held_out_row(n: int, runs: int, decimated: bool) -> None:
    """Extremes of the held-out rows are in the band, points are bounded in number, short parts exact."""
    balance = balance_of(rows_of(n, runs))
    held = balance.rows.held_out
    found = trace(balance)

    assert found is not None
    assert balance.measured is not None
    drawn = found.curves["measured"]
    assert np.count_nonzero(held) == found.rows
    assert (balance.measured[held].min(), balance.measured[held].max()) == (
        np.nanmin(drawn.low),
        np.nanmax(drawn.high),
    )
    assert decimated == (found.rows_per_point > 1)
    assert np.count_nonzero(np.isfinite(found.at)) <= POINTS + 2 * runs
    if not decimated:
        assert np.array_equal(balance.measured[held], drawn.middle[np.isfinite(drawn.middle)])


def test_the_time_axis_of_a_trace_runs_forwards_and_marks_its_cuts() -> None:
    """Runs that all start at zero, and what was fitted in between, are cut out at marked places."""
    balance = balance_of(rows_of(9000, 3))
    found = trace(balance)

    assert found is not None
    at = found.at[np.isfinite(found.at)]
    assert np.all(np.diff(at) > 0)
    # Two held-out stretches in each of three runs.
    assert 5 == len(found.cuts)
    assert {0, 1, 2} == set(found.run[np.isfinite(found.at)])


def test_nothing_is_drawn_of_nothing() -> None:
    """Without held-out rows there is no trace, without three rows no panel, without friction no friction."""
    balance = balance_of(rows_of(5000))
    none = np.zeros(5000, bool)
    empty = replace(balance, rows=replace(balance.rows, train=none, held_out=none))

    assert trace(empty) is None
    assert residual_panel(empty, empty.rows.channels[0]) is None
    assert friction_panel(replace(balance, measured=None), balance.rows.channels[0]) is None
