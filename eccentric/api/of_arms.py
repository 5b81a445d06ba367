"""`eccentric.fit_arm`, `eccentric.diagnose_arm`: every joint of an arm, and the results."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from eccentric.api.diagnosed import DiagnosisResult, result_of
from eccentric.api.inputs import LogSources, names_given, read_logs, sources_of
from eccentric.api.result import FittedModel, Printed, fitted_model
from eccentric.api.tables import LabelledMatrix, ResultTable
from eccentric.core import InputError, given_path, whole_folder
from eccentric.diagnosis import SearchRequest
from eccentric.emission import complete, write
from eccentric.identification import Refit
from eccentric.joints import ArmDiagnosis, ArmFit, JointFit, extended_arm, predicted
from eccentric.joints import diagnose_arm as diagnose_logs
from eccentric.joints import fit_arm as fit_logs
from eccentric.logs import log_names
from eccentric.model import TURNING
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

ArmRigSource: TypeAlias = str | os.PathLike[str] | Mapping[str, Any] | ArmRig
_BEFORE, _AFTER = "#8a8a8a", "#0072b2"


def fit_arm(
    logs: LogSources,
    rig: ArmRigSource,
    progress: Callable[[str], None] | None = None,
    *,
    reading: Callable[[float], None] | None = None,
) -> ArmFitResult:
    """Fit the friction of every joint of an arm, as Coulomb and viscous friction and as load-dependent.

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
        fitted=_models({joint.number: joint.followed for joint in found.joints}),
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
    """Find the effects that the friction model of each joint of an arm is missing.

    Args:
        logs, rig, progress, reading: as `fit_arm` takes them.
        effects: the path of a Python file with your own effects.
        without, only: effects or families not to search for, or the only ones to search for.
        empirical: whether each joint also gets an empirical term, as in `diagnose`.

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
        fitted=_models({joint.number: joint.found.models.extended for joint in found.joints}),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class ArmResult(Printed):
    """What the results of an arm have in common: members by joint, "joint_1" and so on.

    `parameters` has a mapping for each joint; in `covariance` and `correlation` an estimate is named with its
    joint, "B_m@1", and NaN stands between two joints, which are estimated from different balances.
    """

    @property
    def parameters(self) -> dict[str, dict[str, float]]:
        """Joint -> every parameter of its fitted model by the paper's letters, in SI."""
        return {name: dict(model.parameters) for name, model in self.fitted.items()}

    @property
    def covariance(self) -> LabelledMatrix:
        """Covariance (n, n) of the errors of the estimates of all joints, by name and joint; NaN between."""
        blocks = {name.removeprefix("joint_"): model.covariance for name, model in self.fitted.items()}
        names = [f"{one}@{joint}" for joint, block in blocks.items() for one in block.names]
        matrix, first = np.full((len(names), len(names)), np.nan), 0
        for block in blocks.values():
            last = first + len(block.names)
            matrix[first:last, first:last] = block.matrix
            first = last
        return LabelledMatrix(names, matrix)

    @property
    def rmse(self) -> dict[str, dict[str, float]]:
        """Joint -> model -> error on the held-out rows, in the unit of the joint's row in `table`."""
        raise NotImplementedError

    def _layout(self) -> tuple[tuple[int, int], tuple[float, float]]:
        return (1, 1), (2.5 + 1.1 * len(self.rmse), 3.6)

    def _draw_bars(self, ax: Any, scales: Sequence[float], labels: Mapping[str, str]) -> None:
        """Draw the held-out error of each joint over a scale of its own, a bar for each model in `labels`."""
        places = np.arange(len(scales))
        for shift, color, (name, label) in zip((-0.2, 0.2), (_BEFORE, _AFTER), labels.items(), strict=True):
            sizes = [
                100.0 * rmse[name] / scale for rmse, scale in zip(self.rmse.values(), scales, strict=True)
            ]
            ax.bar(places + shift, sizes, 0.38, color=color, label=label)
        ax.set_xticks(list(places), [name.replace("_", " ") for name in self.rmse])
        ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)


