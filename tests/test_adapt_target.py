"""The estimator on a Cortex-M4F under QEMU: the bits of the host, and what it costs."""

import dataclasses
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.cortex_m4 import M4F, OPTIMISED, TOOLS, missing, run
from eccentric.emission.adapt.prior import inputs_of
from eccentric.model import load_model
from tests.adapt_target import SINGLE, counted, sizes
from tests.adapted import DRIVE, current, emitted, module, motion, python_bits
from tests.extended import effects

# Instructions of one sample without the model's functions, and with the alarm: those asked are the first.
MOST = {4: (420, 500), 6: (750, 800)}
BYTES, STACK = {4: 128, 6: 188}, {4: 256, 6: 320}


@pytest.fixture(scope="module", params=[4, 6])
def case(request: Any, tmp_path_factory: pytest.TempPathFactory) -> tuple[int, str, Path, Any, np.ndarray]:
    """Return number of coefficients, name, folder, Python and a log: case C2, and with two harmonics."""
    if absent := missing(TOOLS):
        pytest.skip(f"not installed: {', '.join(absent)}")
    folder = tmp_path_factory.mktemp("target")
    if request.param == 4:
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
    return request.param, name, out, python, np.stack([moved[x] for x in python.INPUTS], 1).astype(np.float32)


def test_the_bits_of_the_host(case: Any) -> None:
    """After 1,200 samples every word of the state is that of Python in single precision."""
    _, name, folder, python, rows = case
    state = python.init(np.float32)
    expected = python.replay(*rows.T, state)["flags"].tolist()

    samples, _, words = counted(folder, name, rows.tolist())

    reals = len(words) - 5 - len(state.seen)
    found = np.array([int(w, 16) for w in words], np.uint32)
    order = python_bits(state)
    seen = order[-5 - len(state.seen) : -5]
    assert expected == [flags for flags, _ in samples]
    assert np.array(order[:reals], np.float32).view(np.uint32).tolist() == found[:reals].tolist()
    assert [state.calls, *map(int, seen)] == found[reals : reals + 1 + len(seen)].tolist()


def test_instructions(case: Any) -> None:
    """The update takes no more than asked, the model's own functions left out; so does all with the alarm."""
    n, name, folder, python, rows = case
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
    print(f"{n} coefficients: {alone - own} instructions, {whole - own} with the alarm")
    assert alone - own <= MOST[n][0]
    assert whole - own <= MOST[n][1]


def test_memory(case: Any) -> None:
    """The state has the bytes that the manual states, nothing else is written to, and the stack is small."""
    n, name, folder, _, rows = case
    _, named, _ = counted(folder, name, rows[:30].tolist())
    found = sizes(folder, name)

    print(n, named, found)
    assert BYTES[n] == named["state"]
    assert 0 == found["data"]
    assert found["stack"] <= STACK[n]


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
