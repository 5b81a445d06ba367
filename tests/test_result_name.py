"""The name of a diagnosis' model says what was done to the base model."""

from types import SimpleNamespace
from typing import Any

import pytest

from eccentric.diagnosis import is_result_name, result_name


def found(base: str, effects: list[str], including: list[str]) -> Any:
    """What a name depends on."""
    models = SimpleNamespace(base=SimpleNamespace(name=base))
    asked = SimpleNamespace(request=SimpleNamespace(including=including))
    return SimpleNamespace(models=models, result=SimpleNamespace(effects=effects), asked=asked)


@pytest.mark.parametrize(
    ("base", "effects", "including", "expected"),
    [
        ("c2_parallel", ["stribeck"], [], "c2_parallel_extended"),
        ("c2_parallel", [], ["stribeck"], "c2_parallel_extended"),
        ("c2_parallel_extended", ["cogging"], [], "c2_parallel_extended_2"),
        ("c2_parallel_extended_2", ["cogging"], [], "c2_parallel_extended_3"),
        ("c2_parallel_fitted", ["cogging"], [], "c2_parallel_extended"),
        ("c2_parallel", [], [], "c2_parallel_fitted"),
        ("c2_parallel_fitted", [], [], "c2_parallel_fitted"),
        ("c2_parallel_extended", [], [], "c2_parallel_extended"),
    ],
)
def test_only_what_was_extended_is_called_so(
    base: str, effects: list[str], including: list[str], expected: str
) -> None:
    """One suffix at most, with the number of the extension from the second on."""
    name = result_name(found(base, effects, including))

    assert (expected, True, False) == (name, is_result_name(name), is_result_name("my_arm"))
