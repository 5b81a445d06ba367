"""Extended models as the tests call them: the effects of a rig, a few at a time on their base model."""

import dataclasses
import inspect
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from _pytest.mark import ParameterSet

from eccentric.effects import Effect, Setting, library
from eccentric.emission import Choice, executed, render, render_check
from eccentric.model import Model, load_model

BASE = {"C1": "c1_perpendicular", "C2": "c2_parallel"}
CASES = tuple(BASE)
every_case = pytest.mark.parametrize("case", CASES)
slow = pytest.mark.slow
M, M_L, L, MU, R, K_I, K_E, G, J_M, J_L = 0.5, 0.2, 0.25, 0.2, 1.0, 0.02, 0.05, 9.81, 2e-4, 0.04
KNOWN = {"M": M, "M_l": M_L, "L": L, "mu": MU, "R": R, "k_i": K_I, "k_e": K_E, "g": G, "J_m": J_M, "J_l": J_L}
MEAN, END, WARM, W_MAX = 20.0, 60.0, 25.0, 80.0
TURNS, ORDER = 40.0, 3.57  # range of the motor angle, and the order that stands out in the log
# Table 1 as the first fit would find it; C1's B and C hold the transversal force 0.2 kg 9.81 m/s^2.
FIRST_FIT = {
    "C1": {
        "B_lN": 0.004,
        "C_lN": 0.08,
        "B": 0.0004 + MU**2 * 0.004 * 0.2 * 9.81,
        "C": 0.008 + MU * 0.08 * 0.2 * 9.81,
    },
    "C2": {"B_lN": 0.004, "C_lN": 0.08, "B_m": 0.0004, "C_m": 0.008},
}
# Of families with one effect for every harmonic these orders are emitted.
ORDERS = {
    "link_harmonic_friction[n=1]",
    "link_harmonic_friction[n=5]",
    "motor_harmonic_friction[n=3]",
    "cogging[n=1]",
    "cogging[n=24]",
    "kt_ripple[n=1]",
    "kt_ripple[n=7]",
}
# Shapes with a value, 0, at which nothing is scaled or replaced.
NEUTRAL = (
    "viscosity_b",
    "viscosity_E",
    "coulomb_b",
    "heat_b",
    "drift_rate",
    "mass_ratio",
    "offset_angle",
    "tilt_angle",
)
Signals = dict[str, np.ndarray]


@dataclasses.dataclass(frozen=True)
class Extended:
    """A model with a few effects, neutral by default, and what was emitted for it.

    Attributes:
        model: the extended model.
        effects: those in it.
        texts: file name -> text.
        module: the emitted NumPy module.
    """

    model: Model
    effects: tuple[Effect, ...]
    texts: dict[str, str]
    module: ModuleType


def setting(case: str, *, warm: bool) -> Setting:
    """Return the setting of a rig, with or without a temperature."""
    channels = {"current", "voltage", *(["temperature"] if warm else [])}
    seen = frozenset(channels)
    middle = WARM if warm else None
    base = load_model(BASE[case])
    shown = {"temperature_mid": middle, "channels": seen, "friction": FIRST_FIT[case]}
    shown |= {"turns": TURNS, "orders": (ORDER,)}
    return Setting(base, MU, KNOWN, 0.5, W_MAX, 15.0, END, MEAN, **shown)


@cache
def effects(case: str) -> dict[str, Effect]:
    """Return every effect of a case by id, those with and those without a logged temperature."""
    return {e.id: e for warm in (False, True) for e in library(setting(case, warm=warm))}


@cache
def groups(case: str) -> tuple[tuple[Effect, ...], ...]:
    """Return up to five effects at a time; in C2 those only that C1 does not have just so."""
    found: list[list[Effect]] = []
    # Those that no group has two of come first, so that others join them.
    for effect in sorted(effects(case).values(), key=_changes, reverse=True):
        seen = case == "C2" and effects("C1").get(effect.id) == effect
        if seen or (effect.evidence.repeats and effect.id not in ORDERS):
            continue
        for members in found:
            # Two variants of a family share their names.
            if len(members) < 5 and effect.family not in {e.family for e in members}:
                if _changes(effect) and any(map(_changes, members)):
                    continue
                members.append(effect)
                break
        else:
            found.append([effect])
    return tuple(map(tuple, found))


def _changes(effect: Effect) -> bool:
    """Whether an effect makes all of the model longer: with two in one, its checks take minutes."""
    warm, geared = "temperature" in effect.evidence.needs, effect.family == "kinematic_error"
    return bool(effect.change.scales or effect.change.replaces) or warm or geared


