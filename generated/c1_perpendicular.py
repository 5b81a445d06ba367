# Generated: do not edit. Written by `make derive` from derivations/c1_perpendicular.py
# (eccentric 0.1.0, program 9e7e7bfc).
# Case C1: gravity perpendicular to the motion plane, steady motion.
"""Case C1: gravity perpendicular to the motion plane, steady motion.

Inputs are on the motor side, in SI units; they broadcast, float32 stays float32, and `out` is honoured.
Without parameters the defaults of `Parameters` hold.
A TypeError names what is no real number; a ValueError, what is too large for the float32 beside it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from numbers import Real
from typing import Any, NamedTuple

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike

__all__ = [
    "GRADIENT",
    "JACOBIAN",
    "REGRESSOR",
    "Parameters",
    "coulomb_torque",
    "current",
    "electrical_residual",
    "friction_coefficients",
    "friction_torque",
    "friction_torque_gradient",
    "friction_torque_jacobian",
    "friction_torque_with_gradient",
    "gravity_torque",
    "mechanical_friction_torque",
    "mechanical_residual",
    "normal_force",
    "polynomial",
    "regressor",
    "voltage",
]

REGRESSOR = ("B_lN", "C_lN", "B", "C")
GRADIENT = ("omega_m",)
JACOBIAN = ("B_lN", "C_lN", "B_lT", "C_lT", "B_m", "C_m")


@dataclass(frozen=True)
class Parameters:
    """Parameters with the paper's letters, in SI units; the defaults are Table 1 of the paper with mu = 1/5.

    Real numbers of any type are taken, and kept as floats.

    Raises:
        TypeError: a value is no real number.
        ValueError: a value is not finite, or has a sign that the quantity cannot have.
    """

    M: float = 0.5
    """unbalanced mass [kg], eq. (5)"""
    M_l: float = 0.2
    """mass of the link without M [kg], eq. (15)"""
    L: float = 0.25
    """distance of M from the axis [m], eq. (5)"""
    mu: float = 0.2
    """gear ratio theta_l/theta_m [1], eq. (3)"""
    R: float = 1.0
    """armature resistance [Ohm], eq. (2)"""
    k_i: float = 0.02
    """torque constant [N m/A], eq. (2)"""
    k_e: float = 0.2
    """back-EMF constant [V s/rad], eq. (2)"""
    g: float = 9.81
    """gravitational acceleration [m/s^2], eq. (5)"""
    B_lN: float = 0.004
    """viscous friction of the link per normal force [m s/rad], eq. (9)"""
    C_lN: float = 0.08
    """Coulomb friction of the link per normal force [m], eq. (9)"""
    B_lT: float = 0.004
    """viscous friction of the link per transversal force [m s/rad], eq. (9)"""
    C_lT: float = 0.08
    """Coulomb friction of the link per transversal force [m], eq. (9)"""
    B_m: float = 0.0004
    """viscous friction of the motor [N m s/rad], eq. (10)"""
    C_m: float = 0.008
    """Coulomb friction of the motor [N m], eq. (10)"""
    F_T: float | None = None
    """transversal force of a level plane [N], eq. (9), M_l*g if None"""
    J_m: float | None = None
    """inertia of the motor [kg m^2], eq. (1), needed with alpha_m"""
    J_l: float | None = None
    """inertia of the link about its axis, M L^2 included [kg m^2], eq. (3), needed with alpha_m"""

    def __post_init__(self) -> None:
        for name, (required, lowest, highest) in _DOMAINS.items():
            value = getattr(self, name)
            if value is None and name in _OPTIONAL:
                continue
            if type(value) is not float and not isinstance(value, Real):
                raise TypeError(f"{name}: required {required}, got {type(value).__name__}")
            try:
                number = float(value) + 0.0  # minus zero is zero, too
            except OverflowError:
                raise ValueError(f"{name}: required {required}, got one beyond double precision") from None
            if not lowest <= number <= highest:
                raise ValueError(f"{name}: required {required}, got {number}")
            # What is equal is then the same, as the caches take it to be.
            object.__setattr__(self, name, number)


_OPTIONAL = ("F_T", "J_m", "J_l")
_LARGEST = float(np.finfo(np.float64).max)
_DOMAINS = {
    "M": ("a number that is not negative [kg]", 0.0, _LARGEST),
    "M_l": ("a number that is not negative [kg]", 0.0, _LARGEST),
    "L": ("a number that is not negative [m]", 0.0, _LARGEST),
    "mu": ("a positive number [1]", math.ulp(0.0), _LARGEST),
    "R": ("a positive number [Ohm]", math.ulp(0.0), _LARGEST),
    "k_i": ("a positive number [N m/A]", math.ulp(0.0), _LARGEST),
    "k_e": ("a number that is not negative [V s/rad]", 0.0, _LARGEST),
    "g": ("a number that is not negative [m/s^2]", 0.0, _LARGEST),
    "B_lN": ("a number that is not negative [m s/rad]", 0.0, _LARGEST),
    "C_lN": ("a number that is not negative [m]", 0.0, _LARGEST),
    "B_lT": ("a number that is not negative [m s/rad]", 0.0, _LARGEST),
    "C_lT": ("a number that is not negative [m]", 0.0, _LARGEST),
    "B_m": ("a number that is not negative [N m s/rad]", 0.0, _LARGEST),
    "C_m": ("a number that is not negative [N m]", 0.0, _LARGEST),
    "F_T": ("a number that is not negative [N]", 0.0, _LARGEST),
    "J_m": ("a number that is not negative [kg m^2]", 0.0, _LARGEST),
    "J_l": ("a number that is not negative [kg m^2]", 0.0, _LARGEST),
}


_Real = type[np.float32] | type[np.float64]


class _Coefficients(NamedTuple):
    """What depends on parameters only, in the working precision."""

    B_lN: Any
    C_lN: Any
    k_i: Any
    mu: Any
    L_M_mu2: Any
    B_lN_mu2: Any
    B: Any
    B_plus_k_e_k_i_per_R: Any
    C_lN_mu: Any
    C: Any
    twice_L_M_mu2: Any
    mu2: Any
    F_T_mu2: Any
    F_T_mu: Any
    J: Any
    B_lN_R_mu2_per_k_i: Any
    B_R_per_k_i_plus_k_e: Any
    C_lN_R_mu_per_k_i: Any
    C_R_per_k_i: Any
    R_per_k_i: Any
    B_lN_mu2_per_k_i: Any
    B_per_k_i: Any
    per_k_i: Any
    C_lN_mu_per_k_i: Any
    C_per_k_i: Any
    k_i_per_R: Any
    k_e_k_i_per_R: Any
    B_lN_L_M_mu4: Any
    C_lN_L_M_mu3: Any


class _Prepared(NamedTuple):
    """The coefficients as numbers, for a kernel on Python's own, and as arrays, for its steps."""

    numbers: _Coefficients
    arrays: _Coefficients


