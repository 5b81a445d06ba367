# Generated: do not edit. Written by `make derive` (eccentric 0.2.0b1).
"""The runtime of the NumPy modules emitted by eccentric; it knows no model.

A kernel is a formula in plain NumPy that takes coefficients and inputs. For arrays it is called once, with
symbols that record its operations. The record is then replayed on blocks of samples that fit in the cache,
in reused buffers. For floats the kernel is called directly, with Python's mathematics in place of NumPy's.

All of it is one file, so that it can be copied with a module in one step. In this order:

    Checked               parameters, their signs and units
    Pair, Coefficients    values that depend on them, beyond double precision where that matters
    sine_ratio, cosine    polynomials
    _Tape, _Layout        the record of a kernel, and places for its values
    _Plan, _Run, _fill    its steps, replayed block by block
    arrays                the arguments of a call
    _Floats               one sample, in Python's numbers
    _Kernel, Model        the functions of a module
"""

from __future__ import annotations

import contextvars
import dataclasses
import inspect
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, lru_cache, partial, wraps
from itertools import islice
from numbers import Real
from types import FunctionType
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike

_LARGEST = float(np.finfo(np.float64).max)


def positive(default: float | None, unit: str) -> Any:
    """A field of parameters above zero."""
    return _field(default, "a positive number", unit, math.ulp(0.0), _LARGEST)


def nonnegative(default: float | None, unit: str) -> Any:
    """A field of nonnegative parameters."""
    return _field(default, "a number that is not negative", unit, 0.0, _LARGEST)


def real(default: float | None, unit: str) -> Any:
    """A field of finite parameters."""
    return _field(default, "a finite number", unit, -_LARGEST, _LARGEST)


def tilt(default: float | None, unit: str) -> Any:
    """A field of angles up to a right angle; rounded up to single precision it is still valid."""
    return _field(default, "a number from 0 to pi/2", unit, 0.0, 1.5707964)


def _field(default: float | None, required: str, unit: str, lowest: float, highest: float) -> Any:
    domain = (default is None, f"{required} [{unit}]", lowest, highest)
    return dataclasses.field(default=default, metadata={"domain": domain})


class Checked:
    """Parameters, checked when they are made, and stored as floats."""

    def __post_init__(self) -> None:
        for name, (optional, required, lowest, highest) in _domains(type(self)):
            value = getattr(self, name)
            if value is None and optional:
                continue
            if type(value) is not float and not isinstance(value, Real):
                raise TypeError(f"{name}: expected {required}, got {type(value).__name__}")
            try:
                number = float(value) + 0.0  # minus zero becomes zero
            except OverflowError:
                received = "got one beyond double precision"
                raise ValueError(f"{name}: expected {required}, {received}") from None
            if not lowest <= number <= highest:
                raise ValueError(f"{name}: expected {required}, got {number}")
            # Equal parameters are then identical, as the caches assume.
            object.__setattr__(self, name, number)


@cache
def _domains(kind: Any) -> list[tuple[str, tuple[bool, str, float, float]]]:
    return [(field.name, field.metadata["domain"]) for field in dataclasses.fields(kind)]


class Pair:
    """A number beyond double precision: high + low, unevaluated, with some 104 bits."""

    __slots__ = ("high", "low")

    def __init__(self, high: float, low: float = 0.0) -> None:
        self.high, self.low = high, low

    def __add__(self, other: Pair | float) -> Pair:
        y = _pair(other)
        highs = _sum(self.high, y.high)
        return _sum(highs.high, highs.low + (self.low + y.low))

    def __mul__(self, other: Pair | float) -> Pair:
        y = _pair(other)
        highs = _product(self.high, y.high)
        return _sum(highs.high, highs.low + (self.high * y.low + self.low * y.high))

    def __truediv__(self, other: Pair | float) -> Pair:
        y = _pair(other)
        quotient = self.high / y.high
        taken = _product(quotient, y.high)
        left = (((self.high - taken.high) - taken.low) + self.low) - quotient * y.low
        return _sum(quotient, left / y.high)

    def __radd__(self, other: float) -> Pair:
        return Pair(other) + self

    def __rmul__(self, other: float) -> Pair:
        return Pair(other) * self

    def __rtruediv__(self, other: float) -> Pair:
        return Pair(other) / self

    def sqrt(self) -> Pair:
        """The square root."""
        root = math.sqrt(self.high)
        taken = _product(root, root)
        left = ((self.high - taken.high) - taken.low) + self.low
        return _sum(root, left / (2.0 * root) if root > 0.0 else 0.0)


def turn_less(a: float, b: float) -> Pair:
    """2 pi - a b, for a b close to 2 pi."""
    taken = _product(a, b)
    first = _sum(6.283185307179586 - taken.high, -taken.low)
    second = _sum(first.high, 2.4492935982947064e-16)
    return _sum(second.high, second.low + (first.low - 5.989539619436679e-33))


