"""What the estimator costs on a Cortex-M4F: a case of four or six coefficients, counted under QEMU."""

import dataclasses
import re
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.cortex_m4 import M4F, OPTIMISED, run
from eccentric.emission import inputs_of
from eccentric.model import load_model
from tests.adapt_target import SINGLE, counted
from tests.adapted import DRIVE, current, emitted, module, motion
from tests.extended import effects

Case = tuple[int, str, Path, Any, np.ndarray]
"""Number of coefficients, name, folder, Python and a log."""


def case(count: int, folder: Path) -> Case:
    """Return case C2, with four coefficients, or with two harmonics of its friction as well."""
    if count == 4:
        name, out = "c2_parallel", emitted(folder)
    else:
        name = "c2_harmonics"
        wide = effects("C2")["link_harmonic_friction[n=2]"].extend(load_model("c2_parallel"), {})
        extra = {q.name: 0.01 for q in wide.parameters if q.default is None and q.name not in DRIVE}
        out = emitted(folder, dataclasses.replace(wide, name=name), DRIVE | extra)
    python = module(out, name)
    moved: dict[str, Any] = dict(
        zip(("theta_m", "omega_m", "alpha_m"), motion(1200, 1, still=0.0), strict=True)
    )
    torque = python.model.mechanical_friction_torque
    friction = np.abs(torque(*(moved[x] for x in inputs_of(torque))))
    noise = np.random.default_rng(0).normal(0, 0.007, 1200)
    moved["i"] = current(python.model, list(moved.values()), friction, noise)
    return count, name, out, python, np.stack([moved[x] for x in python.INPUTS], 1).astype(np.float32)


def costs(one: Case) -> tuple[int, int]:
    """Return the most instructions of a sample, the model's own left out: the update, and with the alarm."""
    _, name, folder, python, rows = one
    columns = np.asarray(python.model.regressor(rows[:, 0], rows[:, 1]))
    stub = folder.parent / "stub.c"
    stub.write_text(stubbed(folder, name, columns, np.asarray(python.model.friction_coefficients())))
    source = (folder / f"{name}_adapt.c").read_text(encoding="utf-8")
    alarm = f"{name}_adapt_alarm(s, (forward != 0u) ? z : -z)"
    assert 1 == source.count(alarm)

    whole = most(counted(folder, name, rows.tolist(), extra=[stub]))
    (folder / f"{name}_adapt.c").write_text(source.replace(alarm, "0u"), encoding="utf-8")
    alone = most(counted(folder, name, rows.tolist(), "-Wno-unused-function", extra=[stub]))
    (folder / f"{name}_adapt.c").write_text(source, encoding="utf-8")

    own = straight(stub, folder)
    return alone - own, whole - own


def most(result: Any) -> int:
    """The most instructions of a sample that has changed the coefficients within their bounds."""
    found = [count for flags, count in result[0] if flags & 33 == 1]
    assert len(found) > 200
    return max(found)


def straight(source: Path, folder: Path) -> int:
    """Return the instructions of the functions of a source, which have no branches, and of a call of each."""
    thing = source.with_suffix(".o")
    run("arm-none-eabi-gcc", "-std=c99", *M4F, *OPTIMISED, SINGLE, f"-I{folder}", "-c", "-o", thing, source)
    lines = run("arm-none-eabi-objdump", "-d", thing).splitlines()
    steps = [line.split("\t")[2] for line in lines if line.count("\t") >= 2]
    assert 3 == steps.count("bx")
    return sum(step != ".word" for step in steps) + 3


def stubbed(folder: Path, name: str, columns: np.ndarray, own: np.ndarray) -> str:
    """C with the model's constants, and with functions that return numbers computed before."""
    base, header = ((folder / f"{name}.{end}").read_text(encoding="utf-8") for end in "ch")

    def constant(kind: str) -> str:
        found = re.search(rf"const {name}_{kind} {name}_default\w* = {{.*?\n}};", base, re.DOTALL)
        assert found
        return found[0]

    def head(function: str) -> str:
        found = re.search(rf"\n(\w+ {name}_{function}\([^;]*\));", header)
        assert found
        return found[1]

    table = ", ".join("{" + ", ".join(f"{x:.8e}f" for x in row) + "}" for row in columns)
    put = " ".join(f"out[{k}] = columns[at][{k}];" for k in range(columns.shape[1]))
    give = " ".join(f"out[{k}] = {x:.8e}f;" for k, x in enumerate(own))
    return f"""
#include "{name}.h"
#include <math.h>
#define real float
{constant("parameters")}
{constant("coefficients")}
static const float columns[][{columns.shape[1]}] = {{{table}}};
static unsigned at;
{head("mechanical_residual")} {{ return 0.004f; }}
{head("regressor")} {{ {put} ++at; }}
{head("friction_coefficients")} {{ {give} }}
"""
