"""The C99 header and source of a Program."""

from collections.abc import Sequence

from eccentric.emission.backends.backend import Backend
from eccentric.emission.backends.c99 import view
from eccentric.emission.backends.c99.printer import code, decimal, prepared_values, wrapped


def _banner(lines: Sequence[str]) -> str:
    return "".join(["/*\n", *(f" * {line}".rstrip() + "\n" for line in lines), " */\n"])


_FILES = {"c99/header.h": "{name}.h", "c99/arrays.h": "{name}_arrays.h", "c99/source.c": "{name}.c"}
BACKEND = Backend(_FILES, view.view, _banner)
