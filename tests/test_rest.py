"""Friction at rest: what holds a drive holds it exactly, and a step never gains energy from friction."""

import inspect
import math
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

import eccentric
from eccentric.core import InputError
from eccentric.effects import Effect
from eccentric.emission import inertial_loss
from eccentric.emission.hot import load_module
from eccentric.model import Model, load_model, with_values
from eccentric.presentation import loss_warnings
from tests import extended
from tests.compiled import CFunctions
from tests.emitted import MODELS, every_model, module, with_inertia
from tests.hosts import need

J_M, J_L = 2e-4, 0.04
RANDOM = np.random.default_rng(8)


def taken(function: Callable[..., object]) -> list[str]:
    """Return the names of a function's inputs."""
    return [x for x in inspect.signature(function).parameters if x not in {"parameters", "out"}]


def drawn(names: list[str], count: int) -> dict[str, np.ndarray]:
    """States in a drive's range, half of the time steps long."""
    wide = {"theta_m": 40.0, "omega_m": 60.0, "alpha_m": 200.0, "torque": 0.5, "i": 5.0, "u": 20.0}
    found = {name: wide.get(name, 1.0) * RANDOM.uniform(-1.0, 1.0, count) for name in names}
    found["dt"] = 10.0 ** RANDOM.uniform(-4.0, -2.0, count)
    found["temperature"] = RANDOM.uniform(15.0, 40.0, count)
    return found


def call(emitted: ModuleType, function: str, columns: dict[str, np.ndarray], p: object) -> np.ndarray:
    """Return what a function gives for the columns that it takes."""
    f = getattr(emitted, function)
    return f(*(columns[name] for name in taken(f)), p)


# Within the levels nothing moves.


@every_model
def test_torques_within_the_levels_move_nothing(name: str) -> None:
    """A thousand drives at rest, a thousand steps each, every torque and time step drawn anew."""
    emitted, p, drives = module(name), with_inertia(name), 1000
    theta_m = RANDOM.uniform(-9.0, 9.0, drives)
    at_rest = {"theta_m": theta_m, "omega_m": np.zeros(drives), "alpha_m": np.zeros(drives)}
    lower, upper, _ = np.broadcast_to(call(emitted, "friction_budget", at_rest, p), (drives, 3)).T
    omega_m = np.zeros(drives)
    for _ in range(1000):
        torque = lower + (upper - lower) * RANDOM.uniform(0.0, 1.0, drives)
        step = at_rest | {"omega_m": omega_m, "torque": torque}
        step["dt"] = 10.0 ** RANDOM.uniform(-4.0, -2.0, drives)
        omega_m = call(emitted, "friction_step", step, p)[:, 0]
        assert not omega_m.any()
        assert not np.any(call(emitted, "acceleration", step, p))


@every_model
def test_a_step_takes_energy(name: str) -> None:
    """Friction has the sign of the velocity, which is at most that without friction: a million steps."""
    emitted, p = module(name), with_inertia(name)
    J = p.J_m + p.mu**2 * p.J_l
    columns = drawn(taken(emitted.friction_step), 1_000_000)
    after, friction = call(emitted, "friction_step", columns, p).T
    without = np.abs(J * columns["omega_m"] + columns["dt"] * columns["torque"]) / J

    assert np.all(friction * after >= 0.0)
    assert np.all(np.abs(after) <= without * (1.0 + 4.0 * np.finfo(float).eps))
    assert np.any(after == 0.0)
    assert np.any(after > 0.0)


@pytest.mark.parametrize("dt", [0.0, -1e-3, 1e-12])
def test_without_time_nothing_happens(dt: float) -> None:
    """A first sample, a time that runs backwards and a repeated one change no velocity."""
    after, friction = module("c2_parallel").friction_step(0.3, 2.0, 0.5, dt, with_inertia("c2_parallel"))

    assert (after, friction) == (2.0, 0.0)


def test_what_is_no_number_gives_none() -> None:
    """A NaN is never taken for a drive at rest."""
    p = with_inertia("c2_parallel")
    for k in range(4):
        given = [0.3, 2.0, 0.5, 1e-3]
        given[k] = math.nan
        assert np.isnan(module("c2_parallel").friction_step(*given, p)).all(), k


# The levels are those of the friction torque.


