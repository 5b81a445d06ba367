"""What the page of benchmarks measures of accuracy, with a handful of states: `benchmarks/accuracy.py`."""

import numpy as np
import pytest

from benchmarks import accuracy
from benchmarks.asked import CODE

MANY, FEW = 12, 5
NEAR_THE_HOLLOW = 2  # of the sets of states; here the paper's form of F_N loses all of its digits


@pytest.mark.parametrize("real", accuracy.PRECISIONS)
@pytest.mark.parametrize("case", accuracy.CASES)
def test_a_set_is_measured_and_within_what_is_asked(case: str, real: str) -> None:
    """Every figure of the case is measured at as many states as told, none is NaN, and its bound holds."""
    name, errors = accuracy._set(case, real, NEAR_THE_HOLLOW, MANY, FEW)

    assert "1e-7 to 1e-3 from it" == name
    steady = {"F_N, C": "force", "F_N, NumPy": "force", "friction": "friction"}
    by_state = {"gradient": "gradient", "rotating_link": "accelerated"} if case == "c2_parallel" else {}
    for what, key in (steady | by_state).items():
        assert (MANY if key == "force" else FEW) == errors[what].size, what
        assert CODE[f"{key} {real}"].reached(float(np.max(errors[what]))), what
    assert set(accuracy.EMITTED) & set(errors) == set(steady | by_state)


@pytest.mark.parametrize("real", accuracy.PRECISIONS)
def test_the_peers_are_measured_at_the_same_states(real: str) -> None:
    """The paper's form misses the bound that the emitted code holds."""
    _, errors = accuracy._set("c2_parallel", real, NEAR_THE_HOLLOW, MANY, FEW)

    assert MANY == errors["paper"].size
    assert not CODE[f"force {real}"].reached(float(np.max(errors["paper"])))
