# Generated: do not edit. Written by `make derive` from derivations/c2_parallel.py
# (eccentric 0.1.0, program d1df6cd0).
# Case C2: gravity parallel to the motion plane, steady motion.
"""Case C2: gravity parallel to the motion plane, steady motion.

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
    "regressor",
    "voltage",
]

REGRESSOR = ("B_lN", "C_lN", "B_m", "C_m")
GRADIENT = ("theta_m", "omega_m")
JACOBIAN = ("B_lN", "C_lN", "B_m", "C_m")


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
    B_m: float = 0.0004
    """viscous friction of the motor [N m s/rad], eq. (10)"""
    C_m: float = 0.008
    """Coulomb friction of the motor [N m], eq. (10)"""
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


_OPTIONAL = ("J_m", "J_l")
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
    "B_m": ("a number that is not negative [N m s/rad]", 0.0, _LARGEST),
    "C_m": ("a number that is not negative [N m]", 0.0, _LARGEST),
    "J_m": ("a number that is not negative [kg m^2]", 0.0, _LARGEST),
    "J_l": ("a number that is not negative [kg m^2]", 0.0, _LARGEST),
}


_Real = type[np.float32] | type[np.float64]


class _Coefficients(NamedTuple):
    """What depends on parameters only, in the working precision."""

    B_lN: Any
    B_m: Any
    C_lN: Any
    C_m: Any
    k_i: Any
    scale_N: Any
    fastest: Any
    mu_omega_star: Any
    omega_star_1: Any
    omega_star_2: Any
    turns_per_rad: Any
    period_1: Any
    period_2: Any
    period_3: Any
    period_4: Any
    period_5: Any
    half_mu: Any
    B_lN_mu2_scale_N: Any
    B_m_plus_k_e_k_i_per_R: Any
    C_lN_mu_scale_N: Any
    mu2_scale_N: Any
    mu_scale_N: Any
    C_lN_mu_weight_plus_C_m: Any
    L_M_g_mu2: Any
    J: Any
    B_lN_R_mu2_scale_N_per_k_i: Any
    B_m_R_per_k_i_plus_k_e: Any
    C_lN_R_mu_scale_N_per_k_i: Any
    C_m_R_per_k_i: Any
    R_per_k_i: Any
    L_M_R_g_mu2_per_k_i: Any
    B_lN_mu2_scale_N_per_k_i: Any
    B_m_per_k_i: Any
    per_k_i: Any
    C_lN_mu_scale_N_per_k_i: Any
    C_m_per_k_i: Any
    L_M_g_mu2_per_k_i: Any
    k_i_per_R: Any
    k_e_k_i_per_R: Any
    rounder: Any


class _Pair(NamedTuple):
    """A parameter beyond double precision: high + low, unevaluated, right to some 104 bits."""

    high: float
    low: float


def _exact(x: float) -> _Pair:
    return _Pair(x, 0.0)


def _sum(a: float, b: float) -> _Pair:
    """Add without error."""
    high = a + b
    part = high - a
    return _Pair(high, (a - (high - part)) + (b - part))


def _product(a: float, b: float) -> _Pair:
    """Multiply without error: both factors are split into halves, whose products are exact."""
    high = a * b
    a_scaled, b_scaled = a * 134217729.0, b * 134217729.0
    a_1, b_1 = a_scaled - (a_scaled - a), b_scaled - (b_scaled - b)
    a_2, b_2 = a - a_1, b - b_1
    return _Pair(high, (((a_1 * b_1 - high) + a_1 * b_2) + a_2 * b_1) + a_2 * b_2)


def _plus(x: _Pair, y: _Pair) -> _Pair:
    highs = _sum(x.high, y.high)
    return _sum(highs.high, highs.low + (x.low + y.low))


def _times(x: _Pair, y: _Pair) -> _Pair:
    highs = _product(x.high, y.high)
    return _sum(highs.high, highs.low + (x.high * y.low + x.low * y.high))


def _over(x: _Pair, y: _Pair) -> _Pair:
    quotient = x.high / y.high
    taken = _product(quotient, y.high)
    left = (((x.high - taken.high) - taken.low) + x.low) - quotient * y.low
    return _sum(quotient, left / y.high)


def _root(x: _Pair) -> _Pair:
    root = math.sqrt(x.high)
    taken = _product(root, root)
    left = ((x.high - taken.high) - taken.low) + x.low
    return _sum(root, left / (2.0 * root) if root > 0.0 else 0.0)


def _turn_left(a: float, b: float) -> _Pair:
    """Take a b from 2 pi, where a b is nearly 2 pi."""
    taken = _product(a, b)
    first = _sum(6.283185307179586 - taken.high, -taken.low)
    second = _sum(first.high, 2.4492935982947064e-16)
    return _sum(second.high, second.low + (first.low - 5.989539619436679e-33))


def _leading(x: float, real: _Real) -> float:
    """Take the leading digits of x, so few that a number of turns and a half times them is exact."""
    scaled = x * (8796093022209.0 if real is np.float32 else 1048577.0)
    return scaled - (scaled - x)


class _Prepared(NamedTuple):
    """The coefficients as numbers, for a kernel on Python's own, and as arrays, for its steps."""

    numbers: _Coefficients
    arrays: _Coefficients


