"""report.html: what it says, in which order, for whom; nothing from a log or a rig becomes markup."""

import ast
import json
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path

import jinja2
import numpy as np
import pytest
import sympy as sp
from jinja2 import meta
from reported import ADOPTED, HOSTILE, RIVAL, balance_of, nothing_missing, rows_of, sample

from eccentric.cli import diagnose as command
from eccentric.cli import main
from eccentric.effects import Setting, library
from eccentric.identify import report as package
from eccentric.identify.diagnose import Diagnosis, diagnose
from eccentric.identify.model_script import script
from eccentric.identify.report import page, report_data
from eccentric.identify.report.data import Errors
from eccentric.identify.report.equation import friction_equations
from eccentric.identify.report.text import number, why
from eccentric.identify.report.view import view
from eccentric.model import load_model, quantity
from eccentric.places import folder

ROOT = Path(__file__).resolve().parent.parent
LOG, RIG = ROOT / "examples" / "bench" / "bench.csv.gz", ROOT / "examples" / "bench" / "bench.json"
VERDICTS = ("named", "not_identifiable", "unexplained", "nothing_missing")


class Reader(HTMLParser):
    """Start tags with their attributes in order, and the text outside of scripts and styles."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text, self._inside = "", ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Remember it."""
        self.tags.append((tag, dict(attrs)))
        self._inside = tag

    def handle_data(self, data: str) -> None:
        """Keep what a person reads."""
        if self._inside not in {"script", "style"}:
            self.text += data

    def count(self, *names: str) -> int:
        """Elements of these names."""
        return sum(tag in names for tag, _ in self.tags)


@pytest.fixture(scope="module")
def found() -> Diagnosis:
    """The diagnosis of the bundled log."""
    return diagnose([LOG], RIG)


@pytest.fixture(scope="module")
def plain() -> str:
    """The page of a log like others."""
    return page(sample())


@pytest.fixture(scope="module")
def hostile() -> str:
    """The page of a log whose every name is an attack."""
    return page(sample(text=HOSTILE))


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without figures, a page takes no time."""
    monkeypatch.setattr(package, "_figures", lambda: None)


def figures_of(text: str) -> str:
    """The JSON of the figures of a page."""
    (content,) = re.findall(r'<script type="application/json" id="figures">(.*?)</script>', text, re.DOTALL)
    return content


def test_the_verdict_comes_first(plain: str) -> None:
    """The sentence stands before every section, and the sections come in the order of the questions."""
    text = Reader(plain).text
    headings = [
        "The model lacks wobble[n=2].", "Error before and after", "What is left", "Friction torque",
        "The held-out part in time", "What was considered", "Parameters", "The model as an equation",
        "Quality of the data", "What to measure next", "How to reproduce",
    ]  # fmt: skip
    places = [text.index(heading) for heading in headings]

    assert sorted(places) == places


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
    assert reader.count("figure") == reader.count("figcaption") == 7
    assert ("html", {"lang": "en"}) in reader.tags


def test_nothing_from_a_log_becomes_markup(plain: str, hostile: str) -> None:
    """Hostile names of files, columns, runs and effects change neither elements nor scripts of the page."""
    before, after = Reader(plain), Reader(hostile)

    assert [tag for tag, _ in before.tags] == [tag for tag, _ in after.tags]
    assert 0 == after.count("img")
    assert f"made{HOSTILE}.csv" in after.text


def test_the_json_of_the_figures_ends_no_script(hostile: str) -> None:
    """A run's name with a closing tag arrives in the figures' JSON letter by letter, without a "<" in it."""
    content = figures_of(hostile)

    assert "<" not in content
    assert f"run 1{HOSTILE}" in json.dumps(json.loads(content), ensure_ascii=False).replace('\\"', '"')


def test_axis_labels_are_never_tex(hostile: str) -> None:
    """No text between dollar signs is handed to Bokeh as a string, which would fetch a typesetter for it."""
    content = json.loads(figures_of(hostile))

    def labels(node: object) -> list[object]:
        if isinstance(node, list):
            return [label for one in node for label in labels(one)]
        if not isinstance(node, dict):
            return []
        own = [node["axis_label"]] if "axis_label" in node else []
        return own + [label for one in node.values() for label in labels(one)]

    found = labels(content)
    assert ["PlainText"] * 16 == [label["name"] if isinstance(label, dict) else label for label in found]


def test_without_bokeh_the_report_is_words_and_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bokeh missing, everything else is there and the page says how to get the figures."""
    for name in [name for name in sys.modules if name.split(".")[0] == "bokeh"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "bokeh", None)
    monkeypatch.delitem(sys.modules, "eccentric.identify.report.figures", raising=False)
    monkeypatch.delattr(package, "figures", raising=False)
    text = page(sample())
    reader = Reader(text)

    assert 'pip install "eccentric[report]"' in reader.text
    assert (0, 7) == (reader.count("script"), reader.count("figcaption"))
    assert "wobble_s2" in reader.text


