"""Pictures of docs/measured-rigs.md, rig by rig: small SVG files on white."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from scipy.signal import lombscargle

from benchmarks.measured_plot import AFTER, BEFORE, INK, PALE, STYLE, band, friction, over_speed, pair
from eccentric.diagnosis import Diagnosis
from eccentric.identification import Refit, refit, residual_samples

RPM = 30.0 / np.pi
COPPER = 0.39
"""Rise of copper's resistance, % per kelvin."""


def draw(name: str, found: Diagnosis, folder: Path) -> None:
    """Draw the pictures of one rig as folder/name_*.svg."""
    folder.mkdir(exist_ok=True)
    for what, make in PICTURES[name].items():
        with mpl.rc_context(STYLE):
            make(found).savefig(folder / f"{name}_{what}.svg", facecolor="white", metadata={"Date": None})


def servo_residual(found: Diagnosis) -> Figure:
    """Left: held-out residual over the load of the gear. Right: the resistance that each run seems to have."""
    figure = Figure((7.2, 3.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    rows, c = found.rows, found.channels
    speed = rows.mean(c.motion.omega_m)
    j_l = found.models.extended.values["J_l"]
    load = np.abs(rows.mean(found.data.gravity + j_l * c.motion.alpha_m))
    edges = np.linspace(0.0, np.quantile(load, 0.995), 13)
    for fit, label, colour, line in pair(found):
        against = 1e3 * fit.residuals["mechanical"] * _factor(fit, found) * np.sign(speed)
        band(left, load[rows.score], against[rows.score], edges, label, colour, line)
    left.axhline(0.0, color=PALE, linewidth=0.8, zorder=0)
    left.set(xlabel="torque that the gear transmits [N m]", ylabel="held-out residual [mN m]")
    left.legend(loc="upper left")
    effect, own = next((e, v) for e, v in found.models.extended.effects if e.balance == "mechanical")
    shape = {s.quantity.name: own[s.quantity.name] for s in effect.shapes}
    load_only = refit(found.models.base, ((effect, shape),), found.data)
    _resistance(right, found, load_only)
    return figure


def _factor(fit: Refit, found: Diagnosis) -> float:
    """To the torque scale of the extended model."""
    return (fit.scale or 1.0) / (found.models.extended.scale or 1.0)


def _resistance(axes: Axes, found: Diagnosis, fit: Refit) -> None:
    """The change of resistance that each run's residual indicates, over its temperature, marked by gain."""
    rows, c = found.rows, found.channels
    off = rows.mean(c.motor.off.astype(float)) > 0.0
    torque, warm = (
        rows.mean(fit.data.drive.torque(fit.values, fit.scale)),
        rows.mean(np.asarray(c.temperature)),
    )
    rises, temperatures, weights = [], [], []
    for run, name in enumerate(c.time.run_names):
        own = (rows.run == run) & ~off
        if not own.any():
            continue
        modelled = (torque - fit.residuals["mechanical"])[own]
        rises.append(100.0 * float(modelled @ fit.residuals["mechanical"][own] / (modelled @ modelled)))
        temperatures.append(float(warm[own].mean()))
        weights.append(float(modelled @ modelled))
        kp = name.rsplit("_kp", 1)[1]
        seen = "none" if rows.score[own].any() else AFTER
        axes.plot(temperatures[-1], rises[-1], MARKERS[kp], color=AFTER, markerfacecolor=seen)
    t = np.array(temperatures)
    at = np.array([t.min(), t.max()])
    middle, level = np.average(t, weights=weights), np.average(rises, weights=weights)
    slope = 100.0 * found.models.extended.values["resistance_alpha"]
    axes.plot(at, level + slope * (at - middle), "-", color=INK, linewidth=1.2)
    axes.plot(at, level + COPPER * (at - middle), ":", color=INK, linewidth=1.2)
    axes.text(at[1], level + slope * (at[1] - middle), f"{slope:.1f} %/K ", ha="right", va="bottom")
    axes.text(at[1], level + COPPER * (at[1] - middle), "copper ", ha="right", va="bottom")
    axes.set(
        xlabel="temperature register, mean of the run [degC]", ylabel="resistance the run seems to have [%]"
    )
    marks = [
        Line2D([], [], color=AFTER, marker=mark, linestyle="none", label=kp) for kp, mark in MARKERS.items()
    ]
    axes.legend(handles=marks, title="firmware gain\n(hollow: held out)", loc="lower right")


MARKERS = {"100": "o", "200": "s", "400": "^", "800": "D"}


def servo_free(found: Diagnosis) -> Figure:
    """The held-out free swing: angle, and the friction that slows it."""
    rows, c = found.rows, found.channels
    off = rows.mean(c.motor.off.astype(float)) > 0.0
    shown = off & rows.score
    run = int(rows.run[shown][0])
    start = float(c.time.t[c.motor.off & (c.time.run == run)][0])
    figure = Figure((7.2, 3.6), layout="constrained")
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(1, 1.6))
    samples = (c.time.run == run) & c.motor.off
    top.plot(c.time.t[samples] - start, np.degrees(c.motion.theta_m[samples]), color=INK)
    top.set(ylabel="angle [deg]", title=f"{c.time.run_names[run]}, motor switched off at 0 s")
    t = rows.t[shown] - start
    bottom.plot(
        t, 1e3 * friction(found.models.extended)[shown], ".", color=INK, label="measured: -J dw/dt - G"
    )
    for fit, label, colour, line in pair(found):
        predicted = friction(fit) - fit.residuals["mechanical"]
        pieces = np.flatnonzero(np.diff(t) > 0.06)
        gapped = np.insert(1e3 * predicted[shown], pieces + 1, np.nan)
        bottom.plot(np.insert(t, pieces + 1, np.nan), gapped, line, color=colour, label=label)
    bottom.axhline(0.0, color=PALE, linewidth=0.8, zorder=0)
    bottom.set(xlabel="time [s]", ylabel="friction torque [mN m]", xlim=(0.0, t.max() + 0.3))
    figure.legend(ncols=3, loc="outside lower center")
    return figure


def screw_speed(found: Diagnosis) -> Figure:
    """Mean torque of each run against the motion, over the speed, for both directions; what is left below."""
    rows = found.rows
    speed = rows.mean(found.channels.motion.omega_m)
    torque = 1e3 * rows.mean(found.data.drive.signal())
    figure = Figure((7.2, 4.0), layout="constrained")
    grid = figure.subplots(2, 2, sharex=True, sharey="row", height_ratios=(1.6, 1))
    for k, (sign, title) in enumerate(((1.0, "forwards"), (-1.0, "backwards"))):
        own = np.flatnonzero(np.sign(speed) == sign)
        own = own[np.argsort(np.abs(speed[own]))]
        top, bottom = grid[0, k], grid[1, k]
        rpm = np.abs(speed[own]) * RPM
        top.plot(rpm, sign * torque[own], "o", color=INK, markersize=4, label="mean of a run")
        for fit, label, colour, line in pair(found, "Coulomb + viscous + load"):
            left = 1e3 * fit.residuals["mechanical"][own]
            top.plot(rpm, sign * (torque[own] - left), line, color=colour, label=label)
            mark = "s" if colour == BEFORE else "o"
            bottom.plot(rpm, sign * left, mark + line, color=colour, markersize=3, linewidth=0.8)
        held = rows.score[own]
        top.plot(
            rpm[held],
            sign * torque[own][held],
            "o",
            color=INK,
            markersize=9,
            fillstyle="none",
            label="held out",
        )
        bottom.axhline(0.0, color=PALE, linewidth=0.8, zorder=0)
        top.set(title=title, xscale="log")
        bottom.set_xlabel("speed of the input [rpm]")
    grid[0, 0].set_ylabel("torque against the motion [mN m]")
    grid[1, 0].set_ylabel("residual [mN m]")
    grid[0, 1].legend(loc="best")
    return figure


def screw_orders(found: Diagnosis) -> Figure:
    """Spectrum over the angle of every run, stacked by speed, and their mean."""
    c, residual = found.channels, residual_samples(found.models.extended)
    order = np.arange(0.5, 6.0, 0.02)
    speeds, spectra = [], []
    for run in range(len(c.time.run_names)):
        own = np.flatnonzero(c.selection.usable & (c.time.run == run))
        if len(own) < 100 or abs(np.ptp(c.motion.theta_m[own])) < 4.0 * np.pi:
            continue
        t = np.linspace(-1.0, 1.0, len(own))
        slow = np.column_stack([np.ones_like(t), t, t**2, c.motion.omega_m[own]])
        rest = residual[own] - slow @ np.linalg.lstsq(slow, residual[own], rcond=None)[0]
        # Beyond half the samples per turn, a spectrum shows only aliases.
        per_turn = len(own) / (np.ptp(c.motion.theta_m[own]) / (2.0 * np.pi))
        power = lombscargle(c.motion.theta_m[own], rest, order, normalize=True)
        spectra.append(np.where(order < 0.5 * per_turn, power, np.nan))
        speeds.append(float(c.motion.omega_m[own].mean()) * RPM)
    place = np.argsort(speeds)
    stack, rpm = np.array(spectra)[place], np.array(speeds)[place]
    figure = Figure((7.2, 4.4), layout="constrained")
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(1, 2.6))
    top.plot(order, 100.0 * np.nanmean(stack, axis=0), color=AFTER, linewidth=1.2)
    top.set(ylabel="mean share of\nthe variance [%]")
    image = bottom.imshow(
        100.0 * stack,
        extent=(order[0], order[-1], len(rpm) - 0.5, -0.5),
        aspect="auto",
        cmap="cividis",
        vmin=0.0,
        interpolation="nearest",
    )
    ticks = np.arange(0, len(rpm), 3)
    bottom.set_yticks(ticks, [f"{rpm[k]:.0f}" for k in ticks])
    bottom.set(xlabel="cycles per turn of the input", ylabel="speed of the run [rpm]", xticks=range(1, 7))
    figure.colorbar(image, ax=bottom, label="share [%]", aspect=15)
    return figure