def _pair(x: Pair | float) -> Pair:
    return x if isinstance(x, Pair) else Pair(x)


def _sum(a: float, b: float) -> Pair:
    """Add without error."""
    high = a + b
    part = high - a
    return Pair(high, (a - (high - part)) + (b - part))


def _product(a: float, b: float) -> Pair:
    """Multiply without error: both factors are split into halves with exact products."""
    high = a * b
    a_scaled, b_scaled = a * 134217729.0, b * 134217729.0
    a_1, b_1 = a_scaled - (a_scaled - a), b_scaled - (b_scaled - b)
    a_2, b_2 = a - a_1, b - b_1
    return Pair(high, (((a_1 * b_1 - high) + a_1 * b_2) + a_2 * b_1) + a_2 * b_2)


_Real = type[np.float32] | type[np.float64]


class Coefficients:
    """The values that a kernel needs from the parameters, computed by `_prepare` in double precision."""

    def __init__(self, precision: _Real) -> None:
        self.real: _Real = precision
        self.single = precision is np.float32
        # x + rounder - rounder is x, rounded to an integer.
        self.rounder = 1.5 / float(np.finfo(precision).eps)

    def rounded(self, x: float) -> float:
        """The number in the working precision."""
        return float(self.real(x))

    def leading(self, x: float) -> float:
        """The leading digits of x, so few that their product with a number of half turns is exact."""
        scaled = x * (8796093022209.0 if self.single else 1048577.0)
        return scaled - (scaled - x)


def _computed(steps: Sequence[tuple[str, Any, list[str]]], known: dict[str, Any]) -> dict[str, Any]:
    """Add the values of these steps to those that are known."""
    with np.errstate(all="ignore"):
        for name, operation, operands in steps:
            known[name] = np.asarray(operation(*(known[operand] for operand in operands)))
    return known


class _Prepared:
    """The coefficients of one set of parameters: numbers for kernels on floats, arrays for recorded steps."""

    def __init__(self, c: Coefficients) -> None:
        self.arrays: dict[str, np.ndarray] = {}
        self.known: dict[_Plan, dict[str, Any]] = {}
        self.numbers: Any = c
        with np.errstate(all="ignore"):
            for name, value in vars(c).items():
                if name not in {"real", "single"}:
                    rounded = c.real(value.high if isinstance(value, Pair) else value)
                    self.arrays[f"c.{name}"] = np.asarray(rounded)
        vars(c).update({name[2:]: float(x) for name, x in self.arrays.items()})

    def constants(self, plan: _Plan) -> dict[str, Any]:
        """Everything that the steps of a plan read and that no sample changes, by its name there."""
        if plan not in self.known:
            self.known[plan] = _computed(plan.ahead, self.arrays | plan.numbers)
        return self.known[plan]


_SINE_RATIO = {
    np.float32: (2.60548113e-6, -1.98094749e-4, 8.33306462e-3, -1.66666595e-1),
    np.float64: (
        2.7209972799826466e-15,
        -7.6429749659503679e-13,
        1.6058939085095993e-10,
        -2.5052106860746877e-8,
        2.7557319211008999e-6,
        -1.9841269841208492e-4,
        8.3333333333331924e-3,
        -1.6666666666666666e-1,
    ),
}
_COSINE = {
    np.float32: (-2.60742068e-7, 2.47617292e-5, -1.38884006e-3, 4.16666405e-2, -4.99999995e-1),
    np.float64: (
        4.6099547638170315e-14,
        -1.1463008250042011e-11,
        2.0876566590691354e-9,
        -2.7557316503307265e-7,
        2.4801587278920885e-5,
        -1.3888888888784392e-3,
        4.1666666666664337e-2,
        -4.9999999999999982e-1,
    ),
}


def sine_ratio(half_angle: Any, c: Coefficients) -> Any:
    """sin(h)/h - 1, |h| within a quarter turn, by a minimax polynomial in h^2: errors 1.4e-8 and 4.3e-18."""
    return _horner(_SINE_RATIO[c.real], half_angle * half_angle)


def cosine(half_angle: Any, c: Coefficients) -> Any:
    """cos(h), |h| within a quarter turn, by a minimax polynomial in h^2: errors 4.1e-9 and 1.4e-17."""
    return _horner(_COSINE[c.real], half_angle * half_angle) + 1.0


def _horner(coefficients: tuple[float, ...], x: Any) -> Any:
    """(...((a x + b) x + c) x + ...) x."""
    if isinstance(x, _Value):
        return x.tape.step(_horner_on_arrays, coefficients, x)
    y = 0.0
    for coefficient in coefficients:
        y = (y + coefficient) * x
    return y


