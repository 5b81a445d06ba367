"""The paper's figures 2, 4 and 5 from the emitted modules: their data as arrays, and the plots."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from eccentric.core import InputError
from eccentric.emission import load_module
from eccentric.model import load_model
from eccentric.model import vocabulary as v

if TYPE_CHECKING:
    from matplotlib.figure import Figure


# Table 1's values; figure 4's minimum requires k_e in V s/rev (see `eccentric audit`, finding 3).
K_E_CONVERTED = float(sp.Rational(v.k_e.default)) / (2 * math.pi)
MU = float(sp.Rational(v.mu.default))
# Okabe and Ito's palette for colour-blind readers.
_BLUE, _ORANGE, _GREEN, _RED = "#0072B2", "#E69F00", "#009E73", "#D55E00"


@dataclass(frozen=True)
class SteadyCurve:
    """A curve of figure 2, case C1 at constant velocity; arrays of shape (n,).

    `voltage` [V] over `omega_m` [rad/s], and `linear` [V], without F_3 and F_2.
    """

    mu: float
    omega_m: np.ndarray
    voltage: np.ndarray
    linear: np.ndarray


@dataclass(frozen=True)
class Surface:
    """Figure 4, case C2: the friction torque [N m] over link angle [rad] and velocity [rad/s], shape (m, n).

    `minimum` is (link angle, link velocity, torque) where F_N is zero.
    """

    theta_l: np.ndarray
    omega_l: np.ndarray
    torque: np.ndarray
    minimum: tuple[float, float, float]


@dataclass(frozen=True)
class Section:
    """A section through figure 4 at one link angle [rad], as in figure 5; arrays of shape (n,).

    Friction torque [N m] and normal force [N] over the link velocity [rad/s].
    """

    theta_l: float
    omega_l: np.ndarray
    torque: np.ndarray
    normal_force: np.ndarray


def steady_curves() -> tuple[SteadyCurve, ...]:
    """Figure 2: Table 1 for the gear ratios 1/5 and 1/30."""
    c1 = load_module(load_model("c1_perpendicular"))
    forwards = np.geomspace(1e-3, 250, 400)
    omega_m = np.concatenate([-forwards[::-1], forwards])
    curves = []
    for mu in (1 / 5, 1 / 30):
        parameters = c1.Parameters(mu=mu)
        f_1, f_0 = c1.polynomial(parameters)[2:]
        linear = parameters.R / parameters.k_i * (f_1 * omega_m + f_0 * np.sign(omega_m))
        curves.append(SteadyCurve(mu, omega_m, c1.voltage(omega_m, parameters=parameters), linear))
    return tuple(curves)


def friction_surface() -> Surface:
    """Figure 4: link angles in [0, 2 pi], link velocities in (0, 8 pi] rad/s."""
    c2 = load_module(load_model("c2_parallel"))
    parameters = c2.Parameters(mu=MU, k_e=K_E_CONVERTED)
    theta_l, omega_l = np.meshgrid(np.linspace(0, 2 * np.pi, 121), np.linspace(1e-6, 8 * np.pi, 161))
    critical = _critical_velocity()
    least = float(c2.friction_torque(math.pi / MU, critical / MU, parameters))
    torque = c2.friction_torque(theta_l / MU, omega_l / MU, parameters)
    return Surface(theta_l, omega_l, torque, (math.pi, critical, least))


def sections() -> tuple[Section, ...]:
    """Figure 5: link angles 0, pi/2 and pi."""
    c2 = load_module(load_model("c2_parallel"))
    parameters = c2.Parameters(mu=MU, k_e=K_E_CONVERTED)
    omega_l = np.linspace(1e-6, 8 * np.pi, 1000)
    curves = []
    for theta_l in (0.0, math.pi / 2, math.pi):
        state = (theta_l / MU, omega_l / MU, parameters)
        curves.append(Section(theta_l, omega_l, c2.friction_torque(*state), c2.normal_force(*state)))
    return tuple(curves)


def _critical_velocity() -> float:
    """Link velocity [rad/s] at which F_N vanishes at the top, at Table 1's values."""
    model = load_model("c2_parallel")
    table = {q.symbol: q.default for q in model.parameters if q.default is not None}
    return float(model.equation("critical_velocity").right.subs(table))


