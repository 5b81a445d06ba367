"""What `eccentric diagnose` writes beside the report: the model's script, and C that comes with its check."""

import ast
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from eccentric.cli import diagnose as command
from eccentric.cli import main
from eccentric.identify.diagnose import Diagnosis, diagnose
from eccentric.identify.model_script import script
from tests.page_reader import Reader

ROOT = Path(__file__).resolve().parent.parent
LOG, RIG = ROOT / "examples" / "bench" / "bench.csv.gz", ROOT / "examples" / "bench" / "bench.json"


@pytest.fixture(scope="module")
def found() -> Diagnosis:
    """The diagnosis of the bundled log."""
    return diagnose([LOG], RIG)


@pytest.mark.parametrize("real", ["float", "double"])
def test_the_extended_model_comes_with_its_check(
    found: Diagnosis, real: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Self-test and proof driver lie beside the C: the test passes, and the report names each file."""
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    monkeypatch.setattr(command, "diagnose", lambda *_: found)
    out, name = tmp_path / "out", "c2_parallel_extended"
    assert 0 == main(["diagnose", str(LOG), "--rig", str(RIG), "--out", str(out)])

    sources = [out / f"{name}.c", out / "check" / f"{name}_selftest.c"]
    flags = ["-std=c99", f"-DECCENTRIC_REAL={real}", f"-I{out}", "-o", tmp_path / "test"]
    subprocess.run(["gcc", *flags, *sources, "-lm"], check=True)
    subprocess.run([tmp_path / "test"], check=True, capture_output=True)
    text = Reader((out / "report.html").read_text(encoding="utf-8")).text
    written = {path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file()}
    assert f"check/{name}_proof.c" in written
    assert [file for file in written - {"report.html", ".eccentric"} if file not in text] == []


def test_no_name_of_a_log_is_run(found: Diagnosis) -> None:
    """What a log is called stays text in model.py, which is loaded as soon as it is written."""
    hostile = 'a\\""" + str(print(1)) + """.csv'

    before, after = (ast.parse(script(replace(found, logs=(name,)))) for name in ("a.csv", hostile))

    assert [ast.dump(node) for node in before.body[1:]] == [ast.dump(node) for node in after.body[1:]]
    assert "print(1)" in (ast.get_docstring(after) or "")
