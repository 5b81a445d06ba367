"""Formulas as MathML: what they say is what the model computes, in letters, on lines that a page can hold."""

from __future__ import annotations

import re
from collections.abc import Mapping
from random import Random
from xml.etree import ElementTree as ET

import pytest
import sympy as sp

from eccentric.effects import Effect
from eccentric.model import Quantity, load_model, meaning, model_names, quantity
from eccentric.model import vocabulary as v
from eccentric.presentation.html.equation import typesetter_of
from eccentric.presentation.html.formulas import (
    Typesetter,
    equation,
    letter,
    plain,
    short_formula,
    with_symbols,
)
from tests.extended import CASES, effects
from tests.mathml import read, value

MARKS = {"*": "__star", "+": "__plus", "-": "__minus", "'": "__rate", "''": "__rate2", "0": "__zero"}


EFFECTS = {
    effect.id: effect
    for case in CASES
    for effect in effects(case).values()
    if not effect.evidence.repeats or "[n=2]" in effect.id
}
"""Every effect of the library once, of a family with one for each harmonic the second."""
every_effect = pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS)


def quantities_of(effect: Effect) -> list[Quantity]:
    """All that the effect brings along."""
    followed = (*effect.change.definitions, *effect.change.states)
    return [*effect.parameters, *(x.quantity for x in followed)]


def expressions(effect: Effect) -> list[sp.Expr]:
    """All that the effect computes: terms, definitions, updates of its states."""
    terms = [term.value for terms in effect.change.terms.values() for term in terms]
    return [
        *terms,
        sp.Add(*terms),
        *(d.value for d in effect.change.definitions),
        *(s.update for s in effect.change.states),
    ]


def computed(expression: sp.Expr, numbers: Mapping[sp.Symbol, float]) -> float:
    """The value of an expression of a model."""
    steps = {
        "sign": lambda x: (x > 0) - (x < 0),
        "Heaviside": lambda x, _: float(x > 0),
        "Max": max,
        "Min": min,
    }
    return sp.lambdify(list(numbers), meaning(expression), [steps, "math"])(*numbers.values())


def read_name(notation: str) -> str:
    """How `tests.mathml` calls a letter."""
    name, _, mark = notation.removeprefix("Delta ").partition("^")
    return name + MARKS.get(mark, "")


@every_effect
def test_formulas_of_an_effect_have_its_values(effect: Effect) -> None:
    """Read back from the page, every formula of an effect has the value of the record, at random inputs."""
    chance = Random(effect.id)  # noqa: S311 - no secret
    own = quantities_of(effect)
    known = {q.symbol: q for q in [*vars(v).values(), *own] if hasattr(q, "symbol")}
    for expression in expressions(effect):
        used = expression.free_symbols
        numbers = {
            s: chance.uniform(0.3, 2.5) * (-1 if s == v.omega_m.symbol and chance.random() < 0.5 else 1)
            for s in used
        }
        expected = computed(expression, numbers)
        typeset = Typesetter([*own, *(known[s] for s in used if s in known)])
        letters = {read_name(known[s].letter or known[s].name): x for s, x in numbers.items()}
        angle = numbers.get(v.mu.symbol, 0.0) * numbers.get(v.theta_m.symbol, 0.0)

        left, _, right = read(equation(typeset, "<mi>y</mi>", plain(expression)))
        actual = value(right, letters | {"theta_l": angle, "Delta": 1.0})

        assert expected == pytest.approx(actual if left == "y" else actual**0.5, rel=1e-3), right


@every_effect
def test_no_name_of_the_code_is_in_a_formula(effect: Effect) -> None:
    """What an effect brings along has letters: its formulas hold no name with an underscore."""
    own = quantities_of(effect)
    for expression in expressions(effect):
        mathml = Typesetter(own)(plain(expression))

        assert [] == [text for text in re.findall(r"<mi>([^<]*)</mi>", mathml) if "_" in text]


@pytest.mark.parametrize("name", model_names())
def test_the_friction_of_a_model_has_its_value(name: str) -> None:
    """Read back, the friction torque of a model is the sum of its terms, at random inputs."""
    model, chance = load_model(name), Random(name)  # noqa: S311 - no secret
    total = sp.Add(*(t.value for t in model.balance("mechanical").terms if t.kind == "friction"))
    quantities = {
        q.symbol: q for q in (*model.inputs, *model.parameters, *(d.quantity for d in model.definitions))
    }
    numbers = {s: chance.uniform(0.3, 2.5) for s in total.free_symbols}
    letters = {read_name(quantities[s].letter or s.name): x for s, x in numbers.items()}

    _, _, right = read(equation(typesetter_of(model), "<mi>y</mi>", plain(total)))

    assert computed(total, numbers) == pytest.approx(value(right, letters))


