"""Two laws of one variable that only outline its curve are no name; two orders of one family are."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from eccentric.diagnosis.search.verdict import _outlines


def _variant(family: str, variable: str = "time") -> SimpleNamespace:
    return SimpleNamespace(candidate=SimpleNamespace(family=family, variable=variable))


@pytest.mark.parametrize(
    ("families", "variable", "best", "smooth", "outlines"),
    [
        (("wear_runin", "time_drift"), "time", 5.0, 1.2, True),
        (("wear_runin", "time_drift"), "velocity", 5.0, 1.2, False),
        (("cogging", "cogging"), "time", 5.0, 1.2, False),
        (("wear_runin",), "time", 5.0, 1.2, False),
        (("wear_runin", "time_drift"), "time", 1.9, 1.0, False),
        (("wear_runin", "time_drift"), "time", 5.0, 3.5, False),
    ],
)
def test_what_two_laws_leave_is_a_curve_of_their_variable(
    families: tuple[str, ...], variable: str, best: float, smooth: float, outlines: bool
) -> None:
    """More than twice the noise is left, and a free curve of the same variable takes most of the excess."""
    search = SimpleNamespace(
        best=SimpleNamespace(score=best, variants=[_variant(family) for family in families]),
        screen=SimpleNamespace(floor=1.0),
    )
    curve = SimpleNamespace(score=smooth, last=SimpleNamespace(variable=variable))
    assert _outlines(search, curve) is outlines  # pyright: ignore[reportArgumentType]
