"""`rig --check` names a wrong scale of the current, and a wrong k_i, k_e or R, by what the log shows."""

from __future__ import annotations

import copy
import functools
import math
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

import eccentric
from eccentric.logs import Log
from eccentric.rigs import read_rig, rig_complaints
from eccentric.signals import Finding, read_channels
from eccentric.signals.quality.ratios import means_of
from tests.logged import SHARED, needs_shared

KEYS = {"k_i": "k_i_Nm_per_A", "k_e": "k_e_Vs_per_rad", "R": "R_ohm"}
INERTIA, MOTOR = ("J_m_kgm2", "J_l_kgm2"), ("R_ohm", "k_e_Vs_per_rad")
MILLI = 'current = { column = "current_A", unit = "mA" }'


@functools.cache
def bench(case: str) -> tuple[Log, dict[str, Any]]:
    """A log of 20 s without any effect, and its rig, whose k_i and k_e are equal."""
    run = eccentric.bench([], case=case, log_type="traj", seconds=20.0, seed=11)
    return run.log, dict(run.run.rig)


def findings(
    case: str,
    current: float = 1.0,
    *,
    without: tuple[str, ...] = (),
    ranged: bool = False,
    voltage: bool = True,
    factors: Mapping[str, float] | None = None,
) -> tuple[Finding, ...]:
    """What the check of the log says, with the current and values of the rig off by factors."""
    log, given = bench(case)
    columns, rig = {**log.columns, "current_A": current * log.numbers("current_A")}, copy.deepcopy(given)
    if not voltage:
        del columns["voltage_V"]
        rig["columns"].remove("voltage_V")
    for key in without:
        del rig["known"][key]
    for letter, factor in (factors or {}).items():
        rig["known"][KEYS[letter]] *= factor
    if ranged:
        del rig["known"][KEYS["k_i"]]
        rig["unknown"] = {KEYS["k_i"]: [0.001, 20.0]}
    found = read_channels([Log(log.path, columns, log.rows)], read_rig(rig)).intake.findings
    return tuple(f for f in found if f.kind in ("contradiction", "wrong_unit", "another_rig"))


@pytest.mark.parametrize(
    ("case", "options"),
    [
        ("C2", {}),
        ("C2", {"voltage": False}),
        ("C2", {"ranged": True}),
        ("C2", {"ranged": True, "voltage": False}),
        ("C2", {"ranged": True, "without": (*INERTIA, *MOTOR)}),
        ("C1", {}),
        ("C1", {"voltage": False}),
        ("C1", {"without": INERTIA}),
        ("C1", {"without": (*INERTIA, *MOTOR)}),
    ],
    ids=str,
)
def test_a_current_in_milliamperes_is_named_with_its_mend(case: str, options: dict[str, Any]) -> None:
    """By R, by gravity, by inertia, or by k_i against k_e: whatever the rig has; else silence."""
    (found,) = findings(case, 1e3, **options)

    assert MILLI == found.mend
    assert () == findings(case, **options)


@pytest.mark.parametrize("case", ["C1", "C2"])
@pytest.mark.parametrize("without", [(), INERTIA])
@pytest.mark.parametrize(("letter", "factor"), [("k_i", 10.0), ("k_i", 0.1), ("k_e", 10.0), ("R", 0.1)])
def test_a_motor_constant_off_by_a_decade_is_named(
    case: str, without: tuple[str, ...], letter: str, factor: float
) -> None:
    """The current is right, and the mend is the value that made the log, to 5 %."""
    true = bench(case)[1]["known"][KEYS[letter]]
    (found,) = findings(case, without=without, factors={letter: factor})

    assert letter == found.channel
    assert found.mend.startswith(f'{letter} = "')
    assert float(found.mend.split('"')[1].split()[0]) == pytest.approx(true, rel=0.05)


def test_a_current_in_counts_has_its_scale_told() -> None:
    """R, gravity and inertia agree on a factor that no unit has: it is the scale, not k_i."""
    (found,) = findings("C2", 20.48)
    scale = float(found.mend.split("* ")[1].rstrip('"'))

    assert ("wrong_unit", "current") == (found.kind, found.channel)
    assert scale == pytest.approx(1.0 / 20.48, rel=0.05)


def test_equal_constants_of_the_motor_may_differ_by_convention() -> None:
    """k_i of a line current of three phases is sqrt(3) off, and no complaint."""
    assert () == findings("C1", without=INERTIA, factors={"k_i": 3.0**0.5})


def test_the_check_lists_what_the_log_contradicts() -> None:
    """One line with the mend, in place of a list of estimates; the right rig has none."""
    log, rig = bench("C2")
    wrong = {**log.columns, "current_A": 1e3 * log.numbers("current_A")}
    found = eccentric.check_rig(Log(log.path, wrong, log.rows), rig)

    assert [f"write {MILLI}" in line for line in found.complaints] == [True]
    assert () == found.estimated


def test_an_encoder_that_is_no_number_is_the_only_complaint() -> None:
    """Columns in its counts can be read, but their scale says nothing about the other values."""
    log, rig = bench("C2")
    encoder = {**log.columns, "theta_m_rad": log.numbers("theta_m_rad") / math.tau * 8192}
    columns = {
        "time": "time_s",
        "theta_m": {"column": "theta_m_rad", "unit": "counts"},
        "omega_m": "omega_m_rad_s",
        "current": "current_A",
    }
    checked = {
        number: eccentric.check_rig(
            Log(log.path, encoder, log.rows), {**rig, "columns": columns, "encoder_counts_per_rev": number}
        ).complaints
        for number in (8192, "8192")
    }

    assert {8192: (), "8192": ("rig: encoder_counts_per_rev: expected a number, got '8192'",)} == checked


