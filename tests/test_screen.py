"""Scores of candidates where every fit is known in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from eccentric.diagnosis.search.candidate import Candidate, Scaling, Values, Variant, grid
from eccentric.diagnosis.search.limits import BELOW_NOISE
from eccentric.diagnosis.search.screen import Fitted, Screen
from eccentric.effects import Shape
from eccentric.identification import Coefficient
from eccentric.model import Role, quantity
from tests.searched import BLOCKS, COLUMNS, SIZE, Array, N, candidate, design, mixed

ANGLE = Shape(quantity("angle", "rad", "direction of a column"), 0.1, 1.5, "linear", 5)


def only(one: Candidate) -> Variant:
    """The one variant of a candidate without shapes."""
    (variant,) = grid(one)
    return variant


def test_a_fit_leaves_the_columns_that_it_lacks() -> None:
    """Score and loss are N times the squares of what is not fitted; the coefficient is the amplitude."""
    one = candidate("a", {2: 1.0})
    screen = Screen(design({0: 5.0, 2: 3.0, 3: 2.0}), [one])
    fitted = screen.fit([only(one)])

    assert fitted.score == pytest.approx(N * (1.0 + 2.0**2), rel=1e-9)
    assert fitted.loss.sum() == pytest.approx(N * (1.0 + 2.0**2), rel=1e-9)
    assert fitted.coefficients == pytest.approx([5.0, 3.0], rel=1e-9)
    assert [pytest.approx([3.0], rel=1e-9)] == screen.own(fitted)


def test_the_ridge_of_a_smooth_term_shrinks_its_coefficient() -> None:
    """With a penalty r in units of the diagonal the coefficient is a/(1 + r); the base goes free."""
    one = candidate("a", {2: 1.0}, ridge=0.5)
    screen = Screen(design({0: 5.0, 2: 3.0}), [one])
    fitted = screen.fit([only(one)])

    assert fitted.coefficients == pytest.approx([5.0, 3.0 / 1.5], rel=1e-9)
    assert fitted.loss.sum() == pytest.approx(N * (1.0 + (3.0 - 3.0 / 1.5) ** 2), rel=1e-9)
    assert fitted.score == pytest.approx(N * (1.0 + (3.0 - 3.0 / 1.5) ** 2), rel=1e-9)


def test_each_ridge_is_that_of_its_own_term() -> None:
    """Beside a free term of two columns, a smooth one alone is shrunk, in whichever order."""
    free, smooth = candidate("a", {2: 1.0}, {3: 1.0}), candidate("b", {4: 1.0}, ridge=1.0)
    screen = Screen(design({2: 1.0, 3: 2.0, 4: 4.0}), [free, smooth])
    for order in ([free, smooth], [smooth, free]):
        fitted = screen.fit([only(one) for one in order])
        own = dict(zip((one.family for one in order), screen.own(fitted), strict=True))

        assert own["a"] == pytest.approx([1.0, 2.0], rel=1e-9)
        assert own["b"] == pytest.approx([2.0], rel=1e-9)


@pytest.mark.parametrize(("ridge", "counts"), [(1e-6, False), (0.0, True)], ids=["smooth", "physical"])
def test_a_smooth_term_says_nothing_where_it_extrapolates(ridge: float, counts: bool) -> None:
    """Where it predicts far more than is there, a smooth term has the loss of the fit without it."""
    reach = np.where(np.arange(N) < SIZE, 20.0, 1.0)
    one = replace(candidate("a", ridge=ridge), columns=lambda _: (reach * COLUMNS[:, 2])[:, None])
    balance = design({})
    target = balance.target + np.where(np.arange(N) < SIZE, 0.0, 2.0) * COLUMNS[:, 2]
    screen = Screen(replace(balance, target=target), [one])

    first, without = (screen.fit(variants).cross[0] for variants in ([only(one)], []))

    assert without == pytest.approx(SIZE * 1.0, rel=1e-6)
    assert counts == (first > 100.0 * without)
    if not counts:
        assert first == pytest.approx(without, rel=1e-9)


def test_a_fit_below_the_noise_of_the_sensors_is_dropped() -> None:
    """A candidate that holds the noise itself explains too much and is not ranked; an honest one is."""
    copy, honest = candidate("copy", {1: 1.0, 2: 0.1}), candidate("honest", {2: 1.0})
    for floor, expected in ((0.0, ["copy", "honest"]), (1.0, ["honest"])):
        ranked = Screen(design({2: 0.1}), [copy, honest], floor).rank([])

        assert expected == [fitted.last.id for fitted in ranked]


@pytest.mark.parametrize(("part", "kept"), [(1.01, True), (0.99, False)])
def test_the_floor_of_an_honest_fit_is_known_to_a_fifth(part: float, kept: bool) -> None:
    """What remains is held against `BELOW_NOISE` of the floor."""
    floor = np.sqrt(1.0 / (part * BELOW_NOISE))
    ranked = Screen(design({2: 1.0}), [candidate("a", {2: 1.0})], floor).rank([])

    assert kept == bool(ranked)


@pytest.mark.parametrize(("lower", "kept"), [((0.0, 0.0), False), ((-np.inf, -np.inf), True)])
def test_an_effect_without_its_first_column_is_another(lower: tuple[float, float], kept: bool) -> None:
    """Of a bounded effect the first coefficient is not to be 0: what is left is another family's."""
    one = candidate("a", {2: 1.0}, {3: 1.0}, lower=lower)
    ranked = Screen(design({2: -1.0, 3: 2.0}), [one]).rank([])

    assert kept == bool(ranked)


