"""An arm from a URDF, read by yourdfpy: joints on the way to the tip move, all others are locked at 0."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.arms.bodies import joined
from eccentric.arms.complaints import complaints_of
from eccentric.arms.joints import ReadJoint
from eccentric.arms.limits import SMALLEST_INERTIA
from eccentric.arms.naming import identifier
from eccentric.arms.placing import after, placed
from eccentric.arms.tree import MOVING, Tree, path_to, tree_of
from eccentric.arms.urdf_text import library, links_and_joints
from eccentric.errors import InputError
from eccentric.model import Body, Joint, Placement


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
        raise InputError(f"{where}: not a valid URDF ({str(error).splitlines()[0]})") from None


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
