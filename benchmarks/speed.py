"""Time of the emitted NumPy module and of the compiled C beside its peers, case C2, paired in one run.

Every round measures all in turn, as processor time on one core; reported are the medians over the rounds. The peers'
environment runs this file as a script, its rounds as argument.
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
from benchmarks import environment  # noqa: E402
from benchmarks.peers import torque  # noqa: E402
from benchmarks.record import Measured, Part, progress  # noqa: E402

SIZES = (1, 100, 10_000, 1_000_000)
OURS, COMPILED = "emitted NumPy", "emitted C, compiled"
_OPTIONAL = ("numexpr", "numba", "jax")
_NEEDED = ("numpy", "sympy", "jinja2")
_SINGLE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "NUMEXPR_NUM_THREADS", "NUMBA_NUM_THREADS"), "1") | {
    "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
}


def measured(quick: bool) -> Part:
    """Measure in the environment of the peers."""
    progress("NumPy: peers")
    absent = environment.absent(*_NEEDED, *_OPTIONAL)
    progress("NumPy: rounds")
    command = [environment.PYTHON, __file__, "5" if quick else "15"]
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env=os.environ | _SINGLE_THREAD, cwd=ROOT
    )
    if done.returncode:
        raise RuntimeError((done.stderr.strip().splitlines() or ["no result"])[-1])
    result = json.loads(done.stdout.splitlines()[-1])
    there = [package for package in (*_NEEDED[:2], *_OPTIONAL) if package not in absent]
    left_out = [f"\n{package}: left out, {reason}." for package, reason in absent.items()]
    details = [f"Peers: {environment.versions(*there)}.", "", *_table(result), *left_out]
    curves = {
        name: (list(map(float, SIZES)), [result["torque"][str(size)][name] for size in SIZES])
        for name in result["torque"][str(SIZES[0])]
    }
    return Part(_figures(result), details, curves)


def _contenders() -> dict[str, dict[str, Callable[..., Any]]]:
    """{"torque": {name: function of angle and velocity}, "gradient": ...}: what is there of the peers."""
    import numpy as np
    import sympy as sp

    import eccentric
    from generated import c2_parallel

    theta, omega = sp.symbols("theta omega", real=True)
    F = torque(theta, omega, sp)
    slopes = [F.diff(theta), F.diff(omega).replace(sp.DiracDelta, lambda *_: sp.Integer(0))]
    compiled = eccentric.compile("c2_parallel")
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
            continue  # the page says why
    return found


def _numexpr(F: Any) -> Callable[..., Any]:
    import numexpr  # pyright: ignore[reportMissingImports]
    import sympy as sp

    omega = next(s for s in F.free_symbols if s.name == "omega")
    sign = sp.Symbol("where(omega > 0, 1, where(omega < 0, -1, 0))")
    text = str(F.subs(sp.sign(omega), sign))
    return lambda x, y: numexpr.evaluate(text, {"theta": x, "omega": y})


def _numba(lambdified: Any) -> Callable[..., Any]:
    import numba  # pyright: ignore[reportMissingImports]
    import numpy as np

    one = numba.njit(lambdified)

    @numba.njit
    def loop(x: Any, y: Any) -> Any:
        out = np.empty_like(x)
        for k in range(x.size):
            out[k] = one(x[k], y[k])  # pyright: ignore[reportCallIssue]
        return out

    return loop


def _jax() -> Callable[..., Any]:
    import jax  # pyright: ignore[reportMissingImports]

    jax.config.update("jax_enable_x64", True)
    compiled = jax.jit(lambda x, y: torque(x, y, jax.numpy))
    return lambda x, y: compiled(x, y).block_until_ready()


def _work(rounds: int) -> dict[str, Any]:
    """{"torque": {size: {name: ns an element}}, "gradient": ..., "float": ns of a call, "found": seconds}."""
    import numpy as np

    found, generator = _contenders(), np.random.default_rng(5)
    result: dict[str, Any] = {kind: {} for kind in found}
    for size in SIZES:
        x, y = generator.uniform(-50.0, 50.0, size), generator.uniform(-100.0, 100.0, size)
        calls = max(1, 100_000 // (size + 200))
        for kind, functions in found.items():
            times = _rounds(functions, (x, y), calls, rounds)
            result[kind][size] = {n: 1e9 * statistics.median(t) / size for n, t in times.items()}
    plain = {n: found["torque"][n] for n in (OURS, COMPILED, "lambdify(cse)", "naive NumPy")}
    times = _rounds(plain, (1.5, 20.0), 2000, rounds)
    result["float"] = {n: 1e9 * statistics.median(t) for n, t in times.items()}
    return result | {"found": _found(rounds)}


_FOUND = """
import time, numpy
start = time.perf_counter()
import eccentric
eccentric.compile("c2_parallel")
print(time.perf_counter() - start)
"""


def _found(rounds: int) -> list[float]:
    """Seconds that a fresh process takes to find a model that was compiled before; NumPy is imported already."""
    run = [sys.executable, "-c", _FOUND]
    return [
        float(subprocess.run(run, capture_output=True, text=True, check=True, cwd=ROOT).stdout)
        for _ in range(rounds)
    ]


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


def _table(result: dict[str, Any]) -> list[str]:
    """Rows of a Markdown table: ns an element, and of a call with two floats."""
    lines = ["| ns an element | " + " | ".join(f"{s:,}" for s in SIZES) + " | a call on floats |"]
    lines += ["|---" * (len(SIZES) + 2) + "|"]
    for kind in ("torque", "gradient"):
        for name in result[kind][str(SIZES[0])]:
            cells = [f"{result[kind][str(size)][name]:,.1f}" for size in SIZES]
            call = f"{result['float'][name]:,.0f}" if kind == "torque" and name in result["float"] else ""
            lines.append(f"| {kind}: {name} | {' | '.join(cells)} | {call} |")
    return lines


def _figures(result: dict[str, Any]) -> dict[str, Measured]:
    at = {size: result["torque"][str(size)] for size in SIZES}
    large, gradient = at[SIZES[-1]], result["gradient"][str(SIZES[-1])]
    figures = {}
    for key, peer, times in (
        ("lambdify", "lambdify(cse)", large),
        ("numba", "numba", large),
        ("lambdify gradient", "lambdify(cse)", gradient),
    ):
        if peer in times:
            ratio = times[peer] / times[OURS]
            others = "; ".join(
                f"{name} {ns:.1f} ns" for name, ns in times.items() if name not in {OURS, COMPILED}
            )
            figures[key] = Measured(ratio, f"{ratio:.1f} ({times[OURS]:.1f} ns)", others)
    for count in (1, 100):
        own, peer = (at[count][name] * count / 1000 for name in (OURS, "naive NumPy"))
        figures[f"naive {count}"] = Measured(
            own / peer, f"{own / peer:.2f} ({own:.1f} us)", f"naive NumPy {peer:.1f} us"
        )
    call = result["float"]
    others = "; ".join(f"{name} {ns / 1000:.1f} us" for name, ns in call.items() if name != COMPILED)
    figures["compiled"] = Measured(call[COMPILED] / 1000, f"{call[COMPILED] / 1000:.2f} us", others)
    for count in (1, 100):
        own = at[count][COMPILED] * count / 1000
        others = "; ".join(f"{n} {ns * count / 1000:.1f} us" for n, ns in at[count].items() if n != COMPILED)
        figures[f"compiled {count}"] = Measured(own, f"{own:.2f} us", others)
    least, median = min(result["found"]), statistics.median(result["found"])
    figures["found"] = Measured(median, f"{median:.2f} s (least {least:.2f} s)")
    return figures


if __name__ == "__main__":
    print(json.dumps(_work(int(sys.argv[1]))))