def test_a_rig_in_volts_has_no_newton_metres() -> None:
    """The unit of a residual is that of its balance, everywhere."""
    text = page(sample(500, unit="V"))

    assert " V" in Reader(text).text
    assert "N m" not in Reader(text).text
    assert "N m" not in figures_of(text)


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
    assert ("Undecided between wobble[n=2] and dent" in text) == (verdict == "not_identifiable")
    assert ("extended model" in text) == (verdict != "nothing_missing")


def test_a_log_with_few_signals_has_fewer_figures() -> None:
    """No channel but time: its residual and the traces are drawn, nothing else is asked for."""
    data = sample()
    (balance,) = data.balances
    rows = replace(balance.rows, channels=balance.rows.channels[-1:])
    reader = Reader(page(replace(data, balances=(replace(balance, rows=rows, measured=None, linear=None),))))

    assert 2 == sum(attributes.get("class") == "plot" for _, attributes in reader.tags)


@pytest.mark.usefixtures("undrawn")
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


def test_why_the_runner_up_lost() -> None:
    """The sentence compares the errors of the same balance: 0.004 against 0.002 is 100 % more."""
    elsewhere = replace(RIVAL, id="other", balance="electrical", rmse=0.001)
    (sentence,) = why(sample(50, candidates=(ADOPTED, elsewhere, RIVAL)))

    assert "dent leaves a cross-validated error of 0.004 N m" in sentence
    assert "what was adopted 0.002 N m: 100 % more" in sentence


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
    """The templates of the report use exactly the names that its view has."""
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(folder("templates")), autoescape=True)
    used: set[str] = set()
    for path in folder("templates").glob("report*.jinja"):
        used |= meta.find_undeclared_variables(environment.parse(path.read_text(encoding="utf-8")))

    assert set(view(sample(50), None)) == used


def test_the_equation_has_every_friction_term() -> None:
    """One line for each term; those of the effect, and no other, are marked; sgn as in the paper."""
    setting = Setting("C2", 0.2, {"k_i": 0.06}, 0.5, 40.0, 10.0, 60.0, 5.0)
    effect = next(e for e in library(setting) if e.id == "link_harmonic_friction[n=2]")
    base = load_model("c2_parallel")
    friction, *where = friction_equations(effect.extend(base), [effect])

    assert (6, 2) == (friction.mathml.count("<mtr"), friction.mathml.count('<mtr class="added"'))
    assert [True, True] == [name in friction.mathml for name in ("link_harmonic_c2", "link_harmonic_s2")]
    assert "Sgn" not in friction.mathml
    assert ["normal force on the axis of rotation [N]", "link angle"] == [
        where[0].note, where[1].note[:10]
    ]  # fmt: skip


def test_the_equation_tells_what_is_replaced() -> None:
    """A mass that is another one than the rig says stands beside the friction, as what it has become."""
    setting = Setting("C2", 0.2, {"M": 0.5, "L": 0.2}, 0.5, 40.0, 10.0, 60.0, 5.0)
    effect = next(e for e in library(setting) if e.id == "mass_mismatch")
    notes = [
        equation.note for equation in friction_equations(effect.extend(load_model("c2_parallel")), [effect])
    ]
    meanings = [d.quantity.meaning for d in effect.definitions if d.symbol in effect.replaces.values()]

    assert 1 == len(meanings) == sum(note.startswith(meanings[0]) for note in notes)