def disc(found: Diagnosis) -> Figure:
    """Left: friction in volts over the speed. Right: what is left over the link angle, both directions."""
    rows, fit = found.rows, found.models.linear
    volts = fit.scale or 1.0
    speed, angle = rows.mean(found.channels.motion.omega_m), rows.mean(found.channels.motion.theta_m)
    left = fit.residuals["mechanical"] * volts
    figure = Figure((7.2, 3.0), layout="constrained")
    one, two = figure.subplots(1, 2)
    own = rows.score
    over_speed(one, speed[own], friction(fit)[own] * volts, left[own], np.linspace(-16, 16, 33))
    one.set(xlabel="speed [rad/s]", ylabel="friction and back-EMF [V], held out")
    edges = np.linspace(-1.0, 1.0, 21)
    for sign, label, colour, line in ((1, "forwards", AFTER, "-"), (-1, "backwards", BEFORE, "--")):
        own = rows.score & (np.sign(speed) == sign)
        band(two, angle[own], 1e3 * left[own], edges, label, colour, line)
    two.axhline(0.0, color=PALE, linewidth=0.8, zorder=0)
    two.set(xlabel="link angle [rad]", ylabel="held-out residual [mV]")
    two.legend(loc="upper center", ncols=2)
    return figure


def direct(found: Diagnosis) -> Figure:
    """Left: friction over the speed. Right: what is left over the speed, and the noise of the sensor."""
    rows, fit = found.rows, found.models.linear
    speed, left = rows.mean(found.channels.motion.omega_m), fit.residuals["mechanical"]
    figure = Figure((7.2, 3.0), layout="constrained")
    one, two = figure.subplots(1, 2)
    over_speed(one, speed, friction(fit), left, np.linspace(-10, 10, 21))
    one.set(xlabel="speed [rad/s]", ylabel="friction torque [N m]")
    two.axhspan(
        -found.noise_floor, found.noise_floor, color=PALE, alpha=0.5, linewidth=0, label="noise of the sensor"
    )
    for part, label, colour, mark in (
        (rows.train, "fitted", AFTER, "o"),
        (rows.score, "held out", BEFORE, "x"),
    ):
        two.plot(speed[part], left[part], mark, color=colour, markersize=3, label=label)
    two.set(xlabel="speed [rad/s]", ylabel="residual [N m]")
    figure.legend(*two.get_legend_handles_labels(), loc="outside lower right", ncols=3)
    return figure


_SCREW = {"speed": screw_speed, "orders": screw_orders}
PICTURES = {
    "bam_xl330_pendulum": {"residual": servo_residual, "free": servo_free},
    "tro2021_drive1": _SCREW,
    "tro2021_drive3": _SCREW,
    "tue_unbalanced_disc": {"friction": disc},
    "dfki_ak80_pendulum": {"friction": direct},
}
