"""What the user knows about the test bench: a TOML or JSON file or a mapping like it, checked and in SI.

The sidecars `rotlink-log/1` are valid rigs. For a handwritten file see `examples/rigs/*.toml`.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eccentric.core import (
    InputError,
    MissingValueError,
    few,
    given_path,
    meant,
    read_document,
    read_number,
    refuse_unknown,
    shown,
)
from eccentric.logs import parse_value
from eccentric.model import (
    ANGLE,
    AXES,
    DRIVE_PARTS,
    LINEAR,
    NO_PART,
    OUTPUT_ANGLE,
    REDUCERS,
    TURNING,
    AxisKind,
    Parts,
)
from eccentric.rigs.controller import Controller, read_controller
from eccentric.rigs.entries import plain_entries, read_intervals, read_names, read_parts
from eccentric.rigs.known import AddedMass, mass_alone, read_added, read_knowns
from eccentric.rigs.limits import LEAST_GRAVITY, LEAST_LOW_PASS_HZ
from eccentric.rigs.sources import (
    ALIGNMENT,
    Alignment,
    LogMap,
    NamedHoldout,
    Sampling,
    channels_of,
    read_columns,
    read_kinds,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


DRIVES = ("current", "voltage", "torque")
COASTING = "none"
"""The drive of a coast-down: nothing turns the motor, and only its inertia is known of what slows it down."""
REVOLUTION = "revolution"
"""What a row is the event of, where it is no sample: one turn of the shaft."""
LINE = "line"
"""Where the angle is from, if it is not logged: the line once per turn in the drive signal."""
KEYS = (
    *("format", "name", "log_type", "kind", "known", "unknown", "columns", "drive", "encoder_counts_per_rev"),
    *("sample_rate_hz", "low_pass_hz", "moving_threshold_rad_s", "holdout_intervals_s", "holdout_runs"),
    *("runs", "average_over", "added", "kinds", "controller", "events", "angle"),
    *DRIVE_PARTS,
    *ALIGNMENT,
)
"""Keys at the top level of a rig file."""
_OF_A_TURN = frozenset({"encoder_counts_per_rev", "theta_zero_rad", "added", "events", "angle"})
_OF_A_CARRIAGE = frozenset({"encoder_step_m"})


def alignment_of(axis: AxisKind) -> tuple[str, ...]:
    """What of the alignment an axis has: a carriage has no zero angle."""
    return tuple(key for key in ALIGNMENT if axis is TURNING or key not in _OF_A_TURN)


def keys_of(axis: AxisKind) -> dict[str, str]:
    """The keys of a rig file -> those of a turning drive, by which they are read."""
    if axis is TURNING:
        return {key: key for key in KEYS}
    return {axis.named(key): key for key in KEYS if key not in _OF_A_TURN} | {
        key: key for key in _OF_A_CARRIAGE
    }


@dataclass(frozen=True)
class Rig:
    """The test bench as described in the rig file; numbers in SI, by the paper's letters.

    Attributes:
        path: of the file, for messages.
        name: of the rig.
        case: "C1", "C2" or None for a tilted plane; then `phi` [rad] is in `known` or `unknown`.
        known: values of motor, gear and link by letter.
        unknown: ranges [lower, upper] by letter; letters that are in neither are estimated if possible.
        log: the columns of the log.
        sampling: how the samples become rows.
        holdout: the held-out part, if the rig names it.
        alignment: delay, zero angle and offset, 0 if the fit has to find them.
        estimate: names of those that the fit has to find.
        aligned: names of those that the rig file has.
        warnings: unusual entries.
        axis: the kind of axis, which names all of these.
        added: added masses, by run or pattern of runs.
        controller: the controller that makes the drive signal; None if the rig has none.
        per_inertia: whether a coast-down without a declared inertia uses 1 kg m^2, so that every torque is a
            deceleration.
        parts: the parts of the drive, as far as the rig names them: words of `DRIVE_PARTS` by kind.
    """

    path: str
    name: str
    case: str | None
    known: Mapping[str, float]
    unknown: Mapping[str, tuple[float, float]]
    log: LogMap
    sampling: Sampling
    holdout: NamedHoldout
    alignment: Alignment
    estimate: frozenset[str]
    warnings: tuple[str, ...]
    axis: AxisKind = TURNING
    added: Mapping[str, AddedMass] = field(default_factory=dict)
    controller: Controller | None = None
    per_inertia: bool = False
    parts: Parts = field(default_factory=dict)
    aligned: frozenset[str] = frozenset()

    def __repr__(self) -> str:
        plane = f"case {self.case}" if self.case else "a tilted plane"
        plane = plane if self.axis is TURNING else f"a {self.axis.name} axis"
        return f"<Rig {self.name}: {plane}; known {few(self.known)}; unknown {few(self.unknown) or 'none'}>"

    def value(self, name: str) -> float:
        """Return a known quantity by the paper's letter; InputError if it is unknown."""
        if name not in self.known:
            letter = f"[known] {self.axis.named(name)}"
            raise MissingValueError(self.path, letter, "none", why="here", letter=name)
        return self.known[name]

    @property
    def added_kg(self) -> dict[str, float]:
        """The added masses [kg], by run or pattern of runs."""
        return {runs: added.mass for runs, added in self.added.items()}

    @property
    def added_words(self) -> str:
        """The runs with an added mass, in words; "" if there are none."""
        carried = [f"{runs} carries {added.mass:g} kg" for runs, added in self.added.items()]
        return f"besides M, {', '.join(carried)}" if carried else ""

    @property
    def model(self) -> str:
        """The name of the model for the case or the tilt."""
        if self.axis.model:
            return self.axis.screw if "pitch" in self.known else self.axis.model
        return {"C1": "c1_perpendicular", "C2": "c2_parallel"}.get(self.case or "", "rotating_link")


