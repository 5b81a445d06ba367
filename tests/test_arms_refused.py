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
    "no joints": ("", "expected joints, each as [[joint]], got none"),
    "a result": (
        'format = "eccentric-diagnosis/1"',
        (
            "expected an arm file, got a result (eccentric-diagnosis/1): emit the model.py next to a"
            " diagnosis.json, or a model with --parameters FIT.json"
        ),
    ),
    "joints that are no tables": ("joint = 3", "expected joints, each as [[joint]], got 3"),
    "a joint without a name": (f"[[joint]]\n{MASS}", "joint 1: expected a name on one line, not 'payload',"),
    "two of one name": ((ELBOW + MASS) * 2, "expected joints of different names, got 'elbow' twice"),
    "a joint without a body": (ELBOW, 'elbow: expected a body, such as body = { mass = "2 kg" }, got'),
    "a body without a mass": (body(""), "elbow: expected mass, got none"),
    "the last body without a mass": (
        body("mass = 0"),
        "elbow: expected a mass on the body of the last joint, or a rotor, got none",
    ),
    "mass below zero": (body('mass = "-1 kg"'), "elbow: mass: expected 0 or above, got -1 kg"),
    "mass in metres": (body('mass = "1 m"'), "elbow: mass: expected a unit like kg, g, got 'm'"),
    "mass without a unit": (body("mass = 1"), 'elbow: mass: expected a text with a unit, as in "0.1 kg"'),
    "a text under a plain key": (body('mass_kg = "1 kg"'), "elbow: mass_kg: expected a number in kg"),
    "mass not a number": (body("mass_kg = nan"), "elbow: mass_kg: expected a finite number, got nan"),
    "mass infinite": (body("mass_kg = inf"), "elbow: mass_kg: expected a finite number, got inf"),
    "mass of a planet": (body('mass = "6e24 kg"'), "elbow: mass: expected a size of at most 1e+09"),
    "an angle without a unit": (
        f'{ELBOW}rpy = [0, 0, "30"]\n{MASS}',
        "elbow: rpy: expected a unit (deg, rad), got '30'",
    ),
    "degrees as radians": (
        f"{ELBOW}rpy_rad = [0, 0, -90]\n{MASS}",
        'elbow: rpy_rad: expected an angle in rad, at most a turn, got -90; did you mean "-90 deg"',
    ),
    "a twist of degrees": (
        f"{ELBOW}dh = {{ alpha_rad = 90 }}\n{MASS}",
        'elbow: dh: alpha_rad: expected an angle in rad, at most a turn, got 90; did you mean "90 d',
    ),
    "a lead per nothing": (
        f'{ELBOW}kind = "prismatic"\nmu = "5 mm"\n{MASS}',
        "elbow: mu: expected a unit (m/rad, mm/rev), got '5 mm'",
    ),
    "a lead of a kind that is none": (
        f'{ELBOW}kind = "prism"\nmu = "5 mm/rev"\n{MASS}',
        "elbow: kind: expected one of revolute, prismatic, got 'prism'; did you mean 'prismatic'?",
    ),
    "a name that is none in code": (
        f'name = "my-arm"\n{ELBOW}{MASS}',
        "name: expected a name of at most 63 ASCII letters, digits and _ that begins with a letter, got",
    ),
    "the rig of an arm": (
        'arm = "arm.toml"\n[columns]\ntime = "t_s"\n',
        "expected an arm file, got the rig of an arm, whose key `arm` names the arm file",
    ),
    "mass true": (body("mass_kg = true"), "elbow: mass_kg: expected a number, got True"),
    "mass twice": (body('mass = "1 kg", mass_kg = 1'), "expected mass only once, got mass and mass_kg"),
    "an unknown key of a body": (body('mas = "1 kg"'), "elbow: unknown key 'mas'; did you mean 'mass'?"),
    "a centre of two": (
        body("mass_kg = 1, centre_m = [1, 2]"),
        "elbow: centre_m: expected a list of three, [x, y, z], got [1, 2]",
    ),
    "the triangle inequality": (
        body("mass_kg = 1, inertia_kgm2 = { xx = 1, yy = 1, zz = 3 }"),
        "which none exceeds the sum of the others, got 1, 1, 3 kg m^2",
    ),
    "inertia below zero": (
        body("mass_kg = 1, inertia_kgm2 = { xx = -1, yy = 1, zz = 1 }"),
        "elbow: inertia: expected principal moments of 0 or above, got -1, 1, 1 kg m^2",
    ),
    "inertia not symmetric": (
        body("mass_kg = 1, inertia_kgm2 = [[1, 0, 0], [1, 1, 0], [0, 0, 1]]"),
        "elbow: inertia: expected a symmetric tensor",
    ),
    "inertia in kilograms": (
        body('mass_kg = 1, inertia = { xx = "1 kg" }'),
        "elbow: inertia: xx: expected a unit like kg m^2, g cm^2, got 'kg'",
    ),
    "inertia by another name": (
        body("mass_kg = 1, inertia_kgm2 = { Ixx = 1 }"),
        "elbow: inertia_kgm2: unknown key 'Ixx'; did you mean 'xx'?",
    ),
    "an axis of no length": (
        f"{ELBOW}axis = [0, 0, 0]\n{MASS}",
        "elbow: axis: expected a vector of length 1, got (0, 0, 0) of length 0",
    ),
    "a ball joint": (
        f'{ELBOW}kind = "ball"\n{MASS}',
        "elbow: kind: expected one of revolute, prismatic, got 'ball'",
    ),
    "a gear that turns nothing": (f"{ELBOW}mu = 0\n{MASS}", "elbow: mu: expected a positive gear ratio"),
    "a gear with a colon": (
        f'{ELBOW}mu = "1:50"\n{MASS}',
        "elbow: mu: expected a ratio with '/', as in '1/5'",
    ),
    "a slide with the gear of a turn": (
        f'{ELBOW}kind = "prismatic"\nmu = 0.1\n{MASS}',
        'elbow: mu: expected a text with a unit, as in "0.1 m/rad", got 0.1',
    ),
    "a rotor below zero": (f"{ELBOW}J_m_kgm2 = -1\n{MASS}", "elbow: J_m: expected 0 or above, got -1"),
    "angles in metres": (f'{ELBOW}rpy = ["1 m", 0, 0]\n{MASS}', "elbow: rpy: expected a unit like deg, rad"),
    "two rotations": (
        f"{ELBOW}rpy_rad = [0, 0, 0]\nrotation = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n{MASS}",
        "elbow: expected only one of rpy and rotation, got both",
    ),
    "a rotation that stretches": (
        f"{ELBOW}rotation = [[2, 0, 0], [0, 1, 0], [0, 0, 1]]\n{MASS}",
        "elbow: rotation: expected columns that are a right-handed frame",
    ),
    "dh and a position": (
        f"{ELBOW}dh = {{ a_m = 1 }}\nposition_m = [0, 0, 1]\n{MASS}",
        "elbow: expected only one of dh and position_m, got both",
    ),
    "an unknown number of dh": (f"{ELBOW}dh = {{ b_m = 1 }}\n{MASS}", "elbow: dh: unknown key 'b_m'"),
    "an unknown body": (
        f'symbolic = ["paylod"]\n{ELBOW}{MASS}',
        "symbolic: expected a body of this arm, got 'paylod'; did you mean 'payload'?",
    ),
    "gravity downwards": (
        f"gravity_m_s2 = -9.81\n{ELBOW}{MASS}",
        "gravity_m_s2: expected a list of three, [x, y, z], got -9.81",
    ),
    "an unknown key": (f"gravit = 3\n{ELBOW}{MASS}", "unknown key 'gravit'; did you mean 'gravity'?"),
    "a name that C has taken": (f'name = "while"\n{ELBOW}{MASS}', "got 'while', a keyword of C"),
    "no TOML": ("joint = [", "not valid TOML: "),
    "not UTF-8": (b"\xff\xfe", "expected UTF-8 text, but byte 0 is not"),
    "a URDF that is not there": ('urdf = "../none.txt"', "urdf: expected a file .urdf, got"),
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
    "another element": (WHOLE.replace("robot", "sdf"), "expected <robot>, got <sdf>"),
    "a document type": (
        WHOLE.replace("<robot", '<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/hosts">]><robot'),
        "expected XML without a document type and entities, got <!DOCTYPE",
    ),
    "another encoding": (
        WHOLE.replace('version="1.0"', 'version="1.0" encoding="latin-1"'),
        "expected UTF-8, got encoding 'latin-1'",
    ),
    "not UTF-8": (WHOLE.encode("utf-16"), "expected UTF-8 text, but byte 0 is not"),
    "xacro": (
        WHOLE.replace("<robot", '<robot xmlns:xacro="http://ros.org/xacro"').replace(
            "</robot>", "<xacro:a/></robot>"
        ),
        "line 2: expected a URDF, got xacro: expand it first",
    ),
    "degrees": (
        WHOLE.replace('<child link="hand"/>', '<child link="hand"/><origin rpy="0 0 90"/>'),
        "origin rpy: expected angles in rad, at most a turn, got '0 0 90'; did you mean degrees?",
    ),
    "no links": ('<robot name="a"/>', "expected links, got none"),
    "a floating joint": (
        WHOLE.replace("continuous", "floating"),
        "joint 'turn': expected type revolute, continuous, prismatic or fixed, got 'floating'",
    ),
    "a joint without a type": (WHOLE.replace(' type="continuous"', ""), "<joint>: expected a type, got"),
    "a joint without a child": (
        WHOLE.replace('<child link="hand"/>', ""),
        "line 2: <joint>: expected a child link, got none",
    ),
    "a link that is not there": (
        WHOLE.replace('<child link="hand"/>', '<child link="hnd"/>'),
        "joint 'turn': expected a link of this file, got 'hnd'; did you mean 'hand'?",
    ),
    "a link twice": (robot(*ARM, link("hand", 1)), "expected each link only once, got 'hand' twice"),
    "a loop back to the base": (
        robot(*ARM, joint("back", "fixed", "hand", "base")),
        "expected one link that no joint carries, got none: a loop",
    ),
    "a loop within": (
        robot(*ARM, joint("back", "fixed", "hand", "carriage")),
        "link 'carriage': expected one joint that carries it, got 'lift' and 'back': a loop",
    ),
    "a loop apart": (robot(*ARM, *LOOP), "expected links behind 'base', got a loop at 'a'"),
    "two bases": (
        robot(*ARM, link("island")),
        "expected one link that no joint carries, got 2: base, island",
    ),
    "nothing that moves": (robot(link("base", 1)), "expected a joint that moves, got none"),
    "a joint that follows another": (
        robot(*ARM, *FINGERS[2:]),
        "joint 'right': expected a drive of its own, got a joint that follows 'left' (mimic)",
    ),
    "a joint without a body": (
        robot(*BASE, link("carriage")),
        "lift: expected a mass on the body of the last joint, or a rotor, got none",
    ),
    "an axis of no length": (
        WHOLE.replace('"0 0 1"', '"0 0 0"'),
        "lift: axis: expected a vector of length 1, got (0, 0, 0) of length 0",
    ),
    "an axis of two": (
        WHOLE.replace('"0 0 1"', '"0 1"'),
        "joint 'lift': axis xyz: expected 3 finite numbers",
    ),
    "a place that is infinite": (
        WHOLE.replace('"0.3 0 0"', '"inf 0 0"'),
        "line 2: joint 'turn': origin xyz: expected 3 finite numbers, got 'inf 0 0'",
    ),
    "mass below zero": (
        WHOLE.replace('mass value="2"', 'mass value="-2"'),
        "link 'hand': mass: expected 0 or above, got -2 kg",
    ),
    "mass not a number": (
        WHOLE.replace('mass value="2"', 'mass value="nan"'),
        "line 2: link 'hand': mass value: expected a finite number, got 'nan'",
    ),
    "inertia without an entry": (
        WHOLE.replace('ixx="0.01"', ""),
        "line 2: link 'hand': inertia ixx: expected a finite number, got none",
    ),
    "the triangle inequality": (
        WHOLE.replace('ixx="0.01"', 'ixx="1"'),
        "which none exceeds the sum of the others, got 0.02, 0.025, 1 kg m^2",
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
        ("hnd", "expected a link of this file as tip, got 'hnd'; did you mean 'hand'?"),
        ("base", "expected a joint that moves before link 'base', got none"),
        ("right finger", "joint 'right': expected a drive of its own, got a joint that follows 'left'"),
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
        ("folder.urdf", "expected a regular file, got a directory"),
        ("arm.yaml", "expected an arm file, .urdf, .toml or .json, got '.yaml'"),
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
