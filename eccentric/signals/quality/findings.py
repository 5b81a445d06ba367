"""The quality of a log under its rig, reported before anything is fitted.

    table, channels, rig -> each signal alone (`quality_record`)
                         -> angle against speed (`plausible`)
                         -> drive against motion, motion against rig (`quality_rig`)

A finding is a likely explanation of numbers that cannot all be right; it changes nothing in the log.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from eccentric.signals.finding import Finding
from eccentric.signals.limits import LEAST_CORRELATION
from eccentric.signals.plausible import speed_doubt, speed_factor, unwrapped
from eccentric.signals.quality.against_rig import rig_findings
from eccentric.signals.quality.record import record_findings, record_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from eccentric.rigs import Rig
    from eccentric.signals.measured import Channels
    from eccentric.signals.table import Table

__all__ = ["Finding", "assess"]


def assess(table: Table, channels: Channels, rig: Rig) -> tuple[Finding, ...]:
    """Return the findings about the logs, warnings first.

    Args:
        table: the kept rows in SI as they were logged.
        channels: the same rows as signals on the motor side; comparisons with the rig use only the rows that
            a fit may use, never the held-out ones.
        rig: what is known.
    """
    found = list(record_findings(table, channels))
    # Consequences of a failed channel are not reported again.
    if not any(finding.kind == "frozen" for finding in found):
        found += [*_speed(table, channels, rig), *rig_findings(channels, rig)]
    return tuple(sorted(found, key=lambda finding: finding.severity == "note"))


def _speed(table: Table, channels: Channels, rig: Rig) -> Iterator[Finding]:
    """Angle and speed of one shaft describe the same motion."""
    c, mu = record_of(table, channels), rig.known.get("mu")
    name = next((name for name in ("theta_m", "theta_l") if name in table.channels), None)
    if name is None:
        return
    gear = rig.value("mu") if name == "theta_l" else 1.0
    _, said = unwrapped(c.t, table.channels[name] / gear, c.segment, c.run, mu)
    if said:
        kind, severity = ("wrong_unit", "warning") if said.endswith("deg?") else ("wrapped", "note")
        yield Finding(kind, name, said, len(c.t), severity)
    if c.omega_logged is None:
        return
    doubt = speed_doubt(c.t, c.theta, c.omega_logged, c.segment, mu)
    told = speed_factor(c.t, c.theta, c.omega_logged, c.segment)
    if doubt and told:
        factor, correlation = told
        follows = abs(correlation) >= LEAST_CORRELATION
        kind = ("wrong_sign" if factor < 0.0 else "wrong_unit") if follows else "mismatch"
        name = "omega_m" if "omega_m" in table.channels else "omega_l"
        yield Finding(kind, name, _advised(doubt), len(c.t), "warning")


def _advised(doubt: str) -> str:
    """What is wrong with the logged speed, possibly as a question, and what to do."""
    return f"{doubt}{' C' if doubt.endswith('?') else '; c'}orrect the rig's [columns] or mu"
