"""The columns of an arm's log: one for every joint by the patterns of the rig, and none for another joint."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from eccentric.errors import InputError, counted, few, meant

if TYPE_CHECKING:
    from eccentric.logs import Log
    from eccentric.rigs import ArmRig

__all__ = ["require_columns"]

_ARITHMETIC = re.compile(r"[`+*/()<>=]|\s-\s")
"""What a source has that is not the name of a column."""


def require_columns(log: Log, rig: ArmRig) -> None:
    """Raise InputError, one line, unless the log has the columns of all joints and of no further one."""
    for channel in rig.patterns:
        names = [rig.column(channel, j) for j in range(len(rig.joints) + 1)]
        _require_all(log, rig, channel, names[:-1])
        if names[-1] in log.columns:
            of = f"the {counted(len(rig.joints), 'joint')} of {rig.chain.name}"
            raise InputError(
                f"{log.path}: {channel}: columns of {of} are required, the log has"
                f" {names[-1]!r} for a joint {rig.number(len(rig.joints))} that the arm does not have"
            )


def _require_all(log: Log, rig: ArmRig, channel: str, names: list[str]) -> None:
    missing = [j for j, name in enumerate(names) if name not in log.columns]
    if not missing or (len(missing) == len(names) and _ARITHMETIC.search(names[0])):
        return
    j, there = missing[0], len(names) - len(missing)
    some = f", received {there} of {counted(len(names), 'joint')}" if there else ""
    of = f"joint {rig.number(j)} of {rig.chain.name}"
    raise InputError(
        f"{log.path}: {channel}: column {names[j]!r} is required for {of}"
        f" (columns count from first = {rig.first}){some}, the log has {few(log.columns)}"
        f"{meant(names[j], log.columns)}"
    )
