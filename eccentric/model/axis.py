"""The kind of axis that a drive moves: symbols, units and terms where they differ from a rotary drive's.

The toolkit computes with one coordinate theta_m, its derivatives and the force along it, in SI. For a rotary
drive they are an angle [rad] and a torque [N m]; for a carriage a position [m] and a force [N]. The equations
are the same, but the names in files, messages and code are not. A record lists the names, units and terms
from which files and sentences are filled.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, Protocol, TypeVar

import sympy as sp

from eccentric.model.balance import Equation
from eccentric.model.quantity import Quantity


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
        model, screw: bundled derivations without and with a screw pitch; "" if the case of the rig decides.
        letters: symbol or name of a rotary drive -> the name here.
        channels: name of a signal -> the one here.
        endings: unit suffix of a name -> the one here.
        units: unit -> the one here.
        formulas: name here -> its symbol in a formula, if shorter.
        words: terms of a rotary drive -> those here; "" to omit one.
        absent: variables, as in the `depends_on` of an effect, that it does not have.
        foreign: families of effects that need an unbalanced mass or gear backlash.
        wraps: whether its coordinate is periodic, as an angle.
    """

    name: str
    model: str = ""
    screw: str = ""
    letters: Mapping[str, str] = field(default_factory=dict)
    channels: Mapping[str, str] = field(default_factory=dict)
    endings: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    formulas: Mapping[str, str] = field(default_factory=dict)
    words: Mapping[str, str] = field(default_factory=dict)
    absent: frozenset[str] = frozenset()
    foreign: frozenset[str] = frozenset()
    wraps: bool = True

    def __reduce__(self) -> str | tuple[Any, ...]:
        """Unpickle to the same object in every process."""
        return _kind_of, (self.name,)

    def named(self, name: str) -> str:
        """Translate a name of a rotary drive, or the names in a formula."""
        return _NAME.sub(lambda match: self._one_named(match[0]), name) if self.letters else name

    def _one_named(self, name: str) -> str:
        if name in self.letters or name in self.channels:
            return self.letters.get(name) or self.channels[name]
        ending = max((end for end in self.endings if name.endswith(end)), key=len, default="")
        return name.removesuffix(ending) + self.endings[ending] if ending else name

    def unit(self, unit: str) -> str:
        """Translate a unit of a rotary drive: force for torque, distance for angle."""
        return _replaced(unit, self.units, self._of_units)

    def term(self, term: str) -> str:
        """Translate a term of a rotary drive, such as "torque", for a sentence."""
        small = term[:1].lower() + term[1:]
        if term in self.words or small not in self.words:
            return self.words.get(term, term)
        here = self.words[small]
        return here[:1].upper() + here[1:]

    def filled(self, sentence: str) -> str:
        """Fill a sentence with terms, units and names in braces: "the {torque} constant {k_i} [{N m/A}]"."""
        return sentence.format_map(_Filling(self))

    def text(self, text: str) -> str:
        """Translate a text of a model or an effect, such as a meaning.

        Not for sentences with the user's names in them: those are filled from `named`, `unit` and `term`.
        """
        return _replaced(text, self._table, self._pattern)

    def estimates(self, found: Mapping[str, E]) -> dict[str, E]:
        """Translate names and units of estimates, or of any records with a unit."""
        return {self.named(name): replace(e, unit=self.unit(e.unit)) for name, e in found.items()}

    def keyed(self, document: Any, kept: tuple[str, ...] = ("added_kg",)) -> Any:
        """Translate the keys of a document, except those below `kept`, which the user has named."""
        if isinstance(document, Mapping):
            return {self.named(key): x if key in kept else self.keyed(x, kept) for key, x in document.items()}
        if isinstance(document, list | tuple):
            return type(document)(self.keyed(x, kept) for x in document)
        return document

    def general(self, name: str) -> str:
        """The symbol of a rotary drive for a name of this kind."""
        # The first of several symbols with one name.
        return next((letter for letter, here in self.letters.items() if here == name), name)

    @cached_property
    def _table(self) -> dict[str, str]:
        # Not for Greek letters: a capital omega is the unit of resistance.
        capital = {
            k[0].upper() + k[1:]: x[:1].upper() + x[1:]
            for k, x in self.words.items()
            if k[0].isascii() and k[0].isalpha()
        }
        return {**capital, **self.words, **self.units, **self.endings, **self.channels, **self.letters}

    @cached_property
    def _pattern(self) -> re.Pattern[str] | None:
        return _any_of(self._table)

    @cached_property
    def _of_units(self) -> re.Pattern[str] | None:
        return _any_of(self.units)


class _Filling(dict[str, str]):
    """Text in the braces of a sentence -> its translation for an axis."""

    def __init__(self, axis: AxisKind) -> None:
        super().__init__()
        self._axis = axis

    def __missing__(self, key: str) -> str:
        term = self._axis.term(key)
        return term if term != key else self._axis.unit(self._axis.named(key))


