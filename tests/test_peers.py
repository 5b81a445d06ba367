"""The peers of the emitted C: what SymPy emits for the benchmark is the paper's friction torque."""

import ctypes
from pathlib import Path

import mpmath
import numpy as np
import pytest
from mpmath import mpf

from benchmarks import peers
from benchmarks.cortex_m4 import run
from benchmarks.generators import Generated
from tests import accuracy, paper
from tests.hosts import both_reals

STATES = ((3.0, 20.0), (-7.5, -41.0), (40.0, 0.5))


def emitted(folder: Path, real: str) -> Generated:
    """Let SymPy emit its C."""
    peers.sympy(folder, real)
    return Generated(folder, real, casadi=False)


@pytest.mark.parametrize("state", STATES)
@both_reals
def test_it_is_the_paper(tmp_path: Path, real: str, state: tuple[float, float]) -> None:
    """Away from the zero of F_N the emitted C gives eq. (18) and its derivatives, up to rounding."""
    one, library = emitted(tmp_path, real), tmp_path / "peer.so"
    run("gcc", "-shared", "-fPIC", "-o", library, one.source("gradient"), "-lm")
    number = {"float": ctypes.c_float, "double": ctypes.c_double}[real]
    out = (number * 3)()

    ctypes.CDLL(str(library)).gradient(number(state[0]), number(state[1]), out)

    p, at = accuracy.decimals(), tuple(map(mpf, state))
    exact = [
        mpmath.diff(lambda x, y: paper.friction_torque_c2(x, y, p), at, n) for n in ((0, 0), (1, 0), (0, 1))
    ]
    eps = float(np.finfo({"float": np.float32, "double": np.float64}[real]).eps)
    assert [float(x) for x in exact] == pytest.approx(list(out), rel=1000 * eps)