@lru_cache(maxsize=64)
def _prepare(parameters: Parameters | None, real: _Real) -> _Prepared:
    p = parameters or _DEFAULT
    F_T = p.M_l * p.g if p.F_T is None else p.F_T
    J_m = math.nan if p.J_m is None else p.J_m
    J_l = math.nan if p.J_l is None else p.J_l
    L_M_mu2 = p.L * p.M * p.mu * p.mu
    B_lN_mu2 = p.B_lN * p.mu * p.mu
    B = p.B_lT * F_T * p.mu * p.mu + p.B_m
    B_plus_k_e_k_i_per_R = B + p.k_e * p.k_i / p.R
    C_lN_mu = p.C_lN * p.mu
    C = p.C_lT * F_T * p.mu + p.C_m
    twice_L_M_mu2 = 2.0 * p.L * p.M * p.mu * p.mu
    mu2 = p.mu * p.mu
    F_T_mu2 = F_T * p.mu * p.mu
    F_T_mu = F_T * p.mu
    J = J_l * p.mu * p.mu + J_m
    B_lN_R_mu2_per_k_i = p.B_lN * p.R * p.mu * p.mu / p.k_i
    B_R_per_k_i_plus_k_e = B * p.R / p.k_i + p.k_e
    C_lN_R_mu_per_k_i = p.C_lN * p.R * p.mu / p.k_i
    C_R_per_k_i = C * p.R / p.k_i
    R_per_k_i = p.R / p.k_i
    B_lN_mu2_per_k_i = p.B_lN * p.mu * p.mu / p.k_i
    B_per_k_i = B / p.k_i
    per_k_i = 1.0 / p.k_i
    C_lN_mu_per_k_i = p.C_lN * p.mu / p.k_i
    C_per_k_i = C / p.k_i
    k_i_per_R = p.k_i / p.R
    k_e_k_i_per_R = p.k_e * p.k_i / p.R
    B_lN_L_M_mu4 = p.B_lN * p.L * p.M * p.mu * p.mu * p.mu * p.mu
    C_lN_L_M_mu3 = p.C_lN * p.L * p.M * p.mu * p.mu * p.mu
    with np.errstate(all="ignore"):
        c = _Coefficients(
            B_lN=real(p.B_lN),
            C_lN=real(p.C_lN),
            k_i=real(p.k_i),
            mu=real(p.mu),
            L_M_mu2=real(L_M_mu2),
            B_lN_mu2=real(B_lN_mu2),
            B=real(B),
            B_plus_k_e_k_i_per_R=real(B_plus_k_e_k_i_per_R),
            C_lN_mu=real(C_lN_mu),
            C=real(C),
            twice_L_M_mu2=real(twice_L_M_mu2),
            mu2=real(mu2),
            F_T_mu2=real(F_T_mu2),
            F_T_mu=real(F_T_mu),
            J=real(J),
            B_lN_R_mu2_per_k_i=real(B_lN_R_mu2_per_k_i),
            B_R_per_k_i_plus_k_e=real(B_R_per_k_i_plus_k_e),
            C_lN_R_mu_per_k_i=real(C_lN_R_mu_per_k_i),
            C_R_per_k_i=real(C_R_per_k_i),
            R_per_k_i=real(R_per_k_i),
            B_lN_mu2_per_k_i=real(B_lN_mu2_per_k_i),
            B_per_k_i=real(B_per_k_i),
            per_k_i=real(per_k_i),
            C_lN_mu_per_k_i=real(C_lN_mu_per_k_i),
            C_per_k_i=real(C_per_k_i),
            k_i_per_R=real(k_i_per_R),
            k_e_k_i_per_R=real(k_e_k_i_per_R),
            B_lN_L_M_mu4=real(B_lN_L_M_mu4),
            C_lN_L_M_mu3=real(C_lN_L_M_mu3),
        )
    return _Prepared(_Coefficients(*map(float, c)), _Coefficients(*map(np.asarray, c)))


