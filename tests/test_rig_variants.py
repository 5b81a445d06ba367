"""One log has one answer, whichever rig file an engineer might have written; and the table of it."""

from __future__ import annotations

import pytest

from benchmarks.rig_variants import Answer, answers, content, letters_changed, paths, row, scaled, variants
from tests.logged import SHARED

EXAMPLES = SHARED / "examples"


@pytest.mark.slow
@pytest.mark.skipif(not EXAMPLES.is_dir(), reason="the shared example logs are not beside this clone")
def test_other_bandwidths_and_wrong_constants_leave_the_name() -> None:
    """Nine of ten rig files or more give the same verdict and leading family, of one of the logs."""
    found = answers(*paths(SHARED, "example2"))
    changed = [answer for answer in found if answer.changed]

    assert len(found) >= 10
    assert sum(answer.leading == found[0].leading for answer in found) >= 0.9 * len(found)
    assert 6 == len(changed)


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


def test_what_was_changed_goes_by_its_letter() -> None:
    """J_m and J_l are both the inertia; a value that stays is none of them."""
    plain = {"known": {"R_ohm": 1.0, "k_i": 0.1, "J_m_kgm2": 1e-4, "J_l": 0.03}}

    assert frozenset("R") == letters_changed(plain, {"known": plain["known"] | {"R_ohm": 1.02}})
    assert frozenset("J") == letters_changed(
        plain, {"known": plain["known"] | {"J_m_kgm2": 2e-4, "J_l": 0.04}}
    )
    assert not letters_changed(plain, plain)


def test_a_quantity_with_a_unit_is_scaled() -> None:
    """A number stays a number, a text keeps its unit."""
    assert (2.04, "0.98 ohm", "0.08 s") == (scaled(2.0, 1.02), scaled("1 ohm", 0.98), scaled("0.1 s", 0.8))


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


def test_a_control_stays_one_where_only_the_changed_value_is_told() -> None:
    """Nothing is missing but the value that was changed."""
    found = Answer("R +2 %", "named", ("resistance_mismatch",), {"resistance_mismatch": "R"}, frozenset("R"))

    assert Answer("as it is", "nothing_missing", ()).leading == found.leading
