"""MISRA C:2012 by cppcheck: the estimator violates no required rule; its header lists the advisory ones."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.adapted import emitted

OF_THE_MODEL = {"20.10"}


@pytest.mark.parametrize("real", ["float", pytest.param("double", marks=pytest.mark.slow)])
def test_deviations_are_declared(tmp_path: Path, real: str) -> None:
    """What is found is what the header says, and what the model's header pastes together."""
    if shutil.which("cppcheck") is None:
        pytest.skip("not installed: cppcheck")
    folder = emitted(tmp_path)
    header = (folder / "c2_parallel_adapt.h").read_text(encoding="utf-8")
    (stated,) = re.findall(r"advisory ones are: (.*?return early)", header, re.DOTALL)
    digits = ["-DFLT_MANT_DIG=24", "-DDBL_MANT_DIG=53"]
    command = [
        "cppcheck",
        "--addon=misra",
        "--std=c99",
        "--template={id}",
        *digits,
        f"-DECCENTRIC_REAL={real}",
    ]

    done = subprocess.run(
        [*command, "c2_parallel_adapt.c"], cwd=folder, capture_output=True, text=True, check=True
    )

    found = set(re.findall(r"misra-c2012-([\d.]+)", done.stderr))
    assert found - OF_THE_MODEL == set(re.findall(r"\d+\.\d+", stated))
