"""The rigid bodies of the bench for arms: torques, bearing loads and energy beside Pinocchio."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from eccentric.virtual_bench.arms.plant import BenchArm, BenchLink, RigidArm
from tests.armbench import random_links, require_mujoco, vector

require_mujoco()
pin = pytest.importorskip("pinocchio", reason="Pinocchio (`pip install pin`) is not installed")


def _inertia(link: BenchLink) -> Any:
    xx, yy, zz, xy, xz, yz = link.inertia
    return pin.Inertia(link.mass, np.array(link.centre), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))


def _rotor(link: BenchLink) -> Any:
    """A rotor as a body: symmetrical about its axis, without weight."""
    axis = np.array(link.axis)
    return pin.Inertia(1e-12, np.zeros(3), 0.5 * link.J_m * (np.eye(3) + np.outer(axis, axis)))


def _place(link: BenchLink) -> Any:
    return pin.SE3(pin.rpy.rpyToMatrix(*link.rpy), np.array(link.position))


def _with_locked_rotors(arm: BenchArm) -> BenchArm:
    """Each link with the rotor that it carries, locked, as an arm is declared."""
    links = list(arm.links)
    for j, link in enumerate(arm.links[:-1]):
        after = arm.links[j + 1]
        both = _inertia(link) + _place(after).act(_rotor(after))
        i = both.inertia
        six = (i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2])
        links[j] = replace(link, mass=both.mass, centre=vector(both.lever), inertia=tuple(map(float, six)))
    return replace(arm, links=tuple(links))


def _pinocchio(
    arm: BenchArm, q: np.ndarray, w: np.ndarray, alpha: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Torques, F_N, F_T, M_B and transmitted torque of an arm whose rotors are bodies of their own."""
    model, parent, own, rotors = pin.Model(), 0, [], []
    model.gravity.linear = np.array(arm.gravity)
    for link in arm.links:
        kind = pin.JointModelRevoluteUnaligned(np.array(link.axis))
        rotors.append(model.addJoint(parent, kind, _place(link), f"rotor {len(own)}"))
        model.appendBodyToJoint(rotors[-1], _rotor(link), pin.SE3.Identity())
        parent = model.addJoint(parent, kind, _place(link), f"joint {len(own)}")
        model.appendBodyToJoint(parent, _inertia(link), pin.SE3.Identity())
        own.append(parent)
    mu, data = arm.column("mu"), model.createData()
    motion = []
    for of_joints in (q, w, alpha):
        full = np.zeros(model.nv)
        full[[model.joints[j].idx_v for j in own]] = of_joints
        full[[model.joints[j].idx_v for j in rotors]] = of_joints / mu
        motion.append(full)
    torque = pin.rnea(model, data, *motion)
    at_joints, at_rotors = (np.array([torque[model.joints[j].idx_v] for j in js]) for js in (own, rotors))
    loads, passed = [], []
    for j, link in zip(own, arm.links, strict=True):
        axis, force, moment = np.array(link.axis), data.f[j].linear, data.f[j].angular
        across = [np.linalg.norm(np.cross(axis, vector)) for vector in (force, moment)]
        loads.append((across[0], abs(axis @ force), across[1]))
        passed.append(axis @ moment)
    return at_joints + at_rotors / mu, np.array(loads).T, np.array(passed)


@pytest.mark.parametrize("n", [1, 2, 3, 6])
def test_torques_and_bearing_loads_are_those_of_pinocchio(n: int) -> None:
    """Arms with any axes and large rotors, which in Pinocchio are bodies of their own: equal to 1e-12."""
    rng = np.random.default_rng(n)
    for _ in range(3):
        bare = random_links(rng, n)
        q, w, alpha = (rng.normal(size=n) * size for size in (2.0, 3.0, 5.0))
        torque, bearing, transmitted = _pinocchio(bare, q, w, alpha)
        rigid = RigidArm(_with_locked_rotors(bare))
        rigid.place(q[None], w[None])
        loads = rigid.loads(alpha[None])

        scale = np.abs(bearing).max()
        np.testing.assert_allclose(rigid.mass()[0] @ alpha + rigid.bias()[0], torque, atol=1e-12 * scale)
        np.testing.assert_allclose(loads.bearing[0], bearing, atol=1e-12 * scale)
        np.testing.assert_allclose(loads.transmitted[0], transmitted, atol=1e-12 * scale)


def test_gravity_torque_is_what_holds_the_arm_at_rest() -> None:
    """Without velocity nothing but gravity is left."""
    rng = np.random.default_rng(5)
    rigid, q = RigidArm(random_links(rng, 6), 2), rng.normal(size=(2, 6))
    rigid.place(q, np.zeros((2, 6)))

    np.testing.assert_allclose(rigid.gravity_torque(), rigid.bias(), atol=1e-11)
