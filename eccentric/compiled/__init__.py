"""The emitted C of a model, built by the local compiler and called from Python like the NumPy module.

    module     a derivation or Model -> a Python module: from the cache, else derived, emitted and built;
               its functions take arguments as NumPy accepts them
    entry      what the cache stores for a model, found without executing its derivation; the compiler

In: a `Model`, its name or path. Out: a module. It imports
`eccentric.core`; and `eccentric.model` and `eccentric.emission` only if it has to derive.
"""

from eccentric.compiled.module import compile  # noqa: A004 - called as eccentric.compile
