"""Close the loop: effects are found and added, a control is left alone, the unknown stays unnamed."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from eccentric.cli import main
from eccentric.diagnosis import diagnose
from eccentric.presentation import diagnosis_document
from eccentric.virtual_bench import Law, PlantedEffect, simply, simulate, write
from tests.virtual import drawn_scenario, log_of

ROOT = Path(__file__).resolve().parent.parent
SHARED = ROOT.parent / "shared" / "data" / "examples"


@pytest.mark.parametrize(
    ("seed", "effect", "options"),
    [
        pytest.param(9001, "stribeck", {}, marks=pytest.mark.slow),
        (9002, "current_bias", {"case": "C1"}),
        pytest.param(
            9003,
            "viscosity_temperature",
            {"temperature": True, "seconds": 60.0},
            marks=pytest.mark.slow,
        ),
    ],
    ids=["friction", "electrical", "temperature"],
)
def test_finds_effects_of_several_kinds(
    tmp_path: Path, seed: int, effect: str, options: dict[str, Any]
) -> None:
    """A torque, a bias in the electrical balance and a replaced coefficient are each named."""
    log, rig = log_of(tmp_path, seed, (effect, 0.15), **options)
    found = diagnose([log], rig)

    assert ("named", [effect]) == (found.attribution.verdict, [e.family for e, _ in found.effects])


@pytest.mark.slow
def test_a_busy_drive_does_not_pass_for_noise(tmp_path: Path) -> None:
    """What a drive does from sample to sample is no noise: a fit below it may be the right one."""
    options = {"case": "C1", "mu": 1.0, "log_type": "traj", "noise": 0.003}
    log, rig = log_of(tmp_path, 2, ("current_bias", 0.05), **options)
    found = diagnose([log], rig)

    assert ("named", ["current_bias"]) == (found.attribution.verdict, [e.family for e, _ in found.effects])


def test_leaves_a_control_alone(tmp_path: Path) -> None:
    """Without an undeclared effect nothing is missing, and the emitted model is the paper's."""
    log, rig = log_of(tmp_path, 9004)
    found = diagnose([log], rig)

    assert "nothing_missing" == found.attribution.verdict
    assert () == found.effects
    assert found.score.rmse["mechanical"]["paper"] == found.score.rmse["mechanical"]["extended"]


def own_friction(
    tmp_path: Path, seed: int, law: Law, size: float, strength: float, **options: Any
) -> tuple[list[Path], Path]:
    """Write a log with a dry friction outside the library, `size` times a Stribeck friction at first."""
    scenario = drawn_scenario(seed, effects=[("stribeck", 0.12)], seconds=60.0, **options)
    effect = PlantedEffect(
        "own",
        "own",
        size * scenario.effects[0].amplitude,
        simply(dry=law),
        ("velocity",),
        strength=strength,
    )
    log, rig, _ = write(simulate(replace(scenario, effects=(effect,))), tmp_path / "own.csv.gz")
    return [log], rig


@pytest.mark.slow
def test_leaves_the_unknown_unnamed(tmp_path: Path) -> None:
    """A friction that no library holds (a band of speed that resonates) gets no name, but its variable."""
    top = 6.2 / 0.2

    def band(state: Any, amplitude: float) -> float:
        return amplitude * (1.0 if 0.35 * top < abs(state.w_mid) < 0.6 * top else 0.0)

    found = diagnose(*own_friction(tmp_path, 9005, band, 2.0, 0.12, log_type="traj", noise=0.006))

    assert ("unexplained", ()) == (found.attribution.verdict, found.effects)
    assert "velocity" == found.attribution.depends_on[0]


def test_takes_an_effect_of_the_users_own(tmp_path: Path) -> None:
    """An effect in a user's file competes with the library, is named, and travels with the result."""
    own = tmp_path / "my_effects.py"
    own.write_text(
        '''"""A fourth-power drag."""
import sympy as sp
from eccentric.effects import Effect, Evidence
from eccentric.model import Change, Role, Term, quantity, vocabulary as v

w = v.omega_m.symbol
D = quantity("my_drag_D", "N m s^4/rad^4", "fourth-power drag", "", "nonnegative")


def effects(setting):
    term = Term("my_drag", "friction", D.symbol, w**3 * sp.Abs(w), "own", role=Role.DRAG)
    return (Effect(family="my_drag", balance="mechanical", formula="D w^3 |w|", reference="own",
                   change=Change({"mechanical": (term,)}), evidence=Evidence(depends_on=("velocity",)),
                   coefficients=(D,)),)
''',
        encoding="utf-8",
    )
    top = 7.5 / 0.2

    def fourth(state: Any, amplitude: float) -> float:
        return amplitude * (abs(state.w_mid) / top) ** 4

    ([log], rig), out = own_friction(tmp_path, 9006, fourth, 4.0, 0.3, noise=0.004), tmp_path / "out"
    assert 0 == main(["diagnose", str(log), "--rig", str(rig), "--effects", str(own), "--out", str(out)])
    said = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))

    assert "my_drag" in [c["id"] for c in said["candidates"][:2]]
    assert (out / "my_effects.py").read_text(encoding="utf-8") == own.read_text(encoding="utf-8")
    assert (out / "model.py").is_file()


@pytest.mark.parametrize("number", [1, *(pytest.param(k, marks=pytest.mark.slow) for k in (2, 3, 4))])
def test_shared_examples_come_out_as_their_truth(number: int) -> None:
    """The development logs are diagnosed as their sealed truth says."""
    log = SHARED / f"example{number}.csv.gz"
    if not log.is_file():
        pytest.skip("the shared example logs are not beside this clone")
    truth = json.loads((SHARED / "truth.json").read_text(encoding="utf-8"))[f"example{number}"]["effects"]
    found = diagnose([log], SHARED / f"example{number}.json")

    assert {e["family"] for e in truth} == {e.family for e, _ in found.effects}
    assert ("named" if truth else "nothing_missing") == found.attribution.verdict


@pytest.mark.slow
def test_what_is_clear_is_told_beside_what_is_not() -> None:
    """Load and losses of the gear are one law on this drive: a tie, and Stribeck friction beside it is sure.

    With a declared value in the place of the load, the name stays, and the value is no name.
    """
    effects = [("load_dependent", 0.12), ("stribeck", 0.12)]
    run = simulate(
        drawn_scenario(3, case="C1", mu=1.0, log_type="traj", seconds=40.0, noise=0.012, effects=effects)
    )
    found = diagnose([run.columns], run.rig)
    said = diagnosis_document(found)

    assert ("not_identifiable", []) == (said["verdict"], said["effects"])
    assert {"load_dependent", "gear_efficiency"} == set(said["tied"])
    assert ["stribeck"] == [e["family"] for e in said["clear"]]
    assert said["sentence"].startswith("Missing: Stribeck friction")
    assert all(family in said["sentence"] for family in said["tied"])

    adopted = [replace(a, undecided=bool(a.alike)) for a in found.attribution.adopted]
    named = replace(found.attribution, verdict="named", tied=(), adopted=tuple(adopted))
    said = diagnosis_document(replace(found, attribution=named))

    assert ["stribeck"] == [e["family"] for e in said["effects"]]
    assert [["load_dependent", "gear_efficiency"]] == [e["alike"] for e in said["undecided"]]
    assert [] == said["clear"]
