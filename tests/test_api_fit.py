"""`eccentric.fit`: one result whatever holds the log, the one of the command, and all that it becomes."""

import dataclasses
import gzip
import json
import pickle
import re
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
from eccentric.model import TURNING, load_model
from eccentric.signals import read_channels
from eccentric.virtual_bench import simulate
from tests.extended import effects
from tests.virtual import drawn_scenario

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
    """Summary and fit.json are those of the function, byte for byte: 15 lines at most, and strict JSON."""
    out = tmp_path / "out"
    assert 0 == cli.main(["fit", str(LOG), "--rig", str(RIG), "--out", str(out)])
    shown, text = capsys.readouterr().out, (out / "fit.json").read_text(encoding="utf-8")
    found = json.loads(text, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))

    assert f"{result.summary()}\n{out}: fit.json, fit.png, fit.svg\n" == shown
    assert len(shown.splitlines()) <= 15
    assert "held-out RMSE [N m]" in shown
    assert result.to_json() == text
    assert {"fit.json", "fit.png", "fit.svg"} == {path.name for path in out.iterdir()} - {".eccentric"}
    assert ["eccentric-fit/1", "c2_parallel", "current", "N m"] == [
        found[key] for key in ("format", "model", "drive", "unit")
    ]
    assert set(LETTERS) == set(found["coefficients"])
    assert {"linear", "paper", "paper_unbounded"} == set(found["rmse_holdout_Nm"])
    assert found["parameters"]["C_m"] == found["coefficients"]["C_m"]["value"]


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

    assert str(error.value).startswith("table: expected column 'i', but the log has time_s, ")


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


def test_what_stands_for_nothing_is_no_parameter(tmp_path: Path) -> None:
    """Fitted by the current: R = 1 and k_e = 0 are in the emitted module, not in the result."""
    rig = json.loads(RIG.read_text(encoding="utf-8"))
    rig["known"] = {name: x for name, x in rig["known"].items() if not name.startswith(("R", "k_e"))}
    rig |= {
        "drive": "current",
        "columns": {"time": "time_s", "theta_m": "theta_m_rad", "current": "current_A"},
    }
    found = eccentric.fit(LOG, rig)
    path = tmp_path / "fit.json"
    path.write_text(found.to_json(), encoding="utf-8")
    (module, *_) = eccentric.emit("c2_parallel", tmp_path / "out", parameters=path, backend="numpy")

    assert {"R": 1.0, "k_e": 0.0} == found.document["placeholders"]
    assert not {"R", "k_e"} & {*found.parameters, *found.document["parameters"]}
    assert {"R", "k_e", *found.parameters} == set(vars(found.module.Parameters()))
    assert (1.0, 0.0) == (found.module.Parameters().R, found.module.Parameters().k_e)
    assert "k_e: float = runtime.nonnegative(0.0," in module.read_text(encoding="utf-8")
    for one in (found, eccentric.diagnose(LOG, rig, only="stribeck")):
        sets = one.samples(2)
        assert set(one.parameters) == set(sets)
        one.module.Parameters(**{name: float(x[0]) for name, x in sets.items()})


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


def test_labels_of_the_figure_overlap_neither_each_other_nor_another_axes(result: FitResult) -> None:
    """On a figure of somebody's own, without a layout and half as wide as that of the file."""
    figure, given = plt.subplots(1, 2)
    result.plot(given)
    figure.canvas.draw()
    for axes in given:
        legend = axes.get_legend().get_window_extent()
        assert axes.get_window_extent().containsx(legend.x0)
        assert axes.get_window_extent().containsx(legend.x1)
        assert axes.get_window_extent().containsy(legend.y1)
    assert figure.get_suptitle() == ""
    assert "held-out rows" in given[0].get_title(loc="left")
    plt.close("all")


def with_coulomb_first(model: Model) -> Model:
    """A turning drive with the friction of the model of a carriage, its terms in the other order."""
    mechanical, *others = model.balances
    terms = sorted(mechanical.terms, key=lambda term: term.name != "coulomb")
    balances = (dataclasses.replace(mechanical, terms=tuple(terms)), *others)
    return dataclasses.replace(model, name="plain", axis=TURNING, balances=balances)


@pytest.mark.parametrize("called", ["Coulomb + viscous", "plain"])
def test_coulomb_and_viscous_friction_is_not_compared_with_itself(called: str) -> None:
    """Neither a bundled model without a mass nor a derivation of somebody's own, in whatever order."""
    run = simulate(drawn_scenario(3, case="C1"))
    rig = run.rig | {"known": run.rig["known"] | {"M_kg": 0.0}}
    model = with_coulomb_first(load_model("linear_axis")) if called == "plain" else None
    found = eccentric.fit(run.columns, rig, model)
    (line,) = (line for line in found.lines if line.startswith("held-out RMSE"))
    errors = f"{re.escape(called)} [0-9.]+"

    assert re.fullmatch(rf"held-out RMSE \[N m\]: {errors}; R\^2 of the drive torque: {errors}", line)
    assert "The model, Coulomb + viscous friction, leaves" in found.sentence
    assert [called] == [text.get_text().split("\n")[0] for text in found.plot()[0].get_legend().get_texts()]
    plt.close("all")


def test_without_matplotlib_the_figure_alone_is_missing(
    result: FitResult,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """One line says what to install; the command writes everything else."""
    for name in [name for name in sys.modules if name.startswith("matplotlib")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    out, why = tmp_path / "out", "matplotlib is required for the figure"

    with pytest.raises(InputError, match=why):
        result.plot()
    assert 0 == cli.main(["fit", str(LOG), "--rig", str(RIG), "--out", str(out)])
    assert f"no figure: {why} (extra `figures`): pip install matplotlib" in capsys.readouterr().out
    assert {"fit.json"} == {path.name for path in out.iterdir()} - {".eccentric"}


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


# `eccentric fit`: a whole folder and a short table, or one line and nothing.


@pytest.fixture(scope="module")
def rows() -> list[str]:
    """Header and rows of the bundled log."""
    return gzip.decompress(LOG.read_bytes()).decode().splitlines()


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
    required = "--accept-misfit: needed to use fit.json, since its log does not fit the rig"
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
        "1 gap in time, 0.002 of the log, the longest 0.12 s after 27.996 s: sections are filtered separately"
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
    "unknown name in a comment": (lambda rows: ["# nothing", *rows[1:]], "the log has column_1, column_2"),
    "empty": (lambda rows: rows[:1], "expected a log with rows"),
    "a third missing": (
        lambda rows: (
            [rows[0]]
            + [r if k % 3 else ",".join(["nan"] * r.count(",") + ["nan"]) for k, r in enumerate(rows[1:])]
        ),
        "at most 20 % may be missing",
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