_NAME = re.compile(r"[A-Za-z_]\w*")


def _any_of(table: Mapping[str, str]) -> re.Pattern[str] | None:
    """A pattern of the keys, longest first, each only as a complete word. None without any."""
    known = sorted(table, key=len, reverse=True)
    # An ending of a name begins with "_".
    alone = (
        ("" if name[0] in "_, " else r"(?<![A-Za-z0-9_])") + re.escape(name) + r"(?![A-Za-z0-9_])"
        for name in known
    )
    return re.compile("|".join(alone)) if table else None


def _replaced(text: str, table: Mapping[str, str], pattern: re.Pattern[str] | None) -> str:
    return text if pattern is None else pattern.sub(lambda match: table[match[0]], text)


TURNING = AxisKind("turning")
"""A rotary drive: the terms of the paper."""

LINEAR = AxisKind(
    "linear",
    model="linear_axis",
    screw="screw_axis",
    letters={
        "theta_m": "position",
        "theta_l": "theta_s",
        "omega_m": "velocity",
        "omega_l": "velocity",
        "omega_after": "velocity_after",
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
        "breakaway_torque": "breakaway_force",
        "gravity_torque": "load_force",
        "torque": "force",
        "torque_unit": "force_unit",
        "speed_m_rad_s": "speed_m_s",
        "position_rad": "position_m",
        "angle_rad": "position_m",
        "theta_m_rad": "position_m",
        "omega_m_rad_s": "velocity_m_s",
        "alpha_m_rad_s2": "acceleration_m_s2",
        "turns_per_rad": "turns_per_m",
    },
    channels={"torque": "force", "motor_angle": "position"},
    endings={"_Nm": "_N", "_rad": "_m", "_rad_s": "_m_s", "_rad_s2": "_m_s2"},
    units={"(N m)": "N", "N m": "N", "Nm": "N", "kg m^2": "kg", "rad": "m"},
    formulas={"position": "x", "velocity": "ẋ", "acceleration": "ẍ", "mass": "m"},
    words={
        # Units.
        "a few degrees": "a few millimetres",
        "newton metres": "newtons",
        "newton metre": "newton",
        # The drive.
        "torque constant": "force constant",
        "torque": "force",
        "torques": "forces",
        "torque's": "force's",
        "inertia": "mass",
        "inertias": "masses",
        "expected inertia and gravity near those of the rig": "expected a mass near that of the rig",
        "masses, lengths, gear and torque constant": "mass, force constant or gain",
        "moment of inertia": "mass",
        "net of inertia and gravity": "net of mass and load",
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
        "angle": "position",
        "angles": "positions",
        "rotation": "motion",
        # Travel is a distance, not a position.
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
        # Instructions: a carriage can neither be turned nor held at a slope.
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
        # Symbols in formulas.
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
"""A carriage: position [m], velocity [m/s], mass [kg], force [N]. Its screw turns, as a link does."""

AXES = {kind.name: kind for kind in (TURNING, LINEAR)}
"""Name in a rig file -> kind."""


def _kind_of(name: str) -> AxisKind:
    return AXES[name]


S = TypeVar("S", bound=sp.Basic)


def spoken_symbol(axis: AxisKind, symbol: sp.Symbol) -> sp.Symbol:
    """The symbol renamed for an axis, with the same assumptions."""
    name = axis.letters.get(symbol.name, symbol.name)
    return symbol if name == symbol.name else sp.Symbol(name, **symbol.assumptions0)


def spoken_quantity(axis: AxisKind, q: Quantity) -> Quantity:
    """A quantity with its name, unit and meaning for an axis."""
    symbol = spoken_symbol(axis, q.symbol)
    letter = axis.formulas.get(symbol.name, "" if symbol != q.symbol else q.letter)
    default = q.default if q.default is None else in_letters_of(axis)(q.default)
    unit, meaning = axis.unit(q.unit), axis.text(q.meaning)
    return replace(q, symbol=symbol, letter=letter, default=default, unit=unit, meaning=meaning)


def spoken_equation(axis: AxisKind, equation: Equation) -> Equation:
    """An equation with the symbols and terms of an axis."""
    put, unit = in_letters_of(axis), equation.unit
    return replace(
        equation,
        left=put(equation.left),
        right=put(equation.right),
        unit=axis.unit(unit) if isinstance(unit, str) else tuple(map(axis.unit, unit)),
        origin=axis.text(equation.origin),
    )


def in_letters_of(axis: AxisKind) -> Callable[[S], S]:
    """A function that renames the symbols of an expression for an axis."""

    def put(expression: S) -> S:
        renamed = {s: spoken_symbol(axis, s) for s in expression.free_symbols}
        return expression.xreplace({old: new for old, new in renamed.items() if old != new})

    return put
