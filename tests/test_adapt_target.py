"""The estimator on a Cortex-M4F under QEMU: the bits of the host, and what it costs."""

from typing import Any

import numpy as np
import pytest

from benchmarks.asked import CODE
from benchmarks.cortex_m4 import TOOLS, missing
from tests import adapt_cost
from tests.adapt_target import counted, sizes
from tests.adapted import python_bits

# Instructions of one sample with the alarm, which the model's own functions come on top of.
WITH_ALARM = {4: 500, 6: 800}
BYTES, STACK = {4: 128, 6: 188}, {4: 256, 6: 320}


@pytest.fixture(scope="module", params=[4, pytest.param(6, marks=pytest.mark.slow)])
def case(request: Any, tmp_path_factory: pytest.TempPathFactory) -> adapt_cost.Case:
    """Return number of coefficients, name, folder, Python and a log: case C2, and with two harmonics."""
    if absent := missing(TOOLS):
        pytest.skip(f"not installed: {', '.join(absent)}")
    return adapt_cost.case(request.param, tmp_path_factory.mktemp("target"))


def test_the_bits_of_the_host(case: Any) -> None:
    """After 1,200 samples every word of the state is that of Python in single precision."""
    _, name, folder, python, rows = case
    state = python.init(np.float32)
    expected = python.replay(*rows.T, state)["flags"].tolist()

    samples, _, words = counted(folder, name, rows.tolist())

    reals = len(words) - 5 - len(state.seen)
    found = np.array([int(w, 16) for w in words], np.uint32)
    order = python_bits(state)
    seen = order[-5 - len(state.seen) : -5]
    assert expected == [flags for flags, _ in samples]
    assert np.array(order[:reals], np.float32).view(np.uint32).tolist() == found[:reals].tolist()
    assert [state.calls, *map(int, seen)] == found[reals : reals + 1 + len(seen)].tolist()


def test_instructions(case: adapt_cost.Case) -> None:
    """The update takes no more than asked, the model's own functions left out; so does all with the alarm."""
    alone, whole = adapt_cost.costs(case)

    print(f"{case[0]} coefficients: {alone} instructions, {whole} with the alarm")
    assert CODE[f"update {case[0]}"].reached(alone)
    assert whole <= WITH_ALARM[case[0]]


def test_memory(case: Any) -> None:
    """The state has the bytes that the manual states, nothing else is written to, and the stack is small."""
    n, name, folder, _, rows = case
    _, named, _ = counted(folder, name, rows[:30].tolist())
    found = sizes(folder, name)

    print(n, named, found)
    assert BYTES[n] == named["state"]
    assert 0 == found["data"]
    assert found["stack"] <= STACK[n]
