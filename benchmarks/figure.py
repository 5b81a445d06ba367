"""The figure of the page: speed against array size, error against distance from the zero of F_N."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from benchmarks import forms
from tests import accuracy, oracle
from tests.emitted import module

Curves = Mapping[str, tuple[list[float], list[float]]]
# Text stays text: otherwise outlines of letters would be most of the file.
_STYLE: dict[Any, str] = {"svg.hashsalt": "eccentric", "svg.fonttype": "none", "font.family": "sans-serif"}


def draw(speed: Curves, path: Path) -> None:
    """Write the figure.

    Args:
        speed: name -> (elements, ns an element).
        path: of the SVG.
    """
    with mpl.rc_context(_STYLE):
        drawing, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
        for axes, curves, marker in ((left, speed, "o-"), (right, near_the_zero(), "-")):
            for name, (x, y) in curves.items():
                axes.loglog(x, y, marker, label=name)
            axes.minorticks_off()
            axes.legend(fontsize="small")
        left.set(xlabel="elements", ylabel="ns an element", title="friction torque, double, one core")
        right.set(
            xlabel="distance from the zero of F_N [rad, rad/s]",
            ylabel="worst error of F_N [ULP]",
            title="single precision",
        )
        drawing.savefig(path, metadata={"Date": None, "Creator": None})
        plt.close(drawing)
    # One path on one line.
    path.write_text(path.read_text(encoding="utf-8").replace(" \n", " "), encoding="utf-8")


def near_the_zero() -> Curves:
    """Form -> (distance, worst error of F_N in float): the emitted one and the paper's as it is printed."""
    decimals = accuracy.decimals()
    values = {letter: float(value) for letter, value in vars(decimals).items()}
    binary = oracle.exact(values)
    top = np.pi / values["mu"]
    fastest = (
        np.sqrt((values["M"] + values["M_l"]) * values["g"] / (values["M"] * values["L"])) / values["mu"]
    )
    distances, generator = np.logspace(-6, 1, 29), np.random.default_rng(2)
    worst: dict[str, list[float]] = {"emitted": [], "the paper's (16)": []}
    for distance in distances:
        turn = generator.uniform(0, 2 * np.pi, 100)
        theta = (top + distance * np.cos(turn)).astype(np.float32)
        omega = (fastest + distance * np.sin(turn)).astype(np.float32)
        exact = accuracy.normal_force("c2_parallel", accuracy.Set("", theta, omega), binary)
        emitted = np.asarray(module("c2_parallel").normal_force(theta, omega))
        printed = forms.normal_forces(theta, omega, SimpleNamespace(**values))["paper"]
        for name, value in zip(worst, (emitted, printed), strict=True):
            worst[name].append(float(np.nanmax(accuracy.units(value, exact))))
    return {name: (distances.tolist(), errors) for name, errors in worst.items()}
