"""Close the loop: effects are found and added, a control is left alone, the unknown stays unnamed."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eccentric.cli import main
from eccentric.diagnosis import diagnose
from eccentric.logs import read_log
from eccentric.presentation import diagnosis_document, diagnosis_sentence
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from eccentric.virtual_bench import Law, PlantedEffect, simply, simulate, write
from tests.logged import SHARED
from tests.virtual import drawn_scenario, log_of

ROOT = Path(__file__).resolve().parent.parent
EXAMPLES = SHARED / "examples"


BUSY = {"case": "C1", "mu": 1.0, "log_type": "traj", "noise": 0.003}
"""What such a drive does from sample to sample is no noise: a fit below it may be the right one."""
KINDS = {
    "friction": (9001, ("stribeck", 0.15), {}),
    "electrical": (9002, ("current_bias", 0.15), {"case": "C1", "seconds": 20.0}),
    "temperature": (9003, ("viscosity_temperature", 0.15), {"temperature": True, "seconds": 60.0}),
    "busy drive": (2, ("current_bias", 0.05), BUSY),
}


@pytest.mark.parametrize(
    "kind", [pytest.param(k, marks=() if k == "electrical" else pytest.mark.slow) for k in KINDS]
)
def test_finds_effects_of_several_kinds(kind: str, tmp_path: Path) -> None:
    """A torque, a bias in the electrical balance and a replaced coefficient are each named."""
    seed, effect, options = KINDS[kind]
    log, rig = log_of(tmp_path, seed, effect, **options)
    found = diagnose([log], rig)

    assert ("named", [effect[0]]) == (found.attribution.verdict, [e.family for e, _ in found.effects])


PARTS = {
    "gear": (9103, ("backlash", 0.2), {"gear": "strain wave"}, {"seconds": 30.0}),
    "motor": (9104, ("cogging", 0.2), {"motor": "coreless"}, {"seconds": 20.0}),
    "bearing": (9106, ("bearing_load", 0.2), {"bearing": "air"}, {"seconds": 30.0}),
    "lubricant": (
        9105, ("viscosity_temperature", 0.2), {"lubricant": "none"}, {"seconds": 40.0, "temperature": True},
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("kind", PARTS)
def test_a_cause_that_the_drive_cannot_have_is_excluded_with_the_reason(kind: str, tmp_path: Path) -> None:
    """It is planted, and named where nothing is declared; else no other name takes its place."""
    seed, effect, parts, options = PARTS[kind]
    log, rig = log_of(tmp_path, seed, effect, **options)
    content = json.loads(rig.read_text(encoding="utf-8"))
    free, found = (diagnosis_document(diagnose([log], content | given)) for given in ({}, parts))

    assert ("named", [effect[0]]) == (free["verdict"], [e["family"] for e in free["effects"]])
    assert ("unexplained", []) == (found["verdict"], found["effects"])
    assert effect[0] not in {c["family"] for c in found["candidates"]}
    assert {"family": effect[0], "explains": "more"}.items() <= found["ruled_out"][0].items()
    assert [kind] == list(found["ruled_out"][0]["needs"])


COGGING, ORDER, GEAR, INERTIA = "cogging[n=6]", 6, 0.2, 1e-3


def swung(reach: float, beyond: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> dict[str, np.ndarray]:
    """A drive that swings by +-reach [rad], with a torque of its angle and direction beyond dry friction."""
    t = np.arange(0.0, 20.0, 0.004)
    parts = [(0.7, 1.9, 0.3), (0.3, 4.3, 1.0)]
    theta, omega, alpha = (
        reach * np.sum([a * w**n * np.sin(w * t + p + 0.5 * n * np.pi) for a, w, p in parts], axis=0)
        for n in range(3)
    )
    noise = np.random.default_rng(7).normal(0.0, 5e-4, len(t))
    torque = INERTIA * alpha + 0.02 * np.sign(omega) + beyond(theta, np.sign(omega)) + 1e-4 * omega + noise
    return {"time_s": t, "theta_m_rad": theta, "omega_m_rad_s": omega, "torque_Nm": torque}


def found_in(log: dict[str, np.ndarray], mu: float) -> dict[str, Any]:
    """The diagnosis of a drive without a mass."""
    known = {"case": "C1", "mu": mu, "M_kg": 0.0, "L_m": 0.0, "J_m_kgm2": INERTIA, "J_l_kgm2": 0.0}
    return diagnosis_document(diagnose([read_log(log)], {"drive": "torque", "known": known}))


@pytest.mark.parametrize("periods", [0.6, 4.0])
def test_what_repeats_with_an_angle_is_named_once_it_has(periods: float) -> None:
    """Over less than a period any smooth curve is a part of a wave: it is left out, with what was seen."""
    reach = 0.5 * periods * 2.0 * np.pi / ORDER
    log = swung(reach, lambda theta, _: 0.01 * np.cos(ORDER * theta) + 0.004 * np.sin(ORDER * theta))
    found = found_in(log, GEAR)

    if periods > 1.0:
        assert [COGGING] == [effect["id"] for effect in found["effects"]]
        return
    assert ("unexplained", []) == (found["verdict"], found["effects"])
    left_out = {entry["id"]: entry for entry in found["ruled_out"]}
    assert {"needs": {}, "periods_seen": pytest.approx(periods, rel=0.05)}.items() <= left_out[
        COGGING
    ].items()
    assert "angle" in found["sentence"]
    assert "motor" in found["undeclared_parts"]


@pytest.mark.parametrize("reach", [2.9, 0.9, 0.1])
def test_a_tight_spot_is_named_where_the_joint_passes_it_whole(reach: float) -> None:
    """No joint that ends before a full turn would get one otherwise; over a part of a bump any curve fits."""
    log = swung(reach, lambda theta, way: 0.015 * way * np.exp(-0.5 * ((theta - 0.1 * reach) / 0.12) ** 2))
    found = found_in(log, 1.0)

    assert (["local_defect"] if reach > 0.5 else []) == [effect["family"] for effect in found["effects"]]


def test_leaves_a_control_alone(tmp_path: Path) -> None:
    """Without an undeclared effect nothing is missing, and the emitted model is the paper's."""
    log, rig = log_of(tmp_path, 9004, seconds=20.0)
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
        "own", "own", size * scenario.effects[0].amplitude, simply(dry=law), ("velocity",), strength=strength
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
    arguments = [str(log), "--rig", str(rig), "--effects", str(own), "--out", str(out)]
    rivals = ["my_drag", "quadratic_drag", "cubic_drag", "stribeck", "eddy_current", "cogging"]
    assert 0 == main(["diagnose", *arguments, *(f"--only={name}" for name in rivals)])
    said = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))

    assert "my_drag" in [c["id"] for c in said["candidates"][:2]]
    assert (out / "my_effects.py").read_text(encoding="utf-8") == own.read_text(encoding="utf-8")
    assert (out / "model.py").is_file()


