"""Models compared on the same rows: the planted one wins, and every figure is what the commands say alone."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.patches import Rectangle

import eccentric
from eccentric.cli import main
from eccentric.diagnosis.stage import stage_of
from eccentric.identification import refit
from eccentric.signals import read_channels
from eccentric.virtual_bench import simulate
from tests.virtual import drawn_scenario

ROOT = Path(__file__).resolve().parent.parent
LOG, RIG = (str(ROOT / "examples" / "bench" / name) for name in ("bench.csv.gz", "bench.json"))
BASELINE, PLANTED = "Coulomb + viscous", "c2_parallel+link_harmonic_friction"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a comparison of the bundled log."""
    out = tmp_path_factory.mktemp("compare") / "out"
    models = ["c2_parallel", PLANTED, "c2_asymmetric", "c2_parallel+presliding"]
    assert 0 == main(["compare", LOG, "--rig", RIG, *models, "--out", str(out)])
    return out


@pytest.fixture(scope="module")
def said(folder: Path) -> dict[str, Any]:
    """Its models by name."""
    found = json.loads((folder / "compare.json").read_text(encoding="utf-8"))
    return {one["name"]: one for one in found["models"]}


def test_the_model_that_the_log_was_made_with_is_the_best(said: dict[str, Any]) -> None:
    """Its error is that of the sensors, and the entries are in the order of their errors.

    The harmonic of the truth is found among its family.
    """
    errors = [one["rmse_holdout_Nm"] for one in said.values()]

    assert PLANTED == next(iter(said))
    assert ["link_harmonic_friction[n=2]"] == said[PLANTED]["effects"]
    assert sorted(errors) == errors
    assert errors[0] == pytest.approx(0.0063, rel=0.02)


def test_errors_are_those_of_a_fit(said: dict[str, Any]) -> None:
    """The paper's model and Coulomb + viscous friction have the errors and R^2 that `eccentric fit` gives."""
    found = eccentric.fit(LOG, RIG)

    for name, own in (("c2_parallel", "paper"), (BASELINE, "linear")):
        assert said[name]["rmse_holdout_Nm"] == pytest.approx(found.rmse["mechanical"][own], rel=1e-6)
        assert said[name]["r_squared_holdout"] == pytest.approx(found.r_squared[own], abs=1e-4)
    # The fit has all rows as they are, the contest its training rows after the low pass: edges differ.
    below = said["c2_parallel"]["rmse_below_low_pass_Nm"]
    assert below == pytest.approx(found.document["error_band"]["below"], rel=0.02)
    assert said["c2_parallel"]["improvement"]["percent"] == pytest.approx(found.improvement, rel=1e-6)


def test_one_model_has_one_error_in_every_command() -> None:
    """Fit, diagnose and compare print the same held-out error, also where a bound holds a coefficient."""
    log, rig = (str(ROOT / "examples" / "tutorial" / name) for name in ("arm.csv.gz", "arm.toml"))
    fitted = eccentric.fit(log, rig)
    diagnosed = eccentric.diagnose(log, rig, only="stribeck").rmse["mechanical"]
    compared = eccentric.compare(log, rig, "c2_parallel").document["models"]

    assert any(e.bound_active for e in fitted.estimates.values())
    assert fitted.rmse["mechanical"]["paper"] == pytest.approx(diagnosed["paper"], rel=1e-9)
    assert fitted.rmse["mechanical"]["linear"] == pytest.approx(diagnosed["linear"], rel=1e-9)
    assert [fitted.rmse["mechanical"]["paper"], fitted.rmse["mechanical"]["linear"]] == pytest.approx(
        [one["rmse_holdout_Nm"] for one in compared], rel=1e-9
    )


def test_an_asymmetric_model_has_the_same_baseline(said: dict[str, Any]) -> None:
    """A gain is over Coulomb + viscous friction of two coefficients, whatever the model."""
    base = said[BASELINE]

    assert 2 == base["parameters"]
    for one in said.values():
        ratio = one["rmse_holdout_Nm"] / base["rmse_holdout_Nm"]
        assert one["improvement"]["percent"] == pytest.approx(100.0 * (1.0 - ratio), abs=1e-9)


