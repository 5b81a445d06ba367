"""An arm from a URDF, read by yourdfpy: joints on the way to the tip move, all others are locked at 0."""

from __future__ import annotations

import importlib
import io
import math
import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from eccentric.core import InputError, few, meant, readable
from eccentric.model import Body, Joint, Placement
from eccentric.rigs.arm_parts import INERTIA, ReadJoint, after, complaints_of, identifier, joined, placed
from eccentric.rigs.limits import LARGEST_ANGLE, LARGEST_OF_ARM, SMALLEST_INERTIA

# The text of a URDF: UTF-8 without entities, reduced to links and joints, every number of theirs checked.
#
# A file from elsewhere must not make this one read others, so a document type, which entities need, is
# refused before anything is parsed. Shapes, materials and extensions are dropped unread.


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
        raise InputError(
            where, problem='yourdfpy is required for .urdf: pip install "eccentric[arms]"'
        ) from None


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
        raise InputError(where, problem=f"not valid XML: {' '.join(error.msg.split())}") from None
    if root.tag != "robot":
        raise InputError(where, "<robot>", f"<{root.tag}>")
    kept = etree.Element("robot", name=root.get("name") or Path(where).stem)
    for element in list(root):
        if str(element.tag).startswith("{") and "xacro" in str(element.tag):
            raise InputError(_at(where, element), "a URDF", "xacro: expand it first")
        if element.tag in {"link", "joint"}:
            kept.append(_reduced(element, where))
    return etree.tostring(kept)


def _text(path: Path, where: str) -> str:
    try:
        text = readable(path).read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise InputError(where, problem=f"cannot be read ({error.strerror or error})") from None
    except UnicodeDecodeError as error:
        raise InputError(where, problem=f"expected UTF-8 text, but byte {error.start} is not") from None
    declared = _ENCODING.match(text)
    if declared and declared[1].lower() not in {"utf-8", "utf8", "us-ascii", "ascii"}:
        raise InputError(where, "UTF-8", f"encoding {declared[1]!r}")
    if found := re.search(r"<!(DOCTYPE|ENTITY)", _COMMENT.sub("", text), re.IGNORECASE):
        raise InputError(where, "XML without a document type and entities", f"<!{found[1]}")
    return text


def _reduced(element: Any, where: str) -> Any:
    """A link with its inertia, or a joint, each checked."""
    for name, value in _names(element):
        if not value or not value.isprintable():
            here = f"{_at(where, element)}: <{element.tag}>"
            raise InputError(here, name, repr(value) if value else "none")
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
        if len(values) != count or not all(math.isfinite(v) and abs(v) <= LARGEST_OF_ARM for v in values):
            what = "a finite number" if count == 1 else f"{count} finite numbers"
            received = "none" if given is None else repr(given)
            raise InputError(here, problem=f"{tag} {attribute}: expected {what}, got {received}")
        if attribute == "rpy" and max(map(abs, values)) > LARGEST_ANGLE:
            turns = "expected angles in rad, at most a turn"
            raise InputError(here, problem=f"{tag} rpy: {turns}, got {given!r}; did you mean degrees?")


def _at(where: str, element: Any) -> str:
    return f"{where}: line {element.sourceline}"


# The tree of a URDF, and the one chain of moving joints in it that is the arm.


MOVING = {"revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic"}
"""Kind of joint by its type in a URDF; a continuous joint is a revolute one without end stops."""


@dataclass(frozen=True)
class Tree:
    """Links and the joints between them, from one root; each link but the root is the child of one joint.

    Attributes:
        where: the file, in messages.
        root: name of the link that nothing carries.
        links: by name, with `inertial`.
        inner: the joint that carries a link, by the name of that link.
        outer: joints that a link carries, by the name of that link.
    """

    where: str
    root: str
    links: Mapping[str, Any]
    inner: Mapping[str, Any]
    outer: Mapping[str, Sequence[Any]]


def tree_of(links: Sequence[Any], joints: Sequence[Any], where: str) -> Tree:
    """The tree that links and joints form.

    Raises InputError: a name twice, a link that is not there, a loop, parts that nothing connects, or a type
    of joint that no arm has.
    """
    for what, given in (("link", links), ("joint", joints)):
        names = Counter(one.name for one in given)
        if names and (most := names.most_common(1)[0])[1] > 1:
            raise InputError(where, f"each {what}", f"{most[0]!r} twice", why="only once")
    if not links:
        raise InputError(where, "links", "none")
    by_name, inner = {link.name: link for link in links}, {}
    outer: dict[str, list[Any]] = {name: [] for name in by_name}
    for joint in joints:
        if joint.type not in {*MOVING, "fixed"}:
            raise InputError(
                f"{where}: joint {joint.name!r}",
                "type revolute, continuous, prismatic or fixed",
                f"{joint.type!r}",
            )
        for end in (joint.parent, joint.child):
            if end not in by_name:
                raise InputError(
                    f"{where}: joint {joint.name!r}", "a link of this file", f"{end!r}{meant(end, by_name)}"
                )
        if joint.child in inner:
            raise InputError(
                f"{where}: link {joint.child!r}",
                "one joint that carries it",
                f"{inner[joint.child].name!r} and {joint.name!r}: a loop",
            )
        inner[joint.child] = joint
        outer[joint.parent].append(joint)
    roots = [name for name in by_name if name not in inner]
    if len(roots) != 1:
        received = f"{len(roots)}: {few(roots)}" if roots else "none: a loop"
        raise InputError(where, "one link that no joint carries", received)
    tree = Tree(where, roots[0], by_name, inner, outer)
    reached = {roots[0], *(joint.child for joint in _behind(tree, roots[0]))}
    if apart := [name for name in by_name if name not in reached]:
        raise InputError(where, f"links behind {roots[0]!r}", f"a loop at {apart[0]!r}")
    return tree


