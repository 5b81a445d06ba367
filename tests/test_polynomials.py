"""The errors of the polynomials that the header states: of the method, measured; of rounding, proved."""

import math
import re
from pathlib import Path

import mpmath
import numpy as np
import pytest

from tests.gappa import proved

GENERATED = Path(__file__).resolve().parent.parent / "generated"
FORMATS = {"float": ("ieee_32", np.float32), "double": ("ieee_64", np.float64)}
# Half a turn of the link from the top, and a little: the nearest top is determined by theta_m mu/2pi, and in
# single precision a rounded factor, product and sum leave of 2^13 turns all but 2^-10.
LARGEST_HALF_ANGLE = math.pi / 2 + math.pi * 2**-10
FUNCTIONS = {"sine_ratio": "sin(h)/h", "cosine": "cos(h)"}
every_polynomial = pytest.mark.parametrize(
    ("function", "real"), [(function, real) for function in FUNCTIONS for real in FORMATS]
)


def stated(function: str, real: str) -> tuple[str, str]:
    """Return the errors of method and rounding that the header shows."""
    header = (GENERATED / "c2_parallel.h").read_text(encoding="utf-8")
    line = re.escape(FUNCTIONS[function]) + r": method (\S+) and (\S+), rounding (\S+) and (\S+)\n"
    (numbers,) = re.findall(line, header)
    return numbers[:: len(FORMATS)] if real == "float" else numbers[1 :: len(FORMATS)]


def statements(function: str, real: str) -> list[tuple[str, str]]:
    """Return (variable, expression) of the polynomial in one precision, as the emitted C has them."""
    source = (GENERATED / "c2_parallel.c").read_text(encoding="utf-8")
    found = re.search(rf"real c2_parallel_{function}\(const real h\)\n\{{(.*?)\n\}}", source, re.DOTALL)
    assert found is not None
    shared, choice = found[1].split("#else", 1)[1].split("#if ECCENTRIC_PRECISION == 1")
    single, double = choice.split("#else")
    own = single if real == "float" else double.split("#endif")[0]
    return re.findall(r"(\w+)(?: =)? ([^=;]+);", re.sub(r"const real |real ", "", shared + own))


def script(function: str, real: str) -> str:
    """Return what Gappa is asked: how far the results of each step rounded and unrounded are apart."""
    rounded, exact, step = [f"@rnd = float<{FORMATS[real][0]}, ne>;", "h = rnd(angle);"], [], dict[str, int]()

    def named(expression: str, prefix: str) -> str:
        constant = re.sub(r"REAL\(([^)]+)\)", r"rnd(\1)", expression)
        return re.sub(r"\b(x|y)\b", lambda m: f"{prefix}_{m[0]}_{step[m[0]]}", constant)

    for variable, expression in statements(function, real):
        texts = named(expression, "r"), named(expression, "e")
        step[variable] = step.get(variable, 0) + 1
        rounded.append(f"r_{variable}_{step[variable]} rnd= {texts[0]};")
        exact.append(f"e_{variable}_{step[variable]} = {texts[1]};")
    asked = f"{{ h in [0, {LARGEST_HALF_ANGLE}] -> r_return_1 - e_return_1 in ? }}"
    return "\n".join([*rounded, *exact, asked])


@every_polynomial
def test_rounding_is_bounded(function: str, real: str) -> None:
    """Over all half angles the emitted polynomial is within the stated bound of its exact value, proved."""
    bound = float(stated(function, real)[1])

    assert 0.9 * bound <= proved(script(function, real)) <= bound


@every_polynomial
def test_method_is_bounded(function: str, real: str) -> None:
    """With its coefficients as the precision rounds them it is within the stated error of sine or cosine."""
    text = " ".join(expression for _, expression in statements(function, real))
    coefficients = [mpmath.mpf(float(FORMATS[real][1](c))) for c in re.findall(r"REAL\(([^)]+)\)", text)]
    worst = mpmath.mpf(0)
    with mpmath.workdps(50):
        for k in range(1, 3000):
            h = mpmath.mpf(LARGEST_HALF_ANGLE) * k / 2999
            exact, scale = (
                (mpmath.cos(h), 1) if function == "cosine" else (mpmath.sin(h) / h, mpmath.sin(h) / h)
            )
            powers = coefficients if function == "cosine" else [*coefficients, 1]
            value = mpmath.polyval(powers, h * h)
            worst = max(worst, abs(value - exact) / scale)

        error = mpmath.mpf(stated(function, real)[0])
        assert 0.9 * error <= worst <= error
