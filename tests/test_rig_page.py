"""docs/rig.md and docs/rig-reference.md are correct: the rig runs, keys are all keys, units are units."""

from __future__ import annotations

import dataclasses
import re
from operator import attrgetter
from pathlib import Path

import numpy as np
import pytest

from eccentric.identification import Fit, fit
from eccentric.logs import parse_unit
from eccentric.model import load_model
from eccentric.rigs import CHANNELS, KEYS, KNOWNS, read_rig
from eccentric.signals import read_channels

ROOT = Path(__file__).parents[1]
PAGE = "".join(
    (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8") for name in ("rig", "rig-reference")
)
BENCH = ROOT / "examples" / "bench"
TABLES = ("known", "unknown", "columns", "added", "kinds", "controller")


def fitted(log: Path, rig_path: Path, **changes: object) -> Fit:
    """Fit a log under a rig file, with other values of the rig."""
    rig = dataclasses.replace(read_rig(rig_path), **changes)  # pyright: ignore[reportArgumentType]
    return fit(read_channels([log], rig), rig, load_model(rig.model))


def _code(text: str) -> list[str]:
    return re.findall(r"`([^`]+)`", text)


def test_the_rig_of_the_page_fits_a_log_in_its_units(tmp_path: Path) -> None:
    """The bundled log in milliseconds, degrees, rpm, milliamperes under the page's rig is the same fit."""
    t, theta, omega, voltage, current = np.loadtxt(BENCH / "bench.csv.gz", delimiter=",", skiprows=1).T
    table = {
        "Time (ms)": 1e3 * t,
        "Angle": np.degrees(theta / 5.0) % 360.0,
        "Speed": omega * 30.0 / np.pi,
        "Iq": 1e3 * current,
        "Duty (%)": 100.0 * voltage / 24.0,
        "Supply": np.full_like(t, 24.0),
    }
    log, page = tmp_path / "log.csv", tmp_path / "rig.toml"
    np.savetxt(log, np.column_stack(list(table.values())), "%.12g", ",", header=",".join(table), comments="")
    text = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)[0]
    page.write_text(text, encoding="utf-8")
    named = read_rig(page)
    found = fitted(log, page)
    (warning,) = found.warnings
    assert warning.startswith("the angle is wrapped at one turn of the link")
    expected = fitted(
        BENCH / "bench.csv.gz", BENCH / "bench.json", holdout=named.holdout, sampling=named.sampling
    )
    for name, e in expected.coefficients.items():
        assert found.coefficients[name].value == pytest.approx(e.value, rel=1e-5)
        assert found.coefficients[name].interval == pytest.approx(e.interval, rel=1e-5)


def test_the_rig_by_hand_of_the_bundled_log_says_what_the_sidecar_says() -> None:
    """bench.toml and bench.json are one rig, and give the same fit of the bundled log."""
    by_hand, sidecar = read_rig(BENCH / "bench.toml"), read_rig(BENCH / "bench.json")
    assert by_hand.known == pytest.approx(sidecar.known, rel=1e-14)
    for name in ("name", "case", "holdout", "sampling", "log.counts_per_rev"):
        assert attrgetter(name)(by_hand) == attrgetter(name)(sidecar)
    found, expected = (fitted(BENCH / "bench.csv.gz", BENCH / f"bench.{s}") for s in ("toml", "json"))
    assert found.warnings == ()
    assert found.rmse == pytest.approx(expected.rmse, rel=1e-9)


def test_every_key_stands_in_the_page() -> None:
    """Keys of the file, quantities in both ways of writing, channels and standard columns: all are listed."""
    told = set(_code(re.sub(r"```.*?```", "", PAGE, flags=re.DOTALL)))
    keys = {*KEYS, *CHANNELS, *(column for column, _ in CHANNELS.values()), "case"}
    keys |= {known.name for known in KNOWNS} | {known.key for known in KNOWNS}
    keys = {f"[{key}]" if key in TABLES else key for key in keys}
    assert sorted(keys - told) == []


def test_every_unit_of_the_page_is_a_unit() -> None:
    """What the table of units lists is understood."""
    table = PAGE.split("## Units")[1].split("\n## ")[0]
    units = [unit for row in table.splitlines() if row.startswith("| ") for unit in _code(row)]
    assert len(units) > 40
    for unit in units:
        assert parse_unit(unit, "page", 1000.0).factor > 0.0
