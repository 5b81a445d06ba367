"""No flag turns the emitted C into garbage: each combination is refused, or keeps the header's bounds."""

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from tests import flags, flags_adapt
from tests.targets import TARGETS, missing

LEVELS = (
    ("-O0", "-std=c99"),
    ("-O1", "-std=gnu11"),
    ("-O2", "-std=gnu17"),
    ("-O3", "-std=gnu2x"),
    ("-Os", "-std=c99"),
    ("-Ofast", "-std=gnu17"),
    ("-O2", "-std=gnu11", "-flto"),
)
REFUSALS = ("spoil prepare and drop NaN", "double_constants")
RE_ASSOCIATED = ("-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math")
SINGLE_FLAGS = (
    ("-ffast-math",),
    ("-funsafe-math-optimizations",),
    RE_ASSOCIATED,
    ("-freciprocal-math",),
    ("-ffinite-math-only",),
    ("-fno-signed-zeros",),
    ("-fno-trapping-math",),
    ("-fno-math-errno",),
    ("-frounding-math",),
    ("-ffp-contract=fast",),
    ("-fsingle-precision-constant",),
    ("-fshort-enums",),
)
# gcc calls arithmetic associative only where all that belongs to it is on.
SEVERAL = (
    ("-funsafe-math-optimizations", "-fno-associative-math"),
    ("-funsafe-math-optimizations", "-fsigned-zeros"),
    ("-ffast-math", "-ftrapping-math", "-fno-finite-math-only"),
)
OF_FAMILY = {
    "gcc": (("-fexcess-precision=fast",), ("-ffloat-store",), ("-fcx-limited-range",)),
    "clang": (("-ffp-model=fast",), ("-fno-honor-nans",), ("-fno-honor-infinities",), ("-fapprox-func",)),
}
NO_NAN = "-fno-honor-nans"
PLACES = [(family, target) for target in TARGETS for family in OF_FAMILY]
SAMPLE = [
    ("gcc", "x86-64-fma", ("-O2",)),
    ("gcc", "x86-64", ("-O2", "-fsingle-precision-constant")),
    ("gcc", "aarch64", ("-O2",)),
    ("clang", "x86-64", ("-O2", "-funsafe-math-optimizations")),
    ("clang", "aarch64", ("-O2", *RE_ASSOCIATED)),
]


Outcome = Callable[[Path, str, str, tuple[str, ...], str], dict[str, float] | str]


def kept_or_refused(
    folder: Path,
    family: str,
    target: str,
    options: tuple[str, ...],
    real: str,
    outcome: Outcome = flags.outcome,
) -> bool:
    """Return whether a combination is refused in the source's own words, or keeps all bounds."""
    found = outcome(folder, family, target, options, real)
    if isinstance(found, str):
        return options not in LEVELS[:5] and any(words in found for words in REFUSALS)
    # Whoever says that there is no NaN gets none kept.
    kept = [worst for name, worst in found.items() if not name.startswith("NaN") or NO_NAN not in options]
    return all(worst <= 1.0 for worst in kept)


def need(family: str, target: str) -> None:
    """Skip the test where a tool is not installed, and say which."""
    if lacking := missing(family, target):
        pytest.skip(f"not installed: {', '.join(lacking)}")


@pytest.mark.parametrize(
    ("family", "target", "options"), SAMPLE, ids=lambda x: x if isinstance(x, str) else " ".join(x)
)
def test_what_used_to_be_wrong(tmp_path: Path, family: str, target: str, options: tuple[str, ...]) -> None:
    """Contraction, re-association and constants in float each spoiled the split of the period in float."""
    need(family, target)

    assert kept_or_refused(tmp_path, family, target, options, "float")


@pytest.mark.parametrize(
    ("family", "target", "options"),
    [*SAMPLE, ("clang", "x86-64-fma", ("-O2", "-ffp-contract=fast")), ("gcc", "m4f", ("-O3", "-std=gnu2x"))],
    ids=lambda x: x if isinstance(x, str) else " ".join(x),
)
def test_the_estimator_is_kept_or_refused(
    tmp_path: Path, family: str, target: str, options: tuple[str, ...]
) -> None:
    """It learns the coefficients of the emitted Python, within 1e-4 of their standard deviation."""
    need(family, target)

    assert kept_or_refused(tmp_path, family, target, options, "float", flags_adapt.outcome)


def combinations(family: str, target: str) -> list[tuple[tuple[str, ...], str]]:
    """Return (options, precision): levels in each dialect, unsafe flags alone, and some together."""
    cross_lto = family == "clang" and TARGETS[target].emulator
    levels = [x for x in LEVELS if not ("-flto" in x and cross_lto)]  # its objects are for its own linker
    found = [(x, real) for x in levels for real in flags.PRECISIONS]
    found += [(("-O2", *x), "float") for x in (*SINGLE_FLAGS, *OF_FAMILY[family])]
    found += [(("-O2", *x), "double") for x in (RE_ASSOCIATED, ("-ffp-contract=fast",), *SEVERAL)]
    # What a flag means is the front end's: x86-64 has all of them, each other target a third, by turns.
    first = list(TARGETS).index(target)
    return found if first == 0 else found[first % 3 :: 3]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("family", "target", "what"),
    [
        *(pytest.param(*place, flags, id=f"{'-'.join(place)}-functions") for place in PLACES),
        # Its sources say what the model's say, and the same front ends read them.
        *(pytest.param(family, "x86-64", flags_adapt, id=f"{family}-estimator") for family in OF_FAMILY),
    ],
)
def test_every_flag(tmp_path: Path, family: str, target: str, what: ModuleType) -> None:
    """Any level of optimisation in any dialect, and any unsafe flag alone: refused, or within the bounds."""
    need(family, target)
    spoiled = [
        (" ".join(options), real)
        for options, real in combinations(family, target)
        if not kept_or_refused(tmp_path, family, target, options, real, what.outcome)
    ]

    assert [] == spoiled
