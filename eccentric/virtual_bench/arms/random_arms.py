"""Random arms that could have been built: two links in a vertical plane, three joints, six joints."""

from __future__ import annotations

from math import pi

import numpy as np

from eccentric.virtual_bench.arms.plant import BenchArm, BenchLink, Vector

KINDS = ("2r", "3", "6")
_RIGHT = pi / 2.0
# Rolls of the joints' frames: a robot with three parallel axes, and one with a spherical wrist.
_TWISTS = {
    "3": ((0.0, -_RIGHT, 0.0), (0.0, -_RIGHT, _RIGHT)),
    "6": ((0.0, -_RIGHT, 0.0, 0.0, -_RIGHT, _RIGHT), (0.0, -_RIGHT, 0.0, -_RIGHT, _RIGHT, -_RIGHT)),
}
_MASSES = {"3": (5.0, 3.0, 2.2), "6": (7.0, 7.0, 4.0, 2.0, 1.6, 1.2)}


def random_arm(rng: np.random.Generator, kind: str) -> BenchArm:
    """Draw an arm without friction; `kind` is one of `KINDS`. Rotor inertias and motors are drawn last."""
    return _planar(rng) if kind == "2r" else _spatial(rng, kind)


def _planar(rng: np.random.Generator) -> BenchArm:
    """Two tubes that swing about horizontal axes, a drive at the elbow, a weight at the tip; 0 hangs."""
    lengths, tubes = rng.uniform(0.24, 0.36, 2), rng.uniform(0.3, 0.6, 2)
    ends = rng.uniform(0.4, 0.9), rng.uniform(0.3, 0.8)  # elbow drive, weight
    links, place = [], (0.0, 0.0, 0.0)
    for length, tube, end in zip(lengths, tubes, ends, strict=True):
        along = np.array([0.0, -1.0, 0.0])
        bodies = [(tube, 0.5 * length * along, tube * length**2 / 12.0), (end, length * along, 0.0)]
        links.append(_link(place, (0.0, 0.0, 0.0), bodies, _ratio(rng, 6.0, 30.0)))
        place = (0.0, -round(float(length), 4), 0.0)
    return BenchArm("bench_2r", tuple(links), (0.0, -9.81, 0.0))


def _spatial(rng: np.random.Generator, kind: str) -> BenchArm:
    """A column, an upper arm and a forearm along x, and a wrist; each link a tube and lumps beside it."""
    twists = _TWISTS[kind][int(rng.integers(2))]
    n, links = len(twists), []
    place = np.array([0.0, 0.0, rng.uniform(0.1, 0.2)])
    for j in range(n):
        long = j in {1, 2}
        reach = rng.uniform(0.24, 0.42) if long else rng.uniform(0.07, 0.12)
        aside = rng.uniform(-0.06, 0.06)
        end = np.array([reach, 0.0, aside]) if long else np.array([0.0, 0.5 * aside, reach])
        mass = _MASSES[kind][j] * rng.uniform(0.8, 1.25)
        lumps = rng.normal(size=(4, 3)) * 0.03 + rng.uniform(0.0, 1.0, (4, 1)) * end
        bodies = [(0.1 * mass, lump, 1e-4) for lump in lumps]
        bodies += [(0.6 * mass, 0.5 * end, 0.6 * mass * float(end @ end) / 12.0)]
        if j == n - 1:
            bodies += [(rng.uniform(0.5, 2.0), end + np.array([0.0, 0.0, 0.05]), 1e-3)]
        turn = (twists[j], 0.0, round(float(rng.uniform(-0.2, 0.2)), 4) if j else 0.0)
        links.append(_link(place, turn, bodies, _ratio(rng, 30.0, 120.0)))
        place = end
    return BenchArm(f"bench_{n}r", tuple(links))


def _ratio(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a gear ratio that a catalogue has: one over a whole number."""
    return 1.0 / round(float(np.exp(rng.uniform(np.log(low), np.log(high)))))


def _link(
    position: object, rpy: Vector, bodies: list[tuple[float, np.ndarray, float]], mu: float
) -> BenchLink:
    """Join spheres, each with its mass, place and inertia, into a link; numbers as in a drawing."""
    mass = sum(m for m, _, _ in bodies)
    centre = np.round(sum(m * p for m, p, _ in bodies) / mass, 5)
    tensor = np.zeros((3, 3))
    for m, place, own in bodies:
        d = place - centre
        tensor += m * (float(d @ d) * np.eye(3) - np.outer(d, d)) + own * np.eye(3)
    six = (tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2])
    x, y, z = (round(float(value), 4) for value in np.asarray(position))
    cx, cy, cz = (float(value) for value in centre)
    xx, yy, zz, xy, xz, yz = (round(float(value), 7) for value in six)
    return BenchLink(
        (x, y, z),
        rpy,
        (0.0, 0.0, 1.0),
        round(float(mass), 4),
        (cx, cy, cz),
        (xx, yy, zz, xy, xz, yz),
        mu,
        0.0,
        1.0,
    )
