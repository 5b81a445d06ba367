"""Logs and a rig become the signals that a model is fitted on: SI units, motor side, masks, held-out part.

    logs, rig -> table (columns in SI) -> stretches without gap -> theta, w, dw/dt -> masks -> Channels

The reference residual takes w and dw/dt from the low-passed angle, current and voltage as logged.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError, counted, few
from eccentric.logs import LogSource, read_log
from eccentric.rigs import COASTING, Alignment, Rig
from eccentric.signals import limits
from eccentric.signals.converted import CONTROLLER
from eccentric.signals.filters import joined, motion_of, rows_of_each, span_velocity, stretches, suited
from eccentric.signals.measured import (
    Channels,
    Controlled,
    Intake,
    MeasuredMotion,
    Motor,
    Selection,
    TimeBase,
)
from eccentric.signals.motion import (
    clear_of_ends,
    motor_side,
    moving_rows,
    near_switching,
    of_the_motor,
    quantum_of,
    standing_lines,
    uneven,
)
from eccentric.signals.quality import assess
from eccentric.signals.rows import LATER, SampledCurrent, at_times, evidence, refined, sampled_current
from eccentric.signals.sampling import windows_by_parts
from eccentric.signals.table import Holdout, Table, hold_out, read_table

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence


Array = NDArray[np.float64]


def logged_step(table: Table) -> float:
    """The usual time between rows [s]."""
    t = table.channels["time"]
    together = np.diff(stretches(t, table.run)) == 0
    return float(np.median(np.diff(t)[together])) if np.any(together) else 0.0


def is_coarse(table: Table, rig: Rig) -> bool:
    """Whether most of the log is too coarse for the rig's low pass, and the rig does not average."""
    return rig.sampling.low_pass_hz * logged_step(table) > limits.COARSE and not rig.sampling.average_over


def _kinds(
    points: _Points, rig: Rig, step: float
) -> tuple[Mapping[str, str], SampledCurrent | None, list[str]]:
    """What a row's value stands for, by channel: by the rig, or as a coarse log proves; and a warning."""
    kinds, by = rig.log.kinds, _drive(points.table.channels, rig)
    by = "torque_l" if by not in points.table.channels else by
    if by in kinds or math.isinf(rig.sampling.average_over):
        return kinds, None, []
    coarse = step >= limits.COARSE_ROW_S * (1.0 - limits.ROUNDED_RATE)
    if by == "current" and "voltage" in points.table.channels and (coarse or "voltage" in kinds):
        own, current, said = _by_the_circuit(points, rig, step)
        if current is not None:
            return own, current, said
    if not coarse:
        return kinds, None, []
    more = _evidence_of_hold(points, rig, by, step)
    if more < limits.PROVED:
        return kinds, None, []
    said = [_held(rig.axis.named(by), step, more)]
    if by != "current":
        return {**kinds, by: "held"}, None, said
    k_i, k_e, inertia = rig.axis.named("k_i"), rig.axis.named("k_e"), rig.axis.term("inertia")
    said.append(
        f"the {inertia} is wrong by up to {k_i} {k_e} h/(2 R), h = {step:.3g} s, if the current falls with"
        " the speed between rows; its interval contains that only with R and k_e in [known]"
    )
    if not {"R", "k_e"} <= set(rig.known):
        return {**kinds, by: "held"}, None, said
    r, cut, when = rig.known["R"], _cut(points.table, rig), (0.5 * step, limits.ANYWHERE * step)
    return kinds, SampledCurrent(r, -rig.known["k_e"] / r, *when, True, points.segment, cut), said


def _held(name: str, step: float, more: float) -> str:
    return (
        f"the {name} is held from row to row, {step:.3g} s each: that explains the motion better than samples"
        f' do, by {more:.2g} standard errors ([kinds] {name} = "sample" overrides this)'
    )


