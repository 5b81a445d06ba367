"""What the virtual bench refuses, its command line, and `eccentric.bench`, which is the same in memory."""

import gzip
import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib import pyplot as plt

import eccentric
from eccentric import BenchResult, cli
from eccentric.core import InputError
from eccentric.virtual_bench import EFFECTS, VARIANTS
from tests.virtual import drawn_scenario

ROOT = Path(__file__).resolve().parents[1]
BUNDLED = ROOT / "examples" / "bench"


def test_the_bundled_log_is_what_its_command_writes(tmp_path: Path) -> None:
    """The command in the README of examples/bench regenerates its rows, its rig and its truth."""
    (line,) = (s for s in (BUNDLED / "README.md").read_text().splitlines() if s.startswith("eccentric bench"))
    arguments = line.replace("'", "").replace("again", str(tmp_path)).split()[1:]

    assert cli.main(arguments) == 0
    for name in ("bench.json", "bench.truth.json"):
        assert (BUNDLED / name).read_text() == (tmp_path / name).read_text()
    bundled, again = ((place / "bench.csv.gz").read_bytes() for place in (BUNDLED, tmp_path))
    assert gzip.decompress(bundled) == gzip.decompress(again)
    assert len(bundled) < 400_000


@pytest.mark.parametrize(
    ("options", "names"),
    [
        ({"mu": 0.0}, "mu"),
        ({"mu": float("nan")}, "mu"),
        ({"case": "C3"}, "case"),
        ({"log_type": "walk"}, "log type"),
        ({"seconds": 2.0}, "seconds"),
        ({"noise": -0.1}, "noise"),
        ({"effects": ["stribec"]}, "stribeck, quadratic_drag"),
        ({"effects": [("stribeck", 0.0)]}, "strength"),
        ({"effects": ["stribeck[new]"]}, "variant"),
        ({"effects": ["load_dependent[air]"]}, "gravity, transmitted"),
        ({"effects": ["angle_offset"], "case": "C1"}, "C2"),
        ({"effects": ["hidden_thermal_drift"], "temperature": True}, "temperature"),
    ],
)
def test_bad_scenarios_are_refused_by_name(options: dict[str, object], names: str) -> None:
    """What cannot be simulated is refused in one line that names it."""
    with pytest.raises(InputError, match=names) as refused:
        drawn_scenario(**options)

    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "arguments",
    [
        ["--effect", "stribeck=much"],
        ["--effect", "stribeck=2"],
        ["--effect", "stribeck[n=2]"],
        ["--effect", "cogging[n=3]"],
        ["--effect", "unheard_of"],
        ["--effect", "stribeck=0.3", "--seconds", "40"],  # the motor cannot move it
        ["--seed", "-1"],
        ["--mu", "-1"],
        ["--seconds", "2"],
        ["--noise", "-1"],
        ["--case", "C3"],
        ["--log-type", "walk"],
        ["--out", "log.csv"],
    ],
)
def test_the_command_line_refuses_and_writes_nothing(
    arguments: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Bad values end in status 2 with one line that begins with the option, and no file."""
    assert cli.main(["bench", "--out", str(tmp_path / "log.csv.gz"), *arguments]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"eccentric: error: {arguments[0]}")
    assert said.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["log.csv.gz", "log.json", "log.truth.json"])
def test_the_command_line_overwrites_nothing(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file that one of the three would replace is named in one line before anything is simulated."""
    monkeypatch.setattr("eccentric.api.simulated.simulate", lambda _: pytest.fail("it was simulated"))
    (tmp_path / name).write_bytes(b"measured")

    assert cli.main(["bench", "--out", str(tmp_path / "log.csv.gz")]) == 2
    said = f"{tmp_path / name}: expected a new file to write, got one that exists"
    assert capsys.readouterr().err == f"eccentric: error: {said}\n"
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {name: b"measured"}


def test_the_command_line_requires_a_place_for_the_log(capsys: pytest.CaptureFixture[str]) -> None:
    """Without --out there is one line that requires it."""
    assert cli.main(["bench"]) == 2
    assert capsys.readouterr().err.startswith("eccentric: error: --out: expected the path of a log")


@pytest.mark.parametrize("family", EFFECTS)
def test_listed_variants_are_those_of_the_families(family: str) -> None:
    """What a family answers to a variant that does not exist is what --list-effects shows."""
    expected = f"expected a variant of {', '.join(VARIANTS[family])}," if family in VARIANTS else "no variant"
    with pytest.raises(InputError, match=expected):
        drawn_scenario(effects=[f"{family}[x]"])


# In memory.


ASYMMETRY = {"coulomb_asymmetry": 0.1}


@pytest.fixture(scope="module")
def result() -> BenchResult:
    """A short log with one effect."""
    return eccentric.bench(ASYMMETRY, seconds=15, seed=4)


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
    again = eccentric.bench(list(ASYMMETRY.items()), seconds=15, seed=4)

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
