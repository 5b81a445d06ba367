"""`eccentric.fit`: one result whatever holds the log, the one of the command, and all that it becomes."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from matplotlib import pyplot as plt
from matplotlib.axes import Axes

import eccentric
from eccentric import FitResult, InputError, Log, Model, cli
from eccentric.effects import constant_load
from eccentric.signals import read_channels
from tests.extended import effects

BENCH = Path(__file__).parents[1] / "examples" / "bench"
LOG, RIG = BENCH / "bench.csv.gz", BENCH / "bench.json"
LETTERS = ("B_lN", "C_lN", "B_m", "C_m")


@pytest.fixture(scope="module")
def log() -> Log:
    """The bundled log."""
    return eccentric.read_log(LOG)


@pytest.fixture(scope="module")
def result() -> FitResult:
    """Its fit."""
    return eccentric.fit(LOG, RIG)


def columns(log: Log) -> dict[str, Any]:
    """The columns of a log as a dict of arrays."""
    return {name: np.array(values) for name, values in log.columns.items()}


def content(result: FitResult) -> dict[str, Any]:
    """The document, without the names of logs and rig."""
    return {key: value for key, value in result.to_dict().items() if key not in {"logs", "rig"}}


def test_the_command_prints_and_writes_the_same(
    result: FitResult, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Summary and fit.json of the command are those of the function, byte for byte."""
    out = tmp_path / "out"
    assert 0 == cli.main(["fit", str(LOG), "--rig", str(RIG), "--out", str(out)])

    assert f"{result.summary()}\n{out}: fit.json, fit.png, fit.svg\n" == capsys.readouterr().out
    assert result.to_json() == (out / "fit.json").read_text(encoding="utf-8")


@pytest.mark.parametrize("kind", ["dict of arrays", "Arrow"])
def test_a_table_in_memory_is_fitted_as_its_file(kind: str, result: FitResult, log: Log) -> None:
    """The same rows from memory, under a rig given as a mapping, give the same figures to the last bit."""
    table = columns(log) if kind == "dict of arrays" else pa.table(columns(log))
    rig = json.loads(RIG.read_text(encoding="utf-8"))

    again = eccentric.fit(table, rig)

    assert content(result) == content(again)
    assert again.lines[0].startswith("table: c2_parallel, driven by current; ")


def test_several_logs_are_one_fit(log: Log) -> None:
    """Two halves of a log as two tables are two runs, each under its name."""
    half = log.rows // 2
    halves = [{n: x[:half] for n, x in columns(log).items()}, {n: x[half:] for n, x in columns(log).items()}]

    found = eccentric.fit(halves, RIG)

    assert ["table 1", "table 2"] == found.document["logs"]
    assert log.rows == found.document["rows"]["read"]


def test_a_log_that_comes_twice_is_refused(log: Log) -> None:
    """Rows that count twice would make errors look smaller than they are."""
    for logs, name in (([LOG, str(LOG)], str(LOG)), ([log, log], "table 2")):
        with pytest.raises(InputError, match="expected each log only once, got it twice") as error:
            eccentric.fit(logs, RIG)
        assert str(error.value).startswith(name)


def test_a_column_that_is_missing_is_named(log: Log) -> None:
    """What the rig maps and the table has not is one line with both names."""
    table = columns(log)
    rig = {**json.loads(RIG.read_text()), "columns": {"time": "time_s", "theta_m": "angle", "current": "i"}}
    table["angle"] = table.pop("theta_m_rad")

    with pytest.raises(InputError) as error:
        eccentric.fit(table, rig)

    assert str(error.value).startswith("table: expected column 'i', the log has time_s, ")