class _Value(NDArrayOperatorsMixin):
    """Stands for an array while a kernel is recorded, under the name that it has there."""

    def __init__(self, tape: _Tape, name: str, *, computed: bool = False) -> None:
        self.tape = tape
        self.name = name
        self.computed = computed

    def __array_ufunc__(self, operation: Any, method: str, *operands: Any) -> _Value:
        return self.tape.step(operation, *operands)


class _Tape:
    """What a kernel does, step by step; what is computed already is not computed again."""

    def __init__(self, real: _Real) -> None:
        self.real = real
        self.numbers: dict[float, _Value] = {}
        self.steps: dict[tuple[Any, ...], _Value] = {}

    def name(self, x: Any) -> str:
        if isinstance(x, _Value):
            return x.name
        return self.numbers.setdefault(x, _Value(self, f"n{len(self.numbers)}")).name

    def step(self, operation: Any, *operands: Any) -> _Value:
        key = (operation, *map(self.name, operands))
        if operation is np.multiply and key[1] == key[2]:
            key = (np.square, key[1])  # the same bits, and less to read
        if key not in self.steps:
            self.steps[key] = _Value(self, f"v{len(self.steps)}", computed=True)
        return self.steps[key]


def _sign(x: Any) -> Any:
    if isinstance(x, float):
        return 1.0 if x > 0.0 else -1.0 if x < 0.0 else x + 0.0
    return np.sign(x)


def _choose(condition: Any, x: Any, y: Any) -> Any:
    if isinstance(condition, bool):
        return x if condition else y
    # What is computed stays where it is; only the other is moved.
    if isinstance(x, _Value) and x.computed:
        return condition.tape.step(np.copyto, np.logical_not(condition), y, x)
    return condition.tape.step(np.copyto, condition, x, y)


class _Rooms:
    """Names of buffers, w0, w1, ..., and of masks, m0, m1, ...; what is given back is taken again."""

    def __init__(self) -> None:
        self.made = {"w": 0, "m": 0}
        self.free: dict[str, list[str]] = {"w": [], "m": []}

    def take(self, kind: str) -> str:
        if self.free[kind]:
            return self.free[kind].pop()
        self.made[kind] += 1
        return f"{kind}{self.made[kind] - 1}"

    def give(self, names: set[str]) -> None:
        for name in sorted(names):
            self.free[name[0]].append(name)

    def names(self) -> list[str]:
        return [f"{kind}{k}" for kind, count in self.made.items() for k in range(count)]


_MASKS = (np.greater, np.less, np.less_equal, np.equal, np.logical_not)  # what gives true or false


