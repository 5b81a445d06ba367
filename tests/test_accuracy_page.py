"""What the page of benchmarks measures of accuracy, with a handful of states: `benchmarks/accuracy.py`."""

import numpy as np
import pytest

from benchmarks import accuracy
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
