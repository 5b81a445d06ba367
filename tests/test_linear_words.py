"""What is written of a linear axis is in its own units and words; what a person has named is left alone."""

from __future__ import annotations

import copy
import json
import re
import subprocess
from html import unescape
from pathlib import Path

import numpy as np
import pytest

import eccentric
from eccentric.api import DiagnosisResult
from eccentric.cli import main
from eccentric.effects import Effect, Setting, library
from eccentric.emission import render
from eccentric.model import LINEAR, TURNING, load_model, spoken
from tests.carriage import RIG, SLIDE, Carriage, logged
from tests.compiled import FLAGS, REAL, run

FOREIGN = re.compile(
    r"\brad\b|\bN ?m\b|\bkg m|_rad|_Nm\b|[Tt]orque|\bF_N\b|theta_m|omega|alpha_m|\bJ_m\b|\bk_i\b|B_m\b"
    r"|\b[Ii]nertia|\bB_lN\b"
    r"|normal force|unbalanced|(?<!not )\blink\b|[ωα]|\\u03c9|motor (?:side|angle|velocity)|paper's"
)
"""Units, letters and words of a drive that swings an unbalanced mass."""


def foreign(text: str) -> list[str]:
    """What a text has of them, with its surroundings."""
    return [text[max(m.start() - 40, 0) : m.end() + 20] for m in FOREIGN.finditer(text)]


def effects_of_the_screw() -> dict[str, Effect]:
    """The effects that may be offered for the slide, with every channel logged."""
    base, shown = load_model("screw_axis"), frozenset({"current", "voltage", "temperature"})
    # A pitch of which 2 pi over it is an integer, too: no order of a motor is at 628 per radian.
    rig = Setting(base, 628.0, {}, 1e-3, 0.3, 10.0, 20.0, 5.0, temperature_mid=30.0, channels=shown)
    return {
        effect.id: effect
        for effect in library(rig)
        if not LINEAR.absent & set(effect.evidence.depends_on) and effect.family not in LINEAR.foreign
    }


FEW = ("cogging", "stribeck", "quadratic_drag")


