"""What the name of a column says: quantity, unit, side of the gear, whether it is a set value.

Loggers write `Speed [rpm]`, `Iq (mA)`, `q_rad`, `motorTemp_C`, `Drehzahl in 1/min`. Nothing is decided here:
names are one piece of evidence, units in brackets the best one.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass

from eccentric.core import InputError
from eccentric.logs import parse_unit

_WORDS = {
    "time": "t time times timestamp stamp zeit clock tick ticks uptime elapsed millis micros sec secs seconds"
    " nsec nanosec nanoseconds msec usec dt ts epoch utc date datetime tiempo temps tempo latency jitter",
    "angle": "theta angle ang pos position q winkel lage enc encoder rotation drehwinkel phi th stroke weg"
    " angulo posicion posizione qpos observationstate",
    "speed": "omega w speed spd vel velo velocity drehzahl dq qd qdot thetadot dtheta rpm geschwindigkeit"
    " n om vitesse velocidad velocita phidot dphi gyro angularvelocity qvel erpm",
    "acceleration": "acc accel acceleration qdd ddq ddtheta beschleunigung qacc a",
    "current": "i iq current curr cur strom amps ampere amp amperage isense imot motorstrom isq corriente"
    " courant",
    "voltage": "u uq vq voltage volt volts spannung umot vmot v klemmenspannung usq tension"
    " pidout pidoutput controlleroutput controloutput controlsignal manipulatedvariable stellgroesse",
    "torque": "tau torque torq moment trq drehmoment tq mot_torque force kraft thrust",
    "temperature": "temp temperature temperatures temperatur celsius tmot",
    "supply": "supply vsupply bus vbus vdc battery vbat batt dclink vin ubat zwischenkreis mains mainvoltage"
    " ubus ibus idc udc inputvoltage voltagein inputcurrent currentin",
    "duty": "pwm duty dutycycle motorpwm",
    "run": "run trial experiment versuch lauf series record test messung",
    "on": "enable enabled on active powered",
    "off": "off coast free disabled released",
    "good": "use used valid ok good",
    "bad": "suspect invalid fault bad outlier disturbance disturbed restored error",
}
CONTROLS = frozenset(
    "pidout pidoutput controlleroutput controloutput controlsignal manipulatedvariable stellgroesse".split()  # noqa: SIM905
)
"""Outputs of controllers, which are voltages at best."""
_OF_WORD = {word: quantity for quantity, words in _WORDS.items() for word in words.split()}
_ROLES = {
    "other": "quat quaternion orientation qx qy qz qw power energy work mass weight inertia constant ratio"
    " coefficient gain kp ki kd efficiency pressure humidity altitude latitude longitude strain mode status"
    " id isd ud usd ld flux ialpha ibeta ualpha ubeta valpha vbeta phase mask layout offset"
    " daxis dcurrent dvoltage",
    "computed": "model modelled modeled predicted prediction predict pred computed calc calculated"
    " calculation simulated simulation sim fitted ideal theoretical theory expected rigid rnea"
    " coriolis gravity friction fric reibung feedforward ff compensation dahl stribeck lugre coulomb viscous"
    " maxwell gms leuven pinn nnfm lstm gru mlp rnn tcn cnn transformer svm svr gpr neural network xgboost"
    " residual resid residuum droop error err diff deviation delta lag abweichung schleppfehler"
    " schleppabstand regelabweichung external ext limit limits lim max min maximum minimum upper lower"
    " limited threshold saturation tolerance",
    "set": "goal target targ tgt cmd cmds cmnd command commanded commands ref refs reference set setp sp"
    " setpoint setvalue setpos setvelo settorque desired des soll sollwert demand demanded des wanted"
    " request requested req planned plan trajectory traj profile nominal action actions ctrl",
    "filtered": "filtered filt averaged avg smoothed smooth lowpass clean gefiltert",
    "estimated": "estimate estimated est hat observer observed obs kalman ekf ukf",
    "measured": "measured mess gemessen meas measurement mes actual act feedback fb fbk ist istwert sensed"
    " sensor real present raw observation actpos actvelo acttorque actcurrent",
}
"""Words that say where a column comes from, besides what it is of; the first that a name has decides."""
_OF_ROLE = {word: role for role, words in _ROLES.items() for word in words.split()}
_INDEX = frozenset(
    "index idx seq sequence frame episode iteration iter sample samples row nr".split()  # noqa: SIM905
)
_OBJECTS = {
    "6064": ("angle", "measured"), "6062": ("angle", "set"), "607a": ("angle", "set"),
    "606c": ("speed", "measured"), "606b": ("speed", "set"), "60ff": ("speed", "set"),
    "6077": ("torque", "measured"), "6071": ("torque", "set"), "6074": ("torque", "set"),
    "6078": ("current", "measured"), "60f4": ("angle", "computed"), "6079": ("supply", "measured"),
}  # fmt: skip
"""Objects of the profile CiA 402 for drives: what they are, and whether measured or set."""
_OBJECT = re.compile(r"(?:0x)?(60[67f][0-9a-f])(?![0-9a-gi-z])", re.IGNORECASE)
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
    "pct": "%", "percent": "%", "prozent": "%", "% rated": "%", "‰": "‰", "permille": "‰", "per mille": "‰",
    "promille": "‰", "permil": "‰", "0.1%": "‰", "0.1 %": "‰", "1/1000": "‰", "hz": "rev/s",
    "kmh": "km/h", "km_h": "km/h", "kph": "km/h", "km/h": "km/h", "m_min": "m/min", "mph": "mph",
    "amps": "A", "volts": "V", "volt": "V", "turns": "turn", "revs": "rev",
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

    Attributes:
        quantity: as in the table of words, or "other" for what is no signal of a drive.
        unit: one of `eccentric.logs`, "%" or "‰".
        side: "m", "l" or empty.
        role: "measured", "estimated", "filtered", "set", "computed" or "other", where the name says so.
        word: the one that the quantity is by.
        weak: whether that is a letter alone, which values may overrule.
    """

    text: str
    quantity: str = ""
    unit: str = ""
    side: str = ""
    role: str = ""
    word: str = ""
    weak: bool = False

    @property
    def commanded(self) -> bool:
        """Whether it is a set value."""
        return self.role == "set"

    @property
    def signal(self) -> bool:
        """Whether it may be a signal of the machine: a set value, a result and a flag of status are none."""
        return self.role in ("", "measured", "estimated", "filtered") and self.quantity != "other"


