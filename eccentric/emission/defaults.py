"""Fitted values as the defaults of an emitted trio, with their uncertainty and range as comments."""

from __future__ import annotations

import builtins
import json
import keyword
import math
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from eccentric.core import InputError, readable
from eccentric.model import AXES, C_KEYWORDS, TURNING, Model, in_general_letters, with_values


@dataclass(frozen=True)
class FittedValues:
    """What a fit hands to emission."""

    source: str  # name of the file, for error messages
    model: str | None  # name of the model that was fitted, None where the file names none
    values: dict[str, float]  # parameter by the paper's letter, in SI units
    notes: dict[str, str]  # parameter -> remark for its comment, such as its interval
    identified_on: str  # range of speeds and temperatures, for the head of the files
    fits_the_rig: bool  # false if the fit says that its log does not fit the rig
    back_emf_in_friction: bool  # whether the values of viscous friction contain the back-EMF
    current_known: bool  # whether the values give a current in amperes
    voltage_known: bool  # whether the values give a voltage
    torque_unit: str  # of the values: "N m", or "V" or "A" without a scale for a torque
    chain: Mapping[str, Any]  # of an arm, what tells it from another; empty where the file does not say
    # of an arm, the inertial parameters that the fit identified, by name; empty if it did not
    bodies: Mapping[str, float]


def read_parameters(source: Path | Mapping[str, Any]) -> FittedValues:
    """Read the parameters of a fit from its fit.json, or from the content of one.

    Raises:
        InputError: the file is missing, is not JSON, or has no `parameters` of finite numbers.
    """
    if isinstance(source, Mapping):
        return _fitted(source, "parameters", "parameters")
    return _fitted(document_of(source), str(source), source.name)


def document_of(source: Path | Mapping[str, Any]) -> Mapping[str, Any]:
    """The content of a fit.json, or what is given as such; empty if it is no object.

    Raises:
        InputError: the file is missing, or is not JSON.
    """
    if isinstance(source, Mapping):
        return source
    try:
        content = json.loads(readable(source).read_text(encoding="utf-8"))
    except InputError:
        raise
    except (ValueError, RecursionError) as error:  # ValueError: for example a number of thousands of digits
        what = "expected the fit.json of `eccentric fit`, or JSON with `parameters` like it"
        raise InputError(f"{source}: {what}, got a file that is not JSON ({error})") from None
    return content if isinstance(content, Mapping) else {}


_DIAGNOSED = {
    "eccentric-diagnosis/": "emit the model.py next to it, which has its values",
    "eccentric-arm-diagnosis/": "emit the model.py of a joint, joint_NUMBER/model.py next to it",
}
"""Beginning of a format -> what to do instead."""


def _fitted(content: Mapping[str, Any], where: str, name: str) -> FittedValues:
    instead = next((x for kind, x in _DIAGNOSED.items() if str(content.get("format")).startswith(kind)), None)
    if instead is not None:
        required = "expected the fit.json of `eccentric fit`"
        raise InputError(f"{where}: {required}, got a diagnosis: {instead}")
    if unscaled := content.get("joints_without_scale"):
        raise InputError(
            where,
            "friction in N m",
            f"that of {', '.join(map(str, unscaled))} without a scale: give k_i under [drives] in the rig"
            " file",
            why="of every joint",
        )
    axis = AXES.get(str(content.get("kind", TURNING.name)), TURNING)
    values = content.get("parameters")
    if not isinstance(values, Mapping) or not values:
        raise InputError(
            where,
            "an object `parameters` of numbers by their letters",
            "none" if values is None else repr(values)[:40],
            why=', as in {"parameters": {"M": 0.42}}',
        )
    placeholders = content.get("placeholders", {})
    if not isinstance(placeholders, Mapping):
        raise InputError(f"{where}: expected `placeholders` as an object of numbers by their letters")
    for key, given in (("placeholders", placeholders), ("parameters", values)):
        for letter, value in given.items():
            if value is not None and not _is_number(value):
                raise InputError(f"{where}: {key}.{letter}", "a finite number", f"{value!r}")
    values = {x: value for x, value in {**placeholders, **values}.items() if value is not None}
    values = in_general_letters(values, axis, where)
    notes, identified_on = content.get("parameter_notes", {}), content.get("identified_range", "")
    if not isinstance(notes, Mapping) or not isinstance(identified_on, str):
        raise InputError(f"{where}: expected `parameter_notes` by letter and `identified_range` as text")
    chain = content.get("chain") or {}
    joints = chain.get("joints", []) if isinstance(chain, Mapping) else None
    if not isinstance(joints, list) or not all(isinstance(joint, Mapping) for joint in joints):
        raise InputError(f"{where}: chain: expected an object with a list `joints` of objects")
    bodies = content.get("bodies") or {}
    found = bodies.get("values") or {} if isinstance(bodies, Mapping) else None
    if not isinstance(found, Mapping) or not all(_is_number(x) for x in found.values()):
        raise InputError(f"{where}: bodies: expected an object `values` of finite numbers")
    # Bodies that cannot exist are no better than a log that does not fit the rig.
    fits = content.get("fits_the_rig") is not False and bodies.get("possible") is not False
    contained = content.get("back_emf_in_friction") is True
    unit = content.get(axis.named("torque_unit"), "N m")
    unit = "N m" if unit == axis.unit("N m") else unit
    if unit not in ("N m", "V", "A"):
        raise InputError(f"{where}: torque_unit", "N m, V or A", f"{unit!r}")
    of = content.get("model")
    return FittedValues(
        name,
        of,
        values,
        {axis.general(x): text for x, text in notes.items()},
        identified_on,
        fits,
        contained,
        content.get("current_known") is not False,
        content.get("voltage_known") is not False,
        unit,
        dict(chain),
        dict(found),
    )