class _Writer:
    """Steps as lines of Python: calls that leave each result in y0, y1, ... and all else in rooms."""

    def __init__(self, results: list[str]) -> None:
        self.results = results
        self.rooms = _Rooms()
        self.place: dict[str, str] = {}  # of what is computed
        self.lines = list[str]()

    def write(self, steps: dict[tuple[Any, ...], str]) -> None:
        last = {name: k for k, (_, *names) in enumerate(steps) for name in names}
        last |= dict.fromkeys(self.results, len(steps))
        for k, ((operation, *names), value) in enumerate(steps.items()):
            read = [str(self.place.get(name, name)) for name in names]
            ending = {self.place[name] for name in names if name in self.place and last[name] == k}
            how = self.choose if operation is np.copyto else self.compute
            self.place[value] = how(operation, read, ending, value)
        ready = [self.place.get(name, name) for name in self.results]
        self.lines += [f"positive({x}, y{k})" for k, x in enumerate(ready) if x != f"y{k}"]

    def compute(self, operation: Any, read: list[str], ending: set[str], value: str) -> str:
        """Write a call; its result may lie where an operand lies that nobody reads any more."""
        self.rooms.give(ending)
        target = self.result(value) or self.rooms.take("m" if operation in _MASKS else "w")
        named = "out=" if operation is np.minimum else ""  # which by position is deprecated, and slow
        self.lines.append(_call(operation, *read, named + target))
        return target

    def choose(self, _: Any, read: list[str], ending: set[str], value: str) -> str:
        """Write a choice: into its last operand, or into a copy of it where it is needed further on."""
        condition, x, y = read
        # A single result may lie where an input lies: it is written last, and by one step.
        target = self.result(value) if len(self.results) > 1 else ""
        target = target or (y if y in ending and y != x else self.rooms.take("w"))
        self.lines += [f"positive({y}, {target})"] if target != y else []
        self.lines.append(f"copyto({target}, {x}, where={condition})")
        self.rooms.give(ending - {target})
        return target

    def result(self, value: str) -> str:
        return f"y{self.results.index(value)}" if value in self.results else ""


class _Steps(NamedTuple):
    """A kernel as plain calls: a function of inputs, results, buffers and masks, and how many there are."""

    run: Callable[..., Any]
    results: int
    buffers: int
    masks: int
    spare: list[list[np.ndarray]]  # buffers and masks of short arrays that nobody uses at present


@lru_cache(maxsize=256)
def _steps(
    kernel: Callable[..., tuple[Any, ...]], inputs: int, parameters: Parameters | None, real: _Real
) -> _Steps:
    steps = _unbound(kernel, inputs, real)
    with np.errstate(all="ignore"):
        return steps._replace(run=steps.run(_prepare(parameters, real).arrays))


@cache
def _unbound(kernel: Callable[..., tuple[Any, ...]], inputs: int, real: _Real) -> _Steps:
    """Record a kernel and write its steps out as a function that takes the coefficients and gives `run`.

    A loop over the steps would take a quarter longer on short arrays.
    """
    tape = _Tape(real)
    given = [f"x{k}" for k in range(inputs)]
    c = _Coefficients(*(_Value(tape, f"c_{name}") for name in _Coefficients._fields))
    results = [tape.name(x) for x in kernel(c, *(_Value(tape, name) for name in given))]
    ahead = _ahead(tape)
    steps = {step: value.name for step, value in tape.steps.items() if step not in ahead}
    writer = _Writer(results)
    writer.write(steps)
    read = {name for _, *names in tape.steps for name in names}.union(results)
    arrays = [*given, *(f"y{k}" for k in range(len(results))), *writer.rooms.names()]
    text = [
        "def bind(c):",
        *(f"    {name} = c.{name[2:]}" for name in sorted(read) if name.startswith("c_")),
        *(f"    {value.name} = array({_call(*step)})" for step, value in ahead.items()),
        "    def run(arrays):",
        f"        {', '.join(arrays)}, = arrays",
        *(f"        {line}" for line in writer.lines),
        "    return run",
    ]
    known: dict[str, Any] = {operation.__name__: operation for operation, *_ in tape.steps}
    known |= {value.name: np.array(x, real) for x, value in tape.numbers.items()}
    known |= {"positive": np.positive, "array": np.array}
    made = writer.rooms.made
    exec("\n".join(text), known)  # noqa: S102 - our own text
    return _Steps(known["bind"], len(results), made["w"], made["m"], [])


def _ahead(tape: _Tape) -> dict[tuple[Any, ...], _Value]:
    """The steps that hang on coefficients only, which are computed once."""
    known = {f"c_{name}" for name in _Coefficients._fields} | {x.name for x in tape.numbers.values()}
    ahead = dict[tuple[Any, ...], _Value]()
    for (operation, *names), value in tape.steps.items():
        if operation is not np.copyto and known.issuperset(names):
            ahead[operation, *names] = value
            known.add(value.name)
    return ahead