def read_name(text: str, unit: str = "") -> Name:
    """Read the name of a column; `unit` is what the log itself says, in a row of units or as metadata.

    A text there that is no unit is read as a part of the name.
    """
    told = "" if spelled(unit) else unit.strip()
    bracket = _BRACKETS.search(text)
    given = ("" if told else unit.strip()) or (
        next((g for g in bracket.groups() if g), "") if bracket else ""
    )
    plain = text[: bracket.start()] + text[bracket.end() :] if bracket else text
    plain = f"{plain} {told}" if told else plain
    found, plain = (spelled(given), plain) if given else _suffix(plain)
    words = [word for token in _TOKENS.findall(plain) for word in _parts(token.lower())]
    # "feed forward", "LuGre" and "set point" are one word each, as is a name in parts.
    pairs = [first + second for first, second in itertools.pairwise(words)]
    named = [(_OF_WORD[w], w) for w in (*words, *pairs) if w in _OF_WORD]
    joined = "".join(words)
    if joined in _OF_WORD:
        named.insert(0, (_OF_WORD[joined], joined))
    if [w for w in words if not w.isdigit()][-1:] == ["effort"]:
        named.append(("torque", "effort"))
    role = _role(plain, words, pairs)
    quantity, word = _chosen(named, found)
    if not named and words[:1] == ["f"]:
        quantity, word = "torque", "f"
    if not named and words[:1] == ["m"] and role in ("measured", "set"):
        quantity, word = "torque", "m"  # M_ist, M_soll
    if number := _OBJECT.search(plain):
        quantity, role = _OBJECTS.get(number[1].lower(), (quantity, role))
    if not quantity and _INDEX & set(words):
        quantity = "other"
    side = "l" if _LINK & set(words) else "m" if _MOTOR & set(words) else ""
    return Name(text, quantity, found, side, role, word, weak=len(word) == 1 and not found)