@pytest.mark.parametrize(("amplitude", "expected"), [(3.0, 1.0), (-3.0, 1.0 + 3.0**2)])
def test_a_coefficient_keeps_to_its_bound(amplitude: float, expected: float) -> None:
    """One that must not be negative explains nothing of a negative amplitude."""
    one = candidate("a", {2: 1.0}, lower=(0.0,))
    fitted = Screen(design({2: amplitude}), [one]).fit([only(one)])

    assert fitted.score == pytest.approx(N * expected, rel=1e-9)


def turned(values: Values) -> Array:
    """Column 2 turned towards column 3."""
    return mixed({2: np.cos(values["angle"]), 3: np.sin(values["angle"])})[:, None]


LOG = replace(ANGLE, low=0.05, high=1.5, scale="log")


@pytest.mark.parametrize(("shape", "planted"), [(ANGLE, 0.731), (LOG, 0.3)], ids=["linear", "logarithmic"])
def test_a_shape_is_refined_between_its_grid_points(shape: Shape, planted: float) -> None:
    """The direction of a column, planted off the grid, is found, and its amplitude."""
    screen = Screen(
        design({2: 4.0 * np.cos(planted), 3: 4.0 * np.sin(planted)}),
        [candidate("a", shapes=(shape,), of=turned)],
    )
    (best,) = screen.rank([])

    assert best.variants[0].values["angle"] == pytest.approx(planted, abs=2e-3)
    assert screen.own(best)[0] == pytest.approx([4.0], rel=1e-5)
    assert best.score == pytest.approx(N, rel=1e-4)


def test_shapes_of_several_effects_are_refined_together() -> None:
    """Two points on a line, at 0.4 and 0.9: their places depend on each other, and one pass finds neither."""

    def of(values: Values) -> Array:
        return mixed({2 + k: values["angle"] ** k for k in range(4)})[:, None]

    first, second = (candidate(name, shapes=(ANGLE,), of=of) for name in "ab")
    planted = 30.0 * (of({"angle": 0.4}) + of({"angle": 0.9}))[:, 0]
    screen = Screen(design({}, also=planted), [first, second])
    coarse = screen.fit([Variant(first, {"angle": 0.1}), Variant(second, {"angle": 1.5})])

    assert screen.refine(coarse).loss.sum() == pytest.approx(N, rel=1e-2)


