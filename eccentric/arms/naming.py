"""Names of arms in code."""

from __future__ import annotations

import re

from eccentric.errors import InputError
from eccentric.model import quantity


def identifier(name: str) -> str:
    """The name of a robot or a file as one in code: letters, digits and underscores, a letter first."""
    plain = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")[:40]
    try:
        quantity(plain, "1", "")
    except InputError:  # a digit first, or a word of C or Python
        return f"arm_{plain}".rstrip("_")
    return plain
