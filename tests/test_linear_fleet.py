"""A fleet of carriages: what changes is named in newtons, by the letters of an axis."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eccentric
from eccentric.fleet.drift import doubts_of
from eccentric.fleet.gathered import Assigned
from eccentric.fleet.periods import History, Period
from eccentric.fleet.sums import Columns, Coverage, Heading, require_rig, sums_of
from eccentric.model import LINEAR
from eccentric.rigs import read_rig
from tests.carriage import RIG, Carriage, logged
from tests.test_linear_words import foreign

pytest.importorskip("pyarrow")
pytest.importorskip("distributed")

pytestmark = pytest.mark.filterwarnings(
    "ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)
DECLARED: dict[str, Any] = {key: value for key, value in RIG.items() if key != "unknown"}
RIG_FILE = """kind = "linear"
[known]
mass = "95 kg"
[columns]
time = "t_s"
run = "run"
position = "q_m"
force = { column = "u_V", gain = "35 N/V" }
"""


def written(path: Path, log: dict[str, np.ndarray]) -> Path:
    """The log as a CSV file, its folder made."""
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, np.column_stack([*log.values()]), delimiter=",", header=",".join(log), comments="")
    return path


def test_the_coefficients_of_a_file_are_those_of_the_carriage(tmp_path: Path) -> None:
    """B, C, the mass and the load come back from the sums, whether the mass is declared or not."""
    path = written(tmp_path / "log.csv", logged(3, seconds=20.0, runs=1))
    found: dict[str, dict[str, float]] = {}
    for key, known in (("open", {}), ("declared", {"mass_kg": 95.0})):
        columns = Columns(read_rig({**DECLARED, "known": known}))
        factor = np.concatenate(sums_of(path, columns).triangles)
        values = np.linalg.lstsq(factor[:, :-1], factor[:, -1], rcond=None)[0]
        names = [f"{heading.name} [{heading.unit}]" for heading in columns.headings]
        found[key] = dict(zip(names, map(float, values), strict=True))

    friction = {"B [N s/m]": pytest.approx(203.0, rel=0.03), "C [N]": pytest.approx(20.0, rel=0.04)}
    load = {"offset [N]": pytest.approx(-3.0, abs=0.4)}
    assert {**friction, "mass [kg]": pytest.approx(95.0, rel=0.01), **load} == found["open"]
    assert {**friction, "scale [1]": pytest.approx(1.0, rel=0.01), **load} == found["declared"]


@pytest.mark.slow
def test_the_carriage_whose_seal_wears_is_named(tmp_path: Path) -> None:
    """Of three carriages over six months one loses a third of its Coulomb friction: it alone is named."""
    for k in range(3):
        for month in range(6):
            worn = k == 1 and month >= 3
            log = logged(10 * k + month, Carriage(C=13.0 if worn else 20.0), seconds=12.0, runs=1)
            written(tmp_path / "logs" / f"joint=X{k}" / f"month=2025-{month + 1:02}" / "log.csv", log)
    rig = tmp_path / "axis.toml"
    rig.write_text(RIG_FILE, encoding="utf-8")

    found = eccentric.diagnose_fleet(tmp_path / "logs", rig, tmp_path / "out", workers=1)

    assert ["X1"] == [one.joint for one in found.drifting]
    (one,) = found.drifting
    assert (("C",), "2025-04", "N") == (one.names, one.since, one.unit)
    assert one.shown.after - one.shown.before == pytest.approx(-7.0, abs=1.0)
    assert found.problems == ()
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    said = [found.summary(), (tmp_path / "out" / "changes.csv").read_text(encoding="utf-8"), page]
    assert not foreign("\n".join(said))
    assert (tmp_path / "out" / one.report).is_file()


def test_what_a_rig_lacks_is_told_once_in_its_own_letters(tmp_path: Path) -> None:
    """A current without its constant is one line that asks for k_f, before any of its files is read."""
    columns = {**DECLARED["columns"], "current": {"column": "u_V", "unit": "A"}}
    del columns["force"]

    with pytest.raises(eccentric.InputError, match=r"expected \[known\] k_f for a fleet driven by current"):
        require_rig(read_rig({**DECLARED, "columns": columns}))
    log = written(tmp_path / "log.csv", logged(1, seconds=3.0, runs=1))
    text = log.read_text(encoding="utf-8").replace("t_s,q_m,u_V", "time_s,position_m,current_A")
    log.write_text(text, encoding="utf-8")
    headed = Columns(read_rig({key: value for key, value in DECLARED.items() if key != "columns"}))
    with pytest.raises(eccentric.InputError, match=r"expected \[known\] k_f for a fleet driven by current"):
        sums_of(log, headed)


def test_a_table_of_rigs_gives_each_carriage_its_own_mass(tmp_path: Path) -> None:
    """A value of the table takes the place of the file's, whichever of its keys either uses."""
    (tmp_path / "axis.toml").write_text(RIG_FILE, encoding="utf-8")
    (tmp_path / "rigs.csv").write_text(
        "joint,rig,mass_kg\nX1,axis.toml,90\nX2,axis.toml,\n", encoding="utf-8"
    )

    rigs = Assigned(str(tmp_path / "rigs.csv"))

    assert [90.0, 95.0] == [rigs.rig(joint).known["J_m"] for joint in ("X1", "X2")]


def test_doubts_are_in_the_words_of_a_carriage() -> None:
    """A mass of another joint, and friction of the wrong sign."""
    headings = (Heading("C", "N", "coulomb"), Heading("scale", "1", "scale"))
    coverage = Coverage(1000, 60.0, 0.5, 0.01, 0.4, np.nan, np.nan, np.nan)
    period = Period(
        *("2025-01", np.array([-20.0, 3.0]), np.diag([1e-2, 1e-4]), 30, np.eye(3), 1000),
        *((-20.0, 0.1), (1.0, 0.1), np.ones(2), coverage),
    )
    history = History("X1", headings, (period,) * 6, LINEAR)

    said = [problem.text for problem in doubts_of(history)]

    assert said[0].startswith("expected a positive mean friction force, got -20 N")
    assert said[1].startswith("expected a mass near that of the rig, got 3 times as much")
    assert not foreign("\n".join(said))
