"""What the virtual bench refuses, and its command line."""

import gzip
from pathlib import Path

import pytest

from eccentric import cli
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
