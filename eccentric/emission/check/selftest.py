"""The self-test of an emitted C source: inputs, and the bits of the emitted NumPy module's results."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from types import ModuleType, SimpleNamespace
from typing import Any

import mpmath
import numpy as np

from eccentric.emission.program import ABSENT
from eccentric.model import vocabulary as v


@dataclass(frozen=True)
class Called:
    """One emitted function."""

    name: str  # in NumPy and, behind the model's prefix, in C
    inputs: tuple[str, ...]  # names, in order
    width: int  # number of its values
    scalar: bool  # whether C returns the single value; otherwise it writes to an array
    call: str  # in C, from x[] to out[]
    # of its array function, from ARRAY samples in each of x_n[] to out_n[]; "" without inputs
    array_call: str


SECTIONS, SECTION = 10, 20_000  # generated samples
_ARM_SECTION = 510  # of an arm: a sample costs a hundred times as much; no fewer than the arrays take
# Arrays of a section, and samples in each: a block of an array function, and of the next an odd part, which
# no vector unit takes without a rest.
_ARRAYS, _ARRAY = 10, 51
_VECTORS_BYTES, _NUMBER_BYTES = 45_000, 32  # of text, in both precisions
_LEAST_VECTORS = 4
_STRIDE = 16  # words of a sample of one joint
# Of the library's exponential: what is asked of it, and where.
_EXPONENTIAL_EPS = 2
_EXPONENTS = tuple(
    sign * size for size in (1e-3, 0.1, 0.3, 0.7, 1.0, 2.5, 7.0, 20.0, 60.0) for sign in (-1, 1)
)
# Largest ordinary size of an input, as a power of two.
_SIZES = {"theta_m": 7, "omega_m": 7, "alpha_m": 9, "i": 5, "u": 6}
_OTHER_SIZE = 3


def view(
    module: ModuleType,
    functions: Sequence[Called],
    inputs: list[str],
    values: Mapping[str, float],
    source: str,
    joints: int = 0,
) -> dict[str, Any]:
    """The variables of the templates of self-test and vectors.

    Args:
        module: the emitted NumPy module; the exponential, which no two libraries round alike, is taken out
            of it.
        functions: its functions.
        inputs: names of the model's inputs.
        values: every parameter.
        source: the emitted C.
        joints: of an arm, whose inputs are vectors with an entry for each.
    """
    exponential = re.search(r"\bexpf?\(", source) is not None
    if exponential:
        _without_exponential(module)
    length = joints or 1
    numbers = length * len(inputs) + sum(f.width for f in functions)
    rows = min(64, max(_LEAST_VECTORS, _VECTORS_BYTES // (_NUMBER_BYTES * numbers)))
    section = _ARM_SECTION if joints else SECTION
    stride = _stride(length * len(inputs), max(f.width for f in functions)) if joints else _STRIDE
    single, double = _default(source)
    return {
        "functions": functions,
        "inputs": [f"{x}_{k}" for x in inputs for k in range(joints)] if joints else inputs,
        "joints": joints,
        "single": [k for k, x in enumerate(inputs) if joints and x in NUMBERS],
        "coefficients": list(single),
        "widths": _braces(f.width for f in functions),
        "taken": _braces(f"0x{sum(1 << inputs.index(x) for x in f.inputs):x}u" for f in functions),
        "largest": max(f.width for f in functions),
        "numbers": numbers,
        "rows": rows,
        "kinds": len(_spans(inputs, length)),
        "sections": SECTIONS,
        "section": section,
        "stride": stride,
        "arrays": _ARRAYS,
        "array": _ARRAY,
        "exponentials": len(_EXPONENTS) if exponential else 0,
        "precisions": [
            _precision(real, module, functions, inputs, values, rows, default, joints, section, stride)
            for real, default in ((np.float32, single), (np.float64, double))
        ],
    }


def _default(source: str) -> list[dict[str, float]]:
    """The constant coefficients by name, in single and in double precision: the decimals in the C source."""
    (block,) = re.findall(r"_coefficients \w+_default = {(.*?)};", source, re.DOTALL)
    return [
        {
            name: float(decimal)
            for name, decimal in re.findall(r"\.(\w+) = (?:\(real\)\()?([-+.\w]+)\)?,", part)
        }
        for part in block.replace("ECCENTRIC_NOT_GIVEN", str(ABSENT)).split("#else")
    ]


def _without_exponential(module: ModuleType) -> None:
    """Put 1/(1 + x^2) in place of the exponential, as selftest.c.jinja does."""

    def stand_in(x: Any) -> Any:
        return 1.0 / (1.0 + x * x)

    for name, library in (("np", np), ("math", math)):
        vars(module)[name] = SimpleNamespace(**vars(library) | {"exp": stand_in})


def _exponentials(real: Any) -> list[tuple[Any, Any]]:
    """Numbers of the precision and their exponentials, rounded from 50 digits."""
    with mpmath.workdps(50):
        return [(x, real(mpmath.nstr(mpmath.exp(float(x)), 40))) for x in map(real, _EXPONENTS)]


def _precision(
    real: Any,
    module: ModuleType,
    functions: Sequence[Called],
    inputs: list[str],
    values: Mapping[str, float],
    rows: int,
    default: Mapping[str, float],
    joints: int,
    section: int,
    stride: int,
) -> dict[str, Any]:
    single, length = real is np.float32, joints or 1
    suffix = "f" if single else ""
    zero = _zero_of_force(values)
    spans = np.array(_spans(inputs, length), real)
    centres = np.zeros_like(spans)
    spans[5] = np.finfo(real).tiny * 4
    centres[3:5] = [zero.get(name, 0.0) for name in inputs for _ in range(length)]
    parameters = module.Parameters(**values)

    def evaluated(f: Called, states: Sequence[np.ndarray]) -> np.ndarray:
        """The bits of a function's results: value, sample."""
        columns = {
            x: _argument(x, states[k * length : (k + 1) * length], joints) for k, x in enumerate(inputs)
        }
        values = np.empty((f.width, len(states[0])), real)
        out = values[0] if f.scalar else values.T
        if f.inputs:
            getattr(module, f.name)(*(columns[x] for x in f.inputs), parameters=parameters, out=out)
        else:
            out[...] = getattr(module, f.name)(parameters=parameters)
        return _bits(values)

    names = [name for name in inputs for _ in range(length)]
    special = [_special(k, zero.get(name, 3.0), real)[:rows] for k, name in enumerate(names)]
    vectors = np.vstack([*map(_bits, special), *(evaluated(f, special) for f in functions)]).T
    stream = _stream(centres, spans, section, stride)
    with ThreadPoolExecutor() as threads:  # NumPy works on long arrays beside other threads
        digests = np.column_stack([*threads.map(lambda f: _digests(evaluated(f, stream), stride), functions)])
    return {
        "condition": "if ECCENTRIC_PRECISION == 1" if single else "else",
        "exponential_error": (float(np.finfo(real).eps) * _EXPONENTIAL_EPS).hex() + suffix,
        "exponentials": [_braces(float(x).hex() + suffix for x in row) for row in _exponentials(real)],
        "bits": "uint32_t" if single else "uint64_t",
        "not_a_number": f"0x{int(_bits(np.array([np.nan], real))[0]):x}u",
        "scale": f"0x1p-32{suffix}",
        "half": f"0.5{suffix}",
        "centres": [_braces(float(x).hex() + suffix for x in row) for row in centres],
        "spans": [_braces(float(x).hex() + suffix for x in row) for row in spans],
        "vectors": [_braces(map(hex, row)) for row in vectors.tolist()],
        "default": _braces(map(hex, _bits(np.array([*default.values()], real)).tolist())),
        "digests": [_braces(f"0x{x:08x}u" for x in row) for row in digests],
    }


