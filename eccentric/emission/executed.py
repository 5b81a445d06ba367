"""Execute an emitted NumPy module from memory, with its runtime beside it."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from functools import cache
from itertools import count
from types import ModuleType

_PACKAGE, _RUNTIME = "eccentric_emitted", "eccentric_runtime"
_numbers = count()


def executed(files: Mapping[str, str], name: str) -> ModuleType:
    """A new module from the emitted file of that name, with the runtime emitted beside it."""
    _package(files[f"{_RUNTIME}.py"])
    return _run(f"{_PACKAGE}.{name}_{next(_numbers)}", files[f"{name}.py"])


def executed_beside(module: ModuleType, name: str, source: str) -> ModuleType:
    """A new module from emitted source that imports `name`, such an executed module, from beside it."""
    package = sys.modules[_PACKAGE]
    setattr(package, name, module)
    try:
        return _run(f"{_PACKAGE}.{name}_beside_{next(_numbers)}", source)
    finally:
        delattr(package, name)


@cache
def _package(runtime: str) -> None:
    """Make the package of the modules, with the one runtime that this toolkit emits."""
    package = ModuleType(_PACKAGE)
    package.__path__ = []
    sys.modules[_PACKAGE] = package
    vars(package)[_RUNTIME] = _run(f"{_PACKAGE}.{_RUNTIME}", runtime)


def _run(name: str, source: str) -> ModuleType:
    module = ModuleType(name)
    module.__package__ = _PACKAGE
    # A dataclass with postponed annotations looks its module up during its definition.
    sys.modules[name] = module
    exec(compile(source, f"<{name}.py as emitted>", "exec"), module.__dict__)  # noqa: S102
    return module
