"""`report.html`: the diagnosis for a person, one file that opens offline.

    gather    Diagnosis -> ReportData: plain numbers, arrays and strings, the interface   (`report_data`)
    data      the record of it
    arrays    rows -> means and quantiles over a channel, run by run
    panels    -> the curves of each figure, and time traces, few enough points to draw
    figures   -> their data as JSON, which BokehJS draws in the page; without Bokeh there are text and tables;
              two of them on matplotlib axes
    equation, formulas  -> the model as MathML
    pictures -> the first pictures, lines of an SVG: the residual over a variable, the drive along time
    text      -> its sentences and tables
    arm_page  the page of an arm, which leads to those of its joints
    view      -> the strings that the templates see (`templates/report/`)

All text from logs and rigs is escaped; only what is made here is inserted verbatim: formulas, BokehJS, the
JSON of the figures. The page's own content policy forbids it to fetch anything.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from eccentric.diagnosis import Diagnosis
from eccentric.emission import template
from eccentric.presentation.html.data import Parameter, ReportData
from eccentric.presentation.html.figures import library, plot_report
from eccentric.presentation.html.formulas import with_symbols
from eccentric.presentation.html.gather import report_data
from eccentric.presentation.html.text import number
from eccentric.presentation.html.view import view

if TYPE_CHECKING:
    from eccentric.joints import ArmDiagnosis


def report(found: Diagnosis, files: Sequence[tuple[str, str]] = ()) -> str:
    """The page of a diagnosis; `files` are (name, description) of everything written beside it."""
    return page(report_data(found, files=files))


def page(data: ReportData) -> str:
    """The page of these records."""
    return rendered("report", view(data, library()))


def arm_page(found: ArmDiagnosis) -> str:
    """The page of an arm, which leads to that of each joint, joint_NUMBER/report.html."""
    from eccentric.presentation.html.view import arm_view  # the joints of an arm take a while to import

    return rendered("arm", arm_view(found))


def rendered(page: str, variables: Mapping[str, Any]) -> str:
    """A page of `templates/report` with its variables; all text is escaped."""
    return template(f"report/{page}.html", page=True).render(symbols=_symbols, **variables)


def _symbols(text: str) -> Markup:
    """A sentence for a template, its symbols with subscripts."""
    return Markup(with_symbols(text))  # noqa: S704 - what is not made by `letter` is escaped
