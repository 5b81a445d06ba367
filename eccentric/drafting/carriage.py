"""A drive that moves a carriage: the units of its position and velocity, and the lines of its rig."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from eccentric.core import InputError
from eccentric.drafting import limits
from eccentric.drafting.columns import LoggedColumn
from eccentric.drafting.proposal import Proposal, RigLine, asked_parts, computed_by, known_asked
from eccentric.drafting.questions import ONE_WAY
from eccentric.drafting.units import Shown
from eccentric.drafting.words import of_a_carriage
from eccentric.logs import parse_unit

_LENGTHS = ("m", "cm", "mm", "um")
_TORQUE = "a torque: behind a screw the force is 2 pi times it over the pitch, as arithmetic on this column"
_FORCE = "a force: a shaft is driven by a torque"
_REFERENCE = 'of an amplifier\'s reference put the force instead, as in { column = "u", gain = "35 N/V" }'
_VELOCITIES = tuple(f"{unit}/s" for unit in _LENGTHS)


FORCES = frozenset({"force", "kraft", "thrust", "f"})
"""Words for what drives a carriage; a shaft has a torque."""


def is_carriage(given: Shown, drive: LoggedColumn | None = None) -> bool:
    """Whether a name gives position or velocity a unit of length, or neither a unit and a force drives."""
    moving = [c for c in (given.angle, given.speed) if c is not None]
    by_force = drive is not None and drive.name.word in FORCES and not any(c.name.unit for c in moving)
    return by_force or any(of_a_carriage(c.name.unit) for c in moving)


def carriage_channels(given: Shown, said_of_speed: Sequence[str]) -> list[Proposal]:
    """Position and velocity: units by name, else by the velocity as the slope of the position.

    Args:
        given: what the values show.
        said_of_speed: evidence that the velocity is one.
    """
    proposals = []
    position, velocity = (_size(c.name.unit) if c else 0.0 for c in (given.angle, given.speed))
    for column, known, size, units, channel in (
        # The velocity as logged is `factor` times the slope of the position as logged.
        (given.angle, position, velocity * abs(given.factor), _LENGTHS, "theta_m"),
        (given.speed, velocity, _ratio(position, abs(given.factor)), _VELOCITIES, "omega_m"),
    ):
        if column is None:
            continue
        said = list(said_of_speed) if channel == "omega_m" else []
        unit, sure, doubt = column.name.unit, 0.99, ""
        if known:
            said.append(f"{unit} by its name")
        elif size:
            off = {name: abs(math.log(_size(name) / size)) for name in units}
            unit = min(off, key=lambda name: off[name])
            said.append("as the slope of the position asks for")
            sure, doubt = (0.95, "") if off[unit] < 4.0 * limits.FACTOR else (0.3, "no unit fits")
        elif position or velocity or channel == "theta_m" or not given.angle:
            unit, sure, doubt = units[0], 0.3, "the log does not show its unit"
        else:
            # Both without a unit: of one length, by the slope.
            per_second = _size(_LENGTHS[0]) / max(abs(given.factor), 1e-30)
            off = {name: abs(math.log(_size(name) / per_second)) for name in units}
            unit = min(off, key=lambda name: off[name])
            sure, doubt = (
                0.3,
                "the log does not show its unit, only that it is that of the position per second",
            )
        proposals.append(Proposal(channel, column.text, unit, tuple(said), sure, doubt))
    return proposals


def _ratio(above: float, below: float) -> float:
    return above / below if below else 0.0


def _size(unit: str) -> float:
    """A unit of length or velocity in SI; 0 for others."""
    return parse_unit(unit, "").factor if of_a_carriage(unit) else 0.0


def driven(
    drives: Sequence[Proposal], stated: Mapping[str, str], carriage: bool
) -> tuple[list[Proposal], dict[str, str]]:
    """The drives of a carriage or a shaft, and why a column is none: one has a force, the other a torque.

    Args:
        drives: as they were found.
        stated: column -> unit that the header gives it, "" for none.
        carriage: whether it is one.
    """
    kept: list[Proposal] = []
    left_out: dict[str, str] = {}
    channels = {drive.channel for drive in drives}
    for drive in drives:
        if carriage and drive.channel == "torque" and not stated.get(drive.source):
            kept.append(replace(drive, unit="N", doubt="no unit in its name: N, if it is a force"))
        elif drive.channel == "torque" and _is_force(drive.unit) != carriage:
            left_out[drive.source] = _TORQUE if carriage else _FORCE
        elif drive.channel == "torque" and carriage:
            said = tuple(one.replace("torque by its name", "force by its name") for one in drive.evidence)
            kept.append(replace(drive, evidence=said))
        elif carriage and channels == {"voltage"}:
            kept.append(drive.doubted(_REFERENCE))
        else:
            kept.append(drive)
    return kept, left_out


def _is_force(unit: str) -> bool:
    try:
        return parse_unit(unit, "").dimension == parse_unit("N", "").dimension
    except InputError:
        return False


def carriage_entries(
    given: Shown, channels: Sequence[Proposal], drives: Sequence[Proposal], largest: float, one_way: bool
) -> list[RigLine]:
    """The lines of the rig file.

    Args:
        given: what the values show.
        channels: position and velocity.
        drives: what moves the carriage.
        largest: value of the first of these, in its unit.
        one_way: whether it moves in one direction only, where a constant force is Coulomb friction.
    """
    kinds = {p.channel for p in drives}
    length = next(c.unit for c in channels)
    by_name = any(c is not None and c.name.unit for c in (given.angle, given.speed))
    why = f"{length} is a unit of a carriage, not of a shaft" if by_name else "a force drives it, by its name"
    doubt = "" if by_name else f"no unit says so: of a shaft it is a torque; {length} is taken for the length"
    entries = [RigLine("", "kind", '"linear"', why, doubt)]
    position = next((c for c in channels if c.channel == "theta_m"), None)
    if given.step and position is not None:
        step = given.step * _size(position.unit)
        why = f"the smallest step of the position, {given.step:.6g} {position.unit}"
        entries.append(RigLine("", "encoder_step_m", f"{step:.6g}", why))
    entries += asked_parts("screw")
    why = "travel per turn of the screw; with it, effects over a turn are tried"
    entries += [
        known_asked("pitch", "10 mm", why),
        known_asked("mass", "95 kg", "moving mass; estimated unless given"),
    ]
    if "current" in kinds:
        why = "the force constant (data sheet): the log cannot show it"
        entries.append(computed_by(drives, known_asked("k_f", "50 N/A", why, needed=True)))
    if "voltage" in kinds:
        why = "resistance of the armature (data sheet), with k_e and k_f for a voltage at the motor"
        entries += [
            known_asked("R", "1 ohm", why),
            known_asked("k_e", "50 V s/m", "back-EMF constant (data sheet)"),
        ]
        if "current" not in kinds:
            entries.append(known_asked("k_f", "50 N/A", "force constant (data sheet)"))
    force = next((p for p in drives if p.channel == "torque"), None)
    end = f"{float(f'{largest:.1g}'):g} {force.unit}" if force and largest else "1000 N"
    why = "a constant force against positive motion: part of the weight; an amplifier's offset looks the same"
    ends = json.dumps([f"-{end}", end])
    if one_way:
        why = f"{why}; {ONE_WAY}"
    entries.append(RigLine("unknown", "F_load", ends, why, asked=one_way or kinds == {"voltage"}))
    return entries
