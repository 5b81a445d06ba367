"""Friction models of drives that swing an unbalanced mass: derived, emitted, compared with measured data.

    read_log, read_rig    a file or a table in memory; a file or a mapping     -> Log, Rig
    fit                   logs, rig -> FitResult: estimates with uncertainty, held-out error
    diagnose              logs, rig -> DiagnosisResult: what the model lacks, and the extended model
    compare               logs, rig, models -> CompareResult: their errors on the same rows
    load_model, emit      a derivation -> Model; a Model -> NumPy module and C99 files
    compile               a Model -> a Python module whose functions are the emitted C
    bench                 a virtual test bench: log, rig and truth             -> BenchResult

Bad input raises InputError, with a message of one line. Everything is imported when it is first used.

Inside, each stage has its own packages, called rooms. Imports run one way: a room imports those before it,
through their `__init__`:

    derive    derivations/*.py         first principles -> Model        (model, effects)
    emit      Model -> Program         -> NumPy module, C99             (emission, templates/)
    read      log + rig                -> signals                       (logs, rigs, signals)
    fit       signals + Model          -> coefficients, residual        (fitting)
    diagnose  residual + effects       -> verdict, extended Model       (search, diagnosis, report)
    run       Model -> its C           -> a Python module               (compiled)
    use       all of it                from Python and from a shell     (api, cli)

`virtual_bench` simulates a test bench with its own code.
"""

import eccentric.started  # noqa: F401 - before anything else
from eccentric.version import __version__

TYPE_CHECKING = False
if TYPE_CHECKING:  # as in `typing`, which takes longer to import than this file
    from eccentric.api import (
        BenchResult,
        CompareResult,
        Correlation,
        DiagnosisResult,
        FitResult,
        ResultTable,
        bench,
        compare,
        diagnose,
        emit,
        fit,
    )
    from eccentric.compiled import compile  # noqa: A004 - called as eccentric.compile
    from eccentric.errors import InputError
    from eccentric.logs import Log, read_log
    from eccentric.model import Model, load_model
    from eccentric.rigs import Rig, read_rig

__all__ = [
    "BenchResult",
    "CompareResult",
    "Correlation",
    "DiagnosisResult",
    "FitResult",
    "InputError",
    "Log",
    "Model",
    "ResultTable",
    "Rig",
    "__version__",
    "bench",
    "compare",
    "compile",
    "diagnose",
    "emit",
    "fit",
    "load_model",
    "read_log",
    "read_rig",
]

_ROOMS = {
    "BenchResult": "api",
    "CompareResult": "api",
    "Correlation": "api",
    "DiagnosisResult": "api",
    "FitResult": "api",
    "InputError": "errors",
    "Log": "logs",
    "Model": "model",
    "ResultTable": "api",
    "Rig": "rigs",
    "bench": "api",
    "compare": "api",
    "compile": "compiled",
    "diagnose": "api",
    "emit": "api",
    "fit": "api",
    "load_model": "model",
    "read_log": "logs",
    "read_rig": "rigs",
}
"""The room that defines each name: SymPy and SciPy take seconds to import, so only their users wait."""


def __getattr__(name: str) -> object:
    if name not in _ROOMS:
        raise AttributeError(f"module 'eccentric' has no attribute {name!r}")
    from importlib import import_module

    found = getattr(import_module(f"eccentric.{_ROOMS[name]}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted(__all__)
