"""Sums of a log: windows, triangles, coefficients; against polynomials, NumPy and the virtual bench."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.fleet.sums.columns import Columns, dependent, solve
from eccentric.fleet.sums.of_file import FileSums, _Left, any_in, means, pieces, rates, sums_of
from eccentric.identification import merged, triangles
from eccentric.logs import Log
from eccentric.rigs import Rig
from eccentric.signals import Table, read_table
from eccentric.virtual_bench import FleetJoint
from tests.fleets import one_joint, rig_of, write_log


def swung() -> tuple[FleetJoint, dict[str, np.ndarray]]:
    """A joint and its log of 40 s."""
    plan, joint = one_joint()
    return joint, {name: np.asarray(x, float) for name, x in plan.log(joint, 0).items()}


def _values(sums: FileSums, columns: Columns) -> dict[str, float]:
    names = [heading.name for heading in columns.headings]
    return dict(zip(names, solve(sums.triangles).values.tolist(), strict=True))


@pytest.mark.parametrize("share", [2, 5, 40])
def test_windows_differentiate_a_parabola_exactly(share: int) -> None:
    """The mean rates of 3 - 2 t + 5 t^2 are -2 + 10 t and 10, far from 0 as well."""
    step = 0.004
    t = 1000.0 + step * np.arange(20 * share, dtype=np.float64)
    middle = t[0] + step * (share * np.arange(17) + (4 * share - 1) / 2.0)

    theta, omega, alpha = rates(3.0 - 2.0 * t + 5.0 * t**2, share, step)

    assert len(theta) == 17
    np.testing.assert_allclose(omega, -2.0 + 10.0 * middle, rtol=1e-9)
    np.testing.assert_allclose(alpha, 10.0, rtol=1e-4)
    np.testing.assert_allclose(means(t, share), middle, rtol=1e-12)


def test_the_rate_of_a_mean_is_the_mean_of_the_rate() -> None:
    """Of a sine all three are the sine, cosine and minus sine times one factor: one low pass for all."""
    step, w = 0.005, 9.0
    t = step * np.arange(4000)

    theta, omega, alpha = rates(np.sin(w * t), 6, step)
    factor = np.max(theta)

    assert 0.9 < factor < 0.999
    np.testing.assert_allclose(np.hypot(theta, omega / w), factor, rtol=2e-4)
    np.testing.assert_allclose(-alpha / w**2, theta, atol=2e-3)


def test_a_window_with_a_flag_anywhere_is_flagged() -> None:
    """The 13th of 40 samples is in the windows of 4 times 3 samples that begin at 3, 6, 9 and 12."""
    flag = np.zeros(40, bool)
    flag[12] = True

    assert np.flatnonzero(any_in(flag, 3)).tolist() == [1, 2, 3, 4]


def test_sums_of_parts_are_those_of_the_whole_in_any_order() -> None:
    """Triangles of 40 parts, merged in three orders, give what lstsq gives on all rows, to 1e-9."""
    random = np.random.default_rng(2)
    x = random.standard_normal((5000, 4)) * [1.0, 1e-3, 40.0, 1.0]
    y = x @ [1.0, 2.0, 3.0, 4.0] + random.standard_normal(5000)
    stack = triangles(np.column_stack([x, y]), np.arange(5000) * 40 // 5000, 40)
    expected = np.linalg.lstsq(x, y, rcond=None)[0]

    for order in (np.arange(40), np.arange(40)[::-1], random.permutation(40)):
        in_pairs = np.stack([merged(stack[order[k : k + 2]]) for k in range(0, 40, 2)])
        np.testing.assert_allclose(solve(in_pairs).values, expected, rtol=1e-9)
        np.testing.assert_allclose(merged(in_pairs), merged(stack), rtol=1e-9, atol=1e-9)


def test_triangles_keep_the_digits_that_normal_equations_lose() -> None:
    """At a condition of 1e7 the triangle's answer is right to 1e-6; that of X'X is wrong by 1e-3 or more."""
    random = np.random.default_rng(5)
    x = random.standard_normal((2000, 2))
    x[:, 1] = x[:, 0] + 1e-7 * x[:, 1]
    y = x @ [1.0, 1.0]
    stack = triangles(np.column_stack([x, y]), np.arange(2000) * 8 // 2000, 8)

    values = solve(stack).values
    normal = np.linalg.solve(x.T @ x, x.T @ y)

    np.testing.assert_allclose(values, 1.0, atol=1e-6)
    assert np.max(np.abs(normal - 1.0)) > 1e-3
    assert dependent(merged(stack)) == [0, 1]


def test_intervals_hold_for_noise_that_lasts() -> None:
    """Errors of a slope under noise with a memory of 20 rows spread as their standard errors say."""
    random = np.random.default_rng(7)
    off, said = [], []
    for _ in range(200):
        noise = np.convolve(random.standard_normal(3200 + 19), np.ones(20), mode="valid")
        x = np.repeat(random.standard_normal(160), 20)
        stack = triangles(np.column_stack([x, 2.0 * x + noise]), np.arange(3200) * 32 // 3200, 32)
        solved = solve(stack)
        off.append(solved.values[0] - 2.0)
        said.append(np.sqrt(solved.covariance[0, 0]))

    assert 0.85 < np.std(off) / np.mean(said) < 1.15


@pytest.mark.parametrize("rows", [997, 3000])
def test_sums_do_not_depend_on_the_size_of_a_batch(rows: int, tmp_path: Path) -> None:
    """Of a log that wraps at every turn, lacks a row and has a gap, read whole and in parts, to 1e-9."""
    joint, log = swung()
    log["theta_m_rad"] = np.mod(log["theta_m_rad"], 2.0 * np.pi)
    kept = np.r_[0:2000, 2001:3333, 3600 : len(log["time_s"])]
    path = write_log(tmp_path / "log.parquet", {k: x[kept] for k, x in log.items()}, group=500)
    columns = Columns(rig_of(joint))

    whole, parts = sums_of(path, columns), sums_of(path, columns, rows)

    assert whole.windows.tolist() == parts.windows.tolist()
    np.testing.assert_allclose(merged(parts.triangles), merged(whole.triangles), rtol=1e-9, atol=1e-9)
    assert whole.coverage.seconds == pytest.approx(parts.coverage.seconds)


def test_a_missing_row_is_filled_in_and_not_wanted(tmp_path: Path) -> None:
    """The others keep their values, and their place on the grid."""
    joint, log = swung()
    rig, rows = rig_of(joint), len(log["time_s"])
    left_out = {name: np.delete(x, 2000) for name, x in log.items()}

    (whole,) = pieces(write_log(tmp_path / "whole.parquet", log), rig, rows)
    (found,) = pieces(write_log(tmp_path / "log.parquet", left_out), rig, rows)

    kept = np.delete(np.arange(rows), 2000)
    np.testing.assert_allclose(found.theta[kept], whole.theta[kept], rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(found.drive[kept], whole.drive[kept], rtol=0.0, atol=1e-9)
    assert np.flatnonzero(found.wanted != whole.wanted).tolist() == [2000]


@pytest.mark.parametrize("idle_s", [2.0, 1500.0])
@pytest.mark.parametrize("rows", [5000, 2**20])
def test_standstill_is_not_motion(idle_s: float, rows: int, tmp_path: Path) -> None:
    """Before 40 s of motion a joint stands still with a noisy angle: none of that counts, in any batch."""
    joint, log = swung()
    rig = rig_of(joint)
    columns = Columns(replace(rig, log=replace(rig.log, counts_per_rev=None)))
    alone = write_log(tmp_path / "alone.parquet", log)
    step = float(np.median(np.diff(log["time_s"])))
    count = round(idle_s / step)
    still = {name: np.full(count, x[0]) for name, x in log.items()}
    still["theta_m_rad"] += 2e-4 * np.random.default_rng(4).standard_normal(count)
    still["current_A"] += 0.5 + np.random.default_rng(6).standard_normal(count)
    still["time_s"] = log["time_s"][0] - 10.0 - step * np.arange(count, 0, -1)
    path = write_log(tmp_path / "log.parquet", {name: np.r_[still[name], x] for name, x in log.items()})
    expected = _values(sums_of(alone, columns), columns)

    sums = sums_of(path, columns, rows)

    assert sums.coverage.seconds == pytest.approx(sums_of(alone, columns).coverage.seconds, rel=0.01)
    assert _values(sums, columns) == {n: pytest.approx(x, rel=0.01, abs=1e-4) for n, x in expected.items()}


def test_an_encoder_that_jitters_at_rest_does_not_move(tmp_path: Path) -> None:
    """Of a file without any motion, the step of the encoder tells so: it has no second of motion."""
    joint, log = swung()
    jitter = 2.0 * np.pi / 32768 * np.random.default_rng(8).integers(0, 2, len(log["time_s"]))
    path = write_log(tmp_path / "log.parquet", log | {"theta_m_rad": jitter})

    assert sums_of(path, Columns(rig_of(joint))).coverage.seconds == 0.0


@pytest.mark.parametrize("suffix", [".csv", ".csv.gz", ".parquet"])
def test_a_file_is_read_in_parts(suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of text as of Parquet at most as many rows as are asked for are in memory; the sums are the same."""
    joint, log = swung()
    expected = sums_of(write_log(tmp_path / "all.parquet", log), Columns(rig_of(joint)))
    path = tmp_path / f"log{suffix}"
    if suffix == ".parquet":
        write_log(path, log)
    else:
        header, rows = ",".join(log), np.column_stack([np.asarray(x, float) for x in log.values()])
        np.savetxt(path, rows, "%.17g", ",", header=header, comments="")
    lengths: list[int] = []

    def told(logs: list[Log], rig: Rig) -> Table:
        lengths.extend(one.rows for one in logs)
        return read_table(logs, rig)

    monkeypatch.setattr("eccentric.fleet.sums.of_file.read_table", told)
    sums = sums_of(path, Columns(rig_of(joint)), 1000)

    assert max(lengths) <= 1000
    assert sum(lengths) == 2 * len(log["time_s"])  # once for the threshold of motion, once for the sums
    np.testing.assert_allclose(merged(sums.triangles), merged(expected.triangles), rtol=1e-8, atol=1e-8)


