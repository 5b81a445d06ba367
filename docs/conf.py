"""How the site is built: `make docs`, or `sphinx-build -EW docs build/docs`."""  # noqa: INP001

from __future__ import annotations

import sys
from pathlib import Path

import jinja2

DOCS = Path(__file__).parent
sys.path[:0] = [str(DOCS), str(DOCS.parent)]

from generator import bench, commands, reference  # noqa: E402 - found by the line above

from eccentric import __version__  # noqa: E402

project = "eccentric"
version = release = __version__
extensions = ["myst_parser"]
myst_heading_anchors = 3
exclude_patterns = ["generator"]
html_theme = "furo"
html_title = "eccentric"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_copyright = False
html_use_index = False
pygments_style, pygments_dark_style = "friendly", "github-dark"

GENERATED = ("index", "commands")
"""Pages that are completed by the generator, besides those below effects/."""
MARKS = {
    "variable_start_string": "<!-- insert:",
    "variable_end_string": "-->",
    "comment_start_string": "<!-- source -->",
    "comment_end_string": "<!-- end -->",
}
"""Marks that Markdown does not show. Text between the last two is for readers of the source alone."""


def setup(app):  # noqa: ANN001, ANN201 - Sphinx's hook
    """Complete the pages that the generator adds to."""
    app.connect("source-read", _fill)


def _fill(app, name: str, content: list[str]) -> None:  # noqa: ANN001
    """Insert what the marks of a page call for; other pages stay as they are."""
    if name not in GENERATED and not name.startswith("effects/"):
        return
    images = Path(app.outdir) / "_images"
    markdown = jinja2.Environment(undefined=jinja2.StrictUndefined, autoescape=False, **MARKS)  # noqa: S701
    page = markdown.from_string(content[0])
    content[0] = page.render(images=images, commands=commands, reference=reference, bench=bench)
