"""The report run by run, the drive as measured and simulated, correlations, and what to do next."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import eccentric.presentation.html as package
from eccentric.model import TURNING
from eccentric.presentation.html.arrays import BalanceResiduals, DriveSignal, runs_apart, runs_of
from eccentric.presentation.html.data import Correlations, ReportData
from eccentric.presentation.html.panels import residual_panel
from eccentric.presentation.html.pictures import drive_picture, residual_picture
from eccentric.presentation.html.text import headline
from eccentric.presentation.html.view import view
from tests.reported import HOSTILE, RIVAL, changed, nothing_missing, sample


def with_balance(data: ReportData, balance: BalanceResiduals) -> ReportData:
    """The report of another balance."""
    return replace(data, errors=replace(data.errors, balances=(balance,)))


def driven(balance: BalanceResiduals, gain: float = 20.0) -> BalanceResiduals:
    """The balance with the current that measured it: a load, and the friction, in amperes."""
    assert balance.measured is not None
    load = np.cos(3.0 * balance.rows.t)
    return replace(balance, drive=DriveSignal("current", "A", gain * (balance.measured + load), gain))


def scaled(balance: BalanceResiduals, factors: list[float]) -> BalanceResiduals:
    """The balance with the measured friction of each run multiplied, its residuals with it."""
    assert balance.measured is not None
    assert balance.extended is not None
    more = (np.array(factors) - 1.0)[balance.rows.run] * (balance.measured - balance.extended)
    return replace(
        balance,
        measured=balance.measured + more,
        paper=balance.paper + more,
        extended=balance.extended + more,
    )


def shown(data: ReportData, monkeypatch: pytest.MonkeyPatch) -> str:
    """The page of a plain install, which has no Bokeh."""
    monkeypatch.setattr(package, "library", str)
    return package.page(data)


def test_the_error_of_a_run_is_that_of_its_rows() -> None:
    """Fitted and held-out rows apart, each by NumPy on the rows of the run."""
    balance = sample(runs=3).errors.balances[0]
    found = runs_of(balance)

    assert ["run 1", "run 2", "run 3"] == [run.name for run in found]
    for k, run in enumerate(found):
        for part, mask in ((run.fitted, balance.rows.train), (run.held_out, balance.rows.held_out)):
            own = mask & (balance.rows.run == k)
            assert part is not None
            assert part.rows == np.count_nonzero(own)
            assert part.before == pytest.approx(np.sqrt(np.mean(balance.paper[own] ** 2)), rel=1e-12)
            assert balance.extended is not None
            assert part.after == pytest.approx(np.sqrt(np.mean(balance.extended[own] ** 2)), rel=1e-12)


def test_runs_that_disagree_are_named_with_their_factors(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run with 0.9 and one with 1.15 times the friction: both in the sentence, and in the table."""
    data = sample(runs=3)
    balance = scaled(data.errors.balances[0], [1.0, 0.9, 1.15])
    page = shown(with_balance(data, balance), monkeypatch)

    said = re.search(
        r"The runs disagree: the friction is (\S+) times in run 2 and (\S+) times in run 3", page
    )
    levels = [run.level[0] for run in runs_of(balance) if run.level]

    assert said is not None
    assert [0.9, 1.15] == pytest.approx([float(said[1]), float(said[2])], abs=5e-3)
    assert [1.0, 0.9, 1.15] == pytest.approx(levels, abs=5e-3)


@pytest.mark.parametrize("factors", [[1.0, 1.0, 1.0], [1.0, 0.98, 1.02]])
def test_runs_alike_are_not_called_different(factors: list[float]) -> None:
    """Chance, and some per cent from day to day."""
    assert runs_apart(runs_of(scaled(sample(runs=3).errors.balances[0], factors))) is None


def test_a_scattered_run_is_no_other_one() -> None:
    """A run of a twentieth of a second has no standard error, and so no friction of its own."""
    balance = sample(runs=2).errors.balances[0]
    few = np.flatnonzero(balance.rows.run == 1)[:12]
    rows = replace(
        balance.rows,
        train=balance.rows.train & ((balance.rows.run == 0) | np.isin(np.arange(len(balance.paper)), few)),
        held_out=balance.rows.held_out & (balance.rows.run == 0),
    )
    noise = np.random.default_rng(3).normal(0.0, 0.3, len(balance.paper)) * (balance.rows.run == 1)
    assert balance.extended is not None
    loud = replace(balance, rows=rows, extended=balance.extended + noise, paper=balance.paper + noise)

    assert runs_apart(runs_of(loud)) is None


def test_one_run_has_no_table(monkeypatch: pytest.MonkeyPatch) -> None:
    """It would repeat the errors above it."""
    assert "Run by run" not in shown(sample(), monkeypatch)


def points(lines: list[tuple[str, str]], kind: str) -> np.ndarray:
    """The points (n, 2) of a kind of line, of both panels."""
    text = " ".join(p for k, p in lines if k == kind)
    return np.array([[float(x) for x in pair.split(",")] for pair in text.split()])