def test_coefficients_are_those_of_the_bench(tmp_path: Path) -> None:
    """The friction that the bench was given, at 22 deg C, within four standard errors and 6 %."""
    plan, joint = one_joint(200.0, warmer=5.0)
    log = plan.log(joint, 0)
    path = write_log(tmp_path / "log.parquet", log)
    columns = Columns(rig_of(joint))
    sums = sums_of(path, columns)
    found = solve(sums.triangles)
    thin = float(np.mean(np.exp(-0.02 * (log["temperature_C"] - 22.0))))
    true = [joint.B_lN * thin, joint.C_lN, joint.B_m * thin, joint.C_m, 1.0, 0.0]

    off = np.abs(found.values - true)

    # The bench lets each coefficient wander by 1 % a month, and windows smooth a swing by some 0.1 %.
    allowed = 4.0 * np.sqrt(np.diag(found.covariance)) + 0.03 * np.abs(true)
    assert np.all(off < allowed), (found.values, true)
    assert found.values[4] == pytest.approx(1.0, abs=0.004)
    assert 0.45 < sums.coverage.forward < 0.55


@pytest.mark.parametrize("drive", ["torque", "torque_l", "voltage"])
def test_every_measure_of_the_drive_gives_the_same_torque(drive: str, tmp_path: Path) -> None:
    """A torque of either side, or the voltage of a known armature, gives the coefficients of the current."""
    joint, log = swung()
    k_i, mu, t = joint.known["k_i"], joint.known["mu"], log["time_s"]
    speed = np.gradient(log["theta_m_rad"], t)
    current = np.asarray(log["current_A"], float)
    signal = {
        "torque": k_i * current,
        "torque_l": k_i * current / mu,
        "voltage": 1.5 * current + 0.06 * speed,
    }
    path = write_log(tmp_path / "log.parquet", log | {"drive": signal[drive]})
    expected = _values(sums_of(path, Columns(rig_of(joint))), Columns(rig_of(joint)))
    known = {"R_ohm": 1.5, "k_e_Vs_per_rad": 0.06}
    columns = Columns(rig_of(joint, columns={"current": None, drive: "drive"}, known=known))

    found = _values(sums_of(path, columns), columns)

    assert found == {name: pytest.approx(value, rel=2e-3, abs=1e-5) for name, value in expected.items()}


