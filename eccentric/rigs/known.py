"""What can be known about a rig: the paper's letters, their keys in a rig file, units and physical bounds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eccentric.core import InputError, read_number, read_table, refuse_unknown
from eccentric.logs import parse_value
from eccentric.model import LINEAR, TURNING, AxisKind, vocabulary
from eccentric.rigs.entries import read_pair
from eccentric.rigs.limits import LARGEST, SMALLEST, USUAL_PITCH_M


@dataclass(frozen=True)
class Known:
    """A quantity of the rig.

    Attributes:
        name: the letter that the toolkit computes with.
        key: in a rig file, with the unit as its suffix; `letter`, without, takes a text with a unit.
        unit: SI unit.
        lower, upper, open_below: the physical range.
        letter: in a rig file; "" for `name`.
    """

    name: str
    key: str
    unit: str
    lower: float = 0.0
    upper: float = math.inf
    open_below: bool = False
    letter: str = ""

    @property
    def required(self) -> str:
        """The allowed range in words."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        if math.isinf(self.lower):
            return f"finite, in{unit}"
        above = f"{'above' if self.open_below else 'at least'} {self.lower:g}"
        return above + unit if math.isinf(self.upper) else f"{above} and at most {self.upper:.6g}{unit}"

    def allows(self, value: float) -> bool:
        """Return whether a value is finite and physically possible."""
        low = value > self.lower if self.open_below else value >= self.lower
        return math.isfinite(value) and low and value <= self.upper

    def has_size(self, value: float) -> bool:
        """Return whether a drive can have such a size; a tilt and a load may be zero but for rounding."""
        rounded = math.isfinite(self.upper) or math.isinf(self.lower)
        return abs(value) <= LARGEST and (abs(value) >= SMALLEST or value == 0.0 or rounded)


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
"""`k_i_Nm_per_A = 0.02` and `k_i = "20 mNm/A"` are equivalent; J_l is about the axis, M L^2 included."""

_OF_A_CARRIAGE = (
    Known("J_m", "mass_kg", "kg", letter="mass"),
    Known("R", "R_ohm", "ohm", open_below=True),
    Known("k_i", "k_f_N_per_A", "N/A", open_below=True, letter="k_f"),
    Known("k_e", "k_e_Vs_per_m", "V s/m"),
    Known("T_load", "F_load_N", "N", lower=-math.inf, letter="F_load"),
    Known("pitch", "pitch_m", "m", open_below=True),
)
_BY_AXIS = {TURNING: KNOWNS, LINEAR: _OF_A_CARRIAGE}


def knowns_of(axis: AxisKind) -> tuple[Known, ...]:
    """The quantities that the rig of an axis can know."""
    return _BY_AXIS[axis]


def find_known(
    key: str, value: object, where: str, others: Iterable[str] = (), axis: AxisKind = TURNING
) -> Known:
    """Return the quantity that a key of the rig file names.

    Raises InputError if there is none, with the closest of the keys for such a `value`: letters for text with
    a unit, keys with a suffix for numbers.
    """
    knowns = knowns_of(axis)
    by_key = {key: known for known in knowns for key in (known.key, known.letter or known.name)}
    if key not in by_key:
        first = value[0] if isinstance(value, list) and value else value
        same = [known.letter or known.name if isinstance(first, str) else known.key for known in knowns]
        refuse_unknown([key], (*same, *others), where)
    return by_key[key]


def read_value(value: object, known: Known, key: str, where: str) -> float:
    """Return a quantity in SI, from a number under a key with a unit suffix or from a text with a unit.

    Raises InputError for a bare number without unit, a wrong dimension, and a physically impossible value.
    """
    if isinstance(value, str):
        number = parse_value(value, known.unit, where)
    elif key == known.key:
        number = read_number(value, where)
    else:
        raise InputError(where, "a text with a unit", f"{value!r}", why=f', as in {key} = "0.1 {known.unit}"')
    if not known.allows(number):
        raise InputError(where, f"a value {known.required}", f"{value!r}")
    if not known.has_size(number):
        sizes = f"{SMALLEST:g} to {LARGEST:g}{'' if known.unit == '1' else ' ' + known.unit}"
        raise InputError(where, f"a value of size {sizes}", f"{value!r}")
    return number


