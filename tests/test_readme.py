"""README's snippets are what they say: they compile under strict flags, and run where it says."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from generated import c2_parallel
from tests.compiled import FLAGS, run
from tests.hosts import need
from tests.test_tutorial import first_difference, outputs

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def snippets(language: str) -> list[str]:
    """The blocks of README in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize(("compiler", "real"), [("gcc", "double"), ("clang", "float")])
def test_the_c_in_both_precisions(tmp_path: Path, real: str, compiler: str) -> None:
    """The C compiles without a word in double and in float, and gives the torque that NumPy gives."""
    need(compiler)
    (snippet,) = snippets("c")
    called = 'int main(void) { set_up(); printf("%.9e", (double)feed_forward(3, 25)); }\n'
    (tmp_path / "my_firmware.c").write_text(f"#include <stdio.h>\n{snippet}{called}", encoding="utf-8")
    options = [*FLAGS, f"-DECCENTRIC_REAL={real}", f"-I{ROOT / 'generated'}"]
    sources = [tmp_path / "my_firmware.c", ROOT / "generated" / "c2_parallel.c"]

    run(compiler, *options, "-o", tmp_path / "firmware", *sources, "-lm")

    expected = c2_parallel.mechanical_friction_torque(3.0, 25.0, c2_parallel.Parameters(M=0.42))
    assert expected == pytest.approx(float(run(tmp_path / "firmware")), rel=1e-6 if real == "float" else 1e-9)


@pytest.mark.parametrize(
    "number", [pytest.param(0, id="NumPy"), pytest.param(1, id="compiled", marks=pytest.mark.slow)]
)
def test_the_python_runs_as_printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int) -> None:
    """Typed in the root of the clone the Python runs, and its last line has as many values as it says."""
    if number and shutil.which("cc") is None:
        pytest.skip("not installed: cc")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    *lines, last = snippets("python")[number].strip().splitlines()
    script = "\n".join([*lines, f"print(({last.partition('#')[0]}).size)"])

    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=False
    )

    assert "" == done.stderr
    assert (100 * 4, 1)[number] == int(done.stdout)


@pytest.mark.slow
def test_the_first_result_is_what_make_prints(tmp_path: Path) -> None:
    """Words exactly, numbers to 2 %, for the two commands that `make` runs on the bundled log."""
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    recipe = (ROOT / "Makefile").read_text(encoding="utf-8")
    script = re.findall(r"^\t@\$\(BIN\)/(eccentric (?:fit|diagnose) .*)$", recipe, re.MULTILINE)
    (shown,) = re.findall(r"^```\n(bench\.csv\.gz: .*?)^```$", README, re.DOTALL | re.MULTILINE)

    (strict,) = re.findall(r"^STRICT := (.*)$", recipe, re.MULTILINE)
    (compiled,) = re.findall(r'^\t@echo "(.*, compiled with) \$\(CC\)', recipe, re.MULTILINE)

    fitted, diagnosed = outputs(script, tmp_path)

    assert first_difference(shown, f"{fitted}\n{diagnosed}{compiled} cc {strict}") is None
