"""How the emitted C compiles and links: without a warning, with little of libm, refused where it must be."""

import re
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from tests.adapted import emitted
from tests.compiled import FLAGS, GENERATED, REAL, Real, run
from tests.emitted import MODELS, PRECISIONS, SOME, both_precisions, every_model, every_model_in_both
from tests.hosts import need

# Square root, absolute value and rounding; sine and cosine of the tilt in `prepare` only, which runs once.
LIBM = {"sqrt", "sqrtf", "fabs", "fabsf", "floor", "floorf", "round", "roundf", "rint", "rintf"}
LIBM_OF_PREPARE = {"sin", "cos", "sincos"}


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Return what compiles a model, once for the same command: any warning is a failure."""

    @cache
    def object_file(name: str, dtype: Real, compiler: str, variant: tuple[str, ...]) -> Path:
        made = tmp_path_factory.mktemp(name) / f"{name}.o"
        options = [*FLAGS, *variant, f"-DECCENTRIC_REAL={REAL[dtype]}"]
        run(compiler, *options, "-c", GENERATED / f"{name}.c", "-o", made)
        return made

    return object_file


VARIANTS = {"polynomials": (), "libm": ("-DECCENTRIC_LIBM",)}


def few(name: str, precision: str, compiler: str, variant: str) -> bool:
    """Whether `make test` compiles it: each model by gcc in one precision, by clang one model in each."""
    by_clang = ("c2_parallel", "c2_asymmetric")
    return precision == SOME[name] and variant == "polynomials" and (compiler == "gcc" or name in by_clang)


@pytest.mark.parametrize(
    ("name", "dtype", "compiler", "variant"),
    [
        pytest.param(
            *(name, dtype, compiler, options),
            id=f"{name}-{precision}-{compiler}-{variant}",
            marks=() if few(name, precision, compiler, variant) else pytest.mark.slow,
        )
        for name in MODELS
        for precision, dtype in PRECISIONS.items()
        for compiler in ("gcc", "clang")
        for variant, options in VARIANTS.items()
    ],
)
def test_no_warning(
    compiled: Callable[..., Path], name: str, dtype: Real, compiler: str, variant: tuple[str, ...]
) -> None:
    """No compiler has a word about the source, under strict flags and an optimisation that sees far."""
    need(compiler)

    assert compiled(name, dtype, compiler, variant).is_file()


@every_model_in_both
def test_links_with_libm_only(compiled: Callable[..., Path], name: str, dtype: Real) -> None:
    """An object file needs square root, absolute value and rounding, and holds no variables."""
    object_file = compiled(name, dtype, "gcc", ())
    symbols = [line.split()[-2:] for line in run("nm", object_file).splitlines()]
    undefined = {symbol for kind, symbol in symbols if kind == "U"} - {"_GLOBAL_OFFSET_TABLE_"}
    defined = {(kind, symbol) for kind, symbol in symbols if kind != "U"}

    assert undefined <= LIBM | (LIBM_OF_PREPARE if name == "rotating_link" else set())
    assert {kind.upper() for kind, _ in defined} <= {"T", "R"}
    assert all(symbol.startswith(f"{name}_") for kind, symbol in defined if kind.isupper())


def refused(*arguments: str | Path) -> str:
    """Return what gcc says of something that it must not compile or link."""
    done = subprocess.run(["gcc", *FLAGS, *arguments], capture_output=True, text=True, check=False)
    assert done.returncode != 0
    return done.stderr


@every_model
def test_header_of_another_derivation_is_refused(tmp_path: Path, name: str) -> None:
    """A source does not compile with a header that another program wrote."""
    header = (GENERATED / f"{name}.h").read_text()
    (tmp_path / f"{name}.c").write_text((GENERATED / f"{name}.c").read_text())
    (tmp_path / f"{name}.h").write_text(re.sub(r"(_PROGRAM )0x\w+", r"\g<1>0x0UL", header))

    assert "#error" in refused("-fsyntax-only", tmp_path / f"{name}.c")


@pytest.mark.parametrize("real", ["real_t", "int", "long double", ""])
def test_other_types_are_refused(tmp_path: Path, real: str) -> None:
    """ECCENTRIC_REAL is float or double, else that is the one error; a typedef hides which of them it is."""
    (tmp_path / "types.h").write_text("typedef float real_t;\n")
    options = [f"-DECCENTRIC_REAL={real}", "-include", tmp_path / "types.h"]

    said = refused("-fsyntax-only", *options, GENERATED / "c2_parallel.c")

    assert ['#error "ECCENTRIC_REAL must be float or double"'] == re.findall(r"error: (.*)", said)


@pytest.fixture(scope="module")
def estimator(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a model with its estimator."""
    return emitted(tmp_path_factory.mktemp("estimator"))


