"""One verdict from searches whose every score is known in closed form; see `searched`."""

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2

from eccentric.diagnosis import Diagnosis
from eccentric.diagnosis.models import _with_both_directions_first, closest_effect, constant_first
from eccentric.diagnosis.search import Attribution, limits, unconfirmed
from eccentric.diagnosis.search.candidate import Candidate
from eccentric.diagnosis.search.verdict import NextMeasurement, _outlines, decided, next_measurement
from eccentric.effects import LOAD, Evidence, Kin, Words
from eccentric.model import TURNING
from eccentric.presentation.plan_text import measurement_sentence
from eccentric.signals import MANY_RUNS
from tests.searched import N, candidate, search

VARIABLES = ("velocity", "direction", "link_angle", "motor_angle", "gravity_load", "transmitted_torque",
             "acceleration", "current", "voltage", "temperature", "time", "history")  # fmt: skip
"""Those that an effect may depend on, as `Evidence` lists them."""
A, B = candidate("a", {2: 1.0}), candidate("b", {3: 1.0})


def verdict(amplitudes: dict[int, float], *candidates: Candidate, smooth: Candidate | None = None,
            scale: float = 1e-3, runs: int = 1, ruled_out: tuple[Candidate, ...] = ()
) -> Attribution:  # fmt: skip
    """The verdict on one mechanical balance; the smooth term, if any, comes without a penalty."""
    given = () if smooth is None else (smooth,)
    found = search(amplitudes, *candidates, smooth=given, ruled_out=ruled_out, scale=scale)
    return decided({"mechanical": found}, runs)


def rival(family: str, odds: float) -> Candidate:
    """A candidate whose probability is `odds` times that of `a`, which fits column 2 with amplitude 3."""
    angle = math.asin(math.sqrt(math.expm1(-2.0 * math.log(odds) / N)) / 3.0)
    return candidate(family, {2: math.cos(angle), 9: math.sin(angle)})


def test_one_clear_effect_is_named() -> None:
    """It has its coefficient, its share of the scale, and a probability that no variant doubts."""
    found = verdict({2: 3.0}, A, B, scale=20.0)
    (only,) = found.adopted

    assert ("named", (), None) == (found.verdict, found.tied, found.next_measurement)
    assert ("mechanical", "a") == (only.balance, only.variant.candidate.id)
    assert only.coefficients == pytest.approx([3.0], rel=1e-9)
    assert only.share == pytest.approx(3.0 / 20.0, rel=1e-9)
    assert found.candidates[0].probability == pytest.approx(101 / 102, rel=1e-9)
    assert (100, 100, {}) == (only.found, only.variants, only.instead)


@pytest.mark.parametrize(
    ("odds", "named", "probability"), [(0.9, "b", 1.0), (0.3, "b", 1.0), (0.2, "a", 0.9), (0.01, "a", 0.99)]
)
def test_one_name_covers_another_until_that_one_is_clearly_ahead(
    odds: float, named: str, probability: float
) -> None:
    """`b` does what `a` does as well: `a` has a name of its own at four times its odds."""
    b = rival("b", odds)
    covering = replace(b, evidence=replace(b.evidence, covers=("a",)))
    found = verdict({2: 3.0}, A, covering, candidate("c", {4: 1.0}))
    (only,) = found.adopted

    assert ("named", (), named) == (found.verdict, found.tied, only.variant.candidate.family)
    assert found.candidates[0].probability == pytest.approx(probability, abs=0.1)
    assert only.covers == (("a",) if named == "b" else ())


def test_errors_of_candidates_are_root_mean_squares() -> None:
    """What a candidate leaves is sqrt(1 + what it lacks squared), in the unit of the target."""
    found = verdict({2: 3.0, 3: 0.2}, A, B)

    assert [("a", pytest.approx(math.sqrt(1.0 + 0.2**2), rel=1e-6))] == [
        (c.id, c.rmse) for c in found.candidates if c.id == "a"
    ]
    (b,) = [c for c in found.candidates if c.id == "b"]
    assert b.rmse == pytest.approx(math.sqrt(1.0 + 3.0**2), rel=1e-6)


