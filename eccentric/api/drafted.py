"""A rig drafted from a log, and a rig file checked against one: all that is wrong at once."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from eccentric.api.inputs import LogSources, read_logs
from eccentric.api.result import ResultBase, speeds_of
from eccentric.api.tables import ResultTable, with_unit
from eccentric.core import InputError, MissingValueError, counted, few, whole_file
from eccentric.drafting import (
    Draft,
    Proposal,
    RigLine,
    by_rate,
    draft_of,
    draft_of_arm,
    folded,
    log_complaints,
    toml_of,
    upright,
)
from eccentric.emission import inertial_loss, read_parameters, with_fitted
from eccentric.identification import Fit
from eccentric.identification import fit as fit_channels
from eccentric.joints import fit_arm as fit_joints
from eccentric.logs import Log, log_names
from eccentric.model import load_model, vocabulary, with_numbers
from eccentric.presentation import (
    arm_fit_lines,
    fit_document,
    fit_sentence,
    loss_sentence,
    no_inertia_sentence,
)
from eccentric.rigs import (
    Complaint,
    Rig,
    arm_rig_complaints,
    knowns_of,
    names_arm,
    read_arm,
    read_rig,
    rig_complaints,
)
from eccentric.signals import (
    Channels,
    Finding,
    Ratio,
    beside_the_rig,
    read_channels,
    read_long_joints,
    shared_cause,
)


@dataclass(frozen=True, repr=False)
class RigDraft(ResultBase):
    """A draft of a rig file.

    Attributes:
        text: the rig file as TOML, each line with its evidence as a comment.
        proposals: the channels; `left_out`: column -> why it is no channel.
        doubts: uncertain choices, one line each.
        questions: values to fill in, since no log shows them; a fit requires those in `needed`.
        ranged: constants that have a range, for which the value of a data sheet is better.
    """

    text: str
    proposals: tuple[Proposal, ...]
    left_out: Mapping[str, str]
    doubts: tuple[str, ...]
    questions: tuple[RigLine, ...]
    ranged: tuple[str, ...] = ()

    @property
    def needed(self) -> tuple[str, ...]:
        """The quantities to fill in before a fit."""
        return tuple(e.key for e in self.questions if e.needed)

    @property
    def needed_to_diagnose(self) -> tuple[str, ...]:
        """The further quantities to fill in before a diagnosis, if voltage and current are mapped."""
        if not {"voltage", "current"} <= {p.channel for p in self.proposals}:
            return ()
        return tuple(e.key for e in self.questions if e.key in ("R", "k_e") and not e.needed)

    def summary(self) -> str:
        """The channels with unit and confidence, the doubts and the questions, for a terminal."""
        width = max(len(p.channel) for p in self.proposals)
        rows = [f"  {p.channel:{width}}  {with_unit(p.column, p.unit)}" for p in self.proposals]
        rows += [f"  left out: {columns}, {why}" for columns, why in folded(self.left_out)]
        rows += [f"check: {doubt}" for doubt in self.doubts]
        more = f"; to diagnose, also {', '.join(self.needed_to_diagnose)}" if self.needed_to_diagnose else ""
        more += f"; preferably also {', '.join(self.ranged)}" if self.ranged else ""
        return "\n".join([*rows, f"still to fill in: {', '.join(self.needed) or 'nothing'}{more}"])

    def table(self) -> ResultTable:
        """A row for each channel: column, unit, confidence from 0 to 1, and the alternatives."""
        names = ("channel", "column", "unit", "confidence", "doubt")
        rows = ((p.channel, p.column, p.unit, p.confidence, p.doubt) for p in self.proposals)
        return ResultTable(names, tuple(rows))

    def __repr__(self) -> str:
        return f"<RigDraft: {counted(len(self.proposals), 'channel')}, {counted(len(self.doubts), 'doubt')}>"

    def write(self, out: str | os.PathLike[str]) -> Path:
        """Write the rig file. InputError if the file exists: a draft overwrites nothing."""
        path = Path(out)
        if path.suffix != ".toml":
            raise InputError(path, "a rig file .toml", f"{path.suffix or 'no suffix'!r}")
        if path.exists():
            problem = "expected a new file, but this one exists: choose another name, or delete it"
            raise InputError(path, problem=problem)
        with whole_file(path) as new:
            new.write_text(self.text, encoding="utf-8")
        return path


@dataclass(frozen=True, repr=False)
class RigCheck(ResultBase):
    """Problems of a rig file with a log, and the quantities that the log will determine.

    Attributes:
        complaints: problems, one line each, with the fix; empty if the rig file can be used.
        estimated: quantities that the log determines, from what, and how well, one line each; empty if there
            are complaints.
        warnings: of reading and fitting the log.
        doubts: values that were guessed from the log or that a simple torque balance contradicts, one line
            each; the rig file can still be used.
    """

    complaints: tuple[str, ...]
    estimated: tuple[str, ...]
    warnings: tuple[str, ...]
    doubts: tuple[str, ...] = ()

    def summary(self) -> str:
        """The result as text for a terminal."""
        if self.complaints:
            return "\n".join(self.complaints)
        found = (
            f"the rig can be used, but see {counted(len(self.doubts), 'doubt')}"
            if self.doubts
            else "no problems found"
        )
        return "\n".join([f"{found}; the log determines:", *(f"  {line}" for line in self.estimated)])

    def table(self) -> ResultTable:
        """A row for each line: its kind, complaint, doubt, warning or estimated, and its text."""
        kinds = {
            "complaint": self.complaints,
            "doubt": self.doubts,
            "warning": self.warnings,
            "estimated": self.estimated,
        }
        return ResultTable(("kind", "text"), tuple((kind, x) for kind, texts in kinds.items() for x in texts))

    def __repr__(self) -> str:
        return (
            f"<RigCheck: {counted(len(self.complaints), 'complaint')}, {counted(len(self.doubts), 'doubt')}>"
        )


def draft_rig(
    logs: LogSources,
    name: str | None = None,
    arm: str | os.PathLike[str] | None = None,
    *,
    rate_hz: float | None = None,
    beside: str | os.PathLike[str] = ".",
    reading: Callable[[float], None] | None = None,
) -> RigDraft:
    """Draft the rig file of a log, or of several logs of one rig, of which the longest is used.

    Args:
        logs: as in `fit`.
        name: of the rig; by default that of the log.
        arm: the path of an arm, .toml or .urdf, whose joints' columns are found by a pattern.
        rate_hz: rows per second of logs without a time column.
        beside: the folder in which the rig file of an arm will be: the path of the arm is written relative to
            it.
        reading: called with the part of the joints of an arm that is done, 0 to 1.

    Raises:
        InputError: a log or the arm cannot be read, two logs have different columns, or one shows neither
            time nor motion.
    """
    read = read_logs(logs)
    if rate_hz is not None:
        read = [by_rate(log, rate_hz) for log in read]
    if arm is None:
        draft = _draft(read)
    else:
        chain = with_numbers(read_arm(Path(arm)))
        place = Path(os.path.relpath(arm, beside)).as_posix()
        draft = draft_of_arm(_same_columns(read), chain, place, reading or (lambda _: None))
    title = name or Path(_longest(read).path).name.split(".")[0]
    if rate_hz is not None:
        draft = _without_time(draft, rate_hz)
    proposals = tuple(replace(p, channel=draft.axis.named(p.channel)) for p in draft.proposals)
    ranged = tuple(e.key for e in draft.entries if e.table == "unknown" and e.key == "k_i")
    return RigDraft(toml_of(draft, title), proposals, draft.left_out, draft.doubts, draft.questions, ranged)


def _without_time(draft: Draft, rate_hz: float) -> Draft:
    """The draft of a log whose clock is its rate."""
    rate = RigLine("", "sample_rate_hz", f"{rate_hz:g}", "as given: time is the number of the row over it")
    channels = tuple(p for p in draft.proposals if p.channel != "time")
    return replace(draft, proposals=channels, entries=(rate, *draft.entries))


def _longest(logs: Sequence[Log]) -> Log:
    return max(logs, key=lambda log: log.rows)


def _draft(logs: Sequence[Log]) -> Draft:
    return draft_of(upright(_same_columns(logs)))


def _same_columns(logs: Sequence[Log]) -> Log:
    """The longest of the logs. InputError if they have different columns."""
    for log in logs[1:]:
        if set(log.columns) != set(logs[0].columns):
            differ = few(sorted(set(log.columns) ^ set(logs[0].columns)))
            raise InputError(log.path, "the same columns", f"in some only: {differ}", why="in every log")
    return _longest(logs)


def check_rig(logs: LogSources, rig: str | os.PathLike[str] | Mapping[str, Any]) -> RigCheck:
    """Check the rig file of a drive or an arm by itself and against logs, and list all its problems at once.

    Raises:
        InputError: a log or the file cannot be read at all.
    """
    read = read_logs(logs)
    if names_arm(rig):
        return _checked_arm(read, rig)
    found, rest = rig_complaints(rig)
    usable = read_rig(rest)
    usable = _named(usable, rig)
    try:
        draft = _draft(read)
        if draft.axis is not usable.axis:
            draft = None  # no header says that this is a carriage
    except InputError:
        draft = None  # what could not be drafted can still be described by hand
    for log in read:
        found += [line for line in log_complaints(usable, log, draft, found) if line not in found]
    tried = _tried(read, usable, rest, found)
    guessed = () if draft is None else _still_guessed(draft, rest, usable.path)
    complaints = tuple(dict.fromkeys((*(one.text for one in found), *tried.complaints)))
    if complaints:
        return RigCheck(complaints, (), tried.warnings)
    return RigCheck((), tried.estimated, tried.warnings, (*guessed, *tried.doubts))


def _still_guessed(draft: Draft, content: Mapping[str, Any], path: str) -> tuple[str, ...]:
    """The values of a rig that a draft guesses from the log, which hardly shows them, one line each."""
    axis, lines = draft.axis, [entry for entry in draft.entries if entry.guessed]
    given = [content.get(e.table, {}) if e.table else content for e in lines]
    return tuple(
        f"{path}: {axis.named(entry.key)} = {entry.value} is a guess from the log: {axis.text(entry.doubt)}"
        for entry, table in zip(lines, given, strict=True)
        if table.get(draft.axis.named(entry.key)) == tomllib.loads(f"value = {entry.value}")["value"]
    )


def _checked_arm(logs: Sequence[Log], source: str | os.PathLike[str] | Mapping[str, Any]) -> RigCheck:
    """The same for the rig of an arm: its columns joint by joint, then a fit of all of them."""
    errors, rig = arm_rig_complaints(source)
    found = [*map(str, errors)]
    for joint in () if rig is None else rig.joints:
        told = (one.text for log in logs for one in log_complaints(joint, log, None))
        found += [line for line in dict.fromkeys(told) if line not in found]
    if rig is None or found:
        return RigCheck(tuple(found), (), ())
    try:
        fit = fit_joints(read_long_joints(logs, rig), rig, log_names(logs), lambda _: None)
    except InputError as error:
        return RigCheck((str(error),), (), ())
    head, *lines = arm_fit_lines(fit)
    if not fit.fits_the_rig:
        return RigCheck((f"{rig.path}: {lines[-1]}",), (), fit.warnings)
    return RigCheck((), (head, *lines), fit.warnings)


def _named(rig: Rig, source: object) -> Rig:
    return replace(rig, path=str(source)) if isinstance(source, str | os.PathLike) else rig


_TYPICAL = {
    "M": "0.5 kg",
    "M_l": "0.2 kg",
    "L": "0.3 m",
    "mu": "1",
    "R": "1 ohm",
    "k_i": "0.05 N m/A",
    "k_e": "0.05 V s/rad",
}
_INSTEAD = {
    "M": ' ("0 kg" for a bare motor)',
    "L": ' ("0 m" for a bare motor)',
    "M_l": ', or a range: [unknown] M_l = ["0 kg", "0.5 kg"]',
}


def _tried(
    logs: Sequence[Log], rig: Rig, content: Mapping[str, Any], complaints: Sequence[Complaint]
) -> RigCheck:
    """Fit, and name every quantity that is missing, each once, with a typical value in its place.

    With all of them there, name what the log contradicts.
    """
    missing: list[str] = []
    given, filled = dict(content), False
    for _ in range(len(_TYPICAL) + 1):
        tried = _named(read_rig(given), rig.path)
        try:
            channels = read_channels(logs, tried)
            fit = fit_channels(channels, channels.rig, load_model(channels.rig.model), few(log_names(logs)))
        except InputError as error:
            letter = error.letter if isinstance(error, MissingValueError) else ""
            axis = tried.axis
            if letter not in _TYPICAL or letter in tried.known:
                # What follows from a complaint that is already made would only be noise.
                return RigCheck((*missing, *([] if complaints else [str(error)])), (), ())
            here = axis.named(letter)
            keys = {here, *(known.key for known in knowns_of(tried.axis) if known.name == letter)}
            if not any(one.table == "known" and one.key in keys for one in complaints):
                missing.append(
                    f"{rig.path}: expected [known] {here}, as in"
                    f' {here} = "{axis.unit(_TYPICAL[letter])}"{_INSTEAD.get(letter, "")}, got none'
                )
            filled = True
            given = {**given, "known": {**given.get("known", {}), here: axis.unit(_TYPICAL[letter])}}
            continue
        # A value that was filled in, and a wrong column, gear or encoder, contradict the log by themselves.
        wrong = {(one.table, one.key) for one in complaints}
        scale = {("known", "mu"), ("", "encoder_counts_per_rev")}
        if filled or scale & wrong or any(table == "columns" for table, _ in wrong):
            return RigCheck(tuple(missing), (), ())
        contradicted = [f"{rig.path}: {_with_mend(f)}" for f in channels.intake.findings if _grave(f)]
        if not contradicted and not fit.fits_the_rig:
            contradicted = [f"{rig.path}: {fit_sentence(fit)}"]
        if contradicted:
            return RigCheck(tuple(contradicted), (), ())
        beside = beside_the_rig(channels, tried)
        determined = *_determined(fit, tried, channels.motor.measured_by), *map(_beside, beside)
        warnings = (*fit.warnings, *_of_the_diagnosis(channels, tried))
        doubts = *_doubted(beside, channels, tried), *_too_long(fit, tried), *_unsolvable(fit, tried)
        doubts = *doubts, *_without_inertia(fit, tried)
        return RigCheck((), determined, warnings, doubts)
    return RigCheck(tuple(missing), (), ())


def _doubted(beside: Sequence[Ratio], channels: Channels, rig: Rig) -> Iterator[str]:
    """The declared values that a plain balance of the log does not give; one line if one cause explains all.

    A torque constant by gravity says of the mass and its arm what M g L would say again: where the inertia
    agrees with the rig, they are what differs, else the constant is.
    """
    doubted = [ratio for ratio in beside if ratio.doubts_the_rig]
    if len(doubted) > 1 and (shared := shared_cause(beside, channels, rig)):
        said, mend = shared
        yield f"{rig.path}: {said}: {', '.join(map(_beside, doubted))}{f': write {mend}' if mend else ''}"
        return
    inertia = any(ratio.letter == "J" and ratio.low > 0.0 and ratio.near(1.0) for ratio in beside)
    letters = {ratio.letter for ratio in doubted}
    for ratio in doubted:
        if {"k_i", "M g L"} <= letters and ratio.letter == ("k_i" if inertia else "M g L"):
            continue
        which = "M and L" if ratio.letter == "M g L" else rig.axis.named(ratio.letter)
        yield f"{rig.path}: {_beside(ratio)}: check {which}{_unless(ratio)}"


COPPER = 0.0039
"""Rise of the resistance of copper per kelvin, from 20 degC."""


def _unless(ratio: Ratio) -> str:
    """What else accounts for a difference."""
    if ratio.letter == "R":
        warmer = (ratio.value - 1.0) / COPPER
        return f", unless the winding was {warmer:.0f} K warmer" if 0.0 < warmer < 150.0 else ""
    if ratio.letter == "k_e":
        return ""
    return ", unless friction missing from the model accounts for the difference"


def _too_long(fit: Any, rig: Rig) -> Iterator[str]:
    """Friction per normal force, where it is longer than the link: it acts at a radius of the bearing."""
    e, arm = fit.coefficients.get("C_lN"), rig.known.get("L")
    if e is not None and arm is not None and e.interval[0] > arm:
        low, high = e.interval
        yield (
            f"{rig.path}: C_lN is {e.value:.3g} m in the log ({low:.3g} to {high:.3g}), longer than the link"
            f" of {arm:.3g} m, although it acts at the radius of the bearing: check mu, M and M_l"
        )


def _without_inertia(fit: Fit, rig: Rig) -> Iterator[str]:
    """An inertia that the fit puts at 0, with which a diagnosis has no motion to explain."""
    inertias = [c for c in fit.problem.coefficients if c.role == "inertia"]
    for name in dict.fromkeys(x for c in inertias for x in (c.name, c.letter)):
        if name in fit.coefficients and fit.coefficients[name].value <= 0.0:
            yield f"{rig.path}: {no_inertia_sentence(name, rig.axis)}"


def _unsolvable(fit: Fit, rig: Rig) -> Iterator[str]:
    """Friction that takes more of an acceleration than the inertia, by the values of the fit."""
    document = fit_document(fit, [])
    model = with_fitted(fit.problem.model, read_parameters(document), fit.problem.model.name)
    loss = inertial_loss(model, *speeds_of(document)[1:])
    if loss is not None and not loss.solvable:
        yield f"{rig.path}: {loss_sentence(loss, rig.axis)}"


def _beside(ratio: Ratio) -> str:
    """What a plain balance of the log gives for a declared value, beside this."""
    low, high = sorted(ratio.found / ratio.value * end for end in (ratio.low, ratio.high))
    percent = round(100 * (ratio.value - 1)) or 0  # no "-0 %"
    return f"{ratio.text} ({percent:+d} %; {low:.3g} to {high:.3g})"


def _of_the_diagnosis(channels: Channels, rig: Rig) -> Iterator[str]:
    """What a diagnosis requires beyond a fit."""
    motor = channels.motor
    missing = sorted({"R", "k_e"} - set(rig.known))
    if motor.measured_by == "current" and motor.voltage is not None and missing:
        here = " and ".join(map(rig.axis.named, missing))
        yield (
            f"{rig.path}: a fit can use this rig; diagnose also requires [known] {here}, since current and"
            " voltage are mapped, or no voltage in [columns]"
        )


def _grave(finding: Finding) -> bool:
    """Whether log and rig contradict each other, or two of the rig's values in view of the log."""
    return finding.doubts_the_rig or finding.kind == "contradiction"


