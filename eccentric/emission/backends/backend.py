"""A back end: a record of what it writes and how, and one line in the registry."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from eccentric.emission.program import Program


@dataclass(frozen=True)
class Backend:
    """A target that programs are printed for.

    Attributes:
        meaning: what it writes, for a list of back ends.
        files: template -> file, such as "numpy/module.py" -> "{name}.py" with the program's name. A file
            without it is the same for all programs.
        view: what the templates are filled with, from a program and the digest of the code as it is spelled
            until it is known. Keys are exactly the names that the templates use; values are strings, numbers,
            truths and collections of them, ready to print: a template computes nothing.
        banner: the lines at the top of every file as a comment of the target.
        single_file: the same, where the others shall carry what is the same for all programs; empty if there
            is no such file.
    """

    meaning: str
    files: Mapping[str, str]
    view: Callable[[Program, str], dict[str, Any]]
    banner: Callable[[Sequence[str]], str]
    single_file: Mapping[str, str] = field(default_factory=dict)

    def written(self, name: str, *, single_file: bool = False) -> dict[str, str]:
        """Template -> file of a program of that name."""
        chosen = self.single_file if single_file and self.single_file else self.files
        return {template: file.format(name=name) for template, file in chosen.items()}
