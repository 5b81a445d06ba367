"""What `eccentric diagnose` writes of a diagnosis: its record, the report, the model's script, checked C."""

import ast
import re
import shlex
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eccentric.cli import diagnose as command
from eccentric.cli import main
from eccentric.diagnosis import Diagnosis, diagnose, script
from eccentric.logs import read_log
from eccentric.presentation.html import report_data
from eccentric.presentation.html.gather import facts_of
from eccentric.presentation.html.panels import leading_panel
from eccentric.presentation.html.pictures import drive_picture
from eccentric.rigs import read_rig
from eccentric.virtual_bench import simulate
from tests.page_reader import Reader
from tests.virtual import drawn_scenario

ROOT = Path(__file__).resolve().parent.parent
LOG, RIG = ROOT / "examples" / "bench" / "bench.csv.gz", ROOT / "examples" / "bench" / "bench.json"


@pytest.fixture(scope="module")
def found(bundled: tuple[Diagnosis, Path]) -> Diagnosis:
    """The diagnosis of the bundled log."""
    return bundled[0]


@pytest.fixture(scope="module")
def out(bundled: tuple[Diagnosis, Path]) -> Path:
    """The folder that the command writes."""
    return bundled[1]


@pytest.mark.parametrize("real", ["float", "double"])
def test_the_extended_model_comes_with_its_check(out: Path, real: str, tmp_path: Path) -> None:
    """Self-test and proof driver lie beside the C: the test passes, and the report names each file."""
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    name = "c2_parallel_extended"

    sources = [out / f"{name}.c", out / "check" / f"{name}_selftest.c"]
    flags = ["-std=c99", f"-DECCENTRIC_REAL={real}", f"-I{out}", "-o", tmp_path / "test"]
    subprocess.run(["gcc", *flags, *sources, "-lm"], check=True)
    subprocess.run([tmp_path / "test"], check=True, capture_output=True)
    text = Reader((out / "report.html").read_text(encoding="utf-8")).text
    written = {path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file()}
    assert f"check/{name}_proof.c" in written
    assert [file for file in written - {"report.html", ".eccentric"} if file not in text] == []


def test_no_name_of_a_log_is_run(found: Diagnosis) -> None:
    """What a log is called stays text in model.py, which is loaded as soon as it is written."""
    hostile = 'a\\""" + str(print(1)) + """.csv'

    before, after = (
        ast.parse(script(replace(found, asked=replace(found.asked, logs=(name,)))))
        for name in ("a.csv", hostile)
    )

    assert [ast.dump(node) for node in before.body[1:]] == [ast.dump(node) for node in after.body[1:]]
    assert "print(1)" in (ast.get_docstring(after) or "")


def test_the_first_picture_is_below_the_low_pass_over_a_period_of_the_effect(found: Diagnosis) -> None:
    """Held-out errors there are those of the score; fitted rows have passed the low pass already."""
    data, score = report_data(found), found.score.below
    balance, (effect,) = data.errors.balances[0], data.extended.effects
    below = balance.below
    assert score is not None
    assert below.extended is not None
    held, train = balance.rows.held_out, balance.rows.train
    errors = [float(np.sqrt(np.mean(x[held] ** 2))) for x in (below.paper, below.extended)]

    assert errors == pytest.approx([score.before, score.after], rel=1e-12)
    assert np.array_equal(below.paper[train], balance.paper[train])
    assert [("link_angle", 2 * np.pi), ("link_angle", pytest.approx(np.pi))] == [
        (c.key, c.period) for c in effect.follows
    ]


@pytest.mark.slow
def test_a_ripple_that_most_rows_are_too_slow_for_shows_over_its_period() -> None:
    """Row by row the extended model adds error at high speed; the first pictures show what it explains."""
    run = simulate(drawn_scenario(5, effects=(("kt_ripple[n=6]", 0.3),), mu=1.0 / 30.0, seconds=40.0))
    data = report_data(diagnose([read_log(run.columns)], read_rig(run.rig)))
    (first,) = (b for b in data.errors.balances if b.name == data.extended.effects[0].balance)
    panel = leading_panel(first.below, data.extended.effects[0].follows)
    drive = drive_picture(next(b for b in data.errors.balances if b.drive is not None))
    assert panel is not None
    assert drive is not None
    before, after = map(float, re.findall(r"([0-9.]+) A \(", drive.caption))

    assert panel.channel.period == pytest.approx(2 * np.pi / 6)
    assert panel.curves["after"].swing < 0.3 * panel.curves["before"].swing
    assert after < 0.3 * before


def test_the_record_says_what_the_diagnosis_found(found: Diagnosis) -> None:
    """Errors follow from the residuals of the held-out rows; parameters are those of the fit."""
    data = report_data(found)
    mechanical = data.errors.balances[0]
    assert mechanical.extended is not None
    held = mechanical.rows.held_out
    rmse = {
        name: float(np.sqrt(np.mean(np.asarray(x)[held] ** 2)))
        for name, x in (
            ("linear", mechanical.linear), ("paper", mechanical.paper), ("extended", mechanical.extended)
        )
    }  # fmt: skip
    fitted = {p.name: p.value for p in data.extended.parameters if p.origin in {"effect", "friction"}}

    assert pytest.approx(dict(mechanical.rmse), rel=1e-9) == rmse
    assert {name: e.value for name, e in found.models.extended.estimates.items()}.items() >= fitted.items()
    assert {
        "velocity",
        "link_angle",
        "motor_angle",
        "acceleration",
        "gravity_load",
        "current",
        "voltage",
        "time",
    } == {channel.key for channel in mechanical.rows.channels}
    assert shlex.split(data.source.command)[:4] == ["eccentric", "diagnose", "bench.csv.gz", "--rig"]


def test_the_report_says_where_a_zero_angle_is_from(found: Diagnosis) -> None:
    """A 0 of the rig file is not that of a rig file without one."""
    for keys, origin in (({"theta_zero_rad"}, "from the rig file"), ((), "by default")):
        channels = replace(found.channels, rig=replace(found.rig, aligned=frozenset(keys)))
        drive = replace(found.data.drive, channels=channels)
        facts = facts_of(replace(found, data=replace(found.data, drive=drive)))
        zero = next(fact for fact in facts if fact.name == "zero angle")
        assert ("0 rad", origin) == (zero.value, zero.remark)


def test_open_opens_the_report(
    found: Diagnosis, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """`--open` hands the written file to the browser; without a browser it says so and ends well."""
    opened: list[str] = []
    report = tmp_path / "out" / "report.html"
    monkeypatch.setattr("eccentric.api.diagnosed.diagnose_logs", lambda *_: found)
    monkeypatch.setattr("eccentric.api.diagnosed.DiagnosisResult.write", lambda *_: [report])
    monkeypatch.setattr(command.webbrowser, "open", lambda address: not opened.append(address))
    arguments = ["diagnose", str(LOG), "--rig", str(RIG), "--out", str(report.parent)]
    assert 0 == main(arguments)
    assert [] == opened
    assert 0 == main([*arguments, "--open"])
    assert [report.as_uri()] == opened

    monkeypatch.setattr(command.webbrowser, "open", lambda address: False)
    capsys.readouterr()
    assert 0 == main([*arguments, "--open"])
    assert "no browser could be opened" in capsys.readouterr().err
