"""The templates: the output with placeholders. Each requires a value, and no template computes."""

from __future__ import annotations

import re
from functools import cache

import jinja2
from jinja2.bccache import Bucket

from eccentric.core import derived, folder


class _Cache(jinja2.BytecodeCache):
    """Compiled templates, kept in the user's cache until one of them changes.

    settings: of the environment, which decide how a template is compiled.
    """

    def __init__(self, settings: str) -> None:
        self._settings = settings

    def load_bytecode(self, bucket: Bucket) -> None:
        if (kept := derived.get(f"template {self._settings} {bucket.key}")) is not None:
            bucket.bytecode_from_string(kept)

    def dump_bytecode(self, bucket: Bucket) -> None:
        derived.put(f"template {self._settings} {bucket.key}", bucket.bytecode_to_string())


@cache
def _environment(*, page: bool) -> jinja2.Environment:
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(folder("templates")),
        bytecode_cache=_Cache("page" if page else "code"),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=not page,
        autoescape=page,  # noqa: S701 - other output is C and Python, not HTML
    )


def template(name: str, *, page: bool = False) -> jinja2.Template:
    """The template `templates/NAME.jinja`, such as `numpy/module.py`; on a page of HTML text is escaped."""
    return _environment(page=page).get_template(f"{name}.jinja")


def plain(text: str) -> str:
    """Free text that is safe in comments and docstrings: one line, no escape, no delimiter of C or Python."""
    line = "".join(c for c in " ".join(text.split()) if c.isprintable())
    line = line.replace("\\", "\\\\").replace('"', "'")
    return re.sub(r"(?<=\*)(?=/)|(?<=/)(?=\*)", " ", line)
