"""Names that a quantity cannot have: it is a member of a structure in C and C++, an attribute in Python."""

from __future__ import annotations

import keyword
import re

from eccentric.errors import InputError

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
# Macros of float.h, math.h and stddef.h, those of compilers in GNU dialects, and functions that are called.
_MACROS = frozenset(
    """
    FLT_EVAL_METHOD FLT_RADIX FLT_ROUNDS HUGE_VAL HUGE_VALF HUGE_VALL INFINITY NAN NULL offsetof
    MAXFLOAT M_1_PI M_2_PI M_2_SQRTPI M_E M_LN10 M_LN2 M_LOG10E M_LOG2E M_PI M_PI_2 M_PI_4 M_SQRT1_2
    M_SQRT2 i386 linux unix
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
    """Raise InputError unless the name is an identifier that C, C++ and Python leave free.

    `what` it is the name of opens the message.
    """
    if not re.fullmatch(rf"[A-Za-z][A-Za-z0-9_]{{0,{LONGEST - 1}}}", name):
        raise InputError(
            f"{what}: a name of at most {LONGEST} ASCII letters, digits and _ that begins with a letter is"
            f" required, received {name!r}"
        )
    taken = next((kind for kind, names in _TAKEN.items() if name in names), None)
    if taken is None and _PREFIXES.match(name):
        taken = "which begins as macros of C or of the emitted code"
    if taken is not None:
        raise InputError(
            f"{what}: a name that C, C++ and Python leave free is required, received {name!r}, {taken}"
        )