def _horner_on_arrays(coefficients: Sequence[np.ndarray], x: np.ndarray, out: np.ndarray) -> None:
    add, multiply = np.add, np.multiply
    multiply(coefficients[0], x, out)
    for coefficient in coefficients[1:]:
        add(out, coefficient, out)
        multiply(out, x, out)


class _Value(NDArrayOperatorsMixin):
    """A placeholder for an array while a kernel is recorded."""

    def __init__(self, tape: _Tape, name: str, *, computed: bool = False) -> None:
        self.tape, self.name, self.computed = tape, name, computed

    def __array_ufunc__(self, operation: Any, method: str, *operands: Any) -> _Value:
        return self.tape.step(operation, *operands)

    def __array_function__(self, function: Any, types: Any, operands: Any, named: Any) -> _Value:
        if function is np.clip and isinstance(operands[2], _Value) and operands[2].computed:
            x, least, most = operands
            return np.minimum(np.maximum(x, least), most)  # between arrays, clip takes twice as long
        if function is not np.where:
            return self.tape.step(function, *operands)
        condition, x, y = operands
        # The computed operand keeps its place; only the other is moved.
        if isinstance(x, _Value) and x.computed:
            return self.tape.step(_put, y, np.logical_not(condition), x)
        return self.tape.step(_put, x, condition, y)


class _Symbols(Coefficients):
    """The coefficients while a kernel is recorded: each a value of its name."""

    def __init__(self, precision: _Real, tape: _Tape) -> None:
        self.real, self.single, self._tape = precision, precision is np.float32, tape

    def __getattr__(self, name: str) -> _Value:
        return _Value(self._tape, f"c.{name}")


class _Tape:
    """The steps of a kernel; a value that is already computed is not computed again."""

    def __init__(self) -> None:
        self.literals: dict[Any, str] = {}
        self.steps: dict[tuple[Any, ...], _Value] = {}

    def name(self, x: Any) -> str:
        """The name of a value, of a number or of the coefficients of a polynomial."""
        return x.name if isinstance(x, _Value) else self.literals.setdefault(x, f"n{len(self.literals)}")

    def step(self, operation: Any, *operands: Any) -> _Value:
        """The value of an operation."""
        key = (operation, *map(self.name, operands))
        if operation is np.multiply and key[1] == key[2]:
            key = (np.square, key[1])  # the same bits, with one operand less
        if key not in self.steps:
            self.steps[key] = _Value(self, f"v{len(self.steps)}", computed=True)
        return self.steps[key]


def _put(x: np.ndarray, where: np.ndarray, out: np.ndarray) -> None:
    np.copyto(out, x, where=where)


def _minimum(x: np.ndarray, y: np.ndarray, out: np.ndarray) -> None:
    np.minimum(x, y, out=out)  # a positional `out` is deprecated


def _maximum(x: np.ndarray, y: np.ndarray, out: np.ndarray) -> None:
    np.maximum(x, y, out=out)


class _Probe(np.ndarray):
    def __array_ufunc__(self, operation: Any, method: str, *operands: Any, **named: Any) -> Any:
        return operation


# How operations are called with the array for their result last. The ufunc behind np.clip has no public
# name, and takes half the time on short arrays.
_CALLS: dict[Any, Any] = {
    np.minimum: _minimum,
    np.maximum: _maximum,
    np.clip: np.zeros(1).view(_Probe).clip(0.0, 1.0),
}
# How they are called on single numbers.
_ONCE: dict[Any, Any] = {_put: lambda x, where, y: np.where(where, x, y), _horner_on_arrays: _horner}
# What gives true or false.
_MASKS = {np.greater, np.greater_equal, np.less, np.less_equal, np.equal, np.logical_not}


