"""Whether drive, motion and rig are consistent: signs, units by a factor, a log from another rig.

Only questions whose answers differ by factors are asked: they need no model of the friction.
"""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eccentric.model import AxisKind
from eccentric.signals.clock import Finding
from eccentric.signals.quality import limits
from eccentric.signals.quality.causes import (
    Logged,
    common_cause,
    mass_causes,
    misreadings,
    of_letter,
    readings,
    single_cause,
    with_unit,
)
from eccentric.signals.quality.ratios import (
    Means,
    Ratio,
    RigidBody,
    body_of,
    constant_beside_torque,
    constant_by_torque,
    electrical,
    is_clear,
    means_of,
    mechanical,
    motor_constant,
    torque_per_unit,
    upright_gravity_of,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from eccentric.rigs import Rig
    from eccentric.signals.measured import Channels


Array = NDArray[np.float64]


def rig_findings(channels: Channels, rig: Rig) -> Iterator[Finding]:
    """Yield wrong signs, and contradictions between rig and log by a factor."""
    means, drive = means_of(channels, rig), channels.motor.measured_by
    # A load or gravity accounts for one sign, but then for nearly one size, too; in case C1 the rig has none.
    alike = 0.0 if rig.case == "C1" else limits.SAME_SIZE
    if means is None:
        if unsigned := _unsigned(_moving_rows(channels), drive, rig, alike):
            yield unsigned
        return
    if unsigned := _unsigned(means, drive, rig, alike):
        yield unsigned
        return
    if inverted := _inverted(means, drive, rig):
        yield inverted
        return
    bodies = {name: body_of(means, x, means.link) for name, x in means.drives.items()}
    bodies = {name: body for name, body in bodies.items() if body.explained >= limits.EXPLAINED}
    against = [name for name, body in bodies.items() if _reversed(body)]
    if against:
        # Where one sign drives it both ways, turning it makes negative friction of positive and no more.
        if one_sided := _unsigned(means, against[0], rig, 0.0):
            yield one_sided
            return
        yield _sign(against, bodies, means, rig.axis)
        return
    # In case C1 a slow sine would explain any drift.
    logged = _logged(channels, rig)
    unit = "" if rig.case == "C1" else _angle_unit(means, logged)
    if unit:
        channel, name = logged.motion
        term = rig.axis.term(drive)
        text = f"the {term} follows gravity if the {name} {unit}: correct [columns] or mu in the rig file"
        yield Finding("wrong_unit", channel, text, means.rows, "warning")
        return
    ratios = [*electrical(means, rig)]
    if drive in bodies:
        body = bodies[drive]
        ratios += mechanical(body, drive, rig)
        ratios += motor_constant(means, body, drive, rig)
        yield from _gravity(body, channels, rig, means)
    yield from _contradictions(ratios, rig, channels, means.rows)


def beside_the_rig(channels: Channels, rig: Rig) -> list[Ratio]:
    """R, k_e, k_i, inertia and gravity by a plain balance of the log, over what the rig declares."""
    means = means_of(channels, rig)
    if means is None:
        # Where moving rows are too few, the circuit is still seen, at standstill and through reversals.
        circuit = means_of(channels, rig, moving=False)
        return [] if circuit is None else list(electrical(circuit, rig))
    found, drive = [*electrical(means, rig), *constant_beside_torque(means, rig)], channels.motor.measured_by
    if drive in means.drives:
        body = body_of(means, means.drives[drive], means.link)
        if body.explained >= limits.EXPLAINED:
            found += mechanical(body, drive, rig)
            found += constant_by_torque(body, drive, rig)
    return found


def shared_cause(ratios: Sequence[Ratio], channels: Channels, rig: Rig) -> tuple[str, str] | None:
    """The one wrong unit, scale or gear that explains all ratios, and the line that mends the rig, or ""."""
    cause = common_cause(ratios, _logged(channels, rig))
    return with_unit(cause, rig) if cause else None


def _moving_rows(c: Channels) -> Means:
    """The moving rows themselves, where they are too few for means."""
    rows = np.flatnonzero(c.selection.fit_rows & ~c.motor.off & np.isfinite(c.motion.omega_m))
    found = {"current": c.motor.current, "torque": c.motor.torque, "voltage": c.motor.voltage}
    drives = {name: x[rows] for name, x in found.items() if x is not None and not c.motor.coasting}
    return Means(c.motion.alpha_m[rows], c.motion.omega_m[rows], None, drives, len(rows))


def _unsigned(m: Means, drive: str, rig: Rig, alike: float) -> Finding | None:
    """Blame a drive of one sign in both directions: friction alone makes it turn over.

    alike: the smaller size over the larger one, at least.
    """
    x = m.drives.get(drive)
    if x is None or not len(x) or rig.known.get("T_load") or "T_load" in rig.unknown:
        return None
    ways = [x[m.omega > 0.0], x[m.omega < 0.0]]
    if min(map(len, ways)) < limits.ONE_WAY * len(x):
        return None
    sizes = [abs(float(np.mean(way))) for way in ways]
    sign = np.sign(float(np.mean(x)))
    if np.mean(m.alpha * sign > 0.0) >= limits.ONE_SIGN:
        return None  # inertia turns it over
    if np.mean(x * sign > 0.0) < limits.ONE_SIGN or min(sizes) < alike * max(sizes):
        return None
    name, side = rig.axis.named(drive), "positive" if sign > 0.0 else "negative"
    text = (
        f"the {name} is {side} in both directions: its sign is missing, as in"
        " a supply current or a duty cycle, or the rig file lacks a load: gravity, or a constant one"
        f" ({rig.axis.named('T_load')}, with a range in [unknown])"
    )
    return Finding("wrong_sign", drive, text, m.rows, "warning")


def _inverted(m: Means, drive: str, rig: Rig) -> Finding | None:
    """Blame mu if its inverse makes gravity, and inertia if visible, agree with the rig."""
    x, mu = m.drives.get(drive), rig.known.get("mu")
    if x is None or m.link is None or mu is None:
        return None

    def ratios(body: RigidBody, gear: float) -> list[Ratio]:
        turned = dataclasses.replace(rig, known={**rig.known, "mu": gear})
        return list(mechanical(body, drive, turned))

    body, other = body_of(m, x, m.link), body_of(m, x, m.link / mu**2)
    if 1.0 - other.explained > min(limits.BETTER * (1.0 - body.explained), limits.EXPLAINED):
        return None
    if torque_per_unit(drive, rig) is None:
        return _inverted_by_angle(m, m.link, drive, rig, other)
    off = [ratio for ratio in ratios(body, mu) if ratio.off(limits.FACTOR)]
    mended = ratios(other, 1.0 / mu)
    if not off or "M g L" not in {r.name for r in mended} or not all(r.near(1.0) for r in mended):
        return None
    said = ", ".join(ratio.text for ratio in off)
    text = f"mu is inverted ({1.0 / mu:.4g} fits, link speed over motor speed): with {mu:.4g}, {said}"
    return Finding("contradiction", "mu", text, m.rows, "warning")


def _inverted_by_angle(m: Means, link: Array, drive: str, rig: Rig, other: RigidBody) -> Finding | None:
    """Blame mu where the rig leaves the torque of the drive open: `other` is the body by the inverse.

    Gravity must show there alone, better than by any other unit of the angle, and its torque constant be in
    the range of the rig: mu^2 may be nearly the factor of a unit.
    """
    x, mu = m.drives[drive], rig.known["mu"]
    turned = dataclasses.replace(rig, known={**rig.known, "mu": 1.0 / mu})
    units = (
        body_of(m, x, link / factor) for factor in misreadings(Logged(drive, mu, True, rig.axis)).values()
    )
    if not is_clear(*other.gravity) or other.explained < max(body.explained for body in units):
        return None
    if drive == "current" and any(motor_constant(m, other, drive, turned)):
        return None
    text = (
        f"mu is inverted: gravity shows with {1.0 / mu:.4g} (link speed over motor speed), not with {mu:.4g}"
    )
    return Finding("contradiction", "mu", text, m.rows, "warning", f"mu = {1.0 / mu:.6g}")


def _reversed(body: RigidBody) -> bool:
    """Return whether the drive opposes the motion: inertia and friction would both be negative."""
    (inertia, i_error), (loss, l_error) = body.inertia, body.loss
    if is_clear(loss, l_error) and loss < 0.0:
        return inertia < 0.0 or not is_clear(inertia, i_error)
    return is_clear(inertia, i_error) and inertia < 0.0 and loss < 0.0


def _sign(against: list[str], bodies: dict[str, RigidBody], m: Means, axis: AxisKind) -> Finding:
    """Blame the drive that opposes the motion, or the angle if all do."""
    angle = axis.term("angle")
    if len(against) == len(bodies) > 1:
        channel = "theta_m"
        text = f"the {angle} is opposite in sign to {' and '.join(map(axis.named, against))}"
    else:
        channel, text = against[0], f"{axis.named(against[0])} is opposite in sign to the motion"
    text += (
        f": {axis.term('inertia')} and friction would be negative; put a minus"
        f" before its column in the rig file"
        f"{'' if channel == 'theta_m' else f' (or before that of the {angle})'}"
    )
    return Finding("wrong_sign", channel, text, m.rows, "warning")


def _logged(c: Channels, rig: Rig) -> Logged:
    columns = rig.log.columns or {}
    angle = c.motion.quantum_rad > 0.0
    of_link = ("theta_l" if angle else "omega_l") in columns
    return Logged(c.motor.measured_by, rig.known.get("mu"), angle, rig.axis, of_link)


def _angle_unit(m: Means, logged: Logged) -> str:
    """Return the unit or side of the angle under which gravity shows, empty for the rig's own."""
    x = m.drives.get(logged.drive)
    if m.link is None or x is None:
        return ""
    words = {1.0: ""} | {factor: unit for unit, factor in misreadings(logged).items()}
    bodies = {factor: body_of(m, x, m.link / factor) for factor in words}
    best = max(bodies, key=lambda factor: bodies[factor].explained)
    left, now = 1.0 - bodies[best].explained, 1.0 - bodies[1.0].explained
    if left > min(limits.BETTER * now, limits.EXPLAINED) or not is_clear(*bodies[best].gravity):
        return ""
    return words[best]


def _gravity(body: RigidBody, c: Channels, rig: Rig, m: Means) -> Iterator[Finding]:
    """Yield gravity where the rig's case has none, and gravity in the wrong direction."""
    value, error = body.gravity
    drive = c.motor.measured_by
    scale, upright = torque_per_unit(drive, rig), upright_gravity_of(rig)
    if rig.case == "C1":
        if scale is None or upright is None:
            return
        # Of a short travel the amplitude is extrapolated: any slow load has that shape there.
        seen = m.link is not None and 0.5 * np.ptp(np.sin(m.link + body.turned)) >= limits.SEEN
        if seen and is_clear(value, error) and scale * value > upright / limits.FACTOR:
            expected = f" ({upright:.3g} N m)" if upright else ", with a mass M at L"
            text = (
                f"the {drive} contains a gravity torque of {scale * value:.3g} N m at the motor, but the rig"
                f" file declares none (C1): is the plane of motion vertical, case C2{expected}?"
            )
            yield Finding("contradiction", "case", text, m.rows, "warning")
    elif (
        is_clear(value, error)
        and abs(body.turned) > limits.TURNED
        and "theta_zero_rad" not in rig.estimate
        and c.motion.quantum_rad > 0.0
    ):
        zero = math.remainder(rig.alignment.theta_zero_rad - body.turned, math.tau)
        text = (
            f"gravity pulls towards {math.degrees(body.turned):.0f} deg off the zero angle of the log:"
            f" set theta_zero_rad = {zero:.3g} in the rig file (the logged link angle at which the mass hangs"
            " straight down)"
        )
        yield Finding("zero_angle", "theta_m", text, m.rows, "warning")


def _contradictions(ratios: list[Ratio], rig: Rig, c: Channels, rows: int) -> Iterator[Finding]:
    """Yield one wrong unit that explains all deviations, else each deviation by itself."""
    factors = {"R": limits.FACTOR_MOTOR, "k_e": limits.FACTOR_MOTOR}
    factors |= dict.fromkeys(("k_i", "k_i by gravity"), limits.IDEAL)
    off = [ratio for ratio in ratios if ratio.off(factors.get(ratio.name, limits.FACTOR))]
    if not off:
        return
    logged = _logged(c, rig)
    cause = common_cause(ratios, logged)
    if cause:
        said, mend = with_unit(cause, rig)
        text = f"{said}: {', '.join(ratio.text for ratio in off)}"
        yield Finding(cause.kind, cause.channel, text, rows, "warning", mend)
        return
    for ratio in off:
        if ratio.name == "J" and (causes := mass_causes(ratio, logged) if not rig.axis.wraps else []):
            said, mend = readings(causes, ratio, rig)
            text = f"{ratio.text} ({said}?); correct the one that is wrong"
            yield Finding("contradiction", ratio.letter, text, rows, "warning", mend)
            continue
        if ratio.found < 0.0 and ratio.name in factors:
            text = f"{ratio.text}, which is impossible: look for a wrong sign or swapped columns in [columns]"
            yield Finding("contradiction", ratio.letter, text, rows, "warning")
            continue
        why, blamed = single_cause(ratio, logged, ratios)
        _, mend = with_unit(blamed, rig) if blamed else ("", of_letter(ratio, rig))
        unit = blamed is not None and blamed.kind == "wrong_unit"
        todo = "[columns] in the rig file" if unit else f"the rig file{_or_estimate(ratio, rig)}"
        text = f"{ratio.text}{why}; correct {todo}"
        # Where the rig's k_e is that of the log, the log says nothing against its k_i but that they differ.
        doubtful = not (ratio.name == "k_i" and any(r.name == "k_e" and r.near(1.0) for r in ratios))
        severity = "warning" if doubtful else "note"
        yield Finding("contradiction", ratio.letter, text, rows, severity, mend)
    if {"J", "M g L"} <= {ratio.name for ratio in off}:
        text = (
            f"neither {rig.axis.term('inertia')} nor gravity in the rig file agrees with the"
            f" log, which may be from another rig"
        )
        yield Finding("another_rig", c.motor.measured_by, text, rows, "warning")


def _or_estimate(ratio: Ratio, rig: Rig) -> str:
    """What else can be done; empty where no single quantity of a rig file stands for the one in question."""
    if ratio.letter == "J" and rig.axis.wraps:
        return ", or give the load's J_l in [unknown] to estimate it jointly"
    return ", or give it in [unknown] to estimate it jointly" if of_letter(ratio, rig) else ""
