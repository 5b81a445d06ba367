"""Tables of results: in a terminal, in a notebook, and as plain data."""

from __future__ import annotations

import copy
import math

import numpy as np
import pytest

from eccentric import Correlation, ResultTable

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
