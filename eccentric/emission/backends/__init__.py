"""The targets of a Program: a folder for the code of each, one for its templates.

In: a `Program`. Out: the view that the templates of a target are filled with, all in strings. The folders
have the same names of files: `view` is what the templates see, `printer` the target as a language of
expressions. They share `expression` (an expression in a language), `python` (what modules in Python have in
common) and `backend` (the record of one, and spellings). A back end imports `eccentric.emission.program` and
these, and no other. It is registered by a line in `eccentric/core/targets.py`.
"""

from collections.abc import Mapping
from importlib import import_module

from eccentric.core import TARGETS
from eccentric.emission.backends.backend import Backend, with_plain_text
from eccentric.emission.backends.c99 import code, decimal, prepared_values, wrapped
from eccentric.emission.backends.python.dialect import Language, UnprintableError, printed

BACKENDS: Mapping[str, Backend] = {name: import_module(f"{__name__}.{name}").BACKEND for name in TARGETS}
DEFAULT = tuple(name for name, target in TARGETS.items() if target.default)
"""The default back ends; the digest is that of their code."""
