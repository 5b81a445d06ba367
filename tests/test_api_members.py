"""Members that every result has: of fits, comparisons and plans, of drafts, checks and exports."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.axes import Axes

import eccentric
from eccentric import Correlation, InputError, ResultTable
from eccentric.signals import read_channels

BENCH = Path(__file__).parents[1] / "examples" / "bench"
LOG, RIG = BENCH / "bench.csv.gz", BENCH / "bench.json"
CIRCUIT = {"R": "0.8 ohm", "k_i": "0.063 N m/A", "k_e": "0.063 V s/rad"}
LIMITS = {"speed_rad_s": 20, "acceleration_rad_s2": 200, "current_A": 8, "time_s": 12}
ARM = Path(__file__).parents[1] / "examples" / "arms" / "planar_2r.toml"

MADE: dict[str, Callable[[Path], Any]] = {
    "fit": lambda _: eccentric.fit(LOG, RIG),
    "diagnose": lambda _: eccentric.diagnose(LOG, RIG, only="stribeck"),
    "compare": lambda _: eccentric.compare(LOG, RIG, "c2_parallel"),
    "simulate": lambda _: eccentric.simulate(*short_log(), "c2_parallel"),
    "adapt": lambda _: eccentric.adapt(LOG, RIG),
    "bench": lambda _: eccentric.bench(seconds=15),
    "draft": lambda _: eccentric.draft_rig(LOG),
    "check": lambda _: eccentric.check_rig(LOG, RIG),
    "describe": lambda _: eccentric.describe_log(LOG),
    "export": lambda out: eccentric.export(
        "c2_parallel", "budget", out / "out", parameters={"J_m": 1e-4, "J_l": 0.04}
    ),
}


def short_log() -> tuple[Any, Any]:
    """A log of a few seconds, which is simulated soon."""
    found = eccentric.bench({"stribeck": 0.2}, seconds=15, seed=3)
    return found.log, found.rig


FITTED = ("fit", "diagnose", "compare", "simulate")
DRAWN = (*FITTED, "adapt", "bench")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Any]:
    """The result of a call by its name, made once."""
    return cache(lambda name: MADE[name](tmp_path_factory.mktemp(name)))


@pytest.mark.parametrize("name", MADE)
def test_it_prints_and_becomes_a_data_frame(name: str, made: Callable[[str], Any]) -> None:
    """Its text is its summary, its repr is one line, and its table has a row and a column at least."""
    result = made(name)
    frame = pytest.importorskip("pandas").DataFrame(result.table())

    assert "" != result.summary() == str(result)
    assert "\n" not in repr(result)
    assert "<table>" in result._repr_html_()
    assert 0 < frame.size
    assert all(x is not None for x in frame.to_numpy().ravel())


@pytest.mark.parametrize("name", MADE)
def test_it_is_drawn_on_one_axes(name: str, made: Callable[[str], Any]) -> None:
    """On the Axes that are given; what has no figure says so."""
    _, ax = plt.subplots()
    if name in DRAWN:
        assert ax is made(name).plot(ax=ax)
        assert ax.has_data()
        assert all(isinstance(one, Axes) for one in np.ravel(made(name).plot()))
    else:
        with pytest.raises(InputError, match="expected a result with a figure"):
            made(name).plot(ax=ax)
    plt.close("all")


@pytest.mark.parametrize("name", MADE)
def test_what_was_fitted_is_there_by_name(name: str, made: Callable[[str], Any]) -> None:
    """Parameters, and a covariance whose correlation follows from it; nothing for what fits no model."""
    result = made(name)
    covariance, correlation = result.covariance, result.correlation
    if name not in FITTED:
        assert () == covariance.names
        with pytest.raises(InputError, match="expected the result of a fit or a diagnosis"):
            result.predict(LOG)
        return
    frame, error = pytest.importorskip("pandas").DataFrame(covariance), np.sqrt(np.diag(covariance.matrix))

    assert {"B_lN", "C_m"} <= set(frame.columns) == set(frame.index) <= set(result.parameters)
    with np.errstate(invalid="ignore"):  # a value at a bound has no variance
        expected = covariance.matrix / np.outer(error, error)
    assert np.allclose(correlation.matrix, expected, equal_nan=True)


def voltage_rig(**known: str) -> dict[str, Any]:
    """The bundled rig with the voltage in place of the current, and some of its circuit."""
    columns = {"time": "time_s", "theta_m": "theta_m_rad", "voltage": "voltage_V"}
    bodies = {"M": "463 g", "M_l": "177 g", "L": "278 mm"}
    inertia = {"J_m": "1e-4 kg m^2", "J_l": "0.04034225 kg m^2"}
    return {"columns": columns, "known": {"case": "C2", "mu": "1/5", **bodies, **inertia, **known}}


@pytest.mark.parametrize("known", [{}, CIRCUIT], ids=["in volts", "in newton metres"])
def test_a_log_is_predicted_with_the_error_that_the_fit_names(known: dict[str, str]) -> None:
    """Also where a voltage alone measures the drive: the RMS of the held-out residuals is that error."""
    log = eccentric.bench({"stribeck": 0.2}, seconds=20, seed=3).log
    result = eccentric.fit(log, voltage_rig(**known))

    found = result.prediction(log)
    held_out = np.array(found["held_out"])
    residual = np.array(found["measured"]) - np.array(found["predicted"])

    assert ("N m" if known else "V") == result.unit
    assert result.rmse["mechanical"]["paper"] == pytest.approx(np.sqrt(np.mean(residual[held_out] ** 2)))
    np.testing.assert_allclose(residual, result.residual(log), rtol=1e-12)
    np.testing.assert_array_equal(found["predicted"], result.predict(log))


def test_rows_that_count_in_no_error_are_marked(made: Callable[[str], Any]) -> None:
    """All rows of the log are predicted; at its ends, where the low pass has not settled, none is used."""
    result = made("fit")
    found = result.prediction(LOG)
    used, held_out = (np.array(found[name]) for name in ("used", "held_out"))
    rows = result.document["rows"]

    assert (rows["read"], rows["used"]) == (len(used), np.count_nonzero(used))
    assert not (held_out & ~used).any()
    assert not used[:5].any()
    assert not used[-5:].any()


@pytest.mark.parametrize("name", ["paper", "linear"])
def test_every_model_of_a_diagnosis_predicts(name: str, made: Callable[[str], Any]) -> None:
    """A model of it by its name; the residual has the error of the result."""
    result = made("diagnose")
    found = result.prediction(LOG, model=name)

    residual = np.array(found["residual"])[np.array(found["held_out"])]
    assert result.rmse["mechanical"][name] == pytest.approx(np.sqrt(np.mean(residual**2)), rel=1e-9)
    with pytest.raises(InputError, match="expected one of extended, paper, linear, got 'papers'"):
        result.predict(LOG, model="papers")


OWN = {
    "columns": {"time": "time_s", "theta_m": "theta_m_rad", "current": "current_A"},
    "known": voltage_rig(k_i=CIRCUIT["k_i"])["known"],
}


def test_another_log_of_the_rig_is_predicted_by_the_emitted_module(made: Callable[[str], Any]) -> None:
    """Measured minus predicted is the residual of the emitted module, at the signals of that log."""
    other = eccentric.bench(seconds=15, seed=9).log
    channels = read_channels([other], eccentric.read_rig(OWN))
    motion, current = channels.motion, channels.motor.current

    expected = made("fit").module.mechanical_residual(motion.theta_m, motion.omega_m, current, motion.alpha_m)
    found = made("fit").prediction(other, OWN)
    held_out = np.array(found["held_out"])

    np.testing.assert_allclose(np.array(found["residual"])[held_out], expected[held_out], rtol=1e-9)


def regressor_data() -> tuple[dict[str, Any], Any]:
    """Columns of a log without the drive, and the drive signal."""
    log = eccentric.bench({"stribeck": 0.2}, seconds=20, seed=3).log
    return {name: log.numbers(name) for name in ("time_s", "theta_m_rad")}, log.numbers("current_A")


def test_the_regressor_predicts_the_drive_as_the_fit_does() -> None:
    """From a dict or an array: k_i times the current that it predicts is the torque that the fit predicts."""
    motion, current = regressor_data()
    found = eccentric.FrictionRegressor(OWN).fit(motion, current)
    by_array = eccentric.FrictionRegressor(OWN, columns=list(motion))
    array = np.column_stack(list(motion.values()))

    predicted = found.predict(motion)

    np.testing.assert_allclose(predicted, by_array.fit(array, current).predict(array), rtol=1e-12)
    measured = {**motion, "current_A": current}
    residual = found.result_.residual(measured)
    held_out = np.array(found.result_.prediction(measured)["held_out"])
    np.testing.assert_allclose(0.063 * (current - predicted)[held_out], residual[held_out], atol=1e-9)
    assert found.score(motion, current) == pytest.approx(
        1.0 - np.var(current - predicted) / np.var(current), abs=1e-3
    )


def test_scikit_learn_clones_and_cross_validates_the_regressor() -> None:
    """A clone has the parameters and no result; a grid over models finds what the fits say."""
    base = pytest.importorskip("sklearn.base")
    from sklearn.model_selection import GridSearchCV, TimeSeriesSplit

    motion, current = regressor_data()
    X = pytest.importorskip("pandas").DataFrame(motion)
    plain = eccentric.FrictionRegressor(OWN)
    again = base.clone(plain.fit(X, current))
    models = ["c2_parallel", "c2_asymmetric"]
    grid = GridSearchCV(plain, {"model": models}, cv=TimeSeriesSplit(2)).fit(X, current)

    assert base.is_regressor(plain)
    assert plain.get_params() == again.get_params()
    assert not hasattr(again, "result_")
    assert "c2_parallel" == again.set_params(model="c2_parallel").model
    assert np.all(grid.cv_results_["mean_test_score"] > 0.9)
    with pytest.raises(InputError, match="expected one of rig, model, columns, got 'rigs'"):
        again.set_params(rigs=OWN)


# Tables of results: in a terminal, in a notebook, and as plain data.


TABLE = ResultTable(("name", "value", "unit"), (("B_m", 0.00123456, "N m s/rad"), ("C<m>", None, "N m")))


def test_it_prints_aligned_with_four_digits() -> None:
    """Texts at the left, numbers at the right, a dash for what is not known."""
    assert str(TABLE) == "name     value  unit\nB_m   0.001235  N m s/rad\nC<m>         -  N m"
    assert repr(TABLE) == str(TABLE)


def test_columns_and_rows_are_plain_data() -> None:
    """A column by its name, rows as dictionaries, in full precision."""
    assert [0.00123456, pytest.approx(math.nan, nan_ok=True)] == TABLE["value"]
    assert {"name": "B_m", "value": 0.00123456, "unit": "N m s/rad"} == next(iter(TABLE))
    assert 2 == len(TABLE) == len(list(TABLE))


def test_a_row_and_a_part_are_taken_as_of_a_list() -> None:
    """By number, from either end, and by a slice, which is a table again."""
    table = ResultTable(("name", "value"), (("a", 1.0), ("b", 2.0), ("c", 3.0)))

    assert {"name": "c", "value": 3.0} == table[-1]
    assert [{"name": "a", "value": 1.0}, {"name": "b", "value": 2.0}] == list(table[:2])


def test_an_unknown_column_is_named_with_those_that_there_are() -> None:
    """A KeyError says which columns the table has."""
    with pytest.raises(KeyError, match="'error'; the columns are name, value, unit"):
        TABLE["error"]


def test_a_notebook_shows_it_escaped() -> None:
    """Texts of a log or a rig cannot become markup."""
    page = TABLE._repr_html_()

    assert "<td>C&lt;m&gt;</td><td>-</td>" in page
    assert page.count("<tr>") == 3


@pytest.mark.parametrize("library", ["pandas", "polars"])
def test_it_becomes_a_data_frame(library: str) -> None:
    """A data frame of another library takes its rows."""
    frame = pytest.importorskip(library).DataFrame(list(TABLE) if library == "polars" else TABLE)

    assert ["name", "value", "unit"] == list(frame.columns)
    assert ["B_m", "C<m>"] == list(frame["name"])


def test_a_matrix_becomes_a_labelled_data_frame() -> None:
    """The names are on both axes, also in a copy."""
    found = copy.deepcopy(Correlation.of(["a", "b", "held"], COVARIANCE))
    frame = pytest.importorskip("pandas").DataFrame(found)

    assert ["a", "b", "held"] == list(frame.columns) == list(frame.index)
    assert 0.5 == pytest.approx(frame.loc["a", "b"]) == pytest.approx(found["a"]["b"])
    assert math.isnan(frame.loc["held", "a"])


COVARIANCE = np.array([[4.0, 3.0, 0.0], [3.0, 9.0, 0.0], [0.0, 0.0, 0.0]])


def test_a_correlation_is_the_covariance_over_both_errors() -> None:
    """3 over 2 times 3; what has no error has no correlation."""
    found = Correlation.of(["a", "b", "held"], COVARIANCE)

    assert 0.5 == pytest.approx(found["a", "b"]) == pytest.approx(found["b", "a"])
    assert 1.0 == pytest.approx(found["b", "b"])
    assert math.isnan(found["held", "a"])
    assert math.isnan(found["held", "held"])


def test_a_correlation_prints_with_its_names_on_both_axes() -> None:
    """Two digits; a dash where there is none."""
    found = Correlation.of(["a", "b", "held"], COVARIANCE)

    assert str(found).splitlines() == [
        "         a     b  held",
        "a     1.00  0.50     -",
        "b     0.50  1.00     -",
        "held     -     -     -",
    ]
    assert [0.5, 1.0, pytest.approx(math.nan, nan_ok=True)] == found.table()["b"]
    assert "<th>held</th>" in found._repr_html_()


def test_a_wrong_name_of_a_correlation_is_told_with_the_right_ones() -> None:
    """A KeyError says which estimates there are."""
    with pytest.raises(KeyError, match="'c'; the estimates are a, b, held"):
        Correlation.of(["a", "b", "held"], COVARIANCE)["a", "c"]
