"""Explanations of a quantity that differs by a factor between log and rig: mostly units."""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from eccentric.model import TURNING, AxisKind
from eccentric.rigs import ForceGain, Rig, channels_of, knowns_of
from eccentric.signals.quality import limits

if TYPE_CHECKING:
    from eccentric.signals.quality.ratios import Ratio


TURN = 2.0 * math.pi


_LEVEL = " (is the plane of motion horizontal, case C1?)"


@dataclass(frozen=True)
class Logged:
    """What a cause depends on: the drive's signal, mu if known, whether an angle is logged, the axis.

    `of_link`: the motion is logged at the link, so that mu makes it that of the motor.
    """

    drive: str
    mu: float | None
    angle: bool
    axis: AxisKind = TURNING
    of_link: bool = False

    @property
    def motion(self) -> tuple[str, str]:
        """The channel of the motion, and what it is called."""
        return ("theta_m", self.axis.term("angle")) if self.angle else ("omega_m", "speed")


@dataclass(frozen=True)
class Cause:
    """A wrong unit: kind and channel of its finding, its text, and the ratios that it causes (others: 1).

    `factor` is that of the channel's values over what they should be in SI, 0 where that is not told; with
    `letter`, that quantity of the rig should be divided by `factor` instead.
    """

    kind: str
    channel: str
    text: str
    ratios: dict[str, float]
    factor: float = 0.0
    letter: str = ""


_ANGLES = {"is in deg": 360.0 / TURN, "is in rev": 1.0 / TURN}
_SPEEDS = {"is in rpm": 60.0 / TURN, "is in deg/s": 360.0 / TURN, "is in rev/s": 1.0 / TURN}


def misreadings(logged: Logged) -> dict[str, float]:
    """Return what the angle, or speed, may be instead: words, and the factor of its values."""
    return ((_ANGLES if logged.angle else _SPEEDS) if logged.axis.wraps else {}) | _sides(logged)


def _sides(logged: Logged) -> dict[str, float]:
    """The other side of the gear, unless it is nearly direct."""
    mu = logged.mu
    if not logged.axis.wraps or mu is None or limits.DIRECT[0] < mu < limits.DIRECT[1]:
        return {}
    if logged.of_link:
        return {"is the motor's, mapped as the link's": 1.0 / mu}
    return {"is the link's, mapped as the motor's": mu}


def common_cause(ratios: Sequence[Ratio], logged: Logged) -> Cause | None:
    """Return the one wrong unit or scale that explains all ratios; None if there is none.

    One ratio alone has many causes: at least two must be off consistently.
    """
    for cause in _causes(logged):
        made = [ratio for ratio in ratios if ratio.name in cause.ratios]
        if len(made) > 1 and all(ratio.near(cause.ratios.get(ratio.name, 1.0)) for ratio in ratios):
            return cause
    return _gear(ratios, logged) or _scale(ratios, logged)


def _gear(ratios: Sequence[Ratio], logged: Logged) -> Cause | None:
    """Blame mu where the link's motion is logged: by k_e it is off by a factor, by gravity by its inverse."""
    of = {ratio.name: ratio for ratio in ratios}
    emf, gravity = of.get("k_e"), of.get("M g L")
    if not logged.of_link or logged.mu is None or emf is None or gravity is None or emf.value <= 0.0:
        return None
    if emf.near(1.0) or gravity.near(1.0) or not gravity.near(1.0 / emf.value):
        return None
    if "R" in of and not of["R"].near(1.0):
        return None
    better = logged.mu / emf.value
    text = f"mu is {logged.mu:.4g} in the rig file, and {better:.3g} makes k_e and gravity agree"
    return Cause("contradiction", "mu", text, {})


