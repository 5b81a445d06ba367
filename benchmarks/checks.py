"""What is counted over all models: bits that differ, alarms, undeclared deviations, calls of fma.

Alarms and deviations are counted on extended models, too.
"""

from __future__ import annotations

import re
import shutil
import tempfile
from pathlib import Path

from benchmarks.cortex_m4 import GENERATED, TOOLS, build, emulate, missing, run
from benchmarks.record import Measured, Part, progress
from tests.emitted import MODELS
from tests.extended import AT_WORK, at_work, written
from tests.hosts import CHECK, HOSTS, REALS, lacking, on_host
from tests.test_misra import declared, deviations, emitted
from tests.test_proof import alarms, proved
from tests.test_target import TARGETS


def measured(_: bool) -> Part:
    """Count on every model in both precisions."""
    sources = [(GENERATED / f"{name}.c").read_text(encoding="utf-8") for name in MODELS]
    calls = sum(len(re.findall(r"\bfmaf?\s*\(", text)) for text in sources)
    figures, left_out = {"fma": Measured(calls, str(calls))}, []
    for key, tool, count in (("misra", "cppcheck", _misra), ("alarms", "frama-c", _alarms)):
        if shutil.which(tool) is None:
            left_out.append(f"{tool}: not installed.")
        else:
            progress(f"checks: {tool}")
            figures[key] = count()
    bits, absent = _bits()
    return Part(figures | {"bits": bits}, [f"{line}\n" for line in left_out + absent])


def _bits() -> tuple[Measured, list[str]]:
    """Self-tests with other bits than NumPy's; compilers that are not there."""
    other, compilers, left_out = [], [], []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for label, compiler in HOSTS.items():
            progress(f"checks: bits of {label}")
            if reason := lacking(*compiler):
                left_out.append(f"{label}: {reason}.")
                continue
            compilers.append(label)
            for model in MODELS:
                for real in REALS:
                    try:
                        run(on_host(folder, model, compiler, real))
                    except RuntimeError:
                        other.append(f"{label}, {model}, {real}")
        absent = missing(TOOLS)
        left_out += [f"Cortex-M: not installed: {', '.join(absent)}."] if absent else []
        for label, (target, optimisation, real) in () if absent else TARGETS.items():
            progress(f"checks: bits of {label}")
            compilers.append(label)
            for model in MODELS:
                sources = [CHECK / f"{model}_selftest.c", GENERATED / f"{model}.c"]
                elf = build(
                    folder / "selftest.elf", sources, [optimisation, f"-DECCENTRIC_REAL={real}"], target
                )
                status, said = emulate(elf, target=target)
                if status or not said.startswith(f"{model}: ok"):
                    other.append(f"{label}, {model}")
    text = f"{len(other)} on {', '.join(compilers)}" if compilers else ""
    return Measured(len(other) if compilers else float("nan"), text), left_out + [f"{one}." for one in other]


def _alarms() -> Measured:
    with tempfile.TemporaryDirectory() as name:
        folders = dict.fromkeys(MODELS, GENERATED) | {
            extended: written(at_work(extended), Path(name) / extended) for extended in AT_WORK
        }
        drivers = [folder / "check" / f"{model}_proof.c" for model, folder in folders.items()]
        said = [proved(driver, real) for driver in drivers for real in REALS]
    count = sum(len(alarms(text)) for text in said)
    return Measured(count, f"{count} in {len(said)} proofs, every effect in some model")


def _misra() -> Measured:
    found, listed = set(), set()
    for name in (*MODELS, *AT_WORK):
        files = emitted(name)
        own = declared(files, name)
        listed |= own
        for real in REALS:
            with tempfile.TemporaryDirectory() as folder:
                found |= {(name, rule) for rule in deviations(Path(folder), files, name, real) - own}
    text = f"{len(found)} in {len(MODELS) + len(AT_WORK)} models, every effect in some"
    return Measured(len(found), f"{text} (declared: {', '.join(sorted(listed, key=float))})")
