"""The pictures of the manual that are drawn from the emitted code.

Run `python benchmarks/manual_figures.py [PICTURE ...]` in the root of the clone; it writes docs/PICTURE.svg.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from benchmarks import loops  # noqa: E402 - the root of the clone comes first
from benchmarks.rest import DT, HELD_S, STILL, ways  # noqa: E402
from eccentric.emission import Choice, executed, render  # noqa: E402
from eccentric.model import arm  # noqa: E402
from eccentric.rigs import read_arm  # noqa: E402
from generated import c2_parallel  # noqa: E402
from tests.learning import SAMPLES, learned  # noqa: E402

BLUE, ORANGE, GREY = "#0072b2", "#d55e00", "#8a8a8a"

# Friction as it was, and as the learning firmware learned it.


def adapted() -> Figure:
    """Run the drive on this computer and draw it."""
    with tempfile.TemporaryDirectory() as folder:
        _, rows, python = learned(Path(folder))
    # Between two swings nothing is drawn: each swing is a point in time.
    rows = rows[np.append(np.diff(rows["sample"]) > 1000, True)]
    hours = rows["sample"] * 1e-3 / 3600
    mu = python.model.Parameters().mu
    force = float(python.model.normal_force(0.0, 20.0))
    column = np.array([force * mu**2 * 20.0, force * mu, 20.0, 1.0])
    emitted = np.asarray(python.model.friction_coefficients())
    shown = [
        ("friction at 20 rad/s\n[N m]", rows["real"] @ column, rows["learned"] @ column, emitted @ column),
        *(
            (f"{name}\n[{unit}]", rows["real"][:, k], rows["learned"][:, k], emitted[k])
            for k, (name, unit) in enumerate(zip(python.COEFFICIENTS[:2], python.UNITS[:2], strict=True))
        ),
    ]
    figure = Figure(figsize=(8.0, 5.6), layout="constrained")
    axes = figure.subplots(3, 1, sharex=True)
    for ax, (label, real, found, start) in zip(axes, shown, strict=True):
        ax.plot(hours, found, color=BLUE, linewidth=0.9, label="learned")
        ax.plot(hours, real, color=ORANGE, linewidth=1.4, label="true")
        ax.axhline(start, color=GREY, linestyle=":", label="as emitted")
        ax.axvline(SAMPLES * 1e-3 / 3600, color="#000000", linewidth=0.6)
        ax.set_ylabel(label)
    axes[0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, frameon=False)
    axes[0].annotate(
        "Coulomb friction +20 %", (SAMPLES * 1e-3 / 3600, 1.0), xycoords=("data", "axes fraction"),
        ha="right", va="bottom",
    )  # fmt: skip
    axes[-1].set_xlabel("time [h], the drive at rest for nine tenths of it")
    return figure


# Where the load of the bearings makes the friction of two links.


FUNCTIONS = ("mechanical_friction_torque", "bearing_loads")
FRICTION = {
    "B_m_0": 2e-4, "C_m_0": 0.012, "B_lN_0": 1e-3, "C_lN_0": 5e-3,
    "B_m_1": 1e-4, "C_m_1": 0.008, "B_lN_1": 1e-3, "C_lN_1": 5e-3,
}  # fmt: skip
"""Plausible values for the shipped arm: bearings of 5 mm times a coefficient of friction."""
POINTS, FASTEST = 181, 12.0
ENOUGH = 0.1
"""Deviation of the linear model that counts as enough."""


def module_of() -> tuple[ModuleType, np.ndarray]:
    """The emitted functions of the shipped arm, and its gear ratios."""
    chain = read_arm(ROOT / "examples" / "arms" / "planar_2r.toml")
    files = render(arm(chain, "An arm"), "", "", ("numpy",), choice=Choice(FUNCTIONS, "none"))
    return executed(files, chain.name), np.array([float(joint.mu) for joint in chain.joints])


def deviations(module: ModuleType, mu: np.ndarray, angles: np.ndarray, speeds: np.ndarray) -> np.ndarray:
    """Friction against the best Coulomb and viscous friction over all of the motions, relative; (..., 2)."""
    theta, omega = angles / mu, speeds / mu
    friction = module.mechanical_friction_torque(theta, omega, 0.0 * omega, module.Parameters(**FRICTION))
    found = np.empty_like(friction)
    for j in range(2):
        columns = np.stack([omega[..., j], np.sign(omega[..., j])], axis=-1)
        moving = np.abs(omega[..., j]) > 0
        linear = columns @ np.linalg.lstsq(columns[moving], friction[..., j][moving], rcond=None)[0]
        found[..., j] = np.abs(linear - friction[..., j]) / np.abs(friction[..., j])
    return found


def arm_friction() -> Figure:
    """Draw both joints over both angles, at two speeds, and over both speeds."""
    module, mu = module_of()
    turn = np.linspace(-np.pi, np.pi, POINTS)
    speed = np.linspace(-FASTEST, FASTEST, POINTS + 1)  # an even number: no motion is at rest
    first, second = np.meshgrid(turn, turn, indexing="ij")
    angles = np.stack([first, second], axis=-1)
    fast, faster = np.meshgrid(speed, speed, indexing="ij")
    speeds = np.stack([fast, faster], axis=-1)
    hanging, slow = np.zeros_like(speeds), np.full_like(angles, 0.5)
    quick = np.full_like(angles, FASTEST)
    # The linear model of a column is fitted to what the arm does in it: all angles at one speed, or all speeds.
    columns = (
        ("over both angles, 0.5 rad/s", turn, "angle", deviations(module, mu, angles, slow)),
        (f"over both angles, {FASTEST:g} rad/s", turn, "angle", deviations(module, mu, angles, quick)),
        ("over both speeds, hanging down", speed, "speed", deviations(module, mu, hanging, speeds)),
    )
    figure = Figure(figsize=(9.0, 5.6), layout="constrained")
    axes, image = figure.subplots(2, 3), None
    for k, (title, along, what, found) in enumerate(columns):
        for j, joint in enumerate(("shoulder", "elbow")):
            ax, shown = axes[j, k], 100 * found[..., j].T
            image = ax.pcolormesh(along, along, shown, vmin=0, vmax=60, cmap="cividis", rasterized=True)
            if shown.min() < 100 * ENOUGH < shown.max():
                ax.contour(along, along, shown, [100 * ENOUGH], colors="white", linewidths=0.9)
            unit = "rad" if what == "angle" else "rad/s"
            ax.set_xlabel(f"{what} of the shoulder [{unit}]")
            ax.set_ylabel(f"{what} of the elbow [{unit}]")
            ax.set_title(f"friction of the {joint}\n{title}", fontsize=9.0)
            ax.set_aspect("equal")
    assert image is not None
    bar = figure.colorbar(image, ax=axes, extend="max", shrink=0.8)
    bar.set_label("deviation of Coulomb + viscous friction [%]; white line: 10 %")
    return figure


# The torque at rest, and the tracking error of a sine, by law.


_DRIVE, _SECONDS = 2, 5.0
"""A drive whose static friction is kinetic friction and that does not preslide."""
_SHOWN = {
    "sign of the measured velocity": ORANGE,
    "tanh(w/3) of the measured velocity": GREY,
    loops.OURS: BLUE,
}


def in_the_loop() -> Figure:
    """Run a few drives, and draw one of them."""
    d = loops.Drives(8)
    with tempfile.TemporaryDirectory() as place:
        laws = loops.by_hand(d) | {loops.OURS: loops.emitted(d, Path(place), loops.REFERENCE, loops.NO_PUSH)}
        laws = {name: laws[name] for name in _SHOWN}
        angles, torques = loops.run(d, laws, _SECONDS, integral=True)
    wanted = loops.references(_SECONDS)[0]
    t = np.arange(len(wanted)) * loops.TICK
    figure = Figure(figsize=(8.0, 4.6), layout="constrained")
    above, below = figure.subplots(2, 1)
    for k, (name, colour) in enumerate(_SHOWN.items()):
        rest = (t >= 4.0) & (t < 4.2)
        above.plot(
            t[rest], 1e3 * torques[rest, k, loops.HOLD, _DRIVE], color=colour, linewidth=0.9, label=name
        )
        moving = (t >= 2.0) & (t < 4.0)
        error = 1e3 * (angles[:, k, loops.SINE, _DRIVE] - wanted[:, loops.SINE])
        below.plot(t[moving], error[moving], color=colour, linewidth=1.1)
    above.set_ylabel("torque at rest [mN m]")
    below.set_ylabel("error of a sine\nof 3 rad/s [mrad]")
    below.set_xlabel("time [s]")
    figure.legend(loc="outside upper left", ncols=3, frameon=False)
    return figure


# What should stand still, and a link that swings down.


_FALLS, _UNTIL_S = 2.1, 1.2


def _path(
    step: Callable[[float, float], float], theta_l: float, until: float
) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and link angles [rad] of a drive that starts at rest."""
    mu = c2_parallel.Parameters().mu
    theta_m, omega_m, angles = theta_l / mu, 0.0, [theta_l]
    for _ in range(round(until / DT)):
        omega_m = step(theta_m, omega_m)
        theta_m += DT * omega_m
        angles.append(mu * theta_m)
    return DT * np.arange(len(angles)), np.array(angles)


