"""The picture of the first page: residual of the bundled log before and after, over the link angle."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from eccentric.diagnosis import diagnose
from eccentric.presentation import diagnosis_sentence
from generator.pictures import COLOURS, STYLE, save

BENCH = Path(__file__).parents[2] / "examples" / "bench"
LOG, RIG = BENCH / "bench.csv.gz", BENCH / "bench.toml"
STRIDE = 6
"""Of the held-out rows every so many are drawn; the mean is of all."""


_HTML = """<p class="picture">
<img class="only-light" src="_images/bench.svg" alt="{alt}">
<img class="only-dark" src="_images/bench-dark.svg" alt="{alt}">
</p>"""
_ALT = "Residual of the bundled log over the link angle, before and after the diagnosis"


def figure(images: Path) -> str:
    """The picture below `images`, as HTML, with the sentence of the diagnosis below it."""
    sentence = picture(images / "bench")
    return f"{_HTML.format(alt=_ALT)}\n\nThe held-out part of the bundled log: {sentence}"


def picture(path: Path) -> str:
    """Diagnose the bundled log, draw path.svg and path-dark.svg; return the sentence of the diagnosis."""
    found = diagnose([LOG], RIG)
    rows = found.rows
    shown = rows.score & (rows.mean(found.channels.motion.omega_m) > 0.0)
    angle = np.degrees(found.setting.mu * rows.mean(found.channels.motion.theta_m)[shown]) % 360.0
    before, after = (
        fit.residuals["mechanical"][shown] for fit in (found.models.paper, found.models.extended)
    )
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
    return diagnosis_sentence(found)