@pytest.mark.parametrize("number", [1, *(pytest.param(k, marks=pytest.mark.slow) for k in (2, 3, 4))])
def test_shared_examples_come_out_as_their_truth(number: int) -> None:
    """The development logs are diagnosed as their sealed truth says."""
    log = EXAMPLES / f"example{number}.csv.gz"
    if not log.is_file():
        pytest.skip("the shared example logs are not beside this clone")
    truth = json.loads((EXAMPLES / "truth.json").read_text(encoding="utf-8"))[f"example{number}"]["effects"]
    found = diagnose([log], EXAMPLES / f"example{number}.json")

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


# Effects that use the friction of a first fit are judged with the friction that was found beside them.


@pytest.mark.slow
def test_a_load_is_that_of_the_friction_beside_the_effect() -> None:
    """Losses of a gear are named and sized as planted, with the friction that was found beside them."""
    scenario = drawn_scenario(
        97312,
        mu=1 / 30,
        log_type="traj",
        effects=[("load_dependent[transmitted]", 0.12)],
        noise=0.004,
        seconds=40.0,
    )
    run = simulate(scenario)
    said: list[str] = []
    found = diagnose([run.columns], run.rig, tell=said.append)
    (planted,) = run.truth["effects"]

    assert ["load_dependent[transmitted]"] == [a.variant.candidate.id for a in found.attribution.adopted]
    assert "named" == found.attribution.verdict
    assert planted["amplitude"] == pytest.approx(found.models.extended.values["load_eta"], rel=0.02)
    assert "the same with the friction that was found" in said


# Current offsets with an open zero angle: the friction under F_N moves with the zero.


