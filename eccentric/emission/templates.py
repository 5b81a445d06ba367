"""The templates: the output with placeholders. Each requires a value, and no template computes."""

from __future__ import annotations

from functools import cache

import jinja2

from eccentric.places import folder


@cache
def _environment() -> jinja2.Environment:
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(folder("templates")),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,  # noqa: S701 - the output is C and Python, not HTML
    )


def template(name: str) -> jinja2.Template:
    """The template `templates/NAME.jinja`, such as `numpy/module.py`."""
    return _environment().get_template(f"{name}.jinja")
