"""The C that other generators emit for the friction torque of case C2 and its derivatives, in a folder.

Run by benchmarks/generators.py in a separate environment: python benchmarks/peers.py GENERATOR FOLDER REAL
Each is given the paper's (15)-(25) with the numbers of Table 1, as its manual shows, and writes torque.c and
gradient.c (torque with both first derivatives), in the precision REAL: float or double.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any


def torque(theta: Any, omega: Any, of: Any) -> Any:
    """The friction torque as the paper writes it; `of` brings sqrt, cos and sign."""
    M, M_l, L, mu, g = 0.5, 0.2, 0.25, 0.2, 9.81
    a, b = M * L * mu**2 * omega**2, (M + M_l) * g
    normal_force = of.sqrt(a**2 + b**2 + 2 * a * b * of.cos(mu * theta))
    sign = of.sign(omega)
    link = mu * normal_force * (0.004 * mu * omega + 0.08 * sign)
    return link + (4e-4 + 0.02 * 0.2 / 1.0) * omega + 0.008 * sign


def differentiated() -> tuple[tuple[Any, Any], Any, list[Any]]:
    """SymPy's symbols of angle and velocity, the friction torque, and its derivatives by both."""
    import sympy as sp

    theta, omega = sp.symbols("theta omega", real=True)
    F = torque(theta, omega, sp)
    return (theta, omega), F, [F.diff(theta), F.diff(omega).subs(sp.DiracDelta(omega), 0)]


def casadi(folder: Path, real: str) -> None:
    """CasADi's C code generator."""
    import casadi as ca  # pyright: ignore[reportMissingImports]

    theta, omega = ca.SX.sym("theta"), ca.SX.sym("omega")
    F = torque(theta, omega, ca)
    for name, results in (
        ("torque", [F]),
        ("gradient", [F, *ca.vertsplit(ca.gradient(F, ca.vertcat(theta, omega)))]),
    ):
        function = ca.Function(name, [theta, omega], results)
        generator = ca.CodeGenerator(f"{name}.c", {"casadi_real": real, "with_header": False})
        generator.add(function)
        generator.generate(f"{folder}/")


def sympy(folder: Path, real: str) -> None:
    """SymPy: cse, then its C printer."""
    _, F, slopes = differentiated()
    _with_printer(folder, real, {"torque": [F], "gradient": [F, *slopes]})


def symforce(folder: Path, real: str) -> None:
    """SymForce's expressions and cse, printed like SymPy's: its own back end writes C++."""
    import symforce  # pyright: ignore[reportMissingImports]

    symforce.set_epsilon_to_number(0.0)
    import symforce.symbolic as sf  # pyright: ignore[reportMissingImports]
    import sympy as sp

    theta, omega = sf.symbols("theta omega")
    F = torque(theta, omega, sf)
    results = {"torque": [F], "gradient": [F, F.diff(theta), F.diff(omega)]}
    plain = {
        name: [sp.sympify(str(e).replace("Heaviside", "heaviside")) for e in es]
        for name, es in results.items()
    }
    _with_printer(folder, real, plain)


def _with_printer(folder: Path, real: str, results: dict[str, list[Any]]) -> None:
    import sympy as sp
    from sympy.codegen import ast
    from sympy.printing.c import C99CodePrinter

    printer = C99CodePrinter(
        {"type_aliases": {ast.real: {"float": ast.float32, "double": ast.float64}[real]}}
    )
    for name, expressions in results.items():
        steps, outs = sp.cse(expressions)
        lines = [f"const {real} {s} = {printer.doprint(e)};" for s, e in steps]
        lines += [f"out[{k}] = {printer.doprint(e)};" for k, e in enumerate(outs)]
        body = "\n".join(f"    {line}" for line in lines)
        text = f"#include <math.h>\nvoid {name}({real} theta, {real} omega, {real} *out)\n{{\n{body}\n}}\n"
        (folder / f"{name}.c").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    {"casadi": casadi, "sympy": sympy, "symforce": symforce}[sys.argv[1]](Path(sys.argv[2]), sys.argv[3])
