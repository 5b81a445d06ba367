"""What the answer says of how many resampled logs find an effect."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from eccentric.diagnosis.search.candidate import Variant, grid
from eccentric.diagnosis.search.verdict import Adopted
from eccentric.presentation import stability_words
from eccentric.presentation.diagnosis_text import _covered
from tests.searched import candidate

A: Variant = grid(candidate("a", {2: 1.0}))[0]


@pytest.mark.parametrize(
    ("own", "expected"),
    [
        (None, ""),
        (Adopted("electrical", A, (), 0.1), "stability not checked (the log has too few blocks)"),
        (Adopted("electrical", A, (), 0.1, 100, 100), "found in 100 of 100 resampled logs"),
        (
            Adopted("electrical", A, (), 0.1, 93, 100, {"b": 6}),
            "found in 93 of 100 resampled logs (b in 6)",
        ),
        (
            Adopted("electrical", A, (), 0.1, 62, 100, {"b": 30}, by_both=True),
            (
                "found in 62 of 100 resampled logs by the electrical balance alone (b in 30);"
                " both balances together decide"
            ),
        ),
    ],
)
def test_the_words_say_which_variants_find_it(own: Adopted | None, expected: str) -> None:
    """And what takes its place in the others; too few are told with what decides instead."""
    found = SimpleNamespace(attribution=SimpleNamespace(adopted_as={"a": own}.get))

    assert stability_words(cast("Any", found), cast("Any", SimpleNamespace(id="a"))) == expected


def test_a_covered_cause_is_marked() -> None:
    """Its probability is part of that of the name, so that the two are not added."""
    own = Adopted("electrical", A, (), 0.1, covers=("b",))
    found: Any = SimpleNamespace(attribution=SimpleNamespace(adopted=(own,)))
    assert (f", counted in {A.candidate.id}", "") == (_covered(found, "b"), _covered(found, "c"))
