"""A log, or several of one rig, becomes a draft of its rig file: every line with its evidence."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError, counted, few
from eccentric.drafting import limits
from eccentric.drafting.balance import (
    GUESSED_UNITS,
    Explained,
    Gear,
    Moved,
    as_gravity,
    balance_of,
    gear_of,
    motion_from,
)
from eccentric.drafting.carriage import carriage_channels, carriage_entries, driven, is_carriage
from eccentric.drafting.columns import Grid, LoggedColumn, Pair, grid_of, pairs_of, step_of, wrap_of
from eccentric.drafting.drives import (
    CONSTANT,
    KINDS,
    SET,
    UNSIGNED,
    bounces,
    coasts,
    find_drives,
    with_direction,
    without_sign,
)
from eccentric.drafting.joints import joint_called, joint_of
from eccentric.drafting.others import find_flags, find_slow, find_voltage
from eccentric.drafting.proposal import BY_SIZE, Proposal, RigLine, quoted
from eccentric.drafting.questions import added_asked, entries_of, facts_of, line_asked, one_way, turns_asked
from eccentric.drafting.units import REGISTER, SECONDS, Clock, Reading, Shown, opened_to_draft, readings
from eccentric.drafting.words import Name, is_mass, is_of_motor, is_of_supply, of_a_carriage
from eccentric.logs import Log, number_of
from eccentric.model import LINEAR, TURNING, AxisKind

Array = NDArray[np.float64]
_NAMED = (
    "time",
    "current",
    "voltage",
    "torque",
    "acceleration",
    "temperature",
    "supply",
    "duty",
    "run",
    "direction",
    "other",
)


@dataclass(frozen=True)
class Draft:
    """A drafted rig.

    Attributes:
        path: of the log, for messages and the name of the rig.
        proposals: the channels, each with column, unit and evidence.
        entries: the other lines of the rig file.
        left_out: column -> why it is no channel.
        facts: what else the log shows, one line each.
        axis: a drive that turns, or a carriage.
    """

    path: str
    proposals: tuple[Proposal, ...]
    entries: tuple[RigLine, ...]
    left_out: Mapping[str, str]
    facts: tuple[str, ...]
    axis: AxisKind = TURNING

    @property
    def doubts(self) -> tuple[str, ...]:
        """What is not sure, one line each."""
        by_channel = [
            f"{self.axis.named(p.channel)} = {p.column}: {p.doubt}" for p in self.proposals if p.doubt
        ]
        return (*by_channel, *(f"{e.key}: {e.doubt}" for e in self.entries if e.doubt))

    @property
    def questions(self) -> tuple[RigLine, ...]:
        """What has to be typed, since no log shows it."""
        return tuple(entry for entry in self.entries if entry.asked)


_UNSIGNED_SPEED = (
    "never negative, and it reaches zero at full rate: if the shaft turns both ways, its sign is missing"
)


def _beside(name: Name) -> str:
    """Why a column is no drive: a duty cycle, or of the supply; "" for others."""
    if name.quantity == "duty":
        return "a duty cycle: the voltage is logged"
    if name.quantity == "supply":
        return OF_SUPPLY if is_of_supply(name) else "supply voltage"
    return ""


TURNS = 'where each row is the time of one turn, write a rig file with events = "revolution"'
OF_SUPPLY = "the current of the supply, which is not that of the motor"


def draft_of(log: Log) -> Draft:
    """Draft the rig of a log.

    Raises:
        InputError: it has no column that rises like a time, too few rows, or nothing that moves.
    """
    opened = opened_to_draft(log)
    columns, texts, run, ends, clock = opened.columns, opened.texts, opened.run, opened.ends, opened.clock
    left = {n: c for n, c in columns.items() if n not in {clock.proposal.column, run and run.column}}
    if not left:
        raise InputError(
            log.path,
            "an angle or a speed",
            "the time alone",
            hint=TURNS,
        )
    grid = grid_of(clock.raw * SECONDS[clock.unit], clock.breaks)
    if not grid.parts:
        raise InputError(log.path, problem="expected a stretch of more rows without a gap in time")
    if grid.step > 1.0 / limits.SLOWEST_HZ:
        said = f"{1.0 / grid.step:.2g}: no acceleration can be seen (is {clock.proposal.source!r} the time?)"
        raise InputError(log.path, f"at least {limits.SLOWEST_HZ:g} rows/s", said)
    flags = [c for c in left.values() if c.is_flag]
    ratio = {c.text: why for c in left.values() if (why := _beside(c.name))}
    joint = joint_of({n: c for n, c in left.items() if n not in ratio}, grid)
    temperature, supply = find_slow([c for n, c in left.items() if n not in joint.others])
    voltage = find_voltage(list(left.values()), supply)
    taken = (
        {*ratio}
        | {c.text for c in flags}
        | ({temperature.source, *temperature.reads} if temperature else set())
    )
    left_out = {
        n: f"of {joint_called(key)}; {joint_called(joint.key)} is drafted" for n, key in joint.others.items()
    }
    left_out |= {n: CONSTANT for n, c in left.items() if c.is_constant and n not in taken}
    left_out |= {n: _BY_RUN for n, c in left.items() if n not in taken and _is_of_runs(c, ends)}
    left_out |= {name: why for name, entries in texts.items() if (why := _spoilt(log, name, entries))}
    free = [c for n, c in left.items() if n not in taken and n not in left_out]
    hint = TURNS if clock.uneven else ""
    angle, speed, pair, doubt = _moving(grid, free, [*left.values()], log.path, hint)
    if angle is not None and speed is not None and _along_the_rim(angle, speed):
        speed = pair = None
    doubt = "; ".join(filter(None, (doubt, joint.doubt)))
    if angle is None and speed is not None and bounces(speed):
        doubt = "; ".join(filter(None, (doubt, _UNSIGNED_SPEED)))
    motion = motion_from(grid, angle, speed)
    rest = [c for c in free if c not in (angle, speed)]
    rest, copies = _without_copies(grid, rest, angle, speed)
    left_out |= copies
    doubt = "; ".join(filter(None, (doubt, _moves_too([left[n] for n in copies], angle, speed, grid))))
    constant = [c for n, c in left.items() if c.is_constant and n not in taken and n not in joint.others]
    rest, of_none = joint.of_its_own([*rest, *constant])
    drives, balances, others = find_drives(grid, motion, rest, lasting=angle is not None)
    left_out |= of_none | others
    drives = _beside_supply(_beside_sensor(drives, [left[n] for n in of_none]), supply, left)
    drives, balances = _with_duty(drives, balances, voltage, grid, motion, left, lasting=angle is not None)
    if not drives and not any(c is not None and c.name.quantity for c in (angle, speed)):
        raise _unnamed(log.path, few(left), drive=True)
    left_out = {n: why for n, why in left_out.items() if n not in {p.source for p in drives}}
    shown = Shown(
        time=clock.likely,
        time_unit=clock.unit,
        angle=angle,
        speed=speed,
        factor=pair.factor if pair else 0.0,
        wrap=wrap_of(angle, clock.breaks) if angle else 0.0,
        step=step_of(angle) if angle else 0.0,
        fastest=float(np.quantile(np.abs(motion.w), 0.95)),
    )
    signals = {p.channel: grid.smooth(c) for p in drives for c in rest if c.text == p.source}
    if any(UNSIGNED in p.doubt for p in drives):
        balances = {kind: balance.without_gravity() for kind, balance in balances.items()}
    evidence, gravity, ripple = as_gravity(shown, balances, motion, signals)
    drive = next((c for c in rest if drives and c.text == drives[0].source), None)
    carried = is_carriage(evidence, drive)
    drives, no_drives = driven(drives, {c.text: c.name.unit for c in rest}, carried)
    left_out |= no_drives
    found = [] if carried else readings(evidence)
    gear = gear_of(found[0], evidence, gravity) if found else None
    if gear is None:
        moving = carriage_channels(evidence, _said(pair))
        proposals = [*([run] if run else []), clock.proposal, *moving]
    else:
        moving = []
        proposals = _channels(clock, run, found, evidence, pair, gear, doubt)
        if found[0].gear and not gear.mu.doubt and any("counts per turn" in p.doubt for p in proposals):
            gear = replace(gear, mu=replace(gear.mu, doubt=GUESSED_UNITS, guessed=True))
    named, unclear = find_flags(flags, grid, motion, drive)
    left_out |= unclear
    left_out |= {n: why for n, why in ratio.items() if not any(n in p.reads for p in drives)}
    proposals = with_direction([*proposals, *drives], left)
    proposals += [*([temperature] if temperature else []), *named]
    if gear is None:
        largest = float(np.quantile(np.abs(drive.values), 0.999)) if drive else 0.0
        entries = carriage_entries(evidence, moving, drives, largest, one_way(motion))
    else:
        entries = [
            *turns_asked(clock.raw, clock.breaks, evidence),
            *line_asked(grid, evidence, found[0].speed, drive),
            *entries_of(found[0], evidence, gravity, gear.mu, drives),
        ]
    if not drives:
        why = "expected a current, a torque or a voltage, and no column follows the motion as one does"
        near = [
            f"{n}: {why}" for n, why in left_out.items() if why in (OF_SUPPLY, SET) and left[n].varies > 0.0
        ]
        why = "; ".join([why, *near[:3]])
        line = RigLine("columns", "current", '"its column"', why, asked=True, needed=True)
        if coasts(motion):
            why = "a coast-down, if nothing drove it; without J_m and J_l it shows friction over inertia"
            line = RigLine("", "drive", '"none"', "", why)
        entries = [line, *entries]
    by_run = [left[n] for n, why in left_out.items() if why == _BY_RUN and is_mass(left[n].name.unit)]
    if run is not None and run.column in columns and is_mass(columns[run.column].name.unit):
        by_run = [columns[run.column]]
    if run is not None and by_run and not carried:
        names = texts[run.column] if run.column in texts else columns[run.column].values
        entries += added_asked(names.tolist(), by_run[0])
    facts, axis = [*facts_of(grid, motion), *ripple], LINEAR if carried else TURNING
    return Draft(log.path, tuple(proposals), tuple(entries), left_out, tuple(facts), axis)


_BY_RUN = (
    f'{CONSTANT} in each run: subtract a load, as in torque = "0.05 * i - 0.001 * load"; masses go to [added]'
)


def _is_of_runs(column: LoggedColumn, ends: NDArray[np.bool_]) -> bool:
    """Whether a column changes at the ends of runs (n-1,) only, and has no name of a motion or a drive."""
    return (
        bool(np.any(ends))
        and not column.is_constant
        and column.name.quantity in ("", "other")
        and not np.any(np.diff(column.values)[~ends])
    )


def _spoilt(log: Log, name: str, entries: NDArray[np.str_]) -> str:
    """The first entry that makes a column of numbers none; "" for a column of text, such as a mode."""
    if np.mean([number_of(str(entry)) is not None for entry in entries]) < limits.MOSTLY_NUMBERS:
        return ""
    try:
        log.numbers(name)
    except InputError as error:
        return str(error)
    return ""


def _said(pair: Pair | None) -> list[str]:
    return [f"correlates {pair.r:.3f} with the slope of {pair.angle}"] if pair else []


def _moving(
    grid: Grid, free: Sequence[LoggedColumn], every: Sequence[LoggedColumn], where: str, hint: str
) -> tuple[LoggedColumn | None, LoggedColumn | None, Pair | None, str]:
    """The angle and the speed: a column and its slope, by their names, or what explains a third column."""
    signals = [c for c in free if c.name.signal]
    could = [c for c in signals if c.name.quantity not in _NAMED or _letter(c)]
    could = [c for c in could if not c.name.is_rated] or could
    could = _few(could, ("angle", "speed"))
    if any(c.name.quantity in ("angle", "speed") and c.name.role != "electrical" for c in could):
        # An electrical speed is that of the shaft times the pole pairs: taken where there is nothing else.
        could = [c for c in could if c.name.role != "electrical"]
    by_name = {c.text: c for c in could}
    pairs = [p for p in pairs_of(grid, could) if _is_motion(p, by_name, every)]
    if pairs:
        slopes = {p.speed for p in pairs}

        def worth(p: Pair) -> float:
            a, b = by_name[p.angle].name, by_name[p.speed].name
            named = 0.3 * (a.quantity == "angle") + 0.3 * (b.quantity == "speed")
            second = 0.05 * (_SECOND.get(a.role, 0) + _SECOND.get(b.role, 0))
            # Of two alike, the shorter name: a filter adds to it.
            longer = 1e-3 * (len(a.text) + len(b.text))
            # Of two sensors of one shaft, both columns of one, then that in SI.
            apart = 0.1 * (a.whose != b.whose) + 0.01 * (not _in_si(a)) + 0.01 * (not _in_si(b))
            return p.r + named - second - 0.1 * (p.angle in slopes) - longer - apart

        best = max(pairs, key=worth)
        a, b = by_name[best.angle], by_name[best.speed]
        return a, b, best, ""
    could = [c for c in could if not _letter(c)]
    angle, speed = (_first(could, what) for what in ("angle", "speed"))
    if angle is not None and speed is not None:
        return angle, speed, None, "the speed does not follow the slope of the angle"
    if angle is not None or speed is not None:
        return angle, speed, None, ""
    return (
        *_explaining(grid, could, _few(signals, KINDS), where, hint),
        None,
        "no name: it is what explains the other columns best as a motion",
    )


def _in_si(name: Name) -> bool:
    return name.unit in ("", "rad", "rad/s", "m", "m/s")


def _few(columns: list[LoggedColumn], quantities: Sequence[str]) -> list[LoggedColumn]:
    """Of very many columns those with a name of one of the quantities, else those that are smoothest."""
    if len(columns) <= limits.MANY:
        return columns
    named = [c for c in columns if c.name.quantity in quantities]
    rough = {c.text: float(np.mean(np.abs(np.diff(c.values)))) / (c.range or 1.0) for c in columns}
    return named or sorted(columns, key=lambda c: rough[c.text])[: limits.MANY]


def _along_the_rim(angle: LoggedColumn, speed: LoggedColumn) -> bool:
    """Whether the speed of a shaft is logged as that of a point on its rim, whose radius no log shows."""
    turns = angle.name.unit and not of_a_carriage(angle.name.unit)
    return bool(turns) and of_a_carriage(speed.name.unit)


def _letter(column: LoggedColumn) -> bool:
    """Whether it is a voltage, a current or a force by one letter alone: values go before that."""
    return column.name.weak and column.name.quantity in ("voltage", "current", "torque")


def _is_motion(p: Pair, by_name: Mapping[str, LoggedColumn], others: Sequence[LoggedColumn]) -> bool:
    """Whether a column and its slope are an angle and a speed, as far as their names go."""
    angle, speed = by_name[p.angle], by_name[p.speed]
    if angle.name.quantity not in ("angle", "") or _letter(angle):
        return False
    if _letter(speed):
        # x and v: the slope as it stands, in the same units; a voltage has another size, or is there too.
        also = (speed.name.quantity, *(["duty"] if speed.name.quantity == "voltage" else []))
        other = any(c is not speed and c.name.quantity in also for c in others)
        return p.r > limits.UNNAMED and (other or abs(abs(p.factor) - 1.0) < limits.FACTOR)
    # Without names: a voltage goes with the speed as well, though less.
    return speed.name.quantity in ("speed", "") and (
        p.r > limits.UNNAMED or bool(angle.name.quantity or speed.name.quantity)
    )


_SECOND = {"estimated": 1, "filtered": 2, "electrical": 3}
"""What comes after a column as it was measured."""


def _first(could: Sequence[LoggedColumn], quantity: str) -> LoggedColumn | None:
    """The first column that is called so; what is estimated comes after what is not."""
    named = [c for c in could if c.name.quantity == quantity]
    return min(named, key=lambda c: _SECOND.get(c.name.role, 0), default=None)


def _explaining(
    grid: Grid, could: Sequence[LoggedColumn], free: Sequence[LoggedColumn], where: str, hint: str
) -> tuple[LoggedColumn | None, LoggedColumn | None]:
    """The column that explains another best as an angle or as a speed."""
    tried: list[tuple[float, LoggedColumn | None, LoggedColumn | None, LoggedColumn]] = []
    for x in could:
        for angle, speed in ((x, None), (None, x)):
            motion = motion_from(grid, angle, speed)
            for y in free:
                if y is x:
                    continue
                balance = balance_of(motion, grid.smooth(y), periodic=False)
                # Friction in the direction of motion: it tells a motion from what it drives.
                if balance is not None and balance.shares["friction"] > 0.05:
                    tried.append((balance.r2, angle, speed, y))
    best: tuple[float, LoggedColumn | None, LoggedColumn | None] = (0.0, None, None)
    for _, angle, speed, y in sorted(tried, key=lambda one: -one[0])[:4]:
        # The search for gravity takes longest: it decides among the few that friction and inertia leave.
        balance = balance_of(motion_from(grid, angle, speed), grid.smooth(y))
        if balance is not None and balance.r2 > best[0]:
            best = (balance.r2, angle, speed)
    if best[0] < limits.SHOWN:
        raise _unnamed(where, few([c.text for c in could]), hint)
    return best[1], best[2]


def _unnamed(where: str, columns: str, hint: str = "", *, drive: bool = False) -> InputError:
    """Neither names nor values show the motion, or a drive that follows it."""
    return InputError(
        where,
        problem="expected an angle or a speed, and a drive; no name says that a column is one"
        f" ({columns}), and none follows another as a drive follows a motion"
        if drive
        else "expected an angle or a speed; no column looks like one"
        f" ({columns or 'all others have names of other quantities'})",
        hint=hint
        or "name the columns in the file, as in angle [deg] and speed [rpm]: without a drive that follows"
        ' them, as in a coast-down (drive = "none"), only names show which is which',
    )


def _without_copies(
    grid: Grid, rest: Sequence[LoggedColumn], angle: LoggedColumn | None, speed: LoggedColumn | None
) -> tuple[list[LoggedColumn], dict[str, str]]:
    """The columns that are no copy or set value of angle or speed, and why the others are left out."""
    kept: list[LoggedColumn] = []
    why: dict[str, str] = {}
    inner = grid.inner()
    # Of very many columns, those without a name are left out anyway where a drive has one.
    named = len(rest) > limits.MANY and any(c.name.quantity in KINDS for c in rest)
    for column in rest:
        if column.name.quantity == "acceleration":
            why[column.text] = "the acceleration is taken from the angle"
            continue
        for of, what in () if named and not column.name.quantity else ((angle, "angle"), (speed, "speed")):
            if of is None or (column.name.quantity not in ("", what) and not _letter(column)):
                continue
            x, y = (grid.smooth(one, angle=what == "angle")[inner] for one in (of, column))
            sizes = float(np.std(x)), float(np.std(y))
            r = abs(float(np.corrcoef(x, y)[0, 1])) if min(sizes) > 0.0 else 0.0
            # A set value has the unit of what it is for; a current that happens to go with the speed has not.
            copy = r > limits.COPY and abs(sizes[0] / sizes[1] - 1.0) < 0.15 and not _letter(column)
            same = r > limits.SAME or copy
            if same or column.name.quantity == what:
                why[column.text] = f"another {what}, or its set point; {of.text} is used"
                break
        else:
            kept.append(column)
    return kept, why


def _beside_sensor(drives: list[Proposal], of_no_joint: Sequence[LoggedColumn]) -> list[Proposal]:
    """The drives, the first with a doubt where a torque beside the joint's own is measured."""
    sensors = [c for c in of_no_joint if c.name.quantity == "torque" and c.varies > limits.HARDLY]
    if not drives or not sensors:
        return drives
    said = f"a sensor of its own? {sensors[0].text} is of no joint, and may be the torque of this one"
    return [drives[0].doubted(said), *drives[1:]]


