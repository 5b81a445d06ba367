"""`eccentric.diagnose`: what the model lacks on logs, and the extended model."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from eccentric.api.inputs import LogSources, ModelSource, RigSource, by_name, names_given, sources_of
from eccentric.api.result import Result, cut_levels_of, fitted_model, placeholders_of, speeds_of
from eccentric.api.tables import ResultTable
from eccentric.core import InputError, given_path, whole_file, whole_folder
from eccentric.diagnosis import (
    BASE,
    Diagnosis,
    SearchRequest,
    base_source,
    extended_model,
    is_result_name,
    script,
)
from eccentric.diagnosis import diagnose as diagnose_logs
from eccentric.emission import complete, inertial_loss, write
from eccentric.model import Model
from eccentric.presentation import (
    Parameter,
    ReportData,
    cut_sentences,
    cuts_document,
    diagnosis_document,
    diagnosis_lines,
    horizons_document,
    not_emitted,
    page,
    plot_report,
    report_data,
)
from eccentric.rigs import read_rig
from eccentric.signals import read_long
from eccentric.simulation import draws_of_refit, simulated_errors

_WRITTEN = (
    ("diagnosis.json", "the results on this page, for programs"),
    (
        "model.py",
        "the extended model as a derivation: python model.py prints it, eccentric emit model.py emits it",
    ),
)
_BASE = "the base model, as provided"
_EMITTED = {
    ".py": "the extended model in NumPy",
    "eccentric_runtime.py": "the runtime of every emitted NumPy module",
    ".h": "its C99 header",
    ".c": "its C99 source",
    "_selftest.c": "a self-test of the source, for your board",
    "_vectors.h": "the reference values of the self-test",
    "_proof.c": "a driver to prove that the source is free of undefined behaviour",
}


def diagnose(
    logs: LogSources,
    rig: RigSource,
    model: ModelSource | None = None,
    effects: str | os.PathLike[str] | None = None,
    progress: Callable[[str], None] | None = None,
    *,
    including: str | Sequence[str] = (),
    without: str | Sequence[str] = (),
    only: str | Sequence[str] = (),
    empirical: bool = False,
    reading: Callable[[float], None] | None = None,
) -> DiagnosisResult:
    """Find the effects that a friction model is missing on the logs of a rig, add them, and score the result.

    Args:
        logs: one log or a list of them: paths, tables in memory (a dict of arrays, or a table of pandas,
            polars or pyarrow) or what `read_log` returned.
        rig: what is known about the rig: the path of a rig file, its content as a mapping, or what `read_rig`
            returned.
        model: the base model: a Model, its name, or the path of a derivation; by default that of the rig's
            case. It may already be extended, such as the `model` of an earlier result: all friction
            coefficients are fitted, including those of its effects; other values of its effects, such as the
            amplitude of cogging, are kept.
        effects: the path of a Python file with your own effects.
        progress: called with one line for each stage.
        including: effects to include from the start, so that the verdict is about the rest: one or several
            families or ids, of the library or your own. Their shapes are those that fit the training part
            best; their friction coefficients are fitted with the rest.
        without: effects or families not to search for.
        only: the only effects or families to search for; all if empty.
        empirical: whether the resulting model also gets an empirical term, smooth in the one or two variables
            that the remaining residual depends on; verdict and named effects stay the same.
        reading: called with the part of the rows read, 0 to 1, while logs of more than 100,000 rows are read.

    Raises:
        InputError: a log, the rig, the model or the effects cannot be read, or do not belong together; the
            model has a tilt in a level plane, hidden states, or an effect of the current; the log has too few
            rows; or an effect is unknown.
    """
    base, offered = by_name(model), None if effects is None else given_path(effects, "effects")
    paths = _scripts(offered, base)
    asked = names_given(including), names_given(without), names_given(only)
    request = SearchRequest(*asked, empirical)
    sources, rig = sources_of(logs), read_rig(rig)
    read = read_long(sources, rig, tell=reading)
    found = diagnose_logs(read, rig, base, offered, request, progress)
    return result_of(found, {path.name: path.read_text(encoding="utf-8") for path in paths})


def result_of(found: Diagnosis, own: Mapping[str, str]) -> DiagnosisResult:
    """The result of a diagnosis; `own` are the scripts that it loads, name -> text."""
    given, axis, models = found.asked.base, found.rig.axis, found.models
    fits = {"linear": models.linear, "paper": models.paper, "extended": models.extended}
    simulated = simulated_errors(fits)
    document, estimates = diagnosis_document(found), axis.estimates(found.result.estimates)
    model, data = extended_model(found), report_data(found, simulated)
    unsolvable = not_emitted(inertial_loss(model, *speeds_of(document)[1:]), axis)
    cut = cut_levels_of(model, document, found.channels)
    warnings = (*unsolvable, *cut_sentences(cut, axis))
    document |= {"warnings": [*document["warnings"], *warnings], **cuts_document(cut, axis)}
    log = dataclasses.replace(data.log, warnings=(*data.log.warnings, *warnings))
    fitted = {name: fitted_model(fit, axis) for name, fit in reversed([*fits.items()])}
    if found.data.drive.along is not None:
        fitted = {name: dataclasses.replace(model, drive=None) for name, model in fitted.items()}
    return DiagnosisResult(
        model=model,
        origin="model.py",
        estimates=estimates,
        fitted=fitted,
        draws=draws_of_refit(found.result).without(placeholders_of(found.result)),
        script=script(found),
        own={**own} | ({BASE: base_source(given)} if isinstance(given, Model) else {}),
        warnings=tuple(document["warnings"]),
        lines=tuple(diagnosis_lines(found)),
        solvable=not unsolvable,
        data=dataclasses.replace(data, log=log),
        document=document | {"simulated": None if simulated is None else horizons_document(simulated)},
    )


def _scripts(effects: Path | None, model: str | Model | None) -> tuple[Path, ...]:
    """The user's own scripts, copied with the result; InputError if a name clashes with its files."""
    taken = {"model.py"} | ({BASE} if isinstance(model, Model) else set())
    given = (effects, None if isinstance(model, Model) else model)
    own = tuple(Path(one) for one in given if one is not None and Path(one).suffix == ".py")
    for one in own:
        if one.name in taken or is_result_name(one.stem):
            raise InputError(one, problem="expected a name that no file of the result has")
    if len({one.resolve() for one in own}) > len(called := {one.name for one in own}):
        raise InputError("effects and model", "files of different names", f"{called.pop()} twice")
    return own


