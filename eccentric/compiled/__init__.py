"""The emitted C of a model, built by the local compiler and called from Python as the NumPy module is.

    module     a derivation or Model -> a module of Python: from the cache, else derived, emitted and built
    entry      what the cache keeps of a model: its library, and what is needed to serve it
    lookup     a derivation -> its entry, without executing it: neither SymPy nor the rooms below are imported
    calls      arguments as NumPy takes them -> the C
    compiler   C sources -> a shared library
    view       a Program -> what `templates/compiled/` is filled with: C that Python calls

In: a `Model`, its name or path. Out: a module. It imports `eccentric.places`, `eccentric.output` and
`eccentric.scripts`; only where it has to derive, `eccentric.model` and `eccentric.emission`.
"""

from eccentric.compiled.module import compile  # noqa: A004 - it is called as eccentric.compile

__all__ = ["compile"]
