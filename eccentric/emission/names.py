"""Names that files, a Python module and C functions can have together."""

from __future__ import annotations

import builtins
import keyword
import re
import sys

from sympy.printing.c import reserved_words, reserved_words_c99

from eccentric.errors import InputError

# The standard headers of C90 to C23 (ISO/IEC 9899, 7.1.2): a file of ours with such a name hides theirs.
_HEADERS = """
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg
    stdatomic stdbit stdbool stdckdint stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar
    wchar wctype
""".split()  # noqa: SIM905 - words read better than a list of them
# What the emitted module imports, and the toolkit itself.
_PACKAGES = ("numpy", "eccentric", "eccentric_runtime")
# Windows has no files of these names, whatever their ending.
_DEVICES = ("aux", "con", "nul", "prn", *(f"{port}{k}" for port in ("com", "lpt") for k in range(10)))
_TAKEN = {
    "a keyword of C": {*reserved_words, *reserved_words_c99},
    "a header of C": set(_HEADERS),
    "a keyword of Python": set(keyword.kwlist),
    "a name of Python's own": set(dir(builtins)),
    "a module of Python": {*sys.stdlib_module_names, *_PACKAGES},
    "a device of Windows": set(_DEVICES),
}


def checked_name(name: str, where: str) -> str:
    """The name, if files, a Python module and C functions can be called by it.

    Raises:
        InputError: they cannot, or would hide another; `where` says where the name comes from.
    """
    if not re.fullmatch(r"[a-z][a-z0-9_]{0,30}", name):
        raise InputError(
            f"{where}: required a lower-case C identifier of at most 31 characters, received {name!r}"
        )
    taken = next((what for what, names in _TAKEN.items() if name in names), None)
    if taken is not None:
        free = "a lower-case C identifier that C and Python leave free"
        raise InputError(f"{where}: required {free}, received {name!r}, {taken}")
    return name