@pytest.mark.parametrize(
    ("case", "effect"),
    [
        pytest.param(case, effect, id=f"{case}-{effect.id}", marks=() if k % 8 == j else pytest.mark.slow)
        for j, case in enumerate(extended.CASES)
        for k, effect in enumerate(extended.effects(case).values())
        if not effect.evidence.repeats or effect.id in extended.ORDERS
        if effect.family not in {"presliding", "backlash"}
        # One that both cases have is taken of one of them.
        if sum(map(ord, effect.id)) % 2 == j or effect.id not in extended.effects(extended.CASES[1 - j])
    ],
)
def test_in_motion_it_is_the_friction_torque(case: str, effect: Effect) -> None:
    """Of the direction of motion, the level and the viscous part add up to it, whatever effect there is."""
    values = {q.name: 1e-4 if "N m" in q.unit else 0.01 for q in effect.coefficients}
    emitted = load_module(effect.extend(load_model(extended.BASE[case]), values))
    p = emitted.Parameters(J_m=J_M, J_l=J_L)
    columns = drawn(taken(emitted.mechanical_friction_torque) + taken(emitted.friction_budget), 500)
    lower, upper, viscous = call(emitted, "friction_budget", columns, p).T

    together = np.where(columns["omega_m"] > 0.0, upper, lower) + viscous * columns["omega_m"]
    expected = call(emitted, "mechanical_friction_torque", columns, p)
    assert together == pytest.approx(expected, rel=1e-12, abs=1e-15)
    assert np.all(lower <= 0.0)
    assert np.all(upper >= 0.0)


@pytest.mark.parametrize(
    "effect",
    [
        "kinematic_error[motor,n=1]",
        *(
            pytest.param(name, marks=pytest.mark.slow)
            for name in ("joint_compliance", "encoder_eccentricity[motor]", "load_dependent[transmitted]")
        ),
    ],
)
def test_an_acceleration_is_that_of_the_balance(effect: str) -> None:
    """In motion it takes as much torque as the residual, friction aside, even if the inertia varies.

    With an error e of the gear it is that of the kinetic energy, J_m + (mu + e')^2 J_l, to first order in e.
    """
    own = extended.effects("C2")[effect]
    model = own.extend(load_model("c2_parallel"), {q.name: 1e-4 for q in own.coefficients})
    emitted = load_module(model)
    p = emitted.Parameters(J_m=J_M, J_l=J_L)
    rows = drawn(taken(emitted.mechanical_residual) + taken(emitted.acceleration), 100)
    rows["omega_m"] = np.abs(rows["omega_m"])
    faster = [call(emitted, "acceleration", rows | {"torque": np.full(100, x)}, p) for x in (5.0, 6.0)]
    needed = [
        call(emitted, "mechanical_residual", rows | {"alpha_m": np.full(100, x)}, p)
        + call(emitted, "mechanical_friction_torque", rows | {"alpha_m": np.full(100, x)}, p)
        for x in (0.0, 1.0)
    ]
    inertia = 1.0 / (faster[1] - faster[0])

    assert inertia == pytest.approx(needed[0] - needed[1], rel=1e-11)
    if "kinematic" in effect:
        slope = 1e-4 * (np.cos(rows["theta_m"]) - np.sin(rows["theta_m"]))
        assert inertia == pytest.approx(J_M + (extended.MU + slope) ** 2 * J_L, rel=1e-6)
        assert np.ptp(inertia) > 1e-3 * inertia.mean()


@pytest.mark.parametrize("name", MODELS)
def test_breakaway_is_the_budget_at_rest(name: str) -> None:
    """At rest and without acceleration."""
    emitted, p = module(name), with_inertia(name)
    at_rest = drawn(taken(emitted.friction_budget), 50) | {"omega_m": np.zeros(50), "alpha_m": np.zeros(50)}

    budget = np.broadcast_to(call(emitted, "friction_budget", at_rest, p), (50, 3))
    levels = np.broadcast_to(call(emitted, "breakaway_torque", at_rest, p), (50, 2))
    assert levels == pytest.approx(budget[:, :2], rel=1e-13)


def test_friction_does_not_drive() -> None:
    """Where a ripple takes away more than there is, the level is cut at 0."""
    effect = extended.effects("C2")["link_harmonic_friction[n=5]"]
    emitted = load_module(
        effect.extend(load_model("c2_parallel"), {q.name: 0.2 for q in effect.coefficients})
    )
    lower, upper, _ = emitted.friction_budget(np.linspace(0.0, 31.4, 2000), 3.0).T

    assert upper.min() == 0.0
    assert upper.max() > 0.3
    assert np.array_equal(-lower, upper)


