"""The picture of a loop for the manual: the torque at rest, and the tracking error of a sine, by law.

Run `python benchmarks/loop_figure.py` in the root of the clone; it writes docs/in_the_loop.svg.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from benchmarks.loops import (  # noqa: E402 - the root of the clone comes first
    HOLD,
    NO_PUSH,
    OURS,
    REFERENCE,
    SINE,
    TICK,
    Drives,
    by_hand,
    emitted,
    references,
    run,
)

_DRIVE, _SECONDS = 2, 5.0
"""A drive whose static friction is kinetic friction and that does not preslide."""
_SHOWN = {
    "sign of the measured velocity": "#d55e00",
    "tanh(w/3) of the measured velocity": "#8a8a8a",
    OURS: "#0072b2",
}


def main() -> None:
    """Run a few drives, and draw one of them."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    d = Drives(8)
    with tempfile.TemporaryDirectory() as place:
        laws = by_hand(d) | {OURS: emitted(d, Path(place), REFERENCE, NO_PUSH)}
        laws = {name: laws[name] for name in _SHOWN}
        angles, torques = run(d, laws, _SECONDS, integral=True)
    wanted = references(_SECONDS)[0]
    t = np.arange(len(wanted)) * TICK
    with rc_context({"svg.hashsalt": "eccentric", "font.size": 9.0}):
        figure = Figure(figsize=(8.0, 4.6), layout="constrained")
        above, below = figure.subplots(2, 1)
        for k, (name, colour) in enumerate(_SHOWN.items()):
            rest = (t >= 4.0) & (t < 4.2)
            above.plot(t[rest], 1e3 * torques[rest, k, HOLD, _DRIVE], color=colour, linewidth=0.9, label=name)
            moving = (t >= 2.0) & (t < 4.0)
            error = 1e3 * (angles[:, k, SINE, _DRIVE] - wanted[:, SINE])
            below.plot(t[moving], error[moving], color=colour, linewidth=1.1)
        above.set_ylabel("torque at rest [mN m]")
        below.set_ylabel("error of a sine\nof 3 rad/s [mrad]")
        below.set_xlabel("time [s]")
        figure.legend(loc="outside upper left", ncols=3, frameon=False)
        for ax in (above, below):
            ax.spines[["top", "right"]].set_visible(False)
        figure.savefig(ROOT / "docs" / "in_the_loop.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
