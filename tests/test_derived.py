"""Results that are kept between processes, and functions printed once: those that would be made anew."""

from __future__ import annotations

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy as sp

from eccentric.model import PartValues, fingerprint, function_of, load_model, printed
from eccentric.model.functions import from_bytes, to_bytes
from eccentric.model.steps import OpaqueStep

ROOT = Path(__file__).resolve().parents[1]
MODELS = sorted(path.stem for path in (ROOT / "derivations").glob("[a-z]*.py"))
PRINT = """
import sympy as sp
from eccentric.model import fingerprint, load_model
model = load_model("linear_axis")
print(fingerprint(model))
print([sp.srepr(e.right) for e in model.equations if isinstance(e.right, sp.Expr)])
"""


def run(cache: Path, code: str = PRINT, root: Path = ROOT, **environment: str) -> str:
    """What a process prints that has its cache in this folder."""
    own = os.environ | {"XDG_CACHE_HOME": str(cache)} | environment
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, check=True, capture_output=True, text=True, env=own, cwd=root)
    assert "" == done.stderr
    return done.stdout


def stored(cache: Path) -> list[Path]:
    """The files of derived results in a cache."""
    return sorted((cache / "eccentric").glob("*.derived"))


def written(value: Any) -> Any:
    """An expression as classes and arguments in their order, which SymPy's own comparison of sums ignores."""
    return (type(value), *map(written, value.args)) if getattr(value, "args", ()) else value


@pytest.mark.parametrize("name", MODELS)
def test_a_model_comes_back_from_bytes_as_it_was_written(name: str) -> None:
    """Also the equations that SymPy was kept from evaluating, argument by argument."""
    model = load_model(name)
    back = from_bytes(to_bytes(model))

    assert model == back
    assert [written(e.right) for e in model.equations] == [written(e.right) for e in back.equations]
    assert model.axis is back.axis


def test_a_root_of_a_quotient_stays_one_root() -> None:
    """SymPy's own pickles take it apart, since evaluating sqrt(a/b) does."""
    a, b = sp.symbols("a b", positive=True)
    root = sp.Pow(a / b, sp.Rational(1, 2), evaluate=False)
    back = from_bytes(to_bytes(root))

    assert (root.args, root) == (back.args, back)


def test_a_greatest_comes_back_as_it_was_written() -> None:
    """Without a comparison of its arguments, which would take most of the time of reading it."""
    x = sp.Symbol("x", positive=True)

    for kind in (sp.Max, sp.Min):
        most = kind(2 * x, 3 * x, evaluate=False)
        assert written(most) == written(from_bytes(to_bytes(most)))


def test_a_fingerprint_sees_every_letter() -> None:
    """Of a name, an assumption, an order of arguments that is kept, and a number."""
    x, positive = sp.Symbol("x"), sp.Symbol("x", positive=True)
    values = [x, positive, sp.Symbol("y"), x + 1, x + 2, x + 1.0, ("x",), "x", (), None, 1, 1.0, True]

    assert len(values) == len({fingerprint(value) for value in values})


HOMELESS = f"""
from pathlib import Path

def no_home():
    raise RuntimeError("Could not determine home directory.")

Path.home = no_home
{PRINT}"""
"""As in a container whose user is a number."""


def test_the_next_process_has_the_same_model(tmp_path: Path) -> None:
    """With another order of sets, from what the first has stored; without a home, derived without a word."""
    first = run(tmp_path, PYTHONHASHSEED="1")
    (file,) = stored(tmp_path)
    before = file.stat().st_mtime_ns

    assert first == run(tmp_path, PYTHONHASHSEED="2")
    assert before == file.stat().st_mtime_ns
    assert first == run(tmp_path, HOMELESS, XDG_CACHE_HOME="")


EXTENDED = """
from eccentric.core import derived
from eccentric.emission import load_module, render
from eccentric.simulation import Law
from tests.extended import effects
from eccentric.model import load_model
model = effects("C2")["link_harmonic_friction[n=1]"].extend(load_model("c2_parallel"))
print(list(load_module(model).__dict__), render(model, backends=["numpy"]), sorted(Law(model).at({}).names))
print(sorted({key.split()[0] for key in derived._new}), file=open("KINDS", "w"))
"""


def test_the_next_process_emits_the_same_extended_model(tmp_path: Path) -> None:
    """Byte for byte, from outputs, routines, module and law that the first has stored."""
    code = EXTENDED.replace("KINDS", str(tmp_path / "made"))
    first, made = run(tmp_path, code, PYTHONHASHSEED="1"), tmp_path / "made"

    assert {"interface", "law", "model", "module", "routines", "template"} == set(
        ast.literal_eval(made.read_text(encoding="utf-8"))
    )
    assert first == run(tmp_path, code, PYTHONHASHSEED="2")
    assert "[]\n" == made.read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_damaged_file_is_made_again(tmp_path: Path) -> None:
    """One with other content than was written: nothing of it is used."""
    first = run(tmp_path)
    (file,) = stored(tmp_path)
    whole = file.read_bytes()
    file.write_bytes(whole[:-1] + b"x")

    assert first == run(tmp_path)
    assert len(whole) == len(file.read_bytes())