@pytest.fixture(scope="module", params=[FEW, pytest.param((), marks=pytest.mark.slow)], ids=["few", "all"])
def diagnosed(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[DiagnosisResult, Path]:
    """The diagnosis of the example by a few families of effects, or all, and the folder that it writes."""
    out = tmp_path_factory.mktemp("slide") / "out"
    found = eccentric.diagnose(SLIDE / "slide.csv.gz", SLIDE / "slide.toml", only=request.param)
    found.write(out)
    return found, out


def test_the_effects_of_the_example_are_found(diagnosed: tuple[DiagnosisResult, Path]) -> None:
    """A force once per turn of the screw, 4 N, and Stribeck friction of 12 N at 20 mm/s: both are named."""
    found, _ = diagnosed
    estimates = found.estimates

    assert (found.verdict, set(found.effects)) == ("named", {"cogging[n=1]", "stribeck[d=2]"})
    assert np.hypot(estimates["cogging_c1"].value, estimates["cogging_s1"].value) == pytest.approx(4, rel=0.1)
    assert estimates["stribeck_A"].value == pytest.approx(12.0, rel=0.1)
    assert estimates["stribeck_v"].value == pytest.approx(0.02, rel=0.1)
    assert (estimates["stribeck_v"].unit, estimates["mass"].unit, found.unit) == ("m/s", "kg", "N")


def test_the_summary_has_no_foreign_word(diagnosed: tuple[DiagnosisResult, Path]) -> None:
    """What a terminal and a notebook show is in newtons, metres and words of a carriage."""
    found, _ = diagnosed

    assert foreign(found.summary()) == []
    assert foreign(unescape(found._repr_html_())) == []
    assert foreign("\n".join(found.warnings)) == []


def test_the_document_has_no_foreign_word(diagnosed: tuple[DiagnosisResult, Path]) -> None:
    """Neither keys nor values of diagnosis.json have one, and it says what kind of axis it is of."""
    _, out = diagnosed
    text = (out / "diagnosis.json").read_text(encoding="utf-8")

    assert foreign(text) == []
    assert json.loads(text)["kind"] == "linear"


def test_the_report_has_no_foreign_word(diagnosed: tuple[DiagnosisResult, Path]) -> None:
    """The text of the page has none, and neither have its figures' labels."""
    _, out = diagnosed
    html = (out / "report.html").read_text(encoding="utf-8")
    script = r"<script[^>]*>.*?</script>|<style>.*?</style>"
    labels = " ".join(re.findall(r'"(?:axis_label|text|name|label|value)":"([^"]*)"', html))

    assert foreign(unescape(re.sub(r"<[^>]+>", " ", re.sub(script, "", html, flags=re.DOTALL)))) == []
    assert foreign(labels) == []
    assert ("screw position" in html, "paper's model" in html, "sgn \\u03c9" in html) == (False,) * 3
    assert "Ẋ" not in html


def test_the_emitted_files_have_no_foreign_word(diagnosed: tuple[DiagnosisResult, Path]) -> None:
    """Header, source and module name positions, forces and masses only."""
    _, out = diagnosed

    for name in ("screw_axis_extended.h", "screw_axis_extended.c", "screw_axis_extended.py"):
        assert foreign((out / name).read_text(encoding="utf-8")) == [], name


@pytest.mark.parametrize("dtype", [np.float64, np.float32], ids=["double", "float"])
def test_the_c_of_an_extended_axis_does_what_its_module_does(
    diagnosed: tuple[DiagnosisResult, Path], tmp_path: Path, dtype: type[np.floating]
) -> None:
    """It compiles without a warning, and its self-test finds the results of the NumPy module."""
    _, out = diagnosed
    program = tmp_path / "selftest"
    options = [*FLAGS, f"-DECCENTRIC_REAL={REAL[dtype]}", f"-I{out}"]
    run("gcc", *options, out / "check" / "screw_axis_extended_selftest.c", "-o", program, "-lm")

    assert subprocess.run([program], capture_output=True, check=False).returncode == 0


def test_the_module_is_the_closed_form(diagnosed: tuple[DiagnosisResult, Path]) -> None:
    """Friction, cogging and load of the emitted module are those of the formulas, written out here."""
    found, _ = diagnosed
    module, p = found.module, found.module.Parameters()
    x, v, a = np.linspace(0.0, 0.03, 7), np.array([-0.3, -0.02, -1e-3, 1e-3, 0.02, 0.1, 0.4]), 2.0
    stribeck = p.stribeck_A * np.exp(-((np.abs(v) / p.stribeck_v) ** 2))
    friction = p.B * v + (p.C + stribeck) * np.sign(v)
    turn = p.kappa * x
    cogging = p.cogging_c1 * np.cos(turn) + p.cogging_s1 * np.sin(turn)
    current = (p.mass * a + p.F_load + cogging + friction) / p.k_f

    np.testing.assert_allclose(module.mechanical_friction_force(v, p), friction, rtol=1e-12)
    np.testing.assert_allclose(module.load_force(x, p), p.F_load + cogging, rtol=1e-9)
    np.testing.assert_allclose(module.current(x, v, a, p), current, rtol=1e-9)
    assert p.kappa == pytest.approx(2.0 * np.pi / 0.01, rel=1e-9)


def test_a_fit_is_emitted_under_its_names(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """fit.json and what is emitted from it have no foreign word; the values of the fit are the defaults."""
    out, log, rig = tmp_path / "fit", str(SLIDE / "slide.csv.gz"), str(SLIDE / "slide.toml")
    assert main(["fit", log, "--rig", rig, "--out", str(out)]) == 0
    emit = ["emit", "screw_axis", "--parameters", str(out / "fit.json"), "--prefix", "my_slide"]
    assert main([*emit, "--out", str(tmp_path / "c")]) == 0
    text = (out / "fit.json").read_text(encoding="utf-8")
    header = (tmp_path / "c" / "my_slide.h").read_text(encoding="utf-8")
    mass = json.loads(text)["parameters"]["mass"]

    assert foreign(capsys.readouterr().out + text + header) == []
    assert f"fitted: {mass:.4g} kg" in header


@pytest.mark.parametrize("name", ["linear_axis", "screw_axis"])
def test_the_files_of_a_plain_axis_have_no_foreign_word(name: str) -> None:
    """Header, sources and modules of NumPy and JAX, and what they say of each value that is not given."""
    texts = {
        **{f"jax/{file}": text for file, text in render(load_model(name), backends=("jax",)).items()},
        **render(load_model(name)),
    }
    module = texts[f"{name}.py"]
    own = {file: text for file, text in texts.items() if "runtime" not in file}

    assert {file: foreign(text) for file, text in own.items() if foreign(text)} == {}
    for said in (
        "armature resistance [Ohm], needed for friction_force",
        "force constant [N/A], needed for friction_force",
        "moving mass [kg], needed with acceleration",
    ):
        assert said in module
    assert "screw [1/m], needed" not in module


def test_the_derivation_prints_its_own_letters() -> None:
    """What `python derivations/linear_axis.py` prints is in letters of a carriage, and checks itself."""
    for name in ("linear_axis", "screw_axis"):
        assert foreign(str(load_model(name))) == []
        assert foreign(load_model(name).latex()) == []
    for equation in load_model("linear_axis").equations:
        assert all(identity.zero == 0 for identity in equation.identities)


def test_a_spoken_model_has_the_same_equations() -> None:
    """Only names differ: put back, they give the model's own terms."""
    model = load_model("linear_axis")
    heard = spoken(model)
    back = {
        now.symbol: was.symbol
        for was, now in zip(
            (*model.inputs, *model.parameters), (*heard.inputs, *heard.parameters), strict=True
        )
    }

    for was, now in zip(model.balances, heard.balances, strict=True):
        assert [term.value.xreplace(back) for term in now.terms] == [term.value for term in was.terms]


NONSENSE = re.compile(
    r"twist|horizontal|[Tt]urn the (?:carriage|motor|link)|with the carriage removed"
    r"|(?:bending|travelled) position"
    r"|position (?:over which|travelled)"
    r"|(?:cos|sin)\([^)]*position|of the axis (?:position|velocity)|axis's flux"
)
"""What translating word by word makes of instructions for a drive that turns."""


@pytest.mark.parametrize("effect", effects_of_the_screw().values(), ids=lambda effect: effect.id)
def test_what_is_said_of_an_effect_can_be_done_with_a_carriage(effect: Effect) -> None:
    """Formula, headline, meaning, hint and the measurements that tell it apart; no letter for two things."""
    words = effect.words
    own = (*effect.parameters, *(state.quantity for state in effect.change.states))
    kin = words.kin.tell_apart.values() if words.kin else ()
    said = [
        effect.formula, words.headline, words.title, words.meaning, words.hint,
        *words.tell_apart.values(), *kin, *(q.meaning for q in own),
    ]  # fmt: skip

    assert [text for text in map(LINEAR.text, said) if NONSENSE.search(text) or foreign(text)] == []
    assert [q.letter for q in own if f"{q.letter}_m" in effect.formula] == []


def test_a_harmonic_of_the_screw_has_no_alias_of_a_motor() -> None:
    """No effect may be another as well that a carriage is never offered."""
    found = effects_of_the_screw()
    families = {effect.family for effect in found.values()}
    aliases = {alias.partition("[")[0] for effect in found.values() for alias in effect.evidence.aliases}

    assert "link_harmonic_friction[n=1]" in found
    assert aliases <= families


def test_the_turns_of_a_motor_are_none_of_a_carriage() -> None:
    """Metres are not counted in turns: no harmonic of a short log claims to be friction of another order."""
    log = logged(2, Carriage(ripple=6.0), seconds=8.0, runs=1)
    rig = RIG | {"known": {"pitch": "10 mm"}}
    found = eccentric.diagnose(log, rig, only=("link_harmonic_friction",)).data.search.candidates

    assert {row.family for row in found} == {"link_harmonic_friction"}
    assert {row.aliases for row in found} == {()}


def test_an_angle_of_the_screw_is_no_length() -> None:
    """Where a tight spot is, how wide, and what a cable adds are by the angle of the screw, kappa x."""
    found = effects_of_the_screw()
    units = {}
    for name in ("local_defect", "cable_spring"):
        heard = spoken(found[name].extend(load_model("screw_axis"), {}))
        units |= {q.name: q.unit for q in heard.parameters}

    assert (units["defect_A"], units["cable_0"], units["kappa"]) == ("N", "N", "1/m")
    assert [units[name] for name in ("defect_angle", "defect_width")] == ["radian", "radian"]
    assert units["cable_k"] == "N/radian"


def test_a_sentence_is_filled_from_terms() -> None:
    """What stands in braces is a term, a unit or a name; a term that begins a sentence does so in either."""
    sentence = "{Turn the link}: the {torque} constant {k_i} [{N m/A}] of the {drive}"

    assert LINEAR.filled(sentence) == "Move the carriage: the force constant k_f [N/A] of the drive"
    assert TURNING.filled(sentence) == sentence.replace("{", "").replace("}", "")


def test_the_keys_of_a_document_are_named_and_those_of_a_person_are_not() -> None:
    """Runs that carry a mass have the names that a person gave them."""
    given = {"rmse_Nm": {"omega_m_rad_s": "torque"}, "added_kg": {"torque": 1.0}}

    assert LINEAR.keyed(given) == {"rmse_N": {"velocity_m_s": "torque"}, "added_kg": {"torque": 1.0}}


@pytest.mark.parametrize("name", ["torque", "angle", "Torque"])
def test_a_column_with_a_word_of_ours_for_a_name_changes_no_sentence(name: str) -> None:
    """What a person has named is never looked up; every word of ours is that of the axis."""
    log = logged(8, seconds=8.0, runs=1)
    log = {"t_s": log["t_s"], "motor angle": log["q_m"], name: log["u_V"]}
    position = {"column": "motor angle", "unit": "m"}
    columns = {"time": "t_s", "position": position, "force": {"column": name, "gain": "35 N/V"}}
    found = eccentric.fit(log, RIG | {"name": name, "columns": columns})

    assert foreign(found.summary()) == []
    assert foreign(json.dumps({k: x for k, x in found.document.items() if k != "rig"})) == []
    assert (found.document["rig"], found.document["drive"]) == (name, "force")
    with pytest.raises(eccentric.InputError, match=f"'{name}'"):
        eccentric.fit({k: x for k, x in log.items() if k != name}, RIG | {"columns": columns})


def test_the_kind_of_an_axis_survives_a_copy() -> None:
    """A result that another process has made, by the same protocol, is of the same kind."""
    assert copy.deepcopy(LINEAR) is LINEAR
    assert copy.deepcopy(load_model("linear_axis")).axis is LINEAR


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("Angle of the link", "Angle of the screw"),
        ("angle of the link", "angle of the screw"),
        ("Turns of the motor", "Turns of the screw"),
        ("Rotation", "Motion"),
    ],
)
def test_a_sentence_begins_with_a_capital_in_either_words(text: str, expected: str) -> None:
    """The first letter of what is replaced is that of what replaces it, large or small."""
    assert expected == LINEAR.text(text)
