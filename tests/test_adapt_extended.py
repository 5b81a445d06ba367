"""The estimator of extended models: it is emitted, compiles, and has the same bits in C and in Python."""

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipe

from eccentric.core import InputError
from eccentric.emission.adapt import prior_of
from eccentric.emission.adapt.prior import _seen
from eccentric.model import Model, load_model, with_values
from tests.adapted import DRIVE, Estimator, emitted, module, motion, python_bits
from tests.extended import effects

NAME = "extended"
COUNT = 3000
# A torque beside friction, a coefficient with an exponential, a scale of others, a hidden state.
KINDS = {"cogging[n=1]": {}, "stribeck[d=2]": {}, "time_drift": {"drift_C": 1e-3}, "presliding[lugre]": {}}
"""With the values of a fit, where the estimator needs them."""


def stand_in(x: Any) -> Any:
    """No two libraries have the same exponential; this is in its place in Python and C."""
    return 1.0 / (1.0 + x * x)


def without_exponential(folder: Path, python: Any) -> None:
    """Put the stand-in into the module and the source of the model."""
    for name, library in (("np", np), ("math", math)):
        vars(python.model)[name] = SimpleNamespace(**vars(library) | {"exp": stand_in})
    source = folder / f"{NAME}.c"
    text = source.read_text(encoding="utf-8")
    for suffix, one in (("f", "1.0f"), ("", "1.0")):
        text = text.replace(f"(x) exp{suffix}(x)", f"(x) ({one} / ({one} + (x) * (x)))")
    source.write_text(text, encoding="utf-8")


def log(names: Sequence[str], dtype: Any) -> list[np.ndarray]:
    """Swings with rests, and everything else that such a model takes."""
    generator = np.random.default_rng(4)
    moved = motion(COUNT, 4)
    driven = 2.0 * np.sign(moved[1]) + generator.normal(0, 0.2, COUNT)
    known: dict[str, np.ndarray] = dict(
        zip(("theta_m", "omega_m", "alpha_m", "i"), [*moved, driven], strict=True)
    )
    known["t"] = np.arange(COUNT) * 1e-3
    known["presliding_z"] = np.tanh(moved[0])
    return [known[name].astype(dtype) for name in names]


def extended(kind: str, **values: float) -> Model:
    """Case C2 with that effect."""
    wide = effects("C2")[kind].extend(load_model("c2_parallel"), KINDS.get(kind, {}) | values)
    return dataclasses.replace(wide, name=NAME)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_same_bits(tmp_path: Path, kind: str) -> None:
    """Flags and every number of the state agree, in both precisions."""
    folder = emitted(tmp_path, extended(kind), DRIVE)
    python = module(folder, NAME)
    without_exponential(folder, python)

    for dtype in (np.float32, np.float64):
        state, c, rows = python.init(dtype), Estimator(folder, NAME, dtype), log(python.INPUTS, dtype)
        expected = python.replay(*rows, state)["flags"].tolist()
        assert expected == c.learn(rows)
        assert python_bits(state) == c.bits()
        assert {python.STILL, python.UPDATED} <= set(expected)


@pytest.mark.parametrize(("kind", "name"), [("time_drift", "drift_C"), ("backlash", "backlash_C")])
def test_a_coefficient_of_unknown_size_is_refused(tmp_path: Path, kind: str, name: str) -> None:
    """At the start its column is 0, by the time or a hidden state: without a value nothing tells its size."""
    with pytest.raises(InputError, match=f"expected {name} other than 0, since nothing else"):
        emitted(tmp_path, extended(kind, **{name: 0.0}), DRIVE)


def test_stribeck_friction_may_move_by_a_share_of_its_size() -> None:
    """At a medium speed nothing is left of it, and that says nothing of its size: 30 % of 0.05 N m it is."""
    model = with_values(load_model("c2_parallel"), DRIVE, "c2_parallel")
    (coefficient, speed) = effects("C2")["stribeck[d=2]"].parameters
    values = {coefficient.name: 0.05, speed.name: 2.0}

    prior = prior_of(effects("C2")["stribeck[d=2]"].extend(model, values))

    deviations = dict(zip((c.name for c in prior.columns), prior.deviations, strict=True))
    assert deviations[coefficient.name] == pytest.approx(0.3 * 0.05, rel=1e-6)


@pytest.mark.parametrize("mu", [0.2, 0.01])
def test_a_column_is_as_large_as_its_mean_over_a_turn_of_the_link(mu: float) -> None:
    """F_N, the length of M L w^2 + (M + M_l) g, has a complete elliptic integral as its mean."""
    known = {"M": 0.6, "M_l": 0.3, "L": 0.4, "g": 9.81, "mu": mu}
    model = with_values(load_model("c2_parallel"), DRIVE | known, "c2_parallel")
    _, sizes, _ = _seen(model, 40.0, 0.01)
    weight = (0.6 + 0.3) * 9.81
    pulls = [0.6 * 0.4 * (mu * speed) ** 2 for speed in (20.0, 40.0)]
    means = [
        2.0 / math.pi * (pull + weight) * ellipe(4.0 * pull * weight / (pull + weight) ** 2) for pull in pulls
    ]

    assert mu * sum(means) / 2.0 == pytest.approx(sizes[1], rel=1e-5)