def test_the_first_look_takes_the_best_grid_point_of_every_candidate() -> None:
    """In-sample losses, best first, one point each; what is taken and closed families are left out."""
    shaped = candidate("a", shapes=(ANGLE,), of=turned)
    orders = [candidate("b", {k: 1.0}, member=str(k), repeats=True) for k in (4, 5)]
    closed = [candidate("c", {k: 1.0}, member=str(k)) for k in (6, 7)]
    screen = Screen(design({3: 3.0, 4: 2.0, 5: 1.0, 6: 0.5, 7: 0.25}), [shaped, *orders, *closed])

    look = screen.first_look([])
    beside = screen.first_look([only(orders[0]), only(closed[0])])

    assert ["a", "b[4]", "b[5]", "c[6]", "c[7]"] == [screen.points[k].candidate.id for _, k in look]
    assert 1.5 == screen.points[look[0][1]].values["angle"]
    rest = 1.0 + 3.0**2 + 2.0**2 + 1.0 + 0.5**2 + 0.25**2
    assert [loss for loss, _ in look] == pytest.approx(
        [N * (rest - taken) for taken in ((3.0 * np.sin(1.5)) ** 2, 4.0, 1.0, 0.25, 0.0625)], rel=1e-9
    )
    assert ["a", "b[5]"] == [screen.points[k].candidate.id for _, k in beside]


def changing(family: str, known: int, column: int) -> Candidate:
    """A candidate that adds a known column and turns the base by another: both grow with its shape."""
    size = Shape(quantity(family, "1", "size of the change"), 0.0, 1.0, "linear", 3)

    def changes(values: Values) -> tuple[Array, Array]:
        x = values[family]
        return x * COLUMNS[:, known], mixed({0: 1.0, column: x})[:, None]

    return replace(candidate(family, {column: 1.0}, shapes=(size,)), changes=changes)


def test_what_changes_the_base_brings_its_own() -> None:
    """Known parts leave the target, the base is the changed one, and there are no columns beside it."""
    one = changing("a", 2, 3)
    screen = Screen(design({0: 2.0, 2: 0.5, 3: 1.0}), [one])
    variant = Variant(one, {"a": 0.5})
    target, matrix, lower = screen.design([variant])

    assert target == pytest.approx(mixed({0: 2.0, 1: 1.0, 3: 1.0}), abs=1e-12)
    assert matrix == pytest.approx(mixed({0: 1.0, 3: 0.5})[:, None], abs=1e-12)
    assert [-np.inf] == lower.tolist()
    assert screen.fit([variant]).score == pytest.approx(N, rel=1e-9)


def test_columns_that_no_change_touches_stay_as_the_balance_has_them() -> None:
    """A column that was filtered before it was averaged is not filtered again beside a changed one."""
    turns = replace(
        changing("a", 2, 3), changes=lambda values: (np.zeros(N), mixed_pair(1.0 + values["a"], 1.0))
    )
    balance = replace(
        design({0: 2.0, 1: 1.0}),
        samples=mixed_pair(1.0, 1.0),
        columns=np.column_stack([mixed({0: 1.0}), mixed({1: 0.7})]),
        coefficients=(*design({}).coefficients, Coefficient("B", "friction", "N m")),
    )

    _, matrix, _ = Screen(balance, [turns]).design([Variant(turns, {"a": 0.5})])

    assert matrix == pytest.approx(np.column_stack([mixed({0: 1.5}), mixed({1: 0.7})]), abs=1e-12)


def mixed_pair(first: float, second: float) -> Array:
    """Two columns of the base, each a multiple of one of the columns."""
    return np.column_stack([mixed({0: first}), mixed({1: second})])


