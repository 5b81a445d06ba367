"""`eccentric.plan`: the motion that would decide what a diagnosis left open."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.api.inputs import (
    LogSources,
    ModelSource,
    RigSource,
    by_name,
    model_of,
    names_given,
    sources_of,
)
from eccentric.api.result import Printed
from eccentric.api.tables import ResultTable
from eccentric.core import InputError, whole_folder
from eccentric.diagnosis import diagnose
from eccentric.emission import template
from eccentric.logs import parse_value
from eccentric.model import Model, load_model
from eccentric.planning import (
    FIRMWARE_HZ,
    RATE_HZ,
    Bounds,
    DetectionPlan,
    MeasurementPlan,
    planned,
    question_from,
    question_of,
    read_bounds,
    require_link,
    sought_of,
)
from eccentric.planning import plan_detection as detection_planned
from eccentric.presentation import detection_document, detection_lines, plan_document, plan_lines
from eccentric.rigs import read_mass, read_rig
from eccentric.signals import read_long

REFERENCE = "reference"


def plan(
    logs: LogSources,
    rig: RigSource,
    limits: str | os.PathLike[str] | Mapping[str, Any] | Bounds,
    model: ModelSource | None = None,
    progress: Callable[[str], None] | None = None,
    reading: Callable[[float], None] | None = None,
    diagnosis: str | os.PathLike[str] | Mapping[str, Any] | None = None,
    added: str | None = None,
) -> PlanResult:
    """Plan a motion to decide between the candidates that remain after a diagnosis of logs.

    If an effect is named, or none is missing, the motion is the one that best determines the model's
    coefficients.

    Args:
        logs, rig, model: as `diagnose` takes them.
        limits: limits of the motion, on the motor side: the path of a TOML or JSON file or a mapping with
            `speed_rad_s`, `acceleration_rad_s2`, `current_A`, `time_s` and, for a drive that does not turn
            without end, `angle_rad`, each in SI or as a text with a unit ("3000 rpm"); `speed_loop_Hz`, the
            bandwidth of the speed loop, if known.
        progress: called with one line for each stage.
        reading: called with the part of the rows read, 0 to 1, while logs of more than 100,000 rows are read.
        diagnosis: the result of `diagnose` for these logs, a diagnosis.json or its content: the remaining
            candidates are taken from there, and no search is run.
        added: a mass to add to the link, as "0.2 kg"; declare it under `[added]` in the rig file for the new
            run, and diagnose both logs together.

    Raises:
        InputError: as `diagnose` does; the diagnosis is of other logs or another model; the log
            does not fit the rig; limits are missing or not positive; no motion stays within them; or the
            mass to be added has no unit or no place on a link.
    """
    sources, rig = sources_of(logs), read_rig(rig)
    bounds = read_bounds(limits, rig.axis)
    mass = 0.0 if added is None else read_mass(added, "--added")
    base = by_name(model)
    if mass:
        require_link(rig, base if isinstance(base, Model) else load_model(base or rig.model))
    read = read_long(sources, rig, tell=reading)
    if diagnosis is None:
        found = diagnose(read, rig, base, tell=progress)
        question, warnings = question_of(found), found.warnings
    else:
        question = question_from(diagnosis, read, rig, base)
        channels = question.data.drive.channels
        warnings = (*channels.intake.warnings, *question.data.drive.warnings)
    made = planned(question, bounds, progress or (lambda _: None), mass)
    return PlanResult(
        plan=made, lines=tuple(plan_lines(made)), warnings=tuple(warnings), document=plan_document(made)
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class PlanResult(Printed):
    """A motion to measure next. It prints as `summary()`.

    Attributes:
        plan: the motion, the candidates, and the probability that the motion decides between them.
        lines, warnings, document: as in Printed; the document is the content of plan.json.
    """

    plan: MeasurementPlan

    @property
    def reference(self) -> dict[str, np.ndarray]:
        """The motion as columns (n,): time_s, theta_m_rad, omega_m_rad_s, alpha_m_rad_s2."""
        motion = self.plan.motion
        columns = {
            "time_s": motion.t,
            "theta_m_rad": motion.theta,
            "omega_m_rad_s": motion.omega,
            "alpha_m_rad_s2": motion.alpha,
        }
        return {self.plan.axis.named(name): values for name, values in columns.items()}

    def _layout(self) -> tuple[tuple[int, int], tuple[float, float]]:
        return (4, 1), (8.0, 7.0)

    def table(self) -> ResultTable:
        """The candidates still to decide between, most probable first, each with its probability."""
        names = ("family", "probability")
        return ResultTable(names, tuple((rival.family, rival.chance) for rival in self.plan.rivals))

    def write(self, out: str | os.PathLike[str]) -> list[Path]:
        """Write plan.json, reference.csv, reference.h and, with matplotlib, plan.png and plan.svg.

        Raises:
            InputError: the folder cannot be written.
        """
        return self._write(out, "plan", {f"{REFERENCE}.csv": self._csv(), f"{REFERENCE}.h": self._header()})

    def _draw(self, axes: list[Any]) -> None:
        """Angle, speed, acceleration and current over time, each with its limits."""
        motion, bounds, axis = self.plan.motion, self.plan.bounds, self.plan.axis
        rows = (
            (f"{axis.term('angle')} [{axis.unit('rad')}]", motion.theta, bounds.angle),
            (f"speed [{axis.unit('rad/s')}]", motion.omega, (-bounds.speed, bounds.speed)),
            (
                f"acceleration [{axis.unit('rad/s²')}]",
                motion.alpha,
                (-bounds.acceleration, bounds.acceleration),
            ),
            ("{} [{}]".format(*self.plan.strength), self.plan.current, (-bounds.current, bounds.current)),
        )
        for ax, (name, values, limits) in zip(axes, rows, strict=False):
            ax.plot(motion.t, values, color="#0072b2", linewidth=1.0)
            # A limit far off would flatten the motion.
            near = [x for x in limits or () if abs(x) < 2.0 * np.max(np.abs(values))]
            for limit in near:
                ax.axhline(limit, color="#d55e00", linestyle="--", linewidth=1.0)
            if limits and not near:
                ax.set_title(f"limits {limits[0]:.4g} to {limits[1]:.4g}", loc="right", fontsize="small")
            ax.set_ylabel(name)
            ax.margins(x=0.0)
        title = f"planned motion{self.plan.axis.term(' (motor side)')}, limits dashed"
        title += f", with {self.plan.added:g} kg added" if self.plan.added else ""
        axes[0].set_title(title, loc="left", fontsize="medium")
        axes[-1].set_xlabel("time [s]")

    def _csv(self) -> str:
        columns = self.reference
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        return "\n".join([",".join(columns), *(",".join(f"{x:.6f}" for x in row) for row in rows)]) + "\n"

    def _header(self) -> str:
        motion, step = self.plan.motion, round(RATE_HZ / FIRMWARE_HZ)
        columns = (x[::step].tolist() for x in (motion.theta, motion.omega, motion.alpha))
        points = list(zip(*columns, strict=True))
        return template("plan/reference.h").render(
            name=REFERENCE,
            command="eccentric plan",
            count=len(points),
            rate=FIRMWARE_HZ,
            said=self.plan.axis.text,
            added=f"{self.plan.added:g}" if self.plan.added else "",
            points=[[f"{x:.6e}" for x in point] for point in points],
        )

    def __repr__(self) -> str:
        names = ", ".join(rival.family for rival in self.plan.rivals)
        return f"<PlanResult: {self.plan.motion.seconds:.0f} s for {names or 'the base model'}>"


def plan_detection(
    rig: RigSource,
    limits: str | os.PathLike[str] | Mapping[str, Any] | Bounds,
    sought: str | Sequence[str] = ("B_lN", "C_lN"),
    model: ModelSource | None = None,
    noise: str | None = None,
) -> DetectionPlanResult:
    """Find the speed, mass and time that would reveal friction by F_N at z = 5, without a log.

    Args:
        rig: what is known about the rig; a range in `[unknown]` counts as its middle.
        limits: as `plan` takes them.
        sought: coefficients, at the model's own value (Table 1 of the paper) or at yours, as in "C_lN=0.01".
        model: by default that of the rig's case or tilt.
        noise: of an independent sample of the torque on the motor side, as "2 mN m"; by default 1 % of the
            torque at the current limit.

    Raises:
        InputError: a coefficient does not follow F_N, a quantity of the rig or a limit is missing, or no
            motion stays within the limits.
    """
    rig = read_rig(rig)
    base = model_of(rig.model if model is None else model)
    values = sought_of(names_given(sought), base)
    sigma = None if noise is None else parse_value(noise, "N m", "--noise")
    if sigma is not None and sigma <= 0.0:
        raise InputError("--noise", "a torque above 0 N m", f"{noise!r}")
    made = detection_planned(rig, base, read_bounds(limits, rig.axis), values, sigma)
    return DetectionPlanResult(
        plan=made,
        lines=tuple(detection_lines(made)),
        warnings=rig.warnings,
        document=detection_document(made),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class DetectionPlanResult(Printed):
    """What would show friction by F_N. It prints as `summary()`.

    Attributes:
        plan: z within the limits, and the time, speed and mass that would be enough, each alone.
        lines, warnings, document: as in Printed; the document is the content of plan.json.
    """

    plan: DetectionPlan

    def write(self, out: str | os.PathLike[str]) -> list[Path]:
        """Write plan.json. InputError: the folder cannot be written."""
        with whole_folder(out, "plan") as folder:
            (folder / "plan.json").write_text(self.to_json(), encoding="utf-8")
        return [Path(out) / "plan.json"]
