"""`eccentric.bench`: a realistic log of a virtual test bench, with effects that its rig does not declare."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from eccentric.api.result import new_axes, paragraphs
from eccentric.api.tables import ResultTable, ranges_of
from eccentric.errors import InputError
from eccentric.logs import Log, read_log
from eccentric.places import given_path
from eccentric.rigs import Rig, read_rig
from eccentric.virtual_bench import BenchRun, free_paths, random_scenario, simulate, write

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["BenchResult", "bench"]

_SIGNALS = {
    "theta_m_rad": "motor angle [rad]",
    "omega_m_rad_s": "motor velocity [rad/s]",
    "current_A": "current [A]",
}
"""The columns to plot over time, with their labels."""


def bench(
    effects: Sequence[str | tuple[str, float]] | Mapping[str, float] = (),
    *,
    case: str = "C2",
    mu: float = 0.2,
    log_type: str = "runs",
    seconds: float = 60.0,
    noise: float = 0.01,
    temperature: bool = False,
    drive: str = "fine",
    seed: int = 1,
    out: str | os.PathLike[str] | None = None,
) -> BenchResult:
    """Simulate a log of a drive that swings an unbalanced mass; the same arguments give the same log.

    Args:
        effects: families of effects that the bench has and its rig does not declare, each a name, with a
            variant if wanted ("cogging[n=4]"), alone or with its rms as a fraction of that of friction, above
            0 and at most 1 (0.15): ["stribeck", ("cogging", 0.1)] or {"stribeck": 0.12}.
        case: "C1", gravity perpendicular to the plane of motion, or "C2", gravity in the plane.
        mu: gear ratio, link speed over motor speed, 0.001 to 2.
        log_type: "runs", constant speeds, or "traj", a sum of sines.
        seconds: length of the log, 15 to 3600.
        noise: of the current over its largest value, at most 0.5.
        temperature: whether a temperature is logged.
        drive: "fine", a well damped loop, fine encoder and steady bus, or "ordinary", a loop that may ring, a
            bus that varies and a coarse encoder.
        seed: of rig, course, shapes of the effects and noise, 0 or more.
        out: where to write the log, NAME.csv.gz, with the rig NAME.json and the truth NAME.truth.json beside
            it; by default nothing is written.

    Raises:
        InputError: a value is out of range, an effect is unknown or invisible in this case, or a file of that
            name exists.
    """
    if not isinstance(seed, int | np.integer) or seed < 0:
        raise InputError(f"seed: an integer of 0 or more is required, received {seed!r}")
    path = None if out is None else given_path(out, "out")
    scenario = random_scenario(
        np.random.default_rng(seed),
        case=case,
        mu=mu,
        log_type=log_type,
        effects=list(effects.items()) if isinstance(effects, Mapping) else effects,
        noise=noise,
        temperature=temperature,
        drive=drive,
        seconds=seconds,
    )
    if path is not None:
        free_paths(path)
    run = simulate(scenario)
    if path is not None:
        write(run, path)
    name = "bench" if path is None else path.name
    return BenchResult(read_log(run.columns, name), read_rig(run.rig), run.truth, run)


@dataclass(frozen=True, eq=False)
class BenchResult:
    """A simulated log, what its rig declares, and the truth: `eccentric.fit(result.log, result.rig)`.

    Attributes:
        log: the columns as a drive would write them: quantised, noisy, rounded.
        rig: what the rig declares; the effects are not in it.
        truth: the sealed truth: friction, and each effect with its amplitude.
        run: the same as the bench's own record.
    """

    log: Log
    rig: Rig
    truth: Mapping[str, Any]
    run: BenchRun

    @property
    def effects(self) -> tuple[str, ...]:
        """The effects that the bench has in addition to the paper's friction, each with its share."""
        return tuple(
            f"{e['id']} at {e['rms_fraction_of_friction']:.1%} of friction" for e in self.truth["effects"]
        )

    def summary(self) -> str:
        """Rows, duration, case and effects, in one line."""
        t, known = self.log.numbers("time_s"), self.rig.known
        head = f"{self.log.rows} rows of {t[-1] - t[0]:.0f} s, case {self.rig.case}, mu {known['mu']:g}"
        return f"{head}: {', '.join(self.effects) or 'no effect'}"

    def table(self) -> ResultTable:
        """The columns of the log, each with its range."""
        return ranges_of(self.log)

    def plot(self, axes: Sequence[Axes] | None = None) -> Sequence[Axes]:
        """Plot angle, velocity and current over time.

        Args:
            axes: three, from top to bottom; by default those of a new figure.

        Raises:
            InputError: matplotlib is not installed.
        """
        axes = new_axes(len(_SIGNALS), 1, (9.0, 6.0)) if axes is None else axes
        for one, (column, label) in zip(axes, _SIGNALS.items(), strict=True):
            one.plot(self.log.numbers("time_s"), self.log.numbers(column), linewidth=0.6)
            one.set_ylabel(label)
        axes[0].set_title(self.summary(), fontsize=9.0)
        axes[-1].set_xlabel("time [s]")
        return axes

    def write(self, out: str | os.PathLike[str]) -> tuple[Path, Path, Path]:
        """Write the log NAME.csv.gz, its rig NAME.json and its truth NAME.truth.json; return the paths.

        Raises:
            InputError: the name does not end in .csv.gz, one of the files exists, or cannot be written.
        """
        return write(self.run, Path(out))

    def __str__(self) -> str:
        return self.summary()

    def __repr__(self) -> str:
        return f"<BenchResult: {self.summary()}>"

    def _repr_html_(self) -> str:
        return f"<div>{paragraphs(self.summary())}{self.table()._repr_html_()}</div>"