def _parts(word: str) -> tuple[str, ...]:
    """A compound of two known words, as "motorcurrent", "cmdvel" and "Drehzahlsollwert"; else the word."""
    if word in _OF_WORD or word in _OF_ROLE or len(word) < 6:
        return (word,)
    known = _OF_WORD.keys() | _OF_ROLE.keys() | _MOTOR | _LINK
    for at in range(3, len(word) - 2):
        # German compounds may have an "en" or "s" between the two.
        for first in (word[:at], word[:at].removesuffix("en"), word[:at].removesuffix("s")):
            if len(first) > 2 and first in known and word[at:] in known:
                return first, word[at:]
    return (word,)


def _role(plain: str, words: Sequence[str], pairs: Sequence[str]) -> str:
    """Where a column comes from, as its words say."""
    said = {_OF_ROLE[w] for w in (*words, *pairs) if w in _OF_ROLE}
    # Of q_d, i_d: desired, or the d axis; rotation/w: a part of a quaternion.
    if re.search(r"[a-z0-9]_d(?![a-z])", plain, re.IGNORECASE) and "d" in words[1:]:
        said.add("set")
    if words[-1:] in (["x"], ["y"], ["z"], ["w"]) and {"rotation", "quat"} & set(words):
        said.add("other")
    return next((role for role in _ROLES if role in said), "")


def _chosen(named: list[tuple[str, str]], unit: str) -> tuple[str, str]:
    """The quantity of the words and the unit together: a longer word says more than a letter."""
    by_unit = dimension_of(unit)
    if by_unit == "other":
        return by_unit, ""
    fitting = [one for one in named if by_unit in ("", one[0]) or (one[0], by_unit) in _COMPATIBLE]
    if fitting:
        return max(fitting, key=lambda one: (one[0] in ("supply", "duty", "off", "on", "bad"), len(one[1])))
    return by_unit, ""


_COMPATIBLE = {("supply", "voltage"), ("duty", "angle"), ("voltage", "angle"), ("torque", "ratio")}


def of_a_carriage(unit: str) -> bool:
    """Whether a unit is one of length or velocity."""
    return _is_like(unit, "m", "m/s")


def is_mass(unit: str) -> bool:
    """Whether a unit is one of mass."""
    return _is_like(unit, "kg")


def _is_like(unit: str, *others: str) -> bool:
    """Whether a unit is of the dimension of one of the others; a ratio, or none, is not."""
    if unit in ("", "%", "‰", "1", "-"):
        return False
    try:
        own = parse_unit(unit, "", 1.0).dimension
    except InputError:
        return False
    return own in [parse_unit(other, "").dimension for other in others]


def dimension_of(unit: str) -> str:
    """The quantity that a unit belongs to, empty for % and 1; "other" for that of no signal."""
    if unit in ("", "%", "‰", "1", "-") or not spelled(unit):
        return ""
    return next((quantity for quantity, units in _KINDS.items() if _is_like(unit, *units)), "other")


def spelled(text: str) -> str:
    """A unit in the spelling of `eccentric.logs`; empty if it is none."""
    clean = " ".join(text.split())
    one = _SPELLINGS.get(clean.lower(), clean)
    if one in ("%", "‰"):
        return one
    try:
        parse_unit(one, "", 1.0)
    except InputError:
        return ""
    return one


_ENDS = (r"[\s_.-]+([^\s_.-]+_[^\s_.-]+)$", r"[\s_.-]+([^\s_.-]+)$", r"(?<=[a-z])([A-Z][a-z]+|[A-Z]{2,})$")


def _suffix(text: str) -> tuple[str, str]:
    """The unit at the end of a name, as in `q_rad`, `w_rad_s`, `i_A_2`, `linkAngleDeg`, and the rest."""
    match = re.fullmatch(r"(.*?)([\s_.-]*\d+)?", text)
    body, number = (match[1], match[2] or "") if match else (text, "")
    if body.lower() in ("rpm", "dps"):
        return spelled(body), text
    for pattern in _ENDS:
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
