"""What others take for the inverse dynamics of the same chain: CasADi's generated C, and Pinocchio's own C++.

Instructions on x86-64, by callgrind, the mean over the same motions.
    python benchmarks/arm_peers.py JOINTS     (calls Pinocchio, for callgrind to count)
"""

from __future__ import annotations

import re
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from benchmarks.cortex_m4 import run
from eccentric.model import Body, Chain
from tests.test_chain_size import robot

MOTIONS = 50
Array = np.ndarray


def motion(k: int, n: int) -> tuple[Array, Array, Array]:
    """Angles, velocities and accelerations (n,) of motion k, those of the emitted code's count."""
    j = np.arange(n)
    return 0.1 * k + j, 1.0 - 0.01 * k * j, 0.5 * k - j


def casadi_torques(chain: Chain, n: int) -> Any:
    """CasADi's function q, w, a -> torques: Newton-Euler with every number of the chain folded.

    Each joint turns about the axis of its own frame; forces are taken back from the last body to the first.
    """
    ca = import_module("casadi")
    q, w, a = (ca.SX.sym(name, n) for name in "qwa")
    speed, rate = ca.SX.zeros(3), ca.SX.zeros(3)
    pull = ca.SX(-np.array(chain.gravity.tolist(), float).ravel())
    links = []
    for k, (joint, body) in enumerate(zip(chain.joints, chain.bodies, strict=True)):
        assert isinstance(body, Body)
        assert joint.turns
        axis, place, centre = (
            np.array(x.tolist(), float).ravel() for x in (joint.axis, joint.placement.position, body.centre)
        )
        frame, inertia = (np.array(x.tolist(), float) for x in (joint.placement.rotation, body.inertia))
        across = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
        turn = np.eye(3) + ca.sin(q[k]) * across + (1 - ca.cos(q[k])) * (across @ across)
        back = ca.sparsify(frame @ turn).T
        pull = back @ (pull + ca.cross(rate, place) + ca.cross(speed, ca.cross(speed, place)))
        speed, rate = back @ speed, back @ rate
        rate = rate + ca.cross(speed, axis * w[k]) + axis * a[k]
        speed = speed + axis * w[k]
        at_centre = pull + ca.cross(rate, centre) + ca.cross(speed, ca.cross(speed, centre))
        force = float(body.mass) * at_centre
        moment = inertia @ rate + ca.cross(speed, inertia @ speed) + ca.cross(centre, force)
        links.append((back, place, axis, force, moment))
    torques, force, moment = [], ca.SX.zeros(3), ca.SX.zeros(3)
    for back, place, axis, own, turning in reversed(links):
        force, moment = force + own, moment + turning
        torques.append(ca.dot(axis, moment))
        force = back.T @ force
        moment = back.T @ moment + ca.cross(place, force)
    return ca.Function("torques", [q, w, a], [ca.cse(ca.vertcat(*reversed(torques)))])


def casadi(folder: Path, n: int) -> float:
    """Instructions of the C that CasADi generates, gcc -O2."""
    ca = import_module("casadi")
    generator = ca.CodeGenerator("peer.c", {"with_header": False})
    generator.add(casadi_torques(robot(n), n))
    generator.generate(f"{folder}/")
    (folder / "call.c").write_text(_MAIN.replace("MOTIONS", str(MOTIONS)), encoding="utf-8")
    program = folder / "peer"
    run("gcc", "-std=c99", "-O2", "-g", folder / "call.c", folder / "peer.c", "-o", program, "-lm")
    return _counted(folder, [program], r":torques\b")


def pinocchio(folder: Path, n: int) -> float:
    """Instructions of Pinocchio's `rnea`, as its package has it compiled."""
    import_module("pinocchio")
    return _counted(folder, [sys.executable, __file__, str(n)], r":pinocchio::DataTpl<.*? pinocchio::rnea<")


def _counted(folder: Path, command: list[str | Path], name: str) -> float:
    """Instructions of a call of the function, with all that it calls."""
    profile = folder / "profile"
    run("valgrind", "-q", "--tool=callgrind", f"--callgrind-out-file={profile}", *command, timeout=600)
    said = run("callgrind_annotate", "--inclusive=yes", "--threshold=100", profile)
    found = re.search(rf"^\s*([\d,]+) .*?{name}", said, re.MULTILINE)
    if found is None:
        raise RuntimeError(f"callgrind saw no {name}")
    return int(found[1].replace(",", "")) / MOTIONS


_MAIN = """
int torques(const double **arg, double **res, long long int *iw, double *w, int mem);
volatile double last;
int main(void)
{
    double q[16], w[16], a[16], out[16];
    for (int k = 0; k < MOTIONS; ++k) {
        for (int j = 0; j < 16; ++j) {
            q[j] = 0.1 * k + j;
            w[j] = 1.0 - 0.01 * k * j;
            a[j] = 0.5 * k - j;
        }
        torques((const double *[]){q, w, a}, (double *[]){out}, 0, 0, 0);
        last = out[0];
    }
    return 0;
}
"""


def main(n: int) -> None:
    """Call Pinocchio once for each motion; joints about the axis of a coordinate are declared as such."""
    pin = import_module("pinocchio")
    model, parent, chain = pin.Model(), 0, robot(n)
    for joint, body in zip(chain.joints, chain.bodies, strict=True):
        assert isinstance(body, Body)
        axis, place, centre = (
            np.array(x.tolist(), float).ravel() for x in (joint.axis, joint.placement.position, body.centre)
        )
        frame, inertia = (np.array(x.tolist(), float) for x in (joint.placement.rotation, body.inertia))
        aligned = {(1, 0, 0): pin.JointModelRX, (0, 1, 0): pin.JointModelRY, (0, 0, 1): pin.JointModelRZ}
        kind = aligned.get(tuple(axis.round(12)))
        turning = pin.JointModelRevoluteUnaligned(axis) if kind is None else kind()
        parent = model.addJoint(parent, turning, pin.SE3(frame, place), joint.name)
        model.appendBodyToJoint(parent, pin.Inertia(float(body.mass), centre, inertia), pin.SE3.Identity())
    data = model.createData()
    for k in range(MOTIONS):
        pin.rnea(model, data, *motion(k, n))


if __name__ == "__main__":
    main(int(sys.argv[1]))
