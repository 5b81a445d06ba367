"""A page as a test reads it: its elements, what a person sees of it, and the JSON of its figures."""

import re
from html.parser import HTMLParser


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


def figures_of(text: str) -> str:
    """The JSON of the figures of a page."""
    (content,) = re.findall(r'<script type="application/json" id="figures">(.*?)</script>', text, re.DOTALL)
    return content