def test_an_unknown_inertia_is_a_column(tmp_path: Path) -> None:
    """Without J_m in the rig, the total inertia at the motor is found; gravity stays the scale."""
    joint, log = swung()
    path = write_log(tmp_path / "log.parquet", log)
    rig = rig_of(joint)
    known = {k: x for k, x in rig.known.items() if k not in {"J_m", "J_l"}}
    columns = Columns(replace(rig, known=known))
    found = _values(sums_of(path, columns), columns)

    total = joint.known["J_m"] + joint.known["mu"] ** 2 * joint.known["J_l"]
    assert found["J_m"] == pytest.approx(total, rel=0.01)
    assert found["scale"] == pytest.approx(1.0, abs=0.01)


def test_rows_that_the_rig_leaves_out_do_not_count(tmp_path: Path) -> None:
    """Rows not in use, or with the motor off, may hold any current."""
    joint, log = swung()
    off = (log["time_s"] > 10.0) & (log["time_s"] < 15.0)
    spoilt = log | {"current_A": np.where(off, 50.0, log["current_A"]), "bad": off.astype(float)}
    path = write_log(tmp_path / "log.parquet", spoilt)
    rig = rig_of(joint, columns={"use": "bad < 0.5"})

    found = _values(sums_of(path, Columns(rig)), Columns(rig))

    assert found["C_m"] == pytest.approx(joint.C_m, rel=0.1)
    assert found["offset"] == pytest.approx(0.0, abs=1e-3)