@pytest.mark.slow
def test_an_open_zero_angle_invents_no_effect_beside_a_current_offset() -> None:
    """The first fit takes the offset for a turn of the gravity torque; what was found says better.

    At the zero of the first fit, friction at the wrong angle is called unexplained.
    """
    effects = [("current_bias", 0.3)]
    scenario = drawn_scenario(5, case="C2", mu=0.2, log_type="runs", effects=effects, noise=0.004)
    run = simulate(scenario)
    moved = run.columns["theta_m_rad"] + 0.2 / scenario.plant.mu
    rig = {**run.rig, "theta_zero_rad": "estimate"}

    found = diagnose([read_log({**run.columns, "theta_m_rad": moved})], rig)

    assert ["current_bias"] == [effect.id for effect, _ in found.effects]
    assert 0.2 == pytest.approx(found.models.extended.estimates["theta_zero_rad"].value, abs=0.002)


# A wrong k_i scales gravity and inertia by the same factor; a wrong mass, or inertia, does not.


def declared(rig: Path, *left_out: str, **factors: float) -> Path:
    """Return the rig with these quantities taken out, or declared by another factor."""
    content = json.loads(rig.read_text(encoding="utf-8"))
    for key in left_out:
        del content["known"][key]
    for key, factor in factors.items():
        content["known"][key] *= factor
    rig.write_text(json.dumps(content), encoding="utf-8")
    return rig


OFF = {
    "k_i": ((), {"k_i_Nm_per_A": 0.85}, "ki_mismatch", "M g L"),
    "mass, the inertia right": ((), {"M_kg": 1.11}, "mass_mismatch", "k_i"),
    "inertia, gravity right": ((), {"J_l_kgm2": 1.15, "J_m_kgm2": 1.15}, "inertia_mismatch", "k_i"),
}


@pytest.mark.slow
@pytest.mark.parametrize("off", OFF)
def test_a_wrong_constant_is_not_taken_for_another(off: str, tmp_path: Path) -> None:
    """The one thing missing is what is off; of k_i, at the value that made the log."""
    log, rig = log_of(tmp_path, 9004, log_type="traj")
    left_out, factors, family, unmentioned = OFF[off]
    true = json.loads(rig.read_text(encoding="utf-8"))["known"]["k_i_Nm_per_A"]
    found = diagnose([log], declared(rig, *left_out, **factors))

    assert ("named", [family]) == (found.attribution.verdict, [e.family for e, _ in found.effects])
    assert unmentioned not in diagnosis_sentence(found)
    if off == "k_i":
        (_, own), *_ = found.effects
        assert pytest.approx(true, rel=0.01) == 0.85 * true / (1.0 + own["current_scale"])


@pytest.mark.slow
@pytest.mark.parametrize("wrong", ["k_i_Nm_per_A", "M_kg"])
def test_where_the_inertia_is_open_mass_and_k_i_are_told_together(wrong: str, tmp_path: Path) -> None:
    """Gravity alone is too little or too much then: the mass is named, k_i said to look the same."""
    log, rig = log_of(tmp_path, 9004, log_type="traj")
    found = diagnose([log], declared(rig, "J_m_kgm2", "J_l_kgm2", **{wrong: 1.11}))

    assert ["mass_mismatch"] == [e.family for e, _ in found.effects]
    assert "looks the same as ki_mismatch" in diagnosis_sentence(found)


@pytest.mark.parametrize(
    ("wrong", "channel", "text"),
    [({"mu": 25.0}, "mu", "0.2 fits"), ({"k_i_Nm_per_A": 1000.0}, "k_i", "")],
    ids=["motor over link in place of link over motor", "another unit"],
)
def test_a_constant_that_contradicts_gravity_is_told(
    wrong: dict[str, float], channel: str, text: str, tmp_path: Path
) -> None:
    """The inverse of mu fits; all torques a thousand times too large are k_i, before any unit of torque."""
    log, rig = log_of(tmp_path, 9004, log_type="traj")
    channels = read_channels([log], read_rig(declared(rig, **wrong)))

    (finding,) = [f for f in channels.intake.findings if f.severity == "warning"]
    assert ("contradiction", channel) == (finding.kind, finding.channel)
    assert text in finding.text


# Twelve logs with nothing missing, from drives with the ordinary faults of drives: not one alarm.


CONTROLS = SHARED / "controls"


@pytest.mark.skipif(not CONTROLS.is_dir(), reason="the shared control logs are not beside this clone")
@pytest.mark.slow  # `test_diagnose` has a control of the virtual bench
@pytest.mark.parametrize("number", range(1, 13))
def test_nothing_is_missing(number: int) -> None:
    """No name, no tie, no `unexplained`: the noise of bus, loop and encoder is no effect."""
    log = CONTROLS / f"control{number:02}.csv.gz"

    found = diagnose([log], CONTROLS / f"control{number:02}.json")

    assert found.attribution.verdict == "nothing_missing"