def test_the_drawn_drive_is_measured_less_the_residual() -> None:
    """In the unit of the drive: what the lines are apart is the gain times the residual, on their scale."""
    balance = driven(sample().errors.balances[0])
    found = drive_picture(balance)
    assert found is not None
    upper = {kind: points(found.lines, kind) for kind in ("measured", "extended")}
    count = len(upper["measured"])
    marks = [(float(y), float(label.replace("−", "-"))) for y, label in found.grid]
    split = next(k for k in range(1, len(marks)) if marks[k][0] > marks[k - 1][0])
    (y0, v0), *_, (y1, v1) = marks[:split]
    apart = (upper["measured"] - upper["extended"][:count])[:, 1] * (v1 - v0) / (y1 - y0)

    assert balance.extended is not None
    expected = 20.0 * np.sqrt(np.mean(balance.extended[balance.rows.held_out] ** 2))
    assert np.sqrt(np.mean(apart**2)) == pytest.approx(expected, rel=0.15)
    assert "0.0" in found.caption
    assert " A (" in found.caption


def test_the_plain_install_has_these_figures_and_no_captions_of_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Without Bokeh there are two pictures, drawn in the page: the effect over what it follows, then time."""
    data = sample()
    page = shown(with_balance(data, driven(data.errors.balances[0])), monkeypatch)

    assert 2 == page.count("<svg")
    first, second = (
        page.index(heading) for heading in ("Residual before and after", "Measured and predicted")
    )
    assert first < page.index("link angle [rad]") < second < page.index("time [s]")
    assert 2 == page.count("<figcaption")
    assert "Residual versus each channel" not in page


def test_the_first_picture_is_the_residual_over_what_the_effect_follows() -> None:
    """Its lines are the means of the panel; with no effect found, it is over what the residual depends on."""
    data = sample()
    balance = data.errors.balances[0]
    panel = residual_panel(balance, balance.rows.channels[1])
    assert panel is not None
    found = residual_picture(panel, balance, TURNING)
    marks = [(float(y), float(label.replace("−", "-"))) for y, label in found.grid]
    (y0, v0), *_, (y1, v1) = marks
    plain = changed(data, verdict="unexplained", effects=(), depends_on=("current",))

    for kind, curve in (("paper", "before"), ("extended", "after")):
        drawn = v0 + (points(found.lines, kind)[:, 1] - y0) * (v1 - v0) / (y1 - y0)
        assert drawn == pytest.approx(panel.curves[curve].middle, abs=2e-4)
    assert ["0", "π/2", "π", "3π/2", "2π"] == [label for _, label in found.ticks]
    assert view(plain, "")["follows"][1][0].below == "current [A]"
    assert view(nothing_missing(changed(data, depends_on=())), "")["follows"] is None


def correlated(**changes: Any) -> ReportData:
    """A report with three estimates, two of which are nearly one."""
    matrix = np.array([[1.0, -0.97, 0.2], [-0.97, 1.0, np.nan], [0.2, np.nan, 1.0]])
    data = sample(**changes)
    names = ("B", f"C{HOSTILE}" if changes.get("text") else "C", "D")
    return replace(data, extended=replace(data.extended, correlations=Correlations(names, matrix)))


def test_correlations_are_a_triangle_and_the_closest_pair_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each pair once; one without a value is an empty cell; names are escaped."""
    page = shown(correlated(), monkeypatch)
    cells = re.findall(r'<td class="n (\w*)" style="--tint: (\d+)%">([^<]*)</td>', page)

    assert [("minus", "58", "−0.97"), ("plus", "12", "0.20"), ("", "0", "")] == cells
    assert "B and C are the most strongly correlated" in page
    assert "<script>alert(1)" not in shown(correlated(text=HOSTILE), monkeypatch)


def test_the_headline_answers_in_words() -> None:
    """The effect where one is named, the tied ones where several are, else what is known."""
    data = sample()
    tied = replace(
        data,
        conclusion=replace(data.conclusion, verdict="not_identifiable"),
        search=replace(data.search, tied=("wobble", "dent")),
    )

    assert "Missing: a shaft that wobbles" == headline(data)
    assert "Missing: wobble[n=2] or a dent" == headline(tied)
    beside = replace(tied, conclusion=replace(tied.conclusion, clear=("a rub",)))
    assert "Missing: a rub, and wobble[n=2] or a dent" == headline(beside)
    assert "Nothing is missing, as far as this log can show" == headline(nothing_missing(data))
    unexplained = replace(data.conclusion, verdict="unexplained")
    misfit, unconfirmed = replace(unexplained, fits_the_rig=False), replace(unexplained, confirmed=False)
    assert "no known effect explains" in headline(replace(data, conclusion=unexplained))
    assert "This log does not fit the rig" == headline(replace(data, conclusion=misfit))
    assert headline(replace(data, conclusion=unconfirmed)).endswith("not confirmed")


def test_the_command_of_the_next_plan_is_there_to_copy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Below what to measure next; without one, no empty box."""
    data = sample()
    planned = replace(data, source=replace(data.source, plan="eccentric plan a.csv --rig r.toml --out plan"))

    assert ">eccentric plan a.csv --rig r.toml --out plan</pre>" in shown(planned, monkeypatch)
    assert "limits.toml" not in shown(data, monkeypatch)
    assert RIVAL.id in shown(data, monkeypatch)