def _by_the_circuit(
    points: _Points, rig: Rig, step: float
) -> tuple[Mapping[str, str], SampledCurrent | None, list[str]]:
    """When in its row a current was sampled, by the voltage, and warnings; None where nothing shows it."""
    kinds, said = rig.log.kinds, []
    if "voltage" not in kinds and (more := _evidence_of_hold(points, rig, "voltage", step)) >= limits.PROVED:
        kinds, said = {**kinds, "voltage": "held"}, [_held("voltage", step, more)]
    kind, table = kinds.get("voltage", "sample"), points.table
    if kind == "mean":
        return kinds, None, []
    count = max(1, round(limits.CIRCUIT_ROW_S / step))
    means = thinned(table, count) if count > 1 else table
    found = sampled_current(table, means, kind == "held", points.threshold, _cut(table, rig), step)
    if found is None or (kind == "sample" and abs(found.late_s) < limits.PROVED * found.error_s):
        return kinds, None, []
    late, error = 100.0 * found.late_s / step, 100.0 * found.error_s / step
    when = (
        f"by the circuit, the current was sampled at {late:.0f} +- {error:.2g} % of its row, which is in the"
        ' standard errors of the fit (for a current loop that holds it: [kinds] current = "held")'
    )
    return kinds, found, [*said, when]


def _cut(table: Table, rig: Rig) -> float:
    """The low pass of the angle [Hz], infinite for a log that is too coarse for one."""
    return math.inf if is_coarse(table, rig) else rig.sampling.low_pass_hz


def _evidence_of_hold(points: _Points, rig: Rig, by: str, step: float) -> float:
    """By how many standard errors a held drive explains the motion better than a sampled one."""
    tables = [refined(points.table, {**rig.log.kinds, by: kind}) for kind in ("held", "sample")]
    fine = _points(tables[0], rig, points.quantum, limits.POINTS_PER_ROW)
    clear = (
        clear_of_ends(fine.t, fine.segment)
        & fine.table.use
        & ~near_switching(fine.t, fine.segment, fine.table.motor_off)
    )
    allowed = clear & ~fine.holdout.rows & ~fine.table.motor_off
    try:
        windows = windows_by_parts(
            fine.t,
            fine.segment,
            fine.table.run,
            max(limits.STEPS * step, limits.HOLD_WINDOW_S, rig.sampling.average_over),
        )
    except InputError:
        return 0.0
    kept = windows.inside(allowed) & (
        windows.mean((fine.moving & allowed).astype(float)) >= limits.MOVING_PART
    )
    windows = windows.chosen(kept)
    if len(windows) < limits.LEAST_WINDOWS:
        return 0.0
    omega = motion_of(fine.t, fine.theta, fine.segment, math.inf)[0][1]
    columns = [np.ones_like(omega), omega, np.sign(omega)]
    if rig.case != "C1" and "mu" in rig.known:
        link = rig.known["mu"] * fine.theta
        columns += [np.sin(link), np.cos(link)]
    beside = windows.mean(np.column_stack(columns))
    held, sampled = (np.column_stack([windows.mean(x.channels[by]), beside]) for x in tables)
    return evidence(windows, windows.second_rate(fine.theta), held, sampled)


# The windows of a long log at the rate that its low pass needs: means of a few rows each.
#
# A log at 1 kHz says no more below 25 Hz than one at 250 Hz, and takes four times the work. A mean over
# four rows is a low pass of its own, the same for angle, drive and temperature: at 25 Hz it takes 1.6 %
# from all of them alike, and lets less noise through than every fourth row would.


def rows_a_point(step_s: float, rig: Rig) -> int:
    """How many rows, `step_s` apart, make a point; 1 where the log is no finer than its low pass needs."""
    if step_s <= 0.0:
        return 1
    rate = max(limits.RATE_PER_CUT * rig.sampling.low_pass_hz, limits.LEAST_RATE_HZ)
    return max(1, int(1.0 / (step_s * rate) + 1e-6))