class _Layout:
    """Places of the operands and results of steps.

    Places are x0, x1, ... for inputs, y0, ... for results, w0, ... for buffers, m0, ... for masks; what has
    another name is constant.
    """

    def __init__(self, results: Sequence[str], numbers: Mapping[str, Any]) -> None:
        self._results, self._numbers = results, numbers
        self.steps: list[tuple[Any, list[str]]] = []
        self.made = {"w": 0, "m": 0}
        self._free: dict[str, list[str]] = {"w": [], "m": []}

    def place(self, steps: list[tuple[Any, list[str], str]]) -> None:
        """Give every value a place; that of a value which is no longer read is used again."""
        last = {name: k for k, (_, names, _) in enumerate(steps) for name in names}
        last |= dict.fromkeys(self._results, len(steps))
        place: dict[str, str] = {}
        for k, (operation, names, value) in enumerate(steps):
            read = [place.get(name, name) for name in names]
            ending = {place[name] for name in names if name in place and last[name] == k}
            how = self._choice if operation is _put else self._operation
            place[value] = how(operation, read, ending, value)
        for k, name in enumerate(self._results):
            if place.get(name, name) != f"y{k}":
                self.steps.append((np.positive, [place.get(name, name), f"y{k}"]))

    def _operation(self, operation: Any, read: list[str], ending: set[str], value: str) -> str:
        """A result may take the place of an operand that is no longer read, unless it is read to the end."""
        kept = ending if operation is _horner_on_arrays else set[str]()
        self._give(ending - kept)
        target = self._result(value) or self._take("m" if operation in _MASKS else "w")
        self._give(kept)
        self.steps.append((_CALLS.get(operation, operation), [*read, target]))
        return target

    def _choice(self, operation: Any, read: list[str], ending: set[str], value: str) -> str:
        """A choice is put into its last operand, or into a copy of it where it is read further on."""
        *others, y = read
        target = y if y in ending and y not in others else ""
        # A single result may share the place of an input: it is written last, and by one step.
        if not target and len(self._results) > 1:
            target = self._result(value)
        target = target or self._take("w")
        if target != y:
            self.steps.append((np.positive, [y, target]))
        x, condition = others
        alone = x in self._numbers or x.startswith("c.")
        if alone and condition.startswith("m") and target.startswith("w"):
            self.steps.append((np.putmask, [target, condition, x]))  # takes two thirds of the time
        else:
            self.steps.append((operation, [x, condition, target]))
        self._give(ending - {target})
        return target

    def _result(self, value: str) -> str:
        return f"y{self._results.index(value)}" if value in self._results else ""

    def _take(self, kind: str) -> str:
        if self._free[kind]:
            return self._free[kind].pop()
        self.made[kind] += 1
        return f"{kind}{self.made[kind] - 1}"

    def _give(self, places: set[str]) -> None:
        for place in sorted(places):
            self._free[place[0]].append(place)


class _Plan:
    """The steps of a kernel in one precision: operations, with the places of operands and results."""

    def __init__(
        self,
        kernel: Callable[..., Any],
        lengths: Sequence[int | None],
        precision: _Real,
        single: tuple[str, ...],
    ) -> None:
        """`single` names inputs with one value for all samples."""
        tape = _Tape()
        inputs = [_Value(tape, f"x{k}") for k in range(sum(n or 1 for n in lengths))]
        found = kernel(_Symbols(precision, tape), *_grouped(inputs, lengths))
        self.precision = precision
        self.vector = isinstance(found, tuple)
        results = [tape.name(x) for x in (found if self.vector else (found,))]
        self.width = len(results)
        self.outside = [x.name for x in inputs if x.name not in single] + [f"y{k}" for k in range(self.width)]
        self.numbers: dict[str, Any] = {}
        for x, name in tape.literals.items():
            several = isinstance(x, tuple)
            self.numbers[name] = [np.array(k, precision) for k in x] if several else np.array(x, precision)
        self.ahead: list[tuple[str, Any, list[str]]] = []
        self.in_call: list[tuple[str, Any, list[str]]] = []
        layout = _Layout(results, self.numbers)
        layout.place(self._split(tape, set(single)))
        self.steps, self.made = layout.steps, layout.made
        self.spare: dict[tuple[int, ...], _Run] = {}

    def _split(self, tape: _Tape, single: set[str]) -> list[tuple[Any, list[str], str]]:
        """The steps, without those done once: of constants only, and in each call of single inputs."""
        constant, steps = set(self.numbers), []
        for (operation, *names), value in tape.steps.items():
            varying = {name for name in names if name not in constant and not name.startswith("c.")}
            if varying - single:
                steps.append((operation, names, value.name))
            else:
                done, known = (self.in_call, single) if varying else (self.ahead, constant)
                done.append((value.name, _ONCE.get(operation, operation), names))
                known.add(value.name)
        return steps


def _grouped(values: Sequence[Any], lengths: Sequence[int | None]) -> list[Any]:
    """The values as a kernel takes them, those of a vector together."""
    rest = iter(values)
    return [next(rest) if n is None else tuple(next(rest) for _ in range(n)) for n in lengths]


_BLOCK = 16384  # elements: few enough to stay in the cache, enough for a low cost per element


