"""What a person asks of a diagnosis: effects to begin with, effects left out, nothing but a few families."""

import json
import math
import re
from pathlib import Path
from typing import Any

import pytest

import eccentric
from eccentric.cli import main
from eccentric.cli.arguments import names_in
from tests.virtual import log_of

ROOT = Path(__file__).resolve().parent.parent
LOG, RIG = (str(ROOT / "examples" / "bench" / name) for name in ("bench.csv.gz", "bench.json"))
PLANTED = "link_harmonic_friction[n=2]"
"""The effect of the bundled log."""


@pytest.fixture(scope="module")
def without() -> eccentric.DiagnosisResult:
    """The bundled log, searched without the family that it was made with."""
    return eccentric.diagnose(LOG, RIG, without="link_harmonic_friction")


@pytest.fixture(scope="module")
def including(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any], str]:
    """The folder, the JSON and the report of the bundled log, diagnosed with its effect from the start."""
    out = tmp_path_factory.mktemp("with") / "out"
    asked = ["--with", PLANTED, "--without", "cogging,backlash"]
    assert 0 == main(["diagnose", LOG, "--rig", RIG, *asked, "--out", str(out)])
    return (
        out,
        json.loads((out / "diagnosis.json").read_text(encoding="utf-8")),
        (out / "report.html").read_text(encoding="utf-8"),
    )


@pytest.mark.slow
def test_an_effect_left_out_is_not_offered(without: eccentric.DiagnosisResult) -> None:
    """No candidate is of that family, and what it would explain stays unexplained."""
    assert "link_harmonic_friction" not in {c["family"] for c in without.document["candidates"]}
    assert ("unexplained", "link_angle") == (without.verdict, without.depends_on[0])


@pytest.mark.slow
def test_the_best_effect_is_shown_with_its_gain_where_none_is_named(
    without: eccentric.DiagnosisResult,
) -> None:
    """A tight spot imitates a part of two waves per turn: more than a tenth, and less than all."""
    best = without.document["closest_effect"]
    errors, gain = best["rmse_holdout_Nm"], best["improvement"]

    assert errors["paper"] == without.rmse["mechanical"]["paper"]
    assert gain["percent"] == pytest.approx(100.0 * (1.0 - errors["extended"] / errors["paper"]))
    assert 10.0 < gain["percent"] < 70.0
    assert gain["interval_95"][0] < gain["percent"] < gain["interval_95"][1]
    (line,) = [line for line in without.lines if line.startswith("Best candidate: ")]
    assert f"({best['id']}), with {gain['percent']:.1f} % lower held-out error" in line
    assert line.endswith("; it explains only part of the residual.")
    assert without.data.conclusion.closest.startswith(line)


@pytest.mark.slow
def test_with_the_effect_from_the_start_nothing_is_missing(
    including: tuple[Path, dict[str, Any], str],
) -> None:
    """The base model then predicts as well as the sensors allow, and the file says what was asked."""
    _, said, page = including
    error = said["rmse_holdout_Nm"]["mechanical"]["paper"]

    assert ("nothing_missing", []) == (said["verdict"], said["effects"])
    assert error < 1.05 * said["noise_floor_Nm"]
    asked = {"with": [PLANTED], "without": ["cogging", "backlash"], "only": [], "empirical": False}
    assert asked == said["asked"]
    assert f"with {PLANTED}; without cogging, backlash" in page


@pytest.mark.slow
def test_the_script_of_a_model_with_an_effect_from_the_start_runs(
    including: tuple[Path, dict[str, Any], str],
) -> None:
    """model.py loads base.py beside it, and has the amplitude that the truth has, within 5 %."""
    truth = json.loads((ROOT / "examples" / "bench" / "bench.truth.json").read_text(encoding="utf-8"))
    model = eccentric.load_model(str(including[0] / "model.py"))
    own = {q.name: float(q.default or 0) for q in model.parameters if q.name.startswith("link_harmonic")}

    assert math.hypot(*own.values()) == pytest.approx(truth["effects"][0]["amplitude"], rel=0.05)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (["--with", "link_harmonic"], "--with: .*did you mean link_harmonic_friction.*there are stribeck, "),
        (["--without", "stribeck[d=7]"], "--without: .*of stribeck there are stribeck"),
        (["--only", "viscosity_temperature"], "--only: expected .*this log can show, .*it can show stribeck"),
        (["--with", "stribeck,stribeck"], "--with: .*only once, got stribeck twice"),
        (["--with", "presliding"], "--with presliding: .*without hidden states"),
    ],
    ids=["unknown", "variant", "not in this log", "twice", "hidden state"],
)
def test_a_name_that_cannot_be_served_is_refused_in_one_line(
    asked: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The option and what there is; nothing is written."""
    status = main(["diagnose", LOG, "--rig", RIG, *asked, "--out", str(tmp_path / "out")])
    said = capsys.readouterr().err

    assert (2, 1, False) == (status, said.count("\n"), (tmp_path / "out").exists())
    assert re.search(message, said)


ASYMMETRIC = ["viscous_asymmetry", "coulomb_asymmetry", "oneway_windage", "current_bias", "gravity_tilt"]


@pytest.mark.parametrize(
    "asked",
    [{"only": "stribeck"}, pytest.param({"without": ASYMMETRIC}, marks=pytest.mark.slow)],
    ids=["only", "without"],
)
def test_a_shipped_model_that_predicts_better_as_it_stands_is_named(
    tmp_path: Path, asked: dict[str, Any]
) -> None:
    """Friction of another size per direction: with the effects of it left out, the asymmetric model is."""
    log, rig = log_of(tmp_path, 4, ("viscous_asymmetry", 0.3))
    found = eccentric.diagnose(log, rig, **asked)
    better, families = found.document["better_model"], {c["family"] for c in found.document["candidates"]}
    rmse = eccentric.compare(log, rig, "c2_asymmetric").rmse["mechanical"]["c2_asymmetric"]

    assert {"stribeck"} == families if "only" in asked else families.isdisjoint(ASYMMETRIC)
    assert "c2_asymmetric" == better["model"]
    assert better["improvement"]["interval_95"][0] > 0.0
    assert better["rmse_holdout_Nm"] == pytest.approx(rmse, rel=1e-6)
    assert any(line.startswith("c2_asymmetric as shipped has") for line in found.lines)


def test_a_comma_inside_brackets_does_not_separate_names() -> None:
    """Ids may contain one."""
    assert ["a", "b[x=1, y]", "c"] == names_in(["a,b[x=1, y]", " c ", ""])