def test_effects_are_listed_by_share_and_before_all_others() -> None:
    """The largest first, whatever the order of adoption or of the library."""
    found = verdict({2: 2.0, 3: 8.0}, candidate("c", {4: 1.0}), A, B)

    assert ["b", "a"] == [one.variant.candidate.id for one in found.adopted]
    assert [8.0, 2.0] == [pytest.approx(one.coefficients[0], rel=1e-6) for one in found.adopted]
    assert ["b", "a", "c"] == [c.id for c in found.candidates]


@pytest.mark.parametrize(("part", "expected"), [(0.99, ("named", ())), (1.01, ("unexplained", ("x",)))])
@pytest.mark.parametrize("place", ["instead", "beside"])
def test_a_cause_that_the_drive_cannot_have_is_no_headline(
    place: str, part: float, expected: tuple[str, tuple[str, ...]]
) -> None:
    """Instead of an effect it has to gain what an effect must, beside it the part that refuses a name."""
    assert (limits.LEAST_DEVIANCE, limits.UNEXPLAINED) == (24.0, 0.04)
    if place == "instead":  # and then a leaves 1 + sin^2 of the whole squared
        sine = math.sqrt(math.expm1(part * 24.0 / N)) / 3.0
        columns = target = {2: 3.0 * math.sqrt(1.0 - sine**2), 3: 3.0 * sine}
    else:
        columns, target = {3: 1.0}, {2: 30.0 * math.sqrt(1.0 - part * 0.04), 3: 30.0 * math.sqrt(part * 0.04)}
    impossible = replace(candidate("x", columns), possible=False)
    found = verdict(target, A, ruled_out=(impossible,))

    assert expected == (found.verdict, tuple(c.family for c in found.ruled_out))
    assert ["a"] == [c.family for c in found.candidates]


@pytest.mark.parametrize(("odds", "expected"), [(0.5, ["x"]), (1.1 / 19.0, ["x"]), (0.9 / 19.0, [])])
def test_what_explains_the_log_as_well_on_another_drive_is_excluded(odds: float, expected: list[str]) -> None:
    """It would be tied; here the name is that of the other. Odds of 1 to 19 are a probability of 0.05."""
    assert limits.POSSIBLE == 0.05
    found = verdict({2: 3.0}, A, B, ruled_out=(replace(rival("x", odds), possible=False),))

    assert ("named", ()) == (found.verdict, found.ruled_out)
    assert expected == [c.family for c in found.excluded if c.instead_of == "a"]
    assert "x" not in {c.family for c in found.candidates}