def _scale(ratios: Sequence[Ratio], logged: Logged) -> Cause | None:
    """Blame the scale of the drive or k_i for torques that are all off by one factor that no unit has."""
    torques = [ratio for ratio in ratios if ratio.name in ("J", "M g L")]
    if not torques or (scale := torques[0].value) <= 0.0 or torques[0].near(1.0):
        return None
    if not all(ratio.near(scale) for ratio in torques):
        return None
    rest = {ratio.name: ratio for ratio in ratios if ratio not in torques}
    others = [ratio for name, ratio in rest.items() if name not in ("R", "k_i")]
    resistance, constant = rest.get("R"), rest.get("k_i")
    if not all(ratio.near(1.0) for ratio in others):
        return None
    drive, k_i, by = logged.drive, logged.axis.named("k_i"), _off(scale)
    if drive == "current" and resistance is not None and constant is None and resistance.near(1.0 / scale):
        return Cause("wrong_unit", "current", f"the scale of the current is {by}", {}, scale)
    if resistance is not None and not resistance.near(1.0):
        return None
    if constant is not None:
        found = constant.near(1.0 / scale)
        return Cause("contradiction", "k_i", f"{k_i} is {by}", {}, scale, "k_i") if found else None
    if len(torques) < 2:
        return None
    if drive == "current" and resistance is not None:
        return Cause("contradiction", "k_i", f"{k_i} is {by}", {}, scale, "k_i")
    return Cause("contradiction", "k_i", f"the scale of the {logged.axis.term(drive)}, or {k_i}, is {by}", {})


def _off(factor: float) -> str:
    return f"off by a factor of {float(f'{factor:.3g}'):g}"


def _causes(logged: Logged) -> list[Cause]:
    channel = logged.motion[0]
    causes = [_misread(words, f, logged) for words, f in misreadings(logged).items()]
    causes += [
        Cause("wrong_unit", "time", f"the time is in {unit}", {"J": f * f, "k_e": f, "k_i": f})
        for unit, f in (("ms", 1e3), ("us", 1e6))
    ]
    signals = _SIGNALS if logged.axis.wraps else (*_SIGNALS, channel)
    return [*causes, *(_prefixed(name, factor, logged) for factor in (1e3, 1e-3) for name in signals)]


def _refuted(made: dict[str, float], every: Sequence[Ratio], by: Collection[str]) -> bool:
    """Whether one of some ratios agrees with the rig, which a cause that makes these would not leave so."""
    return any(
        ratio.low > 0.0 and ratio.near(1.0) and not (ratio.name in made and ratio.near(made[ratio.name]))
        for ratio in every
        if ratio.name in by
    )


def _misread(words: str, factor: float, logged: Logged) -> Cause:
    """The angle or the speed, whose values are this factor larger than they should be."""
    channel, name = logged.motion
    made: dict[str, float] = dict.fromkeys(("J", "k_e", "k_i"), 1.0 / factor)
    return Cause("wrong_unit", channel, f"the {name} {words}", made)


_SIGNALS = ("current", "voltage", "torque")


def _prefixed(signal: str, factor: float, logged: Logged) -> Cause:
    """A current, voltage or torque, or a motion in metres, whose values are this factor larger than in SI."""
    made = {
        "current": {"R": 1.0 / factor},
        "voltage": {"R": factor, "k_e": factor, "k_i": factor},
        "torque": {},
    }.get(signal, dict.fromkeys(("J", "k_e", "k_i"), 1.0 / factor))
    if signal in ("current", "voltage"):
        made["k_i by gravity"] = 1.0 / factor
    if logged.drive == signal:
        made |= {"J": factor, "M g L": factor}
    prefix = "m" if factor > 1.0 else "k"
    name = logged.motion[1] if signal == logged.motion[0] else logged.axis.term(signal)
    text = f"the {name} is in {prefix}{channels_of(logged.axis)[signal][1]}"
    return Cause("wrong_unit", signal, text, made, factor)


_SINGLE = {
    "k_e": {
        1.0 / TURN: "in V s/rev", 60.0 / TURN: "in V/rpm",
        0.06 / TURN: "in V/krpm", 1e-3: "in mV s/rad, or per krpm",
        TURN: "divided by 2 pi once too often",
    },
    "R": {1e-3: "in mohm", 2.0: "one phase, and two in the log", 0.5: "two phases, and one in the log"},
    "J": {1e-4: "in kg cm^2", 1e-7: "in g cm^2", 1e-3: "in g m^2"},
    "M g L": {1e-3: "mass in g, or length in mm", 1e-2: "length in cm",
              1e3: "kg entered as g, or m as mm", 1e2: "m entered as cm"},
}  # fmt: skip


