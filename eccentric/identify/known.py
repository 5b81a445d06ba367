"""What can be known of a rig: the paper's letters, their keys in a rig file, units and physical bounds."""

from __future__ import annotations

import difflib
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from eccentric.errors import InputError
from eccentric.identify.units import parse_value

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping


@dataclass(frozen=True)
class Known:
    """A quantity of the rig: letter, key with the unit as its suffix, SI unit, range that physics allows."""

    name: str
    key: str
    unit: str
    lower: float = 0.0
    upper: float = math.inf
    open_below: bool = False

    @property
    def required(self) -> str:
        """The allowed range in words."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        if math.isinf(self.lower):
            return f"finite, in{unit}"
        above = f"{'above' if self.open_below else 'at least'} {self.lower:g}"
        return above + unit if math.isinf(self.upper) else f"{above} and at most {self.upper:.6g}{unit}"

    def allows(self, value: float) -> bool:
        """Tell whether a value is finite and physically possible."""
        low = value > self.lower if self.open_below else value >= self.lower
        return math.isfinite(value) and low and value <= self.upper


KNOWNS = (
    Known("M", "M_kg", "kg"),
    Known("M_l", "M_l_kg", "kg"),
    Known("L", "L_m", "m"),
    Known("mu", "mu", "1", open_below=True),
    Known("R", "R_ohm", "ohm", open_below=True),
    Known("k_i", "k_i_Nm_per_A", "N m/A", open_below=True),
    Known("k_e", "k_e_Vs_per_rad", "V s/rad"),
    Known("J_m", "J_m_kgm2", "kg m^2"),
    Known("J_l", "J_l_kgm2", "kg m^2"),
    Known("g", "g_m_s2", "m/s^2"),
    Known("F_T", "F_T_N", "N"),
    Known("phi", "phi_rad", "rad", upper=math.pi / 2.0),
    Known("T_load", "T_load_Nm", "N m", lower=-math.inf),
)
"""`k_i_Nm_per_A = 0.02` and `k_i = "20 mNm/A"` say the same; J_l is about the axis, M L^2 included."""

_BY_KEY = {key: known for known in KNOWNS for key in (known.key, known.name)}


def find_known(key: str, value: object, where: str, others: Iterable[str] = ()) -> Known:
    """Return the quantity that a key of the rig file names.

    Raises InputError if there is none, with the closest of the keys that such a `value` can have: letters
    for texts with units, keys with a suffix for numbers.
    """
    if key not in _BY_KEY:
        first = value[0] if isinstance(value, list) and value else value
        same = [known.name if isinstance(first, str) else known.key for known in KNOWNS]
        refuse_unknown([key], (*same, *others), where)
    return _BY_KEY[key]


def read_value(value: object, known: Known, key: str, where: str) -> float:
    """Return a quantity in SI, from a number under a key with a unit suffix or from a text with a unit.

    Raises InputError for a bare number without unit, a wrong dimension, and a physically impossible value.
    """
    if isinstance(value, str):
        number = parse_value(value, known.unit, where)
    elif key == known.key:
        number = read_number(value, where)
    else:
        raise InputError(
            f'{where}: a text with a unit is required, as in {key} = "0.1 {known.unit}", received {value!r}'
        )
    if not known.allows(number):
        raise InputError(f"{where}: a value {known.required} is required, received {value!r}")
    return number


def read_number(value: object, where: str, lower: float = -math.inf, open_below: bool = False) -> float:
    """Return a finite number, at least (or above) `lower`; InputError for anything else, also true."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{where}: a number is required, received {value!r}")
    number = float(value) if abs(value) < 1e300 else math.inf
    if not math.isfinite(number) or number < lower or (open_below and number == lower):
        bound = "" if math.isinf(lower) else f" {'above' if open_below else 'of at least'} {lower:g}"
        raise InputError(f"{where}: a finite number{bound} is required, received {value!r}")
    return number


def read_pair(value: object, where: str) -> tuple[Any, Any]:
    """Return the two ends of a range, as they came; InputError for anything but a list of two."""
    if not isinstance(value, list) or len(value) != 2:
        raise InputError(f"{where}: a range of two values, [lower, upper], is required, received {value!r}")
    return value[0], value[1]


def read_table(value: object, where: str) -> Mapping[str, Any]:
    """Return a table of the rig file; InputError for anything else."""
    if not isinstance(value, dict):
        raise InputError(f"{where}: a table is required, received {value!r}")
    return value


def refuse_unknown(keys: Iterable[str], allowed: Iterable[str], where: str) -> None:
    """Raise InputError for the first key that is not allowed, with the closest one that is."""
    allowed = list(allowed)
    for key in keys:
        if key not in allowed:
            close = difflib.get_close_matches(key, allowed, 1, 0.5)
            hint = f"did you mean {close[0]!r}?" if close else f"known are {', '.join(allowed)}"
            raise InputError(f"{where}: unknown key {key!r}; {hint}")
