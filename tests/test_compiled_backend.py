"""`eccentric.compile`: the emitted C behind the functions of the NumPy module."""

import inspect
import shutil
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import eccentric
from eccentric.core import InputError, folder
from eccentric.model import load_model
from tests import oracle
from tests.emitted import (
    CALLED_ON_STATES,
    CALLS,
    MODELS,
    example_states,
    in_both,
    in_one,
    module,
    quick,
    with_inertia,
)
from tests.refused import NO_NUMBERS, NO_PARAMETERS

FEW = ("c1_asymmetric", "c2_parallel")
"""Compiled in `make test`: together they have every function. The others are slow tests."""
pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")


@pytest.fixture(scope="module", autouse=True)
def cache_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Return the cache of these tests; the user's own is left alone."""
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder))
        yield folder / "eccentric"


@cache
def compiled(name: str) -> ModuleType:
    """Return the model, compiled once."""
    return eccentric.compile(load_model(name))


@in_both(CALLS, FEW)
def test_same_bits_as_the_numpy_module(name: str, function: str, dtype: type[np.floating]) -> None:
    """Arrays of any layout, and the parameters of a drive of one's own, give the bits that NumPy gives."""
    expected, actual = getattr(module(name), function), getattr(compiled(name), function)
    own = module(name).Parameters(J_m=1e-3, J_l=2e-2, mu=1 / 7, M=0.3)
    states = [x.reshape(20, 50).T for x in example_states(name, function, 1000, dtype)]

    for parameters in (with_inertia(name), own):
        wanted = expected(*states, parameters)
        assert np.array_equal(wanted, actual(*states, parameters), equal_nan=True)
        assert wanted.dtype == np.asarray(actual(*states, parameters)).dtype
        if states:
            mixed = [states[0], *(x[:1] for x in states[1:])]
            assert np.array_equal(expected(*mixed, parameters), actual(*mixed, parameters), equal_nan=True)


@in_one(CALLED_ON_STATES, FEW)
def test_floats_give_the_same_bits(name: str, function: str) -> None:
    """One sample in Python's numbers, of whatever size or sign, or whole, is that of NumPy."""
    expected, actual = getattr(module(name), function), getattr(compiled(name), function)
    states = example_states(name, function, 200, np.float64)
    samples = [tuple(map(float, sample)) for sample in zip(*states, strict=True)]
    samples += [tuple([x] * len(states)) for x in (0.0, -0.0, 1e308, 5e-324, float("inf"), float("nan"), 3)]

    p = with_inertia(name)
    for sample in samples:
        assert np.array_equal(expected(*sample, p), actual(*sample, p), equal_nan=True), sample


@in_one(CALLS, FEW)
def test_signature_is_that_of_the_numpy_module(name: str, function: str) -> None:
    """Names, order and defaults of the arguments are the same, and they can be named."""
    expected, actual = (getattr(m, function) for m in (module(name), compiled(name)))
    defaults = [
        {k: p.default for k, p in inspect.signature(f).parameters.items()} for f in (expected, actual)
    ]

    assert defaults[0] == defaults[1]
    states = dict.fromkeys(oracle.inputs(name, function), 0.5)
    assert np.array_equal(
        expected(**states, parameters=with_inertia(name)), actual(**states, parameters=with_inertia(name))
    )


@in_one(CALLED_ON_STATES, FEW)
def test_what_is_refused_is_what_numpy_refuses(name: str, function: str) -> None:
    """Inputs, parameters and `out` of the wrong kind raise the error of the NumPy module, in its words."""
    f, compiled_f = getattr(module(name), function), getattr(compiled(name), function)
    p, count = with_inertia(name), len(oracle.inputs(name, function))
    ones = [np.ones(3, np.float32)] * (count - 1)
    calls: list[tuple[list[Any], dict[str, Any]]] = [
        *(([*ones, wrong], {"parameters": p}) for wrong, _ in NO_NUMBERS),
        *(([*ones, 1.0], {"parameters": wrong}) for wrong in NO_PARAMETERS),
        *(([*ones, np.ones(3)], {"parameters": p, "out": wrong}) for wrong in ([0.0], 0.0)),
    ]
    if count > 1:
        calls.append(([*ones, 1e300], {"parameters": p}))

    for given, named in calls:
        with pytest.raises((TypeError, ValueError)) as expected:
            f(*given, **named)
        with pytest.raises(type(expected.value)) as actual:
            compiled_f(*given, **named)
        assert str(expected.value) == str(actual.value)