def _with_mend(finding: Finding) -> str:
    return f"{finding.text}: write {finding.mend}" if finding.mend else finding.text


def _determined(fit: Any, rig: Rig, drive: str) -> list[str]:
    """Each estimate with its interval, and what of the motion and the `drive` it follows from."""
    lines, axis, inertia = [], rig.axis, rig.axis.term("inertia")
    meaning = {
        "J": "the acceleration", "J_m": "the acceleration", "J_l": "the acceleration",
        "k_i": f"gravity and {inertia} against the {axis.term(drive)}", "M_l": "the load of the bearing",
        "L": "gravity", "phi": "gravity", "T_load": "what is constant in both directions",
        **dict.fromkeys(
            ("1", "R/k_i"), f"what the rig gives of gravity, {inertia} and load, against the drive"
        ),
        "theta_zero_rad": "the phase of gravity",
        "input_delay_s": "the lag of the motion", "voltage_offset_V": "what is constant in both directions",
    }  # fmt: skip
    for name, e in {**fit.coefficients, **fit.searched}.items():
        low, high = e.interval
        # A scaled one, such as J/k_i or J*R/k_i, is of its own letter.
        letters = (name, *name.partition("/")[0].split("*"))
        source = next((meaning[x] for x in letters if x in meaning), "the friction of moving rows")
        value = f"{axis.named(name)} = {e.value:.4g} {axis.unit(e.unit)}"
        lines.append(f"{value}, 95 % interval {low:.4g} to {high:.4g}, from {source}")
    lines += [f"{axis.named(name)}: estimated along with the fit" for name in sorted(rig.estimate)]
    # What follows from the case, and the usual g, nobody needs to have written.
    usual = {"g"} if rig.known.get("g") == float(vocabulary.g.default or "nan") else set[str]()
    by_default = usual | ({"phi"} if rig.case else set())
    given = [axis.named(k.name) for k in knowns_of(axis) if k.name in rig.known and k.name not in by_default]
    return [*lines, f"taken from the rig file: {few(given)}"] if given else lines
