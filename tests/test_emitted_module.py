"""The emitted NumPy module as text: short, plain, also with effects, and alone in a single file."""

import ast
import importlib
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

from eccentric.emission import render
from eccentric.model import load_model, model_names
from generated import c2_parallel
from tests import extended

ROOT = Path(__file__).resolve().parent.parent


@pytest.mark.parametrize("name", model_names())
def test_an_emitted_module_is_short_and_plain(name: str) -> None:
    """At most 570 lines, and neither the module nor its runtime executes text."""
    lines = (ROOT / "generated" / f"{name}.py").read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 570

    for file in (f"{name}.py", "eccentric_runtime.py"):
        tree = ast.parse((ROOT / "generated" / file).read_text(encoding="utf-8"))
        called = {
            n.func.id for n in ast.walk(tree) if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)
        }
        assert set() == called & {"exec", "eval", "compile", "__import__"}


@pytest.mark.parametrize(
    ("effect", "most"),
    [
        ("presliding[lugre]", 570),
        ("gear_efficiency[transmitted]", 570),
        # An error of the gear needs the slopes of the normal force.
        ("kinematic_error[link,n=1]", 640),
    ],
)
def test_a_module_with_one_effect_is_short(effect: str, most: int) -> None:
    """What a diagnosis writes is no longer, with those effects that take the most lines."""
    one = extended.effects("C2")[effect]
    model = one.extend(load_model("c2_parallel"), {q.name: 0.1 for q in one.coefficients})
    text = render(model, backends=("numpy",))[f"{model.name}.py"]

    assert len(text.splitlines()) <= most


def test_no_line_of_a_module_with_effects_is_long() -> None:
    """Long sums and products are broken, here those of torque ripple with four effects more."""
    one = extended.with_effect("C1", "kt_ripple[n=1]")

    assert [line for line in one.texts[f"{one.model.name}.py"].splitlines() if len(line) > 110] == []


def test_help_names_the_inputs() -> None:
    """The docstring of a function is completed by the meaning and unit of each of its inputs."""
    text = inspect.getdoc(c2_parallel.gravity_torque) or ""

    assert text.splitlines()[0] == "Gravity torque G, eq (5) [N m]."
    assert text.splitlines()[2] == "theta_m: motor angle [rad]"


@pytest.mark.parametrize("name", model_names())
def test_a_single_file_needs_no_other(name: str, tmp_path: Path) -> None:
    """It runs alone in a clean process, no name in it hides another, and its bits are those of the pair."""
    files = render(load_model(name), backends=("numpy",), single_file=True)
    assert [f"{name}.py"] == list(files)
    (tmp_path / f"{name}.py").write_text(files[f"{name}.py"], encoding="utf-8")
    committed = importlib.import_module(f"generated.{name}")
    given = [0.5] * (len(inspect.signature(committed.friction_torque_gradient).parameters) - 2)

    program = f"import {name} as m; print(m.friction_torque_gradient(*{given}).tolist())"
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    expected = str(committed.friction_torque_gradient(*given).tolist())
    assert ("", expected) == (run.stderr, run.stdout.strip())
    names = [
        n.name for n in ast.parse(files[f"{name}.py"]).body if isinstance(n, ast.FunctionDef | ast.ClassDef)
    ]
    assert len(set(names)) == len(names)
