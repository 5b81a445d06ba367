"""Calls of compiled functions: whatever is given, the answer is that of the NumPy module, bit for bit."""

import gc
import shutil
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import cache, partial
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eccentric
from tests.emitted import both_precisions, example_states, module, width, with_inertia

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")

NAME = "c2_parallel"
SHAPES = ((), (1,), (5,), (0,), (3, 4), (2, 1, 3))
VALUES = (0.0, -0.0, 1.5, -31.4, 1e300, -1e39, 2.0**60, float("inf"), float("nan"), 5e-324, 3.0)
FUNCTIONS = ("friction_torque", "friction_torque_gradient", "current", "breakaway_torque", "regressor")


Call = tuple[str, list[Any], dict[str, Any], Any]


@pytest.fixture(scope="module", autouse=True)
def cache_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep the libraries of these tests apart; the user's own cache is left alone."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


@cache
def compiled() -> ModuleType:
    """Return the model, compiled once."""
    return eccentric.compile(NAME)


def _inputs(function: str) -> list[str]:
    """Return the names of the inputs, which the signature has before parameters and out."""
    names = {"friction_torque": 2, "friction_torque_gradient": 2, "regressor": 2, "current": 3}
    return ["theta_m", "omega_m", "alpha_m"][: names.get(function, 0)]


def _layouts(x: np.ndarray) -> dict[str, Callable[[], np.ndarray]]:
    """Return ways in which an array can lie in memory."""
    return {
        "whole": lambda: x,
        "by columns": lambda: np.asfortranarray(x),
        "every other": lambda: np.repeat(x, 2, axis=-1)[..., ::2] if x.ndim else x,
        "backwards": lambda: x[..., ::-1][..., ::-1] if x.ndim else x,
        "between addresses": lambda: (
            np.frombuffer(b"\0" + x.tobytes(), np.uint8)[1:].view(x.dtype).reshape(x.shape)
        ),
        "read-only": lambda: np.frombuffer(x.tobytes(), x.dtype).reshape(x.shape),
        "a subclass": lambda: x.view(np.ma.MaskedArray),
    }


@st.composite
def an_input(draw: st.DrawFn, shape: tuple[int, ...]) -> Any:
    """Draw a number or an array that broadcasts to the shape, of some type, somewhere in memory."""
    value = st.sampled_from(VALUES)
    kind = draw(st.sampled_from(["array"] * 4 + ["float", "int", "np.float64", "np.float32", "bool", "list"]))
    if kind != "array":
        number = draw(value)
        whole = int(number) if abs(number) < 1e300 else 7
        made = {"float": number, "int": whole, "bool": True, "list": [number]}
        with np.errstate(over="ignore"):
            return made[kind] if kind in made else getattr(np, kind[3:])(number)
    own = draw(st.sampled_from([shape, shape, shape, shape[-1:], tuple(1 for _ in shape), (7,)]))
    dtype = draw(st.sampled_from(["f8", "f8", "f8", "f4", "f4", "i8", "?", ">f8", "f2"]))
    generator = np.random.default_rng(draw(st.integers(0, 5)))
    with np.errstate(all="ignore"):
        x = np.asarray(generator.choice(VALUES[:5] + VALUES[8:], own)).astype(dtype)
    return draw(st.sampled_from(list(_layouts(x).values())))()


@st.composite
def a_call(draw: st.DrawFn) -> Call:
    """Draw a function, its positional and its named arguments, and the `out` among them."""
    function, shape = draw(st.sampled_from(FUNCTIONS)), draw(st.sampled_from(SHAPES))
    names = _inputs(function)
    if "alpha_m" in names and draw(st.booleans()):
        names.remove("alpha_m")
    inputs = [draw(an_input(shape)) for _ in names]
    own = module(NAME).Parameters(mu=1 / 7, J_m=1e-3, J_l=2e-2)
    parameters = draw(st.sampled_from([None, own, own, with_inertia(NAME), module(NAME).Parameters(M=0.3)]))
    full = (*shape, *width(NAME, function))
    dtype = draw(st.sampled_from([np.float64, np.float32]))
    strided = np.ones((*full[:-1], 2 * full[-1]), dtype)[..., ::2] if full else np.ones((), dtype)
    out = draw(st.sampled_from([None, None, np.ones(full, dtype), strided, np.ones((9, 9)), *inputs]))
    named: dict[str, Any] = {"parameters": parameters, "out": out}
    by_place = draw(st.integers(0, len(inputs)))
    named |= dict(zip(names[by_place:], inputs[by_place:], strict=True))
    if names == _inputs(function) and by_place == len(inputs) and draw(st.booleans()):
        return function, [*inputs, named.pop("parameters")], named, out
    return function, inputs[:by_place], named, out


def _outcome(function: Callable[..., Any], call: Call) -> tuple[Any, ...]:
    """Return the result as type, shape and bits; of an error the type and words. All NaN are one."""
    _, positional, named, out = call
    written = isinstance(out, np.ndarray) and out.flags.writeable
    before = out.copy() if written else None
    try:
        result = function(*positional, **named)
    except (TypeError, ValueError) as error:
        words = str(error)  # NumPy's own differ with the operation that meets the obstacle
        return type(error), next((own for own in ("broadcast", "read-only") if own in words), words)
    returned = np.asarray(result)
    bits = np.where(np.isnan(returned), np.float32("nan"), returned).tobytes()
    found = bits, returned.shape, returned.dtype, type(result), result is out
    if written:
        out[...] = before
    return found


@settings(max_examples=120)
@given(a_call())
def test_any_call_is_answered_as_the_numpy_module_answers_it(call: Call) -> None:
    """Values, type, shape, precision and the words of an error are the same for any call."""
    with np.errstate(all="ignore"):
        expected = _outcome(getattr(module(NAME), call[0]), call)
        actual = _outcome(getattr(compiled(), call[0]), call)

    assert expected == actual