def test_a_letter_of_the_users_own_is_escaped() -> None:
    """A parameter can be called anything: in the formula it is text."""
    base = load_model("c1_perpendicular")
    bad = quantity("<b>bold</b>", "N m", "a name with tags")
    mechanical = base.balance("mechanical")
    term = replace(mechanical.terms[-1], name="own", coefficient=bad.symbol, basis=sp.Integer(2))
    balances = (replace(mechanical, terms=(*mechanical.terms, term)), *base.balances[1:])
    (friction, *_) = friction_equations(
        replace(base, parameters=(*base.parameters, bad), balances=balances), []
    )

    assert "<b>" not in friction.mathml
    assert "&lt;b&gt;bold" in friction.mathml


def test_the_record_says_what_the_diagnosis_found(found: Diagnosis) -> None:
    """Errors follow from the residuals of the held-out rows; parameters are those of the fit."""
    data = report_data(found)
    mechanical = data.balances[0]
    assert mechanical.extended is not None
    held = mechanical.rows.held_out
    rmse = {
        name: float(np.sqrt(np.mean(np.asarray(x)[held] ** 2)))
        for name, x in (
            ("linear", mechanical.linear), ("paper", mechanical.paper), ("extended", mechanical.extended)
        )
    }  # fmt: skip
    fitted = {p.name: p.value for p in data.parameters if p.origin in {"effect", "friction"}}

    assert pytest.approx(dict(mechanical.rmse), rel=1e-9) == rmse
    assert {name: e.value for name, e in found.extended.estimates.items()}.items() >= fitted.items()
    assert {
        "velocity",
        "link_angle",
        "motor_angle",
        "acceleration",
        "gravity_load",
        "current",
        "voltage",
        "time",
    } == {channel.key for channel in mechanical.rows.channels}
    assert shlex.split(data.command)[:4] == ["eccentric", "diagnose", "bench.csv.gz", "--rig"]


def test_open_opens_the_report(
    found: Diagnosis, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """`--open` hands the written file to the browser; without a browser it says so and ends well."""
    opened: list[str] = []
    monkeypatch.setattr(command, "diagnose", lambda *_: found)
    monkeypatch.setattr(command.webbrowser, "open", lambda address: not opened.append(address))
    arguments = ["diagnose", str(LOG), "--rig", str(RIG), "--out", str(tmp_path / "out")]
    assert 0 == main(arguments)
    assert [] == opened
    assert 0 == main([*arguments, "--open"])
    assert [(tmp_path / "out" / "report.html").as_uri()] == opened
    assert (
        "c2_parallel_extended.h"
        in Reader((tmp_path / "out" / "report.html").read_text(encoding="utf-8")).text
    )

    monkeypatch.setattr(command.webbrowser, "open", lambda address: False)
    capsys.readouterr()
    assert 0 == main([*arguments, "--open"])
    assert "no browser was found" in capsys.readouterr().err


@pytest.mark.parametrize("real", ["float", "double"])
def test_the_extended_model_comes_with_its_check(
    found: Diagnosis, real: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Self-test and proof driver lie beside the C: the test passes, and the report names each file."""
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    monkeypatch.setattr(command, "diagnose", lambda *_: found)
    out, name = tmp_path / "out", "c2_parallel_extended"
    assert 0 == main(["diagnose", str(LOG), "--rig", str(RIG), "--out", str(out)])

    sources = [out / f"{name}.c", out / "check" / f"{name}_selftest.c"]
    flags = ["-std=c99", f"-DECCENTRIC_REAL={real}", f"-I{out}", "-o", tmp_path / "test"]
    subprocess.run(["gcc", *flags, *sources, "-lm"], check=True)
    subprocess.run([tmp_path / "test"], check=True, capture_output=True)
    text = Reader((out / "report.html").read_text(encoding="utf-8")).text
    written = {path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file()}
    assert f"check/{name}_proof.c" in written
    assert [file for file in written - {"report.html", ".eccentric"} if file not in text] == []


def test_no_name_of_a_log_is_run(found: Diagnosis) -> None:
    """What a log is called stays text in model.py, which is loaded as soon as it is written."""
    hostile = 'a\\""" + str(print(1)) + """.csv'

    before, after = (ast.parse(script(replace(found, logs=(name,)))) for name in ("a.csv", hostile))

    assert [ast.dump(node) for node in before.body[1:]] == [ast.dump(node) for node in after.body[1:]]
    assert "print(1)" in (ast.get_docstring(after) or "")
