"""What `import eccentric` offers besides the rooms' own readers: fit, diagnose, emit and bench, with results.

    inputs      logs, rigs and models as a user has them      -> those of the rooms
    fitted      fit        -> FitResult
    diagnosed   diagnose   -> DiagnosisResult
    compared    compare    -> CompareResult
    emitted     emit       -> files
    simulated   bench      -> BenchResult
    tables      ResultTable, Correlation: for a terminal and a notebook

In: paths, tables in memory, mappings. Out: results with named fields, `summary()`, `table()`, `plot()`,
`to_json()`. It may import every room; it decides and computes nothing that belongs to a room. A file is
imported when one of its names is first used.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:  # as in `typing`, which takes longer to import than this file
    from eccentric.api.compared import CompareResult, compare
    from eccentric.api.diagnosed import DiagnosisResult, diagnose
    from eccentric.api.emitted import emit
    from eccentric.api.fitted import FitResult, fit
    from eccentric.api.simulated import BenchResult, bench
    from eccentric.api.tables import Correlation, ResultTable

__all__ = [
    "BenchResult",
    "CompareResult",
    "Correlation",
    "DiagnosisResult",
    "FitResult",
    "ResultTable",
    "bench",
    "compare",
    "diagnose",
    "emit",
    "fit",
]

_FILES = {
    "BenchResult": "simulated",
    "CompareResult": "compared",
    "Correlation": "tables",
    "DiagnosisResult": "diagnosed",
    "FitResult": "fitted",
    "ResultTable": "tables",
    "bench": "simulated",
    "compare": "compared",
    "diagnose": "diagnosed",
    "emit": "emitted",
    "fit": "fitted",
}


def __getattr__(name: str) -> object:
    if name not in _FILES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f"{__name__}.{_FILES[name]}"), name)