def path_to(tree: Tree, tip: str | None) -> list[Any]:
    """The moving joints of the arm, from the base outwards: those up to the link `tip`, without one all.

    Raises InputError: the tip is no link, nothing moves before it, a joint follows another (mimic), or there
    is no tip and the moving joints branch.
    """
    if tip is None:
        path = _only_chain(tree)
    else:
        if tip not in tree.links:
            hint = meant(tip, tree.links)
            raise InputError(tree.where, "a link of this file", f"{tip!r}{hint}", why="as tip")
        path = [joint for joint in _up(tree, tip) if joint.type in MOVING][::-1]
    if not path:
        before = f" before link {tip!r}" if tip else ""
        raise InputError(tree.where, problem=f"expected a joint that moves{before}, got none")
    if follower := next((joint for joint in path if joint.mimic is not None), None):
        raise InputError(
            f"{tree.where}: joint {follower.name!r}",
            "a drive of its own",
            f"a joint that follows {follower.mimic.joint!r} (mimic)",
        )
    return path


def _only_chain(tree: Tree) -> list[Any]:
    path: list[Any] = []
    link = tree.root
    while following := [joint for joint in _behind(tree, link, MOVING) if joint.type in MOVING]:
        if len(following) > 1:
            behind = f"joint {path[-1].name!r}" if path else "the base"
            branches = few([repr(joint.name) for joint in following], 4)
            # Behind the last joint of an arm it is the fingers that branch: what carries them is the hand.
            hand = following[0].parent if path else "LINK"
            raise InputError(
                tree.where,
                "one chain of joints",
                f"branches behind {behind}: {branches}; name the last link of the arm,"
                f" as in {tree.where}#{hand}",
            )
        path += following
        link = following[0].child
    return path


def _behind(tree: Tree, link: str, up_to: Collection[str] = ()) -> list[Any]:
    """All joints behind a link, up to those of some types on each way."""
    found, waiting = [], [link]
    while waiting:
        joints = tree.outer[waiting.pop()]
        found += joints
        waiting += [joint.child for joint in joints if joint.type not in up_to]
    return found


def _up(tree: Tree, link: str) -> list[Any]:
    """The joints from a link to the root."""
    found = []
    while link != tree.root:
        found.append(tree.inner[link])
        link = found[-1].parent
    return found


def without_tip(path: Path) -> tuple[Path, str | None]:
    """The file, and the link behind `#` in "panda.urdf#panda_hand"; None where there is none."""
    if "#" not in path.name or path.exists():
        return path, None
    name, _, tip = path.name.partition("#")
    return path.with_name(name), tip


def joints_of_urdf(path: Path, where: str, tip: str | None) -> tuple[str, list[ReadJoint]]:
    """The name of a URDF in code, and the joints of its arm from the base outwards.

    Bodies behind fixed and locked joints belong to the link that carries them; links without <inertial> have
    no mass. What is fixed to the root does not move, and is left out.

    Args:
        path, where: the file, and how messages name it.
        tip: the last link of the arm; None if the moving joints are one chain.

    Raises InputError, one line with file, joint or link, what is required and what was received.
    """
    robot = _robot(links_and_joints(path, where), where)
    tree = tree_of(robot.links, robot.joints, where)
    moving = path_to(tree, tip)
    found = []
    frames = _frames(tree, tree.root, moving)
    for joint in moving:
        with complaints_of(where):
            place = after(frames[joint.parent], _placement(joint.origin, joint.name))
            moved = Joint(MOVING[joint.type], _axis(joint), place, name=joint.name)
        frames = _frames(tree, joint.child, moving)
        here = [placed(_body(tree.links[name], where), at) for name, at in frames.items()]
        found.append(ReadJoint(moved, joined(here, joint.name), Placement()))
    return identifier(robot.name), found


def _robot(text: bytes, where: str) -> Any:
    yourdfpy = library("yourdfpy", where)
    try:
        # Neither meshes nor a scene: nothing else is opened.
        return yourdfpy.URDF.load(io.BytesIO(text), load_meshes=False, build_scene_graph=False).robot
    except (yourdfpy.URDFError, KeyError, TypeError, ValueError) as error:
        raise InputError(where, problem=f"not a valid URDF ({str(error).splitlines()[0]})") from None


def _frames(tree: Tree, link: str, moving: list[Any]) -> dict[str, Placement]:
    """Where the links lie that move with a link, itself included: behind joints that are fixed or locked."""
    found, waiting = {link: Placement()}, [link]
    while waiting:
        carrier = waiting.pop()
        for joint in tree.outer[carrier]:
            if all(joint is not other for other in moving):
                with complaints_of(tree.where):
                    found[joint.child] = after(found[carrier], _placement(joint.origin, joint.name))
                waiting.append(joint.child)
    return found


def _placement(origin: Any, name: str) -> Placement:
    """A 4 by 4 matrix of yourdfpy as a placement."""
    return Placement() if origin is None else Placement(origin[:3, 3].tolist(), origin[:3, :3].tolist(), name)


def _axis(joint: Any) -> list[float]:
    """A unit vector along the axis; one of length 0 as it is, for `Joint` to refuse."""
    length = float(np.linalg.norm(joint.axis))
    return (joint.axis / length if length > 0 else joint.axis).tolist()


def _body(link: Any, where: str) -> Body:
    """The body of a link in the frame of the link."""
    if link.inertial is None:
        return Body(0)
    name, given = f"{where}: link {link.name!r}", link.inertial
    inertia = given.inertia if np.max(np.abs(given.inertia)) > SMALLEST_INERTIA else np.zeros((3, 3))
    return placed(Body(given.mass, inertia=inertia, name=name), _placement(given.origin, name))