@pytest.mark.slow
def test_without_a_cache_everything_is_derived(tmp_path: Path) -> None:
    """A file in the place of the folder is no error, and stays."""
    (tmp_path / "eccentric").write_text("mine", encoding="utf-8")

    assert run(tmp_path / "empty") == run(tmp_path)
    assert "mine" == (tmp_path / "eccentric").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_changed_source_is_derived_again(tmp_path: Path) -> None:
    """Results of other sources have a file of their own: a letter in a derivation changes what comes out."""
    copy = tmp_path / "clone"
    for name in ("eccentric", "derivations", "templates"):
        shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    (copy / "pyproject.toml").touch()
    code = 'from eccentric.model import load_model; print(load_model("linear_axis").title)'
    before = run(tmp_path / "cache", code, copy)
    with (copy / "derivations" / "linear_axis.py").open("a", encoding="utf-8") as script:
        script.write("\nfrom dataclasses import replace\n\nmodel = replace(model, title='changed')\n")

    assert "changed" == run(tmp_path / "cache", code, copy).strip()
    assert before == run(tmp_path / "cache", code)


def test_what_a_person_s_own_code_means_is_in_no_digest() -> None:
    """A function may do anything, and a class of a script may change from one run to the next."""

    class Own(OpaqueStep):
        """A step of a person's script."""

        nargs = 1

    with pytest.raises(TypeError, match="expected a record of expressions, got function"):
        fingerprint((1, run))
    with pytest.raises(TypeError, match=r"expected a class of SymPy or of ours, got .*Own"):
        fingerprint(2 * Own(sp.Symbol("x")))


# Expressions as NumPy functions: the values that SymPy gives at 30 digits, each part computed once.


theta, omega, mu, v, z = sp.symbols("theta omega mu v z", real=True)
FIXED, SIGNALS = {"theta", "omega", "mu"}, {"theta", "omega"}
EXPRESSIONS = {
    "cosines": sp.cos(mu * theta / 2) ** 2 * sp.sign(omega) + sp.sin(mu * theta / 2),
    "shape": mu * omega * sp.cos(theta) * sp.exp(-((omega / v) ** 2)) + mu * omega * sp.cos(theta),
    "state": (omega * theta + mu) * z / v + omega * theta + z,
    "branches": sp.Piecewise((omega / v, omega > 0), (-theta, True)) * sp.Abs(theta),
    "bounds": sp.Max(0, 1 - v * omega) + sp.Heaviside(theta, 0),
    "number": sp.Integer(3),
}


@pytest.mark.parametrize("name", EXPRESSIONS)
def test_a_printed_expression_has_the_values_of_sympy(name: str) -> None:
    """At forty samples, with parts and without."""
    expression, rng = EXPRESSIONS[name], np.random.default_rng(1)
    given = {
        "theta": rng.normal(size=40),
        "omega": rng.normal(size=40),
        "mu": 0.2,
        "v": 1.5,
        "z": rng.normal(size=40),
    }
    at = [
        {sp.Symbol(s, real=True): x if np.ndim(x) == 0 else x[k] for s, x in given.items()} for k in range(40)
    ]
    expected = pytest.approx([float(expression.subs(one).evalf(30)) for one in at], rel=1e-13, abs=1e-15)
    parts = PartValues({k: given[k] for k in FIXED})
    whole = printed(f"test {name}", lambda: expression, FIXED, SIGNALS)
    plain, arguments = function_of(expression)

    values = (parts[whole.parts[a]] if a in whole.parts else given[a] for a in whole.arguments)
    assert np.broadcast_to(whole.call(*values), 40) == expected
    assert np.broadcast_to(plain(*(given[a] for a in arguments)), 40) == expected


def test_parts_need_neither_shapes_nor_states() -> None:
    """What is left beside them is the shape, the state and scalars; signals alone stay as they are."""
    shape = printed("test parts", lambda: EXPRESSIONS["shape"], FIXED, SIGNALS)
    parts = {a for part in shape.parts.values() for a in part.arguments}

    assert {"theta", "omega", "mu"} == parts
    assert not {"theta", "mu"} & set(shape.arguments)
    assert {"v"} == {a for a in shape.arguments if a not in shape.parts} - SIGNALS


def test_a_part_is_computed_once_on_a_log() -> None:
    """Two expressions with the same cosine take its values from one array."""
    values = PartValues({"theta": np.linspace(0.0, 1.0, 5), "mu": 0.2, "omega": np.ones(5)})
    first, second = (
        printed(f"test once {k}", lambda k=k: k * sp.cos(mu * theta), FIXED, SIGNALS) for k in (2, 3)
    )
    (one,), (other,) = first.parts.values(), second.parts.values()

    assert values[one] is values[other]
    np.testing.assert_allclose(values[one], np.cos(0.2 * np.linspace(0.0, 1.0, 5)), rtol=1e-15)