def test_letters() -> None:
    """Greek names are Greek, an index is below, a mark above; a name that is no letter stays as it is."""
    assert "<msub><mi>η</mi><mn>2</mn></msub>" == letter("eta_2")
    assert "<msubsup><mi>B</mi><mi>lN</mi><mo>+</mo></msubsup>" == letter("B_lN^+")
    assert "<mrow><mi>Δ</mi><msub><mi>k</mi><mi>e</mi></msub></mrow>" == letter("Delta k_e")
    assert "<mi>load_torque</mi>" == letter("load_torque")


@pytest.mark.parametrize(
    ("typed", "set_as"),
    [
        ("k_i and M_l.", "[k_i] and [M_l]."),
        ("only J_m + mu^2 J_l, R/k_i", "only [J_m] + [mu^2] [J_l], R/[k_i]"),
        ("B_lN_pos <&", "[B_lN_pos] &lt;&amp;"),
        # Names of files, columns and code, and units, are not symbols.
        ("a_1.csv, 'i_q', J_l_kgm2, theta_zero_rad, stribeck_v, load[F_N,d=2], 2 kg m^2", None),
    ],
)
def test_symbols_in_a_sentence_are_set(typed: str, set_as: str | None) -> None:
    """Letters with an index become MathML; everything else is escaped text."""
    expected = re.sub(r"\[(.*?)\]", lambda mark: f"<math>{letter(mark[1])}</math>", set_as or "")

    assert (expected if set_as else typed.replace("'", "&#x27;")) == with_symbols(typed)


def test_a_letter_of_two_quantities_stays_with_none_of_them() -> None:
    """Two effects that both write A are printed by their names in code; the paper's letters stay."""
    first, second = (quantity(name, "N m", "size", letter="A") for name in ("one_A", "two_A"))
    taken = quantity("own_M", "kg", "another mass", letter="M")
    typeset = Typesetter([v.M, first, second, taken])

    names = ["<mi>one_A</mi>", "<mi>two_A</mi>", "<mi>own_M</mi>", "<mi>M</mi>"]

    assert names == [typeset(q.symbol) for q in (first, second, taken, v.M)]


def test_a_long_sum_goes_one_term_to_a_line() -> None:
    """The torque that a gear passes on has a line each for gravity, inertia, friction by F_N and the rest."""
    effect = EFFECTS["load_dependent[transmitted]"]
    torque = effect.change.definitions[-1]
    typeset = Typesetter(quantities_of(effect))

    lines = ET.fromstring(equation(typeset, typeset(torque.symbol), plain(torque.value))).findall(".//mtr")  # noqa: S314

    shown = ["".join(line.itertext()) for line in lines]
    assert ["T=μMgLsinθl", "+μ2Jlαm", "+FN(BlN0μ2ωm+ClN0μsgnωm)", "+s(Bm0ωm+Cm0sgnωm)"] == shown


def test_a_root_too_long_for_a_line_is_shown_squared() -> None:
    """F = sqrt(sum) with a sum of two lines becomes F^2 = sum, both sides squared."""
    a, b = (sp.Symbol(f"{letter}_long_index_{k}", positive=True) for letter, k in (("a", 1), ("b", 2)))

    shown = equation(Typesetter(), letter("F_N"), sp.sqrt(a**2 + b**2 + a * b))

    assert "<msubsup><mi>F</mi><mi>N</mi><mn>2</mn></msubsup><mo>=</mo>" in shown
    assert "msqrt" not in shown


@pytest.mark.parametrize(
    ("typed", "shown"),
    [
        ("eta |T| sgn w driving, T = G", "η|T|sgnω driving, T=G"),
        ("A exp((cos(theta_l - theta_0) - 1)/sigma^2)", "Aexp((cos(θl−θ0)−1)/σ2)"),
        ("friction times 1 + rate t", "friction times 1+ratet"),
        ("D sqrt(|w|/w_ref) for w > 0 only", "D√(|ω|/ωref) for ω>0 only"),
        ("R (1 + r rise) for R, d(rise)/dt < 1", "R(1+rrise) for R, d(rise)/dt<1"),
        ("a back-driven <b>", "a back-driven <b>"),
    ],
)
def test_a_typed_formula_keeps_its_words(typed: str, shown: str) -> None:
    """Letters become Greek, words stay words, names next to a sign belong to the formula, text is text."""
    html = short_formula(typed)

    assert shown == "".join(ET.fromstring(f"<p>{html}</p>").itertext())  # noqa: S314 - made here


def test_powers_and_indices_of_a_typed_formula_are_set() -> None:
    """What follows ^ is raised, what follows _ lowered, and d2i is a second derivative."""
    assert "<msup><mrow><mi>d</mi></mrow><mn>2</mn></msup>" not in short_formula("q d2i/dt2")
    assert "<msup><mi>d</mi><mn>2</mn></msup><mi>i</mi>" in short_formula("q d2i/dt2")
    assert "<msup><mi>width</mi><mn>2</mn></msup>" in short_formula("1/width^2")
    assert "<msub><mi>T</mi><mn>0</mn></msub>" in short_formula("T - T_0")
