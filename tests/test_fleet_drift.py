"""What drifts: tests over periods against SciPy, simulated fleets and seasons; what changed, by sums."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.random import Generator
from scipy.stats import false_discovery_control

from eccentric.fleet.drift import (
    FleetChange,
    Series,
    against_the_past,
    changes,
    course_of,
    discovered,
    level_of,
    series_of,
    shrunk,
)
from eccentric.fleet.periods import History, Period, temperatures_of
from eccentric.fleet.sums import Coverage
from eccentric.fleet.sums.columns import Heading, solve
from eccentric.identification import merged, triangles

PERIODS = tuple(f"2025-{k:02d}" for k in range(1, 13))
SEASON = 22.0 - 8.0 * np.cos(2.0 * np.pi * np.arange(12) / 12.0)


def _series(values: np.ndarray, heat: np.ndarray, joint: str = "J", error: float = 0.01) -> Series:
    count = len(values)
    return Series(joint, "C_m", "N m", PERIODS[:count], values, np.full(count, error), heat, 1.0, 0.05)


def _fleet(random: Generator, count: int, periods: int = 12) -> list[Series]:
    """Healthy joints: values that scatter twice as much as their errors, and follow the season."""
    heat = SEASON[:periods]
    return [
        _series(1.0 - 0.01 * (heat - 22.0) + 0.02 * random.standard_normal(periods), heat, f"H{k}")
        for k in range(count)
    ]


def test_discoveries_are_those_of_benjamini_and_hochberg() -> None:
    """The same p-values count as with SciPy's adjusted ones at every rate."""
    p = np.random.default_rng(1).uniform(size=400) ** 4

    for rate in (0.01, 0.05, 0.2):
        expected = false_discovery_control(p) <= rate
        assert discovered(p, rate).tolist() == expected.tolist()
    assert discovered(np.array([0.3, 0.9]), 0.05).tolist() == [False, False]


@pytest.mark.parametrize(("prior", "variance"), [(4.0, 2.0), (12.0, 0.5)])
def test_the_scatter_of_the_fleet_is_found(prior: float, variance: float) -> None:
    """Of variances drawn around a scaled inverse chi-square, scale and degrees of freedom come back."""
    random = np.random.default_rng(3)
    true = variance * prior / random.chisquare(prior, 4000)
    seen = true * random.chisquare(8, 4000) / 8

    found, freedom = shrunk([(float(v), 8) for v in seen])

    assert found == pytest.approx(variance, rel=0.15)
    assert freedom == pytest.approx(prior, rel=0.35)


def test_p_values_of_healthy_joints_are_not_too_small() -> None:
    """Of 400 healthy series, no larger part than p has a p-value below p, for 6 and 12 periods."""
    random = np.random.default_rng(4)
    for periods in (6, 12):
        p = np.array([c.p for c in changes(_fleet(random, 400, periods), 0.05)])

        for level in (0.1, 0.01):
            assert np.mean(p < level) < level + 3.0 * math.sqrt(level / len(p))


@pytest.mark.parametrize("periods", [6, 12])
def test_a_step_is_found_where_it_is(periods: int) -> None:
    """Among 100 healthy joints one that steps by 30 % is the one that counts, from the right period on."""
    random = np.random.default_rng(6)
    fleet = _fleet(random, 100, periods)
    values = fleet[0].values + 0.3 * (np.arange(periods) >= 3)
    fleet.append(_series(values, SEASON[:periods], "worn"))

    counted = [c for c in changes(fleet, 0.01) if c.counts]

    assert ["worn"] == [c.series.joint for c in counted]
    assert (counted[0].shape, counted[0].since) == ("step", "2025-04")
    assert counted[0].size == pytest.approx(0.3, abs=0.06)
    assert counted[0].before == pytest.approx(1.0, abs=0.1)


def test_a_season_is_no_drift_where_temperature_is_known() -> None:
    """Friction that halves by the season alone does not count; without a temperature it does."""
    random = np.random.default_rng(8)
    viscous = np.exp(-0.04 * (SEASON[:6] - SEASON[0]))
    fleet = [_series(viscous + 0.01 * random.standard_normal(6), SEASON[:6], f"J{k}") for k in range(30)]
    blind = _series(fleet[0].values, np.full(6, np.nan), "blind")

    assert ["blind"] == [c.series.joint for c in changes([*fleet, blind], 0.05) if c.counts]


