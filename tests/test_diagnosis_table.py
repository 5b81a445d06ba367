"""The benchmark of the diagnosis counts hits, false alarms, honest and dishonest answers."""

from benchmarks.diagnosis_jobs import Job, Result
from benchmarks.diagnosis_table import details, figures
from benchmarks.oracle import Oracle


def result(
    kind: str, truth: list[str], verdict: str, named: list[str] | None = None, **others: object
) -> Result:
    """Return what came of a log; the ranking is what was named."""
    job = Job(kind, 0, tuple((family, 0.1) for family in truth))
    named = named or []
    return Result(job, verdict, truth, [0.1] * len(truth), named, named, probability=0.95, **others)  # pyright: ignore[reportArgumentType]


RESULTS = [
    result("single", ["stribeck"], "named", ["stribeck"]),
    result("single", ["stribeck"], "named", ["cogging"]),
    result("single", ["stribeck"], "unexplained", depends=["velocity"]),
    result("single", ["backlash"], "nothing_missing"),
    result("control", [], "nothing_missing"),
    result("control", [], "unexplained"),
    result("pair", ["stribeck", "cogging"], "named", ["cogging", "stribeck"]),
    result("outside", ["velocity"], "unexplained", depends=["time", "velocity"]),
    result("outside", ["velocity"], "unexplained", depends=["time", "link_angle", "velocity"]),
    result("outside", ["velocity"], "named", ["stribeck"]),
]
LONG = [result("long", ["stribeck"], "named", ["stribeck"], seconds=3.0, memory=0.5)]


def test_fractions_are_those_of_the_logs() -> None:
    """One of four singles is right, one wrong; one control of two a false alarm; one of three honest."""
    found = {key: one.value for key, one in figures(RESULTS, LONG).items()}

    assert {"first": 0.25, "wrong": 0.25, "false alarms": 0.5, "both": 1.0, "outside": 1 / 3} == {
        key: found[key] for key in ("first", "wrong", "false alarms", "both", "outside")
    }
    assert (2 / 3, 3.0, 0.5) == (found["sure"], found["seconds"], found["memory"])


def test_faint_effects_count_where_the_truth_proves_them() -> None:
    """Of two that a fit with the truth proves, one is named; a third, below z = 3, does not count."""
    faint = [
        result(
            "faint",
            ["stribeck"],
            "named",
            ["stribeck"],
            oracle=Oracle("mechanical", 1.0, 9.0, 0.0, 9.0),
            rmse={"mechanical": 1.0},
        ),
        result("faint", ["stribeck"], "nothing_missing", oracle=Oracle("mechanical", 1.0, 3.1, 0.0, 3.1)),
        result("faint", ["stribeck"], "nothing_missing", oracle=Oracle("mechanical", 1.0, 2.9, 0.0, 2.9)),
    ]

    assert 0.5 == figures([*RESULTS, *faint], LONG)["faint"].value


def test_misses_that_data_could_have_decided_are_counted() -> None:
    """Of two wrong singles, a fit that knows the truth predicts better than one of the answers."""

    def single(named: str, z: float) -> Result:
        known = Oracle("mechanical", 1.0, 9.0, z, 9.0)
        return result("single", ["stribeck"], "named", [named], oracle=known, rmse={"mechanical": 1.0})

    lines = details([single("cogging", 3.1), single("cogging", 2.9), single("stribeck", 5.0)])
    (line,) = (line for line in lines if line.startswith("| not first"))

    assert "1/2" in line
