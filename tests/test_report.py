"""report.html: what it says, in which order, for whom."""

import json
import re
import sys
from dataclasses import replace
from itertools import pairwise

import jinja2
import numpy as np
import pytest
from jinja2 import meta

import eccentric.presentation.html as package
from eccentric.core import folder
from eccentric.presentation.html import page
from eccentric.presentation.html.data import Correlations, Errors
from eccentric.presentation.html.text import number, why
from eccentric.presentation.html.view import view
from tests.page_reader import Reader, figures_of
from tests.reported import ADOPTED, HOSTILE, RIVAL, balance_of, changed, nothing_missing, rows_of, sample

VERDICTS = ("named", "not_identifiable", "unexplained", "nothing_missing")


@pytest.fixture(scope="module")
def plain() -> str:
    """The page of a log like others."""
    return page(sample())


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without figures, a page takes no time."""
    monkeypatch.setattr(package, "library", str)


def test_the_verdict_comes_first(plain: str) -> None:
    """The sentence precedes every section, and the sections follow the order of the questions."""
    text = Reader(plain).text
    headings = [
        "Missing: wobble[n=2].", "Error before and after", "Residual versus each channel",
        "Friction torque",
        "The held-out part over time", "Candidates considered", "Parameters", "The model as an equation",
        "Data quality", "What to measure next", "How to reproduce",
    ]  # fmt: skip
    places = [text.index(heading) for heading in headings]

    assert sorted(places) == places


@pytest.mark.usefixtures("undrawn")
def test_symbols_have_subscripts() -> None:
    """In sentences, warnings, facts and tables, B_lN is typeset; only code keeps its underscores."""
    data = sample(
        500,
        sentence="k_i is off.",
        closest="M_l too.",
        next_measurement="Weigh M_l.",
        warnings=("J_l is unknown",),
        correlations=Correlations(("B_lN", "C_lN", "wobble_s2"), np.eye(3)),
    )
    found = page(data)
    text = re.sub(r"<(code|pre|style).*?</\1>", "", found, flags=re.DOTALL)

    assert [] == re.findall(r"\b[A-Za-z]_[A-Za-z0-9]+", text)
    assert 9 == text.count("<msub>")
    assert "<code>wobble_s2</code>" in found


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("verdict", VERDICTS)
def test_headings_are_in_order(verdict: str) -> None:
    """One first heading, and no level is left out on the way down."""
    reader = Reader(page(sample(500, verdict=verdict)))
    levels = [int(tag[1]) for tag, _ in reader.tags if re.fullmatch(r"h[1-6]", tag)]

    assert 1 == levels[0] == levels.count(1)
    assert all(after <= before + 1 for before, after in pairwise(levels))


def test_figures_are_told_in_words(plain: str) -> None:
    """Every plot has a text alternative with numbers, every figure a caption; the page says its language."""
    reader = Reader(plain)
    plots = [attributes for tag, attributes in reader.tags if attributes.get("class") == "plot"]

    # Four channels, friction over velocity and angle, friction and residual along time.
    assert 8 == len(plots)
    assert all(p["role"] == "img" and re.search(r"\d N m", p["aria-label"] or "") for p in plots)
    assert reader.count("figure") == reader.count("figcaption") == 8  # and the first picture
    assert ("html", {"lang": "en"}) in reader.tags


def test_without_bokeh_the_report_is_words_and_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bokeh missing, everything else is there and the page says how to get the figures."""
    monkeypatch.setitem(sys.modules, "bokeh", None)
    text = page(sample())
    reader = Reader(text)

    assert 'pip install "eccentric[report]"' in reader.text
    assert (0, 1) == (reader.count("script"), reader.count("figcaption"))
    assert "wobble_s2" in reader.text


