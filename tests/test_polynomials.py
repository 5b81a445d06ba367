"""How far rounding takes the emitted polynomials from their exact values: bounds that Gappa proves."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

GENERATED = Path(__file__).resolve().parent.parent / "generated"
FORMATS = {"float": "ieee_32", "double": "ieee_64"}
# Half a turn of the link from the top at most, and a little: the half angle is within a quarter turn.
LARGEST_HALF_ANGLE = 1.5709
# Of sin(h)/h - 1 and of cos(h); in units of eps, 2^-23 and 2^-52: 0.52 and 1.9.
PROVED = {
    ("sine_ratio", "float"): 6.2e-8,
    ("sine_ratio", "double"): 1.2e-16,
    ("cosine", "float"): 2.3e-7,
    ("cosine", "double"): 4.2e-16,
}


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
    """Return what Gappa is asked: each step rounded and unrounded, and how far the results are apart."""
    rounded, exact, step = [f"@rnd = float<{FORMATS[real]}, ne>;", "h = rnd(angle);"], [], dict[str, int]()

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


@pytest.mark.parametrize(("function", "real"), PROVED, ids=map("-".join, PROVED))
def test_rounding_is_bounded(function: str, real: str) -> None:
    """Over all half angles the emitted polynomial is within the proved bound of its exact value."""
    if shutil.which("gappa") is None:
        pytest.skip("not installed: gappa")

    done = subprocess.run(
        ["gappa"], input=script(function, real), capture_output=True, text=True, check=True, timeout=60
    )

    bounds = [abs(float(x)) for x in re.findall(r"\{(-?[\d.e-]+), ", done.stderr)]
    assert 2 == len(bounds)
    assert 0.9 * PROVED[function, real] <= max(bounds) <= PROVED[function, real]