def joined(case: str, number: int, values: dict[str, float]) -> Model:
    """Return the base model with a group of effects, the parameters named set to these values."""
    model = load_model(BASE[case])
    for effect in groups(case)[number]:
        model = effect.extend(model, values)
    return dataclasses.replace(model, name=f"{model.name}_{number}")


@cache
def with_group(case: str, number: int) -> Extended:
    """Return the base model with one of the groups, at values where it changes nothing."""
    model = joined(case, number, dict.fromkeys(NEUTRAL, 0.0))
    texts = render(model)
    return Extended(model, groups(case)[number], texts, executed(texts, model.name))


def extended(case: str) -> tuple[Extended, ...]:
    """Return the base model with each of the groups, at values where they change nothing."""
    return tuple(with_group(case, number) for number in range(len(groups(case))))


AT_WORK = {f"{BASE[case]}_{k}": (case, k) for case in CASES for k in range(len(groups(case)))}
# What `make test` samples of them: models with states, two with an exponential; where each costs much, one.
ONE = (("C1", "viscosity_temperature[arrhenius]"),)
SAMPLED = (("C1", "sensor_delay"), ("C2", "hidden_thermal_drift"), *ONE)


def some_at_work(sampled: tuple[tuple[str, str], ...] = SAMPLED) -> list[ParameterSet]:
    """Return the names of the extended models as parameters of a test, most of them slow."""
    return [
        pytest.param(
            name,
            marks=() if any(c == case and e.id == i for c, i in sampled for e in groups(case)[k]) else slow,
        )
        for name, (case, k) in AT_WORK.items()
    ]


def members(name: str) -> tuple[Effect, ...]:
    """Return the effects of an extended model."""
    case, number = AT_WORK[name]
    return groups(case)[number]


def at_work(name: str) -> Model:
    """Return an extended model whose effects show: coefficients 0.1, shapes amid their ranges."""
    return joined(*AT_WORK[name], {q.name: 0.1 for effect in members(name) for q in effect.coefficients})


def written(model: Model, folder: Path) -> Path:
    """Write what is emitted for a model, its checks included, below the folder, and return that."""
    texts = render(model)
    for file, text in (texts | render_check(model, texts)).items():
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        (folder / file).write_text(text, encoding="utf-8")
    return folder


def with_effect(case: str, effect_id: str) -> Extended:
    """Return the extended model that has the effect."""
    members = groups(case)
    return with_group(case, next(k for k in range(len(members)) if effect_id in {e.id for e in members[k]}))


VALUES = ("normal_force", "mechanical_friction_torque", "mechanical_residual", "electrical_residual")


@cache
def briefly(case: str, effect_id: str) -> ModuleType:
    """Return the NumPy module of the extended model that has the effect, without what takes long to derive.

    It has the balances with what they are made of, and the step of the states, but no derivatives.
    """
    number = next(k for k, found in enumerate(groups(case)) if effect_id in {e.id for e in found})
    return _briefly(case, number)


@cache
def _briefly(case: str, number: int) -> ModuleType:
    model = joined(case, number, dict.fromkeys(NEUTRAL, 0.0))
    return executed(render(model, backends=("numpy",), choice=Choice(VALUES, "none")), model.name)


def inputs(size: int = 40) -> Signals:
    """Return reproducible inputs and states, some at rest."""
    random = np.random.default_rng(5)
    columns = {
        "theta_m": random.uniform(-60.0, 60.0, size),
        "omega_m": random.uniform(-70.0, 70.0, size) * (random.integers(0, 5, size) > 0),
        "i": random.uniform(-12.0, 12.0, size),
        "u": random.uniform(-15.0, 15.0, size),
        "alpha_m": random.uniform(-90.0, 90.0, size),
        "t": random.uniform(0.0, END, size),
        "temperature": random.uniform(15.0, 40.0, size),
        "dt": np.full(size, 0.004),
    }
    names = {s.quantity.name for case in CASES for e in effects(case).values() for s in e.change.states}
    return columns | {name: random.uniform(-1.0, 1.0, size) for name in sorted(names)}


def arguments(module: ModuleType, function: str) -> list[str]:
    """Return the names of the inputs of an emitted function, in its order."""
    return [
        n for n in inspect.signature(getattr(module, function)).parameters if n not in {"parameters", "out"}
    ]


def call(module: ModuleType, function: str, given: Signals, **values: float) -> np.ndarray:
    """Call an emitted function with its inputs, the rig's values, and a few parameters set."""
    known = {f.name: KNOWN[f.name] for f in dataclasses.fields(module.Parameters) if f.name in KNOWN}
    asked = [given[name] for name in arguments(module, function)]
    return getattr(module, function)(*asked, module.Parameters(**{**known, **values}))
