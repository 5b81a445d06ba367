"""How far rounding takes the emitted normal force: what Gappa proves, from the text of the emitted C."""

import re
from fractions import Fraction
from functools import cache
from pathlib import Path

import mpmath
import numpy as np
import pytest

from eccentric.emission.program.accuracy import PROVED_FORCE
from tests import accuracy, extended, paper
from tests.gappa import proved

GENERATED = Path(__file__).resolve().parent.parent / "generated"
C2 = (GENERATED / "c2_parallel.c").read_text(encoding="utf-8")
PROVED = " units in the last place (proved for parameters and speeds of 1e-6 to 1e6)"
UNITS = {"float": (2.0**-24, "ieee_32", np.float32), "double": (2.0**-53, "ieee_64", np.float64)}
every_real = pytest.mark.parametrize("real", UNITS)
# A rounding takes u/(1 + u) of a number at most; Gappa counts u.
SLACK = 1 + 2.0**-50
# In units u of the relative error, which are at most one of the last place.
DIFFERENCE = 5


def emitted(text: str, pattern: str) -> str:
    """Return the one thing in emitted C that a pattern finds, with the names of coefficients bare."""
    (found,) = set(re.findall(pattern, text))
    return re.sub(r"\b[pc]->", "", found)


@cache
def products() -> frozenset[tuple[str, str]]:
    """Return F_N as emitted, what `prepare` does for it and the rest, wherever a header calls it proved.

    Of all derived models, and of every effect of the library beside case C1, a few at a time.
    """
    files = [{path.name: path.read_text(encoding="utf-8")} for path in sorted(GENERATED.glob("*.[ch]"))]
    texts: dict[str, str] = {}
    for found in [*files, *(one.texts for one in extended.extended("C1"))]:
        texts |= found
    claim = f"normal_force within {PROVED_FORCE.anywhere}{PROVED}"
    proved = [name for name, text in texts.items() if name.endswith(".h") and claim in text]
    assert {"c1_perpendicular.h", "c1_asymmetric.h"} < set(proved)
    patterns = [
        rf"const {kind} {target} = ([^;]+);" for kind, target in (("double", "L_M_mu2"), ("real", "F_N"))
    ]
    sources = [texts[name.replace(".h", ".c")] for name in proved]
    return frozenset((emitted(text, patterns[0]), emitted(text, patterns[1])) for text in sources)


@pytest.mark.slow
@every_real
def test_products_are_proved(real: str) -> None:
    """F_N of case C1 keeps its bound for all parameters and speeds of 1e-6 to 1e6, whatever the effects."""
    unit, format_, _ = UNITS[real]
    letters = ("L", "M", "mu", "omega_m")
    between = " /\\ ".join(f"{letter} in [1e-6, 1e6]" for letter in letters)
    for coefficient, force in products():
        script = f"""
            @rnd = float<{format_}, ne>;
            omega_m = rnd(speed);
            prepared float<ieee_64, ne>= {coefficient};
            L_M_mu2 = rnd(prepared);
            F_N rnd= {force};
            exact = L * M * mu * mu * omega_m * omega_m;
            {{ {between} -> F_N -/ exact in ? }}"""

        assert proved(script) <= PROVED_FORCE.anywhere * unit * SLACK, (coefficient, force)


def omega_star_emitted(real: str) -> tuple[float, float, mpmath.mpf]:
    """Return both parts of the default critical velocity as emitted, and what the first leaves of it."""
    _, _, dtype = UNITS[real]
    number = r"\(real\)\(([^)]+)\)" if real == "float" else r"([^(),]+)"
    first, second = (float(dtype(emitted(C2, rf"\.omega_star_{k} = {number},"))) for k in (1, 2))
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
    first, second, left = omega_star_emitted(real)
    spacing = float(np.spacing(dtype(first)))
    low, high = {
        "slow": (0.0, first / 2),
        "below": (first / 2, first - spacing),
        "at": (first, first),
        "above": (first + spacing, 2 * first),
        "fast": (2 * first, 2.0**30),
    }[where]
    around = ", ".join(mpmath.nstr(left * (1 + side * mpmath.mpf(10) ** -25), 45) for side in (-1, 1))
    text = emitted(C2, r"const real square_difference = ([^;]+);")
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
    root = emitted(C2, r"const real load = c2_parallel_square_root\(([^;]+)\);").replace(
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