def _call(operation: Any, *names: str) -> str:
    return f"{operation.__name__}({', '.join(names)})"


_BLOCK = 16384  # elements: few enough to stay in the cache, so many that a call costs little for each
_SMALL = 2048  # elements from which on blocks are worth their set-up
_DEFAULT = Parameters()
_NUMBERS = {float, int, np.float64}


def _evaluate(
    kernel: Callable[..., tuple[Any, ...]],
    inputs: tuple[Any, ...],
    parameters: Parameters | None,
    out: np.ndarray | None,
    width: int,
) -> Any:
    """Run the kernel over the broadcast inputs, block by block; width 0 is a scalar result."""
    if parameters is not None:
        _check_kind(type(parameters))
    if out is None and _NUMBERS.issuperset(map(type, inputs)):
        values = _at(kernel, parameters, inputs)
        return np.array(values) if width else np.float64(values[0])
    arrays, real, shape = _broadcast(inputs, kernel)
    full = (*shape, width) if width else shape
    result = np.empty(full, real) if out is None else out
    if out is not None:
        _check_out(out, full, real)
        if out.size <= _SMALL * (width or 1):  # longer ones are read block by block, with care
            arrays = [x.copy() if np.may_share_memory(x, out) else x for x in arrays]
    parts = [result[..., k] for k in range(width)] if width else [result]
    if parts[0].size == 1 and real is np.float64:
        for part, value in zip(parts, _at(kernel, parameters, [x.item() for x in arrays]), strict=True):
            part[...] = value
    else:
        _fill(_steps(kernel, len(arrays), parameters, real), arrays, parts)
    return result if out is not None or full else result[()]


def _broadcast(
    inputs: tuple[Any, ...], kernel: Callable[..., Any]
) -> tuple[Sequence[np.ndarray], _Real, tuple[int, ...]]:
    """The inputs as arrays of one precision, that precision, and the shape that they have together."""
    for x in inputs:  # mostly these are arrays of doubles already, and of one shape
        if type(x) is not np.ndarray or x.dtype is not _DOUBLE or x.shape != inputs[0].shape:
            break
    else:
        return inputs, np.float64, inputs[0].shape if inputs else ()
    arrays, real = _arrays(inputs, kernel.__code__.co_varnames[1:])
    return arrays, real, np.broadcast(*arrays).shape


def _at(kernel: Callable[..., tuple[Any, ...]], parameters: Parameters | None, inputs: Iterable[Any]) -> Any:
    """The kernel at one sample, on Python's own numbers: they are doubles, too, and take no set-up."""
    values = list(map(float, inputs))
    try:
        return kernel(_prepare(parameters, np.float64).numbers, *values)
    except (ArithmeticError, ValueError):  # where NumPy has infinity or NaN, Python raises
        steps = _steps(kernel, len(values), parameters, np.float64)
        out = np.empty((steps.results, 1))
        _fill(steps, [np.array([x]) for x in values], list(out))
        return tuple(out[:, 0].tolist())


_DOUBLE = np.dtype(np.float64)
# Numbers of Python's have no precision of their own: they leave a float32 beside them what it is.
_PYTHONS = (float, int)
_KEPT = (np.ndarray, np.generic, *_PYTHONS)
_LARGEST_SINGLE = float(np.finfo(np.float32).max)


@cache
def _check_kind(kind: type) -> None:
    """Ask for Parameters of this model; a module that was loaded twice has them twice."""
    if getattr(kind, "__dataclass_fields__", {}).keys() != _DOMAINS.keys():
        got = f"{kind.__module__}.{kind.__qualname__}"
        raise TypeError(f"parameters: required Parameters of this model, got {got}")


def _require(names: tuple[str, ...], value: ArrayLike, parameters: Parameters | None) -> None:
    """Ask for the inertia, which has no default, where there is an acceleration."""
    if parameters is not None:
        _check_kind(type(parameters))
    missing = [name for name in names if getattr(parameters or _DEFAULT, name) is None]
    if missing and np.any(np.asarray(value) != 0):
        raise ValueError(f"{', '.join(missing)}: required in Parameters with an acceleration, got None")


def _check_out(out: np.ndarray, shape: tuple[int, ...], real: _Real) -> None:
    if not isinstance(out, np.ndarray):
        raise TypeError(f"out: required an array, got {type(out).__name__}")
    if out.shape != shape or out.dtype != real:
        got = f"{out.shape} of {out.dtype}"
        raise ValueError(f"out: required shape {shape} of {real.__name__}, got {got}")