def test_a_change_too_small_to_matter_does_not_count() -> None:
    """A step of 3 % of the friction is significant, and not reported."""
    random = np.random.default_rng(9)
    fleet = [_series(1.0 + 1e-3 * random.standard_normal(12), SEASON, f"J{k}", 1e-3) for k in range(30)]
    fleet.append(_series(fleet[0].values + 0.03 * (np.arange(12) >= 6), SEASON, "slight", 1e-3))

    (slight,) = [c for c in changes(fleet, 0.01) if c.series.joint == "slight"]

    assert slight.p < 1e-6
    assert not slight.counts


HEADINGS = (
    Heading("B", "N m s/rad", "viscous"),
    Heading("C", "N m", "coulomb"),
    Heading("offset", "N m", "offset"),
)


def _period(name: str, values: np.ndarray, heat: float, random: Generator, ripple: float = 0.0) -> Period:
    """2000 windows of a joint that swings: viscous and Coulomb friction and an offset, with noise."""
    w = 5.0 * np.sin(np.linspace(0.0, 60.0, 2000) + random.uniform(0.0, 6.0))
    x = np.column_stack([w, np.sign(w), np.ones(2000)])
    y = x @ values + ripple * np.cos(7.0 * np.linspace(0.0, 60.0, 2000)) * np.sign(w)
    stack = triangles(
        np.column_stack([x, y + 0.01 * random.standard_normal(2000)]), np.arange(2000) * 32 // 2000, 32
    )
    solved = solve(stack)
    rms = abs(float(merged(stack)[3, 3])) / math.sqrt(2000)
    coverage = Coverage(2000, 40.0, 0.5, 0.1, 5.0, heat, heat - 1.0, heat + 1.0)
    level = float(np.mean(np.abs(x[:, :2] @ values[:2])))
    return Period(
        name,
        solved.values,
        solved.covariance,
        solved.freedom,
        merged(stack),
        2000,
        (level, 1e-3),
        (rms, rms / 50.0),
        np.sqrt(np.mean(x**2, axis=0)),
        coverage,
    )


def _histories(change: Mapping[str, float], ripple: float = 0.0) -> list[History]:
    """Twenty joints over 12 months with a season in B; the first has a change from month 7 on."""
    random = np.random.default_rng(11)
    found = []
    for k in range(20):
        periods = []
        for p, heat in enumerate(SEASON):
            late = p >= 6 and k == 0
            values = [
                0.02 * math.exp(-0.02 * (heat - 22.0)) + change.get("B", 0.0) * late,
                0.1 + change.get("C", 0.0) * late,
                change.get("offset", 0.0) * late,
            ]
            wander = np.array([*random.normal(1.0, 0.01, 2), 1.0])
            periods.append(_period(PERIODS[p], np.array(values) * wander, float(heat), random, ripple * late))
        found.append(History(f"J{k}", HEADINGS, tuple(periods)))
    return found


@pytest.mark.parametrize(
    ("change", "expected"),
    [({"B": 0.01}, ("viscous",)), ({"C": 0.04}, ("coulomb",)), ({"offset": 0.05}, ("offset",))],
)
def test_the_coefficient_that_changed_is_named(change: dict[str, float], expected: tuple[str, ...]) -> None:
    """The sums alone name what changed, and the error falls back to what is usual."""
    histories = _histories(change)
    heat, _ = temperatures_of(histories)
    tested = changes([s for h in histories for s in series_of(h, heat[h.joint])], 0.01)
    counted = sorted((c for c in tested if c.counts), key=lambda c: c.p)

    found = against_the_past(histories[0], counted[0], heat["J0"])

    assert {"J0"} == {c.series.joint for c in counted}
    assert expected == found.kinds
    assert counted[0].since == "2025-07"
    assert found.matters
    assert found.before > 2.0 * found.after
    assert found.after < 1.3 * found.usual


