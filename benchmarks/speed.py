"""Time of the emitted NumPy module and of the compiled C beside its peers, case C2, paired in one run.

Run: python benchmarks/speed.py [--quick]     (peers are installed with pip into build/bench-env)
Every round measures all in turn, as processor time on one core; told are the medians over the rounds.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
import venv
from collections.abc import Callable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
from benchmarks.peers import torque  # noqa: E402

SIZES = (1, 100, 10_000, 1_000_000)
PEERS = ("lambdify(cse)", "naive NumPy", "numexpr", "numba", "JAX")
OURS, COMPILED = "emitted NumPy", "emitted C, compiled"
_NEEDED = ("numpy", "sympy", "jinja2", "numexpr", "numba", "jax")
_SINGLE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "NUMEXPR_NUM_THREADS", "NUMBA_NUM_THREADS"), "1") | {
    "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
}


def measured(quick: bool) -> dict[str, Any]:
    """{"torque": {size: {name: ns an element}}, "gradient": ..., "float": ns of a call, "absent": reasons}."""
    environment = ROOT / "build" / "bench-env"
    python = environment / "bin" / "python"
    if not python.exists():
        venv.create(environment, with_pip=True)
    absent = {}
    for package in _NEEDED:
        known = subprocess.run([python, "-c", f"import {package}"], capture_output=True, check=False)
        if known.returncode:
            command = [python, "-m", "pip", "install", "-q", "--disable-pip-version-check", package]
            try:
                subprocess.run(command, capture_output=True, check=True, timeout=300)
            except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
                absent[package] = type(error).__name__
    command = [python, __file__, "--worker", *(["--quick"] if quick else [])]
    done = subprocess.run(
        command, capture_output=True, text=True, check=True, env=os.environ | _SINGLE_THREAD, cwd=ROOT
    )
    return json.loads(done.stdout.splitlines()[-1]) | {"absent": absent}


def _contenders() -> dict[str, dict[str, Callable[..., Any]]]:
    """{"torque": {name: function of angle and velocity}, "gradient": ...}: what is there of the peers."""
    import numpy as np
    import sympy as sp

    import eccentric
    from eccentric.model.load import load_model
    from generated import c2_parallel

    theta, omega = sp.symbols("theta omega", real=True)
    F = torque(theta, omega, sp)
    slopes = [F.diff(theta), F.diff(omega).replace(sp.DiracDelta, lambda *_: sp.Integer(0))]
    compiled = eccentric.compile(load_model("c2_parallel"))
    lambdified = sp.lambdify((theta, omega), F, "numpy", cse=True)
    found: dict[str, dict[str, Callable[..., Any]]] = {
        "torque": {
            OURS: c2_parallel.friction_torque,
            COMPILED: compiled.friction_torque,
            "lambdify(cse)": lambdified,
            "naive NumPy": lambda x, y: torque(x, y, np),
        },
        "gradient": {
            OURS: c2_parallel.friction_torque_gradient,
            COMPILED: compiled.friction_torque_gradient,
            "lambdify(cse)": sp.lambdify((theta, omega), slopes, "numpy", cse=True),
        },
    }
    for name, make in {
        "numexpr": lambda: _numexpr(F),
        "numba": lambda: _numba(lambdified),
        "JAX": _jax,
    }.items():
        try:
            found["torque"][name] = make()
        except ImportError:
            print(f"{name}: not installed", file=sys.stderr)
    return found


def _numexpr(F: Any) -> Callable[..., Any]:
    import numexpr
    import sympy as sp

    omega = next(s for s in F.free_symbols if s.name == "omega")
    sign = sp.Symbol("where(omega > 0, 1, where(omega < 0, -1, 0))")
    text = str(F.subs(sp.sign(omega), sign))
    return lambda x, y: numexpr.evaluate(text, {"theta": x, "omega": y})


def _numba(lambdified: Any) -> Callable[..., Any]:
    import numba
    import numpy as np

    one = numba.njit(lambdified)

    @numba.njit
    def loop(x: Any, y: Any) -> Any:
        out = np.empty_like(x)
        for k in range(x.size):
            out[k] = one(x[k], y[k])
        return out

    return loop


def _jax() -> Callable[..., Any]:
    import jax

    jax.config.update("jax_enable_x64", True)
    compiled = jax.jit(lambda x, y: torque(x, y, jax.numpy))
    return lambda x, y: compiled(x, y).block_until_ready()


def _work(quick: bool) -> dict[str, Any]:
    import numpy as np

    found, generator, rounds = _contenders(), np.random.default_rng(5), 5 if quick else 15
    result: dict[str, Any] = {kind: {} for kind in found}
    for size in SIZES:
        x, y = generator.uniform(-50.0, 50.0, size), generator.uniform(-100.0, 100.0, size)
        calls = max(1, (20_000 if quick else 100_000) // (size + 200))
        for kind, functions in found.items():
            times = _rounds(functions, (x, y), calls, rounds)
            result[kind][size] = {n: 1e9 * statistics.median(t) / size for n, t in times.items()}
    plain = {n: found["torque"][n] for n in (OURS, COMPILED, "lambdify(cse)", "naive NumPy")}
    times = _rounds(plain, (1.5, 20.0), 2000, rounds)
    return result | {"float": {n: 1e9 * statistics.median(t) for n, t in times.items()}}


def _rounds(functions: dict[str, Any], given: Any, calls: int, rounds: int) -> dict[str, list[float]]:
    times: dict[str, list[float]] = {name: [] for name in functions}
    for turn in range(rounds + 1):
        for name, function in functions.items():
            start = time.process_time()
            for _ in range(calls):
                function(*given)
            if turn:  # the first compiles
                times[name].append((time.process_time() - start) / calls)
    return times


def table(result: dict[str, Any]) -> list[str]:
    """Rows of a Markdown table: ns an element, and of a call with two floats."""
    lines = ["| ns an element | " + " | ".join(f"{s:,}" for s in SIZES) + " | a call on floats |"]
    lines += ["|---" * (len(SIZES) + 2) + "|"]
    for kind in ("torque", "gradient"):
        for name in result[kind][str(SIZES[0])]:
            cells = [f"{result[kind][str(size)][name]:,.1f}" for size in SIZES]
            call = f"{result['float'][name]:,.0f}" if kind == "torque" and name in result["float"] else ""
            lines.append(f"| {kind}: {name} | {' | '.join(cells)} | {call} |")
    return lines


def asked(result: dict[str, Any]) -> list[tuple[str, str, str, bool]]:
    """(what, asked, measured with its peer, whether it is reached) of what was asked for."""
    at = {size: result["torque"][str(size)] for size in SIZES}
    gradient, large = result["gradient"][str(SIZES[-1])], at[SIZES[-1]]
    rows = []
    for what, least, peer, own in (
        ("NumPy, torque, 1e6: lambdify(cse) / emitted", 7.0, large["lambdify(cse)"], large[OURS]),
        ("NumPy, torque, 1e6: numba / emitted", 1.5, large.get("numba"), large[OURS]),
        ("NumPy, gradient, 1e6: lambdify(cse) / emitted", 10.0, gradient["lambdify(cse)"], gradient[OURS]),
    ):
        if peer is not None:
            told = f"{peer / own:.1f} ({peer:.1f} / {own:.1f} ns)"
            rows.append((what, f"at least {least:g}", told, peer >= least * own))
    for count in (1, 100):
        own, peer = at[count][OURS] * count / 1000, at[count]["naive NumPy"] * count / 1000
        told = f"{own / peer:.2f} ({own:.1f} / {peer:.1f} us)"
        rows.append((f"NumPy, torque, {count}: emitted / naive", "at most 2", told, own <= 2 * peer))
    call = result["float"][COMPILED] / 1000
    rows.append(("eccentric.compile, a call on floats", "at most 0.5 us", f"{call:.2f} us", call <= 0.5))
    return rows


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="fewer rounds")
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    wanted = parser.parse_args()
    if wanted.worker:
        print(json.dumps(_work(wanted.quick)))
        return
    result = measured(wanted.quick)
    print("\n".join(table(result)) + "\n\n| what | asked | measured | |\n|---|---|---|---|")
    for what, least, told, reached in asked(result):
        print(f"| {what} | {least} | {told} | {'' if reached else 'not reached'} |")
    for package, reason in result["absent"].items():
        print(f"{package}: left out, {reason}")


if __name__ == "__main__":
    main()
