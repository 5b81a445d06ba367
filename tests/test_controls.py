"""Twelve logs with nothing missing, from drives with the ordinary faults of drives: not one alarm."""

from __future__ import annotations

import pytest

from eccentric.diagnosis import diagnose
from tests.logged import SHARED

CONTROLS = SHARED / "controls"


@pytest.mark.skipif(not CONTROLS.is_dir(), reason="the shared control logs are not beside this clone")
@pytest.mark.slow  # `test_diagnose` has a control of the virtual bench
@pytest.mark.parametrize("number", range(1, 13))
def test_nothing_is_missing(number: int) -> None:
    """No name, no tie, no `unexplained`: the noise of bus, loop and encoder is no effect."""
    log = CONTROLS / f"control{number:02}.csv.gz"

    found = diagnose([log], CONTROLS / f"control{number:02}.json")

    assert found.attribution.verdict == "nothing_missing"