def test_a_trend_is_not_taken_for_its_season() -> None:
    """Coulomb friction that wears from the first month on: warm months against one cold one are no change."""
    random = np.random.default_rng(5)
    season, names = SEASON[:9], PERIODS[:9]
    histories = []
    for k in range(20):
        worn = 0.05 * np.arange(9) / 8.0 * (k == 0)
        periods = [
            _period(name, np.array([0.02 * math.exp(-0.02 * (t - 22.0)), 0.1 + c, 0.0]), float(t), random)
            for name, t, c in zip(names, season, worn, strict=True)
        ]
        histories.append(History(f"J{k}", HEADINGS, tuple(periods)))
    heat, _ = temperatures_of(histories)
    series = next(s for s in series_of(histories[0], heat["J0"]) if s.name == "C")
    trend = FleetChange(series, "trend", names[1], 0.05, 0.1, 1e-6, True)
    healthy = replace(trend, series=next(s for s in series_of(histories[1], heat["J1"]) if s.name == "C"))

    found = against_the_past(histories[0], trend, heat["J0"])
    none = against_the_past(histories[1], healthy, heat["J1"])

    assert found.kinds == ("coulomb",)
    assert found.matters
    assert found.explained > 0.9
    assert not none.matters


@pytest.mark.parametrize(
    ("shape", "expected"),
    [("trend", [0.0, 0.25, 0.5, 0.75, 1.0]), ("step", [0, 0, 1, 1, 1]), ("ramp", [0, 0, 1 / 3, 2 / 3, 1])],
)
def test_the_course_of_a_change_is_its_shape(shape: str, expected: Sequence[float]) -> None:
    """0 before, 1 at the end."""
    since = PERIODS[1] if shape == "trend" else PERIODS[2]
    change = FleetChange(_series(np.zeros(5), np.zeros(5)), shape, since, 1.0, 0.0, 0.0)
    np.testing.assert_allclose(course_of(change), expected, atol=1e-12)


def test_friction_that_is_not_positive_is_not_tested() -> None:
    """A drive signal of the wrong sign turns friction round: no change is a part of that."""
    history = _histories({})[0]
    turned = tuple(replace(p, friction=(-p.friction[0], p.friction[1])) for p in history.periods)

    assert level_of(history) > 0.0
    assert list(series_of(replace(history, periods=turned), {})) == []


def test_what_no_coefficient_explains_is_not_named() -> None:
    """A ripple that the columns do not have is seen in what they leave, and left to a diagnosis."""
    histories = _histories({}, ripple=0.06)
    heat, _ = temperatures_of(histories)
    tested = changes([s for h in histories for s in series_of(h, heat[h.joint])], 0.01)
    counted = sorted((c for c in tested if c.counts), key=lambda c: c.p)

    found = against_the_past(histories[0], counted[0], heat["J0"])

    assert counted[0].series.name == "residual"
    assert found.names == ()
    assert found.matters
    assert found.free > 2.0 * found.usual


def test_a_stuck_temperature_is_replaced_and_named() -> None:
    """A sensor that shows 14 deg C from May on is one problem; the fleet's season takes its place."""
    histories = _histories({})
    frozen = [
        p if k < 4 else replace(p, coverage=replace(p.coverage, temperature=14.0, coldest=14.0, warmest=14.0))
        for k, p in enumerate(histories[3].periods)
    ]
    histories[3] = replace(histories[3], periods=tuple(frozen))

    heat, problems = temperatures_of(histories)

    assert [("J3", "2025-05", "temperature sensor")] == [(p.joint, p.period, p.kind) for p in problems]
    np.testing.assert_allclose([heat["J3"][p] for p in PERIODS], SEASON, atol=1e-9)


def test_a_stuck_temperature_that_nothing_replaces_is_named_as_well() -> None:
    """No other joint logs one: the problem says that the season stays in the coefficients."""
    lone = _histories({})[3]
    frozen = tuple(
        replace(p, coverage=replace(p.coverage, temperature=14.0, coldest=14.0, warmest=14.0))
        for p in lone.periods
    )

    heat, (problem,) = temperatures_of([replace(lone, periods=frozen)])

    assert heat == {"J3": {}}
    assert problem.kind == "temperature sensor"
    assert problem.text.endswith("it is not taken out")
