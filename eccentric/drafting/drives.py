"""Which column drives the motor, and as what.

Current and torque follow friction, acceleration and gravity, a voltage follows the speed as well; where both
are logged, voltage = R current + k_e speed.
"""

from __future__ import annotations

import dataclasses
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.core import few
from eccentric.drafting import limits
from eccentric.drafting.balance import Explained, Moved, balance_of, most_explained
from eccentric.drafting.columns import Grid, LoggedColumn
from eccentric.drafting.proposal import Proposal, quoted
from eccentric.drafting.units import magnitudes
from eccentric.drafting.words import CONTROLS, Name, is_like

Array = NDArray[np.float64]
KINDS = ("current", "torque", "voltage")


CONSTANT = "it is constant"
SET = "a set point by its name"


@dataclass(frozen=True)
class Driven:
    """A column that drives the motor: what it is, and its balance."""

    column: LoggedColumn
    kind: str
    balance: Explained
    evidence: tuple[str, ...]
    doubt: str
    sure: float
    constant: tuple[str, str] = ("", "")


def find_drives(
    grid: Grid, motion: Moved, columns: Sequence[LoggedColumn], *, lasting: bool = True
) -> tuple[list[Proposal], dict[str, Explained], dict[str, str]]:
    """Proposals for current, torque and voltage, the balance of each, and why other columns were left out.

    Args:
        grid, motion: of the log.
        columns: those that are no motion.
        lasting: whether the angle is logged: an integrated speed has none that lasts, and shows no gravity.
    """
    left_out = {c.text: why for c in columns if (why := no_drive(c.name))}
    could = [c for c in columns if c.text not in left_out]
    named = [c for c in could if c.name.quantity in KINDS and np.any(c.values)]
    found: list[tuple[LoggedColumn, Explained]] = []
    steady: list[LoggedColumn] = []
    hopeless = set[str]() if named or not lasting else _hopeless(grid, motion, could)
    for column in could:
        if named and column not in named:
            left_out[column.text] = (
                f"its name does not suggest a drive signal, that of {few([c.text for c in named], 2)} does"
            )
            continue
        if column.varies <= limits.HARDLY:
            steady.append(column)
            part = f"{100 * column.varies:.2g} % at {_middle(column):.4g}"
            left_out[column.text] = CONSTANT + (
                "" if column.is_constant else f" to {part}, too little for a drive"
            )
            continue
        balance = balance_of(motion, grid.smooth(column), periodic=False)
        if balance is None:
            left_out[column.text] = "it does not vary while the drive moves"
        elif (
            column.name.quantity in KINDS
            or (balance.r2 if column.text in hopeless else _shown(grid, motion, column, balance, lasting))
            >= limits.SHOWN
        ):
            found.append((column, balance_of(motion, grid.smooth(column), periodic=lasting) or balance))
        else:
            left_out[column.text] = (
                f"motion explains {100 * max(balance.r2, 0.0):.0f} % of it, too little for a drive"
            )
    kept: list[Driven] = []
    for column, balance in sorted(found, key=lambda one: _rank(*one)):
        copied = next((one for one in kept if _copies(column, one)), None)
        if copied is not None:
            left_out[column.text] = f"it is {copied.column.text} again, in other units or as a set point"
            continue
        kept.append(_kind(column, balance))
    kept = _together(grid, motion, kept)
    if any(one.kind != "voltage" for one in kept):
        for one in kept:
            if one.kind == "voltage" and one.column.varies <= limits.SUPPLY:
                left_out[one.column.text] = (
                    f"it stays near {_middle(one.column):.4g}: a supply, not the voltage at the motor"
                )
        kept = [one for one in kept if one.column.text not in left_out]
    kept = _measured_current(kept, left_out)
    taken: dict[str, Driven] = {}
    proposals: dict[str, Proposal] = {}
    for one in kept:
        first = taken.setdefault(one.kind, one)
        if first is one:
            proposals[one.kind] = _proposal(one, motion)
            continue
        if _role(one.column.name) > _role(first.column.name):
            left_out[one.column.text] = f"another {one.kind}: {first.column.text} is measured by its name"
            continue
        units = first.column.name.unit, one.column.name.unit
        if all(is_like(unit, "N m", "N") for unit in units) and not is_like(*units):
            left_out[one.column.text] = f"in {units[1]}, not as {first.column.text} in {units[0]}"
            continue
        doubt = f"{one.column.text} could be this {one.kind} as well"
        proposals[one.kind] = proposals[one.kind].doubted(doubt)
        left_out[one.column.text] = (
            f"another {one.kind}; {proposals[one.kind].column} follows the motion better"
        )
    balances = {kind: one.balance for kind, one in taken.items()}
    current = next((one for one in kept if one.kind == "current" and one.column in named), None)
    unnamed = [c for c in could if c not in named and c.text in left_out]
    if current is not None and "voltage" not in proposals and len(unnamed) <= limits.TRIED:
        for column in unnamed:
            left_out[column.text] += _as_voltage(grid, motion, column, current)
    if not proposals:
        for column in steady:
            if column.name.quantity in KINDS and np.any(column.values):
                if coasts(motion):
                    left_out[column.text] += " while the motion slows down: a supply, not a drive signal"
                    continue
                left_out.pop(column.text)
                proposals[column.name.quantity] = _steady(column)
                break
    return list(proposals.values()), balances, left_out


