"""What kind of axis a drive moves: its letters, units and words, where they are not those of a turning one.

The toolkit computes with one coordinate theta_m, its derivatives and the force along it, in SI. For a turning
drive they are an angle [rad] and a torque [N m]; for a carriage a position [m] and a force [N]. The equations
are the same; what a person, a file or a program reads is not. A record says what each is called, and names
and texts are put into its words where they leave the toolkit.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Protocol, TypeVar

import sympy as sp

from eccentric.model.equation import Equation
from eccentric.model.quantity import Quantity

T = TypeVar("T")


class _WithUnit(Protocol):
    """A dataclass with a unit."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def unit(self) -> str: ...


E = TypeVar("E", bound=_WithUnit)


@dataclass(frozen=True, eq=False)
class AxisKind:
    """One kind of axis.

    Attributes:
        name: in a rig file.
        model, screw: the bundled derivations for it, without and with a pitch of its screw; "" where the case
            of the rig decides.
        letters: letter of a turning drive -> the name here.
        formulas: name here -> its form in a formula, where that is shorter.
        words: words of a turning drive -> those here; what is left out of a name is "". The longest come
            first, so that their parts are not taken alone.
        absent: variables, as in the `depends_on` of an effect, that it does not have.
        foreign: families of effects that need an unbalanced mass or a gear with a gap of its own.
        wraps: whether its coordinate comes back after a turn, as an angle does.
    """

    name: str
    model: str = ""
    screw: str = ""
    letters: Mapping[str, str] = field(default_factory=dict)
    formulas: Mapping[str, str] = field(default_factory=dict)
    words: Mapping[str, str] = field(default_factory=dict)
    absent: frozenset[str] = frozenset()
    foreign: frozenset[str] = frozenset()
    wraps: bool = True

    def __reduce__(self) -> str | tuple[Any, ...]:
        """A kind is itself in every process."""
        return _kind_of, (self.name,)

    def said(self, text: str, keep: Collection[str] = ()) -> str:
        """A text of the toolkit in the words of this kind.

        Args:
            text: names, units, sentences.
            keep: parts that are a person's own, such as names of files: they stay as they are. A column
                called "torque" has a word of ours for a name, which stays in quotes only.
        """
        if self._pattern is None:
            return text
        ours = _any_of(name for name in keep if name in self._table)
        own = _any_of(name for name in keep if name not in self._table)
        spans = _QUOTED.split(text) if ours else [text]
        return "".join(
            span if k % 2 and ours and ours.search(span) else self._beside(span, own)
            for k, span in enumerate(spans)
        )

    def _beside(self, text: str, own: re.Pattern[str] | None) -> str:
        parts = own.split(text) if own else [text]
        return "".join(part if k % 2 else self._put(part) for k, part in enumerate(parts))

    def told(self, value: T, keep: Collection[str] = ()) -> T:
        """A document, keys included, in the words of this kind; numbers are unchanged."""
        if self._pattern is None:
            return value
        return self._told(value, keep)

    def _told(self, value: Any, keep: Collection[str]) -> Any:
        if isinstance(value, str):
            return self.said(value, keep)
        if isinstance(value, Mapping):
            return {
                self.said(k, keep): x if k in _NAMES and x in keep else self._told(x, keep)
                for k, x in value.items()
            }
        if isinstance(value, list | tuple):
            return type(value)(self._told(x, keep) for x in value)
        return value

    def record(self, value: T, keep: Collection[str] = ()) -> T:
        """A record, and those in it, with its texts in the words of this kind; keys of mappings stay."""
        return value if self._pattern is None else self._record(value, keep)

    def _record(self, value: Any, keep: Collection[str]) -> Any:
        if isinstance(value, str):
            return self.said(value, keep)
        if isinstance(value, Mapping):
            return {k: self._record(x, keep) for k, x in value.items()}
        if isinstance(value, list | tuple):
            return type(value)(self._record(x, keep) for x in value)
        if is_dataclass(value) and not isinstance(value, type | AxisKind):
            return replace(
                value, **{f.name: self._record(getattr(value, f.name), keep) for f in fields(value)}
            )
        return value

    def estimates(self, found: Mapping[str, E]) -> dict[str, E]:
        """Estimates by name, or whatever has a unit, under the names and in the units of this kind."""
        if self._pattern is None:
            return dict(found)
        return {self.said(name): replace(e, unit=self.said(e.unit)) for name, e in found.items()}

    def general(self, name: str) -> str:
        """The letter of a turning drive for a name of this kind."""
        # Of several letters with one name, the first.
        return next((letter for letter, here in self.letters.items() if here == name), name)

    def _put(self, text: str) -> str:
        table, pattern = self._table, self._pattern
        return text if pattern is None else pattern.sub(lambda match: table[match[0]], text)

    @cached_property
    def _table(self) -> dict[str, str]:
        # Not of a Greek letter: a capital omega is the unit of a resistance.
        capital = {
            k[0].upper() + k[1:]: x[:1].upper() + x[1:]
            for k, x in self.words.items()
            if k[0].isascii() and k[0].isalpha()
        }
        return {**capital, **self.words, **self.letters}

    @cached_property
    def _pattern(self) -> re.Pattern[str] | None:
        if not self._table:
            return None
        known = sorted(self._table, key=len, reverse=True)
        # A word or letter of its own: not a part of a longer one. A suffix of a name begins with "_".
        alone = (
            ("" if name[0] in "_, " else r"(?<![A-Za-z0-9_])") + re.escape(name) + r"(?![A-Za-z0-9_])"
            for name in known
        )
        return re.compile("|".join(alone))


