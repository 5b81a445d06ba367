"""The coefficients that `prepare` fills, in each precision."""

import re

import pytest

from tests.compiled import GENERATED, REAL, declarations, run
from tests.emitted import every_model


@pytest.mark.parametrize("real", REAL.values())
@every_model
def test_every_coefficient_is_used(name: str, real: str) -> None:
    """None is held that no function of that precision reads; which precision it is, is chosen beforehand."""
    struct = re.findall(r"typedef struct \{([^}]*)\} \w+_coefficients;", declarations(name, real))[0]
    held = set(re.findall(r"(\w+);", struct))
    source = run("gcc", "-E", "-P", f"-DECCENTRIC_REAL={real}", GENERATED / f"{name}.c")
    filled = re.findall(rf"int {name}_prepare_{real}\([^)]*\)\n\{{.*?\n\}}", source, re.DOTALL)[0]

    assert held == set(re.findall(r"c->(\w+) = ", filled))
    assert held == set(re.findall(r"c->(\w+)", source.replace(filled, "")))
    assert [] == re.findall(r"\b\d == \d\b", source)
