"""The data-quality table of the report: rows, sampling, gaps, delay, zero angle, noise."""

from __future__ import annotations

import numpy as np

from eccentric.diagnosis import Diagnosis
from eccentric.report.data import Fact
from eccentric.report.text import range_of

__all__ = ["facts_of"]


def facts_of(found: Diagnosis) -> list[Fact]:
    """Facts about the log, in the order of the table."""
    channels, counts = found.channels, found.channels.counts
    step = np.diff(channels.time.t)[np.diff(channels.time.segment) == 0]
    usual, points = channels.time.logged_step_s, channels.time.points_per_row
    spread = (points * step.min(), points * step.max())
    uneven = f"; steps of {spread[0]:.4g} to {spread[1]:.4g} s" if np.ptp(spread) > 0.01 * usual else ""
    runs = len(channels.time.run_names)
    gaps = int(channels.time.segment[-1]) + 1 - runs
    moving = f"faster than {channels.selection.moving_threshold_rad_s:.3g} rad/s, clear of reversals and ends"
    held = "; ".join(f"{a:.4g} to {b:.4g} s" for a, b in channels.selection.holdout.intervals_s[:8])

    def aligned(name: str, field: str, unit: str, factor: float = 1.0) -> Fact:
        value = getattr(channels.alignment, field)
        if e := found.models.extended.estimates.get(field):
            return Fact(
                name, f"{e.value:.4g} {unit}", f"estimated, 95 % interval {range_of(e.interval)} {unit}"
            )
        given = "estimated" if field in found.rig.estimate else "from the rig file" if value else "none given"
        return Fact(name, f"{factor * value:.4g} {unit}", given)

    facts = [
        Fact("rows read", f"{counts['read']}", f"{runs} run{'s' * (runs > 1)}"),
        Fact("rows rejected", f"{counts['rejected']}", "with a value that is not a number"),
        Fact("rows used", f"{counts['used']}", moving),
        Fact("rows held out", f"{counts['held_out']}", held),
        Fact("errors are computed on", found.rows.description),
        Fact("sampling", f"{1.0 / usual:.4g} Hz", f"{usual:.4g} s a row{uneven}"),
        Fact("gaps in time", f"{gaps}", "no filter runs across a gap" if gaps else ""),
        Fact("drive measured by", channels.motor.measured_by),
        Fact("step of the motor angle", f"{channels.motion.quantum_rad:.3g} rad"),
        aligned("input delay", "input_delay_s", "ms", 1e3),
        *([aligned("zero angle", "theta_zero_rad", "rad")] if found.rig.axis.wraps else []),
    ]
    if channels.motor.voltage is not None:
        facts.append(aligned("voltage offset", "voltage_offset_V", "V"))
    facts += [
        Fact(
            "periodic inside runs",
            f"{o.per_turn:.2f} per motor turn",
            f"amplitude {o.amplitude:.3g} {found.unit}, {100 * o.share:.0f} % of the residual variance,"
            f" in {o.seen} of {o.stretches} stretches",
        )
        for o in found.orders
    ]
    if channels.excerpt:
        facts.insert(1, Fact("windows of a long log", f"{counts['used']} rows", channels.excerpt))
    if found.rig.added:
        facts.insert(1, Fact("added masses", found.rig.added_words))
    if words := found.asked.request.words:
        facts.insert(0, Fact("effects, as asked", words))
    noise, left = found.noise_floor, found.score.rmse["mechanical"]["extended"]
    remark = (
        f"RMS of a row; the held-out error is {left / noise:.3g} times that" if noise > 0.0 else "none seen"
    )
    return [*facts, Fact("noise of the sensors", f"{noise:.3g} {found.unit}", remark)]
