"""One log has one answer, whichever rig file an engineer might have written; and the table of it."""

from __future__ import annotations

import pytest

from benchmarks.rig_variants import answers, content, paths, row, scaled, variants
from tests.logged import SHARED

EXAMPLES = SHARED / "examples"


@pytest.mark.slow
@pytest.mark.skipif(not EXAMPLES.is_dir(), reason="the shared example logs are not beside this clone")
@pytest.mark.parametrize("name", ["example1", "example2"])
def test_other_bandwidths_and_wrong_constants_leave_the_name(name: str) -> None:
    """Nine of ten rig files or more give the same verdict and the same leading family."""
    found = answers(*paths(SHARED, name))
    (verdict, families), every = found[0][1], [answer for _, answer in found]
    same = sum(v == verdict and families[:1] == f[:1] for v, f in every)

    assert len(every) >= 10
    assert same >= 0.9 * len(every)


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


def test_a_quantity_with_a_unit_is_scaled() -> None:
    """A number stays a number, a text keeps its unit."""
    assert (2.04, "0.98 ohm", "0.08 s") == (scaled(2.0, 1.02), scaled("1 ohm", 0.98), scaled("0.1 s", 0.8))


def test_a_row_counts_verdict_and_leading_family() -> None:
    """A further name beside the first is the same answer, another first one is not."""
    found = [
        ("as it is", ("named", ("stribeck",))),
        ("R +2 %", ("named", ("stribeck", "resistance_mismatch"))),
        ("R -2 %", ("named", ("resistance_mismatch", "stribeck"))),
        ("J_m +5 %", ("unexplained", ())),
    ]

    assert (
        "| log | named stribeck | 2 of 4 | named resistance_mismatch, stribeck (1); unexplained (1) |"
        == row("log", found)
    )
