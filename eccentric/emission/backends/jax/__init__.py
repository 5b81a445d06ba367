"""The JAX module of a Program."""

from collections.abc import Sequence

from eccentric.emission.backends.backend import Backend
from eccentric.emission.backends.jax import view


def _banner(lines: Sequence[str]) -> str:
    return "".join(f"# {line}\n" for line in lines)


BACKEND = Backend("JAX module", {"jax/module.py": "{name}_jax.py"}, view.view, _banner)
