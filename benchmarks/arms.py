"""Arms: what their emitted code costs, and how it agrees with Pinocchio, on chains at right angles.

Instructions on x86-64 are counted by callgrind, on a Cortex-M4F under QEMU; times are those of one core.
"""

from __future__ import annotations

import re
import shutil
import statistics
import tempfile
import time
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

import eccentric
from benchmarks import arm_peers
from benchmarks.cortex_m4 import M4F, OPTIMISED, build, emulate, run
from benchmarks.record import Measured, Part, progress
from eccentric.emission import Choice, executed, render
from eccentric.model import Body, Chain, arm
from tests.arms import random_chain
from tests.test_chain_size import robot

SIZES = (1, 3, 7, 12)
FUNCTIONS = ("inverse_dynamics", "motor_torque", "bearing_loads", "gravity_torque")
SAMPLES, ROUNDS, CALLS = 100_000, 9, 50
SHIPPED = Path(__file__).resolve().parent.parent / "examples" / "arms" / "six_joints.toml"


def written(folder: Path, chain: Chain, functions: Sequence[str]) -> None:
    """The C of some functions of a chain."""
    files = render(
        arm(chain, "An arm"), "make bench", "the benchmark", choice=Choice(tuple(functions), "none")
    )
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")


def _main(name: str, functions: Sequence[str], calls: int, motions: int = CALLS) -> str:
    """A program that calls each function for each motion so many times."""
    arguments = {"gravity_torque": "q, out"}
    lines = "".join(
        f"            {name}_{f}({arguments.get(f, 'q, w, a, out')}, &{name}_default);\n" for f in functions
    )
    return f"""#include "{name}.h"
volatile ECCENTRIC_REAL last;
int main(void)
{{
    ECCENTRIC_REAL q[16], w[16], a[16], out[256];
    for (int k = 0; k < {motions}; ++k) {{
        for (int j = 0; j < 16; ++j) {{
            q[j] = (ECCENTRIC_REAL)(0.1 * k + j);
            w[j] = (ECCENTRIC_REAL)(1.0 - 0.01 * k * j);
            a[j] = (ECCENTRIC_REAL)(0.5 * k - j);
        }}
        for (int call = 0; call < {calls}; ++call) {{
{lines}            last = out[0];
        }}
    }}
    return 0;
}}
"""


def instructions(folder: Path, n: int) -> dict[str, float]:
    """Instructions of a call on x86-64, double, gcc -O2: the mean over motions, by function."""
    written(folder, robot(n), FUNCTIONS)
    (folder / "main.c").write_text(_main("robot", FUNCTIONS, 1), encoding="utf-8")
    program, profile = folder / "counted", folder / "profile"
    run("gcc", "-std=c99", "-O2", "-g", folder / "main.c", folder / "robot.c", "-o", program, "-lm")
    run("valgrind", "-q", "--tool=callgrind", f"--callgrind-out-file={profile}", program)
    said = run("callgrind_annotate", "--inclusive=yes", "--threshold=100", profile)
    found = re.findall(r"^\s*([\d,]+) .*?:robot_(\w+)_double\b", said, re.MULTILINE)
    return {name: int(count.replace(",", "")) / CALLS for count, name in found if name in FUNCTIONS}


def on_a_small_processor(folder: Path) -> dict[str, int]:
    """Motor torque of the shipped arm of six joints on a Cortex-M4F: instructions, text, constants, stack."""
    eccentric.emit(SHIPPED, folder / "m4f", functions=["motor_torque"], backend="c99")
    out, counts = folder / "m4f", []
    for calls in (1, 2):
        (folder / "call.c").write_text(_main("six_joints", ["motor_torque"], calls, 1), encoding="utf-8")
        log, elf = folder / "m4f.log", folder / "m4f.elf"
        options = ("-DECCENTRIC_REAL=float", "-std=c99", f"-I{out}", *OPTIMISED)
        build(elf, [folder / "call.c", out / "six_joints.c"], options, M4F)
        emulate(elf, "-singlestep", "-d", "nochain,exec", "-D", str(log))
        with log.open(encoding="utf-8") as lines:
            counts.append(sum(line.startswith("Trace") for line in lines))
    made = folder / "six.o"
    options = (*M4F, *OPTIMISED, "-std=c99", "-fstack-usage", "-ffunction-sections", "-DECCENTRIC_REAL=float")
    run("arm-none-eabi-gcc", *options, "-c", out / "six_joints.c", "-o", made)
    sections = re.findall(
        r"^\.(text|rodata)(\S*)\s+(\d+)", run("arm-none-eabi-size", "-A", made), re.MULTILINE
    )
    used = made.with_suffix(".su").read_text(encoding="utf-8").splitlines()
    return {
        "instructions": counts[1] - counts[0],
        "text": sum(int(size) for kind, name, size in sections if kind == "text" and "prepare" not in name),
        "constants": sum(int(size) for kind, _, size in sections if kind == "rodata"),
        "stack": max(int(line.split("\t")[1]) for line in used if "prepare" not in line),
    }