def no_drive(name: Name) -> str:
    """Why a column is no drive, whatever its values; "" if it could be one."""
    if name.role == "set":
        # A converter applies the voltage that it is told.
        told = name.quantity == "duty" or (name.quantity == "voltage" and name.word != "v")
        return "" if told else SET
    if name.role == "computed":
        return "computed by a model or a controller, as its name says"
    if not name.signal:
        return "not a drive signal, by its name"
    if name.quantity not in ("", "duty", *KINDS):
        return f"{_A.get(name.quantity, f'a {name.quantity}')}, by its name"
    return ""


_A = {"angle": "another angle", "speed": "another speed", "acceleration": "an acceleration", "on": "a flag"}


def _shown(grid: Grid, motion: Moved, column: LoggedColumn, plain: Explained, lasting: bool) -> float:
    """How much of a column motion explains; gravity is searched where the rest is not enough."""
    if plain.r2 >= limits.SHOWN or not lasting:
        return plain.r2
    full = balance_of(motion, grid.smooth(column))
    return full.r2 if full is not None else plain.r2


def _hopeless(grid: Grid, motion: Moved, columns: Sequence[LoggedColumn]) -> set[str]:
    """Of very many columns those that motion cannot explain, whatever wave of the angle is in them."""
    if len(columns) <= limits.MANY:
        return set()
    found: set[str] = set()
    for first in range(0, len(columns), limits.MANY):
        some = columns[first : first + limits.MANY]
        most = most_explained(motion, np.column_stack([grid.smooth(column) for column in some]))
        found |= {c.text for c, share in zip(some, most, strict=True) if share < limits.SCREENED}
    return found


def _middle(column: LoggedColumn) -> float:
    return float(np.median(column.values))


def coasts(motion: Moved) -> bool:
    """Whether the motion slows down from its peak, to less than half of it, as it does without a drive.

    What sped it up takes two thirds of the rows at most.
    """
    speed = np.abs(motion.w[motion.moving])
    if len(speed) < limits.FEWEST_ROWS:
        return False
    coarse = np.array([np.mean(part) for part in np.array_split(speed, limits.FEWEST_ROWS)])
    after = coarse[int(np.argmax(coarse)) :]
    falls = len(after) > len(coarse) / 3.0 and np.mean(np.diff(after) < 0.0) > limits.COASTS
    return bool(falls and after[-1] < 0.5 * after[0])


def _steady(column: LoggedColumn) -> Proposal:
    """A drive by its name that hardly varies."""
    kind = column.name.quantity
    largest = float(np.max(np.abs(column.values)))
    unit = (
        column.name.unit
        if column.name.unit and not column.name.is_rated
        else magnitudes(column, kind, largest)[0][0]
    )
    doubt = (
        f"nearly constant, about {_middle(column):.4g}: friction and inertia cannot be told apart from one"
        f" {kind}, and a supply looks the same"
    )
    return Proposal(kind, column.text, unit, (f"{kind} by its name",), 0.4, doubt)


