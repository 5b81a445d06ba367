"""`eccentric adapt`: a log through the estimator, from the shell and from Python."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eccentric
from eccentric.adaptation.replay import _elapsed, inputs_of
from eccentric.cli import main
from eccentric.core import InputError
from eccentric.model import TURNING
from eccentric.rigs import read_rig
from eccentric.signals import read_channels

KNOWN = {
    "M": 0.5,
    "M_l": 0.2,
    "L": 0.25,
    "mu": 0.2,
    "R": 1.0,
    "k_i": 0.05,
    "k_e": 0.05,
    "J_m": 2e-4,
    "J_l": 0.04,
}
STEP = 2e-3


@pytest.fixture(scope="module")
def rig() -> dict[str, Any]:
    """Return a rig of case C2 that is known but for its friction."""
    units = {"R": "ohm", "k_i": "Nm_per_A", "k_e": "Vs_per_rad", "J_m": "kgm2", "J_l": "kgm2"}
    units |= {"M": "kg", "M_l": "kg", "L": "m"}
    known = {f"{x}_{units[x]}" if x in units else x: value for x, value in KNOWN.items()}
    return {
        "name": "arm",
        "sample_rate_hz": 1 / STEP,
        "known": {"case": "C2", **known},
        "columns": ["time_s", "theta_m_rad", "current_A"],
    }


def log(warmer: float, seconds: float = 20.0) -> dict[str, np.ndarray]:
    """Return a log of a drive from the paper, its viscous friction changing by that factor after 30 s."""
    t = np.arange(0, seconds, STEP)
    peak = 30 + 10 * np.sin(0.13 * t)
    omega = peak * np.sin(1.3 * t)
    theta = np.cumsum(omega) * STEP
    alpha = np.gradient(omega, STEP)
    M, M_l, L, mu, g = 0.5, 0.2, 0.25, 0.2, 9.81
    force = np.hypot(
        M * L * (mu * omega) ** 2 + (M + M_l) * g * np.cos(mu * theta), (M + M_l) * g * np.sin(mu * theta)
    )
    B = np.where(t < 30, 1.0, warmer) * 4e-3
    friction = B * omega + np.sign(omega) * (0.008 + 0.02 * mu * force) + 1e-4 * force * mu**2 * omega
    torque = (KNOWN["J_m"] + mu**2 * KNOWN["J_l"]) * alpha + mu * M * g * L * np.sin(mu * theta) + friction
    noise = np.random.default_rng(1).normal(0, 0.003, len(t))
    return {"time_s": t, "theta_m_rad": theta, "current_A": (torque + noise) / KNOWN["k_i"]}


def test_it_follows_the_friction(rig: Any) -> None:
    """Viscous friction that falls to 60 % half way is followed from one value to the other."""
    found = eccentric.adapt(log(0.6, 60.0), rig, forgetting=0.998).course

    def at(t: float) -> float:
        return float(found.values[np.searchsorted(found.t, t), found.names.index("B_m")])

    assert at(28.0) == pytest.approx(4e-3, rel=0.1)
    assert at(58.0) == pytest.approx(2.4e-3, rel=0.15)
    first = next((kind, at) for at, kind in found.alarms if at > 29.9)
    assert first == ("less", pytest.approx(30.0, abs=1.0))


def test_files_and_text(tmp_path: Path, rig: Any, capsys: pytest.CaptureFixture[str]) -> None:
    """The command writes strict JSON and figures, and prints a row for each coefficient."""
    table = log(1.0)
    path = tmp_path / "log.csv"
    rows, head = np.column_stack([*table.values()]), ",".join(table)
    np.savetxt(path, rows, delimiter=",", header=head, comments="", fmt="%.9g")
    (tmp_path / "rig.json").write_text(json.dumps(rig))

    status = main(["adapt", str(path), "--rig", str(tmp_path / "rig.json"), "--out", str(tmp_path / "out")])

    said = capsys.readouterr().out
    document = json.loads((tmp_path / "out" / "adapt.json").read_text())
    assert 0 == status
    assert ["adapt.json", "adapt.png", "adapt.svg"] == sorted(
        p.name for p in (tmp_path / "out").glob("adapt*")
    )
    assert {"B_lN", "C_lN", "B_m", "C_m"} == set(document["coefficients"])
    assert all(f"  {name}" in said for name in document["coefficients"])
    assert [] == document["alarms"]
    assert document["innovation"]["over_assumed"] == pytest.approx(1.0, abs=0.3)


@pytest.mark.parametrize(
    ("case", "beside"), [pytest.param("C1", False, marks=pytest.mark.slow), ("C2", True)]
)
def test_a_torque_serves_for_the_current(rig: Any, case: str, beside: bool) -> None:
    """A log of the torque is followed as one of the current; of both, the one that was fitted."""
    table = log(0.6)
    if case == "C1":  # without gravity, whose torque is mu M g L sin(mu theta)
        pull = 0.2 * 0.5 * 9.81 * 0.25 * np.sin(0.2 * table["theta_m_rad"])
        table["current_A"] = table["current_A"] - pull / KNOWN["k_i"]
    rig = rig | {"known": rig["known"] | {"case": case}}
    torque = {"time_s": table["time_s"], "theta_m_rad": table["theta_m_rad"]}
    torque["torque_Nm"] = table["current_A"] * KNOWN["k_i"]
    if beside:  # it is not to be used
        torque["current_A"] = 3.0 * table["current_A"]

    one = eccentric.adapt(table, rig).course
    other = eccentric.adapt(torque, rig | {"columns": [*torque], "drive": "torque"}).course

    assert one.names == other.names
    assert other.values == pytest.approx(one.values, rel=1e-6, abs=1e-9)


def test_runs_whose_time_begins_anew_follow_one_another() -> None:
    """Times that begin at 0 again, or where the run before ended, go on by a step; others stay."""
    assert _elapsed(np.array([0.0, 1.0, 2.0, 0.0, 1.0]), 1.0).tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert _elapsed(np.array([5.0, 6.0, 6.0, 7.0]), 1.0).tolist() == [5.0, 6.0, 7.0, 8.0]
    assert _elapsed(np.array([5.0, 6.0, 9.0, 10.0]), 1.0).tolist() == [5.0, 6.0, 9.0, 10.0]


def test_a_log_of_the_voltage_alone_is_refused(rig: Any) -> None:
    """In one line: file, channel, where to name it, what came."""
    table = log(1.0)
    voltage = {"time_s": table["time_s"], "theta_m_rad": table["theta_m_rad"], "u_V": table["current_A"]}
    columns = {"time": "time_s", "theta_m": "theta_m_rad", "voltage": "u_V"}

    with pytest.raises(InputError) as refused:
        eccentric.adapt(voltage, rig | {"columns": columns})
    assert str(refused.value) == (
        "table: expected a column for current or torque to follow friction; map it in [columns] of rig,"
        " got voltage only"
    )


def test_a_hidden_state_is_in_no_log(rig: Any) -> None:
    """A model with hidden states is refused in one line that names the first of them."""
    channels = read_channels([log(1.0)], read_rig(rig))

    with pytest.raises(InputError, match=r"expected a model without hidden states .*, got heat_P$"):
        inputs_of(channels, TURNING, ("theta_m", "heat_P"), "table")


def test_a_current_of_the_wrong_sign_is_refused(rig: Any) -> None:
    """The estimator does not start from a fit that its log contradicts, nor from one without friction."""
    turned = log(1.0)
    turned["current_A"] = -turned["current_A"]

    with pytest.raises(InputError, match=r"expected .* to start from"):
        eccentric.adapt(turned, rig)


def test_a_missing_effect_is_told_by_the_correlation(rig: Any) -> None:
    """Friction that varies over the link's turn leaves correlated innovations, and the text says so."""
    varied = log(1.0)
    varied["current_A"] += 0.02 * np.sign(varied["current_A"]) * np.sin(0.4 * varied["theta_m_rad"]) / 0.05

    assert "correlated from row to row" in eccentric.adapt(varied, rig).summary()
    assert "correlated" not in eccentric.adapt(log(1.0), rig).summary()
