"""What a candidate gains must be there without the noise of its own signals: columns of known projection."""

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from eccentric.diagnosis.search import balances, instruments_of, limits
from eccentric.diagnosis.search.candidate import Candidate
from eccentric.effects import Shape
from eccentric.model import quantity
from eccentric.virtual_bench import simulate
from tests.identified import prepared
from tests.searched import NOISE, SIZE, N, adopted, candidate, mixed, search
from tests.virtual import drawn_scenario

OWN, OTHER = 2, 5


def seen_through(share: float) -> Candidate:
    """A candidate whose instrument has this part of its squared length in the candidate's own column."""
    instrument = mixed({OWN: math.sqrt(share), OTHER: math.sqrt(1.0 - share)})[:, None]
    return replace(candidate("a", {OWN: 1.0}), instrument=lambda _: instrument)


def gained(amplitude: float, share: float) -> float:
    """The deviance of the instrument: it leaves 1 + b^2 (1 - share) of 1 + b^2."""
    return N * math.log((1.0 + amplitude**2) / (1.0 + amplitude**2 * (1.0 - share)))


def test_a_candidate_that_is_its_own_instrument_is_adopted() -> None:
    """Where the noise of its signals is none of the target's, nothing changes."""
    assert ["a"] == adopted(search({OWN: 1.0}, seen_through(1.0)))


def test_what_gains_by_its_own_noise_alone_is_not_adopted() -> None:
    """Its instrument is orthogonal to the target; the same candidate without one is adopted."""
    assert ["a"] == adopted(search({OWN: 1.0}, candidate("a", {OWN: 1.0})))
    assert [] == adopted(search({OWN: 1.0}, seen_through(0.0)))


def test_the_instrument_must_gain_more_than_chance() -> None:
    """The share that just reaches the threshold, by the closed form of the gain."""
    amplitude = math.sqrt(math.expm1(30.0 / N))
    for above, expected in ((0.97, []), (1.03, ["a"])):
        share = -math.expm1(-above * limits.CONFIRMED / N) * (1.0 + amplitude**2) / amplitude**2

        assert gained(amplitude, share) == pytest.approx(above * limits.CONFIRMED, rel=1e-9)
        assert share > limits.CONFIRMED_PART
        assert expected == adopted(search({OWN: amplitude}, seen_through(share)))


def with_the_noise_of_the_target(share: float) -> Candidate:
    """A candidate whose column holds this much of the target's noise; its instrument holds none."""
    noisy = replace(candidate("a", {OWN: 1.0, NOISE: share}))
    return replace(noisy, instrument=lambda _: mixed({OWN: 1.0})[:, None])


def test_what_least_squares_finds_in_noise_instruments_do_not() -> None:
    """Closed form: y = b x + e seen as x + s e gives (b + s)/(1 + s^2) by least squares, b by instruments.

    The instrument takes out 2 % of the squares that the candidate takes out, far beyond chance.
    """
    s = 3.0
    for above, expected in ((0.97, []), (1.03, ["a"])):
        part = above * limits.KEPT_BY_INSTRUMENTS
        b = part * s / (1.0 + s**2 - part)

        assert b * (1.0 + s**2) / (b + s) == pytest.approx(part, rel=1e-12)
        assert b**2 * (1.0 + s**2) / (b + s) ** 2 < 0.2 * limits.CONFIRMED_PART
        assert gained(b, 1.0) > 4.0 * limits.CONFIRMED
        assert expected == adopted(search({OWN: b}, with_the_noise_of_the_target(s)))


def test_an_instrument_that_blurs_the_signal_confirms_it_all_the_same() -> None:
    """It takes out less than the part of the squares that is asked for, and finds the same coefficient."""
    share = 0.5 * limits.CONFIRMED_PART

    assert ["a"] == adopted(search({OWN: 5.0}, seen_through(share)))


@pytest.mark.parametrize(("jumps", "expected"), [(True, ["a"]), (False, [])])
def test_an_event_that_the_instrument_misplaces_does_not_unname_it(jumps: bool, expected: list[str]) -> None:
    """In one block the instrument is a hundred times too large: no other block predicts that one.

    It gains nothing under cross-validation; what least squares finds, it finds all the same. That counts for
    effects whose shapes decide when something happens.
    """
    own = mixed({OWN: 1.0})[:, None]
    wrong = np.where(np.arange(N)[:, None] < SIZE, 100.0, 1.0) * own
    when = Shape(quantity("when", "s", "when it happens", "", "positive"), 1.0, 2.0, "linear", 2, jumps=jumps)
    made = replace(candidate("a", {OWN: 1.0}, shapes=(when,)), instrument=lambda _: wrong)

    assert expected == adopted(search({OWN: 0.5}, made))


def test_a_fit_below_the_noise_floor_is_kept_where_instruments_find_the_same() -> None:
    """A ripple faster than the sampling counts as noise of the sensors; noise fitted to itself does too."""
    floor = 2.0  # of the amplitude 1 that is left

    assert ["a"] == adopted(search({OWN: 3.0}, seen_through(0.5), floor=floor))
    assert [] == adopted(search({OWN: 3.0}, seen_through(0.0), floor=floor))
    assert [] == adopted(search({OWN: 3.0}, candidate("a", {OWN: 1.0}), floor=floor))


