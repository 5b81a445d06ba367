"""MISRA C:2012, as far as cppcheck sees it: every deviation of the emitted C is declared in its header."""

import re
import shutil
import subprocess
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import pytest

from eccentric.emission import render
from tests.adapted import emitted as with_estimator
from tests.compensated import emitted as with_compensation
from tests.emitted import MODELS
from tests.extended import AT_WORK, ONE, at_work, some_at_work

GENERATED = Path(__file__).resolve().parent.parent / "generated"
# Of the rules that have come up, those that MISRA C:2012, appendix B, calls advisory; 10.8 and 15.6 are not.
ADVISORY = {"2.5", "8.7", "12.1", "15.1", "20.5", "20.10"}
FEW = ("c1_perpendicular", "rotating_link")
"""Checked in `make test`."""


@cache
def emitted(name: str) -> Mapping[str, str]:
    """Return header and source of one of the paper's models, as committed, or of an extended one."""
    if name in AT_WORK:
        return render(at_work(name))
    return {f"{name}.{end}": (GENERATED / f"{name}.{end}").read_text(encoding="utf-8") for end in "hc"}


def declared(files: Mapping[str, str], name: str) -> set[str]:
    """Return the numbers of the rules that the header lists as deviated from, each with a reason."""
    return set(re.findall(r"^ \*  Rule ([\d.]+): .+$", files[f"{name}.h"], re.MULTILINE))


def deviations(folder: Path, files: Mapping[str, str], name: str, real: str) -> set[str]:
    """Return the numbers of the rules that cppcheck finds violated by a source; it works in the folder."""
    for end in "hc":
        (folder / f"{name}.{end}").write_text(files[f"{name}.{end}"], encoding="utf-8")
    return checked(folder, name, f"-DECCENTRIC_REAL={real}")


def checked(folder: Path, name: str, *options: str) -> set[str]:
    """Return the same of a source in a folder."""
    if shutil.which("cppcheck") is None:
        pytest.skip("not installed: cppcheck")
    command = ["cppcheck", "--addon=misra", "--std=c99", "--template={id}", *options, f"{name}.c"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    assert "error" not in done.stderr.replace("misra", ""), done.stderr
    return set(re.findall(r"misra-c2012-([\d.]+)", done.stderr))


@pytest.mark.parametrize(
    ("name", "real"),
    [
        pytest.param("c2_parallel", "double", marks=pytest.mark.slow),
        *(pytest.param(name, "float", marks=() if name in FEW else pytest.mark.slow) for name in MODELS),
        # Of the extended ones in double, `make bench` has the rules.
        *(pytest.param(*one.values, "float", marks=one.marks) for one in some_at_work(ONE)),
    ],
)
def test_deviations_are_declared(tmp_path: Path, name: str, real: str) -> None:
    """The paper's models, and every effect in some model, deviate from the advisory rules of their header."""
    files = emitted(name)

    found = deviations(tmp_path, files, name, real)

    assert declared(files, name) == found
    assert found <= ADVISORY


def test_a_further_deviation_is_seen(tmp_path: Path) -> None:
    """A goto in the source is found: rule 15.1."""
    files = dict(emitted("c2_parallel"))
    jump = "{\n    goto end;\nend:\n    ;\n    const double"
    files["c2_parallel.c"] = files["c2_parallel.c"].replace("{\n    const double", jump, 1)

    assert "15.1" in deviations(tmp_path, files, "c2_parallel", "double")


@pytest.mark.parametrize(
    ("part", "real"),
    [
        ("adapt", "float"),
        pytest.param("adapt", "double", marks=pytest.mark.slow),
        pytest.param("compensation", "float", marks=pytest.mark.slow),
        pytest.param("compensation", "double", marks=pytest.mark.slow),
    ],
)
def test_what_is_emitted_beside_declares_its_deviations(tmp_path: Path, part: str, real: str) -> None:
    """What is found is what its header says, and what the model's header pastes together, 20.10."""
    folder = (with_estimator if part == "adapt" else with_compensation)(tmp_path)
    header = (folder / f"c2_parallel_{part}.h").read_text(encoding="utf-8")
    (stated,) = re.findall(r"advisory ones are: (.*?return early)", header, re.DOTALL)
    digits = ("-DFLT_MANT_DIG=24", "-DDBL_MANT_DIG=53")

    found = checked(folder, f"c2_parallel_{part}", *digits, f"-DECCENTRIC_REAL={real}")

    assert found - {"20.10"} == set(re.findall(r"\d+\.\d+", stated))
    assert found <= ADVISORY | {"15.5"}