@pytest.mark.parametrize("least_blocks", [1, 10**6], ids=["variants", "the log alone"])
def test_a_family_beside_an_effect_is_not_tied_with_it(
    least_blocks: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two orders of a family: one is adopted for itself, the other almost explains another effect."""
    monkeypatch.setattr(limits, "LEAST_BLOCKS", least_blocks)
    order = candidate("harmonic", {5: 1.0}, member="n=1", repeats=True)
    almost = replace(rival("harmonic", 0.5), id="harmonic[n=2]", evidence=order.evidence)
    found = verdict({2: 3.0, 5: 3.0}, A, rival("b", 0.6), order, almost)

    assert ("not_identifiable", ("a", "b")) == (found.verdict, found.tied)


def test_nothing_missing_is_said_where_nothing_is_worth_it() -> None:
    """There is no effect, no variable, no measurement; what was considered is listed all the same."""
    found = verdict({0: 4.0}, A, B)

    assert ("nothing_missing", (), (), None) == (
        found.verdict, found.adopted, found.depends_on, found.next_measurement
    )  # fmt: skip
    assert {"a", "b"} == {c.id for c in found.candidates}


@pytest.mark.parametrize(("odds", "expected"), [(0.24, "named"), (0.26, "not_identifiable")])
def test_an_effect_is_named_from_the_probability_of_being_sure(odds: float, expected: str) -> None:
    """1/(1 + odds) is held against `SURE`, four to one."""
    assert limits.SURE == 0.8
    found = verdict({2: 3.0}, A, rival("b", odds))

    assert expected == found.verdict
    assert (() if expected == "named" else ("a", "b")) == found.tied


def test_all_families_that_explain_the_log_alike_are_tied() -> None:
    """Three in a tie are named, most probable first; a fourth below `POSSIBLE` is not."""
    found = verdict({2: 3.0}, rival("d", 0.06), rival("c", 0.4), A, rival("b", 0.7))
    chances = {c.family: c.probability for c in found.candidates}

    assert ("not_identifiable", ("a", "b", "c")) == (found.verdict, found.tied)
    expected = {name: odds / 2.16 for name, odds in (("a", 1.0), ("b", 0.7), ("c", 0.4), ("d", 0.06))}
    expected["a"] = (100.0 * expected["a"] + 1.0) / 102.0
    # Models of two effects explain as much; the second one costs them a factor of exp(-4).
    assert chances == pytest.approx(expected, abs=math.exp(-4.0))
    assert ["a", "b", "c", "d"] == [c.family for c in found.candidates]


def test_one_family_is_never_tied_with_nothing() -> None:
    """Where every other is improbable by itself, the best of them is tied all the same."""
    odds = [0.04 + 0.001 * k for k in range(9)]
    found = verdict({2: 3.0}, A, *(rival(f"r{k}", one) for k, one in enumerate(odds)))

    assert 1.0 / (1.0 + sum(odds)) < limits.SURE
    assert max(odds) / (1.0 + sum(odds)) < limits.POSSIBLE
    assert ("a", "r8") == found.tied


@pytest.mark.parametrize(("first", "expected"), [(0.0, "not_identifiable"), (4.0, "named")])
@pytest.mark.parametrize("other", ["mass", "gear"], ids=["which value is off", "whether one is off"])
def test_a_declared_value_may_stay_open_beside_a_name(other: str, first: float, expected: str) -> None:
    """Its tie, with another value or with an effect, takes no name from an effect that nothing else explains.

    It is reported, and beside that name an effect in the tie leaves undecided whether a value is off at all.
    """
    inertia = replace(candidate("inertia", {2: 1.0}), tolerance=1e-9)
    tied = rival(other, 0.7) if other == "gear" else replace(rival(other, 0.7), tolerance=1e-9)
    found = verdict({2: 3.0, 3: first}, B, inertia, tied)
    corrected = found.adopted_as("inertia")

    assert expected == found.verdict
    assert (() if first else ("inertia", other)) == found.tied
    assert (["b", "inertia"] if first else ["inertia"]) == [
        one.variant.candidate.family for one in found.adopted
    ]
    assert corrected is not None
    assert (("inertia", other), other == "gear" and bool(first)) == (corrected.alike, corrected.undecided)


@pytest.mark.parametrize(("variable", "expected"), [("time", "not_identifiable"), ("velocity", "named")])
def test_two_drifts_are_the_course_of_one(variable: str, expected: str) -> None:
    """Which of them it is stays open; two effects of another variable are two."""
    first, second = (replace(c, evidence=Evidence((variable,))) for c in (A, B))
    found = verdict({2: 3.0, 3: 4.0}, first, second)

    assert expected == found.verdict
    assert {"a", "b"} == {one.variant.candidate.family for one in found.adopted}
    assert ({"a", "b"} if variable == "time" else set()) == set(found.tied)


@pytest.mark.parametrize(
    ("part", "runs", "expected"),
    [
        (0.9 * limits.UNEXPLAINED, 1, "named"),
        (1.1 * limits.UNEXPLAINED, 1, "unexplained"),
        (1.1 * limits.UNEXPLAINED, MANY_RUNS - 1, "unexplained"),
        (0.95 * limits.UNEXPLAINED_OVER_RUNS, MANY_RUNS, "named"),
        (1.05 * limits.UNEXPLAINED_OVER_RUNS, MANY_RUNS, "unexplained"),
    ],
)
def test_what_a_smooth_term_still_takes_out_refuses_a_name(part: float, runs: int, expected: str) -> None:
    """Its part of all the structure is held against the limit, a wider one over many runs."""
    left = math.sqrt(part / (1.0 - part)) * 3.0
    found = verdict({2: 3.0, 7: left}, A, smooth=candidate("smooth:x", {7: 1.0}), runs=runs)

    assert expected == found.verdict
    # Of the mean square of noise, effect and remainder, 1 + 9 + left^2, the effect takes out 9.
    assert pytest.approx(9.0 / (10.0 + left**2), rel=0.01) == found.explained
    if expected == "unexplained":
        assert (("of_smooth:x",), ()) == (found.depends_on, found.tied)
        assert NextMeasurement("vary", "of_smooth:x") == found.next_measurement


TRACE = math.sqrt(math.expm1(0.9 * limits.LEAST_DEVIANCE / N))


@pytest.mark.parametrize(
    ("size", "expected"), [(2.0, ("unexplained", ("of_smooth:x",))), (TRACE, ("nothing_missing", ()))]
)
def test_a_smooth_term_alone_leaves_the_log_unexplained(size: float, expected: tuple[str, Any]) -> None:
    """Structure without any effect: no name, and its variable. A trace that gains by chance is none."""
    found = verdict({7: size}, A, smooth=candidate("smooth:x", {7: 1.0}))

    assert (*expected, ()) == (found.verdict, found.depends_on, found.adopted)


def test_the_residual_follows_the_stronger_variable_first() -> None:
    """Of the paper's residual, effects aside."""
    terms = [candidate(f"smooth:{name}", {k: 1.0}) for name, k in (("x", 2), ("y", 3))]
    found = decided({"mechanical": search({2: 2.0, 3: 5.0}, A, B, smooth=tuple(terms))})

    assert ("named", ("of_smooth:y", "of_smooth:x")) == (found.verdict, found.depends_on)


@pytest.mark.parametrize(("members", "expected"), [(2, "named"), (3, "unexplained")])
def test_three_members_of_a_family_are_a_patch(members: int, expected: str) -> None:
    """One order or two are an effect, three trace a shape that none of them is; its variable comes first."""
    orders = [candidate("a", {2 + k: 1.0}, member=str(k), repeats=True) for k in range(members)]
    found = verdict({2 + k: 9.0 / (k + 1) for k in range(members)}, *orders)

    assert members == len(found.adopted)
    assert expected == found.verdict
    assert (("of_a",) if expected == "unexplained" else ()) == found.depends_on


def test_the_gain_of_the_best_candidate_is_held_against_chance() -> None:
    """Per balance: N log of the ratio of scores, and what the library reaches by chance.

    A column that shares a part x of its square with the noise gains x (16 S)^2/N where the signs of 128
    blocks add up to S: 16 x times a chi^2 of one degree. Of 200 draws the 99 % quantile lies between its
    quantiles of 96 and 99.8 %.
    """
    shared = 0.005
    gained, by_chance = verdict({2: 3.0}, A, candidate("b", {3: 1.0, 1: math.sqrt(shared)})).deviance[
        "mechanical"
    ]

    assert gained == pytest.approx(N * math.log(10.0), rel=1e-6)
    low, high = chi2.ppf([0.96, 0.998], 1) * 16.0 * shared / (1.0 + shared)
    assert low < by_chance < high


def test_candidates_of_the_balance_that_the_verdict_is_about_come_first() -> None:
    """Errors of different balances do not compare."""
    quiet = search({}, candidate("quiet", {5: 1.0}))
    loud = search({2: 3.0, 3: 1.0}, A, candidate("loud", {4: 1.0}))
    found = decided({"electrical": quiet, "mechanical": loud})

    assert [("a", "mechanical"), ("loud", "mechanical"), ("quiet", "electrical")] == [
        (c.id, c.balance) for c in found.candidates
    ]
    assert found.candidates[1].rmse > found.candidates[2].rmse


def test_a_name_is_taken_back() -> None:
    """What did not predict the held-out part is unexplained, follows its own variable first, and is kept."""
    given = replace(verdict({2: 3.0}, A, rival("b", 0.5)), depends_on=("time",))
    found = unconfirmed(given)

    assert ("unexplained", (), ("of_a", "time"), ("a",)) == (
        found.verdict, found.tied, found.depends_on, found.unconfirmed
    )  # fmt: skip
    assert NextMeasurement("vary", "of_a") == found.next_measurement


SPEED = Kin("speed", {"speed": "More speeds."})


def test_the_measurement_between_tied_families_is_theirs() -> None:
    """Tied families of one kin have the sentence of the kin, from the words of the candidates."""
    one, other = (replace(c, words=Words(kin=SPEED)) for c in (A, rival("b", 0.5)))

    assert "More speeds." == measurement_sentence(verdict({2: 3.0}, one, other).next_measurement, TURNING)


WORDS = {"a": Words(headline="what a is"), "b": Words()}
BETWEEN = NextMeasurement("separate", between=tuple(WORDS.items()))


@pytest.mark.parametrize(
    ("case", "tied", "variables", "expected"),
    [
        ("unexplained", ["a"], ["link_angle", "time"], NextMeasurement("vary", "link_angle")),
        ("unexplained", [], [], NextMeasurement("vary", "time")),
        ("not_identifiable", ["a", "b"], [], BETWEEN),
        ("not_identifiable", [], [], None),
        ("named", ["a"], ["time"], None),
        ("nothing_missing", [], [], None),
    ],
)
def test_the_next_measurement_is_that_of_the_verdict(
    case: str, tied: list[str], variables: list[str], expected: NextMeasurement | None
) -> None:
    """Vary the variable that leads, or time; separate two families; or nothing."""
    assert expected == next_measurement(case, [(name, WORDS[name]) for name in tied], variables)


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        (NextMeasurement("vary", "of_a"), "Change the of a alone, in five steps"),
        (BETWEEN, "separates what a is from b: speeds, loads"),
        (replace(BETWEEN, constant_first=True), "Declare k_i under [known] first"),
        (replace(BETWEEN, one_way=True), "Log both directions first"),
        (NextMeasurement("correct"), "Correct the rig file or the log first."),
        (NextMeasurement("correct", mends=('k_i = "1 N m/A"',)), 'first: write k_i = "1 N m/A".'),
        (NextMeasurement("hold_others"), "with the others held"),
        (None, ""),
    ],
)
def test_a_next_measurement_is_a_sentence(found: NextMeasurement | None, expected: str) -> None:
    """It says what to do; families are called by their headline, else by their name."""
    said = measurement_sentence(found, TURNING)

    assert expected in said
    assert bool(expected) == bool(said)