def _rank(column: LoggedColumn, balance: Explained) -> tuple[int, bool, bool, bool, float]:
    """Measured before set, named before unnamed, in a unit before in percent, then the better explained."""
    name = column.name
    return _role(name), name.quantity not in KINDS, name.weak, name.is_rated, -balance.r2


def _role(name: Name) -> int:
    return {"measured": 0, "": 1, "estimated": 2, "filtered": 3}.get(name.role, 4)


def _measured_current(kept: list[Driven], left_out: dict[str, str]) -> list[Driven]:
    """Without a torque that is a current times a constant: the current is what was measured."""
    for torque in [one for one in kept if one.kind == "torque"]:
        for current in [one for one in kept if one.kind == "current" and one.column.name.quantity]:
            x, y = current.column.values, torque.column.values
            if abs(float(np.corrcoef(x, y)[0, 1])) > limits.SAME:
                factor = float(np.std(y) / np.std(x))
                left_out[torque.column.text] = (
                    f"{factor:.4g} times {current.column.text}: computed from it, by this torque constant"
                )
                if torque.column.name.side == "l" != current.column.name.side:
                    # Behind the gear: this is no torque constant of the motor.
                    left_out[torque.column.text] += ", times the gear"
                    kept = [one for one in kept if one is not torque]
                    break
                unit = f"{torque.column.name.unit or 'N m'}/{current.column.name.unit or 'A'}"
                constant = f"{factor:.4g} {unit}", f"{torque.column.text}: {left_out[torque.column.text]}"
                kept = [
                    dataclasses.replace(one, constant=constant) if one is current else one
                    for one in kept
                    if one is not torque
                ]
                break
    return kept


def _kind(column: LoggedColumn, balance: Explained) -> Driven:
    shares = balance.shares
    told = [
        f"{words} {shares[term]:.2f}"
        for term, words in (
            ("friction", "sign of speed"),
            ("speed", "speed"),
            ("inertia", "acceleration"),
            ("gravity", "angle under gravity"),
        )
        if shares[term] > limits.TOLD
    ]
    opposed = ", some opposed" if max(shares.values()) > 1.0 else ""
    evidence = (
        f"a model of the motion explains {100 * balance.r2:.0f} % of it",
        *((f"shares of its standard deviation{opposed}: {', '.join(told)}",) if told else ()),
    )
    kind, speed, rest = column.name.quantity, shares["speed"], shares["friction"] + shares["inertia"]
    if kind in KINDS:
        evidence, doubt, sure = (f"{kind} by its name", *evidence), "", 0.98
        if kind != "voltage" and speed > max(limits.LIKE_VOLTAGE, limits.OVER_THE_REST * rest):
            doubt, sure = "it follows the speed as a voltage does", 0.8
    elif speed > limits.BACK_EMF * (speed + rest + shares["gravity"]):
        kind, doubt, sure = (
            "voltage",
            "recognised by its values only; a current with much viscous friction would look the same",
            0.7,
        )
    else:
        kind, doubt, sure = "current", "no name; a torque would look the same", 0.6
    return Driven(column, kind, balance, evidence, doubt, sure)


def _as_voltage(grid: Grid, motion: Moved, column: LoggedColumn, current: Driven) -> str:
    """That a column without a name is as the voltage of a circuit, "" if it is not."""
    balance = balance_of(motion, grid.smooth(column), periodic=False)
    if balance is None:
        return ""
    both = _together(grid, motion, [current, _kind(column, balance)])
    return f"; {both[1].evidence[-1]}: is it the voltage?" if both[1].kind == "voltage" else ""


