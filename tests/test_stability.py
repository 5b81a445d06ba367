"""In how many variants of a log a search finds the same, where every loss is known in closed form.

See `searched`: a fit that has a column takes its amplitude out, in every draw of the blocks alike.
"""

import itertools
from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from eccentric.diagnosis.search import limits
from eccentric.diagnosis.search.attribution import Search
from eccentric.diagnosis.search.candidate import Candidate, grid
from eccentric.diagnosis.search.screen import Screen
from eccentric.diagnosis.search.stability import Stability, stability_of
from eccentric.diagnosis.search.verdict import Adopted, decided
from eccentric.identification import BalanceDesign
from eccentric.presentation import stability_words
from eccentric.presentation.diagnosis_text import _ranked
from tests.searched import BLOCKS, COLUMNS, SIZE, N, adopted, candidate, design, mixed, search

A, B, C = candidate("a", {2: 1.0}), candidate("b", {3: 1.0}), candidate("c", {4: 1.0})


def stability(balance: BalanceDesign, models: Sequence[Sequence[Candidate]], *others: Candidate) -> Stability:
    """The stability of the first model among some; `others` are on offer without a model that has them."""
    screen = Screen(balance, [*{c.id: c for model in models for c in model}.values(), *others])
    return stability_of(screen, [screen.fit([grid(c)[0] for c in model]) for model in models])


def found_by(families: str) -> Stability:
    """A stability whose hundred variants find one family each, a letter of the text, "-" for none."""
    best = tuple(frozenset() if letter == "-" else frozenset(letter) for letter in families)
    return Stability(best, {own: best.count(own) / len(best) for own in best})


def test_an_effect_that_all_blocks_show_is_found_in_all_variants() -> None:
    """Its probability is 101/102: a hundred variants do not prove a certainty."""
    found = stability(design({2: 3.0}), [[A], [B], []])

    assert (100, 100, {}) == (found.variants, found.found("a"), found.instead("a", {"a"}, set(), 2))
    assert found.probability("a") == pytest.approx(101 / 102, rel=1e-9)