def read_knowns(
    content: Mapping[str, Any], where: str, axis: AxisKind = TURNING, named: str = "known"
) -> tuple[dict[str, float], dict[str, tuple[float, float]], str | None]:
    """Return known values and unknown ranges in SI, by letter, and the case: C1, C2, None for a tilted plane.

    A carriage has no unbalanced mass, so that no gravity varies: it is a case C1 without gear. Errors
    call the table of known values by the name that a person sees.

    Raises InputError for an unknown key or unit, an impossible value, a quantity that is given twice, and a
    tilt that contradicts the case.
    """
    place = f"{where}: [{named}]"
    table = dict(read_table(content.get("known", {}), place))
    turns = axis is TURNING
    given = table.pop("case", None) if turns else "C1"
    case = given.upper() if isinstance(given, str) else given
    if case not in (None, "C1", "C2"):
        raise InputError(f"{place} case", "C1 or C2", f"{given!r}")
    known: dict[str, float] = {}
    for key, value in table.items():
        quantity = find_known(key, value, place, ["case"] if turns else [], axis)
        _refuse_twice(quantity, known, where)
        known[quantity.name] = read_value(value, quantity, key, f"{place} {key}")
    unknown: dict[str, tuple[float, float]] = {}
    for key, value in read_table(content.get("unknown", {}), f"{where}: [unknown]").items():
        quantity = find_known(key, value, f"{where}: [unknown]", (), axis)
        _refuse_twice(quantity, known | unknown, where)
        at = f"{where}: [unknown] {key}"
        lower, upper = (read_value(end, quantity, key, at) for end in read_pair(value, at))
        if lower >= upper:
            raise InputError(at, "a range with lower below upper", f"{value!r}")
        unknown[quantity.name] = lower, upper
    if not turns:
        if "pitch" in unknown:
            raise InputError(f"{where}: [unknown] pitch", "a value in [known]", "a range")
        # The gear is the screw; a load is there only if the rig says so.
        screw = {"mu": 2.0 * math.pi / known.get("pitch", USUAL_PITCH_M)}
        return {**screw, **({} if "T_load" in unknown else {"T_load": 0.0}), **known}, unknown, case
    case = _case(case, known, unknown, where)
    if "g" not in unknown:
        known.setdefault("g", float(sp.Rational(vocabulary.g.default)))  # Table 1's
    return known, unknown, case


def mass_alone(known: Mapping[str, float]) -> float:
    """Return the J_l of a link without inertia besides its unbalanced mass [kg m^2]; KeyError without M or L.

    J_l is about the axis and includes this, as `derivations/rotating_link.py` defines it.
    """
    return known["M"] * known["L"] ** 2


def _refuse_twice(known: Known, given: Mapping[str, Any], where: str) -> None:
    if known.name in given:
        raise InputError(
            where, known.letter or known.name, "twice", why="only once", keys=(known.letter or known.name,)
        )


def _case(case: str | None, known: dict[str, float], unknown: Mapping[str, Any], where: str) -> str | None:
    """Return the case, which a given tilt must agree with; write the tilt of the case into `known`."""
    tilt = {"C1": math.pi / 2.0, "C2": 0.0}
    if case is None:
        if "phi" not in known and "phi" not in unknown:
            raise InputError(where, "[known] case (C1 or C2) or the tilt phi", "neither")
        return next((name for name, phi in tilt.items() if math.isclose(known.get("phi", -1.0), phi)), None)
    if "phi" in unknown or not math.isclose(known.get("phi", tilt[case]), tilt[case], abs_tol=1e-6):
        raise InputError(
            where, problem=f"[known] case {case} means phi = {math.degrees(tilt[case]):g} deg; remove one"
        )
    known["phi"] = tilt[case]
    return case


# A known mass that some runs carry besides the rig's own: what it does to a drive calibrates it.
#
# Reference: M. Gautier, S. Briot, "Global identification of joint drive gains and dynamic parameters of
# robots", ASME J. Dynamic Systems, Measurement, and Control 136(5), 2014.


_MASS = next(known for known in KNOWNS if known.name == "M")


@dataclass(frozen=True)
class AddedMass:
    """A point mass [kg] at the place of the one on the link."""

    mass: float

    def on(self, values: Mapping[str, float]) -> dict[str, float]:
        """M and J_l of the link with it, from those without; KeyError without M or L."""
        inertia = values.get("J_l", 0.0) + self.mass * values["L"] ** 2
        return {"M": values["M"] + self.mass, "J_l": inertia}


def read_added(content: Mapping[str, Any], where: str, known: Mapping[str, float]) -> dict[str, AddedMass]:
    """The masses by the run, or pattern of runs, that carries them.

    Raises InputError for anything but a mass, and for one without M and L in [known].
    """
    table = read_table(content.get("added", {}), f"{where}: [added]")
    if table and (missing := sorted({"M", "L"} - set(known))):
        raise InputError(where, problem=f"expected [known] {' and '.join(missing)} with [added], got none")
    return {run: AddedMass(read_mass(value, f"{where}: [added] {run}")) for run, value in table.items()}


def read_mass(value: object, where: str) -> float:
    """A mass [kg] from a text with a unit. InputError for anything else, and for none."""
    mass = read_value(value, _MASS, "mass", where)
    if mass == 0.0:
        raise InputError(where, "a mass above 0 kg", f"{value!r}")
    return mass
