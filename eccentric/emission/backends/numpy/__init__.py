"""The NumPy module of a Program."""

from eccentric.emission.backends.backend import Backend
from eccentric.emission.backends.numpy import view
from eccentric.emission.backends.python.module import banner

BACKEND = Backend(
    {"numpy/module.py": "{name}.py", "numpy/runtime.py": "eccentric_runtime.py"},
    view.view,
    banner,
    single_file={"numpy/single_file.py": "{name}.py"},
)
