"""The picture of an arm for the manual: where the load of the bearings makes the friction of two links.

Run `python benchmarks/arm_figure.py` in the root of the clone; it writes docs/arm_friction.svg.
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from eccentric.emission import Choice, executed, render  # noqa: E402
from eccentric.model import arm  # noqa: E402
from eccentric.rigs import read_arm  # noqa: E402 - the root of the clone comes first

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


def main() -> None:
    """Draw both joints over both angles, at two speeds, and over both speeds."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

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
    with rc_context({"svg.hashsalt": "eccentric", "font.size": 9.0}):
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
        figure.savefig(ROOT / "docs" / "arm_friction.svg", metadata={"Date": None}, dpi=110)


if __name__ == "__main__":
    main()
