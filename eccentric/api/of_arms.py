"""`eccentric.fit_arm`, `eccentric.diagnose_arm`: every joint of an arm, and the results."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from eccentric.api.diagnosed import DiagnosisResult, result_of
from eccentric.api.inputs import LogSources, names_given, sources_of
from eccentric.api.result import Printed, ResultTable, new_axes
from eccentric.core import InputError, given_path, whole_folder
from eccentric.diagnosis import SearchRequest
from eccentric.emission import complete, write
from eccentric.joints import ArmDiagnosis, ArmFit, JointFit, extended_arm
from eccentric.joints import diagnose_arm as diagnose_logs
from eccentric.joints import fit_arm as fit_logs
from eccentric.logs import log_names
from eccentric.presentation import (
    arm_command,
    arm_diagnosis_document,
    arm_diagnosis_lines,
    arm_diagnosis_sentence,
    arm_fit_document,
    arm_fit_lines,
    arm_page,
)
from eccentric.rigs import ArmRig, read_arm_rig
from eccentric.signals import FIT_POINTS, read_long_joints

if TYPE_CHECKING:
    from matplotlib.axes import Axes


ArmRigSource: TypeAlias = str | os.PathLike[str] | Mapping[str, Any] | ArmRig
_BEFORE, _AFTER = "#8a8a8a", "#0072b2"


def fit_arm(
    logs: LogSources,
    rig: ArmRigSource,
    progress: Callable[[str], None] | None = None,
    *,
    reading: Callable[[float], None] | None = None,
) -> ArmFitResult:
    """Fit the friction of every joint of an arm: Coulomb and viscous alone, and by the loads that it follows.

    Args:
        logs: one log or a list of them, as `fit` takes them.
        rig: the rig of an arm: the path of a rig file with the key `arm`, its content as a mapping, where
            `arm` may be a Chain, or what `read_arm_rig` returned.
        progress: called with one line for each stage.
        reading: called with the part of the rows read, 0 to 1, while logs of more than 100,000 rows are read.

    Raises:
        InputError: a log, the rig or the arm cannot be read, they do not match, or a joint has too few rows.
    """
    sources, rig = sources_of(logs), read_arm_rig(rig)
    read = read_long_joints(sources, rig, FIT_POINTS, reading)
    found = fit_logs(read, rig, log_names(read), progress or (lambda _: None))
    return ArmFitResult(
        fit=found,
        lines=tuple(arm_fit_lines(found)),
        warnings=found.warnings,
        document=arm_fit_document(found),
    )


def diagnose_arm(
    logs: LogSources,
    rig: ArmRigSource,
    effects: str | os.PathLike[str] | None = None,
    progress: Callable[[str], None] | None = None,
    *,
    without: str | Sequence[str] = (),
    only: str | Sequence[str] = (),
    empirical: bool = False,
    reading: Callable[[float], None] | None = None,
) -> ArmDiagnosisResult:
    """Find what the friction of each joint of an arm lacks.

    Args:
        logs, rig, progress, reading: as `fit_arm` takes them.
        effects: the path of a Python file with effects of your own.
        without, only: effects that the search may not offer, or the only ones that it may.
        empirical: whether each joint gets a term without a cause besides, as in `diagnose`.

    Raises:
        InputError: bad input, as in `fit_arm`; an effect that is unknown.
    """
    sources, rig = sources_of(logs), read_arm_rig(rig)
    read = read_long_joints(sources, rig, tell=reading)
    offered = None if effects is None else given_path(effects, "effects")
    request = SearchRequest((), names_given(without), names_given(only), empirical)
    told = progress or (lambda _: None)
    found = diagnose_logs(read, rig, log_names(read), offered, request, told)
    return ArmDiagnosisResult(
        diagnosis=found,
        own={} if offered is None else {offered.name: offered.read_text(encoding="utf-8")},
        lines=tuple(arm_diagnosis_lines(found)),
        warnings=found.warnings,
        document=arm_diagnosis_document(found),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class ArmFitResult(Printed):
    """The friction of every joint of an arm. It prints as `summary()` and shows as a table in a notebook.

    Attributes:
        fit: everything that was found, joint by joint.
        lines, warnings, document: as in Printed; the document is the content of fit.json.
    """

    fit: ArmFit

    @property
    def fits_the_rig(self) -> bool:
        """Whether the log can be of this arm, in these units."""
        return self.fit.fits_the_rig

    def table(self) -> ResultTable:
        """A row for each joint: what its friction follows, held-out errors, gain with its 95 % interval."""
        names = ("joint", "name", "follows", "linear", "followed", "percent", "lower", "upper", "unit")
        rows = (
            (j.number, j.name, "+".join(j.loads.followed), *_errors(j), j.percent, *j.interval, j.unit)
            for j in self.fit.joints
        )
        return ResultTable(names, tuple(rows))

    def plot(self, axes: Axes | None = None) -> Axes:
        """Plot the held-out error of each joint before and after, over the RMS of its drive.

        Raises:
            InputError: matplotlib is not installed.
        """
        if axes is None:
            (axes,) = new_axes(1, 1, self._size)
        places = range(len(self.fit.joints))
        for shift, name, color, label in (
            (-0.2, "linear", _BEFORE, "Coulomb + viscous"),
            (0.2, "followed", _AFTER, "with the loads that it follows"),
        ):
            sizes = [100.0 * joint.rmse[name] / joint.torque_rms for joint in self.fit.joints]
            axes.bar([place + shift for place in places], sizes, 0.38, color=color, label=label)
        axes.set_xticks(list(places), [f"joint {joint.number}" for joint in self.fit.joints])
        axes.set_ylabel("held-out RMSE [% of the drive's RMS]")
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
        return axes

    def write(self, out: str | os.PathLike[str]) -> list[Path]:
        """Write fit.json and, with matplotlib, fit.png and fit.svg into a folder of their own.

        Raises:
            InputError: the folder cannot be written.
        """
        return self._write(out, "fit", self._size, lambda figure: self.plot(figure.subplots()))

    @property
    def _size(self) -> tuple[float, float]:
        return 2.5 + 1.1 * len(self.fit.joints), 3.6

    def __repr__(self) -> str:
        return f"<ArmFitResult: {len(self.fit.joints)} joints of {self.fit.log.rig.chain.name}>"

    def _repr_html_(self) -> str:
        return self._html(self.table(), after=self.lines[-1])


def _errors(joint: JointFit) -> tuple[float, float]:
    return joint.rmse["linear"], joint.rmse["followed"]


@dataclass(frozen=True, eq=False, kw_only=True)
class ArmDiagnosisResult(Printed):
    """What the joints of an arm lack. It prints as `summary()` and shows as a table in a notebook.

    Attributes:
        diagnosis: everything that was found, joint by joint.
        own: name -> text of a script of your own effects.
        lines, warnings, document: as in Printed; the document is the content of diagnosis.json.
    """

    diagnosis: ArmDiagnosis
    own: Mapping[str, str]

    @property
    def verdict(self) -> str:
        """Over the arm: named, not_identifiable, unexplained or nothing_missing."""
        return self.diagnosis.verdict

    @property
    def effects(self) -> tuple[tuple[int, str], ...]:
        """(number of the joint, id) of the effects that are named, those that gain most first."""
        return tuple((joint.number, effect.id) for joint, effect in self.diagnosis.named)

    @property
    def sentence(self) -> str:
        """The result in one sentence."""
        return arm_diagnosis_sentence(self.diagnosis)

    @property
    def fits_the_rig(self) -> bool:
        """Whether the log can be of this arm, in these units."""
        return self.diagnosis.fits_the_rig

    def table(self) -> ResultTable:
        """A row for each joint: verdict, leading effect, its gain, held-out errors of the three models."""
        names = ("joint", "name", "verdict", "effects", "deviance", "linear", "paper", "extended", "unit")
        rows = []
        for joint in self.diagnosis.joints:
            rmse = joint.found.score.rmse["mechanical"]
            ids = "+".join(effect.id for effect, _ in joint.found.effects)
            errors = (rmse["linear"], rmse["paper"], rmse["extended"])
            rows.append(
                (joint.number, joint.name, joint.verdict, ids, joint.deviance, *errors, joint.found.unit)
            )
        return ResultTable(names, tuple(rows))

    def write(self, out: str | os.PathLike[str]) -> list[Path]:
        """Write report and JSON of the arm, the arm emitted, and what `diagnose` writes for each joint.

        The emitted arm has the friction of every joint as it was fitted, effects included; a log that does
        not fit the rig or has no scale in N m gives none. A joint's folder, joint_NUMBER, has its report, its
        model as a derivation, and the model emitted: its inputs are the motion of the motor and what the
        emitted arm gives as torques and `bearing_loads`.

        Raises:
            InputError: the folder cannot be written.
        """
        names = ["report.html", "diagnosis.json"]
        with whole_folder(out, "diagnose") as folder:
            (folder / "diagnosis.json").write_text(self.to_json(), encoding="utf-8")
            (folder / "report.html").write_text(arm_page(self.diagnosis), encoding="utf-8")
            emitted = self.emitted()
            write(emitted, folder)
            names += emitted
            for joint in self.diagnosis.joints:
                own = folder / f"joint_{joint.number}"
                own.mkdir()
                names += [f"{own.name}/{name}" for name in self.joint(joint.number).fill(own)]
        return [Path(out) / name for name in names]

    def emitted(self) -> dict[str, str]:
        """The emitted files of the arm with the friction of all joints as fitted, name -> text.

        Empty where the log does not fit the rig, has no scale in N m, or no bodies have what was identified.
        """
        arm = extended_arm(self.diagnosis)
        if arm is None:
            return {}
        origin = f"{Path(self.diagnosis.log.rig.path).name} and the model.py of each joint"
        return complete(arm, "eccentric diagnose", origin)

    def joint(self, number: int) -> DiagnosisResult:
        """The result of one joint, by its number in the columns, as `eccentric.diagnose` gives it.

        Raises:
            InputError: there is no such joint.
        """
        found = {joint.number: joint.found for joint in self.diagnosis.joints}
        if number not in found:
            raise InputError("joint", f"one of {', '.join(map(str, found))}", number)
        result = result_of(found[number], self.own)
        source = replace(result.data.source, command=arm_command(self.diagnosis))
        return replace(result, data=replace(result.data, source=source))

    def __repr__(self) -> str:
        return f"<ArmDiagnosisResult: {self.verdict}, {len(self.diagnosis.joints)} joints>"

    def _repr_html_(self) -> str:
        return self._html(self.table(), before=self.sentence)