def test_the_page_is_written_without_importing_bokeh(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its scripts are files; its Python half would take longer than the rest of the report."""
    for name in [name for name in sys.modules if name.split(".")[0] == "bokeh"]:
        monkeypatch.delitem(sys.modules, name)

    assert "Bokeh" in page(sample(500))
    assert "bokeh" not in sys.modules


def test_a_tenth_of_a_millinewton_metre_is_labelled_as_a_decimal(plain: str) -> None:
    """The axis writes powers of ten only for what is smaller."""
    (exponent,) = re.findall(r"power_limit_low = ([-+]?\d+);", plain)

    assert 10.0 ** int(exponent) < 1e-4


def test_the_figures_carry_what_was_planted(plain: str) -> None:
    """0.03 sin(2 theta_l) over the link angle, which comes first, with labels and units."""
    first = json.loads(figures_of(plain))[0]
    (plot,) = first["plots"]
    at, effect = (np.array(first["columns"][name]) for name in ("at", "effect"))

    # The same page in every process: no order is that of a set.
    ends = [f"{name}_{end}" for name in ("before", "after") for end in ("low", "high")]
    assert ["at", "rows", "before", "after", "effect", *ends] == list(first["columns"])
    assert ("link angle [rad]", "residual × sgn ω [N m]", "N m") == (first["x"], plot["y"], first["unit"])
    assert ["paper's model", "extended model", "fitted effect"] == [c["label"] for c in plot["curves"]]
    assert [True, True, False] == [curve["bars"] for curve in plot["curves"]]
    assert first["turn"]
    assert 5000 == sum(first["columns"]["rows"])
    # A bin is a sixtieth of a turn wide: its mean is within the square of that of the value in the middle.
    assert np.allclose(0.03 * np.sin(2 * at), effect, atol=0.03 * (2 * np.pi / 60) ** 2)
    low, high = (np.array(first["columns"][f"before_{end}"]) for end in ("low", "high"))
    assert np.all(low < high)


def test_the_figures_carry_friction_and_the_held_out_part() -> None:
    """Friction with a curve that is hidden at first; two plots along time that share their columns."""
    friction, trace = json.loads(figures_of(page(sample(5000, 2))))[-2:]
    (plot,) = friction["plots"]
    upper, lower = trace["plots"]

    assert ["measured", "Coulomb + viscous", "paper's model", "extended model"] == [
        curve["label"] for curve in plot["curves"]
    ]
    assert ["linear"] == [curve["name"] for curve in plot["curves"] if curve["hidden"]]
    assert ("friction [N m]", "residual [N m]") == (upper["y"], lower["y"])
    assert ["run 1", "run 2"] == trace["runs"]
    # Two held-out stretches in each of two runs, a gap between two of them.
    assert 3 == len(trace["cuts"]) == trace["columns"]["at"].count(None)
    assert {0, 1, -1} == set(trace["columns"]["run"])
    measured, paper, before = (
        np.array(trace["columns"][name][:5]) for name in ("measured", "paper", "before")
    )
    assert np.allclose(before, measured - paper, atol=1e-7)


def test_a_rig_in_volts_has_no_newton_metres() -> None:
    """The unit of a residual is that of its balance, everywhere."""
    text = page(sample(500, unit="V"))

    assert " V" in Reader(text).text
    assert "N m" not in Reader(text).text
    assert "N m" not in figures_of(text)


@pytest.mark.usefixtures("undrawn")
def test_a_gain_that_is_clear_below_the_low_pass_only_is_shown_there() -> None:
    """The figures beside the verdict are those of its sentence; no fall is claimed of the rows."""
    data = sample(50)
    below = Errors(
        "below 25 Hz, the cut-off frequency of the angle",
        "N m",
        {"paper": 0.5, "extended": 0.1},
        (70.0, 90.0),
    )
    text = Reader(page(replace(data, errors=replace(data.errors, below=below)))).text

    assert "held-out error below 25 Hz, the cut-off frequency of the angle" in text
    assert "0.5 → 0.1 N m" in text
    assert "reduction (95 % interval 70 to 90 %)" in text
    assert "80 %" in text
    assert "falls by" in Reader(page(data)).text
    assert "falls by" not in text


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("n", [50, 5000])
@pytest.mark.parametrize("verdict", VERDICTS)
def test_every_verdict_has_a_report(verdict: str, n: int) -> None:
    """Each verdict has its own word, on a log of 50 rows as on a long one."""
    data = sample(n, verdict=verdict, tied=("wobble", "dent") if verdict == "not_identifiable" else ())
    text = Reader(page(nothing_missing(data) if verdict == "nothing_missing" else data)).text
    words = {
        "named": "effect named",
        "not_identifiable": "not identifiable",
        "unexplained": "structure unexplained",
        "nothing_missing": "nothing missing",
    }

    assert [verdict] == [v for v, word in words.items() if word in text]
    assert ("Undecided between wobble[n=2] and a dent (dent)" in text) == (verdict == "not_identifiable")
    assert ("extended model" in text) == (verdict != "nothing_missing")


def test_a_log_with_few_signals_has_fewer_figures() -> None:
    """No channel but time: its residual and the traces are drawn, nothing else is required."""
    data = sample()
    (balance,) = data.errors.balances
    rows = replace(balance.rows, channels=balance.rows.channels[-1:])
    reader = Reader(page(changed(data, balances=(replace(balance, rows=rows, measured=None, linear=None),))))

    assert 2 == sum(attributes.get("class") == "plot" for _, attributes in reader.tags)


def test_the_second_balance_is_drawn_where_it_was_extended() -> None:
    """Residuals of the electrical balance are shown if an effect was adopted in it, errors always."""
    electrical = replace(balance_of(rows_of(500)), name="electrical", measured=None, linear=None)
    shown = {
        adopted: Reader(page(sample(500, balances=(balance_of(rows_of(500)), balance)))).text
        for adopted, balance in ((True, electrical), (False, replace(electrical, extended=None)))
    }

    assert all("electrical balance [N m]" in text for text in shown.values())
    assert [True, False] == ["Residual of the electrical balance" in text for text in shown.values()]


@pytest.mark.usefixtures("undrawn")
def test_further_errors_have_their_bars() -> None:
    """Errors on other parts of the log are shown beside those of the balances, with their remark."""
    errors = Errors(
        "every run left out once", "N m", {"paper": 0.02, "extended": 0.01}, (40.0, 60.0), "9 of 10."
    )
    text = Reader(page(sample(500, further=(errors,)))).text

    assert "every run left out once [N m]" in text
    assert "0.008 to 0.012 N m" in text
    assert "9 of 10." in text


@pytest.mark.usefixtures("undrawn")
def test_what_an_effect_is_comes_before_its_id() -> None:
    """In the list of candidates, at the equation and at the hint a person reads words first."""
    text = " ".join(Reader(page(sample(500, tied=("dent",)))).text.split())

    assert "a dentdent" in text  # two lines of one cell
    assert "a shaft that wobbles (wobble[n=2]): ssin" in text  # the space is MathML's
    assert "To separate a dent (dent) from other effects: turns." in text


def test_why_the_runner_up_lost() -> None:
    """The sentence compares the errors of the same balance: 0.004 is twice 0.002."""
    elsewhere = replace(RIVAL, id="other", balance="electrical", rmse=0.001)
    (sentence,) = why(sample(50, candidates=(ADOPTED, elsewhere, RIVAL)))

    assert "dent leaves an error of 0.004 N m" in sentence
    assert "2 times the 0.002 N m of wobble[n=2] (probability" in sentence


def test_the_runner_up_lost_to_the_effect_in_whose_place_it_would_be() -> None:
    """Beside two effects: the second one is its rival, not the first of the list."""
    second = replace(ADOPTED, id="second", family="second", rmse=0.003)
    rival = replace(RIVAL, instead_of="second")
    first = why(sample(50, candidates=(ADOPTED, second, rival)))[0]

    assert "1.33 times the 0.003 N m of second" in first


def test_probabilities_of_several_effects_are_said_to_be_their_own() -> None:
    """Of one effect they add up, of two not: only then a sentence says so."""
    second = replace(ADOPTED, id="second", family="second")
    one, two = ([*why(sample(50, candidates=(*own, RIVAL)))] for own in ((ADOPTED,), (ADOPTED, second)))

    assert "the probabilities of several do not add up to 1" in two[-1]
    assert not any("add up to 1" in sentence for sentence in one)


@pytest.mark.parametrize(
    ("value", "digits", "expected"),
    [(-0.03376, 4, "−0.03376"), (6.2e-05, 2, "6.2 × 10⁻⁵"), (1.2e7, 3, "1.2 × 10⁷"), (0.0, 4, "0")],
)
def test_numbers_are_set_as_numbers(value: float, digits: int, expected: str) -> None:
    """Real minus signs and powers of ten."""
    assert expected == number(value, digits)


def test_a_long_log_stays_small() -> None:
    """The page of 100,000 rows is below 5 MB."""
    assert len(page(sample(100_000, 4)).encode()) < 5e6


def test_templates_use_what_they_are_given() -> None:
    """The templates of the report use exactly the names that its view has; arms and fleets have their own."""
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(folder("templates")), autoescape=True)
    used: set[str] = set()
    others = {"arm.html.jinja", "fleet.html.jinja"}
    for path in (folder("templates") / "report").glob("*.jinja"):
        if path.name in others:
            continue
        used |= meta.find_undeclared_variables(environment.parse(path.read_text(encoding="utf-8")))

    assert {*view(sample(50), ""), "symbols"} == used


# Nothing that comes from a log, a rig or a user becomes markup.


FORMULA = {
    *("math", "mrow", "mi", "mn", "mo", "msup", "msub", "msubsup", "mfrac", "mspace", "mtable", "mtr", "mtd"),
    "wbr",
}
"""The elements of a typeset formula; a user's own effect may bring one along."""


@pytest.fixture(scope="module")
def hostile() -> str:
    """The page of a log whose every name is an attack."""
    return page(sample(text=HOSTILE))


def test_nothing_from_a_log_becomes_markup(hostile: str) -> None:
    """Hostile names of files, columns, runs and effects change no element but the letters of a formula."""
    before, after = Reader(page(sample())), Reader(hostile)

    pages = [[(tag, names) for tag, names in one.tags if tag not in FORMULA] for one in (before, after)]
    assert [tag for tag, _ in pages[0]] == [tag for tag, _ in pages[1]]
    assert {"stretchy", "form", "width", "display", "class"} >= {
        name for tag, names in after.tags if tag in FORMULA for name in names
    }
    assert 0 == after.count("img")
    assert f"made{HOSTILE}.csv" in after.text


def test_the_json_of_the_figures_ends_no_script(hostile: str) -> None:
    """A run's name with a closing tag arrives in the figures' JSON letter by letter, without a "<" in it."""
    content = figures_of(hostile)

    assert "<" not in content
    assert f"run 1{HOSTILE}" in json.dumps(json.loads(content), ensure_ascii=False).replace('\\"', '"')


def test_axis_labels_are_data(hostile: str) -> None:
    """A channel's name with markup and dollar signs is a label in the JSON, letter by letter."""
    labels = [figure["x"] for figure in json.loads(figures_of(hostile))]

    assert f"link angle{HOSTILE} [rad]" == labels[0]
    assert 6 == sum(HOSTILE in label for label in labels)