def _number(name: str, x: Any) -> Any:
    """The input, as an array unless it is a number."""
    given = x if isinstance(x, _KEPT) else np.asarray(x)
    kind = getattr(given, "dtype", _DOUBLE)
    if kind.kind not in "biuf":
        of = f" of {kind.type.__name__.rstrip('_')}" if np.shape(given) else ""
        raise TypeError(f"{name}: required real numbers, got {type(x).__name__}{of}")
    return given


def _arrays(inputs: Sequence[Any], names: Sequence[str]) -> tuple[list[np.ndarray], _Real]:
    """The inputs as arrays of one precision, and that precision."""
    given = [x if isinstance(x, _KEPT) else np.asarray(x) for x in inputs]
    try:
        common = np.result_type(*given)
    except TypeError:  # dates, texts
        common = None
    if common is None or common.kind not in "biuf":
        given = list(map(_number, names, inputs))
    if common == np.float32:
        return list(map(_rounded, names, given)), np.float32
    return [np.asarray(x, np.float64) for x in given], np.float64


def _rounded(name: str, x: Any) -> np.ndarray:
    if isinstance(x, _PYTHONS):
        if _LARGEST_SINGLE < abs(x) < math.inf:  # infinite, it would make a NaN of what is finite
            raise ValueError(f"{name}: required a number that float32 can hold, got {x}")
        with np.errstate(all="ignore"):
            return np.asarray(x, np.float32)
    return np.asarray(x, np.float32)


@np.errstate(all="ignore")
def _fill(steps: _Steps, arrays: Sequence[np.ndarray], parts: list[np.ndarray]) -> None:
    """Fill the parts, block by block if they are large; the buffers are made once."""
    shape, real, size = parts[0].shape or (1,), parts[0].dtype, parts[0].size
    if size <= _SMALL:
        to = [part.reshape(shape) for part in parts] if parts[0].ndim == 0 else parts
        try:
            work = steps.spare.pop()
        except IndexError:
            work = []
        if not work or work[0].shape != shape:
            work = [*np.empty((steps.buffers, *shape), real), *np.empty((steps.masks, *shape), bool)]
        steps.run([*arrays, *to, *work])
        steps.spare.append(work)
        return
    # One result is written last, element by element: it may lie where an input lies.
    overlap = ["overlap_assume_elementwise"] if len(parts) == 1 else []
    flags: Any = [["readonly", *overlap]] * len(arrays) + [["writeonly", *overlap]] * len(parts)
    mode: Any = ["external_loop", "buffered", "copy_if_overlap"]
    room = min(_BLOCK, size)
    work = [*_aligned(steps.buffers, room, real), *np.empty((steps.masks, room), bool)]
    with np.nditer([*arrays, *parts], mode, flags, buffersize=room) as blocks:
        for block in blocks:
            length = len(block[0])
            steps.run([*block, *(work if length == room else [buffer[:length] for buffer in work])])