def _beside_supply(
    drives: list[Proposal], supply: LoggedColumn | None, left: Mapping[str, LoggedColumn]
) -> list[Proposal]:
    """The drives, with a doubt at a current that may be the supply's, whose voltage is logged."""
    steady = (c for c in left.values() if c.name.quantity == "voltage" and c.varies <= limits.SUPPLY)
    supply = supply or next(steady, None)
    if supply is None:
        return drives
    said = f"a supply current? {supply.text} is logged"
    return [
        p.doubted(said) if p.channel == "current" and not is_of_motor(left[p.source].name) else p
        for p in drives
    ]


def _moves_too(
    others: Sequence[LoggedColumn], angle: LoggedColumn | None, speed: LoggedColumn | None, grid: Grid
) -> str:
    """That another column of the same quantity moves in a way of its own, as that of another machine does."""
    of = angle or speed
    if of is None or wrap_of(of, grid.breaks):
        return ""
    for column in others:
        same = column.name.quantity == of.name.quantity and column.name.signal and column.range > 0.0
        if not same or column.name.role == "electrical" or wrap_of(column, grid.breaks):
            continue
        x, y = (grid.smooth(one) for one in (of, column))
        if np.std(y) > limits.MOVES * np.std(x) and abs(np.corrcoef(x, y)[0, 1]) < limits.DERIVATIVE:
            return f"{column.text} moves independently: is it from another machine?"
    return ""