MISTYPED = """
k_i = "1 Nm/A"
[columns]
Theta_M = "x"
M = "1 kg"
[known]
case = "C2"
M = "0,5 kg"
ML = "1 kg"
drive = "current"
"""


def test_keys_in_the_wrong_place_or_spelling_are_put_right(tmp_path: Path) -> None:
    """Case and underscores do not hide a key; one of another table is sent there; a comma is no point."""
    path = tmp_path / "rig.toml"
    path.write_text(MISTYPED)
    found, _ = rig_complaints(path)

    assert [
        f"{path}: k_i: this key belongs under [known]",
        f"{path}: [columns]: unknown key 'Theta_M'; did you mean 'theta_m'?",
        f"{path}: [columns] M: this key belongs under [known]",
        f"{path}: [known] M: expected a decimal point, as in '0.5 kg', got '0,5 kg'",
        f"{path}: [known]: unknown key 'ML'; did you mean 'M_l'?",
        f"{path}: [known] drive: this key belongs at the top, above all tables",
    ] == [one.text for one in found]
    assert [("", "k_i"), ("columns", "Theta_M")] == [(one.table, one.key) for one in found[:2]]


def test_a_decimal_comma_of_a_bare_number_is_named_with_its_line(tmp_path: Path) -> None:
    """TOML itself cannot read it: the line is shown, and not the parser's words."""
    path = tmp_path / "rig.toml"
    path.write_text('low_pass_hz = 12,5\n[known]\ncase = "C2"\n')
    with pytest.raises(eccentric.InputError, match="expected a decimal point, got 'low_pass_hz = 12,5'"):
        rig_complaints(path)


@pytest.mark.parametrize(
    ("line", "wanted"),
    [
        ("M = 0.5 kg", 'expected a value with its unit in quotes, M = "0.5 kg"'),
        ("J = 1.2e-4 kg m^2  # the rotor", 'expected a value with its unit in quotes, J = "1.2e-4 kg m^2"'),
        ("k_i = .05N m/A", 'expected a value with its unit in quotes, k_i = ".05N m/A"'),
        ("mu_m = 1/10  # gear", 'expected a ratio in quotes, mu_m = "1/10"'),
        ("case = C2", 'expected a text in quotes, case = "C2"'),
        ("motor_off = True", "expected true or false in small letters, motor_off = true"),
    ],
)
def test_a_value_without_quotes_is_shown_as_it_has_to_be_written(
    tmp_path: Path, line: str, wanted: str
) -> None:
    """TOML's own words for it speak of the end of a document."""
    path = tmp_path / "rig.toml"
    path.write_text(f"[known]\nmu = 1\n{line}\n")
    with pytest.raises(eccentric.InputError) as error:
        rig_complaints(path)
    assert f"{path}: {wanted}, got {line!r} in line 3" == str(error.value)


def test_no_mean_of_rows_reaches_over_a_gap() -> None:
    """Stretches of five rows at ten a second, by turns up to a row not used and to a new run: a mean each."""
    stretch = np.repeat(np.arange(40), 6)
    last = np.arange(240) % 6 == 5
    kept = ~last | (stretch % 2 == 0)  # a row between two stretches, or none
    stretch, used = stretch[kept].astype(float), ~last[kept]
    omega, many = np.where(used, stretch, 1e3), len(stretch)
    c = SimpleNamespace(
        motion=SimpleNamespace(theta_m=omega, omega_m=omega, alpha_m=omega),
        motor=SimpleNamespace(
            coasting=False, off=np.zeros(many, dtype=bool), current=omega, torque=None, voltage=None
        ),
        selection=SimpleNamespace(fit_rows=used),
        time=SimpleNamespace(t=0.1 * np.arange(many), segment=(stretch + 1.0) // 2.0),
        carried=(),
    )
    found = means_of(cast("Any", c), cast("Any", SimpleNamespace(known={})))

    assert found is not None
    assert list(range(40)) == found.omega.tolist()


@needs_shared
def test_an_inertia_of_0_is_a_doubt() -> None:
    """A diagnosis of this log refuses it: at one frequency, delay and inertia cannot be told apart."""
    fault = SHARED / "field" / "faults" / "J_zero_misleading"
    found = eccentric.check_rig(fault / "real_log.csv", fault / "real_rig.toml")
    assert any("J, the inertia of the drive, is 0 in the log" in doubt for doubt in found.doubts)


@pytest.mark.parametrize("letter", ["M", "L"])
def test_a_missing_mass_may_be_that_of_a_bare_motor(letter: str) -> None:
    """The example is no advice to invent one."""
    log, rig = bench("C2")
    known = {key: x for key, x in rig["known"].items() if not key.startswith(f"{letter}_") or key == "M_l_kg"}
    (line,) = eccentric.check_rig(log, {**rig, "known": known}).complaints
    assert f"expected [known] {letter}, as in {letter} = " in line
    assert "for a bare motor)" in line


def test_a_missing_link_mass_may_be_a_range() -> None:
    """The range that the message offers is enough for a check and for a fit."""
    log, rig = bench("C2")
    known = {key: x for key, x in rig["known"].items() if key != "M_l_kg"}
    (line,) = eccentric.check_rig(log, {**rig, "known": known}).complaints
    offered = re.search(r"or a range: (\[unknown\]) (M_l = .*), got none$", line)
    assert offered
    ranged = {**rig, "known": known} | tomllib.loads("\n".join(offered.groups()))
    assert not eccentric.check_rig(log, ranged).complaints
    assert "M_l" in eccentric.fit(log, ranged).parameters