@pytest.mark.parametrize("name", quick(MODELS, FEW))
def test_acceleration_asks_for_inertia(name: str) -> None:
    """Without J_m and J_l an acceleration is refused by their names, as the NumPy module does."""
    states = dict.fromkeys(oracle.inputs(name, "voltage"), 1.0)

    with pytest.raises(ValueError, match=r"J_m.*J_l"):
        compiled(name).voltage(**states)


def test_library_is_built_once(cache_folder: Path) -> None:
    """A second model of the same text finds the libraries in the cache; nothing half-written stays there."""
    compiled("c2_parallel")
    before = {path: path.stat().st_mtime_ns for path in cache_folder.iterdir()}

    eccentric.compile(load_model("c2_parallel"))

    assert before == {path: path.stat().st_mtime_ns for path in cache_folder.iterdir()}
    assert {".json", ".so"} == {path.suffix for path in before}


def test_no_compiler_is_one_clear_line(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Without a compiler the error says what is required; with one that fails, what it said."""
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(InputError, match=r"^compile: expected a C compiler .*, got none$"):
        eccentric.compile(load_model("c1_perpendicular"))

    broken = tmp_path / "cc"
    broken.write_text("#!/bin/sh\necho no such flag >&2\nexit 1\n")
    broken.chmod(0o755)
    with pytest.raises(InputError, match=r"^compile: .*/cc: expected .*, got no such flag$"):
        eccentric.compile(load_model("c1_perpendicular"))


def test_compiler_may_have_options(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """CC is what `make` takes: a command with options of its own, which are handed on."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("CC", "cc -O1")
    expected = module("c1_perpendicular").friction_torque(2.0)
    assert expected == eccentric.compile(load_model("c1_perpendicular")).friction_torque(2.0)

    monkeypatch.setenv("CC", "cc -no-such-option")
    with pytest.raises(InputError, match=r"^compile: .*/cc: expected a C99 compiler .*no-such-option"):
        eccentric.compile(load_model("c1_perpendicular"))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("gcc '", r"expected a command with its options, got \"gcc '\": No closing quotation"),
        (
            "no-such-compiler -O1",
            r"expected a C compiler that is installed, got 'no-such-compiler -O1'",
        ),
    ],
    ids=["open quotation", "absent"],
)
def test_a_compiler_that_is_asked_for_is_not_replaced(
    given: str, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Who sets CC wants that compiler: another one in its place would be a surprise."""
    monkeypatch.setenv("CC", given)
    with pytest.raises(InputError, match=f"^compile: CC: {said}$"):
        eccentric.compile(load_model("c1_perpendicular"))


def test_a_model_may_be_called_python() -> None:
    """No file of the build has the name of a model's own."""
    expected = module("c1_perpendicular").friction_torque(2.0)
    model = replace(load_model("c1_perpendicular"), name="python")
    assert expected == eccentric.compile(model).friction_torque(2.0)


def test_a_name_or_a_path_will_do() -> None:
    """By the name of a model and by the path of its derivation the same functions come as by the model."""
    path = folder("derivations") / "c1_perpendicular.py"
    expected = compiled("c1_perpendicular").normal_force(17.0)

    for given in ("c1_perpendicular", path, str(path)):
        assert expected == eccentric.compile(given).normal_force(17.0)


def test_what_cannot_be_compiled_or_kept_is_one_clear_line(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A number in place of a model, an unknown name and a cache that is a file are reported as such."""
    with pytest.raises(TypeError, match=r"^compile: expected a Model, .*, got int$"):
        eccentric.compile(2)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"^model 'c2_paralel' is unknown; known are "):
        eccentric.compile("c2_paralel")

    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    with pytest.raises(InputError, match=r"file/eccentric: expected a place that can be written"):
        eccentric.compile(load_model("c1_perpendicular"))
