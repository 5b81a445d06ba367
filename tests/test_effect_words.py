"""What a person reads about an effect: complete, distinct, and decisive between similar families."""

from __future__ import annotations

import pytest

from eccentric.effects import Kin, Words, measurement_between
from tests.extended import CASES, effects, every_case


@every_case
def test_headlines_are_distinct_noun_phrases(case: str) -> None:
    """A headline continues "Missing: ...": no sentence of its own, no id, no brackets."""
    headlines = {effect.id: effect.words.headline for effect in effects(case).values()}

    assert [] == [
        effect_id
        for effect_id, text in headlines.items()
        if len(text.split()) < 3
        or text.endswith(".")
        or set("_(") & set(text)
        or text.split()[0] in {"The", "A", "An"}
    ]
    # The forms of what covers others have one name, as those have where a log does not tell them apart.
    forms = {e.words.headline for e in effects(case).values() if e.evidence.covers}
    distinct = [text for text in headlines.values() if text not in forms]
    assert len(distinct) == len(set(distinct))
    assert len(forms) == len({e.family for e in effects(case).values() if e.evidence.covers})


@every_case
def test_the_headline_of_a_harmonic_has_its_order(case: str) -> None:
    """Orders one and two have words of their own in English, all others a number."""
    found = effects(case)

    assert [
        "friction that varies once per turn of the link",
        "friction that varies twice per turn of the link",
        "friction that varies 3 times per turn of the link",
    ] == [found[f"link_harmonic_friction[n={n}]"].words.headline for n in (1, 2, 3)]


def test_a_family_has_one_meaning_and_one_hint() -> None:
    """All effects of a family share meaning and hint; no two families share a meaning."""
    meanings: dict[str, set[str]] = {}
    hints: dict[str, set[str]] = {}
    for case in CASES:
        for effect in effects(case).values():
            meanings.setdefault(effect.family, set()).add(effect.words.meaning)
            hints.setdefault(effect.family, set()).add(effect.words.hint)

    assert {1} == {len(texts) for texts in (*meanings.values(), *hints.values())}
    assert [] == [f for f, texts in meanings.items() if not min(texts).endswith(".") or len(min(texts)) < 20]
    assert "" not in set.union(*hints.values())
    assert len(meanings) == len(set.union(*meanings.values()))


@every_case
def test_words_name_families_and_kins_that_exist(case: str) -> None:
    """What distinguishes an effect is keyed by a family of the library or by a kin of one."""
    words = {effect.family: effect.words for effect in effects(case).values()}
    kins = {own.kin.name for own in words.values() if own.kin}
    known = kins | {e.family for c in CASES for e in effects(c).values()}

    assert set() == {key for own in words.values() for key in own.tell_apart} - known
    assert set() == {key for own in words.values() if own.kin for key in own.kin.tell_apart} - kins


SPEED = Kin("speed", {"speed": "More speeds."})
HEAT = Kin("heat", {"heat": "More heat.", "speed": "Warm and cold."})
A = ("a", Words(kin=SPEED, tell_apart={"b": "Look at b."}))
B = ("b", Words(kin=SPEED, tell_apart={"heat": "Log a temperature."}))
C = ("c", Words(kin=HEAT))
D = ("d", Words(kin=SPEED))
LONE = ("lone", Words())


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        (A, B, "Look at b."),
        (B, C, "Log a temperature."),
        (A, C, "Warm and cold."),
        (A, D, "More speeds."),
        (A, A, "More speeds."),
        (A, LONE, ""),
        (LONE, LONE, ""),
    ],
    ids=["family", "kin of the other", "two kins", "one kin", "alone", "one without kin", "none"],
)
def test_the_closest_relation_names_the_measurement(
    first: tuple[str, Words], second: tuple[str, Words], expected: str
) -> None:
    """A sentence on the other family precedes one on its kin, and that the kins' own; either way round."""
    assert [expected, expected] == [measurement_between(first, second), measurement_between(second, first)]
