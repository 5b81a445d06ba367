"""The picture of the learning firmware for the manual: friction as it was, and as the drive learned it.

Run `python benchmarks/adapt_figure.py` in the root of the clone; it writes docs/adapted.svg.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from tests.learning import SAMPLES, learned  # noqa: E402 - the root of the clone comes first

_TRUE, _LEARNED, _EMITTED, _STEP = "#d55e00", "#0072b2", "#8a8a8a", "#000000"


def main() -> None:
    """Run the drive on this computer and draw it."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

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
    with rc_context({"svg.hashsalt": "eccentric", "font.size": 9.0}):
        figure = Figure(figsize=(8.0, 5.6), layout="constrained")
        axes = figure.subplots(3, 1, sharex=True)
        for ax, (label, real, found, start) in zip(axes, shown, strict=True):
            ax.plot(hours, found, color=_LEARNED, linewidth=0.9, label="learned")
            ax.plot(hours, real, color=_TRUE, linewidth=1.4, label="true")
            ax.axhline(start, color=_EMITTED, linestyle=":", label="as emitted")
            ax.axvline(SAMPLES * 1e-3 / 3600, color=_STEP, linewidth=0.6)
            ax.set_ylabel(label)
            ax.spines[["top", "right"]].set_visible(False)
        axes[0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, frameon=False)
        axes[0].annotate(
            "Coulomb friction +20 %", (SAMPLES * 1e-3 / 3600, 1.0), xycoords=("data", "axes fraction"),
            ha="right", va="bottom",
        )  # fmt: skip
        axes[-1].set_xlabel("time [h], the drive at rest for nine tenths of it")
        figure.savefig(ROOT / "docs" / "adapted.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