TURNING = AxisKind("turning")
"""A drive that turns: the words of the paper."""

LINEAR = AxisKind(
    "linear",
    model="linear_axis",
    screw="screw_axis",
    letters={
        "theta_m": "position",
        "theta_l": "theta_s",
        "omega_m": "velocity",
        "omega_l": "velocity",
        "alpha_m": "acceleration",
        "J_m": "mass",
        "J": "mass",
        "k_i": "k_f",
        "mu": "kappa",
        "B_m": "B",
        "C_m": "C",
        "T_load": "F_load",
        "tau_m": "F_drive",
        "friction_torque": "friction_force",
        "mechanical_friction_torque": "mechanical_friction_force",
        "friction_torque_gradient": "friction_force_gradient",
        "friction_torque_with_gradient": "friction_force_with_gradient",
        "friction_torque_jacobian": "friction_force_jacobian",
        "coulomb_torque": "coulomb_force",
        "gravity_torque": "load_force",
        "torque_unit": "force_unit",
        "speed_m_rad_s": "speed_m_s",
        "position_rad": "position_m",
        "angle_rad": "position_m",
        "theta_m_rad": "position_m",
        "omega_m_rad_s": "velocity_m_s",
        "alpha_m_rad_s2": "acceleration_m_s2",
        "turns_per_rad": "turns_per_m",
    },
    formulas={"position": "x", "velocity": "ẋ", "acceleration": "ẍ", "mass": "m"},
    words={
        # Units.
        "N m": "N",
        "(N m)": "N",
        "Nm": "N",
        "kg m^2": "kg",
        "newton metres": "newtons",
        "newton metre": "newton",
        "rad": "m",
        "rad^2": "m^2",
        "rad^3": "m^3",
        "N m/rad": "N/m",
        "_Nm": "_N",
        "_rad": "_m",
        "_rad_s": "_m_s",
        "_rad_s2": "_m_s2",
        # The drive.
        "torque constant": "force constant",
        "torque": "force",
        "torques": "forces",
        "torque's": "force's",
        "inertia": "mass",
        "inertias": "masses",
        "inertia and gravity near those of the rig are required": "a mass near that of the rig is required",
        "masses, lengths, gear and torque constant": "mass, force constant or gain",
        "moment of inertia": "mass",
        # Motion.
        ', mu, and the zero angle (theta_zero_rad = "estimate" estimates it)': "",
        "motor angle": "position",
        "motor angles": "positions",
        ", link side": "",
        "motor velocity": "velocity",
        "motor acceleration": "acceleration",
        "motor speed": "speed",
        "link angle": "screw angle",
        "link velocity": "screw velocity",
        "screw angle": "screw angle",
        "angle of the screw": "angle of the screw",
        "motor_angle": "position",
        "angle": "position",
        "angles": "positions",
        "rotation": "motion",
        # What is travelled is a distance, not a place.
        "bending angle": "bending distance",
        "travelled angle": "distance travelled",
        "angle travelled": "distance travelled",
        "motor angle travelled": "distance travelled",
        "travelled motor angle": "distance travelled",
        "motor angle over which": "distance over which",
        "of the motor angle": "of the position",
        "of the motor velocity": "of the velocity",
        "of the motor's": "of the motor's",
        ", motor side": "",
        "motor side, ": "",
        "on the motor side": "",
        " (motor side)": "",
        # The machine.
        "turn of the link": "turn of the screw",
        "turns of the link": "turns of the screw",
        "angle of the link": "angle of the screw",
        "link": "carriage",
        "of the motor": "of the axis",
        "motor turn": "turn of the screw",
        "turn of the motor": "turn of the screw",
        "turns of the motor": "turns of the screw",
        "half the link angle": "half the screw angle",
        # What is to be done with a carriage, which can neither be turned nor held at a slope.
        "turn the link": "move the carriage",
        "five whole turns": "five whole turns of the screw",
        "over whole turns": "over whole turns of the screw",
        "hold the link horizontal": "hold the carriage against a stop",
        "turn the motor slowly with the link removed": "turn the screw slowly with the carriage uncoupled",
        "turn the motor": "turn the screw",
        "leave J_m and J_l out": "leave the mass out",
        "cable that twists with the link": "cable that bends with the carriage",
        "cable or hose that twists with the link": "cable or hose that bends with the carriage",
        "torque on the motor per link angle": "force per screw angle",
        "f = f_m + mu f_l": "f",
        "the paper's model": "the model of the axis",
        "paper's model": "model of the axis",
        "the paper's friction": "the friction of the axis",
        "the paper's": "the axis model's",
        "Parameters with the paper's letters, in": "Parameters in",
        "Parameters, with the paper's letters, in": "Parameters, in",
        "Inputs are on the motor side, in": "Inputs are in",
        # Letters as a formula has them.
        "ω": "ẋ",
        "α": "ẍ",
        "gravity torque G": "constant force G of the load",
        ", eq (4)": "",
        ", eq (5)": "",
        ", eq (6)": "",
        ", eqs (11)-(14)": "",
    },
    absent=frozenset({"motor_angle", "gravity_load", "transmitted_torque"}),
    foreign=frozenset({"gravity_tilt", "angle_offset", "mass_mismatch", "bearing_load", "backlash"}),
    wraps=False,
)
"""A carriage: position [m], velocity [m/s], mass [kg], force [N]. What turns is its screw, as a link does."""