def _aligned(count: int, size: int, real: np.dtype[Any]) -> np.ndarray:
    """Buffers that start at the lines of the cache, which is a tenth of the time."""
    line = 64 // real.itemsize
    pitch = -(-size // line) * line
    memory = np.empty(count * pitch + line, real)
    start = -memory.ctypes.data % 64 // real.itemsize
    return memory[start : start + count * pitch].reshape(count, pitch)[:, :size]


def _normal_force(
    c: _Coefficients,
    omega_m: Any,
) -> tuple[Any, ...]:
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    result = F_N
    return (result,)


def normal_force(
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Normal force F_N on the axis of rotation [N]; shape of the broadcast inputs.

    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_normal_force, (omega_m,), parameters, out, 0)


def _friction_torque(
    c: _Coefficients,
    omega_m: Any,
) -> tuple[Any, ...]:
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    direction_of_motion = _sign(omega_m)
    part_1 = omega_m * (c.B_lN_mu2 * F_N + c.B_plus_k_e_k_i_per_R)
    result = direction_of_motion * (c.C + c.C_lN_mu * F_N) + part_1
    return (result,)


def friction_torque(
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Resultant friction torque F, back-EMF damping included, eq (6).

    In N m; shape of the broadcast inputs.

    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_friction_torque, (omega_m,), parameters, out, 0)


def _mechanical_friction_torque(
    c: _Coefficients,
    omega_m: Any,
) -> tuple[Any, ...]:
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    direction_of_motion = _sign(omega_m)
    part_1 = direction_of_motion * (c.C + c.C_lN_mu * F_N)
    result = omega_m * (c.B + c.B_lN_mu2 * F_N) + part_1
    return (result,)


def mechanical_friction_torque(
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Mechanical friction torque f = f_m + mu f_l, without back-EMF.

    In N m; shape of the broadcast inputs.

    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_mechanical_friction_torque, (omega_m,), parameters, out, 0)


def _friction_torque_gradient(
    c: _Coefficients,
    omega_m: Any,
) -> tuple[Any, ...]:
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    F_N_d_omega_m = omega_m * c.twice_L_M_mu2
    direction_of_motion = _sign(omega_m)
    part_1 = F_N_d_omega_m * (c.B_lN_mu2 * omega_m + c.C_lN_mu * direction_of_motion)
    result_omega_m = c.B_lN_mu2 * F_N + c.B_plus_k_e_k_i_per_R + part_1
    return (result_omega_m,)


def friction_torque_gradient(
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Partial derivatives of friction_torque with respect to its inputs.

    In N m per rad/s; last axis (omega_m).

    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_friction_torque_gradient, (omega_m,), parameters, out, 1)


def _friction_torque_with_gradient(
    c: _Coefficients,
    omega_m: Any,
) -> tuple[Any, ...]:
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    F_N_d_omega_m = omega_m * c.twice_L_M_mu2
    direction_of_motion = _sign(omega_m)
    part_1 = omega_m * (c.B_lN_mu2 * F_N + c.B_plus_k_e_k_i_per_R)
    result_friction_torque = direction_of_motion * (c.C + c.C_lN_mu * F_N) + part_1
    part_2 = F_N_d_omega_m * (c.B_lN_mu2 * omega_m + c.C_lN_mu * direction_of_motion)
    result_omega_m = c.B_lN_mu2 * F_N + c.B_plus_k_e_k_i_per_R + part_2
    return (result_friction_torque, result_omega_m)


def friction_torque_with_gradient(
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Friction_torque and its partial derivatives, as a linearisation needs them.

    In N m, N m per rad/s; last axis (friction_torque, omega_m).

    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_friction_torque_with_gradient, (omega_m,), parameters, out, 2)


def _friction_torque_jacobian(
    c: _Coefficients,
    omega_m: Any,
) -> tuple[Any, ...]:
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    result_B_lN = F_N * c.mu2 * omega_m
    direction_of_motion = _sign(omega_m)
    result_C_lN = F_N * direction_of_motion * c.mu
    result_B_lT = c.F_T_mu2 * omega_m
    result_C_lT = c.F_T_mu * direction_of_motion
    result_B_m = omega_m
    result_C_m = direction_of_motion
    return (result_B_lN, result_C_lN, result_B_lT, result_C_lT, result_B_m, result_C_m)


def friction_torque_jacobian(
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Partial derivatives of friction_torque with respect to all friction coefficients.

    In N m per unit coefficient; last axis (B_lN, C_lN, B_lT, C_lT, B_m, C_m).

    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_friction_torque_jacobian, (omega_m,), parameters, out, 6)


def _regressor(
    c: _Coefficients,
    omega_m: Any,
) -> tuple[Any, ...]:
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    result_B_lN = F_N * c.mu2 * omega_m
    direction_of_motion = _sign(omega_m)
    result_C_lN = F_N * direction_of_motion * c.mu
    result_B = omega_m
    result_C = direction_of_motion
    return (result_B_lN, result_C_lN, result_B, result_C)


def regressor(
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Columns: regressor times friction_coefficients is mechanical_friction_torque.

    In N m per unit coefficient; last axis (B_lN, C_lN, B, C).

    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_regressor, (omega_m,), parameters, out, 4)


def _friction_coefficients(
    c: _Coefficients,
) -> tuple[Any, ...]:
    result_B_lN = c.B_lN
    result_C_lN = c.C_lN
    result_B = c.B
    result_C = c.C
    return (result_B_lN, result_C_lN, result_B, result_C)


def friction_coefficients(
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """What the columns of the regressor multiply.

    In m s/rad, m, N m s/rad, N m; last axis (B_lN, C_lN, B, C).
    """
    return _evaluate(_friction_coefficients, (), parameters, out, 4)


def _coulomb_torque(
    c: _Coefficients,
) -> tuple[Any, ...]:
    result = c.C
    return (result,)


def coulomb_torque(
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Magnitude of the friction torque at standstill, where it is set-valued.

    In N m; shape of the broadcast inputs.
    """
    return _evaluate(_coulomb_torque, (), parameters, out, 0)


def _gravity_torque(
    c: _Coefficients,
) -> tuple[Any, ...]:
    result = 0.0
    return (result,)


def gravity_torque(
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Gravity torque G, eq (5) [N m]; shape of the broadcast inputs."""
    return _evaluate(_gravity_torque, (), parameters, out, 0)


def _voltage(
    c: _Coefficients,
    omega_m: Any,
    alpha_m: Any,
) -> tuple[Any, ...]:
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    direction_of_motion = _sign(omega_m)
    part_1 = direction_of_motion * (c.C_R_per_k_i + c.C_lN_R_mu_per_k_i * F_N)
    part_2 = omega_m * (c.B_R_per_k_i_plus_k_e + c.B_lN_R_mu2_per_k_i * F_N)
    part_3 = c.R_per_k_i * _choose(alpha_m == 0.0, 0.0, c.J * alpha_m)
    result = part_1 + part_2 + part_3
    return (result,)


def voltage(
    omega_m: ArrayLike,
    alpha_m: ArrayLike = 0.0,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Armature voltage u = (R/k_i) (J alpha_m + G + F), eq (4) [V]; shape of the broadcast inputs.

    omega_m [rad/s]: motor velocity
    alpha_m [rad/s^2]: motor acceleration
    """
    _require(("J_m", "J_l"), alpha_m, parameters)
    return _evaluate(_voltage, (omega_m, alpha_m), parameters, out, 0)


def _current(
    c: _Coefficients,
    omega_m: Any,
    alpha_m: Any,
) -> tuple[Any, ...]:
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    direction_of_motion = _sign(omega_m)
    part_1 = direction_of_motion * (c.C_lN_mu_per_k_i * F_N + c.C_per_k_i)
    part_2 = c.per_k_i * _choose(alpha_m == 0.0, 0.0, c.J * alpha_m)
    part_3 = omega_m * (c.B_lN_mu2_per_k_i * F_N + c.B_per_k_i)
    result = part_1 + part_2 + part_3
    return (result,)


def current(
    omega_m: ArrayLike,
    alpha_m: ArrayLike = 0.0,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Armature current i = (J alpha_m + G + f)/k_i [A]; shape of the broadcast inputs.

    omega_m [rad/s]: motor velocity
    alpha_m [rad/s^2]: motor acceleration
    """
    _require(("J_m", "J_l"), alpha_m, parameters)
    return _evaluate(_current, (omega_m, alpha_m), parameters, out, 0)


def _mechanical_residual(
    c: _Coefficients,
    omega_m: Any,
    i: Any,
    alpha_m: Any,
) -> tuple[Any, ...]:
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    direction_of_motion = _sign(omega_m)
    part_1 = -_choose(alpha_m == 0.0, 0.0, c.J * alpha_m)
    part_2 = -direction_of_motion * (c.C + c.C_lN_mu * F_N)
    result = i * c.k_i - omega_m * (c.B + c.B_lN_mu2 * F_N) + part_1 + part_2
    return (result,)


def mechanical_residual(
    omega_m: ArrayLike,
    i: ArrayLike,
    alpha_m: ArrayLike = 0.0,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """What the mechanical balance leaves: k_i i - J alpha_m - G - f.

    In N m; shape of the broadcast inputs.

    omega_m [rad/s]: motor velocity
    i [A]: armature current
    alpha_m [rad/s^2]: motor acceleration
    """
    _require(("J_m", "J_l"), alpha_m, parameters)
    return _evaluate(_mechanical_residual, (omega_m, i, alpha_m), parameters, out, 0)


def _electrical_residual(
    c: _Coefficients,
    omega_m: Any,
    i: Any,
    u: Any,
) -> tuple[Any, ...]:
    result = -i * c.k_i - c.k_e_k_i_per_R * omega_m + c.k_i_per_R * u
    return (result,)


def electrical_residual(
    omega_m: ArrayLike,
    i: ArrayLike,
    u: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """What the electrical balance leaves, as a torque: (k_i/R)(u - k_e omega_m) - k_i i.

    In N m; shape of the broadcast inputs.

    omega_m [rad/s]: motor velocity
    i [A]: armature current
    u [V]: armature voltage
    """
    return _evaluate(_electrical_residual, (omega_m, i, u), parameters, out, 0)


def _polynomial(
    c: _Coefficients,
) -> tuple[Any, ...]:
    result_F_3 = c.B_lN_L_M_mu4
    result_F_2 = c.C_lN_L_M_mu3
    result_F_1 = c.B_plus_k_e_k_i_per_R
    result_F_0 = c.C
    return (result_F_3, result_F_2, result_F_1, result_F_0)


def polynomial(
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Coefficients F_3, F_2, F_1, F_0 of F for omega_m > 0, eqs (11)-(14).

    In N m s^3/rad^3, N m s^2/rad^2, N m s/rad, N m; last axis (F_3, F_2, F_1, F_0).
    """
    return _evaluate(_polynomial, (), parameters, out, 4)
