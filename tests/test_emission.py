"""Emission: the Program's passes, the templates' holes, generated/ is fresh, what the files depend on."""

import re
import subprocess
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import cffi
import jinja2
import jinja2.meta
import numpy as np
import pytest
import sympy as sp

from eccentric import __version__
from eccentric.cli import main
from eccentric.compiled.module import view as compiled_view
from eccentric.core import folder
from eccentric.emission import (
    BACKENDS,
    build_program,
    check,
    complete,
    differences,
    executed,
    load_module,
    render,
    render_program,
)
from eccentric.emission.program import Program, Routine, prepare
from eccentric.model import Assignment, Input, differentiate, load_model, model_names, needed, quantity
from generated import c2_parallel
from tests.compiled import FLAGS

ROOT = Path(__file__).resolve().parent.parent


@pytest.mark.parametrize("name", model_names())
def test_generated_files_are_fresh(name: str) -> None:
    """What is committed is what would be derived now, byte for byte, without a date or an absolute path."""
    files = complete(load_model(name))
    diff = differences(files, ROOT / "generated")

    assert "" == diff, f"generated/ is stale; mend it with: make derive\n{diff}"
    for file, text in files.items():
        assert re.search(r"\b20\d\d-\d\d|(?<![\w.])/(?:home|root|tmp|usr|work)/", text) is None
        assert file.startswith("check/") or __version__ in text.split("\n\n")[0]


def test_generated_holds_no_orphan() -> None:
    """Every generated file belongs to a derivation."""
    known = {f"{name}{suffix}" for name in model_names() for suffix in (".py", ".h", ".c")}
    found = {p.name for p in (ROOT / "generated").iterdir() if p.suffix in {".py", ".h", ".c"}}

    assert known | {"__init__.py", "eccentric_runtime.py"} == found


def test_every_template_uses_exactly_the_keys_it_is_given() -> None:
    """No hole without a value, no value without a hole."""
    model = load_model("c2_parallel")
    program, checks = build_program(model), check.views(model, render(model))
    views = [([*b.files, *b.single_file], b.view(program, "00000000")) for b in BACKENDS.values()]
    views += [
        (["check/selftest.c", "check/vectors.h"], checks["selftest.c"]),
        (["check/proof.c"], checks["proof.c"]),
        (["compiled/python.c"], compiled_view(program)),
    ]
    environment = jinja2.Environment()  # noqa: S701 - it only parses
    seen = set()
    for names, view in views:
        holes = set().union(*(_holes(environment, f"{name}.jinja", seen) for name in names))
        assert holes == set(view), names
    folders = (*BACKENDS, "python", "check", "compiled")
    emitted = {f"{name}/{p.name}" for name in folders for p in (folder("templates") / name).iterdir()}
    assert seen == emitted, "a template that nothing uses"


def _holes(environment: jinja2.Environment, name: str, seen: set[str]) -> set[str]:
    seen.add(name)
    source = (folder("templates") / name).read_text(encoding="utf-8")
    tree = environment.parse(source)
    holes = jinja2.meta.find_undeclared_variables(tree)
    for included in jinja2.meta.find_referenced_templates(tree):
        holes |= _holes(environment, str(included), seen)
    return holes


@pytest.mark.parametrize("name", model_names())
def test_every_coefficient_says_what_it_is(name: str) -> None:
    """Coefficients have names that all compilers distinguish, and a comment; none is another's negative."""
    program = build_program(load_model(name))
    notes = dict(program.notes)
    names = [symbol.name for symbol in program.coefficients]

    assert [one for one in names if len(one) > 31 or not notes.get(one)] == []
    assert [one for one in names if re.match(r"minus_|constant|coefficient", one)] == []
    header = (ROOT / "generated" / f"{name}.h").read_text(encoding="utf-8")
    assert [one for one in names if not re.search(rf"ECCENTRIC_REAL {one}; /\*\*< \S", header)] == []


def chain(n: int) -> Program:
    """Weighted sum of squared absolute angles of a planar chain of n links, and its slopes."""
    angles = Input(quantity("theta", "rad", "joint angles", "", "real"), n)
    mass, weight = quantity("m", "kg", "mass", "", "positive", "2"), sp.Symbol("weight", real=True)
    assignments: list[Assignment] = []
    for k, theta in enumerate(angles.symbols):
        before = assignments[-1].target if assignments else sp.Integer(0)
        assignments.append(Assignment(sp.Symbol(f"angle_{k}", real=True), before + theta))
    total = sp.Symbol("total", real=True)
    assignments.append(Assignment(total, weight * sp.Add(*(a.target**2 for a in assignments))))
    derived, names = differentiate(assignments, angles.symbols)
    slopes = [names[total, theta] for theta in angles.symbols]
    steps = needed(derived, slopes)
    labels = tuple(theta.name for theta in angles.symbols)
    value = Routine("total", (angles,), tuple(assignments), (total,), (), "N rad^2", "weighted sum")
    gradient = Routine(
        "slopes", (angles,), steps, tuple(slopes), labels, "N rad", "slopes of the weighted sum"
    )
    prepare = (Assignment(weight, 3 * mass.symbol),)
    return Program("chain", "Planar chain", (mass,), prepare, (weight,), (value, gradient))