def deviance(chosen: np.ndarray, shown: np.ndarray, h: float) -> float:
    """Of a column that the blocks `shown` hold with amplitude h, the noise being 1.

    Each of the chosen blocks is predicted with h c, c the part of those outside its group that hold the
    column: that takes h^2 (2 c - c^2) out of one that holds it, and adds h^2 c^2 to one that does not.
    """
    held, count = shown[chosen], len(chosen)
    # Each of 64 by itself; of more, group k begins at the first block beyond a part k/64 of them.
    first = -(-np.arange(64) * count // 64)
    group = np.repeat(np.arange(64), np.diff(first, append=count))
    c = (held.sum() - np.bincount(group, held)[group]) / (count - np.bincount(group)[group])
    gain = h**2 * np.sum(np.where(held, 2.0 * c, 0.0) - c**2)
    before = count + h**2 * held.sum()
    return float(N * np.log(before / (before - gain)))


@pytest.mark.parametrize("shown", [4, 5, 6])
def test_an_effect_that_few_blocks_show_is_found_where_enough_of_them_are_drawn(shown: int) -> None:
    """As often as in 2000 draws of our own, for which the deviance is known in closed form."""
    held = np.arange(BLOCKS) < shown
    balance = design({}, also=3.0 * COLUMNS[:, 2] * np.repeat(held, SIZE))
    rng = np.random.default_rng(20)
    draws = [
        np.sort(rng.permutation(BLOCKS)[: round(part * BLOCKS)]) for part in limits.PARTS for _ in range(1000)
    ]
    expected = limits.VARIANTS * np.mean([deviance(one, held, 3.0) > limits.CONFIRMED for one in draws])

    found = stability(balance, [[A], []]).found("a")

    assert 10.0 < expected < 90.0
    assert abs(found - expected) < 2.0 * np.sqrt(expected * (1.0 - expected / limits.VARIANTS)) + 1.0


def test_a_declared_value_is_free_within_its_tolerance_in_every_second_variant() -> None:
    """A value that is off by one unit makes `b` the best; where it is free, the true effect is."""
    off = replace(candidate("off", {5: 1.0}), tolerance=10.0)
    mixture = candidate("b", {2: 3.0, 5: 1.0, 6: 0.5})
    balance = design({2: 3.0, 5: 1.0})

    found = stability(balance, [[A], [mixture], []], off)

    assert (50, 50) == tuple(found.found(name) for name in "ab")
    # Where it is free it is off by a tenth of its tolerance: not worth a word.
    assert 0 == found.found("off")
    assert 100 == stability(balance, [[A], [mixture], []]).found("b")


def test_a_declared_value_that_explains_an_effect_takes_its_place() -> None:
    """Free within its tolerance, it leaves nothing to the effect: half of the variants find it instead."""
    off = replace(candidate("off", {2: 1.0}), tolerance=3.0)
    found = stability(design({2: 3.0}), [[A], []], off)

    assert (50, 50) == (found.found("a"), found.found("off"))
    assert {"off": 50} == found.instead("a", {"a"}, {"off"}, 0)
    # Off by its tolerance, the square root of 3 standard deviations, against the cost of an effect.
    ahead = 0.5 * (limits.CONFIRMED - 3.0)
    assert found.weight("off", {"a"}) == pytest.approx(0.5 / (1.0 + np.exp(-ahead)), abs=1e-3)


@pytest.mark.parametrize(("part", "expected"), [(0.97, "b"), (1.03, "a")])
def test_one_of_many_orders_has_to_be_ahead_in_the_variants_too(part: float, expected: str) -> None:
    """By twice log 24 there: what is 2 log 24 behind leaves so much more of its own column."""
    order = replace(A, evidence=replace(A.evidence, one_of=24))
    angle = np.arcsin(np.sqrt(np.expm1(part * limits.IN_A_DRAW * np.log(24.0) * 2.0 / N)) / 3.0)
    plain = candidate("b", {2: np.cos(angle), 9: np.sin(angle)})

    assert 100 == stability(design({2: 3.0}), [[order], [plain]]).found(expected)


def sets(counts: dict[str, int]) -> Stability:
    """A stability whose variants find sets of families, each a letter, so many times."""
    best = tuple(frozenset(letters) for letters, times in counts.items() for _ in range(times))
    return Stability(best, {own: best.count(own) / len(best) for own in best})


def test_what_accompanies_an_alternative_takes_nobodys_place() -> None:
    """`d` has more variants than `c`, but never without `b`: b and c are the two that may be tied with a."""
    found = sets({"a": 60, "bd": 20, "b": 10, "c": 10})

    assert {"b": 30, "c": 10} == found.instead("a", {"a"}, set(), 2)
    assert found.nearly_all("a", *found.instead("a", {"a"}, set(), 2))
    assert found.chances("a", "bcd") == pytest.approx(
        {"a": 61 / 102, "b": 0.3, "c": 0.1, "d": 0.0}, abs=1e-12
    )


def test_of_two_that_are_always_together_the_first_by_name_is_the_alternative() -> None:
    """The order does not depend on that of a set: the same log has the same answer in every process."""
    names = ("bearing_load", "drag", "cogging", "stribeck", "backlash")
    for one, other in itertools.combinations(names, 2):
        best = (frozenset({"a"}),) * 60 + (frozenset({one, other}),) * 40
        found = Stability(best, {own: best.count(own) / len(best) for own in best})

        assert {min(one, other): 40} == found.instead("a", {"a"}, set(), 2)
        chances = found.chances("a", [one, other])
        assert (chances[min(one, other)], chances[max(one, other)]) == (0.4, 0.0)


def test_a_declared_value_comes_on_top_of_the_effects_that_may_be_tied() -> None:
    """`j` is declared: it takes its variants first, and leaves room for two effects."""
    found = sets({"a": 30, "j": 20, "jb": 10, "b": 20, "c": 15, "e": 5})

    assert {"j": 30, "b": 20, "c": 15} == found.instead("a", {"a"}, {"j"}, 2)


def test_a_declared_value_is_not_free_beyond_its_tolerance() -> None:
    """The same value off by far more than it is known to: its correction is not a matter of tolerance."""
    off = replace(candidate("off", {5: 1.0}), tolerance=1e-4)
    mixture = candidate("b", {2: 3.0, 5: 1.0, 6: 0.5})

    assert 100 == stability(design({2: 3.0, 5: 1.0}), [[A], [mixture], []], off).found("b")


def test_means_of_two_rows_lose_what_changes_from_row_to_row() -> None:
    """Column 1 is + - + - in turn: every second variant sees nothing of it."""
    fast = candidate("fast", {1: 1.0})
    balance = design({1: 3.0, 7: 1.0}, independent=False)

    assert 50 == stability(balance, [[fast], []]).found("fast")


def test_a_last_block_of_one_row_counts_as_well() -> None:
    """It has no means of two rows, and is drawn all the same."""
    balance = design({2: 3.0}, independent=False)
    rows = replace(balance.rows, block=np.r_[balance.rows.block[:-1], BLOCKS])

    assert 100 == stability(replace(balance, rows=rows), [[A], []]).found("a")


def test_a_log_of_few_blocks_has_no_variants() -> None:
    """Draws of 31 whole runs may determine nothing; then the whole log decides alone."""
    balance = design({2: 3.0})
    rows = replace(balance.rows, block=np.arange(N) // (N // 31 + 1))
    found = stability(replace(balance, rows=rows), [[A], []])

    assert (0, True) == (found.variants, found.nearly_all("a"))


@pytest.mark.parametrize(
    ("variants", "expected", "tied"),
    [
        (90 * "a" + 10 * "b", "named", ()),
        (89 * "a" + 11 * "b", "not_identifiable", ("a", "b")),
        (70 * "a" + 26 * "b" + 4 * "c", "not_identifiable", ("a", "b")),
        (30 * "a" + 20 * "b" + 50 * "c", "not_identifiable", ("a", "c", "b")),
    ],
)
def test_named_is_what_nine_variants_of_ten_find(variants: str, expected: str, tied: tuple[str, ...]) -> None:
    """Otherwise it leads a tie of the families that one variant in twenty or more finds instead."""
    found = search({2: 3.0}, A, B, C)
    found.stability = found_by(variants)
    verdict = decided({"mechanical": found})
    (only,) = verdict.adopted

    assert (expected, tied) == (verdict.verdict, verdict.tied)
    assert (variants.count("a"), 100) == (only.found, only.variants)


def test_a_rival_that_is_found_beside_the_effect_is_none_there() -> None:
    """`b` is part of seventy variants, and in the place of `a` in ten: that is its probability."""
    found = search({2: 3.0}, A, B, C)
    found.stability = sets({"a": 30, "ab": 60, "b": 10})
    chances = {one.family: one.probability for one in decided({"mechanical": found}).candidates}

    assert chances == pytest.approx({"a": 91 / 102, "b": 0.1, "c": 0.0}, abs=1e-12)


def shown_by(blocks: int) -> np.ndarray:
    """A column (N, 1) that this many blocks hold, none of them neighbours: those may be left out together."""
    chosen = np.isin(np.arange(BLOCKS), 8 * np.arange(blocks))
    return COLUMNS[:, [3]] * np.repeat(chosen, SIZE)[:, None]


def run(screen: Screen) -> Search:
    """A search that has run, without smooth terms."""
    base = screen.fit([])
    found = Search(screen, Screen(screen.balance, []), base, base)
    found.run()
    return found


def test_an_effect_that_nothing_replaces_is_dropped_where_few_variants_find_it() -> None:
    """Three blocks show the second effect: the whole log proves it, and too few variants find it."""
    event = shown_by(3)
    balance = design({2: 3.0}, also=5.0 * event[:, 0])
    rare = candidate("rare", of=lambda _: event)
    screen = Screen(balance, [A, rare])
    found = run(screen)

    alone, both = (screen.fit([grid(c)[0] for c in effects]) for effects in ([A], [A, rare]))
    assert found.worth_it(alone, both)
    assert ["a"] == adopted(found)


def test_a_form_that_was_right_beside_what_is_dropped_gives_way_to_that_of_an_earlier_step() -> None:
    """Two blocks show the rare effect, beside which the second form is better; alone, the first one is."""
    event = 12.0 * shown_by(2)
    balance = design({2: 3.0}, also=event[:, 0])
    first = candidate("a", {2: 3.0}, member="first")
    second = candidate("a", {2: 3.0, 4: 0.4, 5: 0.2}, member="second")
    rare = candidate("rare", of=lambda _: event - mixed({4: 0.4})[:, None])
    screen = Screen(balance, [first, second, rare])
    found = run(screen)

    together, without = (screen.fit([grid(c)[0] for c in effects]) for effects in ([second, rare], [second]))
    earlier = screen.fit([grid(first)[0]])
    assert together.score < earlier.score < without.score
    assert ["a[first]"] == adopted(found)


def test_a_comparison_that_brings_back_what_was_dropped_ends() -> None:
    """Where the rare effect takes the place of an earlier step again and again, it is dropped for good."""
    event = 12.0 * shown_by(2)
    balance = design({2: 3.0}, also=event[:, 0])
    rare = candidate("rare", of=lambda _: event)
    screen = Screen(balance, [A, rare])
    alone, both = (screen.fit([grid(c)[0] for c in effects]) for effects in ([A], [A, rare]))

    class Returning(Search):
        """A search whose comparison prefers both effects whenever it is asked."""

        def _compare(self, changes: int = 0) -> None:
            self.best = both
            self.alternatives = [{v.candidate.family: (1.0, both)} for v in both.variants]

    base = screen.fit([])
    found = Returning(screen, Screen(screen.balance, []), base, both, steps=[alone, both])
    found.stability = found_by("a" * 100)
    found._examine([replace(alone, cross=0.5 * alone.cross), both])

    assert ["a"] == adopted(found)


def test_an_effect_that_was_dropped_does_not_come_back_with_an_earlier_step() -> None:
    """The rare effect is found first, and few variants find it: the other one stays, which all find."""
    event = 12.0 * shown_by(2)
    balance = design(
        {2: 1.05}, also=event[:, 0]
    )  # 1.0 would take out exactly half of what is left, the least that counts
    screen = Screen(balance, [candidate("a", {2: 1.0}), candidate("rare", of=lambda _: event)])
    found = run(screen)

    assert ["rare"] == [v.candidate.id for v in found.steps[0].variants]
    assert ["a"] == adopted(found)
    assert "named" == decided({"mechanical": found}).verdict


# What the answer says of how many resampled logs find an effect.


@pytest.mark.parametrize(
    ("own", "expected"),
    [
        (None, ""),
        (Adopted("electrical", grid(A)[0], (), 0.1), "stability not checked (the log has too few blocks)"),
        (Adopted("electrical", grid(A)[0], (), 0.1, 100, 100), "found in 100 of 100 resampled logs"),
        (
            Adopted("electrical", grid(A)[0], (), 0.1, 93, 100, {"b": 6}),
            "found in 93 of 100 resampled logs (b in 6)",
        ),
        (
            Adopted("electrical", grid(A)[0], (), 0.1, 62, 100, {"b": 30}, by_both=True),
            (
                "found in 62 of 100 resampled logs by the electrical balance alone (b in 30);"
                " both balances together decide"
            ),
        ),
    ],
)
def test_the_words_say_which_variants_find_it(own: Adopted | None, expected: str) -> None:
    """And what takes its place in the others; too few are told with what decides instead."""
    found = SimpleNamespace(attribution=SimpleNamespace(adopted_as={"a": own}.get))

    assert stability_words(cast("Any", found), cast("Any", SimpleNamespace(id="a"))) == expected


def test_a_covered_cause_is_below_its_name() -> None:
    """Its probability is part of that of the name, so that the two are not added."""
    own = Adopted("electrical", grid(A)[0], (), 0.1, covers=("b",))
    ranks = (("a", 0.9), ("c", 0.06), ("b", 0.5))
    words = SimpleNamespace(headline="")
    every = [SimpleNamespace(id=x, family=x, probability=p, words=words) for x, p in ranks]
    found: Any = SimpleNamespace(attribution=SimpleNamespace(adopted=(own,), candidates=every))

    assert "a" == A.family
    assert ["  0.90 a", "    of which 0.50 b", "  0.06 c"] == _ranked(found)