AXES = {kind.name: kind for kind in (TURNING, LINEAR)}
"""Name in a rig file -> kind."""


def _any_of(names: Iterable[str]) -> re.Pattern[str] | None:
    """A pattern of names as words of their own, the longest first; None without any."""
    found = "|".join(re.escape(name) for name in sorted(filter(None, names), key=len, reverse=True))
    return re.compile(rf"(?<!\w)({found})(?!\w)") if found else None


_QUOTED = re.compile(
    r"""((?<!\w)'[^'\n]*'(?!\w)|(?<!\w)"[^"\n]*"(?!\w)|`[^`\n]*`|(?<!\w)&#34;.*?&#34;(?!\w))"""
)
"""Quotes as text and as a page has them; an apostrophe follows a letter."""
_NAMES = frozenset({"rig"})
"""Keys of documents whose value a person has named."""


def _kind_of(name: str) -> AxisKind:
    return AXES[name]


# Symbols, quantities and equations under the names of an axis, for whoever reads them.


S = TypeVar("S", bound=sp.Basic)


def spoken_symbol(axis: AxisKind, symbol: sp.Symbol) -> sp.Symbol:
    """The symbol under its name for an axis, with the same assumptions."""
    name = axis.letters.get(symbol.name, symbol.name)
    return symbol if name == symbol.name else sp.Symbol(name, **symbol.assumptions0)


def spoken_quantity(axis: AxisKind, q: Quantity) -> Quantity:
    """A quantity under its name for an axis, with its unit and meaning there."""
    symbol = spoken_symbol(axis, q.symbol)
    letter = axis.formulas.get(symbol.name, "" if symbol != q.symbol else q.letter)
    default = q.default if q.default is None else in_letters_of(axis)(q.default)
    said = {"unit": axis.said(q.unit), "meaning": axis.said(q.meaning)}
    return replace(q, symbol=symbol, letter=letter, default=default, **said)


def spoken_equation(axis: AxisKind, equation: Equation) -> Equation:
    """An equation of a derivation in the words of an axis."""
    put, unit = in_letters_of(axis), equation.unit
    return replace(
        equation,
        left=put(equation.left),
        right=put(equation.right),
        unit=axis.said(unit) if isinstance(unit, str) else tuple(map(axis.said, unit)),
        origin=axis.said(equation.origin),
    )


def in_letters_of(axis: AxisKind) -> Callable[[S], S]:
    """A function that puts the letters of an axis into an expression."""

    def put(expression: S) -> S:
        named = {s: spoken_symbol(axis, s) for s in expression.free_symbols}
        return expression.xreplace({s: now for s, now in named.items() if s != now})

    return put
