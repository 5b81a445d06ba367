"""How far rounding takes the emitted normal force: what Gappa proves, from the text of the emitted C."""

import re
import shutil
import subprocess
from fractions import Fraction
from pathlib import Path

import mpmath
import numpy as np
import pytest

from eccentric.emit.accuracy import NORMAL_FORCE_ULP
from tests import accuracy, paper

GENERATED = Path(__file__).resolve().parent.parent / "generated"
UNITS = {"float": (2.0**-24, "ieee_32", np.float32), "double": (2.0**-53, "ieee_64", np.float64)}
every_real = pytest.mark.parametrize("real", UNITS)
# A rounding takes u/(1 + u) of a number at most; Gappa counts u.
SLACK = 1 + 2.0**-50
# In units u of the relative error, which are at most one of the last place.
DIFFERENCE = 5


def emitted(name: str, pattern: str) -> str:
    """Return the one thing in the emitted C that a pattern finds, with the names of coefficients bare."""
    (found,) = set(re.findall(pattern, (GENERATED / f"{name}.c").read_text(encoding="utf-8")))
    return re.sub(r"\b[pc]->", "", found)


def proved(script: str) -> float:
    """Return the larger end of the one interval that Gappa finds."""
    if shutil.which("gappa") is None:
        pytest.skip("not installed: gappa")
    done = subprocess.run(["gappa"], input=script, capture_output=True, text=True, check=False, timeout=60)
    assert 0 == done.returncode, done.stderr
    ends = re.findall(r"(-?\d+)(?:b(-?\d+))?(?: \{[^}]*\})?[,\]]", done.stderr)
    assert 2 == len(ends), done.stderr
    return max(abs(int(digits)) * 2.0 ** int(power or 0) for digits, power in ends)


@every_real
@pytest.mark.parametrize("name", ["c1_perpendicular", "c1_asymmetric"])
def test_product_is_proved(name: str, real: str) -> None:
    """F_N of case C1 keeps its bound for all parameters and speeds of 1e-6 to 1e6, in SI units."""
    unit, format_, _ = UNITS[real]
    coefficient, force = (
        emitted(name, rf"const {kind} {target} = ([^;]+);")
        for kind, target in (("double", "L_M_mu2"), ("real", "F_N"))
    )
    letters = ("L", "M", "mu", "omega_m")
    between = " /\\ ".join(f"{letter} in [1e-6, 1e6]" for letter in letters)
    script = f"""
        @rnd = float<{format_}, ne>;
        omega_m = rnd(speed);
        prepared float<ieee_64, ne>= {coefficient};
        L_M_mu2 = rnd(prepared);
        F_N rnd= {force};
        exact = ({coefficient}) * omega_m * omega_m;
        {{ {between} -> F_N -/ exact in ? }}"""

    assert proved(script) <= NORMAL_FORCE_ULP * unit * SLACK
    assert (
        "normal_force within 5 units in the last place (proved for" in (GENERATED / f"{name}.h").read_text()
    )


def hollow(real: str) -> tuple[float, float, mpmath.mpf]:
    """Return both parts of the default critical velocity as emitted, and what the first leaves of it."""
    _, _, dtype = UNITS[real]
    number = r"\(real\)\(([^)]+)\)" if real == "float" else r"\n    ([^(),]+)"
    first, second = (
        float(dtype(emitted("c2_parallel", rf"{number}, /\* omega_star_{k} \*/"))) for k in (1, 2)
    )
    p = accuracy.decimals()
    return first, second, paper.critical_velocity(p) / p.mu - mpmath.mpf(first)


def dyadic(number: float) -> str:
    """Return a number as Gappa reads it, exactly."""
    exact = Fraction(number)
    return f"{exact.numerator}b-{exact.denominator.bit_length() - 1}"


@every_real
@pytest.mark.parametrize("where", ["slow", "below", "at", "above", "fast"])
def test_difference_of_squares_is_proved(where: str, real: str) -> None:
    """Table 1's speed^2 - omega_star^2 keeps its digits up to 2^30 rad/s, next to the critical velocity too.

    There the first difference is exact, and a speed that is not the first part itself differs from it by
    more than the second part.
    """
    unit, format_, dtype = UNITS[real]
    first, second, left = hollow(real)
    spacing = float(np.spacing(dtype(first)))
    low, high = {
        "slow": (0.0, first / 2),
        "below": (first / 2, first - spacing),
        "at": (first, first),
        "above": (first + spacing, 2 * first),
        "fast": (2 * first, 2.0**30),
    }[where]
    around = ", ".join(mpmath.nstr(left * (1 + side * mpmath.mpf(10) ** -25), 45) for side in (-1, 1))
    text = emitted("c2_parallel", r"const real square_difference = ([^;]+);")
    rounded = text.replace("omega_star_1", dyadic(first)).replace("omega_star_2", dyadic(second))
    script = f"""
        @rnd = float<{format_}, ne>;
        speed = rnd(any);
        difference rnd= {rounded};
        near = speed + {dyadic(first)};
        sum = near + left;
        exact = (speed - {dyadic(first)} - left) * sum;
        {{ speed in [{dyadic(low)}, {dyadic(high)}] /\\ left in [{around}] -> difference -/ exact in ? }}
        (near - sum) / sum -> -left / sum {{ sum <> 0 }};"""

    assert proved(script) <= DIFFERENCE * unit


@every_real
def test_what_is_left_adds_up(real: str) -> None:
    """With both its parts within 5 units F_N of case C2 is proved within 10, more than is ever measured."""
    unit, format_, _ = UNITS[real]
    root = emitted("c2_parallel", r"const real load = REAL_SQRT\(([^;]+)\);").replace(
        "square_difference", "p"
    )
    near = f"[-{DIFFERENCE}b{int(np.log2(unit))}, {DIFFERENCE}b{int(np.log2(unit))}]"
    script = f"""
        @rnd = float<{format_}, ne>;
        p = rnd(p_any); q = rnd(q_any); scale = rnd(any);
        F_N rnd= sqrt({root}) * scale;
        exact = sqrt(P * P + Q * Q) * any;
        {{ p -/ P in {near} /\\ q -/ Q in {near} /\\ |P| in [1e-12, 1e9] /\\ |Q| in [1e-12, 1e9]
           /\\ any in [1e-6, 1e6] -> F_N -/ exact in ? }}"""

    assert proved(script) / unit < 10