def draw(out: Path) -> list[Path]:
    """Draw figures 2, 4 and 5 as PNG and SVG into an existing folder.

    Returns:
        The files written.

    Raises:
        InputError: matplotlib is not installed.
    """
    try:
        import matplotlib as mpl
    except ModuleNotFoundError:
        raise InputError("figures", problem="matplotlib is required: pip install matplotlib") from None
    paths = []
    # Reproducible bytes: SVG ids from a fixed salt, no date.
    with mpl.rc_context({"svg.hashsalt": "eccentric", "font.size": 10, "axes.grid": True, "grid.alpha": 0.3}):
        for name, figure in (("figure_2", figure_2()), ("figure_4", figure_4()), ("figure_5", figure_5())):
            for suffix, metadata in ((".png", {}), (".svg", {"Date": None})):
                path = out / f"{name}{suffix}"
                figure.savefig(path, dpi=150, metadata=metadata)
                paths.append(path)
    return paths


def _new(width: float, height: float) -> Figure:
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def figure_2() -> Figure:
    """Plot case C1: steady-state motor velocity over armature voltage for two gear ratios."""
    figure = _new(7, 4.5)
    axes = figure.subplots()
    for curve, colour in zip(steady_curves(), (_BLUE, _ORANGE), strict=True):
        name = f"μ = 1/{1 / curve.mu:.0f}"
        axes.plot(curve.voltage, curve.omega_m, color=colour, label=f"{name}, polynomial (11)")
        dashed = {"color": colour, "linestyle": "--", "linewidth": 1}
        axes.plot(curve.linear, curve.omega_m, label=f"{name}, without F_3 and F_2", **dashed)
    axes.set(
        xlabel="armature voltage u [V]",
        ylabel="motor velocity ω_m [rad/s]",
        xlim=(-150, 150),
        ylim=(-250, 250),
    )
    axes.set_title("Figure 2. C1: velocity over voltage in the steady state")
    axes.legend()
    return figure


def figure_4() -> Figure:
    """Plot case C2: the friction torque over link angle and velocity, its minimum marked."""
    shown = friction_surface()
    theta_l, omega_l, torque = shown.theta_l, shown.omega_l, shown.torque
    top, critical, least = shown.minimum
    figure = _new(10.5, 4.8)
    surface = figure.add_subplot(1, 2, 1, projection="3d")
    surface.plot_surface(
        theta_l, omega_l, torque, cmap="viridis", rstride=3, cstride=3, linewidth=0.2, edgecolor="0.4"
    )
    surface.plot([top] * 2, [critical] * 2, [least, torque.max()], color=_RED, linewidth=1.5, zorder=10)
    surface.set(xlabel="link angle θ_l [rad]", ylabel="link velocity ω_l [rad/s]", zlabel="F [N m]")
    surface.set_box_aspect(None, zoom=0.85)
    surface.view_init(elev=28, azim=-128)
    level = figure.add_subplot(1, 2, 2)
    # Contour levels are denser near the minimum, which would otherwise be one flat area.
    levels = least + (torque.max() - least) * np.linspace(0, 1, 25) ** 2
    contours = level.contourf(theta_l, omega_l, torque, levels=levels, norm="log", cmap="viridis")
    figure.colorbar(contours, ax=level, label="friction torque F [N m]", format="%.2f")
    level.plot(top, critical, marker="x", color=_RED, markersize=10, markeredgewidth=2)
    level.annotate(
        f"minimum: {least:.4f} N m at\n({critical:.2f} rad/s, π)", (top, critical), (3.6, 7.9), color="white"
    )
    level.set(xlabel="link angle θ_l [rad]", ylabel="link velocity ω_l [rad/s]")
    figure.suptitle("Figure 4. C2: friction torque F (18), μ = 1/5, k_e = 0.20 V s/rev")
    return figure


def figure_5() -> Figure:
    """Plot case C2: friction torque and normal force over the link velocity at three link angles."""
    figure = _new(10, 4.2)
    left, right = figure.subplots(1, 2)
    for shown, colour, angle in zip(sections(), (_BLUE, _ORANGE, _GREEN), ("0", "π/2", "π"), strict=True):
        left.plot(shown.omega_l, shown.torque, color=colour, label=f"θ_l = {angle}")
        right.plot(shown.omega_l, shown.normal_force, color=colour, label=f"θ_l = {angle}")
    critical = _critical_velocity()
    right.annotate(f"{critical:.2f} rad/s, π", (critical, 0), (10, -0.5), arrowprops={"arrowstyle": "->"})
    left.set(xlabel="link velocity ω_l [rad/s]", ylabel="friction torque F [N m]")
    right.set(xlabel="link velocity ω_l [rad/s]", ylabel="normal force F_N [N]", ylim=(-3, None))
    left.legend()
    right.legend()
    figure.suptitle(
        "Figure 5. C2: friction torque (18) and normal force (17) at three link angles,"
        " μ = 1/5, k_e = 0.20 V s/rev"
    )
    return figure