@pytest.mark.parametrize("n", [1, 2, 5])
def test_chain_of_links_needs_no_rewrite(n: int, tmp_path: Path) -> None:
    """A Program with a vector input, differentiated assignment by assignment, runs in NumPy and in C."""
    files = render_program(chain(n), "a test", "a test")
    module = executed(files, "chain")
    theta = np.random.default_rng(n).uniform(-2, 2, (7, n))
    sums = np.cumsum(theta, axis=-1)
    # By hand: 3 m = 6 times the squared partial sums; by theta_k 12 times the sum of those from k on.
    by_hand = 6 * 2 * np.cumsum(sums[:, ::-1], axis=-1)[:, ::-1]

    np.testing.assert_allclose(module.total(theta), 6 * np.sum(sums**2, axis=-1), rtol=1e-14)
    np.testing.assert_allclose(module.slopes(theta), by_hand, rtol=1e-13)
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    library = cffi.FFI()
    library.cdef(
        "typedef struct { double weight; } chain_coefficients;extern chain_coefficients chain_default_double;"
    )
    library.cdef("void chain_slopes_double(const double *theta, double *out, const chain_coefficients *c);")
    subprocess.run(
        ["gcc", *FLAGS, "-shared", "-fPIC", "chain.c", "-o", "chain.so", "-lm"], check=True, cwd=tmp_path
    )
    compiled: Any = library.dlopen(str(tmp_path / "chain.so"))
    out = np.empty(n)
    compiled.chain_slopes_double(
        library.cast("double *", theta[0].ctypes.data),
        library.cast("double *", out.ctypes.data),
        library.addressof(compiled, "chain_default_double"),
    )

    np.testing.assert_array_equal(out, module.slopes(theta[0]))


def test_derivatives_are_taken_assignment_by_assignment() -> None:
    """Nested definitions stay names in the derivative: it grows with the chain, not with its expansion."""
    sizes = [sum(a.value.count_ops() for a in chain(n).routines[1].assignments) for n in (4, 8, 16)]

    # n links have n slopes through at most n assignments each: no faster than quadratic growth.
    assert sizes[1] <= 4.5 * sizes[0]
    assert sizes[2] <= 4.5 * sizes[1]


def test_hot_loaded_module_is_the_committed_one() -> None:
    """The fit runs what is shipped."""
    module = load_module(load_model("c2_parallel"))
    assert c2_parallel.friction_torque(1.0, 2.0) == module.friction_torque(1.0, 2.0)
    assert load_module(load_model("c2_parallel")) is module


