"""`eccentric.bench_arm`: a realistic log of a virtual arm, with effects that its rig does not declare."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from eccentric.api.result import new_axes, paragraphs
from eccentric.api.tables import ResultTable, ranges_of
from eccentric.errors import InputError
from eccentric.logs import Log, read_log
from eccentric.places import given_path
from eccentric.virtual_bench import ArmRun, free_arm_paths, random_arm_scenario, simulate_arm, write_arm

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["ArmBenchResult", "bench_arm"]


def bench_arm(
    arm: str = "2r",
    effects: Sequence[str | tuple[str, float]] | Mapping[str, float] = (),
    *,
    log_type: str = "traj",
    runs: int = 5,
    seconds: float = 60.0,
    noise: float = 0.01,
    measured: str = "current",
    sample_rate_hz: int = 250,
    seed: int = 1,
    out: str | os.PathLike[str] | None = None,
    progress: Callable[[float], None] | None = None,
) -> ArmBenchResult:
    """Simulate a log of an arm under its servo drives; the same arguments give the same log.

    The rigid bodies are those of MuJoCo; the friction of each joint follows the loads of its bearing.

    Args:
        arm: "2r", two links in a vertical plane with a weight at the tip, or "3" or "6" joints in space;
            their links, gears, drives and friction are drawn by the seed.
        effects: families of effects that the rig does not declare, each a name, with a variant and a joint
            if wanted ("stribeck@2", "link_harmonic_friction[n=2]@1"), alone or with its rms as a fraction of
            that of the joint's friction, above 0 and at most 1 (0.15). Without a joint, one is drawn.
        log_type: "traj", sums of harmonics, or "runs", constant velocities.
        runs: of equal length, each from rest, 3 to 20.
        seconds: length of all runs together, 15 to 3600.
        noise: of each current over its largest value, at most 0.5.
        measured: "current", or the joints' "torque".
        sample_rate_hz: 250 or 500.
        seed: of arm, course, shapes of the effects and noise, 0 or more.
        out: where to write the log, NAME.csv.gz, with the rig NAME.toml, the arm NAME.arm.toml and the truth
            NAME.truth.json beside it; by default nothing is written.
        progress: told the part that is done, from 0 to 1; again from 0 if an effect was not of its size.

    Raises:
        InputError: a value is out of range, an effect or a joint is unknown, a file of that name exists, or
            MuJoCo is not installed.
    """
    if not isinstance(seed, int | np.integer) or seed < 0:
        raise InputError(f"seed: an integer of 0 or more is required, received {seed!r}")
    path = None if out is None else given_path(out, "out")
    if path is not None:
        free_arm_paths(path)
    scenario = random_arm_scenario(
        np.random.default_rng(seed),
        arm=arm,
        effects=effects,
        log_type=log_type,
        runs=runs,
        seconds=seconds,
        noise=noise,
        measured=measured,
        sample_rate_hz=sample_rate_hz,
    )
    run = simulate_arm(scenario, progress)
    if path is not None:
        write_arm(run, path)
    name = "bench" if path is None else path.name
    return ArmBenchResult(read_log(run.columns, name), run.rig, run.arm, run.truth, run)


@dataclass(frozen=True, eq=False)
class ArmBenchResult:
    """A simulated log of an arm, what its rig and its arm file declare, and the truth.

    Attributes:
        log: the columns as the drives would write them: quantised, noisy, rounded.
        rig: the content of the rig file; the effects are not in it.
        arm: the content of the arm file: joints, bodies, gears, rotors.
        truth: the sealed truth: friction of each joint, and each effect with its joint and amplitude.
        run: the same as the bench's own record.
    """

    log: Log
    rig: Mapping[str, Any]
    arm: Mapping[str, Any]
    truth: Mapping[str, Any]
    run: ArmRun

    @property
    def effects(self) -> tuple[str, ...]:
        """The effects that the arm has beyond its friction by loads, each with its joint and share."""
        return tuple(
            f"{e['id']} in joint {e['joint']} at {e['rms_fraction_of_friction']:.1%} of its friction"
            for e in self.truth["effects"]
        )

    def summary(self) -> str:
        """Rows, duration, runs, joints and effects, in one line."""
        seconds = self.log.rows * float(np.median(np.diff(self.log.numbers("t_s"))))
        head = f"{self.log.rows} rows of {seconds:.0f} s in {self.truth['runs']} runs, {self.truth['arm']}"
        return f"{head}: {', '.join(self.effects) or 'no effect'}"

    def table(self) -> ResultTable:
        """The columns of the log, each with its range."""
        return ranges_of(self.log)

    def plot(self, axes: Sequence[Axes] | None = None) -> Sequence[Axes]:
        """Plot angle, velocity and drive of every joint over time.

        Args:
            axes: three, from top to bottom; by default those of a new figure.

        Raises:
            InputError: matplotlib is not installed.
        """
        axes = new_axes(3, 1, (9.0, 6.0)) if axes is None else axes
        drive = "current [A]" if "i_A_1" in self.log.columns else "torque [N m]"
        names = ("q_rad", "w_rad_s", "i_A" if drive.startswith("current") else "tau_Nm")
        labels = ("joint angle [rad]", "joint velocity [rad/s]", drive)
        for one, name, label in zip(axes, names, labels, strict=True):
            for j in range(1, len(self.truth["joints"]) + 1):
                one.plot(
                    self.log.numbers("t_s"), self.log.numbers(f"{name}_{j}"), linewidth=0.6, label=f"{j}"
                )
            one.set_ylabel(label)
        axes[0].legend(title="joint", fontsize=8.0, ncols=6)
        axes[0].set_title(self.summary(), fontsize=9.0)
        axes[-1].set_xlabel("time [s]")
        return axes

    def write(self, out: str | os.PathLike[str]) -> tuple[Path, Path, Path, Path]:
        """Write the log NAME.csv.gz, its rig NAME.toml, NAME.arm.toml and NAME.truth.json; return the paths.

        Raises:
            InputError: the name does not end in .csv.gz, one of the files exists, or cannot be written.
        """
        return write_arm(self.run, Path(out))

    def __str__(self) -> str:
        return self.summary()

    def __repr__(self) -> str:
        return f"<ArmBenchResult: {self.summary()}>"

    def _repr_html_(self) -> str:
        return f"<div>{paragraphs(self.summary())}{self.table()._repr_html_()}</div>"