@lru_cache(maxsize=64)
def _prepare(parameters: Parameters | None, real: _Real) -> _Prepared:
    p = parameters or _DEFAULT
    J_m = math.nan if p.J_m is None else p.J_m
    J_l = math.nan if p.J_l is None else p.J_l
    weight = _times(_exact(p.g), _plus(_exact(p.M), _exact(p.M_l)))
    critical_squared = _exact(1.0) if p.L * p.M == 0.0 else _over(weight, _times(_exact(p.L), _exact(p.M)))
    omega_star = _exact(1.0) if p.L * p.M == 0.0 else _over(_root(critical_squared), _exact(p.mu))
    scale_N = (
        _over(weight, _times(omega_star, omega_star))
        if p.L * p.M == 0.0
        else _times(_times(_exact(p.L), _exact(p.M)), _times(_exact(p.mu), _exact(p.mu)))
    )
    fastest = 0.0 if p.L * p.M == 0.0 else 1073741824.0
    mu_omega_star = _times(_exact(p.mu), omega_star)
    omega_star_1 = float(real(omega_star.high))
    omega_star_2 = float(real(omega_star.high - omega_star_1 + omega_star.low))
    turns_per_rad = 0.5 * p.mu / 3.1415926535897932
    period_1 = _leading(2.0 * 3.1415926535897932 / p.mu, real)
    period_left = _over(_turn_left(period_1, p.mu), _exact(p.mu))
    period_2 = _leading(period_left.high, real)
    period_rest = period_left.high - period_2 + period_left.low
    period_3 = _leading(period_rest, real) if real is np.float32 else float(real(period_rest))
    period_4 = _leading(period_rest - period_3, real) if real is np.float32 else math.nan
    period_last = period_rest - period_3 - period_4 if real is np.float32 else math.nan
    period_5 = float(real(period_last)) if real is np.float32 else math.nan
    half_mu = 0.5 * p.mu
    B_lN_mu2_scale_N = p.B_lN * p.mu * p.mu * scale_N.high
    B_m_plus_k_e_k_i_per_R = p.B_m + p.k_e * p.k_i / p.R
    C_lN_mu_scale_N = p.C_lN * p.mu * scale_N.high
    mu2_scale_N = p.mu * p.mu * scale_N.high
    mu_scale_N = p.mu * scale_N.high
    C_lN_mu_weight_plus_C_m = p.C_lN * p.mu * weight.high + p.C_m
    L_M_g_mu2 = p.L * p.M * p.g * p.mu * p.mu
    J = J_l * p.mu * p.mu + J_m
    B_lN_R_mu2_scale_N_per_k_i = p.B_lN * p.R * p.mu * p.mu * scale_N.high / p.k_i
    B_m_R_per_k_i_plus_k_e = p.B_m * p.R / p.k_i + p.k_e
    C_lN_R_mu_scale_N_per_k_i = p.C_lN * p.R * p.mu * scale_N.high / p.k_i
    C_m_R_per_k_i = p.C_m * p.R / p.k_i
    R_per_k_i = p.R / p.k_i
    L_M_R_g_mu2_per_k_i = p.L * p.M * p.R * p.g * p.mu * p.mu / p.k_i
    B_lN_mu2_scale_N_per_k_i = p.B_lN * p.mu * p.mu * scale_N.high / p.k_i
    B_m_per_k_i = p.B_m / p.k_i
    per_k_i = 1.0 / p.k_i
    C_lN_mu_scale_N_per_k_i = p.C_lN * p.mu * scale_N.high / p.k_i
    C_m_per_k_i = p.C_m / p.k_i
    L_M_g_mu2_per_k_i = p.L * p.M * p.g * p.mu * p.mu / p.k_i
    k_i_per_R = p.k_i / p.R
    k_e_k_i_per_R = p.k_e * p.k_i / p.R
    with np.errstate(all="ignore"):
        c = _Coefficients(
            B_lN=real(p.B_lN),
            B_m=real(p.B_m),
            C_lN=real(p.C_lN),
            C_m=real(p.C_m),
            k_i=real(p.k_i),
            scale_N=real(scale_N.high),
            fastest=real(fastest),
            mu_omega_star=real(mu_omega_star.high),
            omega_star_1=real(omega_star_1),
            omega_star_2=real(omega_star_2),
            turns_per_rad=real(turns_per_rad),
            period_1=real(period_1),
            period_2=real(period_2),
            period_3=real(period_3),
            period_4=real(period_4),
            period_5=real(period_5),
            half_mu=real(half_mu),
            B_lN_mu2_scale_N=real(B_lN_mu2_scale_N),
            B_m_plus_k_e_k_i_per_R=real(B_m_plus_k_e_k_i_per_R),
            C_lN_mu_scale_N=real(C_lN_mu_scale_N),
            mu2_scale_N=real(mu2_scale_N),
            mu_scale_N=real(mu_scale_N),
            C_lN_mu_weight_plus_C_m=real(C_lN_mu_weight_plus_C_m),
            L_M_g_mu2=real(L_M_g_mu2),
            J=real(J),
            B_lN_R_mu2_scale_N_per_k_i=real(B_lN_R_mu2_scale_N_per_k_i),
            B_m_R_per_k_i_plus_k_e=real(B_m_R_per_k_i_plus_k_e),
            C_lN_R_mu_scale_N_per_k_i=real(C_lN_R_mu_scale_N_per_k_i),
            C_m_R_per_k_i=real(C_m_R_per_k_i),
            R_per_k_i=real(R_per_k_i),
            L_M_R_g_mu2_per_k_i=real(L_M_R_g_mu2_per_k_i),
            B_lN_mu2_scale_N_per_k_i=real(B_lN_mu2_scale_N_per_k_i),
            B_m_per_k_i=real(B_m_per_k_i),
            per_k_i=real(per_k_i),
            C_lN_mu_scale_N_per_k_i=real(C_lN_mu_scale_N_per_k_i),
            C_m_per_k_i=real(C_m_per_k_i),
            L_M_g_mu2_per_k_i=real(L_M_g_mu2_per_k_i),
            k_i_per_R=real(k_i_per_R),
            k_e_k_i_per_R=real(k_e_k_i_per_R),
            rounder=real(1.5 / np.finfo(real).eps),
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


def _sqrt(x: Any) -> Any:
    return math.sqrt(x) if isinstance(x, float) else np.sqrt(x)


def _sign(x: Any) -> Any:
    if isinstance(x, float):
        return 1.0 if x > 0.0 else -1.0 if x < 0.0 else x + 0.0
    return np.sign(x)


def _at_most(x: Any, most: Any) -> Any:
    if isinstance(x, float):
        return most if x > most else x  # noqa: FURB136 - a call takes longer
    return np.minimum(x, most)


def _within(x: Any, most: Any) -> Any:
    if isinstance(x, float):
        return most if x > most else -most if x < -most else x  # noqa: FURB136 - a call takes longer
    return x.tape.step(np.ndarray.clip, x, -most, most)


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


def _single(x: Any) -> bool:
    return isinstance(x, _Value) and x.tape.real is np.float32


def _sine_ratio(half_angle: Any) -> Any:
    """sin(h)/h - 1 for |h| within a quarter turn, a minimax polynomial in h^2; error 1.4e-8 and 4.3e-18."""
    x = half_angle * half_angle
    if _single(x):
        y = 2.60548113e-6 * x - 1.98094749e-4
        y = y * x + 8.33306462e-3
        y = y * x - 1.66666595e-1
    else:
        y = 2.7209972799826466e-15 * x - 7.6429749659503679e-13
        y = y * x + 1.6058939085095993e-10
        y = y * x - 2.5052106860746877e-8
        y = y * x + 2.7557319211008999e-6
        y = y * x - 1.9841269841208492e-4
        y = y * x + 8.3333333333331924e-3
        y = y * x - 1.6666666666666666e-1
    return y * x


def _cosine(half_angle: Any) -> Any:
    """cos(h) for |h| within a quarter turn, a minimax polynomial in h^2; error 4.1e-9 and 1.4e-17."""
    x = half_angle * half_angle
    if _single(x):
        y = -2.60742068e-7 * x + 2.47617292e-5
        y = y * x - 1.38884006e-3
        y = y * x + 4.16666405e-2
        y = y * x - 4.99999995e-1
    else:
        y = 4.6099547638170315e-14 * x - 1.1463008250042011e-11
        y = y * x + 2.0876566590691354e-9
        y = y * x - 2.7557316503307265e-7
        y = y * x + 2.4801587278920885e-5
        y = y * x - 1.3888888888784392e-3
        y = y * x + 4.1666666666664337e-2
        y = y * x - 4.9999999999999982e-1
    return y * x + 1.0


def _from_top(c: _Coefficients, theta_m: Any) -> Any:
    """Motor angle from the nearest top of the link [rad]."""
    # whole turns of the link and a half, up to the top that is nearest
    turns = theta_m * c.turns_per_rad - 0.5 + c.rounder - c.rounder + 0.5
    # the turns go off in parts of few digits: all products but the last are exact
    rest = theta_m - turns * c.period_1
    left = rest - turns * c.period_2 - turns * c.period_3
    reduced = left - turns * c.period_4 - turns * c.period_5 if _single(left) else left
    # bounded for angles so large that nothing is left of their phase; infinity gives NaN
    return _within(reduced, c.period_1)


def _chord(c: _Coefficients, from_top: Any) -> Any:
    """2 sin(half the link angle from the top)/mu."""
    half_angle = from_top * c.half_mu
    return from_top + from_top * _sine_ratio(half_angle)


def _half_sine(c: _Coefficients, from_top: Any) -> Any:
    """Cosine of half the link angle from the top."""
    half_angle = from_top * c.half_mu
    return _cosine(half_angle)


def _normal_force(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
) -> tuple[Any, ...]:
    size = abs(omega_m)
    # magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s]
    speed = _at_most(size, c.fastest)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    from_top = _from_top(c, theta_m)
    chord = _chord(c, from_top)
    q = c.mu_omega_star * speed * chord
    # normal force over scale_N [rad^2/s^2]
    load = _sqrt(square_difference * square_difference + q * q)
    result = load * c.scale_N
    return (result,)


def normal_force(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Normal force F_N on the axis of rotation [N]; shape of the broadcast inputs.

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_normal_force, (theta_m, omega_m), parameters, out, 0)


def _friction_torque(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
) -> tuple[Any, ...]:
    size = abs(omega_m)
    # magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s]
    speed = _at_most(size, c.fastest)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    from_top = _from_top(c, theta_m)
    chord = _chord(c, from_top)
    q = c.mu_omega_star * speed * chord
    # normal force over scale_N [rad^2/s^2]
    load = _sqrt(square_difference * square_difference + q * q)
    direction_of_motion = _sign(omega_m)
    part_1 = omega_m * (c.B_lN_mu2_scale_N * load + c.B_m_plus_k_e_k_i_per_R)
    result = direction_of_motion * (c.C_lN_mu_scale_N * load + c.C_m) + part_1
    return (result,)


def friction_torque(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Resultant friction torque F, back-EMF damping included, eq (6).

    In N m; shape of the broadcast inputs.

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_friction_torque, (theta_m, omega_m), parameters, out, 0)


def _mechanical_friction_torque(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
) -> tuple[Any, ...]:
    size = abs(omega_m)
    # magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s]
    speed = _at_most(size, c.fastest)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    from_top = _from_top(c, theta_m)
    chord = _chord(c, from_top)
    q = c.mu_omega_star * speed * chord
    # normal force over scale_N [rad^2/s^2]
    load = _sqrt(square_difference * square_difference + q * q)
    direction_of_motion = _sign(omega_m)
    part_1 = direction_of_motion * (c.C_lN_mu_scale_N * load + c.C_m)
    result = omega_m * (c.B_lN_mu2_scale_N * load + c.B_m) + part_1
    return (result,)


def mechanical_friction_torque(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Mechanical friction torque f = f_m + mu f_l, without back-EMF.

    In N m; shape of the broadcast inputs.

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_mechanical_friction_torque, (theta_m, omega_m), parameters, out, 0)


def _friction_torque_gradient(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
) -> tuple[Any, ...]:
    size = abs(omega_m)
    # magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s]
    speed = _at_most(size, c.fastest)
    direction_of_motion = _sign(omega_m)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    from_top = _from_top(c, theta_m)
    chord = _chord(c, from_top)
    q = c.mu_omega_star * speed * chord
    # normal force over scale_N [rad^2/s^2]
    load = _sqrt(square_difference * square_difference + q * q)
    half_sine = _half_sine(c, from_top)
    # 1 at the apex, where F_N is 0 and its derivatives are taken as 0
    inverse = _choose(load == 0.0, 1.0, 1.0 / load)
    part_1 = c.mu_omega_star * speed * (q * inverse)
    load_d_theta_m = part_1 * half_sine
    part_3 = c.mu_omega_star * (q * inverse) * chord
    part_2 = part_3 + 2.0 * speed * (square_difference * inverse)
    load_d_omega_m = direction_of_motion * part_2
    part_4 = c.B_lN_mu2_scale_N * omega_m + c.C_lN_mu_scale_N * direction_of_motion
    result_theta_m = load_d_theta_m * part_4
    part_5 = load_d_omega_m * part_4
    result_omega_m = c.B_lN_mu2_scale_N * load + c.B_m_plus_k_e_k_i_per_R + part_5
    return (result_theta_m, result_omega_m)


def friction_torque_gradient(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Partial derivatives of friction_torque with respect to its inputs.

    In N m per rad, rad/s; last axis (theta_m, omega_m).

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_friction_torque_gradient, (theta_m, omega_m), parameters, out, 2)


def _friction_torque_with_gradient(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
) -> tuple[Any, ...]:
    size = abs(omega_m)
    # magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s]
    speed = _at_most(size, c.fastest)
    direction_of_motion = _sign(omega_m)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    from_top = _from_top(c, theta_m)
    chord = _chord(c, from_top)
    q = c.mu_omega_star * speed * chord
    # normal force over scale_N [rad^2/s^2]
    load = _sqrt(square_difference * square_difference + q * q)
    half_sine = _half_sine(c, from_top)
    # 1 at the apex, where F_N is 0 and its derivatives are taken as 0
    inverse = _choose(load == 0.0, 1.0, 1.0 / load)
    part_1 = c.mu_omega_star * speed * (q * inverse)
    load_d_theta_m = part_1 * half_sine
    part_3 = c.mu_omega_star * (q * inverse) * chord
    part_2 = part_3 + 2.0 * speed * (square_difference * inverse)
    load_d_omega_m = direction_of_motion * part_2
    part_4 = omega_m * (c.B_lN_mu2_scale_N * load + c.B_m_plus_k_e_k_i_per_R)
    part_5 = direction_of_motion * (c.C_lN_mu_scale_N * load + c.C_m)
    result_friction_torque = part_4 + part_5
    part_6 = c.B_lN_mu2_scale_N * omega_m + c.C_lN_mu_scale_N * direction_of_motion
    result_theta_m = load_d_theta_m * part_6
    part_7 = load_d_omega_m * part_6
    result_omega_m = c.B_lN_mu2_scale_N * load + c.B_m_plus_k_e_k_i_per_R + part_7
    return (result_friction_torque, result_theta_m, result_omega_m)


def friction_torque_with_gradient(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Friction_torque and its partial derivatives, as a linearisation needs them.

    In N m, N m per rad, rad/s; last axis (friction_torque, theta_m, omega_m).

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_friction_torque_with_gradient, (theta_m, omega_m), parameters, out, 3)


def _friction_torque_jacobian(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
) -> tuple[Any, ...]:
    size = abs(omega_m)
    # magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s]
    speed = _at_most(size, c.fastest)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    from_top = _from_top(c, theta_m)
    chord = _chord(c, from_top)
    q = c.mu_omega_star * speed * chord
    # normal force over scale_N [rad^2/s^2]
    load = _sqrt(square_difference * square_difference + q * q)
    result_B_lN = load * c.mu2_scale_N * omega_m
    direction_of_motion = _sign(omega_m)
    result_C_lN = direction_of_motion * load * c.mu_scale_N
    result_B_m = omega_m
    result_C_m = direction_of_motion
    return (result_B_lN, result_C_lN, result_B_m, result_C_m)


def friction_torque_jacobian(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Partial derivatives of friction_torque with respect to all friction coefficients.

    In N m per unit coefficient; last axis (B_lN, C_lN, B_m, C_m).

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_friction_torque_jacobian, (theta_m, omega_m), parameters, out, 4)


def _regressor(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
) -> tuple[Any, ...]:
    size = abs(omega_m)
    # magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s]
    speed = _at_most(size, c.fastest)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    from_top = _from_top(c, theta_m)
    chord = _chord(c, from_top)
    q = c.mu_omega_star * speed * chord
    # normal force over scale_N [rad^2/s^2]
    load = _sqrt(square_difference * square_difference + q * q)
    result_B_lN = load * c.mu2_scale_N * omega_m
    direction_of_motion = _sign(omega_m)
    result_C_lN = direction_of_motion * load * c.mu_scale_N
    result_B_m = omega_m
    result_C_m = direction_of_motion
    return (result_B_lN, result_C_lN, result_B_m, result_C_m)


def regressor(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Columns: regressor times friction_coefficients is mechanical_friction_torque.

    In N m per unit coefficient; last axis (B_lN, C_lN, B_m, C_m).

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_regressor, (theta_m, omega_m), parameters, out, 4)


def _friction_coefficients(
    c: _Coefficients,
) -> tuple[Any, ...]:
    result_B_lN = c.B_lN
    result_C_lN = c.C_lN
    result_B_m = c.B_m
    result_C_m = c.C_m
    return (result_B_lN, result_C_lN, result_B_m, result_C_m)


def friction_coefficients(
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """What the columns of the regressor multiply.

    In m s/rad, m, N m s/rad, N m; last axis (B_lN, C_lN, B_m, C_m).
    """
    return _evaluate(_friction_coefficients, (), parameters, out, 4)


def _coulomb_torque(
    c: _Coefficients,
) -> tuple[Any, ...]:
    result = c.C_lN_mu_weight_plus_C_m
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
    theta_m: Any,
) -> tuple[Any, ...]:
    from_top = _from_top(c, theta_m)
    chord = _chord(c, from_top)
    half_sine = _half_sine(c, from_top)
    result = (-c.L_M_g_mu2) * chord * half_sine
    return (result,)


def gravity_torque(
    theta_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Gravity torque G, eq (5) [N m]; shape of the broadcast inputs.

    theta_m [rad]: motor angle
    """
    return _evaluate(_gravity_torque, (theta_m,), parameters, out, 0)


def _voltage(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
    alpha_m: Any,
) -> tuple[Any, ...]:
    size = abs(omega_m)
    # magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s]
    speed = _at_most(size, c.fastest)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    from_top = _from_top(c, theta_m)
    chord = _chord(c, from_top)
    q = c.mu_omega_star * speed * chord
    # normal force over scale_N [rad^2/s^2]
    load = _sqrt(square_difference * square_difference + q * q)
    direction_of_motion = _sign(omega_m)
    half_sine = _half_sine(c, from_top)
    part_2 = c.C_lN_R_mu_scale_N_per_k_i * load + c.C_m_R_per_k_i
    part_1 = direction_of_motion * part_2
    part_4 = c.B_lN_R_mu2_scale_N_per_k_i * load + c.B_m_R_per_k_i_plus_k_e
    part_3 = omega_m * part_4
    part_5 = (-c.L_M_R_g_mu2_per_k_i) * chord * half_sine
    part_6 = c.R_per_k_i * _choose(alpha_m == 0.0, 0.0, c.J * alpha_m)
    result = part_1 + part_3 + part_5 + part_6
    return (result,)


def voltage(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    alpha_m: ArrayLike = 0.0,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Armature voltage u = (R/k_i) (J alpha_m + G + F), eq (4) [V]; shape of the broadcast inputs.

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    alpha_m [rad/s^2]: motor acceleration
    """
    _require(("J_m", "J_l"), alpha_m, parameters)
    return _evaluate(_voltage, (theta_m, omega_m, alpha_m), parameters, out, 0)


def _current(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
    alpha_m: Any,
) -> tuple[Any, ...]:
    size = abs(omega_m)
    # magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s]
    speed = _at_most(size, c.fastest)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    from_top = _from_top(c, theta_m)
    chord = _chord(c, from_top)
    q = c.mu_omega_star * speed * chord
    # normal force over scale_N [rad^2/s^2]
    load = _sqrt(square_difference * square_difference + q * q)
    direction_of_motion = _sign(omega_m)
    half_sine = _half_sine(c, from_top)
    part_1 = direction_of_motion * (c.C_lN_mu_scale_N_per_k_i * load + c.C_m_per_k_i)
    part_2 = omega_m * (c.B_lN_mu2_scale_N_per_k_i * load + c.B_m_per_k_i)
    part_3 = c.per_k_i * _choose(alpha_m == 0.0, 0.0, c.J * alpha_m)
    part_4 = (-c.L_M_g_mu2_per_k_i) * chord * half_sine
    result = part_1 + part_2 + part_3 + part_4
    return (result,)


def current(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    alpha_m: ArrayLike = 0.0,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Armature current i = (J alpha_m + G + f)/k_i [A]; shape of the broadcast inputs.

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    alpha_m [rad/s^2]: motor acceleration
    """
    _require(("J_m", "J_l"), alpha_m, parameters)
    return _evaluate(_current, (theta_m, omega_m, alpha_m), parameters, out, 0)


def _mechanical_residual(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
    i: Any,
    alpha_m: Any,
) -> tuple[Any, ...]:
    size = abs(omega_m)
    # magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s]
    speed = _at_most(size, c.fastest)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    from_top = _from_top(c, theta_m)
    chord = _chord(c, from_top)
    q = c.mu_omega_star * speed * chord
    # normal force over scale_N [rad^2/s^2]
    load = _sqrt(square_difference * square_difference + q * q)
    direction_of_motion = _sign(omega_m)
    half_sine = _half_sine(c, from_top)
    part_1 = -direction_of_motion * (c.C_lN_mu_scale_N * load + c.C_m)
    part_2 = -_choose(alpha_m == 0.0, 0.0, c.J * alpha_m)
    part_3 = c.L_M_g_mu2 * chord * half_sine
    part_4 = -omega_m * (c.B_lN_mu2_scale_N * load + c.B_m)
    result = i * c.k_i + part_1 + part_2 + part_3 + part_4
    return (result,)


def mechanical_residual(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    i: ArrayLike,
    alpha_m: ArrayLike = 0.0,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """What the mechanical balance leaves: k_i i - J alpha_m - G - f.

    In N m; shape of the broadcast inputs.

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    i [A]: armature current
    alpha_m [rad/s^2]: motor acceleration
    """
    _require(("J_m", "J_l"), alpha_m, parameters)
    return _evaluate(_mechanical_residual, (theta_m, omega_m, i, alpha_m), parameters, out, 0)


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