def test_a_variable_is_the_leading_one() -> None:
    """What a candidate depends on first is what it is reported by."""
    two = replace(A, evidence=Evidence(("velocity", "direction")))

    assert "velocity" == two.variable


def _varied(variable: str) -> str:
    return measurement_sentence(NextMeasurement("vary", variable), TURNING)


@pytest.mark.parametrize("variable", VARIABLES)
def test_every_variable_has_a_measurement_that_a_person_can_do(variable: str) -> None:
    """It says what to do, in a sentence of its own: no two variables share one, none is a word in a frame."""
    sentence = _varied(variable)

    assert (True, ".") == (sentence[0].isupper(), sentence[-1])
    assert "alone, in five steps" not in sentence
    assert 1 == [_varied(other) for other in VARIABLES].count(sentence)


@pytest.mark.parametrize(
    ("second", "declared", "expected"),
    [(1.5, True, ["first"]), (1.5, False, ["first", "second"]), (2.5, True, ["first", "second"])],
    ids=["4 % of the first", "the same of no such family", "6 %"],
)
def test_what_the_record_of_an_effect_leaves_out_is_no_second_effect(
    second: float, declared: bool, expected: list[str]
) -> None:
    """Beside it, a family that looks like its second order is named from 5 % of its RMS on."""
    first = candidate("first", {2: 1.0}, second_order=("second",) if declared else ())

    found = verdict({2: 40.0, 3: second}, first, candidate("second", {3: 1.0}))

    assert expected == [a.variant.candidate.family for a in found.adopted]
    assert all(one.probability < 0.5 for one in found.candidates if one.family not in expected)