def read_rig(source: str | os.PathLike[str] | Mapping[str, Any] | Rig) -> Rig:
    """Read a rig: a file `.toml` or `.json`, or a mapping with the keys of such a file.

    A Rig is returned unchanged. Errors call a mapping "rig".

    Raises InputError, one line with file, key, what was expected and what came: a missing or damaged file, an
    unknown key or unit, a value that is physically impossible, a contradiction.
    """
    if isinstance(source, Rig):
        return source
    if isinstance(source, str | os.PathLike):
        path = given_path(source, "rig")
        return _rig(read_document(path, "a rig file"), shown(path), Path(shown(path)).stem)
    return rig_of(source, "rig")


def rig_of(content: Mapping[str, Any], where: str, constants: str = "known") -> Rig:
    """The rig with the content of a file; errors call it `where`, its table of known values `constants`."""
    return _rig(plain_entries(content, where), where, "rig", constants)


def _rig(content: Mapping[str, Any], where: str, name: str, constants: str = "known") -> Rig:
    if "arm" in content:
        raise InputError(
            f"{where}: arm",
            problem="expected the rig of a single drive here; fit and diagnose take that of an arm",
        )
    if {"joint", "urdf"} & set(content):
        raise InputError(where, "a rig file", 'an arm file; a rig names it with arm = "..."')
    axis = _axis(content, where)
    keys = keys_of(axis)
    refuse_unknown(content, keys, where)
    content = {keys[key]: value for key, value in content.items()}
    known, unknown, case = read_knowns(content, where, axis, constants)
    per_inertia = content.get("drive") == COASTING and _coasting(known, unknown)
    counts = _counts(content, where)
    columns, warnings = read_columns(content.get("columns"), f"{where}: [columns]", counts, axis)
    drive, drives = content.get("drive"), {axis.named(drive): drive for drive in (*DRIVES, COASTING)}
    if drive is not None and (not isinstance(drive, str) or drive not in drives):
        raise InputError(
            f"{where}: drive",
            f"one of {', '.join(drives)}",
            f"{drive!r}{meant(drive, drives) if isinstance(drive, str) else ''}",
        )
    kinds = read_kinds(content.get("kinds", {}), f"{where}: [kinds]", axis)
    if unmapped := sorted(set(kinds) - set(columns)) if columns is not None else []:
        raise InputError(f"{where}: [kinds] {axis.named(unmapped[0])}", "a channel of [columns]", "none")
    alignment, estimate = _alignment(content, where)
    intervals = read_intervals(content.get("holdout_intervals_s", []), f"{where}: holdout_intervals_s")
    return Rig(
        path=where,
        name=str(content.get("name", name)).encode("utf-8", "replace").decode(),
        case=case,
        known=known,
        unknown=unknown,
        log=LogMap(
            columns=columns,
            drive=None if drive is None else drives[drive],
            counts_per_rev=counts,
            sample_rate_hz=_optional(content, "sample_rate_hz", where),
            runs=read_names(content.get("runs", []), f"{where}: runs"),
            kinds=kinds,
            events=_chosen(content, "events", REVOLUTION, where),
            by_line=_chosen(content, "angle", LINE, where),
        ),
        sampling=Sampling(
            low_pass_hz=read_number(
                content.get("low_pass_hz", 25.0), f"{where}: low_pass_hz", LEAST_LOW_PASS_HZ
            ),
            low_pass_given="low_pass_hz" in content,
            moving_threshold_rad_s=_optional(
                content, "moving_threshold_rad_s", where, open_below=False, called=axis.named
            ),
            average_over=_average(content.get("average_over"), f"{where}: average_over"),
        ),
        holdout=NamedHoldout(
            intervals, read_names(content.get("holdout_runs", []), f"{where}: holdout_runs")
        ),
        alignment=alignment,
        estimate=estimate,
        aligned=frozenset(ALIGNMENT) & content.keys(),
        warnings=(*warnings, *(_doubts(known) if axis is TURNING else ())),
        axis=axis,
        added=read_added(content, where, known),
        controller=read_controller(content["controller"], f"{where}: [controller]", axis)
        if "controller" in content
        else None,
        per_inertia=per_inertia,
        parts=_parts(content, where, known),
    )


