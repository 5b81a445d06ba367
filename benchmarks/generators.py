"""What other generators emit in C for the friction torque of case C2 and its gradient, ready to be measured."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from benchmarks import environment
from benchmarks.cortex_m4 import OPTIMISED, run
from benchmarks.record import progress

HERE = Path(__file__).resolve().parent
FUNCTIONS = ("torque", "gradient")
"""What each generator emits, a file for each: the friction torque, and the torque with both derivatives."""
_PACKAGES = {"CasADi": "casadi", "SymPy cse": "sympy", "SymForce": "symforce"}
T = TypeVar("T")


@dataclass(frozen=True)
class Generated:
    """The C of one generator: torque.c and gradient.c in a folder, in one precision."""

    folder: Path
    real: str
    casadi: bool

    @property
    def result(self) -> str:
        """The type that the functions return."""
        return "int" if self.casadi else "void"

    @property
    def types(self) -> str:
        """The types of their arguments."""
        real = self.real
        return (
            f"(const {real} **, {real} **, long long int *, {real} *, int)"
            if self.casadi
            else f"({real}, {real}, {real} *)"
        )

    @property
    def arguments(self) -> str:
        """The arguments: emitted code writes torque and slopes to `out`, CasADi by its own convention."""
        casadi = f"((const {self.real} *[]){{&x, &y}}, ({self.real} *[]){{out, out + 1, out + 2}}, 0, 0, 0)"
        return casadi if self.casadi else "(x, y, out)"

    def declared(self, function: str) -> str:
        """Its declaration."""
        return f"{self.result} {function}{self.types};"

    def source(self, function: str) -> Path:
        """The file that it is in."""
        return self.folder / f"{function}.c"


FORMS = ("as generated", "-ffast-math")
"""How each is compiled; with -ffast-math the functions of float are forced on what is in float."""


def _options(real: str) -> list[tuple[str, ...]]:
    forced = ("-include", str(HERE / "floats.h")) if real == "float" else ()
    return [OPTIMISED, (*OPTIMISED, "-ffast-math", *forced)]


def measured(
    folder: Path, real: str, measure: Callable[[Generated, tuple[str, ...]], T]
) -> tuple[dict[str, list[T]], list[str]]:
    """Generator -> what `measure` finds with each of the options; and those left out, with the reason."""
    found, left_out = {}, []
    reasons = environment.absent(*_PACKAGES.values())
    for name, package in _PACKAGES.items():
        progress(f"peers: {name}, {real}")
        if package in reasons:
            left_out.append(f"{name}: left out, {reasons[package]}.")
            continue
        emitted = Generated(folder / f"{package}_{real}", real, package == "casadi")
        emitted.folder.mkdir()
        try:
            run(environment.PYTHON, HERE / "peers.py", package, emitted.folder, real)
            found[name] = [measure(emitted, form) for form in _options(real)]
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            left_out.append(f"{name}: left out, {str(error).strip().splitlines()[-1]}.")
    return found, left_out


def as_text(found: Mapping[str, Sequence[Sequence[float]]], k: int) -> str:
    """Number k of every generator, in one line."""
    each = [f"{name} {' / '.join(f'{form[k]:.0f}' for form in forms)}" for name, forms in found.items()]
    return f"{' / '.join(FORMS)}: {'; '.join(each)}" if each else ""


def table(
    heads: Sequence[str], own: Sequence[float], found: Mapping[str, Sequence[Sequence[float]]]
) -> list[str]:
    """All numbers as a Markdown table, a row for each generator and its options."""
    rows = {"emitted": own}
    for name, forms in found.items():
        rows |= {f"{name}, {form}": numbers for form, numbers in zip(FORMS, forms, strict=True)}
    lines = [f"| | {' | '.join(heads)} |", "|---" * (len(heads) + 1) + "|"]
    return lines + [
        f"| {name} | {' | '.join(f'{x:.0f}' for x in numbers)} |" for name, numbers in rows.items()
    ]
