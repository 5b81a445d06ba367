"""URDFs: what moves, what is fixed or locked, and what does not matter, in the chain that comes out."""

from __future__ import annotations

import builtins
import io
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy as sp

from eccentric.core import InputError
from eccentric.model import Chain
from eccentric.rigs import read_arm
from tests.arms import bodies_of

pytest.importorskip("yourdfpy", reason="yourdfpy (`pip install 'eccentric[arms]'`) is not installed")


def link(name: str, mass: float = 0, centre: str = "0 0 0", rpy: str = "0 0 0", inertia: float = 0) -> str:
    """A link of a URDF whose moments of inertia are inertia, 2 inertia and 2.5 inertia."""
    if not mass:
        return f'<link name="{name}"/>'
    return (
        f'<link name="{name}"><inertial><origin xyz="{centre}" rpy="{rpy}"/><mass value="{mass}"/>'
        f'<inertia ixx="{inertia}" ixy="0" ixz="0" iyy="{2 * inertia}" iyz="0" izz="{2.5 * inertia}"/>'
        "</inertial></link>"
    )


def joint(name: str, kind: str, parent: str, child: str, origin: str = "0 0 0", more: str = "") -> str:
    """A joint of a URDF about or along z."""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{origin}"/><axis xyz="0 0 1"/>{more}</joint>'
    )


def robot(*parts: str) -> str:
    """A URDF of these parts."""
    return f'<?xml version="1.0"?>\n<robot name="an arm">{"".join(parts)}</robot>'


def arm(folder: Path, *parts: str, tip: str | None = None) -> Chain:
    """The chain of a URDF of these parts."""
    (folder / "arm.urdf").write_text(robot(*parts), encoding="utf-8")
    return read_arm(folder / "arm.urdf", tip)


def numbers(matrix: Any) -> np.ndarray:
    """A SymPy matrix as an array."""
    return np.array(matrix.tolist(), dtype=float)


BASE = (link("base", 9, inertia=1), joint("lift", "prismatic", "base", "carriage", "0 0 0.5"))
FINGERS = (
    joint("left", "prismatic", "hand", "left finger", "0 0.05 0.1"),
    link("left finger", 0.1, "0 0 0.02"),
    joint("right", "revolute", "hand", "right finger", "0 -0.05 0.1", '<mimic joint="left"/>'),
    link("right finger", 0.2, "0 0 0.02"),
)
ARM = (
    *BASE,
    link("carriage", 4, "0.1 0 0", inertia=0.1),
    joint("turn", "continuous", "carriage", "hand", "0.3 0 0"),
    link("hand", 2, "0 0 0.05", inertia=0.01),
)


def test_a_slide_and_a_turn_are_read(tmp_path: Path) -> None:
    """Kinds, names, places, bodies and gravity are those of the file; the base does not count."""
    chain = arm(tmp_path, *ARM)

    assert ("an_arm", ["lift", "turn"]) == (chain.name, [joint.name for joint in chain.joints])
    assert ["prismatic", "revolute"] == [joint.kind for joint in chain.joints]
    places = [list(joint.placement.position) for joint in chain.joints]
    assert [[0, 0, sp.Rational(1, 2)], [sp.Rational(3, 10), 0, 0]] == places
    assert [4, 2] == [body.mass for body in bodies_of(chain)]
    assert [0, 0, sp.Rational("-9.81")] == list(chain.gravity)
    assert ((), None) == (chain.parameters, chain.payload)


