"""The effect that is shown where none is adopted: the best one whose fit on the emitted module settles."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from eccentric.diagnosis.models import closest_effect
from eccentric.diagnosis.search.verdict import decided
from tests.searched import candidate, search

FIRST, SECOND = candidate("first", {2: 1.0}), candidate("second", {3: 1.0})


def fit(left: float, settled: bool = True) -> Any:
    """A fit that leaves a row of this size, before the low pass and below it."""
    rows = SimpleNamespace(score=np.ones(64, bool), operator="averages")
    data = SimpleNamespace(rows=rows, drive=SimpleNamespace(channels=SimpleNamespace(rig=None)))
    residual = left * np.random.default_rng(1).normal(size=64)
    return SimpleNamespace(
        settled=settled, data=data, residuals={"mechanical": residual}, residual_like=lambda *_: residual
    )


@pytest.mark.parametrize(
    ("settled", "expected"),
    [
        ({"first": True, "second": True}, "first"),
        ({"first": False, "second": True}, "second"),
        ({"first": False, "second": False}, None),
    ],
)
def test_an_effect_whose_fit_does_not_settle_is_passed_over(
    monkeypatch: pytest.MonkeyPatch, settled: dict[str, bool], expected: str | None
) -> None:
    """Of two effects that the search ranks, the first one that settles is shown, with its own gain."""
    left = {"first": 0.5, "second": 0.8}
    found = decided({"mechanical": search({2: 3.0, 3: 2.0}, FIRST, SECOND)})
    offered: Any = [SimpleNamespace(id=name) for name in left]
    models: Any = SimpleNamespace(adopted=False, fits_the_rig=True, base=None, paper=fit(1.0))

    def refit(_: Any, effects: Any, __: Any) -> Any:
        ((effect, _),) = effects
        return fit(left[effect.id], settled[effect.id])

    monkeypatch.setattr("eccentric.diagnosis.models.refit", refit)
    shown = closest_effect(found, offered, models)

    assert expected == (None if shown is None else shown.effect.id)
    if shown is not None:
        assert 100.0 * (1.0 - left[shown.effect.id]) == pytest.approx(shown.percent)
