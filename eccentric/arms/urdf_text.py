"""The text of a URDF: UTF-8 without entities, reduced to links and joints, every number of theirs checked.

A file from elsewhere must not make this one read others, so a document type, which entities need, is refused
before anything is parsed. Shapes, materials and extensions are dropped unread.
"""

from __future__ import annotations

import importlib
import math
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

from eccentric.arms.limits import LARGEST, LARGEST_ANGLE
from eccentric.arms.quantities import INERTIA
from eccentric.errors import InputError
from eccentric.places import readable

_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
_ENCODING = re.compile(r"""\A\s*<\?xml[^>]*?encoding\s*=\s*["']([^"']*)""")
_POSE = (("origin", "xyz", 3, False), ("origin", "rpy", 3, False))
NUMBERS = {
    "joint": (*_POSE, ("axis", "xyz", 3, False)),
    "inertial": (*_POSE, ("mass", "value", 1, True), *(("inertia", f"i{e}", 1, True) for e in INERTIA)),
}
"""Elements, attributes, how many numbers each has, and whether they are required."""


def library(name: str, where: str) -> ModuleType:
    """A module that URDFs need; InputError, with the command that installs it, if it is missing."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise InputError(f'{where}: yourdfpy is required for .urdf: pip install "eccentric[arms]"') from None


def links_and_joints(path: Path, where: str) -> bytes:
    """The URDF with its links and joints alone, as UTF-8.

    Raises InputError, with the line of the file: it is missing or not UTF-8, has a document type or entities,
    is no XML or no URDF; a link or joint has no name, or an attribute that is not so many finite numbers.
    """
    etree = library("lxml.etree", where)
    text = _text(path, where)
    parser = etree.XMLParser(
        resolve_entities=False, load_dtd=False, no_network=True, remove_comments=True, remove_pis=True
    )
    try:
        root = etree.fromstring(text.encode(), parser)
    except etree.XMLSyntaxError as error:
        raise InputError(f"{where}: not valid XML: {' '.join(error.msg.split())}") from None
    if root.tag != "robot":
        raise InputError(f"{where}: <robot> is required, received <{root.tag}>")
    kept = etree.Element("robot", name=root.get("name") or Path(where).stem)
    for element in list(root):
        if str(element.tag).startswith("{") and "xacro" in str(element.tag):
            raise InputError(f"{_at(where, element)}: a URDF is required, received xacro: expand it first")
        if element.tag in {"link", "joint"}:
            kept.append(_reduced(element, where))
    return etree.tostring(kept)


def _text(path: Path, where: str) -> str:
    try:
        text = readable(path).read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise InputError(f"{where}: cannot be read ({error.strerror or error})") from None
    except UnicodeDecodeError as error:
        raise InputError(f"{where}: UTF-8 text is required, byte {error.start} is not") from None
    declared = _ENCODING.match(text)
    if declared and declared[1].lower() not in {"utf-8", "utf8", "us-ascii", "ascii"}:
        raise InputError(f"{where}: UTF-8 is required, received encoding {declared[1]!r}")
    if found := re.search(r"<!(DOCTYPE|ENTITY)", _COMMENT.sub("", text), re.IGNORECASE):
        raise InputError(
            f"{where}: XML without a document type and entities is required, received <!{found[1]}"
        )
    return text


def _reduced(element: Any, where: str) -> Any:
    """A link with its inertia, or a joint, each checked."""
    for name, value in _names(element):
        if not value or not value.isprintable():
            here = f"{_at(where, element)}: <{element.tag}>"
            raise InputError(f"{here}: {name} is required, received {repr(value) if value else 'none'}")
    here = f"{_at(where, element)}: {element.tag} {element.get('name')!r}"
    if element.tag == "joint":
        _require_numbers(element, NUMBERS["joint"], here)
    for child in list(element):
        if element.tag == "link" and child.tag == "inertial":
            _require_numbers(child, NUMBERS["inertial"], here)
        elif element.tag == "link" or child.tag not in {"parent", "child", "origin", "axis", "mimic"}:
            element.remove(child)
    return element


def _names(element: Any) -> Iterator[tuple[str, str | None]]:
    yield "a name", element.get("name")
    if element.tag == "joint":
        yield "a type", element.get("type")
        for end in ("parent", "child"):
            found = element.find(end)
            yield f"a {end} link", None if found is None else found.get("link")


def _require_numbers(element: Any, numbers: tuple[tuple[str, str, int, bool], ...], here: str) -> None:
    for tag, attribute, count, required in numbers:
        found = element.find(tag)
        given = None if found is None else found.get(attribute)
        if given is None and not required:
            continue
        try:
            values = [float(word) for word in (given or "").replace("_", "?").split()]
        except ValueError:
            values = []
        if len(values) != count or not all(math.isfinite(v) and abs(v) <= LARGEST for v in values):
            what = "a finite number is" if count == 1 else f"{count} finite numbers are"
            received = "none" if given is None else repr(given)
            raise InputError(f"{here}: {tag} {attribute}: {what} required, received {received}")
        if attribute == "rpy" and max(map(abs, values)) > LARGEST_ANGLE:
            turns = "angles in rad, at most a turn, are required"
            raise InputError(f"{here}: {tag} rpy: {turns}, received {given!r}; did you mean degrees?")


def _at(where: str, element: Any) -> str:
    return f"{where}: line {element.sourceline}"