def _together(grid: Grid, motion: Moved, kept: list[Driven]) -> list[Driven]:
    """Two drive signals tell each other apart: voltage = R current + k_e speed, with both above 0."""
    rows = motion.moving
    for first in range(len(kept)):
        for second in range(len(kept)):
            u, i = kept[first], kept[second]
            if first == second or {u.column.name.quantity, i.column.name.quantity} >= {"voltage", "current"}:
                continue
            if u.column.name.quantity not in ("", "voltage") or i.column.name.quantity not in (
                "",
                "current",
                "torque",
            ):
                continue
            y, x = grid.smooth(u.column)[rows], grid.smooth(i.column)[rows]
            design = np.column_stack([np.ones_like(x), x, motion.w[rows]])
            scaled = design / np.maximum(np.max(np.abs(design), axis=0), 1e-300)
            c = np.linalg.lstsq(scaled, y, rcond=None)[0]
            r2 = 1.0 - float(np.var(y - scaled @ c)) / float(np.var(y))
            emf = abs(c[2]) * float(np.std(scaled[:, 2])) / float(np.std(y))
            if r2 > limits.CIRCUIT and c[1] > 0.0 and c[2] > 0.0 and emf > limits.LEAST_EMF:
                said = (
                    f"it is R {i.column.text} + k_e times the speed, to {100 * r2:.1f} %, with both above 0"
                )
                other = f"{u.column.text} is a multiple of it plus a multiple of the speed"
                kept = list(kept)
                sure = 0.97 if i.column.name.quantity else 0.9
                kept[first] = Driven(u.column, "voltage", u.balance, (*u.evidence, said), "", 0.97)
                if i.column.name.quantity != "torque":
                    kept[second] = Driven(i.column, "current", i.balance, (*i.evidence, other), "", sure)
                return kept
    return kept


def _copies(column: LoggedColumn, other: Driven) -> bool:
    """Whether a column is another one again: to the last digits, or as the value that is set for it."""
    if column.name.quantity not in ("", other.kind) and not column.name.commanded:
        return False
    # A torque that is asked for is a current in other units; a voltage that is asked for drives the motor.
    if "voltage" in {column.name.quantity, other.kind} and column.name.quantity not in ("", other.kind):
        return False
    alike = column.name.commanded or (column.name.quantity == other.column.name.quantity != "")
    r = abs(float(np.corrcoef(column.values, other.column.values)[0, 1]))
    return r > (limits.COPY if alike else limits.SAME)


def _proposal(one: Driven, motion: Moved) -> Proposal:
    largest = float(np.quantile(np.abs(one.column.values), 0.999))
    units = magnitudes(one.column, one.kind, largest)
    unit, sure = units[0]
    evidence, doubts = list(one.evidence), [one.doubt] if one.doubt else []
    name = one.column.name
    if name.is_rated:
        unit, sure = {"torque": "N m", "current": "A", "voltage": "V"}[one.kind], 0.3
        part = {"%": "percent", "‰": "parts per thousand", "pu": "parts"}[name.unit]
        product = f"{quoted(name.text)} * {({'%': 0.0127, '‰': 0.00127, 'pu': 1.27})[name.unit]}"
        doubts.append(
            f"in {part} of a rated value that the log does not contain: with one of 1.27 {unit}, write "
            + json.dumps(product, ensure_ascii=False)
        )
    elif name.unit:
        evidence.append(f"{unit} by its name")
    else:
        second = units[1][0] if len(units) > 1 else ""
        doubts.append(
            f"{unit} only from its size, up to {largest:.3g}" + (f"; may be {second}" if second else "")
        )
        if one.column.is_whole and largest >= limits.COUNTED:
            doubts.append(
                "whole numbers: counts of a converter, or thousandths of a rated value (CiA 402), whose"
                " factor the log does not contain"
            )
    if _RMS.search(name.text):
        doubts.append(
            "rms values: give the torque constant per ampere rms as well"
            if one.kind == "current"
            else "rms values"
        )
    if name.commanded:
        doubts.append("a set point, by its name: the actual value is not logged")
    if name.role == "estimated":
        doubts.append("estimated, by its name")
    if name.word == "v" and name.weak:
        doubts.append("a letter alone: it may be a velocity")
    if name.word in CONTROLS:
        doubts.append("the output of a controller: the log does not show its quantity or its scale")
    levels, values = one.column.levels, one.column.values
    ends = [end for end in (levels[0], levels[-1]) if end != 0.0]
    clipped = float(np.mean(np.isin(values, ends)))
    if len(levels) > limits.FEW_VALUES and clipped > limits.CLIPPED:
        doubts.append(f"clipped in {100 * clipped:.0f} % of rows?")
    if name.word == "effort":
        doubts.append("an effort may be a torque, a current or a voltage, as the drive's driver defines it")
    if without_sign(one.column, motion):
        doubts.append(UNSIGNED)
    turned = one.balance.losses < 0.0 or (one.balance.losses == 0.0 and one.balance.inertia < 0.0)
    if turned:
        evidence.append("its sign is reversed: it falls where friction and inertia need it to rise")
    said = tuple(evidence), min(one.sure, sure), "; ".join(doubts)
    return Proposal(one.kind, one.column.text, unit, *said, turned=turned, constant=one.constant)