def rest() -> Figure:
    """Integrate and draw."""
    steps = ways()
    figure = Figure(figsize=(8.0, 3.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    drawn = zip(steps.items(), (BLUE, ORANGE, GREY), ("-", "-", "--"), strict=False)
    for (name, step), colour, line in drawn:
        t, angle = _path(step, STILL, HELD_S)
        left.plot(t, (STILL - angle) * 1e3, color=colour, linestyle=line, label=name.replace("`", ""))
    left.set(xlabel="time [s]", ylabel="creep of a link at rest [mrad]")
    left.legend(frameon=False, loc="upper left", fontsize=8.0)
    t, angle = _path(next(iter(steps.values())), _FALLS, _UNTIL_S)
    right.plot(t, angle, color=BLUE)
    right.axhline(0.0, color="#bbbbbb", linewidth=0.6)
    right.set(xlabel="time [s]", ylabel="link angle [rad]")
    stop = int(np.flatnonzero(np.diff(angle))[-1]) + 1
    right.annotate(
        f"at rest, {angle[stop]:.3f} rad", (t[stop], angle[stop]), (0.35, -0.9), textcoords="data",
        arrowprops={"arrowstyle": "-", "color": "#8a8a8a"},
    )  # fmt: skip
    right.set_ylim(-1.2, None)
    return figure


PICTURES: tuple[Callable[[], Figure], ...] = (adapted, arm_friction, in_the_loop, rest)


def main(names: list[str]) -> None:
    """Draw the pictures of these names, or all."""
    for picture in PICTURES:
        if names and picture.__name__ not in names:
            continue
        with rc_context({"svg.hashsalt": "eccentric", "font.size": 9.0}):
            figure = picture()
            for ax in figure.axes if picture is not arm_friction else ():
                ax.spines[["top", "right"]].set_visible(False)
            path = ROOT / "docs" / f"{picture.__name__}.svg"
            figure.savefig(path, metadata={"Date": None}, dpi=110 if picture is arm_friction else 100)


if __name__ == "__main__":
    main(sys.argv[1:])