def test_fixed_bodies_become_one(tmp_path: Path) -> None:
    """Behind two fixed joints, turned, a body counts as mass points of it where they are."""
    behind = (
        joint("mount", "fixed", "hand", "plate", "0 0 0.2").replace('"0 0 0.2"', '"0 0 0.2" rpy="0 0 1.2"'),
        link("plate"),
        joint("screw", "fixed", "plate", "tool", "0.1 0 0"),
        link("tool", 3, "0.01 0.02 0.03", "0.4 0.5 0.6", 0.02),
    )
    whole = bodies_of(arm(tmp_path, *ARM, *behind))[1]

    # Rotations as products of turns about z, y and x, bodies as six mass points on their principal axes.
    def turn(axis: int, angle: float) -> np.ndarray:
        found, (i, k) = np.eye(3), [n for n in range(3) if n != axis]
        found[i, i] = found[k, k] = math.cos(angle)
        found[k, i] = math.sin(angle) * (-1) ** axis
        found[i, k] = -found[k, i]
        return found

    def points(mass: float, inertia: float) -> tuple[np.ndarray, np.ndarray]:
        second = np.array([1.75, 0.75, 0.25]) * inertia  # half the trace of the tensor less its entries
        axes = np.diag(np.sqrt(3 * second / mass))
        return np.full(6, mass / 6), np.vstack([axes, -axes])

    hand_m, hand = points(2, 0.01)
    tool_m, tool = points(3, 0.02)
    tool = tool @ (turn(2, 0.6) @ turn(1, 0.5) @ turn(0, 0.4)).T + [0.01, 0.02, 0.03]
    tool = np.add(tool, [0.1, 0, 0]) @ turn(2, 1.2).T + [0, 0, 0.2]
    m, x = np.concatenate([hand_m, tool_m]), np.vstack([np.add(hand, [0, 0, 0.05]), tool])
    centre = m @ x / m.sum()
    apart = x - centre
    tensor = np.sum(m * np.sum(apart**2, axis=1)) * np.eye(3) - (m * apart.T) @ apart

    assert 5 == whole.mass
    assert pytest.approx(centre, rel=1e-14) == numbers(whole.centre).ravel()
    assert pytest.approx(tensor, rel=1e-13, abs=1e-16) == numbers(whole.inertia)


@pytest.mark.parametrize("named", ["tip", "behind #"])
def test_fingers_are_locked_behind_the_tip(named: str, tmp_path: Path) -> None:
    """With the hand as the tip, its fingers belong to it, at 0; one that follows another does no harm."""
    if named == "tip":
        chain = arm(tmp_path, *ARM, *FINGERS, tip="hand")
    else:
        (tmp_path / "arm.urdf").write_text(robot(*ARM, *FINGERS), encoding="utf-8")
        chain = read_arm(f"{tmp_path / 'arm.urdf'}#hand")
    whole = bodies_of(chain)[1]
    first = 2 * np.array([0, 0, 0.05]) + 0.1 * np.array([0, 0.05, 0.12]) + 0.2 * np.array([0, -0.05, 0.12])

    assert ["lift", "turn"] == [joint.name for joint in chain.joints]
    assert pytest.approx(2.3) == float(whole.mass)
    assert pytest.approx(first / 2.3, abs=1e-16) == numbers(whole.centre).ravel()


def test_branches_ask_for_the_tip(tmp_path: Path) -> None:
    """Two fingers that move are no chain: the message names them and the link that carries them."""
    with pytest.raises(InputError) as caught:
        arm(tmp_path, *ARM, *FINGERS)

    path = tmp_path / "arm.urdf"
    assert str(caught.value) == (
        f"{path}: expected one chain of joints, got branches behind joint 'turn': 'left', 'right';"
        f" name the last link of the arm, as in {path}#hand"
    )


def test_a_fixed_joint_between_moving_ones_only_displaces(tmp_path: Path) -> None:
    """The next joint lies where the fixed one carries it."""
    parts = (*BASE, link("carriage", 4), joint("beam", "fixed", "carriage", "end", "0 0.2 0"), link("end"))
    chain = arm(tmp_path, *parts, joint("turn", "revolute", "end", "hand", "0.1 0 0"), link("hand", 1))

    assert [sp.Rational(1, 10), sp.Rational(1, 5), 0] == list(chain.joints[1].placement.position)


def test_an_axis_of_any_length_is_one_of_length_1(tmp_path: Path) -> None:
    """URDFs give axes as directions."""
    text = robot(*ARM).replace('"0 0 1"', '"0 0 -2"')
    (tmp_path / "arm.urdf").write_text(text, encoding="utf-8")

    assert [[0, 0, -1]] * 2 == [list(joint.axis) for joint in read_arm(tmp_path / "arm.urdf").joints]