def thinned(table: Table, count: int) -> Table:
    """The table, angle unwrapped on the motor side, as means of `count` rows each within every stretch.

    A point is wanted, and has the motor off, if all of its rows are; the rows left at the end of a stretch
    are dropped.
    """
    firsts = [
        rows[: len(rows) // count * count : count]
        for rows in rows_of_each(stretches(table.channels["time"], table.run))
    ]
    first = np.concatenate(firsts)
    members = first[:, None] + np.arange(count)

    def all_of(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
        return np.asarray(mask[members].all(axis=1), bool)

    # What was skipped or dropped before the rows that are left out here is so before the next point.
    skipped = np.diff(np.cumsum(table.after_skipped)[first], prepend=0) != 0
    dropped = table.after_dropped[members].any(axis=1)
    return dataclasses.replace(
        table,
        channels={name: x[members].mean(axis=1) for name, x in table.channels.items()},
        run=table.run[first],
        use=all_of(table.use) & (all_of(table.motor_off) | all_of(~table.motor_off)),
        motor_off=all_of(table.motor_off),
        after_dropped=dropped,
        after_skipped=skipped,
    )


Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class _Points:
    """The motor's motion on a grid of n points; the last three fields as in Channels."""

    table: Table
    per_row: int
    segment: NDArray[np.int64]
    holdout: Holdout
    moving: Mask
    quantum: float
    threshold: float

    @property
    def t(self) -> Array:
        """Time [s] (n,)."""
        return self.table.channels["time"]

    @property
    def theta(self) -> Array:
        """Angle of the motor [rad] (n,), without wraps."""
        return self.table.channels["theta_m"]


def read_channels(logs: Sequence[LogSource], rig: Rig) -> Channels:
    """Return the channels of logs under a rig, with its delay, zero angle and offset (0 where "estimate").

    Each log is a path, a table in memory or a Log.

    Raises InputError for whatever `read_log` and `table.read_table` refuse, a drive that no channel
    measures or that is 0 throughout, and a log without rows to fit on or to hold out.
    """
    read = [read_log(log) for log in logs]
    logged = read_table(read, rig)
    table, said = of_the_motor(logged, rig)
    warnings = [*rig.warnings, *said]
    quantum = quantum_of(logged, rig, table.channels["theta_m"])
    points, paths = _points(table, rig, quantum, 1), [log.path for log in read]
    _require_length(points, paths)
    given = rig
    rig, said = _suited(rig, points)
    lines = _lines(points, given, logged_step(logged))
    if lines and rig is not given:
        rig, more = _with_room_for(lines, given, rig, points, logged_step(logged))
        said = more or said
    warnings += said
    cut, doubts = rig.sampling.low_pass_hz, uneven(logged, rig.axis)
    step = logged_step(logged)
    kinds, current, said = _kinds(points, rig, step)
    warnings += said

    def read_by(how: Callable[[Table, Mapping[str, str]], Table]) -> Table:
        return how(table, kinds) if current is None else current.read(how, table, kinds)

    together = rows_a_point(step, rig) if logged.is_excerpt else 1
    if together > 1:
        points = _points(thinned(read_by(at_times), together), rig, quantum, 1)
    elif is_coarse(logged, rig):
        # The unwrapped angle is interpolated, since the wrapped one jumps; a spline needs no even steps.
        points, cut, doubts = (
            _points(read_by(refined), rig, quantum, limits.POINTS_PER_ROW),
            math.inf,
            [],
        )
    elif kinds or current:
        points = dataclasses.replace(points, table=read_by(at_times))
    motion, said = motion_of(points.t, points.theta, points.segment, cut, rig.axis)
    doubts = [*said, *doubts, *_rate_doubt(step, rig)]
    channels = dataclasses.replace(_channels(points, motion, rig, step * together), lines=lines)
    if channels.controlled is not None:
        own = dataclasses.replace(channels.controlled, per_motor=_per_motor(logged, rig))
        channels = dataclasses.replace(channels, controlled=own)
    if together > 1:
        base = dataclasses.replace(channels.time, rows_per_point=together)
        channels = dataclasses.replace(channels, time=base)
    _require_rows(channels, paths, rig)
    _require_drive(channels, paths)
    channels = channels.realigned(rig, rig.alignment)
    findings = assess(logged, channels, rig)
    warnings += _without_rows(channels)
    # Missing rows come before their consequences for the filters.
    warnings += [*(finding.text for finding in findings if finding.kind != "excerpt"), *doubts]
    intake = dataclasses.replace(
        channels.intake, warnings=tuple(warnings), findings=findings, logs=tuple(paths)
    )
    return dataclasses.replace(channels, intake=intake)


def _require_length(points: _Points, paths: Sequence[str]) -> None:
    """No rows of a stretch shorter than the span of the central difference can move."""
    longest = max(float(np.ptp(points.t[rows])) for rows in rows_of_each(points.segment))
    if longest <= 2.0 * limits.HALF_SPAN_S:
        raise InputError(
            few(paths),
            f"more than {2.0 * limits.HALF_SPAN_S:g} s without a gap in time",
            f"{longest:.3g} s: is the unit of time right?",
        )


def _points(table: Table, rig: Rig, quantum: float, per_row: int) -> _Points:
    t = table.channels["time"]
    segment = stretches(t, table.run)
    holdout = hold_out(t, table.run, table.run_names, table.motor_off, rig)
    moving, threshold = moving_rows(t, table.channels["theta_m"], segment, rig, quantum, ~holdout.rows)
    return _Points(table, per_row, segment, holdout, moving, quantum, threshold)


def _suited(rig: Rig, points: _Points) -> tuple[Rig, list[str]]:
    """Return the rig, completed with settings that suit the log, and warnings about them."""
    fitted = points.moving & ~points.holdout.rows
    whole = np.bincount(points.segment, points.table.after_skipped) == 0
    rig, said = suited(rig, points.t, points.theta, points.segment, fitted, whole)
    warnings, axis = [said] if said else [], rig.axis
    if math.isinf(rig.sampling.average_over) and not {"J_m", "J_l"} <= set(rig.known):
        # The small acceleration of a constant speed would absorb anything that the friction lacks.
        rig = dataclasses.replace(rig, known={"J_m": 0.0, "J_l": 0.0, **rig.known})
        warnings.append(
            f"means of runs cannot identify an {axis.term('inertia')}: {axis.named('J_m')} and"
            f" {axis.named('J_l')}"
            " are taken as 0 unless the rig file gives them"
        )
    return rig, warnings


def _lines(points: _Points, rig: Rig, step: float) -> tuple[int, ...]:
    """The orders beyond the usual ones that stand out of the drive; none where angles have no common zero."""
    by = _drive(points.table.channels, rig)
    drive = motor_side(points.table, rig, by, f"{by}_l")
    t, theta, segment = points.t, points.theta, points.segment
    if drive is None or not rig.axis.wraps or not step or (points.quantum == 0.0 and points.table.run[-1]):
        return ()
    rows = np.flatnonzero(points.moving & points.table.use & ~points.table.motor_off & ~points.holdout.rows)
    speed = joined(segment, lambda rows: span_velocity(t[rows], theta[rows]))
    return standing_lines(theta[rows], speed[rows], drive[rows], step, rig.known.get("mu"))


def _with_room_for(
    lines: tuple[int, ...], given: Rig, rig: Rig, points: _Points, step: float
) -> tuple[Rig, list[str]]:
    """The rig with a low pass above the lines, where that of the log would take them; and a warning."""
    if math.isinf(rig.sampling.average_over):
        return rig, []
    speed = joined(points.segment, lambda rows: span_velocity(points.t[rows], points.theta[rows]))
    often = np.abs(speed[points.moving]) * lines[0] / (2.0 * math.pi)
    low, high = np.quantile(often, (0.5, 0.9))
    if rig.sampling.low_pass_hz > low and not rig.sampling.average_over:
        return rig, []
    cut, noisy = (
        max(given.sampling.low_pass_hz, min(limits.LINE_MARGIN * high, limits.RAISED / step)),
        given.axis.term("angle"),
    )
    said = (
        f"a ripple of {lines[0]} per turn stands out of the drive: the low-pass filter is set to {cut:.3g} Hz"
        f"{f', though the {noisy} is noisy there' if rig.sampling.average_over else ''}"
        " (low_pass_hz and average_over in the rig file override this)"
    )
    return dataclasses.replace(given, sampling=dataclasses.replace(given.sampling, low_pass_hz=cut)), [said]


def _channels(points: _Points, motion: Array, rig: Rig, step: float) -> Channels:
    """The channels before alignment, still without warnings and findings."""
    table, t, segment = points.table, points.t, points.segment
    clear = clear_of_ends(t, segment) & ~near_switching(t, segment, table.motor_off)
    wanted = table.use
    if coasting := rig.log.drive == COASTING:
        past = past_the_peak(motion[1], segment)
        clear, wanted = clear & past, wanted & past
    return Channels(
        time=TimeBase(
            t=t,
            run=table.run,
            run_names=table.run_names,
            segment=segment,
            logged_step_s=step,
            points_per_row=points.per_row,
            skipped=table.after_skipped,
        ),
        motion=MeasuredMotion(
            theta_m=motion[0],
            omega_m=motion[1],
            alpha_m=motion[2],
            theta_logged=points.theta,
            omega_logged=table.channels.get("omega_m"),
            quantum_rad=points.quantum,
        ),
        motor=Motor(
            voltage=table.channels.get("voltage"),
            voltage_logged=table.channels.get("voltage"),
            current=table.channels.get("current"),
            current_later=table.channels.get(LATER),
            torque=motor_side(table, rig, "torque", "torque_l"),
            off=table.motor_off,
            measured_by=_drive(table.channels, rig),
            coasting=coasting,
        ),
        temperature=table.channels.get("temperature"),
        selection=Selection(
            moving=points.moving,
            usable=points.moving & table.use & clear,
            holdout=points.holdout,
            moving_threshold_rad_s=points.threshold,
            wanted=wanted,
        ),
        alignment=Alignment(),
        intake=Intake(table.rows_read, table.rows_rejected),
        rig=rig,
        controlled=_controlled(table, rig),
    )


def _per_motor(logged: Table, rig: Rig) -> float:
    """The angle on the logged side for a radian of the motor."""
    sides = ("theta_m", "theta_l", "omega_m", "omega_l")
    first = next(name for name in sides if name in logged.channels)
    return rig.value("mu") if first.endswith("_l") else 1.0


def _controlled(table: Table, rig: Rig) -> Controlled | None:
    if rig.controller is None:
        return None
    named = {name.removeprefix(CONTROLLER): x for name, x in table.channels.items()}
    return Controlled({name: named[name] for name in rig.controller.columns})


def past_the_peak(omega_m: Array, segment: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Rows (n,) after the speed (n,) [rad/s] was last near the highest of their stretch.

    Something sped the drive up before, and may have held the speed for a while.
    """
    past = np.zeros(len(omega_m), dtype=bool)
    for rows in rows_of_each(segment):
        speed = np.nan_to_num(np.abs(omega_m[rows]))  # unknown at the ends
        last = int(np.flatnonzero(speed >= limits.NEAR_PEAK * np.max(speed))[-1])
        past[rows[last + 1 :]] = True
    return past


def _drive(channels: Mapping[str, Array], rig: Rig) -> str:
    """Return the channel that measures the drive torque: by the rig, else the first one available below."""
    logged = {
        "current": "current" in channels,
        "torque": "torque" in channels or "torque_l" in channels,
        "voltage": "voltage" in channels,
    }
    there = [drive for drive, is_there in logged.items() if is_there]
    if rig.log.drive in (None, COASTING):
        return there[0]
    if rig.log.drive not in there:
        raise InputError(
            f"{rig.path}: drive",
            "a channel with a column in the log",
            f"{rig.log.drive!r}",
            why=f"({', '.join(there)})",
        )
    return rig.log.drive


def _rate_doubt(step: float, rig: Rig) -> list[str]:
    declared = rig.log.sample_rate_hz
    if declared is None or not step or limits.RATE_LOW < 1.0 / step / declared < limits.RATE_HIGH:
        return []
    return [f"the rig file says {declared:g} rows per second, the log has {1.0 / step:.4g}: is time in s?"]


def _require_rows(channels: Channels, paths: Sequence[str], rig: Rig) -> None:
    where, rows, axis = few(paths), channels.selection, rig.axis
    fitted, scored = np.count_nonzero(rows.fit_rows), np.count_nonzero(rows.score_rows)
    if not fitted or not scored:
        theta = channels.motion.theta_logged
        if np.ptp(theta) == 0.0:
            raise InputError(
                where,
                f"an {axis.term('angle')} that changes",
                (
                    f"{theta[0]:.6g} {axis.unit('rad')} at the motor in all rows: the encoder"
                    f" is stuck, or a wrong"
                    " column is mapped"
                ),
            )
        raise InputError(
            where,
            f"moving rows (above {rows.moving_threshold_rad_s:.4g} {axis.unit('rad/s')} at the motor)",
            f"{fitted} and {scored} under {rig.path}: {_cause(channels, rig)}",
            why=f"to fit and to hold out ({rows.holdout.brief})",
        )


def _cause(channels: Channels, rig: Rig) -> str:
    """Why no row is left: the default that takes them and the key that changes it, before the units."""
    time, rows, theta = channels.time, channels.selection, channels.motion.theta_logged
    lasts = [float(np.ptp(time.t[own])) for own in rows_of_each(time.segment)]
    speed = np.concatenate(
        [np.abs(_speed_over(time.t[own], theta[own])) for own in rows_of_each(time.segment)]
    )
    fastest = float(np.quantile(speed, 0.95)) if len(speed) else 0.0
    axis, key = rig.axis, rig.axis.named("moving_threshold_rad_s")
    quantum = f"{channels.motion.quantum_rad:.3g} {axis.unit('rad')}"
    if rig.sampling.moving_threshold_rad_s is None and rows.moving_threshold_rad_s > 0.5 * fastest > 0.0:
        return (
            f"the threshold is a default, {limits.QUANTA:g} steps of {quantum}"
            f" in {2e3 * limits.HALF_SPAN_S:g} ms, and the drive turns at {fastest:.3g} {axis.unit('rad/s')}:"
            f" write {key} = {0.25 * fastest:.2g}"
        )
    if np.any(rows.moving) and max(lasts) < limits.END_S / limits.END_PART:
        return (
            f"the longest stretch without a gap lasts {max(lasts):.3g} s, of which"
            f" {100 * limits.END_PART:.0f} % at either end is left to the filter,"
            " and rows near a reversal do not count: record longer"
        )
    return f"are the units of time and {rig.axis.term('angle')} right?"


def _speed_over(t: Array, theta: Array) -> Array:
    """The speed [rad/s] over a time in which the steps of an encoder do not matter."""
    rows = max(1, round(limits.COMPARED_S / max(float(np.median(np.diff(t))), 1e-9))) if len(t) > 1 else 1
    return (theta[rows:] - theta[:-rows]) / (t[rows:] - t[:-rows]) if len(t) > rows else np.empty(0)


def _without_rows(channels: Channels) -> list[str]:
    """The runs of which no row is used, where there are several."""
    names = channels.time.run_names
    used = np.bincount(channels.time.run, channels.selection.usable, minlength=len(names)) > 0
    without = [name for name, has in zip(names, used, strict=True) if not has]
    if not without:
        return []
    what = f"no row of {counted(len(without), 'run')} of {len(names)} is used"
    return [f"{what}, too short or too slow: {few(without)}"]


def _require_drive(channels: Channels, paths: Sequence[str]) -> None:
    """Raise InputError for a drive that is 0 in all rows to fit, or in all held out: R^2 divides by it."""
    if channels.motor.coasting:
        return
    by, rows = channels.motor.measured_by, channels.selection
    hint = "it is not recorded, or a wrong column is mapped"
    held = f"held-out rows ({rows.holdout.brief})"
    for part, what, then in (
        (rows.usable, "rows", hint),
        (rows.fit_rows, "rows to fit", "hold out others"),
        (rows.score_rows, held, "hold out others"),
    ):
        if not np.any(channels.motor.measured[part] ** 2):
            raise InputError(few(paths), f"a {by} that drives the motor", f"0 in all moving {what}: {then}")
