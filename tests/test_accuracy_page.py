"""What the page of benchmarks measures of accuracy, with a handful of states: `benchmarks/accuracy.py`."""

import numpy as np
import pytest

from benchmarks import accuracy, accuracy_any
from benchmarks.asked import CODE

MANY, FEW = 12, 5
NEAR_THE_ZERO = 2  # of the sets of states; here the closed form of F_N loses all of its digits
FEW_REALS = [pytest.param("float", marks=pytest.mark.slow), "double"]


@pytest.mark.parametrize("real", FEW_REALS)
@pytest.mark.parametrize("case", accuracy.CASES)
def test_a_set_is_measured_and_within_what_is_asked(case: str, real: str) -> None:
    """Every figure of the case is measured at the requested states, none is NaN, and its bound holds."""
    name, errors = accuracy._set(case, real, NEAR_THE_ZERO, MANY, FEW)

    assert "1e-7 to 1e-3 from it" == name
    emitted = {(figure, who) for figure in accuracy.MEASURED for who in accuracy.MEASURED[figure]}
    emitted = {(figure, who) for figure, who in emitted if who in accuracy.OWN}
    if case == "c1_perpendicular":
        emitted = {(figure, who) for figure, who in emitted if figure in {"force", "friction"}}
    assert emitted == {one for one in errors if one[1] in accuracy.OWN}
    for figure, who in emitted:
        assert (MANY if figure == "force" else FEW) == errors[figure, who].size
        assert CODE[f"{figure} {real}"].reached(float(np.max(errors[figure, who]))), (figure, who)


@pytest.mark.parametrize(
    "figure", ["force", *(pytest.param(x, marks=pytest.mark.slow) for x in ("friction", "gradient"))]
)
@pytest.mark.parametrize("real", FEW_REALS)
def test_the_peers_are_measured_at_the_same_states(real: str, figure: str) -> None:
    """Every peer has its errors, and the closed form misses the bound that the emitted code holds."""
    _, errors = accuracy._set("c2_parallel", real, NEAR_THE_ZERO, MANY, FEW)

    doubled = {"paper in double"} if real == "double" else set()
    assert set(accuracy.MEASURED[figure]) - doubled == {who for other, who in errors if other == figure}
    assert {MANY if figure == "force" else FEW} == {e.size for one, e in errors.items() if one[0] == figure}
    assert not CODE[f"{figure} {real}"].reached(float(np.max(errors[figure, "paper"])))


@pytest.mark.parametrize("real", FEW_REALS)
def test_the_peers_are_right_elsewhere(real: str) -> None:
    """Far from the zero of F_N all forms agree: their errors near it are rounding, not mistakes."""
    _, errors = accuracy._set("c2_parallel", real, 0, MANY, FEW)

    assert dict.fromkeys(errors, True) == {one: bool(np.max(e) < 1000) for one, e in errors.items()}


def test_an_asked_for_figure_has_its_peers() -> None:
    """Each figure of accuracy is printed with its peers, NaN included."""
    _, errors = accuracy._set("c2_parallel", "float", NEAR_THE_ZERO, MANY, FEW)

    figures = accuracy._figures("float", [errors])

    assert {f"{one} float" for one in (*accuracy.MEASURED, "nan")} == set(figures)
    assert {True} == {"the closed form " in figure.peer for figure in figures.values()}


@pytest.mark.parametrize("real", accuracy.PRECISIONS)
def test_any_parameters_are_told_apart(real: str) -> None:
    """Every bound with any parameters has a figure of its own, measured at random drives, and it holds."""
    figures = accuracy_any.figures(real, FEW)

    assert {key for key in CODE if key.startswith("any ") and key.endswith(f" {real}")} == set(figures)
    assert dict.fromkeys(figures, True) == {key: CODE[key].reached(x.value) for key, x in figures.items()}
    assert 0 < min(figure.value for figure in figures.values())
