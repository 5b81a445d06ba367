"""The targets of a Program: one line for each, a folder for its code, one for its templates.

In: a `Program`. Out: the view that the templates of a target are filled with, all in strings. The folders
have the same names of files: `view` is what the templates see, `printer` the target as a language of
expressions. They share `expression` (an expression in a language), `python` (what modules in Python have in
common) and `backend` (the record of one, and spellings). A back end imports `eccentric.emission.program` and
these, and no other.
"""

from collections.abc import Mapping

from eccentric.emission.backends import c99, jax, numpy
from eccentric.emission.backends.backend import Backend, with_plain_text
from eccentric.emission.backends.c99 import code, decimal, prepared_values, wrapped
from eccentric.emission.backends.expression import UnprintableError

BACKENDS: Mapping[str, Backend] = {
    "numpy": numpy.BACKEND,
    "c99": c99.BACKEND,
    "jax": jax.BACKEND,
}
DEFAULT = ("numpy", "c99")
"""The default back ends; the digest is that of their code."""
