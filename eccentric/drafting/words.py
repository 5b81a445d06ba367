"""What the name of a column says: quantity, unit, side of the gear, whether it is a set value.

Loggers write `Speed [rpm]`, `Iq (mA)`, `q_rad`, `motorTemp_C`, `Drehzahl in 1/min`. Nothing is decided here:
names are one piece of evidence, units in brackets the best one.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from eccentric.core import InputError
from eccentric.logs import parse_unit

_WORDS = {
    "time": "t time times timestamp stamp zeit clock tick ticks uptime elapsed millis micros sec seconds",
    "angle": "theta angle ang pos position q winkel lage enc encoder rotation drehwinkel phi th stroke weg",
    "speed": "omega w speed vel velocity drehzahl dq qd thetadot dtheta rpm geschwindigkeit n om",
    "acceleration": "acc accel acceleration qdd ddq ddtheta beschleunigung",
    "current": "i iq current cur strom amps ampere amp isense imot motorstrom",
    "voltage": "u uq vq voltage volt volts spannung umot vmot v klemmenspannung",
    "torque": "tau torque moment trq drehmoment tq mot_torque force kraft thrust",
    "temperature": "temp temperature temperatur celsius tmot",
    "supply": "supply bus vbus vdc battery vbat batt dclink vin ubat zwischenkreis",
    "duty": "pwm duty dutycycle",
    "run": "run trial experiment versuch lauf series record test messung",
    "on": "enable enabled on active powered",
    "off": "off coast free disabled released",
    "good": "use used valid ok good",
    "bad": "suspect invalid fault bad outlier disturbance disturbed restored error",
}
_OF_WORD = {word: quantity for quantity, words in _WORDS.items() for word in words.split()}
_SET = frozenset(
    "goal target cmd command commanded ref reference set setpoint desired soll demand des wanted".split()  # noqa: SIM905
)
_LINK = frozenset({"link", "load", "output", "out", "joint", "arm", "l", "last", "abtrieb"})
_MOTOR = frozenset({"motor", "mot", "m", "rotor", "input", "in", "antrieb"})

_SPELLINGS = {
    "m_s": "m/s", "mm_s": "mm/s", "um_s": "um/s", "cm_s": "cm/s",
    "rad_s": "rad/s", "rads": "rad/s", "rad/sec": "rad/s", "rad_sec": "rad/s", "rad s^-1": "rad/s",
    "rad_per_s": "rad/s", "deg_s": "deg/s", "°/s": "deg/s", "dps": "deg/s", "deg/sec": "deg/s",
    "deg_per_s": "deg/s", "1/min": "rpm", "min^-1": "rpm", "min-1": "rpm", "u/min": "rpm", "r/min": "rpm",
    "rev/min": "rpm", "rev_s": "rev/s", "rps": "rev/s", "counts_s": "counts/s", "cnt": "counts",
    "count": "counts", "inc": "counts", "ticks": "counts", "grad": "deg", "nm": "Nm", "n m": "N m",
    "n_m": "N m", "n*m": "N m", "mnm": "mNm", "ma": "mA", "mv": "mV", "degc": "degC", "c": "degC",
    "celsius": "degC", "°c": "degC", "sec": "s", "seconds": "s", "msec": "ms", "usec": "us", "µs": "us",
    "pct": "%", "percent": "%", "amps": "A", "volts": "V", "volt": "V", "turns": "turn", "revs": "rev",
    "rad": "rad", "deg": "deg", "rpm": "rpm", "counts": "counts", "ms": "ms", "us": "us", "ns": "ns",
    "mrad": "mrad", "rev": "rev",
}  # fmt: skip
"""In lower case; what is not here is taken as it is written."""
_BRACKETS = re.compile(r"\s*(?:\[([^\]]*)\]|\(([^)]*)\)|\bin\s+(\S+)$|\s/\s*(\S+)$)")
_TOKENS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[°µ%]\w*")

_KINDS = {
    "time": ("s",), "angle": ("rad", "m"), "speed": ("rad/s", "m/s"), "current": ("A",), "voltage": ("V",),
    "torque": ("N m", "N"), "temperature": ("degC",), "acceleration": ("rad/s^2", "m/s^2"),
}  # fmt: skip


@dataclass(frozen=True)
class Name:
    """What a name says: `quantity` and `unit` are empty where it says nothing.

    `unit` is one of `eccentric.logs`, or "%". `side` is "m", "l" or empty; `commanded` marks a set value.
    """

    text: str
    quantity: str = ""
    unit: str = ""
    side: str = ""
    commanded: bool = False
    word: str = ""


def read_name(text: str, unit: str = "") -> Name:
    """Read the name of a column; `unit` is what the log itself says, in a row of units or as metadata."""
    bracket = _BRACKETS.search(text)
    given = unit.strip() or (next((g for g in bracket.groups() if g), "") if bracket else "")
    plain = text[: bracket.start()] + text[bracket.end() :] if bracket else text
    found, plain = (spelled(given), plain) if given else _suffix(plain)
    words = [token.lower() for token in _TOKENS.findall(plain)]
    named = [(_OF_WORD[w], w) for w in words if w in _OF_WORD]
    joined = "".join(words)
    if joined in _OF_WORD:
        named.insert(0, (_OF_WORD[joined], joined))
    quantity, word = _chosen(named, found)
    side = "l" if _LINK & set(words) else "m" if _MOTOR & set(words) else ""
    return Name(text, quantity, found, side, bool(_SET & set(words)), word)


def _chosen(named: list[tuple[str, str]], unit: str) -> tuple[str, str]:
    """The quantity of the words and the unit together: a longer word says more than a letter."""
    by_unit = dimension_of(unit)
    fitting = [one for one in named if by_unit in ("", one[0]) or (one[0], by_unit) in _COMPATIBLE]
    if fitting:
        return max(fitting, key=lambda one: (one[0] in ("supply", "duty", "off", "on", "bad"), len(one[1])))
    return by_unit, ""


_COMPATIBLE = {("supply", "voltage"), ("duty", "angle"), ("voltage", "angle"), ("torque", "ratio")}


def of_a_carriage(unit: str) -> bool:
    """Whether a unit is one of length or velocity."""
    if unit in ("", "%", "1", "-"):
        return False
    try:
        own = parse_unit(unit, "", 1.0).dimension
    except InputError:
        return False
    return own in {parse_unit(known, "").dimension for known in ("m", "m/s")}


def dimension_of(unit: str) -> str:
    """The quantity that a unit belongs to, empty if it says nothing: % and 1 do not."""
    if unit in ("", "%", "1", "-"):
        return ""
    try:
        own = parse_unit(unit, "", 1.0).dimension
    except InputError:
        return ""
    return next((q for q, units in _KINDS.items() if own in [parse_unit(u, "").dimension for u in units]), "")


def spelled(text: str) -> str:
    """A unit in the spelling of `eccentric.logs`; empty if it is none."""
    clean = " ".join(text.split())
    one = _SPELLINGS.get(clean.lower(), clean)
    if one == "%":
        return one
    try:
        parse_unit(one, "", 1.0)
    except InputError:
        return ""
    return one


def _suffix(text: str) -> tuple[str, str]:
    """The unit at the end of a name, as in `q_rad`, `w_rad_s`, `i_A_2`, `linkAngleDeg`, and the rest."""
    match = re.fullmatch(r"(.*?)([\s_.-]*\d+)?", text)
    body, number = (match[1], match[2] or "") if match else (text, "")
    if body.lower() in ("rpm", "dps"):
        return spelled(body), text
    for pattern in (r"[\s_.-]+([^\s_.-]+_[^\s_.-]+)$", r"[\s_.-]+([^\s_.-]+)$", r"(?<=[a-z])([A-Z][a-z]+)$"):
        tail = re.search(pattern, body)
        if tail is None:
            continue
        said = tail[1]
        # A single letter is a unit only in its own case, and two words only where they are known as one.
        if (len(said) == 1 and said not in {"s", "A", "V", "C", "K", "N"}) or (
            "_" in said and said.lower() not in _SPELLINGS
        ):
            continue
        if found := spelled(said):
            return found, body[: tail.start()] + number
    # A quantity over its unit, as ISO 80000 writes it: n/rpm; but rad/s is a unit as it stands.
    for whole, more in ((text, ""), (body, number)):
        quantity, slash, said = whole.partition("/")
        if slash and not spelled(quantity.strip()) and (found := spelled(said.strip())):
            return found, quantity + more
    return "", text
