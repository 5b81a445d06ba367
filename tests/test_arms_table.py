"""The benchmark of the diagnosis of arms counts families and joints, wrong names and alarms."""

from benchmarks.arms_diagnosis import CONTROLS, LOGS, ArmAnswer, ArmJob, details, figures, jobs

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


def test_misses_are_listed() -> None:
    """Two wrong names and the alarm, one row each."""
    rows = details(ANSWERS)

    assert 3 == len(rows) - rows.index("| seed | log | truth | verdict | named | first |") - 2
    assert any("| stribeck in 2 | named | stribeck in 1 | stribeck in 1 |" in row for row in rows)


def test_as_many_logs_as_are_said() -> None:
    """Every seed once; all kinds of arms; controls without a family."""
    listed = list(jobs(quick=False))

    assert len({job.seed for job in listed}) == len(listed) == LOGS + CONTROLS
    assert CONTROLS == sum(job.family is None for job in listed)
    assert {"2r", "3", "6"} == {job.arm for job in listed}
