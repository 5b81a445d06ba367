"""One log has one answer, whichever rig file an engineer might have written; and the table of it."""

from __future__ import annotations

import pytest

from benchmarks import rig_variants
from benchmarks.rig_variants import Answer, answers, content, paths, row, variants
from tests.logged import SHARED

EXAMPLES = SHARED / "examples"


@pytest.mark.slow
@pytest.mark.skipif(not EXAMPLES.is_dir(), reason="the shared example logs are not beside this clone")
def test_other_bandwidths_and_wrong_constants_leave_the_name(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every second rig file of one log gives the same verdict and leading family; the page has all of all."""
    monkeypatch.setattr(rig_variants, "variants", lambda *rig: list(variants(*rig))[::2])
    found = answers(*paths(SHARED, "example1"))

    assert 6 == len(found)
    assert {found[0].leading} == {answer.leading for answer in found}
    assert 3 == sum(bool(answer.changed) for answer in found)


@pytest.mark.skipif(not EXAMPLES.is_dir(), reason="the shared example logs are not beside this clone")
def test_a_variant_changes_one_choice() -> None:
    """Bandwidth, threshold, hold-out, R, k and J of an example: one each, two ways but for the hold-out."""
    rig = content(paths(SHARED, "example1")[1])
    found = dict(variants(rig, []))
    changed = {name: {key for key in one if one[key] != rig.get(key)} for name, one in found.items()}

    assert changed.pop("as it is") == set()
    assert all(len(keys) == 1 for keys in changed.values())
    assert 11 == len(changed)
    assert found["R -2 %"]["known"]["R_ohm"] == pytest.approx(0.98 * rig["known"]["R_ohm"], rel=1e-12)


def test_a_row_counts_verdict_and_leading_family() -> None:
    """A further name beside the first is the same answer, another first one is not.

    A value that was changed is told beside the name or alone; one that was not is a name like any other, and
    to tell another one than was changed is not to tell it.
    """
    values, R, J = {"resistance_mismatch": "R", "inertia_mismatch": "J"}, frozenset("R"), frozenset("J")
    found = [
        Answer("as it is", "named", ("stribeck",), values),
        Answer("R +2 %", "named", ("stribeck", "resistance_mismatch"), values, R),
        Answer("R -2 %", "named", ("inertia_mismatch", "stribeck"), values, R),
        Answer("bandwidth x 0.8", "named", ("resistance_mismatch", "stribeck"), values),
        Answer("J_m +5 %", "named", ("inertia_mismatch",), values, J),
        Answer("J_m -5 %", "unexplained", (), values, J),
    ]

    assert (
        "| log | named stribeck | 3 of 6 | 2 of 4 | named resistance_mismatch, stribeck (1);"
        " named inertia_mismatch (1); unexplained (1) |" == row("log", found)
    )
