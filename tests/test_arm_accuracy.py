"""The bounds that an arm's header states, against its recursion at 50 digits, on random arms and motions."""

from __future__ import annotations

from types import CodeType

import mpmath
import numpy as np
import pytest
import sympy as sp
from sympy.printing.pycode import MpmathPrinter

from eccentric.emission import Choice, executed, render
from eccentric.emission.program.accuracy import FORCE, MOMENT
from eccentric.model import Body, Chain, Recursion, arm, recursion
from tests.arms import random_chain

DIGITS, STATES = 50, 12
FUNCTIONS = ("inverse_dynamics", "joint_wrenches", "bearing_loads")
LOADS = {"NORMAL": "F_N", "TRANSVERSAL": "F_T", "BENDING": "M_B", "TRANSMITTED": "T"}


def code(found: Recursion) -> CodeType:
    """The recursion and its results for mpmath; angles by the gear ratio that a double holds."""
    printer = MpmathPrinter({
        "fully_qualified_modules": False,
        "user_functions": {"Magnitude": "magnitude"},
    })  # fmt: skip
    angles = {
        f"theta_l_{j}": f"mpf({float(joint.mu)!r})*theta_m_{j}" for j, joint in enumerate(found.chain.joints)
    }
    lines = [
        f"{d.symbol} = {angles.get(d.quantity.name) or printer.doprint(d.value)}" for d in found.definitions
    ]
    for j, joint in enumerate(found.chain.joints):
        results = {f"tau_m_{j}": found.rotors[j] + joint.mu * found.torques[j]}
        results |= {f"{LOADS[load.name]}_{j}": e for load, e in found.bearings[j].loads.items()}
        for part, vector in (("f", found.wrenches[j].force), ("n", found.wrenches[j].moment)):
            turned = found.chain.links[j].tilt * vector
            results |= {f"{part}_{j}_{axis}": turned[k] for k, axis in enumerate("xyz")}
        lines += [f"result_{label} = {printer.doprint(e)}" for label, e in results.items()]
    return compile("\n".join(lines), "recursion", "exec")


def length(vector: sp.MatrixBase) -> float:
    """Of a vector of numbers."""
    return float(np.linalg.norm(np.array(vector.tolist(), dtype=float)))


class Sizes:
    """What the header relates its bounds to, at one motion."""

    def __init__(self, chain: Chain, q: np.ndarray, w: np.ndarray, a: np.ndarray) -> None:
        self.turns = np.array([joint.turns for joint in chain.joints])
        self.mu = np.array([float(joint.mu) for joint in chain.joints])
        J_m = np.array([float(joint.J_m) for joint in chain.joints])
        angle, speed, change = (np.abs(self.mu * x.astype(float)) for x in (q, w, a))
        W, A = speed[self.turns].sum(), change[self.turns].sum()
        V, B = speed[~self.turns].sum(), change[~self.turns].sum()
        self.R = sum(length(joint.placement.position) for joint in chain.joints) + angle[~self.turns].sum()
        bodies = [body for body in chain.bodies if isinstance(body, Body)]
        self.R += max(length(body.centre) for body in bodies)
        self.R += max(float(sp.sqrt(body.inertia.trace() / body.mass)) for body in bodies)
        M = sum(float(body.mass) for body in chain.bodies)
        self.F = M * (length(chain.gravity) + self.R * (W**2 + A) + 2 * V * W + B)
        self.rotors = J_m * (np.abs(a.astype(float)) + W * np.abs(w.astype(float)) + A)
        farthest = max(abs(float(joint.bearing)) for joint in chain.joints)
        self.N = self.F * (self.R + farthest) + self.rotors.sum()

    def bound(self, label: str) -> float:
        """The largest error of a result, over eps."""
        j = int("".join(filter(str.isdigit, label)))
        slides = not self.turns[j]
        if label.startswith("tau_m"):
            passed = self.F if slides else self.N
            return MOMENT * (self.mu[j] * passed + self.rotors[j])
        if label.startswith(("f_", "F_")):
            return FORCE * self.F
        return FORCE * self.F if slides and label.startswith("T_") else MOMENT * self.N


FEW = {
    ("", 1, np.float64),
    ("far bearings", 2, np.float64),
    ("", 3, np.float32),
    ("far bearings", 6, np.float32),
}
"""What `make test` has."""


@pytest.mark.parametrize(
    ("far", "n", "real"),
    [
        pytest.param(
            *(far, n, real),
            id=f"{name}-{n}-{real.__name__}",
            marks=() if (name, n, real) in FEW else pytest.mark.slow,
        )
        for k, (name, far) in enumerate((("", 1.0), ("far bearings", 50.0)))
        for j, n in enumerate((1, 2, 3, 6))
        for i, real in enumerate((np.float32, np.float64))
        if (name, n, real) in FEW or (i + j + k) % 2
    ],
)
def test_the_stated_bounds_hold(n: int, real: type, far: float) -> None:
    """Arms that turn and slide, at rest to fast, over many turns of their motors."""
    rng = np.random.default_rng(50 + n)
    chain = random_chain(rng, n, aligned=n % 2 == 0, geared=True, rotors=True)
    for joint in chain.joints:
        joint.bearing *= sp.Integer(far)
    found = recursion(chain)
    choice, eps = Choice(FUNCTIONS, "none"), float(np.finfo(real).eps)
    files = render(arm(chain, "An arm", found=found), "a test", "a test", ("numpy",), choice=choice)
    module, steps = executed(files, "arm"), code(found)
    for _ in range(STATES):
        fast, jerky, turned = (10.0 ** rng.uniform(*span) for span in ((-1, 1.5), (-1, 2), (0, 3)))
        motion = [(rng.normal(size=n) * x).astype(real) for x in (turned, fast, jerky)]
        motion[1:] = [x / real(1) / np.array([float(j.mu) for j in chain.joints], real) for x in motion[1:]]
        sizes = Sizes(chain, *motion)
        with mpmath.workdps(DIGITS):
            known = dict(vars(mpmath)) | {"magnitude": lambda p, q: mpmath.sqrt(p * p + q * q)}
            for letter, values in zip(("theta_m", "omega_m", "alpha_m"), motion, strict=True):
                known |= {f"{letter}_{j}": mpmath.mpf(float(x)) for j, x in enumerate(values)}
            exec(steps, known)  # noqa: S102 - printed by SymPy
            for function in FUNCTIONS:
                labels = getattr(module, function.upper())
                for label, value in zip(labels, getattr(module, function)(*motion), strict=True):
                    error = float(abs(mpmath.mpf(float(value)) - known[f"result_{label}"]))

                    assert error <= eps * sizes.bound(label), (function, label)


def test_the_header_states_them() -> None:
    """The numbers of the bounds, beside the functions that are emitted."""
    chain = random_chain(np.random.default_rng(60), 2)
    header = render(arm(chain, "An arm"), "a test", "a test")["arm.h"]

    assert f"joint_wrenches: forces within {FORCE} eps of F, moments within {MOMENT} eps of N" in header