class _Run:
    """The calls that a plan makes on arrays of one shape, with its own buffers."""

    def __init__(self, plan: _Plan, shape: tuple[int, ...]) -> None:
        self.plan, self.constants = plan, None
        buffers = _aligned(plan.made["w"], math.prod(shape), np.dtype(plan.precision))
        self.places: dict[str, np.ndarray] = {f"w{k}": b.reshape(shape) for k, b in enumerate(buffers)}
        self.places |= {f"m{k}": np.empty(shape, bool) for k in range(plan.made["m"])}
        # Entering a context takes a tenth of the time of np.errstate.
        self.quiet = contextvars.copy_context()
        self.quiet.run(np.seterr, all="ignore")

    def bind(self, constants: dict[str, Any]) -> None:
        """Put these constants into the calls, and leave places for inputs and results."""
        self.constants = constants
        places = self.places | constants
        outside = {place: k for k, place in enumerate(self.plan.outside)}
        self.calls: list[tuple[Any, Any]] = []
        self.holes: list[tuple[list[Any], int, int]] = []
        for operation, names in self.plan.steps:
            arguments = [places.get(name) for name in names]
            holes = [(arguments, at, outside[name]) for at, name in enumerate(names) if name in outside]
            self.calls.append((operation, arguments if holes else tuple(arguments)))
            self.holes += holes

    def play(self, arrays: Sequence[np.ndarray]) -> None:
        """Make the calls on inputs and results."""
        for arguments, at, k in self.holes:
            arguments[at] = arrays[k]
        for operation, arguments in self.calls:
            operation(*arguments)
        for arguments, at, _ in self.holes:
            arguments[at] = None  # otherwise a cached run would keep them alive


