"""`eccentric.bench`, `bench_arm`, `bench_fleet`: realistic logs with effects that no rig file declares."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.api.result import ResultBase
from eccentric.api.tables import ResultTable, ranges_of
from eccentric.core import InputError, given_path
from eccentric.logs import Log, read_log
from eccentric.rigs import Rig, read_rig
from eccentric.virtual_bench import (
    ArmRun,
    BenchRun,
    fleet_plan,
    free_arm_paths,
    free_paths,
    random_arm_scenario,
    random_scenario,
    simulate,
    simulate_arm,
    write,
    write_arm,
    write_fleet,
)

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
        effects: effects that the bench has and its rig does not declare: names of families, optionally with a
            variant ("cogging[n=4]"), alone or with the RMS as a fraction of the friction's, above 0 and at
            most 1 (default 0.15): ["stribeck", ("cogging", 0.1)] or {"stribeck": 0.12}.
        case: "C1", gravity perpendicular to the plane of motion, or "C2", gravity in the plane.
        mu: gear ratio, link speed over motor speed, 0.001 to 2.
        log_type: "runs", constant speeds, or "traj", a sum of sines.
        seconds: length of the log, 15 to 3600.
        noise: of the current over its largest value, at most 0.5.
        temperature: whether a temperature is logged.
        drive: "fine", a well damped loop, fine encoder and steady bus, or "ordinary", a loop that may ring, a
            bus that varies and a coarse encoder.
        seed: of rig, motion, effects and noise, 0 or more.
        out: where to write the log, NAME.csv.gz, with the rig NAME.json and the truth NAME.truth.json next to
            it; by default nothing is written.

    Raises:
        InputError: a value is out of range, an effect is unknown or invisible in this case, or a file of that
            name exists.
    """
    path, rng = _asked(out, seed)
    scenario = random_scenario(
        rng,
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


def _asked(out: str | os.PathLike[str] | None, seed: int) -> tuple[Path | None, np.random.Generator]:
    if not isinstance(seed, int | np.integer) or seed < 0:
        raise InputError("seed", "an integer of 0 or more", f"{seed!r}")
    return None if out is None else given_path(out, "out"), np.random.default_rng(seed)


class _Simulated(ResultBase):
    """What a simulated log shows of itself."""

    log: Log

    def _layout(self) -> tuple[tuple[int, int], tuple[float, float]]:
        return (3, 1), (9.0, 6.0)

    def table(self) -> ResultTable:
        """The columns of the log, each with its range."""
        return ranges_of(self.log)

    def _label(self, axes: list[Any], labels: Iterable[str]) -> None:
        """Name axes over time, from top to bottom."""
        for one, label in zip(axes, labels, strict=False):
            one.set_ylabel(label)
        axes[0].set_title(self.summary(), fontsize=9.0)
        axes[-1].set_xlabel("time [s]")

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.summary()}>"


@dataclass(frozen=True, eq=False, repr=False)
class BenchResult(_Simulated):
    """A simulated log, its rig and the truth; fit it with `eccentric.fit(result.log, result.rig)`.

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
        """The planted effects, in addition to the paper's friction, each with its share."""
        return tuple(
            f"{e['id']} at {e['rms_fraction_of_friction']:.1%} of friction" for e in self.truth["effects"]
        )

    def summary(self) -> str:
        """Rows, duration and case, in one line; the effects are in `effects` and `truth`."""
        t, known = self.log.numbers("time_s"), self.rig.known
        return f"{self.log.rows} rows of {t[-1] - t[0]:.0f} s, case {self.rig.case}, mu {known['mu']:g}"

    def _draw(self, axes: list[Any]) -> None:
        """Angle, velocity and current over time."""
        self._label(axes, _SIGNALS.values())
        for one, column in zip(axes, _SIGNALS, strict=False):
            one.plot(self.log.numbers("time_s"), self.log.numbers(column), linewidth=0.6)

    def write(self, out: str | os.PathLike[str]) -> tuple[Path, Path, Path]:
        """Write the log NAME.csv.gz, its rig NAME.json and its truth NAME.truth.json; return the paths.

        Raises:
            InputError: the name does not end in .csv.gz, one of the files exists, or cannot be written.
        """
        return write(self.run, Path(out))


