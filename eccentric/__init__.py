"""Friction models of drives that swing an unbalanced mass: derived, emitted, held against measured data.

The pipeline, each stage in the package of its name:

    derive    derivations/*.py         first principles -> Model        (eccentric.model)
    emit      Model -> Program         -> NumPy module, C99             (eccentric.emission, templates/)
    read      log + rig                -> signals                       (logs, rigs, signals)
    fit       signals + Model          -> coefficients, residual        (eccentric.fitting)
    diagnose  residual + effects       -> verdict, extended Model       (search, diagnosis, report)

`eccentric.compile("c2_parallel")` serves the emitted C of a model as a Python module, built by the local
compiler.
`eccentric.virtual_bench` simulates a test bench with code of its own; `eccentric.cli` is the command line.
Imports run one way: model <- emission; logs <- rigs <- signals <- fitting <- search <- diagnosis <- cli.
"""

from typing import Any

import eccentric.started  # noqa: F401 - before anything else

__version__ = "0.1.0"


def __getattr__(name: str) -> Any:
    # SymPy takes longest to import: only who compiles waits for it.
    if name == "compile":
        from eccentric.compiled import compile as function

        return function
    raise AttributeError(f"module 'eccentric' has no attribute {name!r}")
