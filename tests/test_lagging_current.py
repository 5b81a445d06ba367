"""The noise of the electrical balance is looked for where the current's lag is taken back."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np

from eccentric.diagnosis.search import balances


def test_a_lag_is_taken_back_within_a_segment() -> None:
    """Each sample is that of `lag` rows later, NaN where its segment or the log has none."""
    segment = np.array([0, 0, 0, 0, 1, 1, 1])
    channels = cast("Any", SimpleNamespace(time=SimpleNamespace(segment=segment)))
    signal = np.arange(7.0)

    np.testing.assert_array_equal(
        [2, 3, np.nan, np.nan, 6, np.nan, np.nan], balances._ahead(signal, channels, 2)
    )
    np.testing.assert_array_equal([np.nan, 0, 1, 2, np.nan, 4, 5], balances._ahead(signal, channels, -1))


def test_lags_are_those_of_a_delayed_sensor() -> None:
    """From 20 ms early to 70 ms late, no more of them at 10 kHz than are 2 ms apart."""

    def at(step: float) -> list[int]:
        return balances._lags(cast("Any", SimpleNamespace(time=SimpleNamespace(logged_step_s=step))))

    fine = at(1e-4)
    assert [*range(-5, 19)] == at(0.004)
    assert (-200, 700, 20) == (fine[0], fine[-1], max(np.diff(fine)))
