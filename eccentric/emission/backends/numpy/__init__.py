"""The NumPy module of a Program."""

from collections.abc import Sequence

from eccentric.emission.backends.backend import Backend
from eccentric.emission.backends.numpy import view


def _banner(lines: Sequence[str]) -> str:
    return "".join(f"# {line}\n" for line in lines)


BACKEND = Backend(
    "NumPy module",
    {"numpy/module.py": "{name}.py", "numpy/runtime.py": "eccentric_runtime.py"},
    view.view,
    _banner,
    single_file={"numpy/single_file.py": "{name}.py"},
)
