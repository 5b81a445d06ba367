"""`eccentric.bench`: the virtual test bench in memory is the one that its command writes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib import pyplot as plt

import eccentric
from eccentric import BenchResult, InputError, cli

EFFECTS = {"coulomb_asymmetry": 0.1}


@pytest.fixture(scope="module")
def result() -> BenchResult:
    """A short log with one effect."""
    return eccentric.bench(EFFECTS, seconds=15, seed=4)


def test_the_command_writes_what_the_function_returns(result: BenchResult, tmp_path: Path) -> None:
    """Columns to the last bit, rig and truth; and `write` of the result writes the same bytes."""
    path = tmp_path / "command" / "log.csv.gz"
    arguments = ["--effect", "coulomb_asymmetry=0.1", "--seconds", "15", "--seed", "4"]
    assert 0 == cli.main(["bench", "--out", str(path), *arguments])
    paths = result.write(tmp_path / "function" / "log.csv.gz")

    written = eccentric.read_log(path)
    assert list(result.log.columns) == list(written.columns)
    for name, values in result.log.columns.items():
        np.testing.assert_array_equal(values, written.columns[name], err_msg=name)
    assert result.rig.known == eccentric.read_rig(tmp_path / "command" / "log.json").known
    for one in paths:
        assert one.read_bytes() == (tmp_path / "command" / one.name).read_bytes()


def test_the_truth_is_sealed_from_the_rig(result: BenchResult) -> None:
    """The truth names the effect and its share; nothing that the rig declares does."""
    assert ["coulomb_asymmetry"] == [effect["family"] for effect in result.truth["effects"]]
    assert ("coulomb_asymmetry at 10.0% of friction",) == result.effects
    assert "asymmetry" not in json.dumps(dict(result.rig.known))
    assert "3750 rows of 15 s, case C2, mu 0.2" == result.summary() == str(result)


def test_effects_may_be_a_mapping_or_a_list(result: BenchResult) -> None:
    """A mapping to strengths and a list of pairs are the same bench."""
    again = eccentric.bench(list(EFFECTS.items()), seconds=15, seed=4)

    np.testing.assert_array_equal(result.log.numbers("current_A"), again.log.numbers("current_A"))


def test_the_table_has_the_range_of_each_column(result: BenchResult) -> None:
    """A row for each column of the log."""
    table = result.table()

    assert list(result.log.columns) == table["column"]
    assert [float(x.max()) for x in result.log.columns.values()] == table["highest"]
    assert "theta_m_rad" in result._repr_html_()


def test_it_is_drawn_over_time(result: BenchResult) -> None:
    """Angle, velocity and current, one below the other."""
    axes = result.plot()

    assert ["motor angle [rad]", "motor velocity [rad/s]", "current [A]"] == [x.get_ylabel() for x in axes]
    np.testing.assert_array_equal(result.log.numbers("current_A"), axes[2].lines[0].get_ydata())
    plt.close("all")


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ({"seed": -1}, "seed: expected an integer of 0 or more, got -1"),
        ({"case": "C3"}, "case: expected C1 or C2, "),
        ({"effects": ["stribec"]}, "effect stribec: expected one of "),
    ],
    ids=["seed", "case", "effect"],
)
def test_bad_values_are_one_line(arguments: dict, line: str) -> None:
    """The line begins with the argument."""
    with pytest.raises(InputError) as error:
        eccentric.bench(**arguments)

    assert str(error.value).startswith(line)