def seconds(call: Callable[[], Any]) -> float:
    """Processor time of a call, the median of rounds."""
    spent = []
    for _ in range(ROUNDS):
        started = time.process_time()
        call()
        spent.append(time.process_time() - started)
    return statistics.median(spent)


def speed(folder: Path) -> tuple[float, float, float | None]:
    """Microseconds a sample of the inverse dynamics of seven joints: NumPy, compiled, Pinocchio from Python."""
    rng = np.random.default_rng(0)
    motion = [rng.normal(size=(SAMPLES, 7)) for _ in range(3)]
    chain = robot(7)
    files = render(arm(chain, "An arm"), "make bench", "the benchmark", ("numpy",))
    module = executed(files, "robot")
    compiled = eccentric.compile(arm_file(chain, folder))
    ours, built = (
        seconds(lambda m=m: m.inverse_dynamics(*motion)) / SAMPLES * 1e6 for m in (module, compiled)
    )
    try:
        pin = import_module("pinocchio")
        pinocchio_of = import_module("tests.test_chain_pinocchio").pinocchio_of
    except ImportError:
        return ours, built, None
    model, data = pinocchio_of(chain)
    some = [x[:5000] for x in motion]

    def loop() -> None:
        for q, v, a in zip(*some, strict=True):
            pin.rnea(model, data, q, v, a)

    return ours, built, seconds(loop) / 5000 * 1e6


def arm_file(chain: Chain, folder: Path) -> Path:
    """A chain as an arm file."""

    def text(values: Any) -> str:
        return "[" + ", ".join(f"{float(x):.17g}" for x in values) + "]"

    lines = [f'name = "{chain.name}"', f"gravity_m_s2 = {text(chain.gravity)}"]
    for number, (joint, body) in enumerate(zip(chain.joints, chain.bodies, strict=True)):
        assert isinstance(body, Body)
        rows = ", ".join(text(joint.placement.rotation[k, :]) for k in range(3))
        inertia = {
            a + b: float(body.inertia[i, k])
            for i, a in enumerate("xyz")
            for k, b in enumerate("xyz")
            if i <= k
        }
        lines += [
            "[[joint]]",
            f'name = "joint {number}"',
            "mu = 1",
            f"axis = {text(joint.axis)}",
            f"position_m = {text(joint.placement.position)}",
            f"rotation = [{rows}]",
            "[joint.body]",
            f"mass_kg = {float(body.mass):.17g}",
            f"centre_m = {text(body.centre)}",
            "inertia_kgm2 = { " + ", ".join(f"{key} = {value:.17g}" for key, value in inertia.items()) + " }",
        ]
    path = folder / f"{chain.name}.toml"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def deviation(chains: int) -> float | None:
    """The largest difference to Pinocchio's torques and wrenches on random chains, relative to the largest entry."""
    try:
        pin = import_module("pinocchio")
        pinocchio_of = import_module("tests.test_chain_pinocchio").pinocchio_of
    except ImportError:
        return None
    rng, worst = np.random.default_rng(1), 0.0
    for k in range(chains):
        n = (1, 2, 3, 6, 7, 12)[k % 6]
        chain = random_chain(rng, n, aligned=k % 2 == 0)
        choice = Choice(("inverse_dynamics", "joint_wrenches"), "none")
        files = render(arm(chain, "An arm"), "make bench", "the benchmark", ("numpy",), choice=choice)
        module = executed(files, "arm")
        model, data = pinocchio_of(chain)
        for _ in range(20):
            q, v, a = (rng.normal(size=n) * scale for scale in (2, 3, 5))
            torques = pin.rnea(model, data, q, v, a)
            wrenches = np.concatenate([data.f[k + 1].vector for k in range(n)])
            for mine, theirs in (
                (module.inverse_dynamics(q, v, a), torques),
                (module.joint_wrenches(q, v, a), wrenches),
            ):
                worst = max(worst, float(np.max(np.abs(mine - theirs)) / np.max(np.abs(theirs))))
        progress(f"arms: {k + 1} of {chains} chains beside Pinocchio")
    return worst