def test_a_column_of_text_is_named_with_its_row(log: Log) -> None:
    """A number is required where the rig maps a number."""
    table = columns(log)
    texts = table["current_A"].astype("<U24")
    texts[: len(texts) // 3] = "fast"
    table["current_A"] = texts

    with pytest.raises(InputError) as error:
        eccentric.fit(table, RIG)

    assert "table: row 1, column 'current_A': expected a number, got 'fast'" == str(error.value)


def test_estimates_are_named_with_unit_and_interval(result: FitResult) -> None:
    """The table has a row for each estimate, its numbers those of fit.json."""
    table, written = result.table(), result.to_dict()["coefficients"]

    assert list(LETTERS) == table["name"] == list(result.estimates)
    for row in table:
        entry = written[row["name"]]
        assert (entry["value"], entry["unit"]) == (row["value"], row["unit"])
        assert entry["interval_95"] == [row["lower"], row["upper"]]
        assert entry["std_error"] == row["std_error"]


def test_the_correlation_is_that_of_least_squares(result: FitResult) -> None:
    """Its axes are the coefficients; it is about that of the normal equations, which take noise for white."""
    channels = read_channels([LOG], eccentric.read_rig(RIG))
    rows = channels.selection.fit_rows
    design = result.module.regressor(channels.motion.theta_m[rows], channels.motion.omega_m[rows])
    covariance = np.linalg.inv(design.T @ design)
    error = np.sqrt(np.diag(covariance))
    expected = covariance / np.outer(error, error)

    assert LETTERS == result.correlation.names
    np.testing.assert_allclose(expected, result.correlation.matrix, atol=0.2)
    np.testing.assert_allclose(1.0, np.diag(result.correlation.matrix), rtol=1e-12)
    assert result.correlation["B_lN", "C_lN"] < -0.5 < 0.5 < result.correlation["B_lN", "C_m"]


def test_the_fitted_model_predicts_the_reported_error(result: FitResult) -> None:
    """The residual of the fitted module on the held-out rows has the RMSE that the result names."""
    channels = read_channels([LOG], eccentric.read_rig(RIG))
    rows = channels.selection.score_rows
    assert channels.motor.current is not None
    signals = (
        channels.motion.theta_m,
        channels.motion.omega_m,
        channels.motor.current,
        channels.motion.alpha_m,
    )
    residual = result.module.mechanical_residual(*(x[rows] for x in signals))

    assert result.rmse["mechanical"]["paper"] == pytest.approx(np.sqrt(np.mean(residual**2)), rel=1e-9)
    assert result.parameters["C_m"] == result.module.Parameters().C_m == result.estimates["C_m"].value


def test_json_goes_round(result: FitResult, tmp_path: Path) -> None:
    """What was written as JSON emits the same files as the result itself."""
    path = tmp_path / "fit.json"
    path.write_text(result.to_json(), encoding="utf-8")
    mine = result.emit(tmp_path / "mine", prefix="arm", compensation=True)
    for kind, parameters in (("path", path), ("content", json.loads(path.read_text())), ("result", result)):
        theirs = eccentric.emit(
            "c2_parallel", tmp_path / kind, parameters=parameters, prefix="arm", compensation=True
        )
        assert [p.read_bytes() for p in mine] == [p.read_bytes() for p in theirs]
    assert result.to_dict() == json.loads(result.to_json())


def test_it_is_drawn_on_two_axes_or_on_one(result: FitResult) -> None:
    """A new figure, or axes that are given; the held-out rows are on all of them."""
    left, right = result.plot()
    _, given = plt.subplots(1, 2)
    _, one = plt.subplots()

    assert isinstance(left, Axes)
    assert list(given) == list(result.plot(given))
    assert one is result.plot(ax=one)
    assert result.comparison.measured.shape == np.shape(one.lines[0].get_ydata())
    for axes in (left, right, *given):
        assert result.comparison.speed.shape == np.shape(axes.lines[0].get_xdata())
    assert "motor velocity [rad/s]" == right.get_xlabel() == given[1].get_xlabel()
    plt.close("all")


def test_a_plot_without_matplotlib_says_what_to_install(
    result: FitResult, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """One line for `plot`; `write` leaves the figures out."""
    for name in [name for name in sys.modules if name.startswith("matplotlib")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "matplotlib", None)

    with pytest.raises(InputError, match="matplotlib is required for the figure"):
        result.plot()
    assert [tmp_path / "out" / "fit.json"] == result.write(tmp_path / "out")


def test_a_notebook_shows_the_table_and_the_sentence(result: FitResult) -> None:
    """Its HTML has a row for each estimate, between head and sentence."""
    page = result._repr_html_()

    assert page.count("<tr>") == 1 + len(LETTERS)
    assert page.index("bench.csv.gz: c2_parallel") < page.index("<table>") < page.index("held-out error than")


def test_it_goes_to_another_process_and_back(result: FitResult, tmp_path: Path) -> None:
    """A process that never saw the log unpickles the result, and its model gives the same torque."""
    (tmp_path / "fit.pickle").write_bytes(pickle.dumps(result))
    program = (
        "import pickle, sys; found = pickle.load(open(sys.argv[1], 'rb'));"
        "print(found); print(repr(float(found.module.mechanical_friction_torque(0.5, 20.0))))"
    )
    command = [sys.executable, "-c", program, str(tmp_path / "fit.pickle")]
    shown = subprocess.run(command, capture_output=True, text=True, check=True).stdout

    torque = float(result.module.mechanical_friction_torque(0.5, 20.0))
    assert f"{result.summary()}\n{torque!r}\n" == shown


def test_a_model_may_be_given_in_every_form(result: FitResult, log: Log) -> None:
    """By its name and as a Model: the fit is the one by default."""
    for model in ("c2_parallel", eccentric.load_model("c2_parallel")):
        assert content(result) == content(eccentric.fit(log, RIG, model))


def with_effect(family: str, **values: float) -> Model:
    """The model of case C2 with an effect of the library."""
    effect = next(effect for name, effect in effects("C2").items() if name.startswith(family))
    return effect.extend(eccentric.load_model("c2_parallel"), values)


def test_what_is_not_fitted_of_an_effect_keeps_its_value() -> None:
    """The Stribeck velocity of the model stays its own, in the result and in the emitted code."""
    found = eccentric.fit(LOG, RIG, with_effect("stribeck[d=1]", stribeck_v=3.25))

    assert 3.25 == found.parameters["stribeck_v"] == found.module.Parameters().stribeck_v
    assert "the model's own, not fitted" == found.document["parameter_notes"]["stribeck_v"]


def test_effects_are_no_part_of_the_linear_model(result: FitResult) -> None:
    """Against Coulomb and viscous friction a model with an effect is measured as the paper's is."""
    found = eccentric.fit(LOG, RIG, with_effect("link_harmonic_friction"))

    assert result.rmse["mechanical"]["linear"] == pytest.approx(found.rmse["mechanical"]["linear"], rel=1e-9)


def test_a_constant_load_in_the_model_is_that_of_the_rig(result: FitResult) -> None:
    """A model that has T_load is fitted as one that has none: what the rig declares counts, and once."""
    declared = json.loads(RIG.read_text(encoding="utf-8"))
    declared["known"] |= {"T_load": "0.05 N m"}
    model = constant_load.extend(eccentric.load_model("c2_parallel"), {"T_load": 0.3})

    plain, loaded = (eccentric.fit(LOG, declared, one) for one in (None, model))

    assert plain.rmse["mechanical"] == pytest.approx(loaded.rmse["mechanical"])
    assert plain.rmse["mechanical"]["paper"] > 1.01 * result.rmse["mechanical"]["paper"]
    assert 0.05 == loaded.parameters["T_load"]


@pytest.mark.parametrize(
    ("family", "received"),
    [("presliding", "presliding_z"), ("kt_saturation", "i"), ("coulomb_temperature", "temperature")],
)
def test_friction_that_no_log_of_this_kind_shows_is_refused(family: str, received: str) -> None:
    """One line says which input the fit cannot provide."""
    with pytest.raises(InputError, match=f"fit requires .*, got some that depend on .*{received}"):
        eccentric.fit(LOG, RIG, with_effect(family))


def test_an_alignment_that_the_rig_gives_is_not_estimated(result: FitResult) -> None:
    """Delay, zero angle and offset of a rig that leaves none of them open are those of the rig, 0 here."""
    given = {"value": 0.0, "estimated": False}

    assert (
        dict.fromkeys(("input_delay_s", "theta_zero_rad", "voltage_offset_V"), given)
        == (result.document["alignment"])
    )
