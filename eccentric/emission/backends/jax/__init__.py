"""The JAX module of a Program."""

from eccentric.emission.backends.backend import Backend
from eccentric.emission.backends.jax import view
from eccentric.emission.backends.python.module import banner

BACKEND = Backend({"jax/module.py": "{name}_jax.py"}, view.view, banner)
