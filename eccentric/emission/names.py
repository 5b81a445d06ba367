"""Names that are valid for files, a Python module and C functions."""

from __future__ import annotations

import builtins
import keyword
import re
import sys

from eccentric.errors import InputError
from eccentric.model import C_KEYWORDS

# The standard headers of C90 to C23 (ISO/IEC 9899, 7.1.2): a file with such a name would hide them.
_HEADERS = """
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg
    stdatomic stdbit stdbool stdckdint stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar
    wchar wctype
""".split()  # noqa: SIM905 - words are easier to read than a list
# Imports of the emitted module, and the toolkit itself.
_PACKAGES = ("numpy", "eccentric", "eccentric_runtime")
# Windows allows no files with these names, whatever their suffix.
_DEVICES = ("aux", "con", "nul", "prn", *(f"{port}{k}" for port in ("com", "lpt") for k in range(10)))
_TAKEN = {
    "a keyword of C": C_KEYWORDS,
    "a header of C": set(_HEADERS),
    "a keyword of Python": set(keyword.kwlist),
    "a Python built-in": set(dir(builtins)),
    "a Python module": {*sys.stdlib_module_names, *_PACKAGES},
    "a Windows device": set(_DEVICES),
}


def checked_name(name: str, where: str) -> str:
    """The name, if it is valid for files, a Python module and C functions.

    Raises:
        InputError: it is not, or would hide another name; `where` is the source of the name.
    """
    if not isinstance(name, str) or not re.fullmatch(r"[a-z][a-z0-9_]{0,30}", name):
        raise InputError(
            f"{where}: a lower-case C identifier of at most 31 characters is required, received {name!r}"
        )
    taken = next((what for what, names in _TAKEN.items() if name in names), None)
    if taken is not None:
        free = "a lower-case C identifier that C and Python leave free"
        raise InputError(f"{where}: {free} is required, received {name!r}, {taken}")
    return name
