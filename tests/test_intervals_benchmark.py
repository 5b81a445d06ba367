"""The benchmark of intervals compares like with like: what is planted is what is fitted."""

import numpy as np
import pytest

from benchmarks import intervals
from benchmarks.diagnosis_jobs import Job, Result
from benchmarks.diagnosis_table import details, figures
from benchmarks.intervals import counted, effect_of, run
from benchmarks.oracle import Oracle
from eccentric.identification import FitData, refit
from eccentric.identification.fit_data import Emitted
from eccentric.model import load_model
from eccentric.virtual_bench import simulate
from tests.extended import KNOWN, effects
from tests.identified import prepared
from tests.virtual import drawn_scenario

FRICTION = {"C_m": 0.1, "B_m": 0.01, "C_lN": 0.02, "B_lN": 0.003}


@pytest.mark.parametrize(
    ("truth", "at", "expected"),
    [
        # A exp(-(w/v)^d), A w/(1 + (w/w_c)^2), A cos(n theta + phi)
        ({"family": "stribeck", "amplitude": 0.3, "shape": [4.0, 2.0]}, (0.0, 6.0), 0.3 * np.exp(-2.25)),
        ({"family": "eddy_current", "amplitude": 0.3, "shape": [4.0]}, (0.0, 6.0), 1.8 / 3.25),
        ({"family": "cogging", "amplitude": 0.3, "shape": [6.0, 0.4]}, (0.5, 6.0), 0.3 * np.cos(3.4)),
    ],
)
def test_the_planted_effect_is_that_of_the_library(
    truth: dict[str, object], at: tuple[float, float], expected: float
) -> None:
    """At one angle and speed, by the law of the bench."""
    name, values = effect_of(truth)
    effect = effects("C2")[name]
    emitted = Emitted(effect.extend(load_model("c2_parallel"), values))
    inputs = {
        name: np.array([x])
        for name, x in zip(("theta_m", "omega_m", "alpha_m", "i"), (*at, 0.0, 0.0), strict=True)
    }
    none = values | {c.name: 0.0 for c in effect.coefficients}
    without, there = (
        emitted("mechanical_residual", inputs, emitted.parameters({**KNOWN, **FRICTION, **own}))
        for own in (none, values)
    )

    assert float((without - there)[0]) == pytest.approx(expected, rel=1e-9)


def test_a_filter_that_changes_nothing_widens_no_interval(monkeypatch: pytest.MonkeyPatch) -> None:
    """Inertia and back-EMF move to their own parameters after a step; that is not the filter's doing."""
    run = simulate(drawn_scenario(7, case="C1", log_type="traj", seconds=40.0))
    known = {key: x for key, x in run.rig["known"].items() if key != "J_l_kgm2"}
    rig = run.rig | {"known": known, "unknown": {"J_l": ["0 kg m^2", "1000 kg m^2"]}}
    data, model = prepared(run.columns, rig)

    errors = []
    for narrowed in (data, None):
        monkeypatch.setattr(FitData, "narrowed", narrowed)
        errors.append(
            {name: e.std_error for name, e in refit(model, (), data, linear=True).estimates.items()}
        )
    assert "J_l" in errors[0]
    assert errors[0] == pytest.approx(errors[1], rel=1e-6)


def test_a_log_is_judged_by_all_three_kinds() -> None:
    """Inertia, four friction coefficients and the effect's own parameters."""
    result = run(97101)

    assert result.failed == ""
    assert {"inertia": 1, "friction": 4, "effect": 2} == {kind: len(own) for kind, own in result.held.items()}


@pytest.mark.slow
def test_a_log_that_could_not_be_fitted_holds_no_truth(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its quantities count: a fit that fails where it is difficult would flatter the rest."""

    def fails(*_: object, **__: object) -> None:
        raise ValueError("no fit")

    monkeypatch.setattr(intervals, "refit", fails)
    result = run(97101)

    assert "ValueError: no fit" == result.failed
    assert {"inertia": (0, 1), "friction": (0, 4), "effect": (0, 2)} == {
        kind: counted([result], kind) for kind in intervals.KINDS
    }


# The benchmark of the diagnosis counts hits, false alarms, honest and dishonest answers.


def result(
    kind: str, truth: list[str], verdict: str, named: list[str] | None = None, **others: object
) -> Result:
    """Return what came of a log; the ranking is what was named."""
    job = Job(kind, 0, tuple((family, 0.1) for family in truth))
    named = named or []
    return Result(job, verdict, truth, [0.1] * len(truth), named, named, probability=0.95, **others)  # pyright: ignore[reportArgumentType]


RESULTS = [
    result("single", ["stribeck"], "named", ["stribeck"]),
    result("single", ["stribeck"], "named", ["cogging"]),
    result("single", ["stribeck"], "unexplained", depends=["velocity"]),
    result("single", ["backlash"], "nothing_missing"),
    result("control", [], "nothing_missing"),
    result("control", [], "unexplained"),
    result("pair", ["stribeck", "cogging"], "named", ["cogging", "stribeck"]),
    result("outside", ["velocity"], "unexplained", depends=["time", "velocity"]),
    result("outside", ["velocity"], "unexplained", depends=["time", "link_angle", "velocity"]),
    result("outside", ["velocity"], "named", ["stribeck"]),
]
LONG = [result("long", ["stribeck"], "named", ["stribeck"], seconds=3.0, memory=0.5)]


def test_fractions_are_those_of_the_logs() -> None:
    """One of four singles is right, one wrong; one control of two a false alarm; one of three honest."""
    found = {key: one.value for key, one in figures(RESULTS, LONG).items()}

    assert {"first": 0.25, "wrong": 0.25, "false alarms": 0.5, "both": 1.0, "outside": 1 / 3} == {
        key: found[key] for key in ("first", "wrong", "false alarms", "both", "outside")
    }
    assert (2 / 3, 3.0, 0.5) == (found["sure"], found["seconds"], found["memory"])


def test_faint_effects_count_where_the_truth_proves_them() -> None:
    """Of two that a fit with the truth proves, one is named; a third, below z = 3, does not count."""
    faint = [
        result(
            "faint",
            ["stribeck"],
            "named",
            ["stribeck"],
            oracle=Oracle("mechanical", 1.0, 9.0, 0.0, 9.0),
            rmse={"mechanical": 1.0},
        ),
        result("faint", ["stribeck"], "nothing_missing", oracle=Oracle("mechanical", 1.0, 3.1, 0.0, 3.1)),
        result("faint", ["stribeck"], "nothing_missing", oracle=Oracle("mechanical", 1.0, 2.9, 0.0, 2.9)),
    ]

    assert 0.5 == figures([*RESULTS, *faint], LONG)["faint"].value


def test_misses_that_data_could_have_decided_are_counted() -> None:
    """Of two wrong singles, a fit that knows the truth predicts better than one of the answers."""

    def single(named: str, z: float) -> Result:
        known = Oracle("mechanical", 1.0, 9.0, z, 9.0)
        return result("single", ["stribeck"], "named", [named], oracle=known, rmse={"mechanical": 1.0})

    lines = details([single("cogging", 3.1), single("cogging", 2.9), single("stribeck", 5.0)])
    (line,) = (line for line in lines if line.startswith("| not first"))

    assert "1/2" in line