def test_emit_takes_a_path_and_a_prefix(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A derivation of one's own is emitted by its path; the prefix names files and C functions."""
    script = tmp_path / "mine.py"
    script.write_text(
        "from dataclasses import replace\nfrom eccentric.model import load_model\n"
        "model = replace(load_model('c2_parallel'), name='mine', title='My arm')\n",
        encoding="utf-8",
    )
    assert 0 == main(["emit", str(script), "--prefix", "arm", "--out", str(tmp_path / "out")])

    assert {"arm.py", "arm.h", "arm.c"} <= {p.name for p in (tmp_path / "out").iterdir()}
    assert "arm_friction_torque" in (tmp_path / "out" / "arm.c").read_text(encoding="utf-8")
    assert "arm.py, eccentric_runtime.py, arm.h, arm.c" in capsys.readouterr().out


def test_emit_takes_fitted_parameters(tmp_path: Path) -> None:
    """Fitted values become the defaults, with their remarks as comments."""
    fit = tmp_path / "fit.json"
    fit.write_text(
        '{"parameters": {"B_m": 0.00123, "J_m": 2e-5},'
        ' "parameter_notes": {"B_m": "0.0012 to 0.0013 (95 %)"}}',
        encoding="utf-8",
    )
    main(["emit", "c2_parallel", "--parameters", str(fit), "--out", str(tmp_path / "out")])
    text = (tmp_path / "out" / "c2_parallel.py").read_text(encoding="utf-8")

    assert 'B_m: float = runtime.nonnegative(0.00123, "N m s/rad")' in text
    assert "0.0012 to 0.0013 (95 %)" in text
    assert 'J_m: float = runtime.nonnegative(2e-05, "kg m^2")' in text


NASTY = """Arm */ 3 /* of "two" \\N{x} ''' \"\"\" \n\x00 \u2028 ends in a \\"""


def test_free_text_stays_in_comments(tmp_path: Path) -> None:
    """No title, meaning, unit or remark ends a comment or a docstring, whatever it contains."""
    base = load_model("c2_parallel")
    meant = {q.symbol.name: replace(q, meaning=NASTY, unit=NASTY, equation=NASTY) for q in base.parameters}
    speed = replace(base.definition("speed").quantity, meaning=NASTY)
    model = replace(
        base,
        title=NASTY,
        parameters=tuple(meant.values()),
        inputs=tuple(replace(q, meaning=NASTY) for q in base.inputs),
        definitions=tuple(
            replace(d, quantity=speed) if d.symbol == speed.symbol else d for d in base.definitions
        ),
    )
    for name, text in render(model, NASTY, NASTY).items():
        (tmp_path / name).write_text(text, encoding="utf-8")

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        compile((tmp_path / "c2_parallel.py").read_text("utf-8"), "c2_parallel.py", "exec")
    subprocess.run(["gcc", *FLAGS, "-fsyntax-only", tmp_path / "c2_parallel.c"], check=True)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ('{"parameters": {"B_m": -1}}', "B_m: expected a nonnegative number, got -1"),
        ('{"parameters": {"mu": 0}}', "mu: expected a positive number, got 0"),
        ('{"model": "c2_asymmetric", "parameters": {"M": 1}}', "expected a fit of c2_parallel, got"),
        ('{"parameters": {"B_x": 1}}', "B_x: c2_parallel has no such parameter"),
        ('{"parameters": {"B_m": "a"}}', "B_m: expected a finite number, got 'a'"),
        (
            "{",
            "fit.json: expected the fit.json of `eccentric fit`, or JSON with `parameters` like it, got",
        ),
        ("[]", "an object `parameters`"),
    ],
)
def test_bad_fit_file_is_one_line(
    content: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A fit file that cannot be used is named with what is wrong in it, and nothing is written."""
    fit = tmp_path / "fit.json"
    fit.write_text(content, encoding="utf-8")
    status = main(["emit", "c2_parallel", "--parameters", str(fit), "--out", str(tmp_path / "out")])
    error = capsys.readouterr().err

    assert 2 == status
    assert 1 == error.count("\n")
    assert said in error
    assert not (tmp_path / "out").exists()


def test_derive_writes_all_or_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A derivation that cannot be emitted keeps the one before it from being written, too."""
    script = tmp_path / "mine.py"
    script.write_text(MINE + "with_term(v.B_m.symbol, sp.tanh(w))", encoding="utf-8")

    status = main(["derive", "c1_perpendicular", str(script), "--out", str(tmp_path / "out")])

    assert 2 == status
    assert "term mine" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


MINE = """
from dataclasses import replace
import sympy as sp
from eccentric.model import Role, Term, load_model, vocabulary as v
base = load_model("c2_parallel")
def with_term(coefficient, basis):
    balance = base.balance("mechanical")
    term = Term("mine", "friction", coefficient, basis, "mine", role=Role.DRAG)
    balance = replace(balance, terms=(*balance.terms, term))
    return replace(base, name="mine", balances=(balance, base.balance("electrical")))
w = v.omega_m.symbol
model = """


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ("raise RuntimeError('no')", "RuntimeError: no"),
        ("x = 1", "a module-level `model`"),
        ("from eccentric.model import load_model\nmodel = load_model(__file__)", "in a circle"),
        (MINE + "with_term(v.B_m.symbol, sp.tanh(w))", "model mine: term mine: tanh(omega_m): expected +, -"),
        (MINE + "with_term(v.B_m.symbol, sp.sin(w))", "model mine: term mine: sin(omega_m): expected +, -"),
        (
            MINE + "with_term(v.B_m.symbol, sp.Piecewise((w, w > 1), (0, True)))",
            "model mine: term mine: Piecewise",
        ),
        (MINE + "with_term(sp.Integer(1), w * sp.Abs(w))", "model mine: term mine: expected a parameter"),
        (MINE + "with_term(v.B_lT.symbol, w)", "model mine: term mine uses B_lT, which nothing defines"),
        (
            MINE + "with_term(v.M.symbol, w)",
            "model mine: terms motor_viscous, mine: no log distinguishes them",
        ),
        (MINE + "replace(base, name='mine', balances=())", "model mine: expected a balance `mechanical`"),
        (MINE + "replace(base, name='My arm')", "its name: expected a lower-case C identifier"),
        (MINE + "replace(base, name='lambda')", "its name: expected a lower-case C identifier"),
    ],
    ids=[
        *("raises", "without model", "circle", "unknown function", "function of prepare only", "condition"),
        *("no coefficient", "undefined", "nameless combination", "no balance", "bad name", "keyword"),
    ],
)
def test_bad_derivation_is_one_line(
    source: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A derivation that cannot be loaded or emitted is named with the reason, its model and term."""
    script = tmp_path / "bad.py"
    script.write_text(source, encoding="utf-8")
    status = main(["emit", str(script), "--out", str(tmp_path / "out")])
    error = capsys.readouterr().err

    assert 2 == status
    assert 1 == error.count("\n")
    assert said in error


def test_a_difference_of_letters_is_called_minus() -> None:
    """A coefficient has the name of its formula."""
    k_e, k_i = sp.symbols("k_e k_i", positive=True)

    assert "k_e_minus_k_i" == prepare._name(k_e - k_i, "driving")