def test_nothing_else_is_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Meshes of a package, of the network and of this folder, and what cannot be read, are all left alone."""
    mesh = (
        '<visual><geometry><mesh filename="package://arm/hand.dae"/></geometry></visual>'
        '<collision><geometry><mesh filename="http://localhost/hand.stl" scale="big"/></geometry></collision>'
        '<visual><geometry><mesh filename="hand.stl"/></geometry><material><texture/></material></visual>'
    )
    text = robot(*ARM, "<transmission/>", '<gazebo reference="hand"><mu1>high</mu1></gazebo>')
    text = text.replace('<link name="hand">', f'<link name="hand">{mesh}')
    (tmp_path / "hand.stl").write_text("solid", encoding="utf-8")
    (tmp_path / "arm.urdf").write_text(text, encoding="utf-8")
    read_arm(tmp_path / "arm.urdf")  # what is imported on first use is there now
    opened: list[str] = []
    real = io.open

    def seen(file: Any, *rest: Any, **named: Any) -> Any:
        opened.append(str(file))
        return real(file, *rest, **named)

    monkeypatch.setattr(builtins, "open", seen)
    monkeypatch.setattr(io, "open", seen)
    chain = read_arm(tmp_path / "arm.urdf")

    assert [str(tmp_path / "arm.urdf")] == opened
    assert [4, 2] == [body.mass for body in bodies_of(chain)]


def test_a_byte_order_mark_and_a_comment_do_no_harm(tmp_path: Path) -> None:
    """A comment may speak of a document type."""
    text = robot(*ARM).replace("<robot", "<!-- no <!DOCTYPE here -->\n<robot", 1)
    (tmp_path / "arm.urdf").write_bytes(b"\xef\xbb\xbf" + text.encode())

    assert 2 == len(read_arm(tmp_path / "arm.urdf").joints)


def test_an_arm_file_gives_a_urdf_its_drives(tmp_path: Path) -> None:
    """URDFs know neither gears nor rotors: a file beside one adds them, a payload, and what is symbolic."""
    plain = arm(tmp_path, *ARM, *FINGERS, tip="hand")
    (tmp_path / "driven.toml").write_text("""
        urdf = "arm.urdf#hand"
        gravity = ["9.81 m/s^2", 0, 0]
        symbolic = ["turn.mass", "payload.mass"]
        [[joint]]
        name = "turn"
        mu = "1/50"
        J_m = "2e-5 kg m^2"
        bearing = "1 cm"
        [payload]
        mass = "1 kg"
        centre = [0, 0, "0.2 m"]
    """, encoding="utf-8")  # fmt: skip
    chain = read_arm(tmp_path / "driven.toml")

    assert ("driven", [sp.Rational("9.81"), 0, 0]) == (chain.name, list(chain.gravity))
    assert [1, sp.Rational(1, 50)] == [joint.mu for joint in chain.joints]
    assert [0, sp.Rational("2e-5")] == [joint.J_m for joint in chain.joints]
    assert [0, sp.Rational(1, 100)] == [joint.bearing for joint in chain.joints]
    assert {"body_1_mass": bodies_of(plain)[1].mass, "payload_mass": 1} == {
        q.name: q.default for q in chain.parameters
    }
    assert [x.rotation for x in plain.links] == [x.rotation for x in chain.links]
    assert [x.position for x in plain.links] == [x.position for x in chain.links]
    assert bodies_of(plain)[0].moments == bodies_of(chain)[0].moments
    assert (bodies_of(plain)[1].centre, bodies_of(plain)[1].inertia) == (
        bodies_of(chain)[1].centre,
        bodies_of(chain)[1].inertia,
    )


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            '[[joint]]\nname = "trn"',
            "expected a joint of the arm in the URDF, got 'trn'; did you mean 'turn'?",
        ),
        ('[[joint]]\nname = "turn"\naxis = [0, 0, 1]', "turn: unknown key 'axis'; known are name, mu, J_m"),
        ('[[joint]]\nname = "lift"\nmu = 2', 'lift: mu: expected a text with a unit, as in "0.1 m/rad"'),
    ],
    ids=["an unknown joint", "what the URDF says", "the gear of a slide"],
)
def test_drives_that_no_joint_of_the_urdf_has_are_refused(text: str, expected: str, tmp_path: Path) -> None:
    """A file on a URDF has drives of its joints and nothing else about them."""
    arm(tmp_path, *ARM)
    (tmp_path / "driven.toml").write_text(f'urdf = "arm.urdf"\n{text}', encoding="utf-8")

    with pytest.raises(InputError) as caught:
        read_arm(tmp_path / "driven.toml")
    assert expected in str(caught.value)
