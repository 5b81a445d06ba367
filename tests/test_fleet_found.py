"""What a fleet says of a joint by its diagnoses: whose gain it is, and when an earlier one still counts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from eccentric.api import fleet as api
from eccentric.core import InputError
from eccentric.fleet import NOT_GROUPED, FleetProblem, Suspect, run
from eccentric.fleet.drift import Changed, FleetChange, Series
from eccentric.fleet.periods import History, Period
from eccentric.fleet.run import Examined, FleetFound, drifting_of
from eccentric.fleet.sums import Coverage
from eccentric.presentation import fleet_sentence
from eccentric.presentation.fleet_html import _levels
from eccentric.rigs import Rig
from tests.fleets import one_joint, rig_of


def _suspect(rig: Rig) -> Suspect:
    """A joint whose change no coefficient explains, without logs."""
    return Suspect("J", rig, None, (), Changed((), (), 0.1, 0.05, 0.02, 0.05, 0.2, 0.5), None, None)


@pytest.mark.parametrize(
    "entry",
    [
        {"theta_zero_rad": 0.7},
        {"voltage_offset_V": 1.0},
        {"holdout_intervals_s": [[1.0, 2.0]]},
        {"low_pass_hz": 10.0},
        {"known": {"M_kg": 9.0}},
    ],
    ids=lambda entry: next(iter(entry)),
)
def test_a_diagnosis_counts_for_its_own_rig_only(entry: dict[str, Any]) -> None:
    """Whatever is said of the rig in another way, a joint is diagnosed again; a new name changes nothing."""
    _, joint = one_joint()
    rig = rig_of(joint)

    assert api._digest(_suspect(rig_of(joint, **entry))) != api._digest(_suspect(rig))
    assert api._digest(_suspect(replace(rig, path="elsewhere", name="K"))) == api._digest(_suspect(rig))


class _Diagnosed(NamedTuple):
    """What `_kept` reads of a diagnosis: new effects, and the errors before and after."""

    document: dict[str, Any]
    rmse: dict[str, dict[str, float]]
    unit: str = "N m"

    def write(self, folder: Path) -> None:
        """Write nothing but the folder."""
        folder.mkdir(parents=True)


def _as_found(
    families: Sequence[str],
    before: float,
    after: float,
    tied: Sequence[str] = (),
    corrects: str | None = None,
) -> Any:
    given = {"headline": "", "balance": "mechanical", "corrects": corrects}
    effects = [{"family": name, "id": f"{name}[d=1]", **given} for name in families]
    errors = {"mechanical": {"paper": before, "extended": after}}
    document = {"effects": effects, "tied": list(tied), "improvement": {"balance": "mechanical"}}
    return _Diagnosed(document, errors)


@pytest.mark.parametrize(
    ("beside", "expected"),
    [({}, True), ({"balance": "electrical"}, True), ({"corrects": "J"}, True), (None, False)],
    ids=["another of friction", "one of the motor", "a wrong declaration", "the motor's alone"],
)
def test_one_effect_of_the_friction_is_enough(
    beside: dict[str, Any] | None, expected: bool, tmp_path: Path
) -> None:
    """What else a diagnosis finds, in the motor or in what was declared, does not make it less."""
    _, joint = one_joint()
    found = _as_found(["cogging"], 0.1, 0.05)
    (effect,) = found.document["effects"]
    found.document["effects"] = (
        [{**effect, "balance": "electrical"}] if beside is None else [effect, {**effect, **beside}]
    )
    word = api._kept(tmp_path, _suspect(rig_of(joint)), (found, (), ""))

    assert expected == word.friction


@pytest.fixture
def suspect() -> Suspect:
    """A joint whose residual changed."""
    series = Series("J", "residual", "1", ("a",), *(np.zeros(1) for _ in range(3)), torque=1.0, least=0.15)
    change = FleetChange(series, "step", "2025-05", 0.3, 1.0, 1e-5, True)
    return replace(_suspect(rig_of(one_joint()[1])), changes=(change,))


def test_the_gain_of_old_effects_is_not_that_of_a_new_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suspect: Suspect
) -> None:
    """Of 0.10 the past's Stribeck effect takes 0.05, a new one 0.001: that is not named as the cause."""
    can_be_in_the_model = True

    def diagnosed(_: Rig, __: object, when: str, including: Sequence[str] = ()) -> Any:
        if including and not can_be_in_the_model:
            raise InputError("an effect with hidden states cannot be part of the model from the start")
        if including:
            return _as_found(["cogging"], 0.05, 0.049)
        return _as_found(["stribeck"] if when == "past" else ["stribeck", "cogging"], 0.1, 0.049)

    monkeypatch.setattr(api, "_diagnosed", diagnosed)
    (found,) = api._examined([suspect])
    word = api._kept(tmp_path / "a", suspect, found)
    assert (word.before, word.after) == (0.05, 0.049)
    assert drifting_of(suspect, word).names == ()
    assert drifting_of(suspect, word).what.endswith("nor any effect of the library")

    can_be_in_the_model = False
    (found,) = api._examined([suspect])
    word = api._kept(tmp_path / "b", suspect, found)
    said = drifting_of(suspect, word)
    assert said.names == ()
    assert (said.before, said.after) == (suspect.changed.before, suspect.changed.after)
    assert said.what.endswith("new beside stribeck: cogging[d=1], whose own gain is not known")