def mass_causes(ratio: Ratio, logged: Logged) -> list[Cause]:
    """Return the wrong units that explain the mass of a carriage alone: none is likelier than another."""
    motion = logged.motion[0]
    causes = [_prefixed(name, factor, logged) for name in (motion, logged.drive) for factor in (1e3, 1e-3)]
    if logged.drive == "current":
        k_i = logged.axis.named("k_i")
        causes += [
            Cause("", "k_i", f"{k_i} is off by a factor of {f:g}", {"J": f}, f, "k_i") for f in (1e3, 1e-3)
        ]
    return [cause for cause in causes if ratio.value > 0.0 and ratio.near(cause.ratios["J"])]


def single_cause(ratio: Ratio, logged: Logged, every: Sequence[Ratio]) -> tuple[str, Cause | None]:
    """Return the explanation of one of the ratios, in brackets, "" if there is none, and what to blame."""
    drive, mu = logged.drive, logged.mu
    causes = {f: logged.axis.text(words) for f, words in _SINGLE.get(ratio.letter, {}).items()}
    blamed: dict[str, Cause] = {}
    if ratio.name == "k_e":
        made = (_misread(words, factor, logged) for words, factor in _sides(logged).items())
        blamed = {c.text: c for c in made if not _refuted(c.ratios, every, ("J", "M g L"))}
        causes |= {cause.ratios["k_e"]: cause.text for cause in blamed.values()}
    if ratio.name == "J" and not logged.axis.wraps:
        return "", None
    if ratio.name == "J" and mu is not None and mu < limits.REDUCED:
        causes |= {mu**2: "J_m at the link", 1.0 / mu**2: "J_l at the motor"}
    level = ratio.name == "M g L" and ratio.high < limits.LEVEL_PLANE
    if level and ratio.low <= 0.0:
        return _LEVEL, None
    for factor in (1e3, 1e-3):
        # A mass in grams, an inertia in kg mm^2: nobody logs in kiloamperes.
        if ratio.name in ("J", "M g L") and factor < 1.0:
            continue
        # A resistance has two readings: that of the more usual winding is taken.
        if ratio.name == "R" and abs(math.log(ratio.found)) < abs(math.log(ratio.found / ratio.value)):
            continue
        cause = _prefixed("current" if ratio.letter in ("R", "k_i") else drive, factor, logged)
        explains = ratio.name in cause.ratios and ratio.value > 0.0 and ratio.near(cause.ratios[ratio.name])
        if explains and not _refuted(cause.ratios, every, cause.ratios):
            return f" ({cause.text}?)", cause
    near = {math.inf: ""}
    if ratio.value > 0.0:
        near |= {abs(math.log(ratio.value / factor)): words for factor, words in causes.items()}
    best = min(near)
    if best <= limits.NEAR:
        return f" ({near[best]}?)", blamed.get(near[best])
    if ratio.name == "k_e" and logged.of_link and mu is not None and ratio.value > 0.0:
        gear = Cause("contradiction", "mu", f"or is mu {mu / ratio.value:.3g}", {"M g L": 1.0 / ratio.value})
        return ("", None) if _refuted(gear.ratios, every, gear.ratios) else (f" ({gear.text}?)", gear)
    if level:
        return _LEVEL, None
    # Gravity is the larger part of a torque; an inertia off by the same factor may not show.
    scaled = {"J": ratio.value}
    either = ratio.name == "M g L" and drive == "current" and not _refuted(scaled, every, scaled)
    return (f" (or is {logged.axis.named('k_i')} {_off(ratio.value)}?)" if either else ""), None


# What to write into the rig file for a wrong unit, scale or value.


_PREFIXES = {1.0: "", 1e-3: "m", 1e-6: "u", 1e3: "k"}