def test_the_end_of_a_batch_joins_the_next_in_all_that_a_table_has() -> None:
    """Of two tables of 40 and 30 rows, 25 rows and 30 make one of 55, in every array that has rows."""
    _, joint = one_joint()

    def table(rows: int) -> Table:
        log = {
            name: 1.0 + np.arange(rows) for name in ("time_s", "theta_m_rad", "current_A", "temperature_C")
        }
        return read_table([log], rig_of(joint))

    both = _Left.of(table(40), 0.0, 15).before(table(30))
    held = {f.name: getattr(both, f.name) for f in fields(both)}

    lengths = {name: len(x) for name, x in (held | held["channels"]).items() if isinstance(x, np.ndarray)}
    assert len(lengths) == 5 + len(both.channels)
    assert set(lengths.values()) == {55}


def test_a_drive_that_is_stuck_is_refused(tmp_path: Path) -> None:
    """A current that stays where it is says nothing of friction."""
    joint, log = swung()
    path = write_log(tmp_path / "log.parquet", log | {"current_A": np.full(len(log["time_s"]), 0.7)})

    with pytest.raises(InputError, match="repeats its value in 100% of the moving rows"):
        sums_of(path, Columns(rig_of(joint)))


def test_a_rig_that_leaves_values_open_is_refused() -> None:
    """Sums hold linear unknowns only."""
    _, joint = one_joint()

    with pytest.raises(InputError, match="theta_zero_rad is left to be estimated"):
        Columns(rig_of(joint, theta_zero_rad="estimate"))
    with pytest.raises(InputError, match="input_delay_s: expected 0"):
        Columns(rig_of(joint, input_delay_s=0.01))


def test_ten_columns_that_cancel_all_belong_to_their_dependency() -> None:
    """The corners of a regular simplex add up to zero: each has a tenth of the square of that direction."""
    corners = np.eye(10) - 0.1
    rows = np.zeros((12, 12))
    rows[:10, :10], rows[10, 10], rows[11, 11] = corners, 1.0, 1.0

    assert list(range(10)) == dependent(merged(rows))