def _parts(content: Mapping[str, Any], where: str, known: Mapping[str, float]) -> Parts:
    parts, mu = read_parts(content, where), known.get("mu", 1.0)
    if parts.get("gear") == (NO_PART,) and mu != 1.0:
        raise InputError(f"{where}: gear", "a gear", '"none"', why=f"with mu = {mu:g}")
    if mu == 1.0 and REDUCERS.intersection(parts.get("gear", ())):
        # Such a gear is inside what the rig calls the motor: the log is on its output.
        return {**parts, ANGLE: OUTPUT_ANGLE}
    return parts


def _chosen(content: Mapping[str, Any], key: str, only: str, where: str) -> bool:
    """Whether a key is there, of which there is only one value."""
    if (said := content.get(key, only)) != only:
        raise InputError(f"{where}: {key}", f'"{only}", or nothing', f"{said!r}")
    return key in content


def _coasting(known: dict[str, float], unknown: Mapping[str, Any]) -> bool:
    """Complete the inertia of a coast-down; whether there is none, so that decelerations are all it gives.

    Where gravity is known, the fit finds the inertia by it, and nothing is added.
    """
    inertias = {"J_m", "J_l"}
    given = inertias & (set(known) | set(unknown))
    if (
        not given
        and math.cos(known.get("phi", 0.0)) * known.get("M", 0.0) * known.get("L", 0.0) > LEAST_GRAVITY
    ):
        return False
    for name in sorted(inertias - given):
        known[name] = 1.0 if not given and name == "J_m" else 0.0
    return not given


def _doubts(known: Mapping[str, float]) -> list[str]:
    """Return warnings about values that are possible but unusual."""
    doubts = []
    if known.get("mu", 0.0) > 1.0:
        doubts.append(
            f"mu = {known['mu']:g} is above 1: the link turns faster than the motor (step-up drive);"
            f" where it turns slower, mu is 1/{known['mu']:g}"
        )
    if {"J_l", "M", "L"} <= set(known) and known["J_l"] < (mass := mass_alone(known)) * (1 - 1e-9):
        doubts.append(
            f"J_l = {known['J_l']:.6g} kg m^2 is less than M L^2 = {mass:.6g} kg m^2, which it includes:"
            " it is the inertia of the whole link about its axis"
        )
    return doubts


def _axis(content: Mapping[str, Any], where: str) -> AxisKind:
    """Return the kind of axis that the rig names, by default one that turns."""
    kind = content.get("kind", TURNING.name)
    if "kind" not in content and (own := _of_a_carriage_alone(content)):
        raise InputError(f"{where}: {own}", 'kind = "linear"', "no kind", why="with this key")
    if not isinstance(kind, str) or kind not in AXES:
        raise InputError(
            f"{where}: kind",
            f"one of {', '.join(AXES)}",
            f"{kind!r}{meant(kind, AXES) if isinstance(kind, str) else ''}",
        )
    return AXES[kind]


def _of_a_carriage_alone(content: Mapping[str, Any]) -> str:
    """A key or channel that only the rig of a carriage has, "" for none."""
    columns = content.get("columns")
    keys = sorted(content.keys() & (keys_of(LINEAR).keys() - keys_of(TURNING).keys()))
    channels = {LINEAR.named(name) for name in channels_of(LINEAR)} - channels_of(TURNING).keys()
    return next(iter([*keys, *sorted(channels & set(columns if isinstance(columns, dict) else ()))]), "")


def _counts(content: Mapping[str, Any], where: str) -> float | None:
    """Return the counts of the encoder per radian times 2 pi: of a carriage, per 2 pi metres."""
    if (step := _optional(content, "encoder_step_m", where)) is not None:
        return 2.0 * math.pi / step
    return _optional(content, "encoder_counts_per_rev", where)


def _optional(
    content: Mapping[str, Any],
    key: str,
    where: str,
    *,
    open_below: bool = True,
    called: Callable[[str], str] = str,
) -> float | None:
    """Return a number above 0 (or at least 0), None without the key; messages have it as it is `called`."""
    if key not in content:
        return None
    return read_number(content[key], f"{where}: {called(key)}", 0.0, open_below)


def _alignment(content: Mapping[str, Any], where: str) -> tuple[Alignment, frozenset[str]]:
    """Return delay, zero angle and offset, 0 for those that the fit estimates, and the names of these."""
    given = {key: content.get(key, 0.0) for key in ALIGNMENT}
    estimate = frozenset(key for key, value in given.items() if value == "estimate")
    values: dict[str, float] = {}
    for key, value in given.items():
        if isinstance(value, str) and value != "estimate":
            raise InputError(f"{where}: {key}", 'a number or "estimate"', f"{value!r}")
        lower = 0.0 if key == "input_delay_s" else -math.inf
        values[key] = 0.0 if key in estimate else read_number(value, f"{where}: {key}", lower)
    return Alignment(**values), estimate


def _average(value: object, where: str) -> float:
    """Return a time [s], 0 if none is given, infinity for "run"."""
    if value is None or value == "run":
        return 0.0 if value is None else math.inf
    seconds = parse_value(value, "s", where) if isinstance(value, str) else value
    return read_number(seconds, where, 0.0, open_below=True)
