"""The draft of an arm's rig: columns by pattern, `theta = "q_rad_{j}"`, each joint read like a drive alone.

A pattern is a name with one number that runs through all joints. What a joint's columns are is found joint by
joint, as for a single drive, and the joints have to agree; where they do not, that is a doubt.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from eccentric.core import InputError, counted, few
from eccentric.drafting.draft import Draft, draft_of
from eccentric.drafting.proposal import Proposal, RigLine, asked_parts
from eccentric.drafting.units import opened_to_draft
from eccentric.drafting.words import read_name
from eccentric.logs import Log
from eccentric.model import Chain
from eccentric.rigs import NUMBER

_TURN = {"rad": 2.0 * np.pi, "deg": 360.0, "rev": 1.0, "mrad": 2e3 * np.pi}
_OF_ALL = ("time", "run", "use", "motor_off")


def draft_of_arm(log: Log, chain: Chain, arm: str, tell: Callable[[float], None] = lambda _: None) -> Draft:
    """Draft the rig of an arm.

    Args:
        log: with a column for each joint, numbered from 0 or 1, or from any number on.
        chain: the arm.
        arm: its path, as the rig file is to say it.
        tell: called with the part that is done, 0 to 1.

    Raises:
        InputError: no column for each joint, no time, too few rows, or no joint that moves.
    """
    count = len(chain.joints)
    first, patterns = _patterns(log, count)
    numbered = {p.replace(NUMBER, str(first + j)) for p in patterns for j in range(count)}
    common = [name for name in log.columns if name not in numbered]
    clock, run = _clock(log, common)
    votes: dict[str, list[Proposal]] = {}
    silent: list[str] = []
    for j in range(count):
        own = {p.replace(NUMBER, str(first + j)): p for p in patterns}
        try:
            found = draft_of(_part(log, [clock.column, *([run.column] if run else []), *own]))
        except InputError as error:
            silent.append(f"joint {first + j} shows no motion ({error.inside(log.path)})")
        else:
            for proposal in found.proposals:
                if proposal.source in own:
                    votes.setdefault(own[proposal.source], []).append(proposal)
        tell((j + 1) / count)
    if len(silent) == count:
        raise InputError(log.path, problem=f"expected joints that move; {silent[0]}")
    heard = count - len(silent)
    chosen = [_agreed(pattern, given, heard) for pattern, given in votes.items()]
    proposals, left_out = _one_each(_sides(chosen, log, chain, first))
    left_out |= {p: "it is no signal of a drive in any joint" for p in patterns if p not in votes}
    left_out |= {
        n: "one column for all joints" for n in common if n not in (clock.column, run and run.column)
    }
    return Draft(
        path=log.path,
        proposals=(*([run] if run else []), clock, *proposals),
        entries=tuple(_entries(proposals, chain, arm, first)),
        left_out=left_out,
        facts=(f"{counted(count, 'joint')} of {chain.name}, columns counted from {first}", *silent),
    )


def _patterns(log: Log, count: int) -> tuple[int, list[str]]:
    """The number of the first joint, and the patterns that have a column for each joint."""
    seen: dict[str, set[int]] = {}
    for name in log.columns:
        for place in re.finditer(r"\d+", name):
            # A number with leading zeros would not come out of the pattern again.
            if str(int(place[0])) == place[0]:
                pattern = f"{name[: place.start()]}{NUMBER}{name[place.end() :]}"
                seen.setdefault(pattern, set()).add(int(place[0]))
    starts = Counter(
        start for numbers in seen.values() for start in numbers if {*range(start, start + count)} == numbers
    )
    if not starts:
        most = max((len(numbers) for numbers in seen.values()), default=0)
        raise InputError(
            log.path,
            f"columns of {counted(count, 'joint')}, such as q_1 to q_{count}",
            f"at most {most} that differ by a number; the log has {few(log.columns)}",
        )
    first = max(starts, key=lambda start: (starts[start], -start))
    return first, [p for p, numbers in seen.items() if numbers == {*range(first, first + count)}]


def _clock(log: Log, common: Sequence[str]) -> tuple[Proposal, Proposal | None]:
    """The time and the runs, among the columns that are one for all joints."""
    found = opened_to_draft(_part(log, common))
    return found.clock.proposal, found.run


def _part(log: Log, names: Sequence[str]) -> Log:
    units = {name: log.units[name] for name in names if name in log.units}
    return Log(log.path, {name: log.columns[name] for name in names}, log.rows, units=units)


def _agreed(pattern: str, given: Sequence[Proposal], heard: int) -> Proposal:
    """What most joints say of a pattern, and a doubt where some say otherwise."""
    said = Counter((_kind(p.channel), p.unit, p.turned) for p in given)
    (kind, unit, turned), most = said.most_common(1)[0]
    of = [p for p in given if (_kind(p.channel), p.unit, p.turned) == (kind, unit, turned)]
    best = max(of, key=lambda p: (not p.doubt, p.confidence))
    doubts = [best.doubt] if best.doubt else []
    if most < heard:
        others = sorted({f"{_kind(p.channel)} {p.unit}".strip() for p in given if p not in of})
        doubts.append(
            f"so in {most} of {heard} joints that move" + (f"; else {' or '.join(others)}" if others else "")
        )
    # Where others move, what repeats with the angle of a joint is not only its own gravity.
    own = tuple(said for said in best.evidence if said not in best.by_gravity)
    evidence = (*own, f"so in {counted(most, 'joint')}") if most == heard else own
    sure, doubt = best.confidence * most / heard, "; ".join(doubts)
    return Proposal(best.channel, pattern, unit, evidence, sure, doubt, turned)


def _kind(channel: str) -> str:
    return channel.removesuffix("_m").removesuffix("_l")


def _sides(chosen: Sequence[Proposal], log: Log, chain: Chain, first: int) -> list[Proposal]:
    """Angles, speeds and torques are the joint's, unless their names or the travel say the motor's."""
    found = []
    far = any(_kind(p.channel) == "theta" and _turns(p, log, first, len(chain.joints)) > 3.0 for p in chosen)
    direct = all(float(joint.mu) == 1.0 for joint in chain.joints)
    for p in chosen:
        kind = _kind(p.channel)
        if kind not in ("theta", "omega", "torque"):
            found.append(p)
            continue
        side = read_name(p.source.replace(NUMBER, "1")).side
        motor = side == "m" or (not side and far and kind != "torque")
        doubt = ""
        if not side and not direct:
            why = "it travels further than a joint does: the motor's" if motor else "taken as the joint's"
            doubt = f"no name says which side of the gear: {why}"
        of_motor = "" if kind == "torque" else "_m"
        found.append(replace(p, channel=f"{kind}{of_motor if motor else '_l'}").doubted(doubt))
    return found


def _turns(p: Proposal, log: Log, first: int, count: int) -> float:
    """The longest travel of an angle over a turn, of all joints; 0 for counts, whose turn is not known."""
    turn = _TURN.get(p.unit)
    if turn is None:
        return 0.0
    names = [p.source.replace(NUMBER, str(first + j)) for j in range(count)]
    return max(float(np.ptp(log.numbers(name))) for name in names) / turn


def _one_each(chosen: Sequence[Proposal]) -> tuple[list[Proposal], dict[str, str]]:
    """One pattern for each quantity, the surest; the others are left out."""
    best: dict[str, Proposal] = {}
    left_out: dict[str, str] = {}
    for p in sorted(chosen, key=lambda p: (bool(p.doubt), -p.confidence)):
        kind = _kind(p.channel)
        if kind in _OF_ALL or kind in best:
            left_out[p.source] = (
                f"another {kind}; {best[kind].column} is surer" if kind in best else f"a {kind} of each joint"
            )
        else:
            best[kind] = p
    order = ("theta", "omega", "torque", "current", "voltage", "temperature")
    return sorted(best.values(), key=lambda p: order.index(_kind(p.channel))), left_out


def _entries(proposals: Sequence[Proposal], chain: Chain, arm: str, first: int) -> list[RigLine]:
    count = len(chain.joints)
    kinds = {_kind(p.channel) for p in proposals}
    names = few([joint.name for joint in chain.joints])
    entries = [RigLine("", "arm", json.dumps(arm, ensure_ascii=False), f"{counted(count, 'joint')}: {names}")]
    if any("counts" in p.unit for p in proposals):
        why = "counts of the angle per turn of the shaft that it is logged on"
        entries.append(RigLine("", "encoder_counts_per_rev", "4096", why, asked=True))
    entries += asked_parts("strain wave")
    if "current" in kinds:
        why = "torque constants from the base outwards (data sheets); without them bodies give the scale"
        entries.append(RigLine("drives", "k_i", _each("0.1 N m/A", count), why, asked=True))
    if "voltage" in kinds:
        why = "resistance of each armature (data sheets)"
        entries.append(RigLine("drives", "R", _each("1 ohm", count), why, asked=True))
        why = "back-EMF constants; in SI they equal k_i"
        entries.append(RigLine("drives", "k_e", _each("0.1 V s/rad", count), why, asked=True))
    entries.append(
        RigLine("joints", "first", str(first), "the number in the columns of the joint at the base")
    )
    why = 'the bodies are those of the arm file; "open": the log has to show their inertial parameters'
    entries.append(RigLine("joints", "inertial", '"known"', why))
    return entries


def _each(value: str, count: int) -> str:
    return json.dumps([value] * count)