def test_two_changes_of_the_base_are_the_same_in_either_order() -> None:
    """Changes add up: what was adopted first makes no difference."""
    one, other = changing("a", 2, 3), changing("b", 4, 5)
    screen = Screen(design({0: 2.0, 2: 0.5, 3: 1.0, 4: 1.0, 5: 2.0}), [one, other])
    variants = [Variant(one, {"a": 0.5}), Variant(other, {"b": 1.0})]

    for order in (variants, variants[::-1]):
        target, matrix, _ = screen.design(order)
        assert target == pytest.approx(mixed({0: 2.0, 1: 1.0, 3: 1.0, 5: 2.0}), abs=1e-12)
        assert matrix == pytest.approx(mixed({0: 1.0, 3: 0.5, 5: 1.0})[:, None], abs=1e-12)


def scaling(family: str, role: Role, column: int) -> Candidate:
    """A candidate that multiplies friction of a role, and the base, by 1 + its shape times a column."""
    size = Shape(quantity(family, "1", "size of the change"), 0.0, 1.0, "linear", 3)

    def factor(values: Values) -> Array:
        return 1.0 + values[family] * COLUMNS[:, column]

    return replace(
        candidate(family, {column: 1.0}, shapes=(size,)),
        changes=lambda values: (np.zeros(N), (COLUMNS[:, 0] * factor(values))[:, None]),
        scales=lambda values: Scaling(factor(values)[:, None], {role: factor(values)}),
    )


def test_factors_multiply_the_base_in_either_order() -> None:
    """Two effects that scale give the product of their factors, as in the extended model."""
    one, other = scaling("a", Role.COULOMB, 2), scaling("b", Role.COULOMB, 4)
    screen = Screen(design({0: 2.0}), [one, other])
    variants = [Variant(one, {"a": 0.5}), Variant(other, {"b": 0.25})]
    expected = COLUMNS[:, 0] * (1.0 + 0.5 * COLUMNS[:, 2]) * (1.0 + 0.25 * COLUMNS[:, 4])

    for order in (variants, variants[::-1]):
        assert screen.design(order)[1] == pytest.approx(expected[:, None], abs=1e-12)


def test_a_factor_reaches_friction_of_its_role_in_other_effects() -> None:
    """Dry friction of another effect is scaled, its viscous friction and what is no friction are not."""
    warm = Variant(scaling("a", Role.COULOMB, 2), {"a": 0.5})
    three = replace(
        candidate("b", {3: 1.0}, {5: 1.0}, {6: 1.0}), roles=(Role.COULOMB, Role.VISCOUS, Role.NONE)
    )
    screen = Screen(design({0: 2.0}), [warm.candidate, three])
    scaled = COLUMNS[:, 3] * (1.0 + 0.5 * COLUMNS[:, 2])
    expected = np.column_stack([scaled, COLUMNS[:, 5], COLUMNS[:, 6]])

    for order in ([warm, only(three)], [only(three), warm]):
        assert screen.columns(only(three), order) == pytest.approx(expected, abs=1e-12)
    assert screen.columns(only(three)) == pytest.approx(COLUMNS[:, [3, 5, 6]], abs=1e-12)


def test_blocks_are_predicted_from_the_others() -> None:
    """What only one block has is not predicted there: its cross-validated loss is that of no fit, or more."""
    inside = np.arange(N) < SIZE
    one = replace(candidate("a"), columns=lambda _: (inside * COLUMNS[:, 2])[:, None])
    screen = Screen(design({}, also=3.0 * inside * COLUMNS[:, 2]), [one])
    fitted = screen.fit([only(one)])

    assert fitted.loss[0] == pytest.approx(SIZE * 1.0, rel=1e-6)
    assert fitted.cross[0] == pytest.approx(SIZE * (1.0 + 3.0**2), rel=1e-6)
    assert (BLOCKS - 1) * SIZE == pytest.approx(fitted.cross[1:].sum(), rel=1e-6)