def _read_as(cause: Cause, rig: Rig) -> tuple[float, str | None]:
    """Return the factor to SI that a column has by a cause, and the prefix of that unit, None for none."""
    source = (rig.log.columns or {}).get(cause.channel)
    declared = source.unit.factor if source is not None and source.unit is not None else 1.0
    true = declared / cause.factor
    return true, next((_PREFIXES[p] for p in _PREFIXES if abs(math.log(true / p)) <= limits.NEAR), None)


def _is_far(cause: Cause, rig: Rig) -> bool:
    """Whether a cause reads a column in a unit that nobody logs in: kilometres, kiloamperes, kilovolts."""
    source = (rig.log.columns or {}).get(cause.channel)
    if cause.letter or not cause.factor or (source is not None and source.gain is not None):
        return False
    prefix = _read_as(cause, rig)[1]
    thousand = cause.factor < 1.0 if prefix is None else prefix == "k"
    return thousand and channels_of(rig.axis)[cause.channel][1] in {"m", "A", "V"}


def with_unit(cause: Cause, rig: Rig) -> tuple[str, str]:
    """Return the text of a cause, for the unit that the rig declares, and the line that mends the rig."""
    if cause.letter:
        unit = next(known.unit for known in knowns_of(rig.axis) if known.name == cause.letter)
        return (
            cause.text,
            f'{rig.axis.named(cause.letter)} = "{rig.known[cause.letter] / cause.factor:.3g} {unit}"',
        )
    if not cause.factor:
        return cause.text, ""
    source = (rig.log.columns or {}).get(cause.channel)
    standard, si = channels_of(rig.axis)[cause.channel]
    channel = rig.axis.named(cause.channel)
    column = source.text if source is not None else standard
    if source is not None and source.gain is not None:
        return _with_gain(cause, channel, column, source.gain)
    true, prefix = _read_as(cause, rig)
    if prefix is None:
        plain = column if column.isidentifier() else f"`{column}`"
        scaled = json.dumps(f"{plain} * {true:.3g}", ensure_ascii=False)
        # Arithmetic is not told from an odd name here: the factor alone is said.
        return cause.text, "" if set(column) & set("+-*/`") else f"{channel} = {scaled}"
    unit = f"{prefix}{si}"
    unit = unit.replace("mN m", "mNm").replace("kN m", "kNm").replace("uN m", "uNm")
    name = {"theta_m": rig.axis.term("angle"), "omega_m": "speed"}.get(cause.channel, channel)
    text = f"the {name} is in {unit}" + (f", not {source.unit.text}" if source and source.unit else "")
    return text, f'{channel} = {{ column = {json.dumps(column, ensure_ascii=False)}, unit = "{unit}" }}'


def _with_gain(cause: Cause, channel: str, column: str, gain: ForceGain) -> tuple[str, str]:
    """The same for a column that a gain converts: its unit stays, the gain is what differs."""
    true = f"{gain.value / cause.factor:.6g} {gain.unit}"
    unit = "" if gain.column is None else f'unit = "{gain.column}", '
    text = f"the gain of the {channel} is {true}, not {gain.value:.6g} {gain.unit}"
    line = f'column = {json.dumps(column, ensure_ascii=False)}, {unit}gain = "{true}"'
    return text, f"{channel} = {{ {line} }}"


def readings(causes: Iterable[Cause], ratio: Ratio, rig: Rig) -> tuple[str, str]:
    """Return several possible causes of one ratio, the rig's own value last, and the line for each."""
    told = [with_unit(cause, rig) for cause in causes if not _is_far(cause, rig)]
    value = f"{rig.axis.named(ratio.letter)} is {ratio.found:.3g} {ratio.unit}", of_letter(ratio, rig)
    said, mends = zip(*told, value, strict=True)
    return ", or ".join(said), " or ".join(mends)


def of_letter(ratio: Ratio, rig: Rig) -> str:
    """Return the line of the rig with the value of the log; empty for what is of several letters."""
    single = ("R", "k_e", "k_i", *(() if rig.axis.wraps else ("J",)))
    return (
        f'{rig.axis.named(ratio.letter)} = "{ratio.found:.3g} {ratio.unit}"' if ratio.letter in single else ""
    )