def _aligned(count: int, size: int, real: np.dtype[Any]) -> np.ndarray:
    """Buffers aligned with cache lines, which saves a tenth of the time."""
    line = 64 // real.itemsize
    pitch = -(-size // line) * line
    memory = np.empty(count * pitch + line, real)
    start = -memory.ctypes.data % 64 // real.itemsize
    return memory[start : start + count * pitch].reshape(count, pitch)[:, :size]


def _fill(
    plan: _Plan, constants: dict[str, Any], inputs: Sequence[np.ndarray], parts: Sequence[np.ndarray]
) -> None:
    """Fill the parts of the result, block by block if they are large."""
    first = parts[0]
    if first.size <= _BLOCK:
        shape = first.shape
        if not shape:
            shape, parts = (1,), [part.reshape(1) for part in parts]
        spare = plan.spare
        run = spare.pop(shape, None) or _Run(plan, shape)
        if run.constants is not constants:
            run.bind(constants)
        run.quiet.run(run.play, (*inputs, *parts))
        spare[shape] = run
        if len(spare) > 2:  # a block, and the rest after the last whole one
            oldest, *_ = spare
            spare.pop(oldest, None)
        return
    # A single result is written last, element by element: it may share the memory of an input.
    overlap = ["overlap_assume_elementwise"] if len(parts) == 1 else []
    flags: Any = [["readonly", *overlap]] * len(inputs) + [["writeonly", *overlap]] * len(parts)
    mode: Any = ["external_loop", "buffered", "copy_if_overlap"]
    with np.nditer([*inputs, *parts], mode, flags, buffersize=_BLOCK) as blocks:
        for block in blocks:
            _fill(plan, constants, block[: len(inputs)], block[len(inputs) :])


_DOUBLE = np.dtype(np.float64)
# Python numbers have no precision: they do not change that of a float32.
_PYTHONS = (float, int)
_KEPT = (np.ndarray, np.generic, *_PYTHONS)
_LARGEST_SINGLE = float(np.finfo(np.float32).max)


def arrays(inputs: Sequence[Any], names: Sequence[str]) -> tuple[Sequence[np.ndarray], _Real]:
    """The inputs as arrays of one precision, and that precision.

    Raises:
        TypeError: one is no real number.
        ValueError: a number of Python's is too large for the float32 beside it.
    """
    given = [x if isinstance(x, _KEPT) else np.asarray(x) for x in inputs]
    try:
        common = np.result_type(*given)
    except TypeError:  # dates, text
        common = None
    if common is None or common.kind not in "biuf":
        given = list(map(_number, names, inputs))
    if common == np.float32:
        return list(map(_rounded, names, given)), np.float32
    return [np.asarray(x, np.float64) for x in given], np.float64


def check_out(out: Any, shape: tuple[int, ...], precision: _Real) -> None:
    """Require an array that the result fits in."""
    if not isinstance(out, np.ndarray):
        raise TypeError(f"out: expected an array, got {type(out).__name__}")
    if out.shape != shape or out.dtype != precision:
        received = f"{out.shape} of {out.dtype}"
        raise ValueError(f"out: expected shape {shape} of {precision.__name__}, got {received}")


def _number(name: str, x: Any) -> Any:
    """The input, as an array unless it is a number."""
    given = x if isinstance(x, _KEPT) else np.asarray(x)
    kind = getattr(given, "dtype", _DOUBLE)
    if kind.kind not in "biuf":
        of = f" of {kind.type.__name__.rstrip('_')}" if np.shape(given) else ""
        raise TypeError(f"{name}: expected real numbers, got {type(x).__name__}{of}")
    return given


def _rounded(name: str, x: Any) -> np.ndarray:
    if isinstance(x, _PYTHONS):
        if _LARGEST_SINGLE < abs(x) < math.inf:  # as infinity it would turn finite results into NaN
            raise ValueError(f"{name}: expected a number that float32 can hold, got {x}")
        with np.errstate(all="ignore"):
            return np.asarray(x, np.float32)
    return np.asarray(x, np.float32)


def _broadcast(
    inputs: Sequence[Any], names: Sequence[str], vectors: Mapping[str, int]
) -> tuple[Sequence[np.ndarray], _Real, tuple[int, ...]]:
    """The inputs as arrays of one precision, that precision, and their broadcast shape."""
    shape = inputs[0].shape if inputs and type(inputs[0]) is np.ndarray else ()
    for x in inputs:  # mostly these are already arrays of doubles, and of one shape
        if type(x) is not np.ndarray or x.dtype is not _DOUBLE or x.shape != shape:
            break
    else:
        if not vectors:
            return inputs, np.float64, shape
    found, precision = arrays(inputs, names)
    if vectors:
        found = _elements(found, names, vectors)
    return found, precision, np.broadcast_shapes(*(x.shape for x in found))


def _elements(
    inputs: Sequence[np.ndarray], names: Sequence[str], vectors: Mapping[str, int]
) -> list[np.ndarray]:
    """The inputs, with the elements of a vector, its last axis, as inputs of their own."""
    found: list[np.ndarray] = []
    for name, x in zip(names, inputs, strict=True):
        if name in vectors and x.shape[-1:] != (vectors[name],):
            required = f"expected {vectors[name]} values on the last axis"
            raise ValueError(f"{name}: {required}, got shape {x.shape}")
        found.extend(np.moveaxis(x, -1, 0) if name in vectors else [x])
    return found


class _Floats:
    """Python's mathematics under NumPy's names: the same bits, in a tenth of the time for one sample."""

    sqrt = math.sqrt

    @staticmethod
    def sign(x: float) -> float:
        return 1.0 if x > 0.0 else -1.0 if x < 0.0 else x + 0.0

    @staticmethod
    def heaviside(x: float, at_zero: float) -> float:
        return 1.0 if x > 0.0 else 0.0 if x < 0.0 else at_zero if x == 0.0 else x

    @staticmethod
    def exp(x: float) -> float:
        with np.errstate(all="ignore"):  # math.exp has other bits
            return float(np.exp(x))

    @staticmethod
    def minimum(x: float, most: float) -> float:
        return most if x > most else x  # noqa: FURB136 - a call takes longer

    @staticmethod
    def clip(x: float, least: float, most: float) -> float:
        return most if x > most else least if x < least else x  # noqa: FURB136 - a call takes longer

    @staticmethod
    def where(condition: bool, x: float, y: float) -> float:
        return x if condition else y


def _on_floats(kernel: Any) -> Callable[..., Any]:
    """The kernel with `_Floats` for `np`, in itself and in the functions of its module that it calls."""
    names = {**kernel.__globals__, "np": _Floats}

    def copied(function: Any) -> FunctionType:
        for name in function.__code__.co_names:
            value = names.get(name)
            # A function that is already copied has other globals; one with a closure is not a formula.
            if isinstance(value, FunctionType) and value.__globals__ is kernel.__globals__:
                names[name] = value if value.__closure__ else copied(value)
        return FunctionType(function.__code__, names, function.__name__)

    return copied(kernel)


class _Kernel:
    """A kernel f(c, inputs), evaluated on floats and on arrays."""

    def __init__(self, model: Model, kernel: Callable[..., Any], vectors: Mapping[str, int]) -> None:
        self._model, self._kernel, self.vectors = model, kernel, vectors
        self.inputs = list(inspect.signature(kernel).parameters.values())[1:]
        self.names = [x.name for x in self.inputs]
        self.takes_numbers = not vectors.keys() & set(self.names)
        self._lengths = [vectors.get(name) for name in self.names]
        self._on_floats: Callable[..., Any] | None = None  # its callees may not be defined yet
        self._plan = cache(partial(_Plan, kernel, self._lengths))

    def at(self, inputs: Sequence[Any], parameters: Any) -> Any:
        """The kernel at one sample, on Python's own numbers: they are doubles as well, and need no arrays.

        The elements of a vector are inputs of their own.
        """
        if self._on_floats is None:
            self._on_floats = _on_floats(self._kernel)
        prepared = self._model.prepared(parameters, np.float64)
        numbers = map(float, inputs)
        try:
            return self._on_floats(
                prepared.numbers, *(numbers if self.takes_numbers else self._grouped(numbers))
            )
        except (ArithmeticError, ValueError):  # where NumPy has infinity or NaN, Python raises
            plan = self._plan(np.float64, ())
            out = np.empty((plan.width, 1))
            _fill(plan, prepared.constants(plan), [np.array([x], np.float64) for x in inputs], list(out))
            return tuple(out[:, 0].tolist()) if plan.vector else float(out[0, 0])

    def _grouped(self, numbers: Iterator[float]) -> list[Any]:
        """Numbers as a kernel with vectors takes them: the elements of each as a tuple."""
        return [next(numbers) if n is None else tuple(islice(numbers, n)) for n in self._lengths]

    def on_arrays(self, given: Sequence[Any], parameters: Any, out: Any) -> Any:
        """The kernel at all samples of arrays that broadcast, in `out` if there is one."""
        inputs, precision, shape = _broadcast(given, self.names, self.vectors)
        size = math.prod(shape)
        large = size > _BLOCK
        single = tuple(f"x{k}" for k, x in enumerate(inputs) if x.size == 1) if large else ()
        plan = self._plan(precision, single)
        full = (*shape, plan.width) if plan.vector else shape
        if out is not None:
            check_out(out, full, precision)
        if size == 1 and precision is np.float64 and not self.vectors:
            result = np.array(self.at([x.item() for x in inputs], parameters)).reshape(full)
            if out is None:
                return result if full else result[()]
            out[...] = result
            return out
        result = np.empty(full, precision) if out is None else out
        parts = [result[..., k] for k in range(plan.width)] if plan.vector else [result]
        if out is not None and not large:  # longer ones are read block by block, with care
            inputs = [x.copy() if np.may_share_memory(x, out) else x for x in inputs]
        prepared = self._model.prepared(parameters, precision)
        constants = prepared.known.get(plan) or prepared.constants(plan)
        if single:
            copies = [x.copy().reshape(()) for x in inputs if x.size == 1]  # `out` may overlap them
            constants = _computed(plan.in_call, constants | dict(zip(single, copies, strict=True)))
            inputs = [x for x in inputs if x.size > 1]
        _fill(plan, constants, inputs, parts)
        return result if out is not None or full else result[()]


def _described(kernel: Any, meanings: Any) -> str | None:
    """The docstring of a function: that of its kernel, and the meanings of its inputs."""
    _, *names = inspect.signature(kernel).parameters
    if not names or not kernel.__doc__:
        return kernel.__doc__
    inputs = "".join(f"{name}: {meanings[name]}\n" for name in names)
    shape = "The result has the shape of the inputs, broadcast, before any last axis named above."
    return f"{inspect.getdoc(kernel)}\n\n{inputs}\n{shape}\n"


_NUMBERS = {float, int, np.float64}


def _function(
    model: Model, kernel: Callable[..., Any], evaluated: _Kernel, needs: Sequence[str], *, steps: bool
) -> Any:
    """The function f(inputs, parameters=None, out=None), with the name and docstring of the kernel."""
    either = inspect.Parameter.POSITIONAL_OR_KEYWORD
    optional = [inspect.Parameter(name, either, default=None) for name in ("parameters", "out")]
    signature = inspect.Signature([*evaluated.inputs, *optional])
    count, at, on_arrays = len(evaluated.names), evaluated.at, evaluated.on_arrays
    numbers: set[type] = _NUMBERS if evaluated.takes_numbers else set()

    @wraps(kernel)
    def function(*given: Any, parameters: Any = None, out: Any = None, **named: Any) -> Any:
        if len(given) == count + 1 and parameters is None and not named:
            given, parameters = given[:-1], given[-1]
        elif len(given) != count or named:
            given, parameters, out = _ordered(signature, given, parameters, out, named)
        if needs:
            model.require(needs, evaluated.names[-1], given[-1], parameters)
        if steps:
            model.require_solvable(parameters)
        on_floats = not given or type(given[0]) in numbers
        if on_floats and out is None and numbers.issuperset(map(type, given)):
            found = at(given, parameters)
            return np.array(found) if type(found) is tuple else np.float64(found)
        return on_arrays(given, parameters, out)

    function.__doc__ = _described(kernel, model.inputs)
    vars(function)["__signature__"] = signature
    return function


def _ordered(
    signature: inspect.Signature, given: Sequence[Any], parameters: Any, out: Any, named: dict[str, Any]
) -> tuple[tuple[Any, ...], Any, Any]:
    """Inputs, parameters and `out` of any call, in order."""
    named |= {"parameters": parameters} if parameters is not None else {}
    named |= {"out": out} if out is not None else {}
    bound = signature.bind(*given, **named)
    bound.apply_defaults()
    *inputs, parameters, out = bound.arguments.values()
    return tuple(inputs), parameters, out


class Model:
    """What the functions of one model share: the coefficients of its parameters."""

    def __init__(
        self,
        parameters: Callable[[], Any],
        prepare: Callable[[Any, Coefficients], None],
        inputs: Mapping[str, str],
        losses: Callable[[Any], tuple[float, str, Sequence[tuple[str, float]]]] = lambda _: (0.0, "", ()),
    ) -> None:
        self.default, self.inputs, self._losses = parameters(), inputs, losses
        self._solvable: Any = self  # the latest parameters for which a step has one solution
        self._prepare = prepare
        self._by_value = lru_cache(maxsize=64)(self._computed)
        self._kernels: dict[str, _Kernel] = {}
        self._latest: dict[_Real, tuple[Any, _Prepared]] = {}

    def prepared(self, parameters: Any, precision: _Real) -> _Prepared:
        """The coefficients of parameters, by default those of the default.

        Raises:
            TypeError: these are not parameters of this model.
        """
        latest = self._latest.get(precision)
        if latest is None or latest[0] is not parameters:
            self.check(parameters)
            latest = self._latest[precision] = parameters, self._by_value(parameters, precision)
        return latest[1]

    def _computed(self, parameters: Any, precision: _Real) -> _Prepared:
        c = Coefficients(precision)
        self._prepare(parameters or self.default, c)
        return _Prepared(c)

    def check(self, parameters: Any) -> None:
        """Require Parameters of this model, or None; a module that was loaded twice has two such classes."""
        fields = self.default.__dataclass_fields__.keys()
        own = getattr(parameters, "__dataclass_fields__", {}).keys() == fields
        if parameters is not None and (isinstance(parameters, type) or not own):
            received = f"{type(parameters).__module__}.{type(parameters).__qualname__}"
            raise TypeError(f"parameters: expected Parameters of this model, got {received}")

    def require(self, names: Sequence[str], last: str, value: ArrayLike, parameters: Any) -> None:
        """Require the inertia, which has no default, unless the last input is 0 everywhere."""
        self.check(parameters)
        missing = [name for name in names if getattr(parameters or self.default, name) is None]
        if missing and np.any(np.asarray(value) != 0):
            raise ValueError(f"{', '.join(missing)}: expected numbers unless {last} is 0, got None")

    def unsolvable(self, parameters: Any) -> str:
        """Why a time step has no unique solution, "" if it has; friction itself is defined anyway."""
        inertia, unit, losses = self._losses(parameters or self.default)
        for name, loss in losses:
            if loss >= inertia:
                below = f"below the inertia, {inertia:.6g} {unit}"
                return f"{name}: expected acceleration-dependent friction {below}, got {loss:.6g} {unit}"
        return ""

    def require_solvable(self, parameters: Any) -> None:
        """Require parameters for which a time step has one solution."""
        if parameters is not self._solvable:
            self.check(parameters)
            if problem := self.unsolvable(parameters):
                raise ValueError(problem)
            self._solvable = parameters

    def function(
        self,
        kernel: Callable[..., Any] | None = None,
        *,
        needs: Sequence[str] = (),
        vectors: Mapping[str, int] | None = None,
        steps: bool = False,
    ) -> Any:
        """Make a kernel f(c, inputs) a function f(inputs, parameters=None, out=None).

        Args:
            kernel: it returns a number, or a tuple of numbers, which become the last axis.
            needs: parameters without a default that are needed where the last input is not zero.
            vectors: inputs that have an axis of their own, the last one, and its length.
            steps: whether friction may take no more of an acceleration than the inertia.
        """
        if kernel is None:
            return partial(self.function, needs=needs, vectors=vectors, steps=steps)
        evaluated = self._kernels[kernel.__name__] = _Kernel(self, kernel, vectors or {})
        return _function(self, kernel, evaluated, needs, steps=steps)

    def follow(
        self, step: str, initial: Mapping[str, float], inputs: Sequence[ArrayLike], parameters: Any
    ) -> np.ndarray:
        """The hidden states along time, before each sample is used; `step` names their function."""
        kernel = self._kernels[step]
        logged = [name for name in kernel.names if name not in initial]
        numbers = [np.asarray(_number(name, x), np.float64) for name, x in zip(logged, inputs, strict=True)]
        columns = np.broadcast_arrays(*_elements(numbers, logged, kernel.vectors), np.zeros(1))[:-1]
        known = [*initial, *(name for name in logged for _ in range(kernel.vectors.get(name, 1)))]
        order = [at for name in kernel.names for at, own in enumerate(known) if own == name]
        out = np.empty((len(columns[0]), len(initial)))
        state = tuple(initial.values())
        for k, row in enumerate(zip(*(column.tolist() for column in columns), strict=True)):
            out[k] = state
            sample = (*state, *row)
            state = kernel.at([sample[at] for at in order], parameters)
        return out