_RMS = re.compile(r"(?<![a-z])[AV]?[ _(]?(rms|eff)(?![a-z])", re.IGNORECASE)


def with_direction(proposals: Sequence[Proposal], columns: Mapping[str, LoggedColumn]) -> list[Proposal]:
    """The proposals, with a doubt where a column of a direction may hold the sign of one that has none."""
    of = (c for c in columns.values() if c.name.quantity == "direction" and not c.is_constant)
    direction = next(of, None)
    if direction is None:
        return list(proposals)
    factor = _factor(direction)
    never = f"never negative, and {direction.text} gives a direction"

    def doubt(p: Proposal) -> str:
        if p.channel.startswith(("current", "torque")):
            return f"{never}: its sign is missing where the drive brakes"
        product = f'multiply it, as in "{quoted(p.source)} * {factor}"' if factor else "multiply by -1 or 1"
        return f"{never}: if that is its sign, {product}"

    return [p.doubted(doubt(p)) if _is_size(p, columns) else p for p in proposals]


def _factor(direction: LoggedColumn) -> str:
    """The sign by a column of a direction: that itself, or by its two levels; "" for others."""
    name, levels = quoted(direction.text), sorted(set(direction.levels.tolist()))
    if set(levels) <= {-1.0, 0.0, 1.0} and -1.0 in levels:
        return name
    if len(levels) != 2:
        return ""
    low, apart = levels[0], levels[1] - levels[0]
    moved = name if low == 0.0 else f"({name} {'-' if low > 0.0 else '+'} {abs(low):g})"
    return f"({2.0 / apart:g} * {moved} - 1)"


def _is_size(proposal: Proposal, columns: Mapping[str, LoggedColumn]) -> bool:
    """Whether a speed or a drive is never negative."""
    moves = proposal.channel.startswith(("omega", *KINDS))
    column = columns.get(proposal.source)
    return moves and column is not None and bool(np.all(column.values >= 0.0))


def bounces(speed: LoggedColumn) -> bool:
    """Whether a speed that is never negative reaches zero without slowing down, as a magnitude does."""
    steps = np.abs(np.diff(speed.values))
    low = speed.values[1:] < limits.LOW * float(np.quantile(speed.values, 0.99))
    visits = np.count_nonzero(low[1:] & ~low[:-1])
    signed = bool(np.any(speed.values < 0.0)) or visits < limits.FEW_VISITS
    return not signed and float(np.mean(steps[low])) > 0.5 * float(np.mean(steps))


UNSIGNED = "never negative though the shaft turns both ways: its sign is missing, and no fit can be right"


def without_sign(column: LoggedColumn, motion: Moved) -> bool:
    """Whether a drive has one sign alone where the motion has two."""
    w = motion.w[motion.moving]
    both = len(w) > 0 and min(float(np.mean(w > 0.0)), float(np.mean(w < 0.0))) > limits.BOTH_WAYS
    return both and bool(np.all(column.values >= 0.0))