def _with_duty(
    drives: list[Proposal],
    balances: dict[str, Explained],
    voltage: Proposal | None,
    grid: Grid,
    motion: Moved,
    left: Mapping[str, LoggedColumn],
    *,
    lasting: bool,
) -> tuple[list[Proposal], dict[str, Explained]]:
    """A voltage that is a duty cycle times a supply, where none is logged; `lasting` as of `find_drives`."""
    if voltage is None or "voltage" in balances:
        return drives, balances
    y = np.ones(1)
    for name, column in left.items():
        if name in voltage.reads:
            y = y * grid.smooth(column)
    if voltage.source in {p.source for p in drives}:
        return drives, balances
    if any(without_sign(c, motion) for n, c in left.items() if n in voltage.reads[:1]):
        voltage = voltage.doubted(UNSIGNED)
    balance = balance_of(motion, y, periodic=lasting)
    if balance is not None:
        return [*drives, voltage], {**balances, "voltage": balance}
    if drives or not np.any(y):
        return drives, balances
    constant = f"constant, {y[0]:.4g} in all rows: friction and inertia cannot be told apart from one step"
    return [voltage.doubted(constant)], balances


def _channels(
    clock: Clock,
    run: Proposal | None,
    found: Sequence[Reading],
    given: Shown,
    pair: Pair | None,
    gear: Gear,
    doubt: str,
) -> list[Proposal]:
    """Time, run, angle and speed in the units of the best reading."""
    best = found[0]
    shown = bool(best.why["angle"]) or (given.speed is not None and bool(given.speed.name.unit))
    time = clock.proposal
    if best.time != time.unit:
        said = f"{best.time} fits the units of angle and speed"
        time = Proposal(
            "time", time.column, best.time, (*time.evidence[:1], said), time.confidence, time.doubt
        )
    proposals = [*([run] if run else []), time]
    for column, what, unit in ((given.angle, "angle", best.angle), (given.speed, "speed", best.speed)):
        if column is None:
            continue
        sure = sum(r.weight for r in found if getattr(r, what) == unit and _alike(r, best, unit))
        said = list(best.why[what])
        if what == "speed":
            said = [*_said(pair), *said]
        if column.name.quantity == what:
            said.insert(0, f"{what} by its name")
        if column.astray:
            said.append(f"{counted(column.astray, 'row')} far from its neighbours, which a fit drops")
        doubts = [doubt] if doubt else []
        if column.name.role == "electrical":
            doubts.append(ELECTRICAL)
        elif given.speed is not None and given.speed.name.role == "electrical":
            doubts.append(f"by {given.speed.text}: {ELECTRICAL}")
        if column.name.maker:
            doubts.append(f"turns ({column.name.maker}'s unit): check")
        if (
            what == "angle"
            and unit == "counts"
            and given.wrap in limits.COUNTERS
            and not _is_turn(best, given)
        ):
            doubts.append(f"turn or {math.log2(given.wrap):g}-bit overflow?")
        also = _others(found, what, unit) if sure < limits.SURE else []
        turn = {f"{r.counts:.6g}" for r in found if r.weight > 0.02 and r.counts} - {f"{best.counts:.6g}"}
        if sure < limits.SURE and unit == "counts" and turn:
            also.append(f"{' or '.join(sorted(turn))} counts per turn")
        if also:
            doubts.append(f"could also be {' or '.join(also)}")
        elif sure < limits.SURE or not shown:
            doubts.append(BY_SIZE)
        if "counts" in unit and best.product:
            doubts.append("the log shows counts per turn times gear, not each: check encoder_counts_per_rev")
        if "counts" in unit and not best.counts:
            doubts.append("the log does not show how many counts make a turn: set encoder_counts_per_rev")
        channel = f"theta_{gear.angle}" if what == "angle" else f"omega_{gear.speed}"
        by_gravity = best.by_gravity if what == "angle" else ()
        turned = what == "speed" and given.angle is not None and given.factor < 0.0
        found_in = Proposal(
            channel, column.text, unit, tuple(said), sure, "; ".join(doubts), turned, by_gravity=by_gravity
        )
        if unit == REGISTER:
            found_in = found_in.doubted(f"{REGISTER} (Dynamixel X): check")
            source = f"{quoted(column.text)} * 0.229"
            found_in = replace(found_in, source=source, unit="rpm", reads=(column.text,))
        proposals.append(found_in)
    return proposals


ELECTRICAL = "electrical, by its name: divide it by the pole pairs of the motor"


def _is_turn(best: Reading, given: Shown) -> bool:
    """Whether gravity or a speed in a unit confirms that a wrap of the angle is a turn."""
    return abs(best.gear - 1.0) < limits.SAME_SHAFT or (
        given.speed is not None and bool(given.speed.name.unit)
    )


def _alike(reading: Reading, best: Reading, unit: str) -> bool:
    """Whether a reading in the same unit has the same counts per turn, where the unit is counts."""
    return "counts" not in unit or math.isclose(reading.counts, best.counts, rel_tol=1e-3)


def _others(found: Sequence[Reading], what: str, unit: str) -> list[str]:
    weights: dict[str, float] = {}
    for reading in found:
        own = getattr(reading, what)
        if own != unit:
            weights[own] = weights.get(own, 0.0) + reading.weight
    return [
        f"{own} (probability {100 * weight:.0f} %)"
        for own, weight in sorted(weights.items(), key=lambda x: -x[1])
        if weight > 0.02
    ]
