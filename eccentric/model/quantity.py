"""Quantities: a SymPy symbol with its name in code, unit, meaning and the paper's equation number."""

from __future__ import annotations

import keyword
import re
from dataclasses import dataclass

import sympy as sp

from eccentric.core import InputError

LONGEST = 63  # characters of a name that a C compiler must tell apart (ISO/IEC 9899, 5.2.4.1)
# ISO/IEC 9899:2024, 6.4.1, and ISO/IEC 14882:2020, 5.11, but for those that begin with an underscore.
C_KEYWORDS = frozenset(
    """
    alignas alignof auto bool break case char const constexpr continue default do double else enum
    extern false float for goto if inline int long nullptr register restrict return short signed
    sizeof static static_assert struct switch thread_local true typedef typeof typeof_unqual union
    unsigned void volatile while
    """.split()  # noqa: SIM905 - words are easier to read than a list
)
CPP_KEYWORDS = frozenset(
    """
    and and_eq asm bitand bitor catch char16_t char32_t char8_t class co_await co_return co_yield
    compl concept const_cast consteval constinit decltype delete dynamic_cast explicit export friend
    mutable namespace new noexcept not not_eq operator or or_eq private protected public
    reinterpret_cast requires static_cast template this throw try typeid typename using virtual
    wchar_t xor xor_eq
    """.split()  # noqa: SIM905 - words are easier to read than a list
)
# Object-like macros of C headers and of compilers in GNU dialects, and called functions: a model's header may
# be included after any other, such as complex.h, whose I is the imaginary unit.
_MACROS = frozenset(
    """
    FLT_EVAL_METHOD FLT_RADIX FLT_ROUNDS HUGE_VAL HUGE_VALF HUGE_VALL INFINITY NAN NULL offsetof
    MAXFLOAT M_1_PI M_2_PI M_2_SQRTPI M_E M_LN10 M_LN2 M_LOG10E M_LOG2E M_PI M_PI_2 M_PI_4 M_SQRT1_2
    M_SQRT2 i386 linux unix
    I complex imaginary EOF BUFSIZ stdin stdout stderr errno
    FP_FAST_FMA FP_ILOGB0 FP_ILOGBNAN FP_INFINITE FP_NAN FP_NORMAL FP_SUBNORMAL FP_ZERO
    """.split()  # noqa: SIM905 - words are easier to read than a list
)
_CALLED = frozenset(
    f"{name}{ending}" for name in ("cos", "exp", "fabs", "sin", "sqrt") for ending in ("", "f")
)
_TAKEN = {
    "a keyword of C": C_KEYWORDS,
    "a keyword of C++": CPP_KEYWORDS,
    "a keyword of Python": frozenset(keyword.kwlist),
    "a macro of C": _MACROS,
    "a function of C": _CALLED,
    "the working precision of the emitted C": frozenset({"real"}),
}
_PREFIXES = re.compile(r"(DBL|FLT|LDBL|REAL|ECCENTRIC)_|REAL$")


def require_free(name: str, what: str = "quantity") -> None:
    """Raise InputError unless the name is an identifier that is free in C, C++ and Python.

    `what` begins the message.
    """
    if not re.fullmatch(rf"[A-Za-z][A-Za-z0-9_]{{0,{LONGEST - 1}}}", name):
        raise InputError(
            what,
            (f"a name of at most {LONGEST} ASCII letters, digits and _ that begins with a letter"),
            f"{name!r}",
        )
    taken = next((kind for kind, names in _TAKEN.items() if name in names), None)
    if taken is None and _PREFIXES.match(name):
        taken = "which begins as macros of C or of the emitted code"
    if taken is not None:
        raise InputError(what, "a name that C, C++ and Python leave free", f"{name!r}, {taken}")


_ASSUMPTIONS = {
    "positive": {"positive": True},
    "nonnegative": {"nonnegative": True},
    "real": {"real": True},
    "tilt": {"nonnegative": True},  # 0 to a right angle
}


@dataclass(frozen=True)
class Quantity:
    """A symbol of the vocabulary.

    Attributes:
        symbol: the SymPy symbol; its name is the name in NumPy and C.
        unit: SI unit, e.g. "N m s/rad"; "1" for a pure number.
        meaning: a short description.
        equation: the paper's equation number, "" where the paper has none.
        domain: of valid values: "positive", "nonnegative", "real" or "tilt" (0 to a right angle).
        default: the paper's value as a decimal, or an expression in other parameters; None if there is none.
        letter: its symbol in a formula, if different from its name: "eta_2", "B_m^+", "Delta t", "i^'".
        part_of: the declared quantity that it is a fraction of, else None; with an added mass it applies to
            the declared part only.
    """

    symbol: sp.Symbol
    unit: str
    meaning: str
    equation: str = ""
    domain: str = "real"
    default: sp.Expr | None = None
    letter: str = ""
    part_of: sp.Symbol | None = None

    @property
    def name(self) -> str:
        """The name in code."""
        return self.symbol.name


def quantity(
    name: str,
    unit: str,
    meaning: str,
    equation: str = "",
    domain: str = "real",
    default: str | sp.Expr | None = None,
    letter: str = "",
    part_of: Quantity | None = None,
) -> Quantity:
    """Create a quantity; a decimal default such as "0.25" is converted exactly (1/4).

    Raises:
        InputError: the name is not an identifier, or is reserved in C, C++ or Python.
        ValueError: the domain is unknown.
    """
    require_free(name)
    if domain not in _ASSUMPTIONS:
        raise ValueError(f"{name}: domain: expected one of {', '.join(_ASSUMPTIONS)}, got {domain!r}")
    value = sp.Rational(default) if isinstance(default, str) else default
    symbol, declared = sp.Symbol(name, **_ASSUMPTIONS[domain]), None if part_of is None else part_of.symbol
    return Quantity(symbol, unit, meaning, equation, domain, value, letter, declared)


def symbols(*quantities: Quantity) -> tuple[sp.Symbol, ...]:
    """The symbols of several quantities."""
    return tuple(quantity.symbol for quantity in quantities)


@dataclass(frozen=True)
class Definition:
    """A quantity defined by others."""

    quantity: Quantity
    value: sp.Expr

    @property
    def symbol(self) -> sp.Symbol:
        """The symbol defined."""
        return self.quantity.symbol


@dataclass(frozen=True)
class State:
    """A hidden state, advanced in time by the caller.

    Attributes:
        quantity: its name and unit.
        initial: value before the first sample.
        update: value one sample later, in inputs, parameters, definitions, states and the time step dt.
    """

    quantity: Quantity
    initial: sp.Expr
    update: sp.Expr

    @property
    def symbol(self) -> sp.Symbol:
        """The symbol of the state."""
        return self.quantity.symbol