@dataclass(frozen=True, eq=False, kw_only=True)
class ArmFitResult(ArmResult):
    """The friction of every joint of an arm. It prints as `summary()` and shows as a table in a notebook.

    Attributes:
        fit: everything that was found, joint by joint.
        lines, warnings, document: as in Printed; the document is the content of fit.json.
    """

    fit: ArmFit

    @property
    def fits_the_rig(self) -> bool:
        """Whether the log can be from this arm, in these units."""
        return self.fit.fits_the_rig

    @property
    def rmse(self) -> dict[str, dict[str, float]]:
        """Joint -> model ("linear", "followed", "every") -> held-out error, in the joint's unit."""
        return {f"joint_{joint.number}": dict(joint.rmse) for joint in self.fit.joints}

    def table(self) -> ResultTable:
        """A row for each joint: the load its friction follows, held-out errors, gain and 95 % interval."""
        names = ("joint", "name", "follows", "linear", "followed", "percent", "lower", "upper", "unit")
        rows = (
            (j.number, j.name, "+".join(j.loads.followed), *_errors(j), j.percent, *j.interval, j.unit)
            for j in self.fit.joints
        )
        return ResultTable(names, tuple(rows))

    def _draw(self, axes: list[Any]) -> None:
        """The held-out error of each joint before and after, over the RMS of its drive."""
        labels = {"linear": "Coulomb + viscous", "followed": "with the loads that it follows"}
        self._draw_bars(axes[0], [joint.torque_rms for joint in self.fit.joints], labels)
        axes[0].set_ylabel("held-out RMSE [% of the drive's RMS]")

    def predict(
        self, logs: LogSources, rig: ArmRigSource | None = None, model: str | None = None
    ) -> dict[str, NDArray[np.float64]]:
        """Joint -> predicted drive signal (m,) on its m moving rows, in the unit of its errors.

        Args:
            logs: as `fit_arm` takes them.
            rig: of these logs; by default that of the fit.
            model: of `parameters`, one joint alone; by default all of them.

        Raises:
            InputError: a log cannot be read or is of another arm; there is no such joint.
        """
        found = self._runs(logs, rig, model)
        return {name: drive - left for name, (drive, left) in found.items()}

    def residual(
        self, logs: LogSources, rig: ArmRigSource | None = None, model: str | None = None
    ) -> dict[str, NDArray[np.float64]]:
        """Joint -> measured minus predicted drive (m,), with the arguments and errors of `predict`."""
        return {name: left for name, (_, left) in self._runs(logs, rig, model).items()}

    def _runs(
        self, logs: LogSources, rig: ArmRigSource | None, model: str | None
    ) -> dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]:
        if model is not None:
            self._model(model)
        fit = self.fit if rig is None else replace(self.fit, log=replace(self.fit.log, rig=read_arm_rig(rig)))
        runs = predicted(fit, read_logs(logs), ())
        found = zip(self.fitted, zip(runs.drives, runs.residuals, strict=True), strict=True)
        return {name: pair for name, pair in found if model in (None, name)}

    def write(self, out: str | os.PathLike[str]) -> list[Path]:
        """Write fit.json and, with matplotlib, fit.png and fit.svg into a folder of their own.

        Raises:
            InputError: the folder cannot be written.
        """
        return self._write(out, "fit")

    def __repr__(self) -> str:
        return f"<ArmFitResult: {len(self.fit.joints)} joints of {self.fit.log.rig.chain.name}>"

    def _repr_html_(self) -> str:
        return self._html(self.table(), after=self.lines[-1])


def _models(joints: Mapping[int, Refit]) -> dict[str, FittedModel]:
    """The fitted models of the joints; one of them alone predicts nothing, since the others load it."""
    found = ((f"joint_{number}", fitted_model(fit, TURNING)) for number, fit in joints.items())
    return {name: replace(model, drive=None) for name, model in found}


def _errors(joint: JointFit) -> tuple[float, float]:
    return joint.rmse["linear"], joint.rmse["followed"]


@dataclass(frozen=True, eq=False, kw_only=True)
class ArmDiagnosisResult(ArmResult):
    """Diagnosis of every joint of an arm. It prints as `summary()` and shows as a table in a notebook.

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
        """(joint number, id) of each named effect, those with the largest gain first."""
        return tuple((joint.number, effect.id) for joint, effect in self.diagnosis.named)

    @property
    def sentence(self) -> str:
        """The result in one sentence."""
        return arm_diagnosis_sentence(self.diagnosis)

    @property
    def fits_the_rig(self) -> bool:
        """Whether the log can be from this arm, in these units."""
        return self.diagnosis.fits_the_rig

    @property
    def rmse(self) -> dict[str, dict[str, float]]:
        """Joint -> model ("linear", "paper", "extended") -> held-out error of its balance, in its unit."""
        errors = ((joint.number, joint.found.score.rmse["mechanical"]) for joint in self.diagnosis.joints)
        return {f"joint_{number}": dict(rmse) for number, rmse in errors}

    def _draw(self, axes: list[Any]) -> None:
        """The held-out error of each joint before and after, over that of Coulomb + viscous friction."""
        labels = {"paper": "the loads that it follows", "extended": "named effects"}
        self._draw_bars(axes[0], [rmse["linear"] for rmse in self.rmse.values()], labels)
        axes[0].set_ylabel("held-out RMSE [% of Coulomb + viscous]")

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
        """Write the report and JSON of the arm, the emitted arm, and the files of `diagnose` for each joint.

        The emitted arm has the friction of every joint as fitted, effects included; it is omitted if the log
        does not fit the rig or has no scale in N m. A joint's folder, joint_NUMBER, has its report, its
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

        Empty if the log does not fit the rig, has no scale in N m, or identifies values that no bodies can
        have.
        """
        arm = extended_arm(self.diagnosis)
        if arm is None:
            return {}
        origin = f"{Path(self.diagnosis.log.rig.path).name} and the model.py of each joint"
        return complete(arm, "eccentric diagnose", origin)

    def joint(self, number: int) -> DiagnosisResult:
        """The result of one joint, by its number in the columns, as `eccentric.diagnose` returns it.

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
