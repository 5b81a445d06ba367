"""A rig file held against a log: columns that are not there, units and channels that it contradicts."""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Iterator, Mapping
from typing import Any

from eccentric.core import InputError, few, meant
from eccentric.drafting.draft import Draft
from eccentric.drafting.proposal import Proposal
from eccentric.drafting.words import read_name
from eccentric.logs import Log, evaluate, is_arithmetic, parse_unit
from eccentric.rigs import CHANNELS, COASTING, ColumnSource, Complaint, Rig, channels_of, gain_of

_SIDES = ({"theta_m", "theta_l"}, {"omega_m", "omega_l"}, {"torque", "torque_l"})


def log_complaints(
    rig: Rig, log: Log, draft: Draft | None, told: Collection[Complaint] = ()
) -> list[Complaint]:
    """What is wrong with the columns of a rig for this log, each with the mend.

    Args:
        draft: of the same log, None where none could be made; only what it is sure of counts.
        told: what is wrong with the rig by itself: a column that it refuses is not missing as well.
    """
    without_gain = [*_without_gain(rig, log)]
    found = [*_missing(rig, log, told), *without_gain]
    if draft is not None:
        found += [*_contradicted(rig, draft, {one.key for one in without_gain}), *_values(rig, draft)]
    return found


def _sources(rig: Rig, log: Log) -> dict[str, str]:
    if rig.log.columns is None:
        return {c: column for c, (column, _) in channels_of(rig.axis).items() if column in log.columns}
    return {c: source.text for c, source in rig.log.columns.items()}


def _missing(rig: Rig, log: Log, told: Collection[Complaint]) -> Iterator[Complaint]:
    sources = _sources(rig, log)
    refused = {one.key for one in told if one.table == "columns"}
    for channel, text in sources.items():
        called = rig.axis.named(channel)
        if text in log.columns:
            if channel != "run":
                try:
                    log.numbers(text)
                except InputError as error:
                    yield Complaint(str(error), "columns", called)
            continue
        if not is_arithmetic(text, log.columns):
            hint = meant(text, log.columns) or f"; the log has {few(log.columns)}"
            line = f"{rig.path}: [columns] {called}: no column {text!r} in {log.path}{hint}"
            yield Complaint(line, "columns", called)
            continue
        try:
            evaluate(text, log.numbers, f"{rig.path}: [columns] {called}")
        except InputError as error:
            yield Complaint(str(error), "columns", called)
    for choice in (
        ("time",),
        ("theta_m", "theta_l", "omega_m", "omega_l"),
        ("current", "torque", "torque_l", "voltage"),
    ):
        names = [rig.axis.named(channel) for channel in choice if channel in channels_of(rig.axis)]
        if choice == ("time",) and rig.log.sample_rate_hz is not None:
            continue
        if "theta_m" in choice and rig.log.events:
            continue  # each row is a turn
        if choice[0] == "current" and rig.log.drive == COASTING:
            continue
        if refused.isdisjoint(names) and not any(channel in sources for channel in choice):
            yield Complaint(
                f"{rig.path}: [columns]: expected {' or '.join(names)}, got none; the log has"
                f" {few(log.columns)}",
                "columns",
            )


def _without_gain(rig: Rig, log: Log) -> Iterator[Complaint]:
    """A force column whose header says volts or amperes, without a gain."""
    for channel, source in (rig.log.columns or {}).items():
        plain = source.text.removeprefix("-").strip("` ")
        # A unit that the rig states outranks a name.
        if source.gain is not None or source.unit is not None or plain not in log.columns:
            continue
        unit = read_name(plain, log.units.get(plain, "")).unit
        if gain := gain_of(channels_of(rig.axis)[channel][1], unit):
            called = rig.axis.named(channel)
            column = json.dumps(source.text, ensure_ascii=False)
            line = (
                f"{rig.path}: [columns] {called}: {plain!r} is in {unit} by its header: give the gain of the"
                f' amplifier, as in {called} = {{ column = {column}, gain = "35 {gain}" }}'
            )
            yield Complaint(line, "columns", called)


