"""The page of benchmarks: every required figure has its row, and one that is missed says so."""

import re

import pytest

from benchmarks import page
from benchmarks.asked import CODE, DIAGNOSIS
from benchmarks.record import Asked, Measured, Part, table

LIMITS = {
    "most": Asked("time", "at most", 2.0, "ns"),
    "least": Asked("gain", "at least", 7.0),
    "range": Asked("part", "at least", 0.92, up_to=0.97),
}


@pytest.mark.parametrize(
    ("key", "value", "judged"),
    [
        ("most", 1.9, "reached"),
        ("most", 2.0, "reached"),
        ("most", 2.1, "not reached"),
        ("least", 7.1, "reached"),
        ("least", 6.6, "not reached"),
        ("least", float("nan"), "not reached"),
        ("most", float("nan"), "not reached"),
        ("range", 0.919, "not reached"),
        ("range", 0.97, "reached"),
        ("range", 0.98, "not reached"),
    ],
)
def test_a_missed_figure_is_not_reached(key: str, value: float, judged: str) -> None:
    """A value beyond its limit is marked as not reached, and so is a missing one."""
    row = table({key: LIMITS[key]}, {key: Measured(value, "so much", "a peer")})[-1]

    limit = {"most": "at most 2 ns", "least": "at least 7", "range": "at least 0.92 and at most 0.97"}[key]
    assert [LIMITS[key].what, limit, "so much", "a peer", judged] == [c.strip() for c in row.split("|")[1:-1]]


def test_every_figure_stands_once() -> None:
    """Figures that were not measured have their rows as well, each once."""
    text = page.page({"speed": Part({"numba": Measured(1.2)}, ["Told."])}, quick=False)

    rows = [line.split("|") for line in text.splitlines() if re.match(r"\| .* \| at (most|least) ", line)]
    asked = [*CODE.values(), *DIAGNOSIS.values()]
    assert sorted(one.what for one in asked) == sorted(row[1].strip() for row in rows)
    judged = {row[1].strip(): row[-2].strip() for row in rows}
    assert "not reached" == judged.pop(CODE["numba"].what)
    assert {"not measured"} == set(judged.values())


def test_a_part_measured_anew_replaces_its_own_rows_and_section() -> None:
    """The page is the one that a whole run with the new part would have written."""
    calls = Part({"compiled": Measured(0.1)}, ["Of calls.", "", "| a | b |"])
    old, new = (
        Part({"first": Measured(x), **{k: Measured(x) for k in more}}, [f"At {x}."])
        for x, more in ((0.5, ()), (0.99, ("three",)))
    )
    text = page.page({"calls": calls, "diagnosis": old}, quick=False)

    expected = page.page({"calls": calls, "diagnosis": new}, quick=False)
    assert expected == page.renewed(text, {"diagnosis": new})
    fuzzed = Part({}, ["Fuzzed."])
    expected = page.page({"calls": calls, "readers": fuzzed, "diagnosis": old}, quick=False)
    assert expected == page.renewed(text, {"readers": fuzzed})


def test_a_part_that_fails_does_not_end_the_run(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its reason is reported, the others are measured, and the exit status is 1."""

    def fails(_: bool) -> Part:
        raise RuntimeError("not installed: valgrind")

    parts = {"host": ("Arrays", lambda _: Part({"v3": Measured(1.5)})), "calls": ("Calls", fails)}
    monkeypatch.setattr(page, "PARTS", parts)
    monkeypatch.setattr("sys.argv", ["page.py", "calls", "host"])

    assert 1 == page.main()

    said = capsys.readouterr().out
    assert "not installed: valgrind" in said
    assert re.search(r"x86-64-v3.* 1\.5 ns .*\| reached \|", said)