def test_the_former_name_names_the_new_one(tmp_path: Path) -> None:
    """In Python, in compiled modules, in C and at the command line's `--functions`."""
    need("gcc")
    for emitted in (module("c2_parallel"), eccentric.compile("c2_parallel")):
        with pytest.raises(
            AttributeError, match="now breakaway_torque, which returns the lower and the upper"
        ):
            emitted.coulomb_torque()
    with pytest.raises(InputError, match="expected breakaway_torque, got 'coulomb_torque', its former"):
        eccentric.emit("c2_parallel", tmp_path / "out", functions=["coulomb_torque"])

    source = tmp_path / "main.c"
    called = "int main(void) { return c2_parallel_coulomb_torque(&c2_parallel_default) > 0; }"
    source.write_text(f'#include "c2_parallel.h"\n{called}\n')
    folder = Path(__file__).resolve().parents[1] / "generated"
    said = subprocess.run(
        ["gcc", "-std=c99", "-Werror", f"-I{folder}", "-c", source, "-o", tmp_path / "main.o"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert said.returncode != 0
    assert "is_now_breakaway_torque" in said.stderr


# Presliding: friction builds up over a distance, and holds there.


@pytest.mark.parametrize(("variant", "share"), [("presliding", 0.99), ("presliding[lugre]", 0.9)])
def test_bristles_come_to_rest(variant: str, share: float) -> None:
    """A constant torque below breakaway bends them to where they hold it; changing ones move them little.

    Nearer to it those of LuGre give way: its friction falls with the speed, also with that of bristles.
    """
    values = {"presliding_A": 0.06, "presliding_D": 1e-3}
    effect = extended.effects("C2")[variant]
    emitted = load_module(
        effect.extend(load_model("c2_parallel"), {q.name: values[q.name] for q in effect.coefficients})
    )
    p, drives, dt = emitted.Parameters(J_m=J_M, J_l=J_L), 50, 4e-3
    breakaway = emitted.breakaway_torque(p)[1]
    reach = p.presliding_x
    constant = breakaway * np.linspace(-share, share, drives)
    moved: list[np.ndarray] = []
    for torques_at in (lambda: constant, lambda: breakaway * RANDOM.uniform(-0.7, 0.7, drives)):
        theta_m, omega_m, z = np.zeros((3, drives))
        for _ in range(5_000):
            omega_m = emitted.friction_step(theta_m, omega_m, z, torques_at(), dt, p)[:, 0]
            z = emitted.next_state(omega_m, z, dt, p)[:, 0]
            theta_m = theta_m + dt * omega_m
        moved += [theta_m, dt * omega_m]
    bent, last, shaken, _ = moved

    assert np.all(np.abs(last) < 1e-9 * reach)
    assert np.all(bent * constant >= 0.0)
    assert np.abs(bent).max() > 0.1 * reach
    assert np.all(np.abs(shaken) < 0.1 * reach)


@pytest.mark.parametrize(("C_lN", "solvable"), [(0.07, True), (0.5, False)])
def test_friction_that_follows_the_acceleration_has_to_stay_below_the_inertia(
    C_lN: float, solvable: bool, tmp_path: Path
) -> None:
    """F_N takes C_lN mu^2 M L + B_lN mu^3 M L |w| of it; above J all but the torque is refused."""
    M, L, mu, B_lN, speed = 0.489, 0.279, 0.2, 0.006, 1.0
    values = {"M": M, "L": L, "mu": mu, "C_lN": C_lN, "B_lN": B_lN, "J_m": 1e-4, "J_l": J_L}
    model = with_values(load_model("rotating_link"), values, "rotating_link")
    found = inertial_loss(model, speed)

    assert found is not None
    assert solvable is found.solvable
    assert found.inertia == pytest.approx(1e-4 + mu**2 * J_L)
    assert found.loss == pytest.approx(C_lN * mu**2 * M * L + B_lN * mu**3 * M * L * speed, rel=1e-6)
    if solvable:
        assert eccentric.emit(model, tmp_path / "whole")
    else:
        with pytest.raises(InputError, match=r"below the inertia, 0\.0017 kg m"):
            eccentric.emit(model, tmp_path / "whole")
        assert eccentric.emit(model, tmp_path / "torque", functions=["friction_torque"])


@pytest.mark.parametrize(("speed", "warned"), [(1.0, False), (300.0, True)])
def test_a_simulation_judges_the_loss_at_the_speed_of_its_log(speed: float, warned: bool) -> None:
    """B_lN mu^3 M L |w| of the acceleration is below J at 1 rad/s and above it at 300 rad/s."""
    values = {"M": 0.489, "L": 0.279, "mu": 0.2, "B_lN": 0.05, "C_lN": 0.01, "J_m": 1e-4, "J_l": 0.01}
    channels = SimpleNamespace(
        motion=SimpleNamespace(omega_m=np.array([-0.5 * speed, speed])),
        selection=SimpleNamespace(fit_rows=np.ones(2, dtype=bool)),
        temperature=None,
    )
    drive = SimpleNamespace(drive=SimpleNamespace(channels=channels))
    fit = SimpleNamespace(model=load_model("rotating_link"), values=values, data=drive)
    assert warned is bool(loss_warnings({"paper": cast("Any", fit)}))


def test_a_loss_of_the_transmitted_torque_has_its_closed_form() -> None:
    """It takes eta mu^2 J_l of an acceleration; friction that follows none has no loss of this kind."""
    effect = extended.effects("C2")["load_dependent[transmitted]"]
    eta = 0.3
    values = {q.name: eta if q.name == "load_eta" else 0.0 for q in effect.parameters}
    known = {**extended.KNOWN, "B_lN": 0.0, "C_lN": 0.0, "B_m": 0.001, "C_m": 0.01}
    plain = with_values(load_model("c2_parallel"), known, "drive")
    found = inertial_loss(effect.extend(plain, values))

    assert inertial_loss(plain) is None
    assert found is not None
    assert found.loss == pytest.approx(eta * extended.MU**2 * J_L, rel=1e-6)


LOSSES = [  # a loss that is tried, the others, and how much of it makes a loss of so much of mu^2 J_l
    ("load_eta", {}, lambda whole: whole),
    ("gear_eta", {"gear_rho": 0.5}, lambda whole: whole),
    ("gear_rho", {"gear_eta": 0.25}, lambda whole: whole / 0.25),
    ("gear_eta", {"load_eta": 0.4, "gear_rho": 0.5}, lambda whole: whole - 0.4),
    ("gear_rho", {"load_eta": 0.4, "gear_eta": 0.25}, lambda whole: (whole - 0.4) / 0.25),
]
"""The losses of several effects add up, and the parameter with which they reach the inertia is named."""


@cache
def lossy() -> Model:
    """The model of case C2 with two losses of the transmitted torque; all friction is 0 but what is set."""
    model = load_model("c2_parallel")
    for name in ("load_dependent[transmitted]", "gear_efficiency[transmitted]"):
        model = extended.effects("C2")[name].extend(model, {})
    return with_values(model, dict.fromkeys((q.name for q in model.friction_parameters), 0.0), "lossy")


def beside_the_bound(
    parameter: str, values: dict[str, float], own: Callable[[float], float]
) -> list[dict[str, float]]:
    """Values just below and just above those that make the losses (J_m + mu^2 J_l)/(mu^2 J_l)."""
    least = own((J_M + extended.MU**2 * J_L) / (extended.MU**2 * J_L))
    return [values | {parameter: share * least} for share in (0.999, 1.001)]


def test_a_loss_beyond_the_inertia_is_refused(tmp_path: Path) -> None:
    """By `prepare` in C, with the number of the parameter; in Python by what solves for a motion."""
    need("gcc")
    eccentric.emit(lossy(), tmp_path / "out", functions=["friction_step"], backend="c99")
    c = CFunctions("lossy", np.float64, tmp_path / "lossy.so", tmp_path / "out")
    letters = [name for name, _ in c.ffi.typeof("lossy_parameters").fields]
    modules = load_module(lossy()), eccentric.compile(lossy())
    for parameter, values, own in LOSSES:
        for given, refused in zip(beside_the_bound(parameter, values, own), (False, True), strict=True):
            p: Any = c.ffi.new("lossy_parameters *", c["default_parameters"])
            prepared = c.ffi.new("lossy_coefficients *")
            for name, value in (given | {"J_m": J_M, "J_l": J_L}).items():
                setattr(p, name, value)
            assert c["prepare"](p, prepared) == (1 + letters.index(parameter) if refused else 0)
            p.J_m = math.nan
            assert c["prepare"](p, prepared) == 0
            for emitted in modules:
                require_one_solution(
                    emitted, emitted.Parameters(**given, J_m=J_M, J_l=J_L), parameter * refused
                )


def require_one_solution(emitted: ModuleType, p: object, refused: str) -> None:
    """Call what solves for a motion, on numbers and arrays; `refused` is the parameter it names, if any."""
    state, many = (0.3, 0.0, 0.0), (np.full(3, 0.3), 0.0, np.zeros((2, 1)))
    assert np.isfinite(emitted.mechanical_residual(*state, 0.1, p))
    for at in (state, many):
        for function, rest in (
            (emitted.friction_step, (0.1, 1e-3)),
            (emitted.acceleration, (0.1,)),
            (emitted.acceleration, (0.0,)),
        ):
            if refused:
                with pytest.raises(ValueError, match=f"^{refused}: expected acceleration-dependent friction"):
                    function(*at, *rest, p)
            else:
                assert np.isfinite(function(*at, *rest, p)).all()