def test_coulomb_and_viscous_friction_is_the_same_model_in_every_command() -> None:
    """Beside an asymmetric model, too, it has two coefficients and the same held-out error."""
    plain, asymmetric = (
        eccentric.fit(LOG, RIG, name).rmse["mechanical"] for name in ("c2_parallel", "c2_asymmetric")
    )
    channels = read_channels([eccentric.read_log(LOG)], eccentric.read_rig(RIG))
    stage = stage_of(channels, eccentric.load_model("c2_asymmetric"), None, "log")
    linear = refit(stage.base, (), stage.data, linear=True)

    assert 2 == len(linear.estimates)
    assert plain["linear"] == pytest.approx(linear.held_out("mechanical"), rel=1e-9)
    assert plain["linear"] == pytest.approx(asymmetric["linear"], rel=1e-9)
    assert asymmetric["paper"] < plain["paper"]


def test_the_figure_has_a_bar_for_each_model(folder: Path) -> None:
    """As long as the errors of the table, and the files are written; the best member stands for a family."""
    found = eccentric.compare(LOG, RIG, ["c2_parallel", PLANTED])
    assert "(link_harmonic_friction[n=2])" in found.summary()
    assert max(map(len, found.summary().splitlines())) <= 80
    lengths = [bar.get_width() for bar in found.plot().patches if isinstance(bar, Rectangle)]

    assert np.allclose(list(found.rmse["mechanical"].values()), lengths)
    assert {"compare.json", "compare.png", "compare.svg"} == {path.name for path in folder.glob("compare.*")}


@pytest.mark.parametrize(
    ("models", "words"),
    [
        (["c3"], "model 'c3' is unknown"),
        (["c2_parallel", "c2_parallel"], "only once, got c2_parallel twice"),
        (["c2_parallel+stribek"], "did you mean stribeck?"),
        (["c1_perpendicular"], "requires case C1"),
    ],
    ids=["model", "twice", "effect", "case"],
)
def test_what_cannot_be_compared_is_refused_in_one_line(
    models: list[str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """The name and the reason."""
    status = main(["compare", LOG, "--rig", RIG, *models])
    error = capsys.readouterr().err

    assert (2, 1) == (status, error.count("\n"))
    assert words in error


def test_an_effect_of_both_balances_is_compared_by_what_it_does_to_the_drive() -> None:
    """A bias of the current sensor adds a constant torque, as friction that differs by direction does."""
    run = simulate(drawn_scenario(5, effects=(("current_bias", 0.2),), case="C2", mu=0.2, seconds=40.0))
    found = eccentric.compare(
        run.columns, run.rig, ["c2_parallel", "c2_parallel+current_bias", "c2_parallel+coulomb_asymmetry"]
    )
    plain, bias, alias = (
        next(e for e in found.contest.entries if e.name.endswith(own))
        for own in ("parallel", "bias", "asymmetry")
    )

    assert bias.rmse < 0.9 * plain.rmse
    assert bias.rmse == pytest.approx(alias.rmse, rel=0.01)


@pytest.mark.slow
def test_an_effect_of_the_circuit_alone_is_compared_by_the_error_of_the_circuit() -> None:
    """The dead time of the inverter leaves the drive's error as it is; the circuit is the better for it."""
    run = simulate(drawn_scenario(5, effects=(("inverter_deadtime", 0.2),), case="C2", mu=0.2, seconds=40.0))
    names = "c2_parallel+inverter_deadtime", "c2_parallel"
    found = eccentric.compare(run.columns, run.rig, [*reversed(names)])
    own, plain = found.contest.entries[:2]
    noise = eccentric.diagnose(run.columns, run.rig).rmse["electrical"]["extended"]

    assert names == (own.name, plain.name)
    assert own.rmse == pytest.approx(plain.rmse, rel=1e-9)
    assert own.circuit is not None
    assert plain.circuit is not None
    assert own.circuit < 0.8 * plain.circuit
    assert own.circuit == pytest.approx(noise, rel=0.01)
    assert f"{own.circuit:.4g}" in found.summary()
    assert "is the best" not in found.summary()


def test_a_ripple_that_is_the_best_below_the_low_pass_only_is_told() -> None:
    """Row by row the model of a fast ripple adds error: the order of the table says the opposite."""
    effects = (("kt_ripple", 0.5),)
    run = simulate(drawn_scenario(5, effects=effects, case="C2", mu=1 / 30, seconds=40.0))
    (effect,) = run.truth["effects"]
    ripple = f"c2_parallel+kt_ripple[n={effect['shape'][0]:.0f}]"
    found = eccentric.compare(run.columns, run.rig, ["c2_parallel", ripple])
    first, *others = found.contest.entries
    other = next(e for e in others if e.name == ripple)

    assert first.below is not None
    assert other.below is not None
    assert other.below < first.below
    assert f"below 25 Hz {ripple} is the best" in found.summary()
