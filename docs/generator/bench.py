"""The picture of the first page: residual of the bundled log before and after, over the link angle."""

from __future__ import annotations

import contextlib
import io
import json
import tempfile
from pathlib import Path
from types import ModuleType

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from eccentric import cli
from eccentric.emit import load_module
from eccentric.identify.channels import read_channels
from eccentric.identify.rig import read_rig
from eccentric.model import load_model
from generator.pictures import COLOURS, STYLE, save

BENCH = Path(__file__).parents[2] / "examples" / "bench"
LOG, RIG = BENCH / "bench.csv.gz", BENCH / "bench.toml"
STRIDE = 6
"""Of the held-out rows every so many are drawn; the mean is of all."""


def picture(path: Path) -> str:
    """Diagnose the bundled log, draw path.svg and path-dark.svg; return the sentence of the diagnosis."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "diagnosis"
        with contextlib.redirect_stdout(io.StringIO()):
            cli.main(["diagnose", str(LOG), "--rig", str(RIG), "--out", str(out)])
        sentence = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))["sentence"]
        extended = load_module(load_model(out / "model.py"))
    angle, before, after = _residuals(extended)
    with mpl.rc_context(STYLE):
        figure = Figure((7.0, 2.7), layout="constrained")
        bins = np.linspace(0.0, 360.0, 37)
        for axes, residual, title, colour in zip(
            figure.subplots(1, 2, sharey=True),
            (before, after),
            ("the paper's model", "with the effect that was found"),
            (COLOURS[1], COLOURS[0]),
            strict=True,
        ):
            rms = np.sqrt(np.mean(residual**2))
            means = [residual[np.digitize(angle, bins) == k].mean() for k in range(1, len(bins))]
            axes.plot(angle[::STRIDE], residual[::STRIDE], ".", markersize=2, alpha=0.4, color=colour)
            axes.plot(0.5 * (bins[1:] + bins[:-1]), means, "-", color=colour, linewidth=2)
            axes.set_title(f"{title}: {1e3 * rms:.0f} mN m rms", fontsize=9)
            axes.set_xlabel("link angle [deg]")
            axes.set_xticks(range(0, 361, 90))
        figure.axes[0].set_ylabel("residual [N m], forwards")
    save(figure, path)
    return sentence


def _residuals(extended: ModuleType) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Link angle [deg] and both residuals [N m] of the held-out rows that turn forwards.

    The paper's model is fitted to the training rows by least squares; the extended one is as it was emitted.
    """
    rig = read_rig(RIG)
    channels = read_channels([LOG], rig)
    theta, omega, alpha = channels.theta_m, channels.omega_m, channels.alpha_m
    p = extended.Parameters()
    friction = p.k_i * channels.current - (p.J_m + p.mu**2 * p.J_l) * alpha - extended.gravity_torque(theta)
    paper = extended.regressor(theta, omega)[..., :4]
    fitted, *_ = np.linalg.lstsq(paper[channels.fit_rows], friction[channels.fit_rows])
    shown = channels.held_out & channels.usable & (omega > 0)
    angle = np.degrees(p.mu * theta[shown]) % 360.0
    after = friction - extended.mechanical_friction_torque(theta, omega)
    return angle, (friction - paper @ fitted)[shown], after[shown]
