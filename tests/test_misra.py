"""MISRA C:2012, as far as cppcheck sees it: every deviation of the emitted C is declared in its header."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.emitted import every_model

ROOT = Path(__file__).resolve().parent.parent
GENERATED = ROOT / "generated"


def deviations(folder: Path, name: str, text: str, *options: str) -> set[str]:
    """Return the numbers of the rules that cppcheck finds violated by a source; it writes beside it."""
    if shutil.which("cppcheck") is None:
        pytest.skip("not installed: cppcheck")
    source = folder / f"{name}.c"
    source.write_text(text, encoding="utf-8")
    shutil.copy(GENERATED / f"{name}.h", folder)
    command = ["cppcheck", "--addon=misra", "--std=c99", "--template={id}", *options, str(source)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "error" not in done.stderr.replace("misra", ""), done.stderr
    return set(re.findall(r"misra-c2012-([\d.]+)", done.stderr))


@pytest.mark.parametrize("real", ["float", "double"])
@every_model
def test_deviations_are_declared(tmp_path: Path, name: str, real: str) -> None:
    """The rules that the source deviates from are those that the header lists, each with a reason."""
    header = (GENERATED / f"{name}.h").read_text(encoding="utf-8")
    declared = dict(re.findall(r"^ \*  Rule ([\d.]+): (.+)$", header, re.MULTILINE))
    text = (GENERATED / f"{name}.c").read_text(encoding="utf-8")

    assert set(declared) == deviations(tmp_path, name, text, f"-DECCENTRIC_REAL={real}")


def test_a_further_deviation_is_seen(tmp_path: Path) -> None:
    """A goto in the source is found: rule 15.1."""
    text = (GENERATED / "c2_parallel.c").read_text(encoding="utf-8")
    jump = "{\n    goto end;\nend:\n    ;\n    const double"

    found = deviations(tmp_path, "c2_parallel", text.replace("{\n    const double", jump, 1))

    assert "15.1" in found
