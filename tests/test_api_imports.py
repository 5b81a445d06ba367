"""`import eccentric` and every `--help` are there at once; what the package offers is there to see."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import eccentric
from eccentric import api, cli

ROOT = Path(__file__).resolve().parents[1]
HEAVY = {"numpy", "sympy", "mpmath", "scipy", "matplotlib", "jinja2", "bokeh", "pandas", "pyarrow", "typing"}
OFFERED = {
    "adapt", "bench", "bench_arm", "bench_fleet", "check_rig", "compare", "compile", "describe_log",
    "diagnose", "diagnose_arm", "diagnose_fleet", "draft_rig", "emit", "export", "fit", "fit_arm",
    "load_model", "plan", "plan_detection", "read_arm_rig", "read_log", "read_rig", "simulate",
    "AdaptResult", "ArmBenchResult", "ArmDiagnosisResult", "ArmFitResult", "ArmRig", "BenchResult",
    "CompareResult", "Correlation", "DiagnosisResult", "ExportResult", "FitResult", "FleetResult",
    "FrictionRegressor", "LabelledMatrix", "LogDescription", "Log", "Model", "PlanResult", "ResultTable",
    "Rig", "RigCheck", "RigDraft", "SimulateResult", "InputError", "__version__",
}  # fmt: skip


def imported_by(program: str) -> set[str]:
    """The top-level modules that a program has imported when it ends, its own standard ones included."""
    ending = "\nimport sys; print('|'.join(sorted({name.split('.')[0] for name in sys.modules})))"
    done = subprocess.run(
        [sys.executable, "-c", program + ending], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return set(done.stdout.splitlines()[-1].split("|"))


def test_the_package_alone_imports_nothing_heavy() -> None:
    """`import eccentric` costs a few small files; not even `typing` is among what it brings in."""
    bare = imported_by("pass")

    assert (imported_by("import eccentric") - bare) & HEAVY == set()
    assert "sympy" in imported_by("import eccentric\neccentric.load_model")


@pytest.mark.parametrize("command", ["", *cli.COMMANDS])
def test_help_imports_nothing_heavy(command: str) -> None:
    """A command's description and arguments need no SymPy, SciPy, NumPy or matplotlib."""
    arguments = [*command.split(), "--help"]
    program = f"from eccentric.cli import main\ntry: main({arguments})\nexcept SystemExit: pass"

    assert imported_by(program) & (HEAVY - {"typing"}) == set()


def test_a_package_lists_what_it_offers() -> None:
    """`dir` shows exactly the public names, before and after they are used."""
    assert sorted(OFFERED) == dir(eccentric)
    assert callable(eccentric.read_log)
    assert sorted(OFFERED) == dir(eccentric)


@pytest.mark.parametrize("name", sorted(OFFERED))
def test_every_name_is_there(name: str) -> None:
    """Each public name is found, the same object each time, and says what it is."""
    found = getattr(eccentric, name)

    assert found is getattr(eccentric, name)
    assert isinstance(found, str) or found.__doc__


@pytest.mark.parametrize("module", [eccentric, api], ids=["eccentric", "eccentric.api"])
def test_what_type_checkers_see_is_what_there_is(module: ModuleType) -> None:
    """The names of the stub are those that the package has, from the same modules."""
    source = Path(str(module.__file__)).with_suffix(".pyi").read_text(encoding="utf-8")
    typed = {
        alias.asname or alias.name: str(node.module)
        for node in ast.parse(source).body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }

    assert module.__all__ == dir(module) == sorted(typed)
    for name, home in typed.items():
        assert getattr(module, name) is getattr(sys.modules[home], name), name


def test_a_name_that_is_not_offered_is_an_attribute_error() -> None:
    """A wrong name is refused as Python refuses it, with the name in the message."""
    for module in (eccentric, api):
        with pytest.raises(AttributeError, match=f"module '{module.__name__}' has no attribute 'fitt'"):
            module.fitt  # type: ignore[attr-defined] # noqa: B018
