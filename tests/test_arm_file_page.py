"""docs/arm-file.md is correct: its files are read, its keys are all keys, its Python prints what it says."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

import pytest
import sympy as sp

from eccentric.rigs import KEYS_OF_ARMS, KEYS_OF_BODIES, KEYS_OF_JOINTS, read_arm
from tests.arms import bodies_of
from tests.test_arms_urdf import joint, link, robot

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "arm-file.md").read_text(encoding="utf-8")
COMPLETE, ON_URDF = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)


def test_the_arm_of_the_page_is_what_its_comments_say(tmp_path: Path) -> None:
    """The complete file is read: joints, drives, bodies, gravity, payload and what stays symbolic."""
    (tmp_path / "arm.toml").write_text(COMPLETE, encoding="utf-8")
    chain = read_arm(tmp_path / "arm.toml")
    shoulder, elbow = chain.joints

    assert ("two_links", "shoulder", "elbow") == (chain.name, shoulder.name, elbow.name)
    assert [0, sp.Rational("-9.81"), 0] == list(chain.gravity)
    assert [sp.Rational(1, 9), sp.Rational("6e-5"), sp.Rational("0.015")] == [
        shoulder.mu, shoulder.J_m, shoulder.bearing,
    ]  # fmt: skip
    assert sp.Matrix([[0, -1, 0], [1, 0, 0], [0, 0, 1]]) == shoulder.placement.rotation
    assert [0, sp.Rational("-0.3"), sp.Rational("0.025")] == list(elbow.placement.position)
    assert sp.diag(*map(sp.Rational, ("0.0158", "0.0011", "0.0162"))) == bodies_of(chain)[0].inertia
    assert {"payload_mass": sp.Rational(1, 2)} == {q.name: q.default for q in chain.parameters}


def test_the_file_on_a_urdf_is_read(tmp_path: Path) -> None:
    """The second file adds drives to a URDF with the names that it uses."""
    pytest.importorskip("yourdfpy", reason="yourdfpy (`pip install 'eccentric[arms]'`) is not installed")
    turn, hand = joint("panda_joint2", "revolute", "base", "panda_hand"), link("panda_hand", 1)
    fingers = joint("finger", "prismatic", "panda_hand", "finger"), link("finger", 1)
    (tmp_path / "panda.urdf").write_text(robot(link("base"), turn, hand, *fingers), encoding="utf-8")
    (tmp_path / "arm.toml").write_text(ON_URDF, encoding="utf-8")
    chain = read_arm(tmp_path / "arm.toml")

    assert [("panda_joint2", sp.Rational(1, 100))] == [(x.name, x.mu) for x in chain.joints]
    assert 10 == len(chain.parameters)


def test_every_key_stands_in_the_page() -> None:
    """Keys of the file, of joints and of bodies, in both ways of writing."""
    tables = PAGE.split("## Keys")[1].split("## What")[0]
    told = {code.strip("[]") for code in re.findall(r"`([^`]+)`", tables)}

    assert set() == {*KEYS_OF_ARMS, *KEYS_OF_JOINTS, *KEYS_OF_BODIES, "mu_m_per_rad"} - told


def test_the_python_of_the_page_prints_what_follows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Run in the folder of the project."""
    (code, printed), = re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", PAGE, re.DOTALL)  # fmt: skip
    monkeypatch.chdir(ROOT)
    with contextlib.redirect_stdout(io.StringIO()) as out:
        exec(compile(code, "arm-file.md", "exec"), {})  # noqa: S102 - the page's own

    assert printed == out.getvalue()