def emitted_in(n: int) -> float:
    """Seconds to derive and emit all functions of n joints."""
    started = time.process_time()
    render(arm(robot(n), "An arm"), "make bench", "the benchmark")
    return time.process_time() - started


def measured(quick: bool) -> Part:
    """Measure all of it; what needs a tool that is missing is left out with the reason."""
    left_out: list[str] = []
    figures: dict[str, Measured] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        table = ["| joints | " + " | ".join(f"`{f}`" for f in FUNCTIONS) + " |", "|--:" * 5 + "|"]
        if shutil.which("valgrind"):
            for n in SIZES:
                counted = instructions(folder, n)
                table.append(f"| {n} | " + " | ".join(f"{counted[f]:.0f}" for f in FUNCTIONS) + " |")
                beside = peers(folder, n)
                figures[f"arm inverse {n}"] = _plain(counted["inverse_dynamics"], beside)
                if n == 7:
                    figures["arm motor torque 7"] = _plain(counted["motor_torque"])
        else:
            table, left_out = [], ["Instructions on x86-64: not installed: valgrind."]
        if shutil.which("arm-none-eabi-gcc") and shutil.which("qemu-system-arm"):
            small = on_a_small_processor(folder)
            left_out.append(
                f"Motor torque of six joints on a Cortex-M4F, float: {small['instructions']} instructions,"
                f" {small['text']} B of text, {small['constants']} B of constants, {small['stack']} B of stack."
            )
        ours, built, peer = speed(folder)
    said = "" if peer is None else f"Pinocchio from Python {peer:.2f} us"
    figures["arm numpy"] = Measured(ours, f"{ours:.2f} us", said)
    figures["arm compiled"] = Measured(built, f"{built:.2f} us", said)
    worst = deviation(6 if quick else 60)
    if worst is None:
        left_out.append("Agreement with Pinocchio: it is not installed.")
    else:
        figures["arm pinocchio"] = Measured(worst, f"{worst:.1e}")
    for n in (7, 12):
        spent = emitted_in(n)
        figures[f"arm emitted {n}"] = Measured(spent, f"{spent:.1f} s")
    says = (
        "Chains of joints at right angles to one another, bodies without symmetry, all numbers folded."
        " Instructions of a call on x86-64, double, gcc -O2, the mean over 50 motions; `motor_torque` has all"
        " wrenches, all loads and the friction that follows them. Peers compute the inverse dynamics alone:"
        " Pinocchio as its package has it compiled, CasADi with all numbers folded and its cse"
        " (`benchmarks/arm_peers.py`)."
    )
    return Part(figures, [says, "", *table, "", *left_out])


def peers(folder: Path, n: int) -> str:
    """Instructions of the inverse dynamics alone elsewhere, of what is installed."""
    said = []
    for name, count in (("Pinocchio's rnea", arm_peers.pinocchio), ("CasADi", arm_peers.casadi)):
        progress(f"arms: {name}, {n} joints")
        try:
            said.append(f"{name} {count(folder, n):.0f}")
        except ImportError:
            continue
    return ", ".join(said)


def _plain(value: float, peer: str = "") -> Measured:
    return Measured(value, f"{value:.0f}", peer)


if __name__ == "__main__":
    part = measured(quick=True)
    print("\n".join([*part.details, *(f"{key}: {one}" for key, one in part.figures.items())]))
