"""Two results are compared number by number, and the reference results are there to be compared."""

import json
import sys
from pathlib import Path
from typing import Any

import pytest

from benchmarks import compare_results, reference_results
from benchmarks.compare_results import differences
from tests.virtual import log_of

NAN = float("nan")
RESULT = {"verdict": "named", "rmse": {"paper": 0.25}, "interval": [1.0, 2.0], "probability": 1, "floor": NAN}


@pytest.mark.parametrize(
    ("after", "expected"),
    [
        (RESULT, []),
        ({**RESULT, "rmse": {"paper": 0.25 * (1 + 0.9e-9)}}, []),
        ({**RESULT, "probability": 1.0}, []),
        ({**RESULT, "rmse": {"paper": 0.25 * (1 - 1.1e-9)}}, ["/rmse/paper: 0.25, then 0.249999999725"]),
        ({**RESULT, "rmse": {"paper": -0.25}}, ["/rmse/paper: 0.25, then -0.25"]),
        ({**RESULT, "rmse": {}}, ["/rmse/paper: only in the first"]),
        ({**RESULT, "more": None}, ["/more: only in the second"]),
        ({**RESULT, "interval": [1.0]}, ["/interval: 2 entries, then 1"]),
        ({**RESULT, "interval": [1.0, "2"]}, ["/interval/1: 2.0, then '2'"]),
        ({**RESULT, "verdict": "unexplained"}, ["/verdict: 'named', then 'unexplained'"]),
        ({**RESULT, "probability": True}, ["/probability: 1, then True"]),
        ({**RESULT, "floor": 0.0}, ["/floor: nan, then 0.0"]),
    ],
)
def test_differences_are_named_by_their_place(after: dict[str, Any], expected: list[str]) -> None:
    """A relative 1e-9 separates what agrees from what does not; NaN agrees with NaN only, true is not 1."""
    found = list(differences(RESULT, after, 1e-9))

    assert expected == found


def _compared(
    arguments: list[Path | str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> tuple[int, list[str]]:
    """Exit status and lines of the command."""
    monkeypatch.setattr(sys, "argv", ["compare_results.py", *map(str, arguments)])
    return compare_results.main(), capsys.readouterr().out.splitlines()


def test_folders_are_compared_file_by_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Equal folders give 0; another number, or a file that one of them lacks, gives 1 and a line."""
    before, after = tmp_path / "before", tmp_path / "after"
    for folder in (before, after):
        (folder / "bench").mkdir(parents=True)
        (folder / "bench" / "fit.json").write_text(json.dumps(RESULT))

    assert (0, ["1 pairs compared, 0 differences"]) == _compared([before, after], monkeypatch, capsys)

    (after / "bench" / "fit.json").write_text(json.dumps({**RESULT, "probability": 2}))
    (before / "only.json").write_text("{}")
    place = after / "bench" / "fit.json"
    expected = [
        f"{place}: /probability: 1, then 2",
        f"{after / 'only.json'}: required to compare, not there",
        "2 pairs compared, 2 differences",
    ]
    assert (1, expected) == _compared([before, after], monkeypatch, capsys)
    coarse = _compared([before, after, "--tolerance", "0.6"], monkeypatch, capsys)
    assert (1, expected[1:2]) == (coarse[0], coarse[1][:1])


def test_the_reference_logs_are_those_of_the_issue() -> None:
    """The bundled log is there; with data there are four examples and five measured rigs beside it."""
    (bundled,) = reference_results.reference_logs(None).values()
    every = reference_results.reference_logs(Path("data"))

    assert [True, True] == [path.is_file() for path in bundled]
    assert 1 + 4 + 5 == len(every)
    assert (Path("data/examples/example3.csv.gz"), Path("data/examples/example3.json")) == every["example3"]
    assert [] == [name for name, (_, rig) in every.items() if rig.suffix == ".toml" and not rig.is_file()]


@pytest.mark.slow
def test_reference_results_are_written_once_for_each_command(tmp_path: Path) -> None:
    """A log gives its two results; one that is not there gives a line for each command and stops nothing."""
    log, rig = log_of(tmp_path, 9004, seconds=20.0)
    out = tmp_path / "out"
    failed = reference_results.run_all({"own": (log, rig), "gone": (tmp_path / "gone.csv", rig)}, out)
    written = {str(path.relative_to(out)) for path in out.rglob("*.json")}

    assert {"own/diagnose/diagnosis.json", "own/fit/fit.json"} == written
    assert ["diagnose gone", "fit gone"] == [line.partition(":")[0] for line in failed]