@dataclass(frozen=True, eq=False, kw_only=True)
class DiagnosisResult(Result):
    """The result of a diagnosis. It prints as `summary()`, shows as tables in a notebook, and can be pickled.

    Attributes:
        script: the derivation of the extended model, the text of model.py.
        own: name -> text of the scripts that it loads: your own, and base.py if the base model was given as a
            Model.
        solvable: whether friction takes less of an acceleration than the inertia; otherwise a time step has
            no single solution, and the model is not emitted.
        data: the content of the report.
        model, origin, estimates, lines, warnings, document, fitted: as in Result; the model is the
            extended one, without an adopted effect the base model, fitted; the document is the content of
            diagnosis.json.
    """

    script: str
    own: Mapping[str, str]
    solvable: bool
    data: ReportData

    @property
    def verdict(self) -> str:
        """named, not_identifiable, unexplained or nothing_missing."""
        return self.data.conclusion.verdict

    @property
    def sentence(self) -> str:
        """The result in one sentence."""
        return self.data.conclusion.sentence

    @property
    def effects(self) -> tuple[str, ...]:
        """Ids of the effects that the model was missing, in order of adoption; empty if none is named."""
        return tuple(effect["id"] for effect in self.document["effects"])

    @property
    def rmse(self) -> dict[str, dict[str, float]]:
        """Balance -> model ("linear", "paper", "extended") -> error on the held-out rows in `unit`."""
        return {balance.name: dict(balance.rmse) for balance in self.data.errors.balances}

    @property
    def unit(self) -> str:
        """Unit of the errors: "N m"; that of the drive if the log does not determine a torque."""
        return self.data.errors.balances[0].unit

    @property
    def improvement(self) -> float:
        """Reduction of the held-out error by the effects, in percent."""
        return self.document["improvement"]["percent"]

    @property
    def improvement_interval(self) -> tuple[float, float]:
        """The 95 % interval of the improvement, in percent."""
        low, high = self.document["improvement"]["interval_95"]
        return low, high

    @property
    def depends_on(self) -> tuple[str, ...]:
        """Variables that the residual of the paper's model depends on, strongest first."""
        return self.data.conclusion.depends_on

    @property
    def next_measurement(self) -> str:
        """What to measure next; "" if nothing is open."""
        return self.data.conclusion.next_measurement

    def table(self) -> ResultTable:
        """The parameters of the extended model: value, standard error, 95 % interval, unit, bound, origin.

        The origin is "effect" or "friction" (fitted), "estimated" (jointly with them), "part of J_m + mu^2
        J_l" or another combination (which alone is identified), "rig" (known), "model" (the base model's own
        value, not fitted) or "unseen" (nothing in the log depends on it). Motor constants that are neither
        known nor identified are left out.
        """
        names = ("name", "value", "std_error", "lower", "upper", "unit", "bound", "origin")
        return ResultTable(names, tuple(map(_row, self.data.extended.parameters)))

    def candidates(self) -> ResultTable:
        """The effects considered, best first: cross-validated RMSE, probability among families.

        Tied effects count as not adopted, although the extended model contains the first of them.
        """
        names, tied = ("id", "family", "balance", "rmse", "probability", "adopted"), self.data.search.tied
        rows = (
            (c.id, c.family, c.balance, c.rmse, c.probability, c.adopted and c.family not in tied)
            for c in self.data.search.candidates
        )
        return ResultTable(names, tuple(rows))

    def _layout(self) -> tuple[tuple[int, int], tuple[float, float]]:
        return (1, 2), (9.0, 4.2)

    def _draw(self, axes: list[Any]) -> None:
        """The residual before and after over what it depends on, and friction over the motor velocity."""
        plot_report(self.data, *axes)

    def report(self, path: str | os.PathLike[str]) -> Path:
        """Write the report, one HTML file that opens offline; return its path.

        Raises:
            InputError: it cannot be written.
        """
        with whole_file(path) as new:
            new.write_text(page(self.data), encoding="utf-8")
        return Path(path)

    def write(self, out: str | os.PathLike[str]) -> list[Path]:
        """Write the files of `eccentric diagnose`: report, JSON, script and the emitted model.

        The emitted model is omitted if the log does not fit the rig, and if friction takes as much of an
        acceleration as the inertia.

        Raises:
            InputError: the folder cannot be written.
        """
        with whole_folder(out, "diagnose") as folder:
            names = self.fill(folder)
        return [Path(out) / name for name in names]

    def fill(self, folder: Path) -> Sequence[str]:
        """Write the files of `write` into an existing folder; return their names."""
        (folder / "diagnosis.json").write_text(self.to_json(), encoding="utf-8")
        (folder / "model.py").write_text(self.script, encoding="utf-8")
        for name, text in self.own.items():
            (folder / name).write_text(text, encoding="utf-8")
        holds = self.fits_the_rig and self.solvable
        emitted = complete(self.model, "eccentric diagnose", "model.py") if holds else {}
        write(emitted, folder)
        text = page(dataclasses.replace(self.data, files=_described(self.own, emitted, self.model)))
        (folder / "report.html").write_text(text, encoding="utf-8")
        return ["report.html", "diagnosis.json", "model.py", *self.own, *emitted]

    def __repr__(self) -> str:
        return f"<DiagnosisResult: {self.verdict}{': ' if self.effects else ''}{', '.join(self.effects)}>"

    def _repr_html_(self) -> str:
        return self._html(self.table(), before=self.sentence)


def _row(p: Parameter) -> tuple[Any, ...]:
    low, high = p.interval or (None, None)
    origin = f"part of {p.part_of}" if p.origin == "part" else p.origin
    return (p.name, p.value, p.std_error, low, high, p.unit, p.bound, origin)


def _described(own: Iterable[str], emitted: Iterable[str], model: Model) -> tuple[tuple[str, str], ...]:
    """(name, what it is) of the files beside a report; `own` are the scripts that the model loads."""
    files = (
        *_WRITTEN,
        *((name, _BASE if name == BASE else "your own script") for name in own),
        *((name, _EMITTED[name.rpartition(model.name)[2]]) for name in emitted),
    )
    kind = "extended" if model.extensions else "fitted"
    return tuple((name, what.replace("extended", kind)) for name, what in files)
