"""`eccentric.diagnose`: the command's result as an object, with the extended model alive in it."""

import json
import pickle
import shutil
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot as plt

import eccentric
from eccentric import DiagnosisResult, InputError, Model
from eccentric.api import diagnosed
from eccentric.diagnosis import Diagnosis
from eccentric.effects import Setting, library
from eccentric.emission import complete, load_module
from eccentric.model import with_values
from eccentric.virtual_bench import simulate
from generated import c2_parallel
from tests.extended import effects
from tests.virtual import drawn_scenario

BENCH = Path(__file__).parents[1] / "examples" / "bench"
LOG, RIG = BENCH / "bench.csv.gz", BENCH / "bench.json"


@pytest.fixture(scope="module")
def stages() -> list[str]:
    """What the diagnosis said while it ran."""
    return []


@pytest.fixture(scope="module")
def result(stages: list[str]) -> DiagnosisResult:
    """The diagnosis of the bundled log, from a table in memory and a mapping."""
    rig = json.loads(RIG.read_text(encoding="utf-8"))
    table: Mapping[str, Any] = eccentric.read_log(LOG).columns
    return eccentric.diagnose(table, rig, progress=stages.append)


def without_friction() -> tuple[dict[str, Any], dict[str, Any]]:
    """A drive that speeds itself up a little, in a level plane."""
    t = np.arange(0.0, 40.0, 0.004)
    theta = 9.0 * np.sin(0.9 * t) + 4.0 * np.sin(2.3 * t) + 0.02 * t
    omega = 8.1 * np.cos(0.9 * t) + 9.2 * np.cos(2.3 * t) + 0.02
    alpha = -7.29 * np.sin(0.9 * t) - 21.16 * np.sin(2.3 * t)
    noise = np.random.default_rng(5).normal(0.0, 0.002, len(t))
    torque = 0.04 * alpha - 1e-4 * omega - 0.002 * np.sign(omega) + noise
    known = {"case": "C1", "mu": 1, "J_m": "0 kg m^2", "J_l": "0.04 kg m^2"}
    known |= {"M": "0.5 kg", "M_l": "0.2 kg", "L": "0.25 m"}
    return {"time_s": t, "theta_m_rad": theta, "torque_Nm": torque}, {"known": known}


def with_known(case: str, *, unknown: Mapping[str, Any], **known: float) -> tuple[Any, dict[str, Any]]:
    """A log of the bench driven by current, and its rig with other values, or ranges in their place."""
    run = simulate(drawn_scenario(3, case=case))
    values = {k: x for k, x in run.rig["known"].items() if k.partition("_kg")[0] not in unknown}
    columns = [name for name in run.rig["columns"] if name != "voltage_V"]
    return run.columns, run.rig | {"known": values | known, "unknown": unknown, "columns": columns}


WARNED = {
    "the fit leaves no friction": without_friction,
    "no unbalanced mass": lambda: with_known("C1", unknown={}, M_kg=0.0),
    "M_l is known only as a range": lambda: with_known("C2", unknown={"M_l": ["0.1 kg", "0.3 kg"]}),
}


@pytest.mark.parametrize("warning", WARNED)
def test_it_warns_of_what_a_fit_warns_of(warning: str) -> None:
    """In the object, in the document and in the report."""
    log, rig = WARNED[warning]()
    found = eccentric.diagnose(log, rig, only="stribeck")
    fitted = eccentric.fit(log, rig).warnings

    assert any(text.startswith(warning) for text in fitted)
    assert set(fitted) == set(found.warnings) == set(found.document["warnings"])
    findings = {finding.text for finding in found.data.log.findings}
    assert set(fitted) - findings == set(found.data.log.warnings)


def extended(family: str) -> Model:
    """The model of case C2 with an effect of the library, its parameters at their defaults."""
    effect = next(effect for effect in effects("C2").values() if effect.family == family)
    return effect.extend(eccentric.load_model("c2_parallel"))


@pytest.fixture(scope="module")
def written(bundled: tuple[Diagnosis, Path]) -> Path:
    """What the command writes for the same log."""
    return bundled[1]