# `eccentric.bench_arm`: a realistic log of a virtual arm, with effects that its rig does not declare.


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

    MuJoCo simulates the rigid bodies; the friction of each joint follows the loads on its bearing.

    Args:
        arm: "2r", two links in a vertical plane with a weight at the tip, or "3" or "6" joints in space;
            their links, gears, drives and friction are drawn by the seed.
        effects: effects that the rig does not declare: names of families, optionally with a variant and a
            joint ("stribeck@2", "link_harmonic_friction[n=2]@1"), alone or with the RMS as a fraction of the
            joint's friction, above 0 and at most 1 (default 0.15). Without a joint, one is chosen at random.
        log_type: "traj", sums of harmonics, or "runs", constant velocities.
        runs: of equal length, each from rest, 3 to 20.
        seconds: length of all runs together, 15 to 3600.
        noise: of each current over its largest value, at most 0.5.
        measured: "current", or the joints' "torque".
        sample_rate_hz: 250 or 500.
        seed: of arm, motion, effects and noise, 0 or more.
        out: where to write the log, NAME.csv.gz, with the rig NAME.toml, the arm NAME.arm.toml and the truth
            NAME.truth.json next to it; by default nothing is written.
        progress: called with the part that is done, 0 to 1; starts again from 0 if an effect missed its size.

    Raises:
        InputError: a value is out of range, an effect or a joint is unknown, a file of that name exists, or
            MuJoCo is not installed.
    """
    path, rng = _asked(out, seed)
    if path is not None:
        free_arm_paths(path)
    scenario = random_arm_scenario(
        rng,
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


@dataclass(frozen=True, eq=False, repr=False)
class ArmBenchResult(_Simulated):
    """A simulated log of an arm, its rig and arm file, and the truth.

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
        """The planted effects, besides the friction that follows the loads, each with its joint and share."""
        return tuple(
            f"{e['id']} in joint {e['joint']} at {e['rms_fraction_of_friction']:.1%} of its friction"
            for e in self.truth["effects"]
        )

    def summary(self) -> str:
        """Rows, duration, runs and joints, in one line; the effects are in `effects` and `truth`."""
        seconds = self.log.rows * float(np.median(np.diff(self.log.numbers("t_s"))))
        return f"{self.log.rows} rows of {seconds:.0f} s in {self.truth['runs']} runs, {self.truth['arm']}"

    def _draw(self, axes: list[Any]) -> None:
        """Angle, velocity and drive of every joint over time."""
        drive = "current [A]" if "i_A_1" in self.log.columns else "torque [N m]"
        names = ("q_rad", "w_rad_s", "i_A" if drive.startswith("current") else "tau_Nm")
        self._label(axes, ("joint angle [rad]", "joint velocity [rad/s]", drive))
        t = self.log.numbers("t_s")
        for one, name in zip(axes, names, strict=False):
            for j in range(1, len(self.truth["joints"]) + 1):
                one.plot(t, self.log.numbers(f"{name}_{j}"), linewidth=0.6, label=f"{j}")
        axes[0].legend(title="joint", fontsize=8.0, ncols=6)

    def write(self, out: str | os.PathLike[str]) -> tuple[Path, Path, Path, Path]:
        """Write NAME.csv.gz, the rig NAME.toml, the arm NAME.arm.toml and NAME.truth.json; return the paths.

        Raises:
            InputError: the name does not end in .csv.gz, one of the files exists, or cannot be written.
        """
        return write_arm(self.run, Path(out))


# `eccentric.bench_fleet`: a small fleet over some months, some of whose joints degrade.


def bench_fleet(
    out: str | os.PathLike[str],
    *,
    joints: int = 12,
    months: int = 6,
    degrading: int = 2,
    bad_sensors: int = 1,
    seconds: float = 40.0,
    rate_hz: float = 200.0,
    seed: int = 1,
    progress: Callable[[float], None] | None = None,
) -> dict[str, str]:
    """Write the logs of a fleet: prescribed motion, friction that follows a season, wear in some joints.

    Args:
        out: a new or empty folder for logs/joint=.../month=.../log.parquet, rigs.csv with its rig files, and
            the sealed truth.json.
        joints, months: how many.
        degrading: joints whose friction changes, in one of five ways each.
        bad_sensors: joints with a current offset or a stuck temperature, alternately.
        seconds: length of each log.
        rate_hz: rows per second.
        seed: seed of the random numbers; the same arguments give the same fleet.
        progress: called with the part that is done, 0 to 1.

    Returns:
        Joint -> its change, for the joints that change.

    Raises:
        InputError: a number is out of range, the folder is not empty, or pyarrow is not installed.
    """
    plan = fleet_plan(
        joints=joints,
        periods=months,
        degrading=degrading,
        bad_sensors=bad_sensors,
        seconds=seconds,
        rate_hz=rate_hz,
        seed=seed,
    )
    write_fleet(plan, Path(out), progress)
    return {joint.name: joint.way for joint in plan.joints if joint.way}
