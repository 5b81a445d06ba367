"""What can be exported: a model, a fit.json, its content or its folder, the folder of a diagnosis."""

import json
from pathlib import Path
from typing import Any

import pytest

import eccentric
from eccentric.core import InputError
from eccentric.model import load_model, with_values
from tests.exports import BENCH

FIT = {"model": "c2_parallel", "parameters": BENCH, "ranges": {"speed_m_rad_s": [2.0, 30.0]}}
SCRIPT = f"""from eccentric.model import load_model, with_values

model = with_values(load_model("c2_parallel"), {BENCH}, "c2_parallel")
"""


@pytest.fixture(scope="module")
def places(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with those of a fit and of a diagnosis."""
    folder = tmp_path_factory.mktemp("results")
    for name, file, text in (("fit", "fit.json", json.dumps(FIT)), ("found", "model.py", SCRIPT)):
        (folder / name).mkdir()
        (folder / name / file).write_text(text, encoding="utf-8")
    return folder


def test_every_source_gives_the_same_drive(places: Path, tmp_path: Path) -> None:
    """All have the same values: the FMU is the same, but for where they come from."""
    model = with_values(load_model("c2_parallel"), BENCH, "c2_parallel")
    sources: list[tuple[Any, Any]] = [
        (model, None),
        ("c2_parallel", BENCH),
        ("c2_parallel", FIT),
        ("c2_parallel", places / "fit" / "fit.json"),
        (places / "fit" / "fit.json", None),
        (places / "fit", None),
        (places / "found", None),
    ]
    written = [
        eccentric.export(source, "bam", tmp_path / str(k), parameters=parameters, speeds=(2.0, 30.0))
        for k, (source, parameters) in enumerate(sources)
    ]
    contents = {result.paths[0].read_bytes() for result in written}

    assert len(contents) == 1


def test_the_range_of_the_log_is_taken(places: Path, tmp_path: Path) -> None:
    """The command's line says at which link speeds; given ones go first."""
    said = [
        str(eccentric.export(places / "fit", "mjcf", tmp_path / str(k), speeds=speeds))
        for k, speeds in enumerate((None, (5.0, 10.0)))
    ]

    assert "link speeds 0.4 to 6 rad/s, as in the log" in said[0]
    assert "link speeds 1 to 2 rad/s: error" in said[1]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"torque_unit": "V"}, "expected friction in N m to export"),
        ({"fits_the_rig": False}, "accept_misfit"),
        ({"model": None}, "a fit.json that names its model"),
        ({"model": "c1_perpendicular", "parameters": {"nothing": 1.0}}, "no such parameter"),
    ],
    ids=["in volts", "misfit", "of no model", "of another model"],
)
def test_a_fit_that_cannot_be_exported(change: dict[str, Any], said: str, tmp_path: Path) -> None:
    """One line says why; nothing is written."""
    path = tmp_path / "fit.json"
    path.write_text(json.dumps(FIT | change), encoding="utf-8")

    with pytest.raises(InputError, match=said):
        eccentric.export(path, "mjcf", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_parameters_may_be_the_folder_of_a_fit(places: Path, tmp_path: Path) -> None:
    """As the source of an export may: its fit.json is taken."""
    ways = (places / "fit", places / "fit" / "fit.json")
    written = [eccentric.emit("c2_parallel", tmp_path / str(k), parameters=way) for k, way in enumerate(ways)]
    assert [path.read_bytes() for path in written[0]] == [path.read_bytes() for path in written[1]]


def test_a_folder_that_is_not_there_is_told_with_what_there_may_be(tmp_path: Path) -> None:
    """It is no misspelt name of a model."""
    with pytest.raises(InputError, match="the folder of a fit or a diagnosis, got none with this name"):
        eccentric.export(tmp_path / "nothing", "mjcf", tmp_path / "out")


@pytest.mark.parametrize("speeds", [(1.0,), (0.0, 1.0), (2.0, 1.0), (1.0, float("nan")), (1.0, float("inf"))])
def test_speeds_are_a_range(speeds: tuple[float, ...], places: Path, tmp_path: Path) -> None:
    """Two finite numbers above 0, the second larger."""
    with pytest.raises(InputError, match="speeds: expected motor speeds 0 < LOW < HIGH"):
        eccentric.export(places / "fit", "mjcf", tmp_path / "out", speeds=speeds)