def _python_calls(call: Callable[[], Any]) -> list[str]:
    """Return the names of the Python functions that run during a call, apart from the call itself."""
    seen: list[str] = []

    def profile(frame: Any, event: str, _: Any) -> None:
        if event == "call":
            seen.append(frame.f_code.co_name)

    gc.disable()  # libraries are told of a collection by Python functions of theirs
    sys.setprofile(profile)
    try:
        call()
    finally:
        sys.setprofile(None)
        gc.enable()
    return seen[1:]


@both_precisions
@pytest.mark.parametrize("function", FUNCTIONS)
def test_plain_calls_run_no_python(function: str, dtype: type[np.floating]) -> None:
    """Arrays of one shape, numbers among them, with `out` and with parameters seen before, stay in C."""
    f, count = getattr(compiled(), function), len(_inputs(function))
    x, p = np.linspace(-3, 3, 12, dtype=dtype).reshape(3, 4), with_inertia(NAME)
    plain: dict[str, Any] = {"parameters": p}
    calls = {
        "arrays": partial(f, *[x] * count, **plain),
        "a number among them": partial(f, *[x, 2, 0.5][:count], **plain),
        "numbers": partial(f, *[1.5, 2, 0.5][:count], **plain),
        "by position": partial(f, *[x] * count, p),
        "by name": partial(f, **dict(zip(_inputs(function), [x] * count, strict=True)), **plain),
    }
    if count:
        out = np.empty((3, 4, *width(NAME, function)), dtype)
        calls["into out"] = partial(f, *[x] * count, **plain, out=out)
    for call in calls.values():
        call()  # prepares the parameters

    assert {name: [] for name in calls} == {name: _python_calls(call) for name, call in calls.items()}


@both_precisions
@pytest.mark.parametrize("size", [1, 255, 256, 257, 513, 4095, 4096, 10_001])
def test_a_number_among_arrays_of_any_size_is_an_array_of_it(size: int, dtype: type[np.floating]) -> None:
    """Neither the pieces that a number is spread over nor the threads let in for long arrays change a bit."""
    theta_m, omega_m = example_states(NAME, "friction_torque", size, dtype)

    for function in ("friction_torque", "friction_torque_with_gradient"):
        f = getattr(compiled(), function)
        assert np.array_equal(f(theta_m, np.full(size, 7.25, dtype)), f(theta_m, 7.25))
        assert np.array_equal(f(np.full(size, -3.5, dtype), omega_m), f(-3.5, omega_m))
        assert np.array_equal(getattr(module(NAME), function)(theta_m, 7.25), f(theta_m, 7.25))


def test_parameters_may_change_from_call_to_call() -> None:
    """What was prepared last is not taken for other parameters, nor for the other precision."""
    sets = [None, *(module(NAME).Parameters(mu=1 / n) for n in (3, 5, 7))]
    states = {dtype: example_states(NAME, "friction_torque", 10, dtype) for dtype in (np.float64, np.float32)}

    for k in range(40):
        p, own = sets[k % 3], states[(np.float64, np.float32)[k // 2 % 2]]
        assert np.array_equal(module(NAME).friction_torque(*own, p), compiled().friction_torque(*own, p))


def test_threads_do_not_disturb_each_other() -> None:
    """Calls of several threads at a time, each with parameters of its own, give what they give alone."""
    x, y = example_states(NAME, "friction_torque", 20_000)
    sets = [module(NAME).Parameters(mu=1 / n) for n in range(2, 10)]
    alone = [module(NAME).friction_torque(x, y, p) for p in sets]

    def several(k: int) -> bool:
        found = [compiled().friction_torque(x, y, sets[k]) for _ in range(20)]
        return all(np.array_equal(alone[k], one) for one in found)

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(several, range(len(sets))))


@pytest.mark.slow
def test_calls_keep_nothing() -> None:
    """After any kind of call, taken or refused, what was given is referred to as often as before."""
    f, g = compiled().friction_torque, compiled().friction_torque_gradient
    x, y, out, p = np.ones(5), np.ones(5), np.empty(5), with_inertia(NAME)
    kept = (x, y, out, np.dtype(np.float64), np.dtype(np.float32), 12345.5, None)
    f(x, y, p)

    def calls() -> None:
        f(x, y)
        f(x, 12345.5, p, out)
        f(x, y, out=x)
        f(x[::2], y[:3])
        g(x, omega_m=y)
        g(x, y[:, None])
        f(12345.5, 2.0)
        f(12345.5, 2.0, p)
        for wrong in ((x, y, p, out, x), (x, y[:3]), (x, "1"), (x, y, 3), (x,)):
            with pytest.raises((TypeError, ValueError)):
                f(*wrong)

    # What else runs in this process (threads of other tests, cycles that wait for their collection) moves the
    # counts of `None` and of the dtypes, in either direction. A reference that is kept shows in every round.
    def growth() -> list[int]:
        gc.collect()
        before = [sys.getrefcount(one) for one in kept]
        for _ in range(50):
            calls()
        gc.collect()
        return [sys.getrefcount(one) - early for one, early in zip(kept, before, strict=True)]

    calls()
    rounds = np.array([growth() for _ in range(4)])
    assert np.all(rounds.min(axis=0) < 25), rounds
    assert np.all(rounds.max(axis=0) > -25), rounds
    assert sys.getrefcount(np.float64(1.0)) == sys.getrefcount(f(1.0, 2.0)) == sys.getrefcount(f(1.0, 2.0, p))
    assert sys.getrefcount(np.empty(5)) == sys.getrefcount(f(x, y)) == sys.getrefcount(g(x, y))