def _stride(inputs: int, widest: int) -> int:
    """Words of a sample, a power of two: two for each input, and one for each value of the widest result."""
    return 1 << (max(2 * inputs, widest) - 1).bit_length()


NUMBERS = frozenset({v.t.name, v.dt.name})
"""Inputs of an arm that are one number, not one for each joint: the first of as many."""


def _argument(name: str, columns: Sequence[np.ndarray], joints: int) -> np.ndarray:
    """The input that an array each for its entries gives."""
    return np.stack(columns, axis=-1) if joints and name not in NUMBERS else columns[0]


def _zero_of_force(values: Mapping[str, float]) -> dict[str, float]:
    """The zero of F_N: at the top, with the weight carried by the centrifugal force."""
    try:
        M, M_l, L, mu, g = (values[name] for name in ("M", "M_l", "L", "mu", "g"))
    except KeyError:
        return {}
    if M * L == 0:
        return {}
    in_plane = g * math.cos(values.get("phi", 0.0))
    return {"theta_m": math.pi / mu, "omega_m": math.sqrt(in_plane * (M + M_l) / (M * L)) / mu}


def _spans(inputs: list[str], length: int) -> list[list[float]]:
    """Widths of the inputs' ranges, a row per kind of sample, powers of two; 0 is any bits."""
    names = [name for name in inputs for _ in range(length)]
    usual = [2.0 ** (_SIZES.get(name, _OTHER_SIZE) + 1) for name in names]

    def with_angle(span: float) -> list[float]:
        return [span if name == "theta_m" else size for name, size in zip(names, usual, strict=True)]

    nearby, closer, tiny, any_bits = ([x] * len(names) for x in (2.0**-9, 2.0**-19, 1.0, 0.0))
    return [usual, with_angle(2.0**11), with_angle(2.0**15), nearby, closer, tiny, any_bits, with_angle(0.0)]