def test_what_is_kept_of_a_suspect_is_made_of_its_own_result(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two joints one is diagnosed and the other fails: each has its word, and the failure is told."""
    _, joint = one_joint()
    good = _suspect(rig_of(joint))
    bad = replace(good, joint="K")
    results = {"J": "a result", "K": run.Failed("no luck")}
    monkeypatch.setattr(run, "spread", lambda *_: ((s, results[s.joint]) for s in (good, bad)))
    into: dict[str, Examined] = {}

    def keep(suspect: Suspect, result: str) -> Examined:
        return Examined(report=f"{suspect.joint}: {result}")

    problems = run._examined([good, bad], None, lambda _: (), keep, into, lambda *_: None)

    assert {"J": Examined(report="J: a result"), "K": Examined(said="no luck")} == into
    assert [("K", "no luck")] == [(problem.joint, problem.text) for problem in problems]


def test_a_new_effect_with_a_gain_of_its_own_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suspect: Suspect
) -> None:
    """A past without effects: 0.10 becomes 0.05 by the new one, which is the answer, also in the next run."""
    made = {"past": _as_found([], 0.05, 0.05), "recent": _as_found(["cogging"], 0.1, 0.05)}
    monkeypatch.setattr(api, "_diagnosed", lambda rig, sample, when, including=(): made[when])

    (found,) = api._examined([suspect])
    word = api._kept(tmp_path, suspect, found)
    (api._place(tmp_path, suspect) / "report.html").touch()

    said = drifting_of(suspect, word)
    assert (said.what, said.before, said.after) == ("new: cogging[d=1]", 0.1, 0.05)
    assert api._known(tmp_path, suspect) == word


def test_a_wrong_declaration_is_not_friction(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suspect: Suspect
) -> None:
    """Another load, or another torque constant, is found like friction, and counted apart."""
    for family, corrects in (("cogging", None), ("inertia_mismatch", "J")):
        made = {
            "past": _as_found([], 0.05, 0.05),
            "recent": _as_found([family], 0.1, 0.05, corrects=corrects),
        }
        monkeypatch.setattr(api, "_diagnosed", lambda rig, sample, when, including=(), made=made: made[when])
        (found,) = api._examined([suspect])
        said = drifting_of(suspect, api._kept(tmp_path / family, suspect, found))
        assert said.sensor == (corrects is not None)
        assert said.size == "residual × 1.35"


def test_effects_that_the_log_does_not_distinguish_are_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suspect: Suspect
) -> None:
    """A tie is no name, and not the same as a change that nothing explains."""
    made = {"past": _as_found([], 0.05, 0.05), "recent": _as_found([], 0.1, 0.05, ("stribeck", "presliding"))}
    monkeypatch.setattr(api, "_diagnosed", lambda rig, sample, when, including=(): made[when])

    (found,) = api._examined([suspect])
    word = api._kept(tmp_path, suspect, found)
    (api._place(tmp_path, suspect) / "report.html").touch()

    said = drifting_of(suspect, word)
    assert said.names == ()
    assert said.what.endswith("explains: stribeck or presliding, which its log does not distinguish")
    assert api._known(tmp_path, suspect) == word


def test_a_joint_that_was_not_diagnosed_is_not_called_unexplained(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suspect: Suspect
) -> None:
    """A diagnosis that fails, in whatever way, is told in its place, and the other joints are diagnosed."""
    fails = [OSError("disk full"), InputError("no log")]

    def diagnosed(*_: object) -> Any:
        raise fails.pop(0)

    monkeypatch.setattr(api, "_diagnosed", diagnosed)
    words = [api._kept(tmp_path, suspect, found) for found in api._examined([suspect, suspect])]

    assert [drifting_of(suspect, word).what for word in words] == [
        "a change that no coefficient explains, and that was not diagnosed: OSError: disk full",
        "a change that no coefficient explains, and that was not diagnosed: no log",
    ]


def test_a_fleet_without_a_judged_joint_is_not_called_unchanged() -> None:
    """No joint has a period with an answer: the sentence says so, instead of "none changed"."""
    empty = FleetFound(
        histories=(History("J1", (), ()),),
        changes=(),
        drifting=(),
        problems=(),
        files=1,
        reused=0,
        gone=(),
        without_log=(),
        rate=0.01,
    )
    assert "No joint could be tested" in fleet_sentence(empty)


def _friction(period: str, level: float) -> Period:
    """A period of which only the mean friction is known."""
    none, coverage = np.zeros(0), Coverage(1, 1.0, 0.5, 0.1, 5.0, 20.0, 19.0, 21.0)
    return Period(period, none, none, 1, none, 1, (level, 1e-3), (0.1, 1e-3), none, coverage)


@pytest.mark.parametrize("count", [2, 3, 6])
def test_the_lines_of_all_joints_span_the_figure_from_the_first_period_to_the_last(count: int) -> None:
    """Each period has its place at equal distances; a joint without a log in one goes past it."""
    periods = [f"2025-{k + 1:02d}" for k in range(count)]
    levels = [_friction(period, 1.0 + 0.1 * k) for k, period in enumerate(periods)]
    histories = (History("J", (), tuple(levels)), History("K", (), (levels[0], levels[-1])))
    found = _levels(FleetFound(histories, (), (), (), 2 * count, 0, (), (), 0.01), periods)
    every, ends = ([float(at.split(",")[0]) for at in line.split()] for _, _, line in found["lines"])

    assert float(found["right"]) == every[-1]
    assert np.linspace(every[0], every[-1], count) == pytest.approx(every, abs=0.06)
    assert [every[0], every[-1]] == ends


def test_logs_without_a_joint_are_one_warning() -> None:
    """A wrong pattern is said once, with how many logs it concerns; all are in problems.csv."""
    aside = [FleetProblem("", "", f"{k}.csv", NOT_GROUPED, f"expected a name, got {k}.csv") for k in "abc"]
    other = FleetProblem("J", "2025-01", "d.csv", "cannot be used", "expected rows")

    assert list(api._warnings([*aside, other])) == [
        "J 2025-01: expected rows",
        "expected a name, got a.csv, and so 2 more",
    ]
    assert list(api._warnings(aside[:1])) == ["expected a name, got a.csv"]
