"""Attribution finds planted effects, leaves a control alone, and gives no name to what no candidate holds."""

from collections.abc import Callable

import numpy as np
import pytest

from eccentric.diagnosis.search import Attribution, attribute
from eccentric.diagnosis.search.candidate import Candidate, Variables
from eccentric.effects import Evidence, Shape
from eccentric.identification import Coefficient, balance_design
from eccentric.model import quantity
from eccentric.signals import hann_windows

MU, NOISE = 0.2, 0.004


def motion(seconds: float = 60.0, rate: float = 250.0) -> Variables:
    """Four sines whose frequencies have no common period."""
    t = np.arange(0.0, seconds, 1.0 / rate)
    waves = [(14.0, 0.11, 0.3), (9.0, 0.273, 1.1), (7.0, 0.571, 2.0), (3.0, 0.937, 0.5)]
    phases = [2 * np.pi * f * t + p for _, f, p in waves]
    omega = sum(a * np.sin(x) for (a, _, _), x in zip(waves, phases, strict=True))
    theta = sum(-a / (2 * np.pi * f) * np.cos(x) for (a, f, _), x in zip(waves, phases, strict=True))
    alpha = sum(a * 2 * np.pi * f * np.cos(x) for (a, f, _), x in zip(waves, phases, strict=True))
    return Variables(t, np.asarray(theta), np.asarray(omega), np.asarray(alpha), np.zeros(len(t)), MU)


S = motion()
ANGLE = S.theta_m if S.theta_m is not None else np.empty(0)


def stribeck(shape: dict[str, float]) -> np.ndarray:
    """Dry friction that falls off with the square of the speed."""
    return (np.exp(-((np.abs(S.omega_m) / shape["vs"]) ** 2)) * np.sign(S.omega_m))[:, None]


def harmonic(order: int) -> Callable[[dict[str, float]], np.ndarray]:
    """Columns of dry friction that varies with a multiple of the link angle."""
    angle = order * MU * ANGLE
    columns = np.column_stack([np.cos(angle), np.sin(angle)]) * np.sign(S.omega_m)[:, None]
    return lambda _: columns


free = -np.inf
LIBRARY = [
    Candidate("stribeck", "stribeck", "mechanical", Evidence(("velocity",)), stribeck,
              (Shape(quantity("vs", "rad/s", "Stribeck velocity"), 0.5, 15.0, "log", 9),), (0.0,)),
    Candidate("quadratic_drag", "quadratic_drag", "mechanical", Evidence(("velocity",)),
              lambda _: (S.omega_m * np.abs(S.omega_m))[:, None], lower=(0.0,)),
    Candidate("asymmetry", "asymmetry", "mechanical", Evidence(("direction",)),
              lambda _: np.ones((len(S.t), 1))),
    Candidate("time_drift", "time_drift", "mechanical", Evidence(("time",)),
              lambda _: (np.sign(S.omega_m) * S.t / S.t[-1])[:, None]),
    *[Candidate(f"harmonic[n={n}]", "harmonic", "mechanical", Evidence(("link_angle",), repeats=True),
                harmonic(n), lower=(free, free)) for n in (1, 2, 3, 4)],
]  # fmt: skip


def diagnose(missing: np.ndarray, seed: int = 3) -> Attribution:
    """Attribution of a log with Coulomb and viscous friction, white noise and `missing`."""
    rng = np.random.default_rng(seed)
    base = np.column_stack([np.sign(S.omega_m), S.omega_m])
    target = base @ [0.15, 0.01] + missing + NOISE * rng.standard_normal(len(S.t))
    slow = np.abs(S.omega_m) < 0.5
    moving = np.convolve(slow, np.ones(31), mode="same") < 0.5
    one_run = np.zeros(len(S.t), dtype=int)
    rows = hann_windows(S.t, moving, one_run, one_run, length_s=0.064)
    friction = [Coefficient(name, "friction", "", 0.0) for name in ("C", "B")]
    balance = balance_design("mechanical", rows, friction, target, base, target)
    noise = NOISE * float(rows.noise_gain()[0])
    return attribute([balance], LIBRARY, S, noise={"mechanical": noise})


def families(found: Attribution) -> list[str]:
    """Families of the adopted effects."""
    return [one.variant.candidate.family for one in found.adopted]


PLANTED = {
    "stribeck": 0.05 * stribeck({"vs": 4.0})[:, 0],
    "quadratic_drag": 2e-4 * S.omega_m * np.abs(S.omega_m),
    "asymmetry": 0.01 * np.ones(len(S.t)),
    "time_drift": 0.02 * np.sign(S.omega_m) * S.t / 60.0,
    "harmonic": 0.02 * harmonic(3)({})[:, 1],
}


@pytest.mark.parametrize("family", PLANTED)
def test_a_planted_effect_is_named(family: str) -> None:
    """One planted effect is adopted alone and named."""
    found = diagnose(PLANTED[family])

    assert ("named", [family]) == (found.verdict, families(found))


def test_the_shape_of_a_planted_effect_is_recovered() -> None:
    """The Stribeck velocity comes out within 5 %."""
    found = diagnose(PLANTED["stribeck"])

    assert found.adopted[0].variant.values["vs"] == pytest.approx(4.0, rel=0.05)


def test_two_planted_effects_are_both_named() -> None:
    """Both of two effects are adopted."""
    found = diagnose(PLANTED["stribeck"] + PLANTED["harmonic"])

    assert ("named", {"stribeck", "harmonic"}) == (found.verdict, set(families(found)))


@pytest.mark.parametrize("seed", range(3))
def test_a_control_is_left_alone(seed: int) -> None:
    """Where nothing is missing nothing is adopted."""
    found = diagnose(np.zeros(len(S.t)), seed)

    assert ("nothing_missing", []) == (found.verdict, families(found))


@pytest.mark.parametrize(
    ("variable", "missing"),
    {
        "velocity": 0.05 * np.sign(S.omega_m) * np.sin(2 * np.pi * np.abs(S.omega_m) / 9.0),
        "time": 0.03 * np.sign(S.omega_m) * np.sin(2 * np.pi * S.t / 19.0),
        "link_angle": 0.04 * np.sign(S.omega_m) * (np.mod(MU * ANGLE, 2 * np.pi) < 1.6),
    }.items(),
)
def test_what_no_candidate_holds_is_not_named(variable: str, missing: np.ndarray) -> None:
    """Structure outside the library is `unexplained`, with the variable that it follows first."""
    found = diagnose(missing)

    assert ("unexplained", variable) == (found.verdict, found.depends_on[0])
