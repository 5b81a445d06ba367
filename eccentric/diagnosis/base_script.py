"""The base model as a derivation, where it was given as an object: base.py, which model.py loads.

It has the outcome of a derivation, not its steps: every quantity, definition, term and equation as it is.
"""

from __future__ import annotations

import ast
import keyword
import re
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from enum import Enum
from typing import Any

import sympy as sp
from sympy.printing.str import StrPrinter

import eccentric.model
from eccentric.emission import plain
from eccentric.model import Model, steps

BASE = "base.py"
"""Name of the script beside model.py."""
_WIDTH = 110
_TAKEN = frozenset({*vars(sp), *vars(steps), *vars(eccentric.model), "model", "show"})


def base_source(model: Model) -> str:
    """The text of a Python script whose module-level `model` equals this one.

    Expressions are evaluated when the script runs: an equation that SymPy was kept from simplifying may be
    printed in another form, its value the same.
    """
    writer = _Writer()
    body = writer.text(model, 0)
    symbols = "".join(f"{name} = {sp.srepr(symbol)}\n" for symbol, name in writer.names.items())
    used = {node.id for node in ast.walk(ast.parse(symbols + body)) if isinstance(node, ast.Name)}
    used -= set(writer.names.values())
    of_steps = {name for name in used if isinstance(getattr(steps, name, None), type)}
    return (
        f'"""{plain(model.title)}.\n\nWritten by `eccentric diagnose`: the model that it was given.\n"""\n\n'
        f"{_imports('sympy', used - of_steps - writer.words)}\n"
        f"{_imports('eccentric.model', writer.words)}"
        f"{_imports('eccentric.model.steps', of_steps)}"
        f"from eccentric.output import show\n\n"
        f"{symbols}\n"
        f"model = {body}\n\n"
        'if __name__ == "__main__":\n    show(model)\n'
    )


class _Writer(StrPrinter):
    """Values as source text; symbols by names that are given to them here."""

    def __init__(self) -> None:
        super().__init__({"sympy_integers": True, "full_prec": True})
        self.names: dict[sp.Symbol, str] = {}
        self.words: set[str] = set()

    def text(self, value: Any, indent: int) -> str:
        """The value as source text, its further lines indented."""
        if isinstance(value, Enum):
            self.words.add(type(value).__name__)
            return f"{type(value).__name__}.{value.name}"
        if isinstance(value, sp.Basic | sp.MatrixBase):
            return self.doprint(value)
        if is_dataclass(value):
            name = type(value).__name__
            self.words.add(name)
            given = [(f"{f.name}=", getattr(value, f.name)) for f in fields(value) if not _usual(f, value)]
            return self._joined(f"{name}(", given, ")", indent)
        if isinstance(value, Mapping):
            given = [(f"{self.text(key, 0)}: ", x) for key, x in value.items()]
            return self._joined("{", given, "}", indent)
        if isinstance(value, tuple):
            return self._joined("(", [("", x) for x in value], ",)" if len(value) == 1 else ")", indent)
        return repr(value)

    def _joined(self, head: str, parts: list[tuple[str, Any]], tail: str, indent: int) -> str:
        inner = indent + 4
        shown = [f"{label}{self.text(x, inner)}" for label, x in parts]
        line = f"{head}{', '.join(shown)}{tail}"
        if "\n" not in line and indent + len(line) <= _WIDTH:
            return line
        lines = "".join(f"{' ' * inner}{part},\n" for part in shown)
        return f"{head}\n{lines}{' ' * indent}{tail.lstrip(',')}"

    def _print_Symbol(self, expr: sp.Symbol) -> str:
        if expr not in self.names:
            letters = re.sub(r"\W", "_", expr.name, flags=re.ASCII)
            name = f"_{letters}" if keyword.iskeyword(letters) or not letters.isidentifier() else letters
            while name in _TAKEN or name in self.names.values():
                name += "_"
            self.names[expr] = name
        return self.names[expr]

    _print_Dummy = _print_Symbol

    def _print_Integer(self, expr: sp.Integer) -> str:
        # Where a Python number would do, SymPy takes it; alone it has to be SymPy's.
        return f"S({expr.p})" if self._print_level <= 1 else super()._print_Integer(expr)


def _usual(field: Field[Any], value: Any) -> bool:
    """Whether a field has its default."""
    default = field.default
    if field.default_factory is not MISSING:
        default = field.default_factory()
    return default is not MISSING and bool(getattr(value, field.name) == default)


def _imports(module: str, names: Iterable[str]) -> str:
    names = sorted(names)
    line = f"from {module} import {', '.join(names)}\n"
    if len(line) <= _WIDTH or not names:
        return line if names else ""
    return f"from {module} import (\n{''.join(f'    {name},{chr(10)}' for name in names)})\n"