def _special(k: int, at: float, real: Any) -> np.ndarray:
    """The values of input k in the vectors: hard cases of arithmetic, each input in a different order."""
    limits, centre = np.finfo(real), real(at)
    above, below = np.nextafter(centre, real(np.inf)), np.nextafter(centre, real(0))
    values = np.array([
        0.0, -0.0, 1.0, -2.5, centre, above, below, -centre, 2 * centre, centre / 2, 1e3, 1e4, -1e4, 1e7,
        -1e9, limits.max, -limits.max, limits.tiny, limits.smallest_subnormal, -limits.tiny / 4, np.inf,
        -np.inf, np.nan,
    ], real)  # fmt: skip
    row = np.arange(64)
    return values[((2 * k + 1) * row + (k + 3) * (row // len(values))) % len(values)]


def _stream(centres: np.ndarray, spans: np.ndarray, section: int, stride: int) -> list[np.ndarray]:
    """The generated samples, an array per input: what `generated` in selftest.c.jinja computes."""
    columns = []
    for k in range(spans.shape[1]):
        unit, word = _drawn(k, spans.dtype, section, stride)
        # Not by `resize`, which joins as many arrays.
        copies = -(-len(unit) // len(spans))
        centre, span = (np.tile(table[:, k], copies)[: len(unit)] for table in (centres, spans))
        columns.append(np.where(span == 0, word, centre + unit * span))
    return columns


@cache
def _drawn(k: int, real: np.dtype, section: int, stride: int) -> tuple[np.ndarray, np.ndarray]:
    """The sources of input k of every sample: a number from -1/2 to 1/2, and arbitrary bits as a number."""
    high, low = _words(2 * k, section, stride), _words(2 * k + 1, section, stride)
    scale = real.type(2.0**-32)
    unit = high.astype(real) * scale + low.astype(real) * scale * scale
    word = high if real.itemsize == 4 else (low.astype(np.uint64) << np.uint64(32)) | high
    return unit - real.type(0.5), word.view(real)


@cache
def _words(k: int, section: int, stride: int) -> np.ndarray:
    """Pseudo-random word k of every generated sample."""
    x = np.arange(SECTIONS * section, dtype=np.uint32) * np.uint32(stride) + np.uint32(k)
    x = (x ^ (x >> np.uint32(16))) * np.uint32(0x7FEB352D)
    x = (x ^ (x >> np.uint32(15))) * np.uint32(0x846CA68B)
    return x ^ (x >> np.uint32(16))


def _bits(values: np.ndarray) -> np.ndarray:
    """The bits of the values, in place; a NaN has one pattern: sign and payload depend on the processor."""
    single = values.dtype == np.float32
    bits = values.view(np.uint32 if single else np.uint64)
    bits[np.isnan(values)] = 0x7FC00000 if single else 0x7FF8000000000000
    return bits


def _digests(values: np.ndarray, stride: int) -> np.ndarray:
    """One number per section of the samples: a sum, each word times an odd factor of its place."""
    parts = values.dtype.itemsize // 4  # a double is two words, the lower one first
    words = values.astype(f"<u{4 * parts}", copy=False).view("<u4").reshape(len(values), SECTIONS, -1)
    total = np.zeros(SECTIONS, np.uint32)
    for j, section in enumerate(words):
        total += np.einsum("sn,sn->s", section, _factors(j, parts, section.shape[1] // parts, stride))
    return total


@cache
def _factors(j: int, parts: int, section: int, stride: int) -> np.ndarray:
    """The factors of the words of value j, section by section."""
    first = _words(j, section, stride) | np.uint32(1)
    return np.stack([first + np.uint32(2 * part) for part in range(parts)], axis=-1).reshape(SECTIONS, -1)


def _braces(items: Iterable[object]) -> str:
    return "{" + ", ".join(map(str, items)) + "}"