def _contradicted(rig: Rig, draft: Draft, told: Collection[str]) -> Iterator[Complaint]:
    """Channels and units that the log shows otherwise, where it leaves no doubt; `told` are done with."""
    sources, here = rig.log.columns or {}, rig.axis.named
    by_column = {p.source: p for p in draft.proposals}
    for channel, source in sources.items():
        proposal = by_column.get(source.text.strip("`"))
        if proposal is None or proposal.doubt or here(channel) in told:
            continue
        if not _same(channel, proposal.channel):
            right, seen = here(proposal.channel), f"{here(proposal.channel)} there"
            said = f" = {json.dumps(source.text)}:"
        elif CHANNELS[channel][1] and not _same_unit(source, proposal, rig.log.counts_per_rev):
            right, seen = here(channel), proposal.unit
            unit = source.unit.text if source.unit is not None else here(CHANNELS[channel][1])
            said = f": {source.text!r} is read in {unit},"
        else:
            continue
        seen = f"the log shows {seen} ({'; '.join(proposal.evidence)}): write {_line(proposal, right)}"
        yield Complaint(f"{rig.path}: [columns] {here(channel)}{said} {seen}", "columns", here(channel))


def _same_unit(source: ColumnSource, proposal: Proposal, counts: float | None) -> bool:
    """Whether a column is read in the unit that the log shows, as far as it shows one."""
    if "counts" in proposal.unit and counts is None:
        return True
    own = source.unit.factor if source.unit is not None else 1.0
    return math.isclose(own, parse_unit(proposal.unit, "", counts or 1.0).factor, rel_tol=0.01)


def _same(channel: str, other: str) -> bool:
    return channel == other or any({channel, other} <= both for both in _SIDES)


def _line(proposal: Proposal, channel: str) -> str:
    column = json.dumps(proposal.column, ensure_ascii=False)
    unit = f', unit = "{proposal.unit}"' if proposal.unit else ""
    return f"{channel} = {{ column = {column}{unit} }}"


def _values(rig: Rig, draft: Draft) -> Iterator[Complaint]:
    """The encoder, the case and the gear, where steps and gravity leave no doubt."""
    said: Mapping[str, Any] = {e.key: e for e in draft.entries if not e.asked and not e.doubt}
    case = said.get("case")
    if (
        case is not None
        and rig.case is not None
        and case.value.strip('"') != rig.case
        and rig.known.get("M", 1.0) > 0.0
    ):
        line = f"{rig.path}: [known] case {rig.case}: the log shows {case.value} ({case.evidence})"
        yield Complaint(line, "known", "case")
    angle = next((p for p in draft.proposals if p.channel in ("theta_m", "theta_l")), None)
    counts, declared = said.get("encoder_counts_per_rev"), rig.log.counts_per_rev
    # The step of the same column; an angle in counts shows no step in turns.
    columns = rig.log.columns or {}
    mapped = {columns[c].text.strip("`") for c in ("theta_m", "theta_l") if c in columns}
    by_step = angle is not None and angle.source in mapped and "counts" not in angle.unit
    if by_step and counts and declared and not math.isclose(declared, float(counts.value), rel_tol=0.02):
        yield Complaint(
            f"{rig.path}: encoder_counts_per_rev = {declared:g}: the log shows {counts.value}"
            f" ({counts.evidence})",
            key="encoder_counts_per_rev",
        )
    gear = said.get("mu")
    if gear is None or "mu" not in rig.known or (angle is not None and angle.doubt):
        return
    over, _, under = gear.value.strip('"').partition("/")
    mu = float(over) / float(under or 1.0)
    speed = next((p for p in draft.proposals if p.channel in ("omega_m", "omega_l")), None)
    if angle is not None and speed is not None and angle.channel[-1] != speed.channel[-1]:
        # Of the two ends of a gear: a rig that has one of them says nothing of the other.
        every = {source.text.strip("`") for source in columns.values()}
        judged = {angle.source, speed.source} <= every
    else:
        judged = "theta_l" not in columns
    if judged and mu != 1.0 and not math.isclose(rig.known["mu"], mu, rel_tol=0.05):
        line = f"{rig.path}: [known] mu = {rig.known['mu']:.6g}: the log shows {gear.value} ({gear.evidence})"
        yield Complaint(line, "known", "mu")
