"""The benchmark of the diagnosis of arms counts families and joints, wrong names and alarms."""

from benchmarks.arms_diagnosis import ArmAnswer, ArmJob, figures

STRIBECK, COGGING = (2, "stribeck"), (2, "cogging")
ELSEWHERE = (1, "stribeck")


def answer(truth: tuple[int, str] | None, *named: tuple[int, str], **others: object) -> ArmAnswer:
    """What came of a log; the first name leads."""
    job = ArmJob(0, "2r", None if truth is None else truth[1], 0.1)
    first, verdict = (named[0], "named") if named else (None, "nothing_missing")
    return ArmAnswer(job, truth, **{"verdict": verdict, "first": first, "named": list(named), **others})  # pyright: ignore[reportArgumentType]


ANSWERS = [
    answer(STRIBECK, STRIBECK),
    answer(STRIBECK, ELSEWHERE),
    answer(STRIBECK, verdict="not_identifiable", first=STRIBECK),
    answer(STRIBECK, COGGING),
    answer(STRIBECK, beyond=0.001),
    answer(None),
    answer(None, STRIBECK),
]


def test_family_and_joint_both_count() -> None:
    """Two of four lead with both; a right family in the wrong joint is wrong; aliases are left out."""
    found = {key: one.value for key, one in figures(ANSWERS).items()}

    assert {"arms first": 0.5, "arms wrong": 0.5, "arms alarms": 0.5} == found