@pytest.mark.parametrize(
    ("scale", "by_voltage", "kins", "expected"),
    [
        (17.0, False, (LOAD, LOAD), True),
        (None, False, (LOAD, LOAD), False),
        (17.0, True, (LOAD, LOAD), False),
        (17.0, False, (LOAD, Kin("speed", {})), False),
    ],
    ids=["open", "declared", "by voltage", "not under load"],
)
def test_a_tie_under_load_asks_for_an_open_torque_constant_first(
    scale: float | None, by_voltage: bool, kins: tuple[Kin, Kin], expected: bool
) -> None:
    """A value in a data sheet costs less than a measurement."""
    tie = replace(verdict({2: 3.0}, A, rival("b", 0.5)), tied=("a", "b"))
    offered: Any = [SimpleNamespace(family=f, words=Words(kin=k)) for f, k in zip("ab", kins, strict=True)]
    data: Any = SimpleNamespace(drive=SimpleNamespace(scale=scale, by_voltage=by_voltage))

    said = constant_first(tie.next_measurement, tie.tied, offered, data)
    assert tie.next_measurement is not None
    assert replace(tie.next_measurement, constant_first=expected) == said


@pytest.mark.parametrize(("speed", "expected"), [([1.0, 2.0, 0.0], True), ([1.0, -2.0, 0.5], False)])
def test_a_tie_on_a_log_of_one_direction_asks_for_the_other(speed: list[float], expected: bool) -> None:
    """Friction changes its sign with the direction, cogging does not."""
    tie = replace(verdict({2: 3.0}, A, rival("b", 0.5)), tied=("a", "b"))
    said = _with_both_directions_first(tie, np.array(speed)).next_measurement
    assert tie.next_measurement is not None
    assert replace(tie.next_measurement, one_way=expected) == said


