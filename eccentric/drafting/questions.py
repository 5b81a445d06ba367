"""The lines of a drafted rig besides its channels: what the log shows, and questions about the rest."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError, counted
from eccentric.drafting import limits
from eccentric.drafting.balance import GUESSED_UNITS, SHORT, Explained, Moved
from eccentric.drafting.columns import Grid, LoggedColumn, nice_counts
from eccentric.drafting.proposal import Proposal, RigLine, asked_parts, computed_by, known_asked
from eccentric.drafting.units import Reading, Shown
from eccentric.logs import parse_unit
from eccentric.signals import turn_line

Array = NDArray[np.float64]
TURN = 2.0 * math.pi


def entries_of(
    best: Reading, given: Shown, balance: Explained | None, gear: RigLine, drives: Sequence[Proposal]
) -> list[RigLine]:
    """The lines of the rig file; `gear` is that of mu."""
    kinds = {p.channel for p in drives}
    return [
        *_encoder(best, given, balance),
        *_alignment(balance, kinds),
        *asked_parts("planetary"),
        *_known(gear, given, balance, drives),
    ]


def _encoder(best: Reading, given: Shown, balance: Explained | None) -> list[RigLine]:
    if given.angle is None:
        return []
    key = "encoder_counts_per_rev"
    if best.angle == "counts":
        if not best.counts:
            return [RigLine("", key, "4096", "counts of the angle per turn of its shaft", asked=True)]
        why = "; ".join(w for w in best.why["angle"] if "counts" in w)
        by_gravity = not given.wrap and not given.factor
        doubt = SHORT if by_gravity and balance is not None and balance.turns < 1.0 else ""
        if given.speed is not None and given.factor and not (given.wrap or given.speed.name.unit):
            doubt = GUESSED_UNITS
        return [RigLine("", key, f"{best.counts:g}", why, doubt, guessed=bool(doubt))]
    if "counts" in best.speed and best.counts:
        why = next(w for w in best.why["speed"] if "per turn" in w)
        return [RigLine("", key, f"{best.counts:g}", why)]
    if given.step:
        unit = parse_unit(best.angle, "").factor
        counts = TURN / (given.step * unit)
        if 90.0 < counts < 2e7 and (nice := nice_counts(counts, 2e-3)):
            why = f"the smallest step of the angle, {given.step:.6g} {best.angle}"
            return [RigLine("", key, f"{nice:g}", why)]
    return []


def _alignment(balance: Explained | None, kinds: set[str]) -> list[RigLine]:
    entries: list[RigLine] = []
    if balance is not None and balance.period:
        zero = round(TURN * balance.zero / balance.period, 3) + 0.0  # no -0
        why, value = f"gravity vanishes at {zero:+.3f} rad of the link", "0"
        if abs(zero) > 0.01:
            why, value = f"{why}: the fit refines it", '"estimate"'
        entries.append(RigLine("", "theta_zero_rad", value, why))
    if kinds == {"voltage"}:
        why = "a logged voltage is a command; it acts later, and only the fit shows by how much"
        entries.append(RigLine("", "input_delay_s", '"estimate"', why))
        if balance is not None and abs(balance.offset) > 0.02:
            why = f"mean beyond motion: {balance.offset:+.3f} of its scatter"
            entries.append(RigLine("", "voltage_offset_V", '"estimate"', why))
    return entries


def _known(
    gear: RigLine, given: Shown, balance: Explained | None, drives: Sequence[Proposal]
) -> list[RigLine]:
    """[known] and [unknown]: the case and the gear as the log shows them, the rest as questions."""
    gravity, kinds = balance is not None and balance.period > 0.0, {p.channel for p in drives}
    entries = [
        _case(given, balance),
        gear,
        known_asked("M", "0.5 kg", "the unbalanced mass: weigh it; 0 kg for a bare joint", needed=True),
        known_asked("L", "0.3 m", "from the axis to the centre of that mass: measure it", needed=True),
    ]
    if gravity or balance is None:
        why = 'the link without the unbalanced mass: weigh it, or a range: [unknown] M_l = ["0 kg", "0.5 kg"]'
        entries.append(known_asked("M_l", "0.2 kg", why, needed=True))
    if "current" in kinds and not gravity:
        why = "the torque constant (data sheet): without gravity the log cannot show it"
        entries.append(computed_by(drives, known_asked("k_i", "0.05 N m/A", why, needed=True)))
    elif "current" in kinds:
        why = (
            "the torque constant, identified through gravity; the data sheet's value, under [known] instead"
            " of this line, is better: without it, gear losses cannot be told from a wrong constant"
        )
        entries.append(RigLine("unknown", "k_i", '["0.001 N m/A", "20 N m/A"]', why))
    if "voltage" in kinds:
        use = "diagnose requires it" if "current" in kinds else ""
        resistance = use or "with k_i it gives the current"
        back_emf = use or "it tells the back-EMF from friction"
        entries += [
            known_asked("R", "1 ohm", f"resistance of the armature (data sheet); {resistance}"),
            known_asked(
                "k_e", "0.05 V s/rad", f"back-EMF constant (data sheet), in SI equal to k_i; {back_emf}"
            ),
        ]
    rotor = "inertia of the rotor (data sheet); without it the sum J_m + mu^2 J_l is estimated"
    link = "inertia of the link about its axis, M L^2 included"
    return [*entries, known_asked("J_m", "1000 g cm^2", rotor), known_asked("J_l", "0.05 kg m^2", link)]


def _case(given: Shown, balance: Explained | None) -> RigLine:
    if balance is None:
        why = "gravity in the plane of motion; C1: perpendicular to it"
        return known_asked("case", "C2", why, needed=True)
    if balance.period > 0.0:
        part, turns = min(balance.shares["gravity"], 1.0), balance.turns
        why = (
            f"gravity in the plane of motion: {100 * part:.0f} % of the drive's scatter repeats with the"
            f" angle, {turns:.1f} periods"
        )
        short = "less than one period was seen: it may be a spring, or a load that drifts"
        return RigLine("known", "case", '"C2"', why, "" if turns > 1.0 else short)
    why = "no gravity: nothing in the drive repeats with the angle in both directions"
    doubt = "a light mass or a barely moving axis would look the same in the log"
    if balance.follows:
        doubt = "the drive follows the angle: a spring, or gravity (C2) over a part of a turn?"
    if given.angle is None:
        doubt = "without an angle gravity cannot be seen"
    return RigLine("known", "case", '"C1"', why, doubt)


def turns_asked(t: Array, breaks: NDArray[np.bool_], given: Shown) -> list[RigLine]:
    """Whether each row is the time of one turn: steps of time are uneven, and turn with the speed.

    Args:
        t, breaks: the time of the rows (n,) and the ends of stretches (n-1,).
        given: its angle counts turns, or its speed is the inverse of the step of time, as a mean over a turn.
    """
    steps = np.diff(t)
    inside = ~breaks & (steps > 0.0)
    low, high = np.quantile(steps[inside], [0.1, 0.9])
    if high < limits.UNEVEN * low:
        return []
    column = given.angle or given.speed
    if column is None:
        return []
    if column is given.angle:
        changes = np.abs(np.diff(column.values)[inside])
        of_turns = column.is_whole and np.mean(changes > 1.0) <= limits.FEW_STEPS
    else:
        way = np.abs(column.values[1:] * steps)[inside]
        low, middle, high = np.quantile(way, [0.1, 0.5, 0.9])
        of_turns = high - low <= limits.ONE_TURN * middle
    why = f"{column.text} and the uneven time steps look like turns: is each row the time of one turn?"
    return [RigLine("", "events", '"revolution"', why, asked=True)] if of_turns else []


def added_asked(run: Sequence[object], mass: LoggedColumn) -> list[RigLine]:
    """What each run carries beside the least, by a column of masses that is constant in it.

    Args:
        run: the run of each row (n,).
        mass: the column (n,), with a unit of mass.
    """
    least, unit = float(np.min(mass.values)), mass.name.unit
    why = f"M is {least:g} {unit}, if {mass.text} is all of it"
    entries: list[RigLine] = []
    for name, value in dict(zip(run, mass.values.tolist(), strict=True)).items():
        if value > least:
            key = json.dumps(f"{name:.12g}" if isinstance(name, float) else str(name), ensure_ascii=False)
            entries.append(RigLine("added", key, f'"{value - least:g} {unit}"', why, asked=True))
            why = "as above"
    return entries


def line_asked(grid: Grid, given: Shown, unit: str, drive: LoggedColumn | None) -> list[RigLine]:
    """Whether the angle is the phase of a line in the drive signal, where none is logged.

    Args:
        grid: of the log; its longest stretch is looked at.
        given: without an angle, its speed nearly constant; `unit` is that of the speed.
        drive: the signal, None without any.
    """
    speed = given.speed
    if given.angle is not None or speed is None or drive is None or speed.varies > limits.HARDLY:
        return []
    t, even, rows = max(grid.parts, key=lambda part: len(part[1]))
    in_si = parse_unit(unit, "").factor
    signal, omega = (np.interp(even, t, c.values[rows]) for c in (drive, speed))
    try:
        line = turn_line(even, signal, in_si * omega)
    except InputError:
        return []
    hertz = line.order * line.frequency
    why = f"{drive.text} repeats {line.order}/turn, at {hertz:.4g} Hz: is its phase the angle of the drive?"
    return [RigLine("", "angle", '"line"', why, asked=True)]


ONE_WAY = "one direction only: Coulomb friction and a constant load look the same there"


def one_way(motion: Moved) -> bool:
    """Whether nearly all moving rows move in one direction."""
    return not np.any(motion.moving) or not 0.05 <= float(np.mean(motion.w[motion.moving] > 0.0)) <= 0.95


def facts_of(grid: Grid, motion: Moved) -> list[str]:
    """What else the log shows, one line each."""
    inner = grid.inner()
    still = 1.0 - float(np.mean(motion.moving[inner])) if np.any(inner) else 0.0
    both = float(np.mean(motion.w[motion.moving] > 0.0)) if np.any(motion.moving) else 0.0
    facts = [
        f"{counted(len(grid.parts), 'section')} without gaps, {1.0 / grid.step:.4g} rows/s (mean)",
        (
            f"at rest (below {100 * limits.STILL:.0f} % of its speed) in {100 * still:.0f} % of rows;"
            f" in motion, {100 * both:.0f} % forwards"
        ),
    ]
    if one_way(motion):
        facts.append(ONE_WAY)
    return facts