@pytest.mark.parametrize(("drive", "inertia", "expected"), [(np.inf, np.inf, ["inertia"]), (0.5, 0.95, [])])
def test_a_balance_of_zeros_is_no_fit(drive: float, inertia: float, expected: list[str]) -> None:
    """Factors on the drive torque and on the inertia that both go to 0 leave nothing: ranges refuse that."""
    torque, accelerating = {2: 3.0, 3: 2.0}, {3: 2.0}
    of_the_drive = candidate("drive", {k: -a for k, a in torque.items()})
    of_the_inertia = candidate("inertia", accelerating)
    first = replace(of_the_drive, ranges=((-drive, drive),))
    second = replace(of_the_inertia, ranges=((-inertia, np.inf),))
    lacking = {k: a - accelerating.get(k, 0.0) for k, a in torque.items()}

    ranked = Screen(design(lacking), [first, second]).rank([only(first)])

    assert expected == [fitted.last.id for fitted in ranked]
    for fitted in ranked:
        assert fitted.coefficients == pytest.approx([0.0, -1.0, -1.0], abs=1e-9)
        assert fitted.score == pytest.approx(N, rel=1e-9)


@pytest.mark.parametrize(("beyond", "kept"), [(0.06, True), (0.07, False)])
@pytest.mark.parametrize("end", [0.0, 1.0])
def test_a_coefficient_at_the_end_of_its_range_may_lie_beyond_by_noise(
    end: float, beyond: float, kept: bool
) -> None:
    """Held there it leaves 1 + x^2 for 1: of 2048 rows, a deviance of 8 at x = 0.063."""
    one = replace(candidate("a", {2: 1.0}), ranges=((0.0, 1.0),))
    amplitude = end + np.copysign(beyond, end - 0.5)
    ranked = Screen(design({2: amplitude}), [one]).rank([])

    assert kept == (N * np.log1p(beyond**2) < 8.0)
    assert kept == bool(ranked)


@pytest.mark.parametrize(("stiffness", "expected"), [(0.12, ["cable", "asymmetry"]), (0.1, ["asymmetry"])])
def test_what_contains_another_effect_has_its_own_term(stiffness: float, expected: list[str]) -> None:
    """A cable whose stiffness gains less than an effect must, 2048 log(1 + a^2) of 24, is a constant."""
    cable = candidate("cable", {2: 1.0}, {3: 1.0}, lower=(0.0, -np.inf))
    constant = candidate("asymmetry", {3: 1.0}, special_of=("cable",))
    ranked = Screen(design({2: stiffness, 3: 3.0}), [cable, constant]).rank([])

    assert (len(expected) == 2) == (N * np.log1p(stiffness**2) > 24.0)
    assert expected == [fitted.last.id for fitted in ranked]


def test_a_screen_that_has_forgotten_its_columns_makes_them_again() -> None:
    """Fits, the order of candidates and the library are the same afterwards."""
    screen = Screen(
        design({2: 3.0, 3: 2.0}), [candidate("a", shapes=(ANGLE,), of=turned), candidate("b", {3: 1.0})]
    )
    point, library, ranked = screen.points[1], screen.library.copy(), screen.rank([])
    screen.release()

    assert screen.fit([point]).score == pytest.approx(
        N * (1.0 + (3.0 * np.sin(point.values["angle"]) - 2.0 * np.cos(point.values["angle"])) ** 2), rel=1e-9
    )
    np.testing.assert_array_equal(library, screen.library)
    assert [f.last.id for f in ranked] == [f.last.id for f in screen.rank([])]
    assert [f.score for f in ranked] == [f.score for f in screen.rank([])]


def test_the_eight_best_candidates_are_refined() -> None:
    """Ten columns at angles of 0.1 to 1.0 to what is planted: the eight closest are looked at again."""
    angles = np.linspace(0.1, 1.0, 10)
    several = [candidate(f"at {a:.1f}", {2: np.cos(a), 3: np.sin(a)}) for a in angles]
    screen, refined = Screen(design({2: 10.0}), several), list[str]()

    def refine(fitted: Fitted, *_: object, **__: object) -> Fitted:
        refined.append(fitted.last.id)
        return fitted

    screen.refine = refine
    screen.rank([])

    assert [f"at {a:.1f}" for a in angles[:8]] == refined
