"""The tree of a URDF, and the one chain of moving joints in it that is the arm."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from eccentric.errors import InputError, few, meant

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
            raise InputError(f"{where}: each {what} is required only once, received {most[0]!r} twice")
    if not links:
        raise InputError(f"{where}: links are required, received none")
    by_name, inner = {link.name: link for link in links}, {}
    outer: dict[str, list[Any]] = {name: [] for name in by_name}
    for joint in joints:
        if joint.type not in {*MOVING, "fixed"}:
            raise InputError(
                f"{where}: joint {joint.name!r}: type revolute, continuous, prismatic or fixed is required,"
                f" received {joint.type!r}"
            )
        for end in (joint.parent, joint.child):
            if end not in by_name:
                raise InputError(
                    f"{where}: joint {joint.name!r}: a link of this file is required, received"
                    f" {end!r}{meant(end, by_name)}"
                )
        if joint.child in inner:
            raise InputError(
                f"{where}: link {joint.child!r}: one joint that carries it is required, received"
                f" {inner[joint.child].name!r} and {joint.name!r}: a loop"
            )
        inner[joint.child] = joint
        outer[joint.parent].append(joint)
    roots = [name for name in by_name if name not in inner]
    if len(roots) != 1:
        received = f"{len(roots)}: {few(roots)}" if roots else "none: a loop"
        raise InputError(f"{where}: one link that no joint carries is required, received {received}")
    tree = Tree(where, roots[0], by_name, inner, outer)
    reached = {roots[0], *(joint.child for joint in _behind(tree, roots[0]))}
    if apart := [name for name in by_name if name not in reached]:
        raise InputError(f"{where}: links behind {roots[0]!r} are required, received a loop at {apart[0]!r}")
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
            raise InputError(f"{tree.where}: a link of this file is required as tip, received {tip!r}{hint}")
        path = [joint for joint in _up(tree, tip) if joint.type in MOVING][::-1]
    if not path:
        before = f" before link {tip!r}" if tip else ""
        raise InputError(f"{tree.where}: a joint that moves is required{before}, received none")
    if follower := next((joint for joint in path if joint.mimic is not None), None):
        raise InputError(
            f"{tree.where}: joint {follower.name!r}: a drive of its own is required, received a joint that"
            f" follows {follower.mimic.joint!r} (mimic)"
        )
    return path


def _only_chain(tree: Tree) -> list[Any]:
    path: list[Any] = []
    link = tree.root
    while following := _next_moving(tree, link):
        if len(following) > 1:
            behind = f"joint {path[-1].name!r}" if path else "the base"
            branches = few([repr(joint.name) for joint in following], 4)
            # Behind the last joint of an arm it is the fingers that branch: what carries them is the hand.
            hand = following[0].parent if path else "LINK"
            raise InputError(
                f"{tree.where}: one chain of joints is required, received branches behind {behind}:"
                f" {branches}; name the last link of the arm, as in {tree.where}#{hand}"
            )
        path += following
        link = following[0].child
    return path


def _next_moving(tree: Tree, link: str) -> list[Any]:
    """The moving joints on a link and on what is fixed to it."""
    found, waiting = [], [link]
    while waiting:
        joints = tree.outer[waiting.pop()]
        found += [joint for joint in joints if joint.type in MOVING]
        waiting += [joint.child for joint in joints if joint.type not in MOVING]
    return found


def _behind(tree: Tree, link: str) -> list[Any]:
    """All joints behind a link."""
    found, waiting = [], [link]
    while waiting:
        joints = tree.outer[waiting.pop()]
        found += joints
        waiting += [joint.child for joint in joints]
    return found


def _up(tree: Tree, link: str) -> list[Any]:
    """The joints from a link to the root."""
    found = []
    while link != tree.root:
        found.append(tree.inner[link])
        link = found[-1].parent
    return found
