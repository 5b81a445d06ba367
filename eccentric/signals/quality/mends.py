"""What to write into the rig file for a wrong unit, scale or value."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING

from eccentric.signals.quality.limits import NEAR

if TYPE_CHECKING:
    from eccentric.rigs import Rig
    from eccentric.signals.quality.causes import Cause
    from eccentric.signals.quality.ratios import Ratio

__all__ = ["of_letter", "with_unit"]

_UNITS = {"current": "A", "voltage": "V", "torque": "N m"}
_K_I = "N m/A"
_PREFIXES = {1.0: "", 1e-3: "m", 1e-6: "u", 1e3: "k"}


def with_unit(cause: Cause, rig: Rig) -> tuple[str, str]:
    """Return the text of a cause, for the unit that the rig declares, and the line that mends the rig."""
    if cause.letter:
        return cause.text, f'{cause.letter} = "{rig.known[cause.letter] / cause.factor:.3g} {_K_I}"'
    if not cause.factor:
        return cause.text, ""
    source = (rig.log.columns or {}).get(cause.channel)
    column = source.text if source is not None else _standard(cause.channel)
    declared = source.unit.factor if source is not None and source.unit is not None else 1.0
    true = declared / cause.factor
    near = next((p for p in _PREFIXES if abs(math.log(true / p)) <= NEAR), None)
    if near is None:
        plain = column if column.isidentifier() else f"`{column}`"
        scaled = json.dumps(f"{plain} * {true:.3g}", ensure_ascii=False)
        # Arithmetic is not told from an odd name here: the factor alone is said.
        return cause.text, "" if set(column) & set("+-*/`") else f"{cause.channel} = {scaled}"
    unit = f"{_PREFIXES[near]}{_UNITS[cause.channel]}"
    unit = unit.replace("mN m", "mNm").replace("kN m", "kNm").replace("uN m", "uNm")
    text = f"the {cause.channel} is in {unit}" + (
        f", not {source.unit.text}" if source and source.unit else ""
    )
    return text, f'{cause.channel} = {{ column = {json.dumps(column, ensure_ascii=False)}, unit = "{unit}" }}'


def of_letter(ratio: Ratio) -> str:
    """Return the line of the rig with the value of the log; empty for a product of letters."""
    return f'{ratio.letter} = "{ratio.found:.3g} {ratio.unit}"' if ratio.letter in ("R", "k_e", "k_i") else ""


def _standard(channel: str) -> str:
    from eccentric.rigs import CHANNELS

    return CHANNELS[channel][0]