def _is_number(value: object) -> bool:
    return not isinstance(value, bool) and isinstance(value, int | float) and abs(value) < math.inf


def with_fitted(model: Model, fitted: FittedValues, name: str) -> Model:
    """Return the model under a new name, with fitted values as its defaults.

    Raises:
        InputError: the values are those of another model, which would leave the rest at the paper's values,
            or some of the motor's constants without the others; a value is of no parameter of the model, or
            of a sign that it cannot have.
    """
    if fitted.model not in (None, model.name):
        raise InputError(fitted.source, f"a fit of {model.name}", f"one of {fitted.model}")
    motor = [q.name for q in model.parameters if q.name in {"R", "k_i", "k_e"}]
    given = [name for name in motor if {name, model.axis.named(name)} & fitted.values.keys()]
    if given and given != motor:  # the others would be those of the paper's motor
        raise InputError(
            f"{fitted.source}: parameters",
            f"all of {', '.join(motor)}, or none",
            f"{', '.join(given)} alone",
            hint="give the whole document of a fit: its `placeholders` have the rest",
        )
    title = f"{model.title}; {fitted.identified_on}" if fitted.identified_on else model.title
    return with_values(
        model,
        fitted.values,
        name,
        fitted.notes,
        title,
        fitted.source,
        fitted.back_emf_in_friction,
        fitted.current_known,
        fitted.voltage_known,
        fitted.torque_unit,
        fits_the_rig=fitted.fits_the_rig,
    )


# The standard headers of C90 to C23 (ISO/IEC 9899, 7.1.2): a file with such a name would hide them.
_HEADERS = """
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg
    stdatomic stdbit stdbool stdckdint stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar
    wchar wctype
""".split()  # noqa: SIM905 - words are easier to read than a list
# Imports of the emitted module, and the toolkit itself.
_PACKAGES = ("numpy", "eccentric", "eccentric_runtime")
# Windows allows no files with these names, whatever their suffix.
_DEVICES = ("aux", "con", "nul", "prn", *(f"{port}{k}" for port in ("com", "lpt") for k in range(10)))
_TAKEN = {
    "a keyword of C": C_KEYWORDS,
    "a header of C": set(_HEADERS),
    "a keyword of Python": set(keyword.kwlist),
    "a Python built-in": set(dir(builtins)),
    "a Python module": {*sys.stdlib_module_names, *_PACKAGES},
    "a Windows device": set(_DEVICES),
}


def checked_name(name: str, where: str) -> str:
    """The name, if it is valid for files, a Python module and C functions.

    Raises:
        InputError: it is not, or would hide another name; `where` is the source of the name.
    """
    if not isinstance(name, str) or not re.fullmatch(r"[a-z][a-z0-9_]{0,30}", name):
        raise InputError(where, "a lower-case C identifier of at most 31 characters", f"{name!r}")
    taken = next((what for what, names in _TAKEN.items() if name in names), None)
    if taken is not None:
        free = "a lower-case C identifier that C and Python leave free"
        raise InputError(where, free, f"{name!r}, {taken}")
    return name
