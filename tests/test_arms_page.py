"""The page of arms: its commands run in order, its Python prints what it shows, its C compiles."""

import json
import os
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from eccentric.emission import executed
from tests.compiled import FLAGS
from tests.test_tutorial import first_difference

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs" / "arms.md").read_text(encoding="utf-8")
BENCH = "build/bench_arm"


def blocks(language: str) -> list[str]:
    """The blocks of the page in a language, "" for commands."""
    fence = re.compile(r"^```(\S*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
    return [text for kind, text in fence.findall(PAGE) if kind == language]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the examples, in which all commands of the page have run."""
    pytest.importorskip("mujoco", reason="not installed: MuJoCo (`pip install 'eccentric[arms-bench]'`)")
    pytest.importorskip("yourdfpy", reason="not installed: yourdfpy (`pip install 'eccentric[arms]'`)")
    place = tmp_path_factory.mktemp("arms")
    (place / "examples").symlink_to(ROOT / "examples")
    environment = os.environ | {"OMP_NUM_THREADS": "1", "MPLBACKEND": "agg"}
    for command in "".join(blocks("")).splitlines():
        program, *arguments = shlex.split(command)
        assert "eccentric" == program
        done = subprocess.run(
            [sys.executable, "-m", "eccentric", *arguments],
            cwd=place, env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert 0 == done.returncode, f"{command}\n{done.stdout}{done.stderr}"
    return place


def test_python_prints_what_the_page_shows(folder: Path) -> None:
    """The friction and the loads of one motion."""
    done = subprocess.run(
        [sys.executable, "-c", "".join(blocks("python"))],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip

    assert "" == done.stderr
    assert None is first_difference("".join(blocks("text")), done.stdout)


def test_the_c_compiles(folder: Path) -> None:
    """Beside the emitted header, without a warning."""
    (folder / "drive.c").write_text(blocks("c")[0], encoding="utf-8")
    command = [
        "gcc",
        *FLAGS,
        "-Wno-missing-prototypes",
        "-Ibuild/planar_2r",
        "-c",
        "drive.c",
        "-o",
        "drive.o",
    ]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)

    assert (0, "") == (done.returncode, done.stderr)


def test_the_extended_arm_is_one_call(folder: Path) -> None:
    """The C of the page gives the torque of the arm as declared, and friction by the model of each joint."""
    q, w, a = [0.7, -1.1], [30.0, -9.0], [40.0, 15.0]
    main = f"""#include <stdio.h>
int main(void) {{
    const double q[2] = {{{q[0]}, {q[1]}}}, w[2] = {{{w[0]}, {w[1]}}}, a[2] = {{{a[0]}, {a[1]}}};
    double torque[2];
    feedforward(q, w, a, torque);
    printf("%.17g %.17g", torque[0], torque[1]);
    return 0;
}}
"""
    (folder / "feedforward.c").write_text(blocks("c")[1] + main, encoding="utf-8")
    diagnosis = f"{BENCH}/diagnosis"
    sources = ["feedforward.c", f"{diagnosis}/bench_2r_extended.c"]
    command = [
        "gcc",
        *FLAGS,
        "-Wno-missing-prototypes",
        f"-I{diagnosis}",
        *sources,
        "-o",
        "feedforward",
        "-lm",
    ]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (0, "") == (done.returncode, done.stderr)
    said = subprocess.run(["./feedforward"], cwd=folder, capture_output=True, text=True, check=True).stdout
    places = {
        "bench_2r": f"{BENCH}/firmware",
        "bench_2r_joint_1_fitted": f"{diagnosis}/joint_1",
        "bench_2r_joint_2_extended": f"{diagnosis}/joint_2",
    }
    arm, *joints = (
        executed(
            {path.name: path.read_text(encoding="utf-8") for path in (folder / place).glob("*.py")}, name
        )
        for name, place in places.items()
    )
    load = dict(zip(arm.BEARING_LOADS, arm.bearing_loads(q, w, a), strict=True))
    friction = [
        joint.mechanical_friction_torque(omega_m=w[j], load_N=load[f"F_N_{j}"])
        for j, joint in enumerate(joints)
    ]

    assert pytest.approx(arm.inverse_dynamics(q, w, a) + friction, rel=1e-12) == [
        float(x) for x in said.split()
    ]
    assert abs(friction[1]) > 0.01


def test_the_rig_is_that_of_the_bench(folder: Path) -> None:
    """But for its comments."""
    shown = tomllib.loads(blocks("toml")[0])
    written = tomllib.loads((folder / BENCH / "log.toml").read_text(encoding="utf-8"))

    assert shown == written


def test_the_planted_effect_is_found_in_its_joint(folder: Path) -> None:
    """With the held-out error before and after; the other joint lacks nothing."""
    found = json.loads((folder / BENCH / "diagnosis" / "diagnosis.json").read_text(encoding="utf-8"))
    (effect,) = found["effects"]

    assert (2, "stribeck") == (effect["joint"], effect["family"])
    assert effect["percent"] > 5
    assert "nothing_missing" == found["joints"][0]["diagnosis"]["verdict"]


def test_the_firmware_has_what_was_fitted(folder: Path) -> None:
    """Coefficients and intervals of the fit, as defaults and comments; and it compiles."""
    header = (folder / BENCH / "firmware" / "bench_2r.h").read_text(encoding="utf-8")
    source = (folder / BENCH / "firmware" / "bench_2r.c").read_text(encoding="utf-8")
    fit = json.loads((folder / BENCH / "fit" / "fit.json").read_text(encoding="utf-8"))

    assert fit["parameters"]
    for name, value in fit["parameters"].items():
        (given,) = re.findall(rf"\.{name} = ([-+.e\d]+),", source.split("_default_parameters = {")[1])[:1]
        assert float(given) == value, name
        assert f"{fit['parameter_notes'][name]}" in header
    subprocess.run(
        ["gcc", *FLAGS, "-c", f"{BENCH}/firmware/bench_2r.c", "-o", "firmware.o"], cwd=folder, check=True
    )
