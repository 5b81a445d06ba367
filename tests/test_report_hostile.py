"""Nothing that comes from a log, a rig or a user becomes markup of the report."""

import json

import pytest

from eccentric.presentation.html import page
from tests.page_reader import Reader, figures_of
from tests.reported import HOSTILE, sample

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