def test_the_command_finds_the_same(result: DiagnosisResult, written: Path, tmp_path: Path) -> None:
    """The figures to the last bit, the emitted code to the last byte, and the same files."""
    command = json.loads((written / "diagnosis.json").read_text(encoding="utf-8"))
    paths = result.write(tmp_path / "out")

    assert command | {"logs": ["table"]} == result.to_dict()
    files = {path.relative_to(tmp_path / "out").as_posix() for path in paths}
    assert {p.relative_to(written).as_posix() for p in written.rglob("*.*")} - {".eccentric"} == files
    for name in files - {"report.html", "diagnosis.json", "model.py"}:
        assert (written / name).read_bytes() == (tmp_path / "out" / name).read_bytes(), name


@pytest.mark.parametrize(("share", "solvable"), [(0.99, True), (1.01, False)])
def test_a_loss_beyond_the_inertia_is_not_emitted(
    share: float,
    solvable: bool,
    bundled: tuple[Diagnosis, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """From (J_m + mu^2 J_l)/(mu^2 J_l) of the transmitted torque on: a warning, and the rest is written."""
    base = with_values(eccentric.load_model("c2_parallel"), {"J_m": 2e-4, "J_l": 0.04}, "c2_parallel")
    model = effects("C2")["load_dependent[transmitted]"].extend(base, {"load_eta": share * 1.8 / 1.6})
    monkeypatch.setattr(diagnosed, "extended_model", lambda _: model)
    result = diagnosed.result_of(bundled[0], {})
    names = {path.name for path in result.write(tmp_path / "out")}
    said = [text for text in result.warnings if "a time step has no unique solution" in text]

    assert (said == []) is solvable is ("c2_parallel.c" in names)
    assert {"report.html", "diagnosis.json", "model.py"} <= names
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert ("has no unique solution" in page) is not solvable
    if not solvable:
        assert result.to_dict()["warnings"][-1] == said[0]
        with pytest.raises(InputError, match="acceleration-dependent friction below the inertia"):
            result.emit(tmp_path / "emitted")


def test_the_extended_model_leaves_less_below_the_low_pass(result: DiagnosisResult) -> None:
    """Cut-off and noise are those that the fit of the shipped model has on this log."""
    fit, own = eccentric.fit(LOG, RIG).document["error_band"], result.document["error_band"]

    assert (fit["cut_hz"], pytest.approx(fit["noise"], rel=1e-9)) == (own["cut_hz"], own["noise"])
    assert own["below"] < 0.5 * fit["below"]


def test_it_says_what_it_found(result: DiagnosisResult, stages: list[str]) -> None:
    """The planted harmonic, the error before and after, and what the residual depends on."""
    before, after = (result.rmse["mechanical"][name] for name in ("paper", "extended"))

    assert ("named", ("link_harmonic_friction[n=2]",)) == (result.verdict, result.effects)
    assert 100 * (1 - after / before) == pytest.approx(result.improvement)
    assert result.improvement_interval[0] < result.improvement < result.improvement_interval[1]
    assert ("link_angle", "N m") == (result.depends_on[0], result.unit)
    assert result.sentence in result.summary() == str(result)
    assert "<DiagnosisResult: named: link_harmonic_friction[n=2]>" == repr(result)
    assert "14293 rows used of 15000" == stages[0]


def test_the_live_model_is_the_one_of_the_script(result: DiagnosisResult, written: Path) -> None:
    """model.py, loaded, and the model of the result are emitted as the same files."""
    loaded = eccentric.load_model(written / "model.py")

    assert complete(loaded) == complete(result.model)


THETA, OMEGA = np.linspace(0.0, 6.0, 50), 20.0


def test_the_live_model_can_be_called(result: DiagnosisResult) -> None:
    """It is the paper's model, fitted, and the harmonic."""
    p = result.module.Parameters()
    harmonic = p.link_harmonic_c2 * np.cos(2 * p.mu * THETA) + p.link_harmonic_s2 * np.sin(2 * p.mu * THETA)
    fitted = {field.name: getattr(p, field.name) for field in fields(c2_parallel.Parameters)}
    plain = c2_parallel.mechanical_friction_torque(THETA, OMEGA, c2_parallel.Parameters(**fitted))

    torque = result.module.mechanical_friction_torque(THETA, OMEGA)
    np.testing.assert_allclose(plain + harmonic, torque, rtol=1e-12)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_the_live_model_can_be_compiled(
    result: DiagnosisResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """C and NumPy agree to the last bit."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    one, other = (m.mechanical_friction_torque for m in (result.module, eccentric.compile(result.model)))

    np.testing.assert_array_equal(one(THETA, OMEGA), other(THETA, OMEGA))


def test_the_live_model_can_be_derived_further(result: DiagnosisResult) -> None:
    """Another effect of the library extends it, and its torque is added to the rest."""
    logged = {"temperature_mid": 25.0, "channels": frozenset[str]()}
    setting = Setting(result.model, 0.2, {}, 1.0, 60.0, 15.0, 60.0, 70.0, **logged)
    drag = next(effect for effect in library(setting) if effect.family == "quadratic_drag")
    (letter,) = (q.name for q in drag.parameters)
    further = drag.extend(result.model, {letter: 1e-4})

    before, after = (m.mechanical_friction_torque(0.3, 20.0) for m in (result.module, load_module(further)))

    assert 1e-4 * 20.0**2 == pytest.approx(after - before, rel=1e-9)


def test_the_table_names_the_sum_of_which_an_inertia_is_a_part() -> None:
    """The log identifies J_m + mu^2 J_l alone."""
    log, rig = with_known("C2", unknown={})
    for name in ("J_m_kgm2", "J_l_kgm2"):
        del rig["known"][name]
    table = eccentric.diagnose(log, rig, only="stribeck").table()
    origins = dict(zip(table["name"], table["origin"], strict=True))

    assert {origins["J_m"], origins["J_l"]} == {"part of J_m + mu^2 J_l"}


def test_tables_have_parameters_and_candidates(result: DiagnosisResult) -> None:
    """The parameters of the effect come first, with their errors; the candidates best first."""
    table, candidates = result.table(), result.candidates()
    (effect,) = result.document["effects"]

    assert list(effect["parameters"]) == table["name"][:2]
    assert [p["value"] for p in effect["parameters"].values()] == table["value"][:2]
    assert [p["std_error"] for p in effect["parameters"].values()] == table["std_error"][:2]
    assert {"effect", "friction", "rig"} == set(table["origin"])
    assert [c["id"] for c in result.document["candidates"]] == candidates["id"]
    assert [True] == candidates["adopted"][:1]


def test_the_errors_of_the_estimates_are_correlated(result: DiagnosisResult) -> None:
    """As those of a fit of the extended model to the same rows, which solves the same least squares."""
    table: Mapping[str, Any] = eccentric.read_log(LOG).columns
    fitted = eccentric.fit(table, RIG, result.model)
    names = result.correlation.names

    assert tuple(result.estimates) == names
    assert set(fitted.correlation.names) == set(names)
    for one in names:
        assert 1.0 == pytest.approx(result.correlation[one, one])
        for other in names:
            assert fitted.correlation[one, other] == pytest.approx(result.correlation[one, other], abs=1e-6)


@pytest.fixture(scope="module")
def again(result: DiagnosisResult) -> DiagnosisResult:
    """The same log with the extended model, alive, as the base model."""
    families = "link_harmonic_friction", "motor_harmonic_friction", "kinematic_error", "stribeck"
    return eccentric.diagnose(LOG, RIG, result.model, only=families)


def test_a_live_model_is_diagnosed(result: DiagnosisResult, again: DiagnosisResult) -> None:
    """What the first diagnosis has added is no longer missing, and is estimated as before."""
    assert ("nothing_missing", ()) == (again.verdict, again.effects)
    assert result.rmse["mechanical"]["extended"] == pytest.approx(again.rmse["mechanical"]["paper"])
    assert result.rmse["mechanical"]["linear"] == pytest.approx(again.rmse["mechanical"]["linear"])
    assert set(result.estimates) == set(again.estimates)
    for name, estimate in result.estimates.items():
        assert estimate.value == pytest.approx(again.estimates[name].value, rel=1e-6), name


def test_a_live_model_travels_as_a_script(again: DiagnosisResult, tmp_path: Path) -> None:
    """model.py loads base.py beside it, and is emitted as the files of the live model."""
    paths = again.write(tmp_path / "out")
    loaded = eccentric.load_model(tmp_path / "out" / "model.py")

    assert tmp_path / "out" / "base.py" in paths
    assert complete(again.model) == complete(loaded)


def test_a_live_model_that_ships_is_known_by_its_name() -> None:
    """The script loads it by name, as if the name had been given."""
    bench = eccentric.bench(seconds=15, seed=3)

    model = eccentric.load_model("c2_parallel")
    found = eccentric.diagnose(bench.log, bench.rig, model, only="stribeck")

    assert "model = load_model('c2_parallel')" in found.script
    assert {} == found.own


@pytest.mark.parametrize(
    ("family", "line"),
    [
        ("presliding", "c2_parallel: diagnose requires a model without hidden states, got one with"),
        ("inverter_deadtime", "diagnose requires a model with the paper's armature, got one extended"),
        ("kt_saturation", "diagnose requires a model with the paper's armature, got one extended"),
        ("coulomb_temperature", "c2_parallel: diagnose requires a temperature in the log, got none"),
    ],
)
def test_a_model_that_a_diagnosis_cannot_start_from_is_refused(family: str, line: str) -> None:
    """One line says what it has that a base model must not have."""
    with pytest.raises(InputError, match=line):
        eccentric.diagnose(LOG, RIG, extended(family))


def test_it_is_drawn_over_what_it_depends_on(result: DiagnosisResult) -> None:
    """Left the residual over the link angle, before and after; right friction over the velocity."""
    left, right = result.plot()
    names = [line.get_label() for line in left.lines]

    assert ["paper's model", "extended model", "fitted effect"] == names
    labels = left.get_xlabel(), right.get_xlabel()
    assert ("link angle modulo π [rad]", "motor velocity [rad/s]") == labels
    before, after = (np.asarray(line.get_ydata()) for line in left.lines[:2])
    assert np.nanstd(after) < 0.1 * np.nanstd(before)
    plt.close("all")


def test_the_report_is_one_file(result: DiagnosisResult, tmp_path: Path) -> None:
    """It is written where requested, and names no files that are not beside it."""
    path = result.report(tmp_path / "reports" / "arm.html")
    text = path.read_text(encoding="utf-8")

    assert tmp_path / "reports" / "arm.html" == path
    assert "link_harmonic_friction[n=2]" in text
    assert "diagnosis.json" not in text


def test_a_notebook_shows_sentence_and_table(result: DiagnosisResult) -> None:
    """Its HTML has a row for each parameter below the sentence."""
    page = result._repr_html_()

    assert page.count("<tr>") == 1 + len(result.table())
    assert page.index("Missing: ") < page.index("<table>")


def test_it_can_be_pickled(result: DiagnosisResult) -> None:
    """The copy says the same, draws the same report, and its model is emitted as the same files."""
    again = pickle.loads(pickle.dumps(result))  # noqa: S301 - what was just pickled

    assert (result.to_json(), result.script) == (again.to_json(), again.script)
    assert list(result.table()) == list(again.table())
    assert complete(result.model) == complete(again.model)


def test_scripts_that_would_hide_a_file_of_the_result_are_refused(tmp_path: Path) -> None:
    """One line, before the logs are read."""
    for name in ("model.py", "my_extended.py"):
        with pytest.raises(InputError, match="a name that no file"):
            eccentric.diagnose("no.csv", RIG, effects=tmp_path / name)
    with pytest.raises(InputError, match=r"effects and model: expected files of different names, got a\.py"):
        eccentric.diagnose("no.csv", RIG, tmp_path / "one" / "a.py", tmp_path / "two" / "a.py")


def test_scripts_of_ones_own_travel_with_a_pickled_result(tmp_path: Path) -> None:
    """Their text is in the result: where it is written, the files themselves need not be."""
    own = tmp_path / "mine.py"
    own.write_text("from eccentric.model import load_model\n\nmodel = load_model('c2_parallel')\n")
    bench = eccentric.bench(seconds=15, seed=3)
    found = eccentric.diagnose(bench.log, bench.rig, own, only="stribeck")
    found = pickle.loads(pickle.dumps(found))  # noqa: S301
    text = own.read_text()
    own.unlink()

    found.write(tmp_path / "out")

    assert text == (tmp_path / "out" / "mine.py").read_text()
