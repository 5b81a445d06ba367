"""`eccentric emit`: names of one's own, and the folder that is written."""

import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import pytest

from eccentric.cli import main
from eccentric.emission import BACKENDS, render
from eccentric.model import load_model


@pytest.mark.parametrize(
    "taken", ["math", "stdint", "int", "inline", "class", "numpy", "json", "list", "aux"]
)
def test_a_prefix_that_hides_another_name_is_refused(
    taken: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Headers, modules, keywords of C and Python and devices of Windows: one line, and nothing is written."""
    assert 2 == main(["emit", "c2_parallel", "--prefix", taken, "--out", str(tmp_path / "out")])

    error = capsys.readouterr().err
    required = "expected a lower-case C identifier that C and Python leave free"
    start = f"eccentric: error: --prefix: {required}, got '{taken}', a "
    assert (1, True) == (error.count("\n"), error.startswith(start))
    assert [] == list(tmp_path.iterdir())


NUMPY = {"c1_perpendicular.py", "eccentric_runtime.py"}
C99 = {"c1_perpendicular.h", "c1_perpendicular.c", "check"}
JAX = {"c1_perpendicular_jax.py"}


@cache
def whole() -> Mapping[str, str]:
    """What every back end writes of a model."""
    return render(load_model("c1_perpendicular"), "eccentric emit", backends=BACKENDS)


def files_in(folder: Path) -> set[str]:
    """Names of the files and folders that were written."""
    return {path.name for path in folder.iterdir()} - {".eccentric"}


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ([], {*NUMPY, *C99}),
        (["--backend", "numpy"], NUMPY),
        (["--backend", "c99"], C99),
        (["--backend", "c99", "--single-file"], C99),
        (["--backend", "jax"], JAX),
    ],
    ids=["default", "numpy", "c99", "c99 with a flag for numpy", "jax"],
)
def test_only_the_named_back_ends_are_written(given: list[str], expected: set[str], tmp_path: Path) -> None:
    """Each back end writes its files, C its checks, too; texts and digest are those of the default."""
    assert 0 == main(["emit", "c1_perpendicular", *given, "--out", str(tmp_path / "out")])

    assert expected == files_in(tmp_path / "out")
    for path in (tmp_path / "out").glob("c1_*"):
        assert whole()[path.name] == path.read_text(encoding="utf-8")


def test_an_unknown_back_end_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One line with the names that there are."""
    assert 2 == main(["emit", "c2_parallel", "--backend", "fortran", "--out", str(tmp_path / "out")])

    expected = "eccentric: error: --backend: expected one of numpy, c99, jax, got 'fortran'\n"
    assert expected == capsys.readouterr().err


def test_help_names_every_back_end(capsys: pytest.CaptureFixture[str]) -> None:
    """The help, which loads no back end, lists what the registry holds."""
    with pytest.raises(SystemExit):
        main(["emit", "--help"])

    shown = capsys.readouterr().out
    assert [] == [name for name in BACKENDS if not re.search(rf"\b{name}\b", shown)]


@pytest.mark.parametrize(
    ("name", "received"),
    [
        ("arm.xacro", "'.xacro': expand a xacro and name the result .urdf"),
        ("arm.xml", "'.xml': expand a xacro and name the result .urdf"),
        ("", "a folder"),
    ],
)
def test_what_is_no_model_is_told_what_one_is(
    name: str, received: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """One line with the suffixes of models and arms; nothing is written."""
    done = main(["emit", str(tmp_path / name), "--out", str(tmp_path / "out")])
    said = capsys.readouterr().err

    assert 2 == done
    assert "expected a model's name, a derivation .py, or an arm .toml, .json or .urdf" in said
    assert said.endswith(f"got {received}\n")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("file", "instead"),
    [("model.py", "give its model, "), ("fit.json", "give the model that was fitted, with --parameters ")],
)
def test_the_folder_of_a_result_says_what_to_give_instead(
    file: str, instead: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of a diagnosis its script, of a fit its parameters."""
    (tmp_path / "result").mkdir()
    (tmp_path / "result" / file).write_text("{}", encoding="utf-8")
    assert main(["emit", str(tmp_path / "result"), "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err.endswith(f"got a folder: {instead}{tmp_path / 'result' / file}\n")
