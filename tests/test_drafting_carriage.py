"""A log of a carriage becomes a rig file: by the units of its header, and only by these."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

import eccentric

MASS, COULOMB, VISCOUS, LOAD = 80.0, 25.0, 150.0, 12.0
K_F = 40.0


def _log(path: Path, **columns: str) -> Path:
    """A carriage under F = m a + C sgn v + B v + F_load; `columns`: quantity -> header."""
    rng = np.random.default_rng(11)
    t = np.arange(0.0, 40.0, 0.004)
    x = 0.12 * np.sin(0.9 * t) + 0.03 * np.sin(3.1 * t + 1.0)
    v = 0.108 * np.cos(0.9 * t) + 0.093 * np.cos(3.1 * t + 1.0)
    a = -0.0972 * np.sin(0.9 * t) - 0.2883 * np.sin(3.1 * t + 1.0)
    force = MASS * a + COULOMB * np.sign(v) + VISCOUS * v + LOAD + rng.normal(0.0, 1.0, len(t))
    values = {
        "t": t, "x": x, "x_mm": 1e3 * x, "v": v, "v_mm": 1e3 * v, "F": force, "i": force / K_F,
        "tau": 0.002 * force,
    }  # fmt: skip
    table = np.column_stack([values[name] for name in columns])
    np.savetxt(path, table, delimiter=",", header=",".join(columns.values()), comments="", fmt="%.9g")
    return path


def _channels(text: str) -> dict[str, tuple[str, str]]:
    """Channel -> column and unit, "" for the standard one."""
    found = tomllib.loads(text)["columns"]
    return {
        name: (one, "") if isinstance(one, str) else (one["column"], one["unit"])
        for name, one in found.items()
    }


def test_from_the_header_to_the_fit_nothing_is_typed(tmp_path: Path) -> None:
    """Mass and friction that made the log are in the intervals of a fit with the drafted rig as it is."""
    log = _log(tmp_path / "log.csv", t="t_s", x_mm="x [mm]", F="force_N")
    rig = tmp_path / "rig.toml"

    draft = eccentric.draft_rig(log)
    draft.write(rig)
    fit = eccentric.fit(log, rig)

    assert draft.needed == ()
    assert _channels(draft.text) == {
        "time": ("t_s", ""),
        "position": ("x [mm]", "mm"),
        "force": ("force_N", ""),
    }
    for name, value in {"mass": MASS, "C": COULOMB, "B": VISCOUS, "F_load": LOAD}.items():
        low, high = fit.estimates[name].interval
        assert low < value < high, name
        assert high - low < 0.2 * value, name


@pytest.mark.parametrize(
    ("columns", "expected"),
    [
        ({"x": "x [m]", "v_mm": "vel", "F": "F_N"}, {"position": ("x [m]", ""), "velocity": ("vel", "mm/s")}),
        (
            {"x_mm": "pos", "v": "vel [m/s]", "F": "F_N"},
            {"position": ("pos", "mm"), "velocity": ("vel [m/s]", "")},
        ),
        ({"v_mm": "speed_mm_s", "F": "F_N"}, {"velocity": ("speed_mm_s", "mm/s")}),
    ],
    ids=["unit of the velocity by the position", "unit of the position by the velocity", "no position"],
)
def test_a_unit_that_no_header_gives_follows_from_the_slope(
    tmp_path: Path, columns: dict[str, str], expected: dict[str, tuple[str, str]]
) -> None:
    """Position and velocity are one motion: the unit of one gives that of the other."""
    draft = eccentric.draft_rig(_log(tmp_path / "log.csv", t="t_s", **columns))
    found = _channels(draft.text)

    assert expected == {name: found[name] for name in ("position", "velocity") if name in found}
    assert tomllib.loads(draft.text)["kind"] == "linear"


def test_a_current_asks_for_the_force_constant(tmp_path: Path) -> None:
    """It is the one value to be typed; the load keeps a range."""
    draft = eccentric.draft_rig(_log(tmp_path / "log.csv", t="t_s", x_mm="x [mm]", i="current_A"))

    assert draft.needed == ("k_f",)
    assert tomllib.loads(draft.text)["unknown"]["F_load"] == ["-1000 N", "1000 N"]


def test_a_torque_drives_no_carriage_and_a_force_no_shaft(tmp_path: Path) -> None:
    """Each is left out with the reason, instead of a line that no fit takes."""
    carriage = eccentric.draft_rig(_log(tmp_path / "one.csv", t="t_s", x_mm="x [mm]", tau="torque_Nm"))
    shaft = eccentric.draft_rig(_log(tmp_path / "two.csv", t="t_s", x="theta_rad", F="force_N"))

    assert "pitch" in carriage.left_out["torque_Nm"]
    assert "shaft" in shaft.left_out["force_N"]
    assert "kind" not in tomllib.loads(shaft.text)
    assert not {"force", "torque"} & (set(_channels(carriage.text)) | set(_channels(shaft.text)))


def test_without_a_unit_of_length_a_shaft_is_drafted(tmp_path: Path) -> None:
    """Values alone tell no carriage from a shaft."""
    draft = eccentric.draft_rig(_log(tmp_path / "log.csv", t="t_s", x="pos", F="drive"))

    assert "kind" not in tomllib.loads(draft.text)
    assert "theta_m" in _channels(draft.text)


def test_a_check_holds_a_carriage_against_its_log(tmp_path: Path) -> None:
    """Millimetres that are read as metres are contradicted, in the words of a carriage."""
    log = _log(tmp_path / "log.csv", t="t_s", x_mm="x [mm]", v="v [m/s]", F="F_N")
    draft = eccentric.draft_rig(log)
    right = draft.text
    wrong = right.replace('unit = "mm"', 'unit = "m"')
    assert wrong != right
    for name, text in (("right", right), ("wrong", wrong)):
        (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")

    assert eccentric.check_rig(log, tmp_path / "right.toml").complaints == ()
    (said,) = eccentric.check_rig(log, tmp_path / "wrong.toml").complaints
    assert "[columns] position: 'x [mm]' is read in m, the log shows mm" in said
    assert said.endswith('write position = { column = "x [mm]", unit = "mm" }')
