"""Files of arms that cannot be: one line with the file, the joint and the quantity, and nothing is opened."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import pytest

from eccentric.core import InputError
from eccentric.rigs import read_arm
from tests.test_arms_urdf import ARM, BASE, FINGERS, joint, link, robot

ELBOW = '[[joint]]\nname = "elbow"\n'
MASS = 'body = { mass = "1 kg" }\n'


def complaint(path: Path, content: str | bytes) -> str:
    """What is said about a file with this content: one line that begins with its path."""
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(InputError) as caught:
        read_arm(path)
    said = str(caught.value)
    assert "\n" not in said
    assert said.startswith(f"{path}: ")
    assert 1 == said.count(f"{path}: ")
    return said.removeprefix(f"{path}: ")


def body(text: str) -> str:
    """An arm file of one joint with this body."""
    return f"{ELBOW}body = {{ {text} }}\n"


ARM_FILES = {
    "no joints": ("", "joints are required, each as [[joint]], received none"),
    "a result": (
        'format = "eccentric-diagnosis/1"',
        (
            "an arm file is required, received a result (eccentric-diagnosis/1): emit the model.py beside a"
            " diagnosis.json, or a model with --parameters FIT.json"
        ),
    ),
    "joints that are no tables": ("joint = 3", "joints are required, each as [[joint]], received 3"),
    "a joint without a name": (
        f"[[joint]]\n{MASS}",
        "joint 1: a name on one line, not 'payload', is required",
    ),
    "two of one name": ((ELBOW + MASS) * 2, "joints of different names are required, received 'elbow' twice"),
    "a joint without a body": (
        ELBOW,
        'elbow: a body is required, such as body = { mass = "2 kg" }, received',
    ),
    "a body without a mass": (body(""), "elbow: mass is required, received none"),
    "the last body without a mass": (
        body("mass = 0"),
        "elbow: a mass on the body of the last joint, or a rotor, is required, received none",
    ),
    "mass below zero": (body('mass = "-1 kg"'), "elbow: mass: 0 or above is required, received -1 kg"),
    "mass in metres": (body('mass = "1 m"'), "elbow: mass: a unit like kg, g is required, received 'm'"),
    "mass without a unit": (body("mass = 1"), 'elbow: mass: a text with a unit is required, as in "0.1 kg"'),
    "a text under a plain key": (body('mass_kg = "1 kg"'), "elbow: mass_kg: a number in kg is required"),
    "mass not a number": (body("mass_kg = nan"), "elbow: mass_kg: a finite number is required, received nan"),
    "mass infinite": (body("mass_kg = inf"), "elbow: mass_kg: a finite number is required, received inf"),
    "mass of a planet": (body('mass = "6e24 kg"'), "elbow: mass: a size of at most 1e+09 is required"),
    "an angle without a unit": (
        f'{ELBOW}rpy = [0, 0, "30"]\n{MASS}',
        "elbow: rpy: a unit is required (deg, rad), received '30'",
    ),
    "degrees as radians": (
        f"{ELBOW}rpy_rad = [0, 0, -90]\n{MASS}",
        'elbow: rpy_rad: an angle in rad, at most a turn, is required, received -90; did you mean "-90 deg"',
    ),
    "a twist of degrees": (
        f"{ELBOW}dh = {{ alpha_rad = 90 }}\n{MASS}",
        'elbow: dh: alpha_rad: an angle in rad, at most a turn, is required, received 90; did you mean "90 d',
    ),
    "a lead per nothing": (
        f'{ELBOW}kind = "prismatic"\nmu = "5 mm"\n{MASS}',
        "elbow: mu: a unit is required (m/rad, mm/rev), received '5 mm'",
    ),
    "a lead of a kind that is none": (
        f'{ELBOW}kind = "prism"\nmu = "5 mm/rev"\n{MASS}',
        "elbow: kind: one of revolute, prismatic is required, received 'prism'; did you mean 'prismatic'?",
    ),
    "a name that is none in code": (
        f'name = "my-arm"\n{ELBOW}{MASS}',
        "name: a name of at most 63 ASCII letters, digits and _ that begins with a letter is required, recei",
    ),
    "the rig of an arm": (
        'arm = "arm.toml"\n[columns]\ntime = "t_s"\n',
        "an arm file is required, received the rig of an arm, whose key `arm` names the arm file",
    ),
    "mass true": (body("mass_kg = true"), "elbow: mass_kg: a number is required, received True"),
    "mass twice": (
        body('mass = "1 kg", mass_kg = 1'),
        "mass is required only once, received mass and mass_kg",
    ),
    "an unknown key of a body": (body('mas = "1 kg"'), "elbow: unknown key 'mas'; did you mean 'mass'?"),
    "a centre of two": (
        body("mass_kg = 1, centre_m = [1, 2]"),
        "elbow: centre_m: a list of three, [x, y, z], is required, received [1, 2]",
    ),
    "the triangle inequality": (
        body("mass_kg = 1, inertia_kgm2 = { xx = 1, yy = 1, zz = 3 }"),
        "which none exceeds the sum of the others, received 1, 1, 3 kg m^2",
    ),
    "inertia below zero": (
        body("mass_kg = 1, inertia_kgm2 = { xx = -1, yy = 1, zz = 1 }"),
        "elbow: inertia: principal moments of 0 or above are required, received -1, 1, 1 kg m^2",
    ),
    "inertia not symmetric": (
        body("mass_kg = 1, inertia_kgm2 = [[1, 0, 0], [1, 1, 0], [0, 0, 1]]"),
        "elbow: inertia: a symmetric tensor is required",
    ),
    "inertia in kilograms": (
        body('mass_kg = 1, inertia = { xx = "1 kg" }'),
        "elbow: inertia: xx: a unit like kg m^2, g cm^2 is required, received 'kg'",
    ),
    "inertia by another name": (
        body("mass_kg = 1, inertia_kgm2 = { Ixx = 1 }"),
        "elbow: inertia_kgm2: unknown key 'Ixx'; did you mean 'xx'?",
    ),
    "an axis of no length": (
        f"{ELBOW}axis = [0, 0, 0]\n{MASS}",
        "elbow: axis: a vector of length 1 is required, received (0, 0, 0) of length 0",
    ),
    "a ball joint": (
        f'{ELBOW}kind = "ball"\n{MASS}',
        "elbow: kind: one of revolute, prismatic is required, received 'ball'",
    ),
    "a gear that turns nothing": (f"{ELBOW}mu = 0\n{MASS}", "elbow: mu: a positive gear ratio is required"),
    "a gear with a colon": (f'{ELBOW}mu = "1:50"\n{MASS}', "elbow: mu: a ratio with '/', as in '1/5'"),
    "a slide with the gear of a turn": (
        f'{ELBOW}kind = "prismatic"\nmu = 0.1\n{MASS}',
        'elbow: mu: a text with a unit is required, as in "0.1 m/rad", received 0.1',
    ),
    "a rotor below zero": (
        f"{ELBOW}J_m_kgm2 = -1\n{MASS}",
        "elbow: J_m: 0 or above is required, received -1",
    ),
    "angles in metres": (
        f'{ELBOW}rpy = ["1 m", 0, 0]\n{MASS}',
        "elbow: rpy: a unit like deg, rad is required",
    ),
    "two rotations": (
        f"{ELBOW}rpy_rad = [0, 0, 0]\nrotation = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n{MASS}",
        "elbow: only one of rpy and rotation is required, received both",
    ),
    "a rotation that stretches": (
        f"{ELBOW}rotation = [[2, 0, 0], [0, 1, 0], [0, 0, 1]]\n{MASS}",
        "elbow: rotation: columns that are a right-handed frame are required",
    ),
    "dh and a position": (
        f"{ELBOW}dh = {{ a_m = 1 }}\nposition_m = [0, 0, 1]\n{MASS}",
        "elbow: only one of dh and position_m is required, received both",
    ),
    "an unknown number of dh": (f"{ELBOW}dh = {{ b_m = 1 }}\n{MASS}", "elbow: dh: unknown key 'b_m'"),
    "an unknown body": (
        f'symbolic = ["paylod"]\n{ELBOW}{MASS}',
        "symbolic: a body of this arm is required, received 'paylod'; did you mean 'payload'?",
    ),
    "gravity downwards": (
        f"gravity_m_s2 = -9.81\n{ELBOW}{MASS}",
        "gravity_m_s2: a list of three, [x, y, z], is required, received -9.81",
    ),
    "an unknown key": (f"gravit = 3\n{ELBOW}{MASS}", "unknown key 'gravit'; did you mean 'gravity'?"),
    "a name that C has taken": (f'name = "while"\n{ELBOW}{MASS}', "received 'while', a keyword of C"),
    "no TOML": ("joint = [", "not valid TOML: "),
    "not UTF-8": (b"\xff\xfe", "UTF-8 text is required, byte 0 is not"),
    "a URDF that is not there": ('urdf = "../none.txt"', "urdf: a file .urdf is required, received"),
}


@pytest.mark.parametrize(("content", "expected"), ARM_FILES.values(), ids=ARM_FILES)
def test_an_arm_file_that_cannot_be_is_refused(content: str | bytes, expected: str, tmp_path: Path) -> None:
    """The line says what is required and what was received."""
    assert expected in complaint(tmp_path / "arm.toml", content)


WHOLE = robot(*ARM)
LOOP = (link("a", 1), link("b", 1), joint("x", "revolute", "a", "b"), joint("y", "revolute", "b", "a"))
URDFS = {
    "empty": ("", "not valid XML: Document is empty, line 1"),
    "cut off": (WHOLE.replace("<link", "\n<link")[:-40], "not valid XML: "),
    "a null character": (
        WHOLE.replace("</robot>", "\0</robot>"),
        "not valid XML: Invalid character: Char 0x0 out of",
    ),
    "another element": (WHOLE.replace("robot", "sdf"), "<robot> is required, received <sdf>"),
    "a document type": (
        WHOLE.replace("<robot", '<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/hosts">]><robot'),
        "XML without a document type and entities is required, received <!DOCTYPE",
    ),
    "another encoding": (
        WHOLE.replace('version="1.0"', 'version="1.0" encoding="latin-1"'),
        "UTF-8 is required, received encoding 'latin-1'",
    ),
    "not UTF-8": (WHOLE.encode("utf-16"), "UTF-8 text is required, byte 0 is not"),
    "xacro": (
        WHOLE.replace("<robot", '<robot xmlns:xacro="http://ros.org/xacro"').replace(
            "</robot>", "<xacro:a/></robot>"
        ),
        "line 2: a URDF is required, received xacro: expand it first",
    ),
    "degrees": (
        WHOLE.replace('<child link="hand"/>', '<child link="hand"/><origin rpy="0 0 90"/>'),
        "origin rpy: angles in rad, at most a turn, are required, received '0 0 90'; did you mean degrees?",
    ),
    "no links": ('<robot name="a"/>', "links are required, received none"),
    "a floating joint": (
        WHOLE.replace("continuous", "floating"),
        "joint 'turn': type revolute, continuous, prismatic or fixed is required, received 'floating'",
    ),
    "a joint without a type": (
        WHOLE.replace(' type="continuous"', ""),
        "<joint>: a type is required, received",
    ),
    "a joint without a child": (
        WHOLE.replace('<child link="hand"/>', ""),
        "line 2: <joint>: a child link is required, received none",
    ),
    "a link that is not there": (
        WHOLE.replace('<child link="hand"/>', '<child link="hnd"/>'),
        "joint 'turn': a link of this file is required, received 'hnd'; did you mean 'hand'?",
    ),
    "a link twice": (robot(*ARM, link("hand", 1)), "each link is required only once, received 'hand' twice"),
    "a loop back to the base": (
        robot(*ARM, joint("back", "fixed", "hand", "base")),
        "one link that no joint carries is required, received none: a loop",
    ),
    "a loop within": (
        robot(*ARM, joint("back", "fixed", "hand", "carriage")),
        "link 'carriage': one joint that carries it is required, received 'lift' and 'back': a loop",
    ),
    "a loop apart": (robot(*ARM, *LOOP), "links behind 'base' are required, received a loop at 'a'"),
    "two bases": (
        robot(*ARM, link("island")),
        "one link that no joint carries is required, received 2: base, island",
    ),
    "nothing that moves": (robot(link("base", 1)), "a joint that moves is required, received none"),
    "a joint that follows another": (
        robot(*ARM, *FINGERS[2:]),
        "joint 'right': a drive of its own is required, received a joint that follows 'left' (mimic)",
    ),
    "a joint without a body": (
        robot(*BASE, link("carriage")),
        "lift: a mass on the body of the last joint, or a rotor, is required, received none",
    ),
    "an axis of no length": (
        WHOLE.replace('"0 0 1"', '"0 0 0"'),
        "lift: axis: a vector of length 1 is required, received (0, 0, 0) of length 0",
    ),
    "an axis of two": (
        WHOLE.replace('"0 0 1"', '"0 1"'),
        "joint 'lift': axis xyz: 3 finite numbers are required",
    ),
    "a place that is infinite": (
        WHOLE.replace('"0.3 0 0"', '"inf 0 0"'),
        "line 2: joint 'turn': origin xyz: 3 finite numbers are required, received 'inf 0 0'",
    ),
    "mass below zero": (
        WHOLE.replace('mass value="2"', 'mass value="-2"'),
        "link 'hand': mass: 0 or above is required, received -2 kg",
    ),
    "mass not a number": (
        WHOLE.replace('mass value="2"', 'mass value="nan"'),
        "line 2: link 'hand': mass value: a finite number is required, received 'nan'",
    ),
    "inertia without an entry": (
        WHOLE.replace('ixx="0.01"', ""),
        "line 2: link 'hand': inertia ixx: a finite number is required, received none",
    ),
    "the triangle inequality": (
        WHOLE.replace('ixx="0.01"', 'ixx="1"'),
        "which none exceeds the sum of the others, received 0.02, 0.025, 1 kg m^2",
    ),
}


@pytest.mark.parametrize(("content", "expected"), URDFS.values(), ids=URDFS)
def test_a_urdf_that_cannot_be_is_refused(content: str | bytes, expected: str, tmp_path: Path) -> None:
    """The line names the joint or the link, and the line of the file where XML and numbers are wrong."""
    assert expected in complaint(tmp_path / "arm.urdf", content)


def test_the_line_of_malformed_xml_is_named(tmp_path: Path) -> None:
    """A tag that is not closed is found in its line."""
    broken = WHOLE.replace("<link", "\n<link").replace('<mass value="2"/>', '<mass value="2">')
    number = 1 + broken[: broken.index("</inertial>", broken.index('<mass value="2">'))].count("\n")

    assert f", line {number}, column " in complaint(tmp_path / "arm.urdf", broken)


@pytest.mark.parametrize(
    ("tip", "expected"),
    [
        ("hnd", "a link of this file is required as tip, received 'hnd'; did you mean 'hand'?"),
        ("base", "a joint that moves is required before link 'base', received none"),
        (
            "right finger",
            "joint 'right': a drive of its own is required, received a joint that follows 'left'",
        ),
    ],
)
def test_a_tip_that_cannot_be_is_refused(tip: str, expected: str, tmp_path: Path) -> None:
    """The tip is a link behind joints that have drives."""
    path = tmp_path / "arm.urdf"
    path.write_text(robot(*ARM, *FINGERS), encoding="utf-8")

    with pytest.raises(InputError) as caught:
        read_arm(path, tip)
    assert f"{path}: {expected}" in str(caught.value)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("none.toml", "no such file"),
        ("none.urdf", "no such file"),
        ("folder.urdf", "a regular file is required, received a directory"),
        ("arm.yaml", "an arm file, .urdf, .toml or .json is required, received '.yaml'"),
    ],
)
def test_a_file_that_cannot_be_read_is_refused(name: str, expected: str, tmp_path: Path) -> None:
    """What is missing, a folder, or of another kind."""
    (tmp_path / "folder.urdf").mkdir()

    with pytest.raises(InputError) as caught:
        read_arm(tmp_path / name)
    assert f"{tmp_path / name}: {expected}" == str(caught.value)


def test_a_missing_library_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the library the message has the command that installs it; arm files need none."""
    real = importlib.import_module

    def without(name: str, package: str | None = None) -> object:
        if name == "yourdfpy":
            raise ImportError(name)
        return real(name, package)

    monkeypatch.setattr(importlib, "import_module", without)
    monkeypatch.delitem(sys.modules, "yourdfpy", raising=False)

    said = complaint(tmp_path / "arm.urdf", WHOLE)
    assert 'yourdfpy is required for .urdf: pip install "eccentric[arms]"' == said
    (tmp_path / "arm.toml").write_text(ELBOW + MASS, encoding="utf-8")
    assert 1 == len(read_arm(tmp_path / "arm.toml").joints)