@pytest.mark.parametrize(
    ("verdict", "expected"), [("not_identifiable", ["b"]), ("named", []), ("unexplained", [])]
)
def test_beside_a_tie_the_effect_that_nothing_else_explains_is_clear(
    verdict: str, expected: list[str]
) -> None:
    """Of a tied effect and another one it is the other; any other verdict has none."""
    alike = {"a": ("a", "c"), "b": ()}
    found = Diagnosis.__new__(Diagnosis)
    own = SimpleNamespace(verdict=verdict, adopted_as=lambda name: SimpleNamespace(alike=alike[name]))
    effects = [(SimpleNamespace(id=name), None) for name in alike]
    object.__setattr__(found, "attribution", own)
    object.__setattr__(found, "models", SimpleNamespace(extended=SimpleNamespace(effects=effects)))

    assert expected == [effect.id for effect, _ in found.clear]


@pytest.mark.parametrize("orders", [1, 24])
def test_what_no_row_distinguishes_is_tied_whatever_is_assumed_beforehand(orders: int) -> None:
    """Half of the probability each, also where one is one order of many: its column is the other's, twice."""
    other = candidate("b", {2: 2.0}, member="n=1")
    other = replace(other, evidence=replace(other.evidence, one_of=orders))
    found = verdict({2: 3.0}, A, other)

    assert ("not_identifiable", {"a", "b"}) == (found.verdict, set(found.tied))
    assert [("a", 0.5), ("b", 0.5)] == sorted(
        (c.family, pytest.approx(c.probability, abs=0.005)) for c in found.candidates
    )