def test_what_is_far_above_the_noise_is_not_noise() -> None:
    """A gain of many times the squares that the sensors explain needs no instrument."""
    for above, expected in ((0.97, []), (1.03, ["a"])):
        floor = math.sqrt(9.0 / limits.BEYOND_NOISE / above)

        assert expected == adopted(search({OWN: 3.0}, seen_through(0.0), floor=floor))


def test_the_next_candidate_takes_the_place_of_one_that_is_not_confirmed() -> None:
    """It is passed over, not the end of the search: the smaller effect behind it is adopted."""
    false = [replace(seen_through(0.0), id=f"false{k}", family=f"false{k}") for k in range(3)]

    assert ["b"] == adopted(search({OWN: 2.0, 3: 1.0}, *false, candidate("b", {3: 1.0})))


def test_a_smooth_term_explains_what_its_instrument_shows() -> None:
    """What follows the noise of a variable is no structure, and refuses no name."""
    for share, expected in ((1.0, True), (0.0, False)):
        found = search({OWN: 1.0}, smooth=(replace(seen_through(share), id="smooth:x"),))

        assert expected == found.explains(found.base, found.smoothed[0])


def test_where_the_sensors_explain_all_that_is_left_there_is_no_structure() -> None:
    """The base leaves 1 + 1 of a squared amplitude; the sensors' noise is just below, or just above it."""
    for part, expected in ((0.97, True), (1.03, False)):
        smooth = (replace(seen_through(1.0), id="smooth:x"),)
        found = search({OWN: 1.0}, smooth=smooth, floor=math.sqrt(2.0 * part))

        assert found.base.score == pytest.approx(2.0 * N, rel=1e-9)
        assert expected == found.explains(found.base, found.smoothed[0])


def test_the_instruments_are_the_signals_that_the_motion_needs() -> None:
    """Current and voltage of a log without noise, from its motion at low frequency: noise changes neither."""
    found = {}
    for noise in (0.0, 0.03):
        run = simulate(drawn_scenario(5, log_type="traj", seconds=40.0, noise=noise))
        data, model = prepared(run.columns, run.rig)
        hidden = run.truth["hidden_parameters"]
        friction = np.array([hidden[c.name] for c in data.signals.columns(model)])
        signals = instruments_of(data, model, friction)
        assert signals is not None
        found[noise] = data.drive.channels.selection.usable, signals.values, run.columns

    rows, quiet, logged = found[0.0]
    for name, column in (("i", "current_A"), ("u", "voltage_V")):
        error = (quiet[name] - logged[column])[rows]
        assert np.sqrt(np.mean(error**2)) < 0.1 * np.sqrt(np.mean(logged[column][rows] ** 2))
    noisy = found[0.03][1]
    assert np.array_equal(quiet["i"], noisy["i"])
    assert np.array_equal(quiet["u"], noisy["u"])


def test_the_instruments_keep_the_phase_of_a_ripple() -> None:
    """Behind a gear slow motion leaves out a part of a turn; order 6 stays within a tenth of a radian."""
    run = simulate(drawn_scenario(1, mu=1.0 / 30.0, log_type="traj", seconds=40.0))
    data, model = prepared(run.columns, run.rig)
    signals = instruments_of(data, model, np.zeros(len(data.signals.columns(model))))
    assert signals is not None

    rows = data.drive.channels.selection.usable
    missed = (signals.values["theta_m"] - run.columns["theta_m_rad"])[rows]
    assert 6.0 * np.sqrt(np.mean(missed**2)) < 0.1


# The noise of the electrical balance is looked for where the current's lag is taken back.


def test_a_lag_is_taken_back_within_a_segment() -> None:
    """Each sample is that of `lag` rows later, NaN where its segment or the log has none."""
    segment = np.array([0, 0, 0, 0, 1, 1, 1])
    channels = cast("Any", SimpleNamespace(time=SimpleNamespace(segment=segment)))
    signal = np.arange(7.0)

    np.testing.assert_array_equal(
        [2, 3, np.nan, np.nan, 6, np.nan, np.nan], balances._ahead(signal, channels, 2)
    )
    np.testing.assert_array_equal([np.nan, 0, 1, 2, np.nan, 4, 5], balances._ahead(signal, channels, -1))


def test_lags_are_those_of_a_delayed_sensor() -> None:
    """From 20 ms early to 70 ms late, no more of them at 10 kHz than are 2 ms apart."""

    def at(step: float) -> list[int]:
        return balances._lags(cast("Any", SimpleNamespace(time=SimpleNamespace(logged_step_s=step))))

    fine = at(1e-4)
    assert [*range(-5, 19)] == at(0.004)
    assert (-200, 700, 20) == (fine[0], fine[-1], max(np.diff(fine)))