@pytest.mark.parametrize("option", ["-ansi", "-std=c89", "-std=gnu89"])
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_an_older_dialect_is_the_one_error(
    tmp_path: Path, estimator: Path, compiler: str, option: str
) -> None:
    """The sources say that C99 is required and nothing else; the headers serve code of any dialect."""
    need(compiler)
    folder = estimator
    (tmp_path / "user.c").write_text('#include "c2_parallel_adapt.h"\nint main(void) { return 0; }\n')
    strict = (compiler, option, "-Wall", "-Wextra", "-pedantic-errors", f"-I{folder}", "-fsyntax-only")

    for name in ("c2_parallel.c", "c2_parallel_adapt.c", "check/c2_parallel_selftest.c"):
        done = subprocess.run([*strict, folder / name], capture_output=True, text=True, check=False)
        said = [line.removeprefix("#error ") for line in re.findall(r"(?:error|warning): (.*)", done.stderr)]
        assert ['"C99 or later is required: compile with -std=c99"'] == said
    run(*strict, "-Werror", tmp_path / "user.c")


@pytest.mark.parametrize(
    "option", ["-ffast-math", "-Ofast", "-funsafe-math-optimizations", "-ffinite-math-only"]
)
def test_fast_arithmetic_is_refused(option: str) -> None:
    """A compiler that re-associates sums or assumes no NaN breaks what the source promises."""
    assert "#error" in refused("-fsyntax-only", option, GENERATED / "c2_parallel.c")


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a model as it compiles without a named precision: in double."""
    made = tmp_path_factory.mktemp("default") / "c2_parallel.o"
    run("gcc", *FLAGS, "-c", GENERATED / "c2_parallel.c", "-o", made)
    return made


USER = """
#include "c2_parallel.h"
int main(void)
{
    c2_parallel_coefficients own;
    CALL;
    ECCENTRIC_REAL levels[2];
    c2_parallel_breakaway_torque(levels, &own);
    return levels[1] > 0;
}
"""


@pytest.mark.parametrize(
    "call",
    [
        "c2_parallel_prepare(&c2_parallel_default_parameters, &own)",
        "own = c2_parallel_default",
        "static c2_parallel_coefficients of_another_file; own = of_another_file",
    ],
)
def test_files_of_different_precision_do_not_link(tmp_path: Path, model: Path, call: str) -> None:
    """Coefficients in single precision are not read as double: all that makes or takes them names its own."""
    (tmp_path / "user.c").write_text(USER.replace("CALL", call))
    for real in ("float", "double"):
        options = [f"-DECCENTRIC_REAL={real}", f"-I{GENERATED}", "-c", "-o", tmp_path / f"{real}.o"]
        run("gcc", *FLAGS, *options, tmp_path / "user.c")
    linked = [model, "-o", tmp_path / "user", "-lm"]

    run("gcc", *FLAGS, tmp_path / "double.o", *linked)
    said = refused(tmp_path / "float.o", *linked)

    assert "undefined reference" in said
    assert "_float" in said


def test_both_precisions_are_in_one_program(tmp_path: Path) -> None:
    """Source and caller compiled twice link: each caller gets the coefficients of its own precision."""
    body = """#include "c2_parallel.h"
double PRECISION(void);
double PRECISION(void)
{
    c2_parallel_coefficients own;
    if (c2_parallel_prepare(&c2_parallel_default_parameters, &own) != 0) { return -1.0; }
    const ECCENTRIC_REAL prepared = c2_parallel_normal_force(3, 30, &own);
    return (double)(prepared - c2_parallel_normal_force(3, 30, &c2_parallel_default));
}
"""
    main = """double in_float(void);
double in_double(void);
static int wrong(double difference) { return (difference < -1e-5) || (difference > 1e-5); }
int main(void) { return wrong(in_float()) + 2 * wrong(in_double()); }
"""
    (tmp_path / "main.c").write_text(main)
    (tmp_path / "user.c").write_text(body)
    objects = []
    for real in ("float", "double"):
        options = [*FLAGS, f"-DECCENTRIC_REAL={real}", f"-DPRECISION=in_{real}", f"-I{GENERATED}", "-c"]
        for source in (GENERATED / "c2_parallel.c", tmp_path / "user.c"):
            objects.append(tmp_path / f"{real}_{source.stem}.o")
            run("gcc", *options, "-o", objects[-1], source)

    run("gcc", *FLAGS, "-o", tmp_path / "both", tmp_path / "main.c", *objects, "-lm")

    assert "" == run(tmp_path / "both")


@both_precisions
def test_models_share_a_translation_unit(tmp_path: Path, dtype: Real) -> None:
    """All models included in one file compile: nothing private has a name that two of them use."""
    (tmp_path / "all.c").write_text("".join(f'#include "{name}.c"\n' for name in MODELS))

    options = ("-fsyntax-only", f"-DECCENTRIC_REAL={REAL[dtype]}", f"-I{GENERATED}")
    assert "" == run("gcc", *FLAGS, *options, tmp_path / "all.c")


@pytest.mark.parametrize("compiler", ["g++", "clang++"])
@every_model
def test_header_is_cpp(tmp_path: Path, name: str, compiler: str) -> None:
    """The header includes from C++ and keeps C linkage."""
    need(compiler)
    source = tmp_path / "user.cpp"
    source.write_text(f'#include "{name}.h"\ntypedef {name}_coefficients user;\n')

    run(compiler, "-Wall", "-Wextra", "-Werror", "-fsyntax-only", f"-I{GENERATED}", source)
    assert 'extern "C"' in run(compiler, "-E", f"-I{GENERATED}", source)