def test_an_alias_that_the_record_names_is_no_tie() -> None:
    """It is given beside the name, and the record of the other need not name it."""
    other = replace(B, columns=A.columns, evidence=replace(B.evidence, aliases=("a",), one_of=24))

    assert "named" == verdict({2: 3.0}, A, other).verdict


# Two laws of one variable that only outline its curve are no name; two orders of one family are.


def _variant(family: str, variable: str = "time") -> SimpleNamespace:
    return SimpleNamespace(candidate=SimpleNamespace(family=family, variable=variable))


@pytest.mark.parametrize(
    ("families", "variable", "best", "smooth", "outlines"),
    [
        (("wear_runin", "time_drift"), "time", 5.0, 1.2, True),
        (("wear_runin", "time_drift"), "velocity", 5.0, 1.2, False),
        (("cogging", "cogging"), "time", 5.0, 1.2, False),
        (("wear_runin",), "time", 5.0, 1.2, False),
        (("wear_runin", "time_drift"), "time", 1.9, 1.0, False),
        (("wear_runin", "time_drift"), "time", 5.0, 3.5, False),
    ],
)
def test_what_two_laws_leave_is_a_curve_of_their_variable(
    families: tuple[str, ...], variable: str, best: float, smooth: float, outlines: bool
) -> None:
    """More than twice the noise is left, and a free curve of the same variable takes most of the excess."""
    search = SimpleNamespace(
        best=SimpleNamespace(score=best, variants=[_variant(family) for family in families]),
        screen=SimpleNamespace(floor=1.0),
    )
    curve = SimpleNamespace(score=smooth, last=SimpleNamespace(variable=variable))
    assert _outlines(search, curve) is outlines  # pyright: ignore[reportArgumentType]


# The effect that is shown where none is adopted: the best one whose fit on the emitted module settles.


FIRST, SECOND = candidate("first", {2: 1.0}), candidate("second", {3: 1.0})


def fit(left: float, settled: bool = True, trained: float = 1.0) -> Any:
    """A fit that leaves held-out rows of this size, before the low pass and below it; and training rows."""
    score = np.arange(96) < 64
    rows = SimpleNamespace(score=score, train=~score, operator="averages")
    data = SimpleNamespace(rows=rows, drive=SimpleNamespace(channels=SimpleNamespace(rig=None)))
    residual = np.where(score, left, trained) * np.random.default_rng(1).normal(size=96)
    return SimpleNamespace(
        settled=settled, data=data, residuals={"mechanical": residual}, residual_like=lambda *_: residual
    )


@pytest.mark.parametrize(
    ("settled", "trained", "expected"),
    [
        ({"first": True, "second": True}, 0.9, "first"),
        ({"first": False, "second": True}, 0.9, "second"),
        ({"first": False, "second": False}, 0.9, None),
        ({"first": True, "second": True}, 13.0, "second"),
    ],
)
def test_an_effect_whose_fit_does_not_settle_is_passed_over(
    monkeypatch: pytest.MonkeyPatch, settled: dict[str, bool], trained: float, expected: str | None
) -> None:
    """Of two effects that the search ranks, the first one that settles and explains the training part."""
    left = {"first": 0.5, "second": 0.8}
    found = decided({"mechanical": search({2: 3.0, 3: 2.0}, FIRST, SECOND)})
    offered: Any = [SimpleNamespace(id=name) for name in left]
    models: Any = SimpleNamespace(adopted=False, fits_the_rig=True, base=None, paper=fit(1.0))

    def refit(_: Any, effects: Any, __: Any) -> Any:
        ((effect, _),) = effects
        return fit(left[effect.id], settled[effect.id], trained if effect.id == "first" else 0.9)

    monkeypatch.setattr("eccentric.diagnosis.models.refit", refit)
    shown = closest_effect(found, offered, models)

    assert expected == (None if shown is None else shown.effect.id)
    if shown is not None:
        assert 100.0 * (1.0 - left[shown.effect.id]) == pytest.approx(shown.percent)
