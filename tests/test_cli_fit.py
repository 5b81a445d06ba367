"""`eccentric fit`: a whole folder and a short table, or one line and nothing."""

from __future__ import annotations

import gzip
import json
import sys
from pathlib import Path

import pytest

from eccentric import cli

BENCH = Path(__file__).parents[1] / "examples" / "bench"
LOG, RIG = BENCH / "bench.csv.gz", BENCH / "bench.json"


@pytest.fixture(scope="module")
def rows() -> list[str]:
    """Header and rows of the bundled log."""
    return gzip.decompress(LOG.read_bytes()).decode().splitlines()


def test_folder_and_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The folder holds strict JSON of the stated format and the figure; the table has at most 15 lines."""
    assert cli.main(["fit", str(LOG), "--rig", str(RIG), "--out", str(tmp_path / "out")]) == 0
    shown = capsys.readouterr()
    names = {path.name for path in (tmp_path / "out").iterdir()} - {".eccentric"}
    assert names == {"fit.json", "fit.png", "fit.svg"}
    text = (tmp_path / "out" / "fit.json").read_text(encoding="utf-8")
    found = json.loads(text, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))
    assert found["format"] == "eccentric-fit/1"
    assert (found["model"], found["drive"], found["unit"]) == ("c2_parallel", "current", "N m")
    assert set(found["coefficients"]) == {"B_lN", "C_lN", "B_m", "C_m"}
    assert set(found["rmse_holdout_Nm"]) == {"linear", "paper", "paper_unbounded"}
    assert found["parameters"]["C_m"] == found["coefficients"]["C_m"]["value"]
    assert len(shown.out.splitlines()) <= 15
    assert "held-out RMSE [N m]" in shown.out


def test_without_matplotlib_the_fit_still_comes_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A missing matplotlib costs the figure only, and one line names the extra."""
    for name in [name for name in sys.modules if name.startswith("matplotlib")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert cli.main(["fit", str(LOG), "--rig", str(RIG), "--out", str(tmp_path / "out")]) == 0
    said = "no figure: matplotlib is required for the figure (extra `figures`): pip install matplotlib"
    assert said in capsys.readouterr().out
    assert (tmp_path / "out" / "fit.json").is_file()
    assert not (tmp_path / "out" / "fit.png").exists()


def changed(**known: float | None) -> dict:
    """The bundled rig with other known values; None takes one out."""
    rig = json.loads(RIG.read_text())
    rig["known"] = {k: v for k, v in {**rig["known"], **known}.items() if v is not None}
    return rig


RIGS = {
    "unknown key": ({**changed(), "colour": "red"}, "unknown key 'colour'"),
    "unknown unit": (changed() | {"columns": {"time": {"column": "time_s", "unit": "parsec"}}}, "parsec"),
    "unknown drive": (
        changed() | {"drive": "torque"},
        "drive: expected a channel with a column in the log (current, voltage), got 'torque'",
    ),
    "no k_i": (changed(k_i_Nm_per_A=None), "expected [known] k_i"),
    "never moving": (changed() | {"moving_threshold_rad_s": 1e4}, "moving rows"),
}


@pytest.mark.parametrize("name", RIGS)
def test_bad_rig_is_one_line(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A rig that cannot be: status 2, one line that names the quantity, no folder."""
    rig, message = RIGS[name]
    (tmp_path / "rig.json").write_text(json.dumps(rig))
    assert message in refused([str(LOG), "--rig", str(tmp_path / "rig.json")], tmp_path, capsys)


def test_a_log_that_does_not_fit_its_rig_says_so(
    rows: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A current of the wrong sign explains nothing: no comparison of models, but what to check."""
    log = tmp_path / "log.csv"
    rig = changed() | {"columns": {"time": "time_s", "theta_m": "theta_m_rad", "current": "0 - current_A"}}
    log.write_text("\n".join(rows) + "\n")
    (tmp_path / "rig.json").write_text(json.dumps(rig))
    arguments = ["fit", str(log), "--rig", str(tmp_path / "rig.json"), "--out", str(tmp_path / "out")]
    assert cli.main(arguments) == 1
    *table, sentence, _ = capsys.readouterr().out.splitlines()
    explained = json.loads((tmp_path / "out" / "fit.json").read_text())["r_squared_holdout"]
    assert explained["paper"] < 0.0
    assert sentence == (
        f"This log does not fit the rig (R^2 {explained['paper']:.2f}): check units and signs of the "
        'columns, mu, and the zero angle (theta_zero_rad = "estimate" estimates it).'
    )
    assert not any("suggests a missing effect" in line for line in table)

    emit = ["emit", "c2_parallel", "--parameters", str(tmp_path / "out" / "fit.json"), "--backend", "jax"]
    emit += ["--out", str(tmp_path / "emitted")]
    assert cli.main(emit) == 2
    required = "--accept-misfit: needed to emit fit.json, since its log does not fit the rig"
    assert capsys.readouterr().err == f"eccentric: error: {required}\n"
    assert not (tmp_path / "emitted").exists()
    assert cli.main([*emit, "--accept-misfit"]) == 0


def test_one_blank_cell_and_a_default_threshold_are_told_shortly(
    rows: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A blank cell is one line of warning; the threshold by default is an ordinary line with its key."""
    log = tmp_path / "log.csv"
    blank = ",".join(["" if k == 4 else cell for k, cell in enumerate(rows[7000].split(","))])
    log.write_text("\n".join([*rows[:7000], blank, *rows[7001:]]) + "\n")
    rig = changed()
    del rig["moving_threshold_rad_s"]
    (tmp_path / "rig.json").write_text(json.dumps(rig))
    arguments = ["fit", str(log), "--rig", str(tmp_path / "rig.json"), "--out", str(tmp_path / "out")]
    assert cli.main(arguments) == 0
    shown = capsys.readouterr()
    (dropped,) = shown.err.splitlines()
    assert "log.csv: no number in 1 of 15000 rows (first: line 7001; most: 'current_A')" in dropped
    assert "(default of moving_threshold_rad_s)" in shown.out


def test_a_stretch_of_blank_cells_is_told_before_the_gap_that_it_leaves(
    rows: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """First what is known, rows that are not numbers; then the gap, without a guess at its cause."""
    log = tmp_path / "log.csv"
    blank = [row.rsplit(",", 1)[0] + "," for row in rows[7001:7030]]
    log.write_text("\n".join([*rows[:7001], *blank, *rows[7030:]]) + "\n")
    assert cli.main(["fit", str(log), "--rig", str(RIG), "--out", str(tmp_path / "out")]) == 0
    dropped, gap = capsys.readouterr().err.splitlines()
    assert (
        "no number in 29 of 15000 rows (first: line 7002; most: 'current_A'): such rows are dropped"
        in dropped
    )
    assert gap.endswith(
        "1 gap in time, 0.002 of the log, the longest of 0.12 s after 27.996 s: no filter crosses them"
    )


def test_a_refusal_names_a_few_of_many_runs(
    rows: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of 150 runs one line names the first, and how many more there are or that there are more."""
    columns = {"time": "time_s", "theta_m": "theta_m_rad", "current": "current_A", "run": "run"}
    rig = {k: v for k, v in changed().items() if k != "holdout_intervals_s"} | {"columns": columns}
    log, path = tmp_path / "log.csv", tmp_path / "rig.json"
    runs = [f"{row},bench {k // 100}" for k, row in enumerate(rows[1:])]
    log.write_text("\n".join([f"{rows[0]},run", *runs]) + "\n")
    first = ", ".join(f"bench {k}" for k in range(12))
    for more, message in (
        ({"holdout_runs": ["x*"]}, f"expected one of {first} and 138 more, got 'x*'"),
        ({"moving_threshold_rad_s": 1e4}, "every fifth from the third on: bench 2, bench 7, bench 12,"),
    ):
        path.write_text(json.dumps(rig | more))
        assert message in refused([str(log), "--rig", str(path)], tmp_path, capsys)


LOGS = {
    "missing file": (None, "no such file"),
    "missing column": (lambda rows: ["time_s,current_A", "0,1", "1,2"], "expected column 'theta_m_rad'"),
    "text": (lambda rows: [rows[0], *(row.replace(row.split(",")[1], "fast") for row in rows[1:])], "'fast'"),
    "decimal comma between commas": (
        lambda rows: [rows[0], *(row.replace(".", ",") for row in rows[1:])],
        "expected a decimal point, as in 1.5",
    ),
    "two hundred columns": (
        lambda rows: [",".join(f"signal_{k}" for k in range(200)), *[",".join(["1"] * 200)] * len(rows)],
        f"the log has {', '.join(f'signal_{k}' for k in range(12))} and 188 more",
    ),
    "unknown name in a comment": (lambda rows: ["# nothing", *rows[1:]], "a header row with column names"),
    "empty": (lambda rows: rows[:1], "expected a log with rows"),
    "a third missing": (
        lambda rows: (
            [rows[0]]
            + [r if k % 3 else ",".join(["nan"] * r.count(",") + ["nan"]) for k, r in enumerate(rows[1:])]
        ),
        "at most 20% may be missing",
    ),
}


@pytest.mark.parametrize("name", LOGS)
def test_bad_log_is_one_line(
    name: str, rows: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A log that cannot be: status 2, one line that names file and place, no folder."""
    make, message = LOGS[name]
    log = tmp_path / "log.csv"
    if make:
        log.write_text("\n".join(make(rows[:2001])) + "\n")
    assert message in refused([str(log), "--rig", str(RIG)], tmp_path, capsys)


def refused(arguments: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """Run `fit`, check that it ends with one line and leaves nothing, and return that line."""
    before = set(tmp_path.iterdir())
    assert cli.main(["fit", *arguments, "--out", str(tmp_path / "out")]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.startswith("eccentric: error: ")
    assert shown.err.count("\n") == 1
    assert set(tmp_path.iterdir()) == before
    return shown.err
