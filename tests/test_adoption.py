"""What the search adopts, and how sure it is, where every score is known in closed form.

With the noise at 1, a fit that lacks amplitudes b, c, ... leaves N (1 + b^2 + c^2 + ...), N = 2048. Rows
count as independent, so the deviance of an addition is N log(before/after).
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from eccentric.diagnosis.search import limits
from eccentric.diagnosis.search.attribution import Search
from eccentric.diagnosis.search.candidate import Candidate, Variables, grid
from eccentric.diagnosis.search.screen import Screen
from eccentric.diagnosis.search.stability import beats_chance
from eccentric.diagnosis.search.two_balances import search_all
from eccentric.effects import Shape
from eccentric.model import quantity
from tests.searched import COLUMNS, N, adopted, candidate, design, mixed, search

A, B, C = candidate("a", {2: 1.0}), candidate("b", {3: 1.0}), candidate("c", {4: 1.0})


def amplitude(deviance: float, left: float = 1.0) -> float:
    """The amplitude of a column that gains this deviance where `left` squared stays behind."""
    return math.sqrt(left * math.expm1(deviance / N))


LARGE, FOUR = 100.0, tuple(candidate(name, {k: 1.0}) for k, name in enumerate("abcd", 2))
SMALL = amplitude(1.5 * limits.LEAST_DEVIANCE)
ADOPTED = {
    "a planted column, the others left alone": ({3: 1.0}, (A, B, C), {}, "b"),
    "nothing where nothing is missing": ({0: 3.0}, (A, B, C), {}, ""),
    # Just below `LEAST_DEVIANCE` it may be chance.
    "too small a deviance": ({2: amplitude(0.97 * limits.LEAST_DEVIANCE)}, (A,), {}, ""),
    "deviance": ({2: amplitude(1.03 * limits.LEAST_DEVIANCE)}, (A,), {}, "a"),
    # The RMS of an addition is held against `LEAST_SHARE` of the balance's scale.
    "too small a share": ({2: 0.99 * 0.5}, (A,), {"scale": 0.5 / limits.LEAST_SHARE}, ""),
    "share": ({2: 1.01 * 0.5}, (A,), {"scale": 0.5 / limits.LEAST_SHARE}, "a"),
    # Beside a large effect its square is held against `LEAST_PART` of all that was found.
    "too small a part": (
        {2: LARGE, 3: LARGE * math.sqrt(0.97 * limits.LEAST_PART)},
        (A, B),
        {"floor": 1.0},
        "a",
    ),
    "part": ({2: LARGE, 3: LARGE * math.sqrt(1.03 * limits.LEAST_PART)}, (A, B), {"floor": 1.0}, "ab"),
    # A second effect takes out `CLEARS`, half, of what is left above the floor; the first need not.
    "clears": ({2: 9.0, 3: 2.0, 7: 2.0 * 0.95}, (A, B), {"floor": 1.0}, "ab"),
    "does not clear": ({2: 9.0, 3: 2.0, 7: 2.0 * 1.05}, (A, B), {"floor": 1.0}, "a"),
    "the first need not clear": ({2: 1.0, 7: 3.0}, (A,), {"floor": 1.0}, "a"),
    # What is left after the first effect is held against `AT_FLOOR` of the sensors' floor.
    "at the floor": (
        {2: 3.0, 3: SMALL},
        (A, B),
        {"floor": math.sqrt((1.0 + SMALL**2) / (0.999 * limits.AT_FLOOR))},
        "a",
    ),
    "above the floor": (
        {2: 3.0, 3: SMALL},
        (A, B),
        {"floor": math.sqrt((1.0 + SMALL**2) / (1.001 * limits.AT_FLOOR))},
        "ab",
    ),
    # In which order the three are taken out, rounding decides.
    "the three largest of four": ({2: 32.0, 3: 16.0, 4: 8.0, 5: 4.0}, FOUR, {}, "abc"),
}


@pytest.mark.parametrize("case", ADOPTED)
def test_what_is_adopted(case: str) -> None:
    """Planted columns that gain enough, by every threshold; each is a letter."""
    planted, candidates, options, expected = ADOPTED[case]

    assert limits.CLEARS == 0.5
    assert expected == "".join(sorted(adopted(search(planted, *candidates, **options))))


def test_score_and_deviance_have_their_closed_forms() -> None:
    """What is taken out leaves the noise alone; where nothing is adopted there are no alternatives."""
    found, none = search({2: amplitude(30.0)}, A, B, C), search({0: 3.0}, A)

    assert found.best.score == pytest.approx(N, rel=1e-9)
    assert found.deviance(found.base, found.ranked[0]) == pytest.approx(30.0, rel=1e-6)
    assert [] == none.alternatives


def test_the_order_of_harmonics_is_free_and_others_are_alone_in_their_family() -> None:
    """Of a family whose members repeat two are adopted, of another one alone."""
    for repeats, expected in ((True, ["a[1]", "a[2]"]), (False, ["a[1]"])):
        members = [candidate("a", {k: 1.0}, member=str(k - 1), repeats=repeats) for k in (2, 3)]

        assert expected == adopted(search({2: 8.0, 3: 4.0}, *members))


MIX = candidate("mix", {2: 1.0, 3: 1.0, 4: 0.3})


def test_what_looks_best_alone_is_swapped_for_the_pair() -> None:
    """A mixture of two effects is the best single one, and leaves when both are there."""
    found = search({2: 4.0, 3: 4.0}, MIX, A, B)

    assert "mix" == found.ranked[0].last.id
    assert {"a", "b"} == set(adopted(found))
    assert found.best.score == pytest.approx(N, rel=1e-9)


def test_a_mixture_is_swapped_for_what_belongs_in_its_place() -> None:
    """Beside one of its parts the mixture gives way to the other, in whichever place it is."""
    found = search({2: 4.0, 3: 4.0}, MIX, A, B)
    for order in ((MIX, A), (A, MIX)):
        start = found.screen.fit([variant for one in order for variant in grid(one)])

        swapped = found.swapped(start)
        assert {"a", "b"} == {v.candidate.id for v in swapped.variants}
        assert swapped.score == pytest.approx(N, rel=1e-9)


def test_a_swap_that_gains_nothing_is_not_made() -> None:
    """Two candidates with the same column do not take turns: the one that was there stays."""
    found = search({2: 4.0, 3: 2.0}, A, B, candidate("twin", {2: 1.0}))
    start = found.screen.fit([variant for one in (A, B) for variant in grid(one)])

    assert found.swapped(start) is start


def test_pairs_are_sought_beside_the_runners_up() -> None:
    """The pair of two runners-up is found though neither is among the best partners of the leader.

    Beside the mixture, `d` and `e` fit best, and from there no swap of one leads to `a` and `b`.
    """
    partners = [candidate(name, {2: -0.97, 3: -0.97, 4: 6.5, k: 0.3}) for name, k in (("d", 5), ("e", 6))]
    found = search({2: 4.0, 3: 4.0}, MIX, A, B, *partners)

    beside_the_leader = [fitted.last.id for fitted in found.screen.rank(found.ranked[0].variants)]
    assert ["d", "e"] == sorted(beside_the_leader[:2])
    assert {"a", "b"} == set(adopted(found))


def test_what_the_others_make_superfluous_leaves() -> None:
    """Beside both of its parts the mixture no longer earns its place; what does stays."""
    found = search({2: 4.0, 3: 4.0}, MIX, A, B)
    three = found.screen.fit([variant for one in (MIX, A, B) for variant in grid(one)])
    two = found.screen.fit([variant for one in (A, B) for variant in grid(one)])

    assert ["a", "b"] == [v.candidate.id for v in found.pruned(three).variants]
    assert found.pruned(two) is two


def near(family: str, log_odds: float, **fields: object) -> Candidate:
    """A candidate that falls short of column 2 with amplitude 3 by these log-odds."""
    short = math.expm1(2.0 * log_odds / N)  # squared, of what it leaves beside the noise
    angle = math.asin(math.sqrt(short) / 3.0)
    return replace(candidate(family, {2: math.cos(angle), 9: math.sin(angle)}), **fields)


def chances(found: Search) -> dict[str, float]:
    """Family -> probability in the place of the only adopted effect."""
    (options,) = found.alternatives
    return {family: chance for family, (chance, _) in options.items()}


def test_probabilities_are_those_of_the_scores() -> None:
    """N/2 log of the ratio of scores are the log-odds of two families, and of three."""
    two = chances(search({2: 3.0}, A, near("b", 1.0)))
    three = chances(search({2: 3.0}, A, near("b", 1.0), near("c", 2.0)))

    assert two == pytest.approx({"a": 1 / (1 + math.exp(-1)), "b": 1 / (1 + math.e)}, rel=1e-6)
    whole = 1 + math.exp(-1) + math.exp(-2)
    assert three == pytest.approx({"a": 1 / whole, "b": math.exp(-1) / whole, "c": math.exp(-2) / whole})


def test_members_of_a_family_are_one_alternative() -> None:
    """The best member represents its family."""
    members = [replace(near("b", odds), id=f"b[{odds}]") for odds in (4.0, 1.0)]
    found = chances(search({2: 3.0}, A, *members))

    assert found == pytest.approx({"a": 1 / (1 + math.exp(-1)), "b": 1 / (1 + math.e)}, rel=1e-6)


def test_rows_that_overlap_count_half() -> None:
    """Rows that share samples are two for one at least: deviance and log-odds are half as large."""
    found = search({2: 3.0}, A, near("b", 1.0), independent=False)

    assert chances(found)["b"] == pytest.approx(1 / (1 + math.exp(0.5)), rel=1e-6)
    assert found.deviance(found.base, found.best) == pytest.approx(N / 2 * math.log(10.0), rel=1e-9)


def test_a_shape_costs_half_a_unit() -> None:
    """Of two families with the same score the one with a shape has log-odds of -1/2."""
    shape = Shape(quantity("x", "1", "of no effect"), 0.0, 1.0, "linear", 2)
    shaped = candidate("b", shapes=(shape,), of=lambda _: COLUMNS[:, [2]])
    found = search({2: 3.0}, A, shaped)

    assert ["a"] == adopted(found)
    assert chances(found)["b"] == pytest.approx(1 / (1 + math.exp(0.5)), rel=1e-6)


@pytest.mark.parametrize(("behind", "expected"), [(1.5, "special"), (2.5, "a")])
def test_a_special_case_wins_a_tie(behind: float, expected: str) -> None:
    """It takes the place of the family that contains it where it is less than `SPECIAL` behind."""
    assert limits.SPECIAL == 2.0
    special = candidate("special", special_of=("a",))
    special = replace(special, columns=near("special", behind).columns)
    found = search({2: 3.0}, A, special)

    assert [expected] == adopted(found)
    odds = math.exp(-abs(behind - limits.SPECIAL))
    assert chances(found)[expected] == pytest.approx(1 / (1 + odds), rel=1e-6)


@pytest.mark.parametrize(("behind", "expected"), [(3.0, "plain"), (3.4, "a")])
def test_one_of_many_orders_has_its_part_of_the_probability(behind: float, expected: str) -> None:
    """One of 24 orders has to be ahead of an effect that is the only one of its family by log 24 = 3.18."""
    order = replace(A, evidence=replace(A.evidence, one_of=24))
    found = search({2: 3.0}, order, near("plain", behind))

    assert [expected] == adopted(found)
    assert chances(found)[expected] == pytest.approx(
        1 / (1 + math.exp(-abs(behind - math.log(24.0)))), rel=1e-6
    )


def test_a_special_case_has_its_odds_only_beside_its_family() -> None:
    """Without the general family as a candidate, a special case has only its own score."""
    special = replace(near("special", 1.5), evidence=candidate("s", special_of=("other",)).evidence)

    assert ["a"] == adopted(search({2: 3.0}, A, special))


def test_smooth_terms_try_what_is_left() -> None:
    """They are fitted beside the adopted effects, and never adopted."""
    found = search({2: 3.0, 7: 2.0}, A, smooth=(candidate("smooth:x", {7: 1.0}),))

    assert ["a"] == adopted(found)
    assert [["a", "smooth:x"]] == [[v.candidate.id for v in f.variants] for f in found.smoothed]
    assert found.smoothed[0].score == pytest.approx(N, rel=1e-9)


def test_what_the_electrical_balance_shows_leaves_the_mechanical_target() -> None:
    """An effect found there is taken out here with the coefficient that it has there; others are not."""
    bias = replace(candidate("bias", {2: 1.0}, balance="electrical"), also=lambda _: mixed({5: 2.0})[:, None])
    plain = candidate("plain", {3: 1.0}, balance="electrical")
    mechanical = design({5: 7.0})
    electrical = replace(design({2: 3.0, 3: 2.0}), name="electrical")
    t = mixed({0: 1.0})
    lines: list[str] = []

    found = search_all(
        [mechanical, electrical],
        [bias, plain, A],
        Variables(t=t, theta_m=None, omega_m=t, alpha_m=0.0 * t, gravity=0.0 * t, mu=1.0, averaged=True),
        {},
        lines.append,
    )

    assert ["bias", "plain"] == adopted(found["electrical"])
    left = found["mechanical"].screen.balance.target
    assert left == pytest.approx(mixed({1: 1.0, 5: 7.0 - 2.0 * 3.0}), abs=1e-6)
    assert ["electrical balance: bias, plain", "mechanical balance: nothing adopted"] == lines[1::2]


@pytest.mark.parametrize(
    ("also", "floor", "explained"),
    [(0.0, 1.0, True), (0.0, 20.0, False), (3.5, 1.75, True), (3.5, 1.85, False), (6.0, 2.0, False)],
    ids=["far beyond", "within", "most of what is far", "most, within", "little of what is far"],
)
def test_a_burst_far_beyond_the_noise_is_explained(also: float, floor: float, explained: bool) -> None:
    """The signs of eight seconds come about by chance once in 128 draws: the sensors' noise says the rest.

    also: amplitude of what else is left.
    """
    burst = np.zeros(N)
    burst[160:288:16] = [1.0, -1.0] * 4
    balance = design({}, independent=False)
    noise = np.random.default_rng(3).standard_normal(N)
    balance = replace(balance, target=balance.target + np.hypot(1.0, also) * noise + 60.0 * burst)
    smooth = candidate("smooth", ridge=1e-9, of=lambda _: burst[:, None])
    screen, other = Screen(balance, (), floor), Screen(balance, (smooth,))
    base = screen.fit([])
    found = Search(screen, other, base, base)
    after = other.fit(grid(smooth))

    assert found.worth_it(base, after, other)
    assert not beats_chance(other, base, after)
    assert found.explains(base, after) == explained


def in_orders(family: str, beyond: float = 0.0) -> list[Candidate]:
    """Columns 2 and 3 as two orders of a family, the second one with a part of column 4."""
    members = {"72": ({2: 1.0}, 720.0), "18": ({3: 1.0, 4: beyond}, 180.0)}
    return [
        replace(candidate(family, column, member=member, repeats=True), periods=periods)
        for member, (column, periods) in members.items()
    ]


@pytest.mark.parametrize("short", [0.99, 1.01])
def test_another_order_of_what_is_there_is_as_likely_as_another_cause(short: float) -> None:
    """A motor that hardly turns back: friction with the angle explains what cogging does, and a little more.

    Of the gain of a column 3 + s 4 the column 3 alone has the part 1/(1 + s^2), here just below and above
    `ONE_CAUSE`. Above it, what is as clear by its deviance, N log(1 + 4 s^2), is open.
    """
    s = math.sqrt(1.0 / (short * limits.ONE_CAUSE) - 1.0)
    found = search({2: 4.0, 3: 2.0, 4: 2.0 * s}, *in_orders("cogging"), in_orders("friction", s)[1])
    chances = {family: chance for family, (chance, _) in found.alternatives[-1].items()}

    assert {*adopted(found)} == {"cogging[72]", "friction[18]" if short < 1.0 else "cogging[18]"}
    assert chances == pytest.approx(
        {"friction": 1.0, "cogging": 0.0} if short < 1.0 else {"cogging": 0.5, "friction": 0.5}
    )


def test_another_order_takes_no_place_that_it_could_not_have_alone() -> None:
    """Its gain does not appear with an instrument: it may be the noise of its own signals."""
    first, second = in_orders("cogging")
    doubtful = replace(second, instrument=lambda _: mixed({9: 1.0})[:, None])
    found = search({2: 4.0, 3: 2.0, 4: 0.2}, first, doubtful, in_orders("friction", 0.1)[1])

    assert {*adopted(found)} == {"cogging[72]", "friction[18]"}


def test_another_cause_that_does_the_same_stays_open() -> None:
    """A motor that never turns back: one of both orders may be friction with the angle."""
    first, second = in_orders("cogging")
    found = search({2: 4.0, 3: 2.0}, first, second, in_orders("friction")[1])

    assert adopted(found) == ["cogging[72]", "cogging[18]"]
    open_to = [{f for f, (chance, _) in options.items() if chance > 0.1} for options in found.alternatives]
    assert [{"cogging"}, {"cogging", "friction"}] == open_to
