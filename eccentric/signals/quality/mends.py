"""What to write into the rig file for a wrong unit, scale or value."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable
from typing import TYPE_CHECKING

from eccentric.rigs import channels_of, knowns_of
from eccentric.signals.quality.limits import NEAR

if TYPE_CHECKING:
    from eccentric.rigs import ForceGain, Rig
    from eccentric.signals.quality.causes import Cause
    from eccentric.signals.quality.ratios import Ratio

__all__ = ["of_letter", "readings", "with_unit"]

_PREFIXES = {1.0: "", 1e-3: "m", 1e-6: "u", 1e3: "k"}


def with_unit(cause: Cause, rig: Rig) -> tuple[str, str]:
    """Return the text of a cause, for the unit that the rig declares, and the line that mends the rig."""
    if cause.letter:
        unit = next(known.unit for known in knowns_of(rig.axis) if known.name == cause.letter)
        return cause.text, f'{cause.letter} = "{rig.known[cause.letter] / cause.factor:.3g} {unit}"'
    if not cause.factor:
        return cause.text, ""
    source = (rig.log.columns or {}).get(cause.channel)
    standard, si = channels_of(rig.axis)[cause.channel]
    column = source.text if source is not None else standard
    if source is not None and source.gain is not None:
        return _with_gain(cause, column, source.gain)
    declared = source.unit.factor if source is not None and source.unit is not None else 1.0
    true = declared / cause.factor
    near = next((p for p in _PREFIXES if abs(math.log(true / p)) <= NEAR), None)
    if near is None:
        plain = column if column.isidentifier() else f"`{column}`"
        scaled = json.dumps(f"{plain} * {true:.3g}", ensure_ascii=False)
        # Arithmetic is not told from an odd name here: the factor alone is said.
        return cause.text, "" if set(column) & set("+-*/`") else f"{cause.channel} = {scaled}"
    unit = f"{_PREFIXES[near]}{si}"
    unit = unit.replace("mN m", "mNm").replace("kN m", "kNm").replace("uN m", "uNm")
    name = {"theta_m": "angle", "omega_m": "speed"}.get(cause.channel, cause.channel)
    text = f"the {name} is in {unit}" + (f", not {source.unit.text}" if source and source.unit else "")
    return text, f'{cause.channel} = {{ column = {json.dumps(column, ensure_ascii=False)}, unit = "{unit}" }}'


def _with_gain(cause: Cause, column: str, gain: ForceGain) -> tuple[str, str]:
    """The same for a column that a gain converts: its unit stays, the gain is what differs."""
    true = f"{gain.value / cause.factor:.6g} {gain.unit}"
    unit = "" if gain.column is None else f'unit = "{gain.column}", '
    text = f"the gain of the {cause.channel} is {true}, not {gain.value:.6g} {gain.unit}"
    line = f'column = {json.dumps(column, ensure_ascii=False)}, {unit}gain = "{true}"'
    return text, f"{cause.channel} = {{ {line} }}"


def readings(causes: Iterable[Cause], ratio: Ratio, rig: Rig) -> tuple[str, str]:
    """Return several possible causes of one ratio, the rig's own value last, and the line for each."""
    told = [with_unit(cause, rig) for cause in causes]
    # No carriage moves kilometres, and nobody logs in kiloamperes.
    told = [(said, mend) for said, mend in told if not re.search(r" in k[mAV]\b", said)]
    value = f"{ratio.letter} is {ratio.found:.3g} {ratio.unit}", of_letter(ratio, rig)
    said, mends = zip(*told, value, strict=True)
    return ", or ".join(said), " or ".join(mends)


def of_letter(ratio: Ratio, rig: Rig) -> str:
    """Return the line of the rig with the value of the log; empty for what is of several letters."""
    single = ("R", "k_e", "k_i", *(() if rig.axis.wraps else ("J",)))
    return f'{ratio.letter} = "{ratio.found:.3g} {ratio.unit}"' if ratio.letter in single else ""
