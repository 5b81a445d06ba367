"""The estimator on a Cortex-M4F under QEMU: executed instructions of one sample, memory and stack."""

import re
from collections.abc import Sequence
from pathlib import Path

from benchmarks.cortex_m4 import M4F, OPTIMISED, build, emulate, run

SINGLE = "-DECCENTRIC_REAL=float"

# The model's functions return rows that were computed before, so that the update alone is counted.
_MAIN = """
#include <stdint.h>
#include <stdio.h>
#include "@NAME@_adapt.h"
#define TIMER_CONTROL (*(volatile uint32_t *)0x40000000u)
#define TIMER_VALUE (*(volatile uint32_t *)0x40000004u)
#define TIMER_RELOAD (*(volatile uint32_t *)0x40000008u)
static @NAME@_adapt_state state;
static @NAME@_coefficients c;
static const float rows[][@WIDTH@] = {@ROWS@};
__attribute__((noinline)) static uint32_t empty(@TYPES@, @NAME@_adapt_state *s, const @NAME@_coefficients *p)
{
    __asm__ volatile("" ::"r"(s), "r"(p) : "memory");
    return 0u;
}
__attribute__((noinline)) static void nothing(const @NAME@_adapt_state *s, @NAME@_coefficients *p)
{
    __asm__ volatile("" ::"r"(s), "r"(p) : "memory");
}
#define TICKS(call) (start = TIMER_VALUE, (call), start - TIMER_VALUE)
int main(void)
{
    uint32_t start;
    TIMER_RELOAD = 0xffffffffu;
    TIMER_VALUE = 0xffffffffu;
    TIMER_CONTROL = 1u;
    c = @NAME@_default;
    @NAME@_adapt_init(&state);
    for (uint32_t k = 0; k < sizeof rows / sizeof rows[0]; ++k) {
        uint32_t flags;
        const uint32_t all = TICKS(flags = @NAME@_adapt(@ARGUMENTS@, &state, &@NAME@_default));
        const uint32_t none = TICKS(empty(@ARGUMENTS@, &state, &@NAME@_default));
        printf("%lu %lu\\n", (unsigned long)flags, (unsigned long)((all - none + 12u) * 10u / 256u + 1u));
    }
    const uint32_t all = TICKS(@NAME@_adapt_apply(&state, &c));
    const uint32_t none = TICKS(nothing(&state, &c));
    printf("apply %lu\\n", (unsigned long)((all - none + 12u) * 10u / 256u + 1u));
    printf("state %u\\n", (unsigned)sizeof state);
    const uint32_t *words = (const uint32_t *)&state;
    for (uint32_t k = 0; k < sizeof state / 4u; ++k) {
        printf("word %08lx\\n", (unsigned long)words[k]);
    }
    return 0;
}
"""


def counted(
    folder: Path, name: str, rows: Sequence[Sequence[float]], *options: str, extra: Sequence[Path] = ()
) -> tuple[list[tuple[int, int]], dict[str, int], list[str]]:
    """Return (flags, instructions) of each sample, those of `apply` and bytes of the state, its words."""
    width = len(rows[0])
    text = _MAIN
    for hole, value in {
        "NAME": name,
        "WIDTH": str(width),
        "ROWS": ", ".join(
            "{" + ", ".join(f"{x:.9g}f" if x % 1 else f"{x:.1f}f" for x in row) + "}" for row in rows
        ),
        "TYPES": ", ".join(f"float x{k}" for k in range(width)),
        "ARGUMENTS": ", ".join(f"rows[k][{k}]" for k in range(width)),
    }.items():
        text = text.replace(f"@{hole}@", value)
    main = folder.parent / "count_adapt.c"
    main.write_text(text, encoding="utf-8")
    sources = [main, folder / f"{name}_adapt.c", *(extra or [folder / f"{name}.c"])]
    elf = build(folder.parent / "count.elf", sources, [*OPTIMISED, SINGLE, f"-I{folder}", *options])
    status, said = emulate(elf, "-icount", "shift=10,sleep=off")
    assert 0 == status, said
    samples = [(int(a), int(b)) for a, b in re.findall(r"^(\d+) (\d+)$", said, re.MULTILINE)]
    named = {what: int(x) for what, x in re.findall(r"^(apply|state) (\d+)$", said, re.MULTILINE)}
    return samples, named, re.findall(r"^word (\w+)$", said, re.MULTILINE)


def sizes(folder: Path, name: str) -> dict[str, int]:
    """Return bytes of code and constants of the estimator, and of the deepest stack of its functions."""
    thing = folder.parent / f"{name}_adapt.o"
    run(
        "arm-none-eabi-gcc", "-std=c99", *M4F, *OPTIMISED, SINGLE, "-fstack-usage", "-c", "-o", thing,
        folder / f"{name}_adapt.c",
    )  # fmt: skip
    text, data, bss, *_ = run("arm-none-eabi-size", thing).splitlines()[1].split()
    stacks = [int(line.split("\t")[1]) for line in thing.with_suffix(".su").read_text().splitlines()]
    return {"text": int(text), "data": int(data) + int(bss), "stack": max(stacks)}
