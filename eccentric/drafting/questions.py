"""The lines of a drafted rig besides its channels: what the log shows, and questions about the rest."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from eccentric.core import counted
from eccentric.drafting import limits
from eccentric.drafting.balance import SHORT, Explained, Moved
from eccentric.drafting.columns import Grid, nice_counts
from eccentric.drafting.proposal import Proposal, RigLine, asked_parts, computed_by
from eccentric.drafting.units import Reading, Shown

TURN = 2.0 * math.pi


def entries_of(
    best: Reading,
    given: Shown,
    balance: Explained | None,
    gear: RigLine,
    drives: Sequence[Proposal],
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
    if best.angle == "counts":
        if best.counts:
            why = "; ".join(w for w in best.why["angle"] if "counts" in w)
            by_gravity = not given.wrap and not given.factor
            doubt = SHORT if by_gravity and balance is not None and balance.turns < 1.0 else ""
            counts = f"{best.counts:g}"
            return [RigLine("", "encoder_counts_per_rev", counts, why, doubt, guessed=bool(doubt))]
        return [
            RigLine(
                "", "encoder_counts_per_rev", "4096", "counts of the angle per turn of its shaft", asked=True
            )
        ]
    unit = {"rad": 1.0, "deg": TURN / 360.0, "rev": TURN, "mrad": 1e-3}[best.angle]
    if given.step:
        counts = TURN / (given.step * unit)
        if 90.0 < counts < 2e7 and (nice := nice_counts(counts, 2e-3)):
            return [
                RigLine(
                    "",
                    "encoder_counts_per_rev",
                    f"{nice:g}",
                    f"the smallest step of the angle, {given.step:.6g} {best.angle}",
                )
            ]
    return []


def _alignment(balance: Explained | None, kinds: set[str]) -> list[RigLine]:
    entries: list[RigLine] = []
    if balance is not None and balance.period:
        zero = TURN * balance.zero / balance.period
        entries.append(
            RigLine(
                "",
                "theta_zero_rad",
                '"estimate"',
                f"gravity vanishes at {zero:+.3f} rad of the link: the fit refines it",
            )
            if abs(zero) > 0.01
            else RigLine("", "theta_zero_rad", "0", f"gravity vanishes at {zero:+.3f} rad of the link")
        )
    if kinds == {"voltage"}:
        why = "a logged voltage is a command; it acts later, and only the fit shows by how much"
        entries.append(RigLine("", "input_delay_s", '"estimate"', why))
        if balance is not None and abs(balance.offset) > 0.02:
            entries.append(
                RigLine(
                    "",
                    "voltage_offset_V",
                    '"estimate"',
                    f"mean beyond motion: {balance.offset:+.3f} of its scatter",
                )
            )
    return entries


def _known(
    gear: RigLine, given: Shown, balance: Explained | None, drives: Sequence[Proposal]
) -> list[RigLine]:
    """[known] and [unknown]: the case and the gear as the log shows them, the rest as questions."""
    gravity, kinds = balance is not None and balance.period > 0.0, {p.channel for p in drives}
    entries: list[RigLine] = []
    if gravity and balance is not None:
        share, turns = balance.shares["gravity"], balance.turns
        part = min(share, 1.0)
        why = (
            f"gravity in the plane of motion: {part:.0%} of the drive's scatter repeats with the angle,"
            f" {turns:.1f} periods"
        )
        doubt = (
            "" if turns > 1.0 else "less than one period was seen: it may be a spring, or a load that drifts"
        )
        entries.append(RigLine("known", "case", '"C2"', why, doubt))
    elif balance is not None:
        why = "no gravity: nothing in the drive repeats with the angle in both directions"
        doubt = "" if given.angle is not None else "without an angle gravity cannot be seen"
        entries.append(
            RigLine(
                "known",
                "case",
                '"C1"',
                why,
                doubt or "a light mass or a barely moving axis would look the same in the log",
            )
        )
    else:
        entries.append(
            RigLine(
                "known",
                "case",
                '"C2"',
                "gravity in the plane of motion; C1: perpendicular to it",
                asked=True,
                needed=True,
            )
        )
    entries.append(gear)
    entries += [
        RigLine("known", "M", '"0.5 kg"', "the unbalanced mass: weigh it", asked=True, needed=True),
        RigLine(
            "known",
            "L",
            '"0.3 m"',
            "from the axis to the centre of that mass: measure it",
            asked=True,
            needed=True,
        ),
    ]
    if gravity or balance is None:
        entries.append(
            RigLine(
                "known",
                "M_l",
                '"0.2 kg"',
                "the link without the unbalanced mass: weigh it",
                asked=True,
                needed=True,
            )
        )
    if "current" in kinds and not gravity:
        why = "the torque constant (data sheet): without gravity the log cannot show it"
        asked = RigLine("known", "k_i", '"0.05 N m/A"', why, asked=True, needed=True)
        entries.append(computed_by(drives, asked))
    elif "current" in kinds:
        why = (
            "the torque constant, which gravity identifies; better the data sheet's, under [known] in place"
            " of this line: without it, gear losses may be a wrong constant"
        )
        entries.append(RigLine("unknown", "k_i", '["0.001 N m/A", "20 N m/A"]', why))
    if "voltage" in kinds:
        use = "diagnose requires it" if "current" in kinds else "it tells the back-EMF from friction"
        resistance = "diagnose requires it" if "current" in kinds else "with k_i it gives the current"
        entries += [
            RigLine(
                "known",
                "R",
                '"1 ohm"',
                f"resistance of the armature (data sheet); {resistance}",
                asked=True,
            ),
            RigLine(
                "known",
                "k_e",
                '"0.05 V s/rad"',
                f"back-EMF constant (data sheet), in SI equal to k_i; {use}",
                asked=True,
            ),
        ]
    entries += [
        RigLine(
            "known",
            "J_m",
            '"1000 g cm^2"',
            "inertia of the rotor (data sheet); without it the sum J_m + mu^2 J_l is estimated",
            asked=True,
        ),
        RigLine(
            "known", "J_l", '"0.05 kg m^2"', "inertia of the link about its axis, M L^2 included", asked=True
        ),
    ]
    return entries


ONE_WAY = "one direction only: Coulomb friction and a constant load are one and the same there"


def one_way(motion: Moved) -> bool:
    """Whether nearly all moving rows move in one direction."""
    return not np.any(motion.moving) or not 0.05 <= float(np.mean(motion.w[motion.moving] > 0.0)) <= 0.95


def facts_of(grid: Grid, motion: Moved) -> list[str]:
    """What else the log shows, one line each."""
    inner = grid.inner()
    still = 1.0 - float(np.mean(motion.moving[inner])) if np.any(inner) else 0.0
    both = float(np.mean(motion.w[motion.moving] > 0.0)) if np.any(motion.moving) else 0.0
    facts = [
        f"{counted(len(grid.parts), 'part')} without a gap, {1.0 / grid.step:.4g} rows a second (mean)",
        f"standing (below {limits.STILL:.0%} of its speed) in {still:.0%} of rows, forwards in {both:.0%}",
    ]
    if one_way(motion):
        facts.append(ONE_WAY)
    return facts
