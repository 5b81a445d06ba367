"""A live base model as base.py: the script makes the model that it was written from."""

import dataclasses
import runpy
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import sympy as sp

from eccentric.diagnosis import base_source, is_result_name, result_name
from eccentric.model import Definition, Model, load_model, model_names, quantity
from tests.extended import BASE, effects


def parts(model: Model) -> dict[str, object]:
    """All of a model but its equations, which are for the reader."""
    return {f.name: getattr(model, f.name) for f in dataclasses.fields(model) if f.name != "equations"}


def made(model: Model, folder: Path) -> Model:
    """The model of the script, run as a program."""
    path = folder / "base.py"
    path.write_text(base_source(model), encoding="utf-8")
    return runpy.run_path(str(path))["model"]


@pytest.mark.parametrize("name", model_names())
def test_a_derivation_comes_back(name: str, tmp_path: Path) -> None:
    """Inputs, parameters with their defaults, definitions and terms are the same; equations are equal."""
    model = load_model(name)

    again = made(model, tmp_path)

    assert parts(model) == parts(again)
    for one, other in zip(model.equations, again.equations, strict=True):
        same = dataclasses.replace(other, right=one.right, identities=one.identities)
        assert one == same
        assert one.right == other.right or sp.simplify(one.right - other.right) == 0


@pytest.mark.parametrize("case", [pytest.param("C1", marks=pytest.mark.slow), "C2"])
def test_every_family_comes_back(case: str, tmp_path: Path) -> None:
    """States, replaced quantities and scaled roles included: what the extensions are is a part of a model."""
    for effect in {effect.family: effect for effect in effects(case).values()}.values():
        model = effect.extend(load_model(BASE[case]))

        assert parts(model) == parts(made(model, tmp_path)), effect.id


def test_letters_may_be_any(tmp_path: Path) -> None:
    """A letter that Python, SymPy or the script has taken is spelled differently there, and only there."""
    paper = load_model("c2_parallel")
    names = ("print", "model", "pi", "Model", "S", "Sgn", "sp", "x_y")
    taken = tuple(
        Definition(quantity(name, "1", 'a "letter" \\ of its own'), sp.Integer(2)) for name in names
    )
    model = dataclasses.replace(paper, definitions=(*taken, *paper.definitions))

    assert parts(model) == parts(made(model, tmp_path))


# The name of a diagnosis' model says what was done to the base model.


def found(base: str, effects: list[str], including: list[str]) -> Any:
    """What a name depends on."""
    models = SimpleNamespace(base=SimpleNamespace(name=base))
    asked = SimpleNamespace(request=SimpleNamespace(including=including))
    return SimpleNamespace(models=models, result=SimpleNamespace(effects=effects), asked=asked)


@pytest.mark.parametrize(
    ("base", "effects", "including", "expected"),
    [
        ("c2_parallel", ["stribeck"], [], "c2_parallel_extended"),
        ("c2_parallel", [], ["stribeck"], "c2_parallel_extended"),
        ("c2_parallel_extended", ["cogging"], [], "c2_parallel_extended_2"),
        ("c2_parallel_extended_2", ["cogging"], [], "c2_parallel_extended_3"),
        ("c2_parallel_fitted", ["cogging"], [], "c2_parallel_extended"),
        ("c2_parallel", [], [], "c2_parallel_fitted"),
        ("c2_parallel_fitted", [], [], "c2_parallel_fitted"),
        ("c2_parallel_extended", [], [], "c2_parallel_extended"),
    ],
)
def test_only_what_was_extended_is_called_so(
    base: str, effects: list[str], including: list[str], expected: str
) -> None:
    """One suffix at most, with the number of the extension from the second on."""
    name = result_name(found(base, effects, including))

    assert (expected, True, False) == (name, is_result_name(name), is_result_name("my_arm"))
