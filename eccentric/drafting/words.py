"""What the name of a column says: quantity, unit, side of the gear, whether it is a set value.

Loggers write `Speed [rpm]`, `Iq (mA)`, `q_rad`, `motorTemp_C`, `Drehzahl in 1/min`. Nothing is decided here:
names are one piece of evidence, units in brackets the best one.
"""

from __future__ import annotations

import itertools
import re
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from eccentric.core import InputError
from eccentric.logs import parse_unit

_WORDS = {
    "time": "t time times timestamp stamp zeit clock tick ticks uptime elapsed millis micros sec secs seconds"
    " nsec nanosec nanoseconds msec usec dt ts epoch utc date datetime tiempo temps tempo latency jitter"
    " zeitstempel uhrzeit datum czas cas tijd tid zaman 시간 时间 時間 время",
    "angle": "theta angle ang pos position q winkel lage enc encoder rotation drehwinkel phi th stroke weg"
    " angulo angolo posicion posizione posicao qpos observationstate drehgeber"
    " hoek positie vinkel kat polozenie uhel poloha aci konum 각도 위치 角度 位置 угол положение θ ϑ φ ϕ",
    "speed": "omega w speed spd vel velo velocity drehzahl dq qd qdot thetadot dtheta rpm geschwindigkeit"
    " n om vitesse velocidad velocidade velocita phidot dphi gyro angularvelocity qvel erpm giri"
    " snelheid toerental hastighet predkosc rychlost hiz 속도 转速 速度 回転数"
    " скорость ω",
    "acceleration": "acc accel acceleration qdd ddq qddot ddot ddtheta thetaddot beschleunigung qacc a"
    " 加速度",
    "current": "i iq current curr cur strom amps ampere amp amperage isense imot motorstrom isq corriente"
    " corrente courant stroom prad proud akim 전류 电流 電流 ток",
    "voltage": "u uq vq voltage volt volts spannung umot vmot v klemmenspannung usq tension"
    " tensione tensao voltaje vmotor spanning napiecie napeti gerilim 전압 电压 電圧 напряжение"
    " pidout pidoutput controlleroutput controloutput controlsignal manipulatedvariable stellgroesse"
    " stellgrosse",
    "torque": "tau torque torq tor moment trq drehmoment tq mot_torque force kraft thrust couple coppia"
    " koppel vridmoment tork qfrc 토크 转矩 扭矩 力矩 トルク момент τ",
    "temperature": "temp temperature temperatures temperatur temperatura celsius tmot 温度 температура",
    "supply": "supply psu vsupply bus vbus vdc battery vbat batt bat iin dclink vin ubat zwischenkreis mains"
    " mainvoltage batterycurrent sourcecurrent buscurrent supplycurrent psucurrent"
    " ubus ibus idc udc inputvoltage voltagein inputcurrent currentin",
    "duty": "pwm duty dutycycle motorpwm",
    "direction": "direction dir drehrichtung richtung sign cw ccw clockwise",
    "run": "run trial experiment versuch lauf series record test messung",
    "on": "enable enabled on active powered",
    "off": "off coast free disabled released",
    "good": "use used valid ok good",
    "bad": "suspect invalid fault bad outlier disturbance disturbed restored error",
}
CONTROLS = frozenset(
    "pidout pidoutput controlleroutput controloutput controlsignal manipulatedvariable stellgroesse"  # noqa: SIM905
    " stellgrosse".split()
)
"""Outputs of controllers, which are voltages at best."""
_OF_WORD = {word: quantity for quantity, words in _WORDS.items() for word in words.split()}
_ROLES = {
    "other": "quat quaternion orientation qx qy qz qw power leistung energy work mass weight inertia constant"
    " ratio coefficient gain kp ki kd efficiency pressure humidity altitude latitude longitude strain mode"
    " status id isd ud usd ld flux ialpha ibeta ualpha ubeta valpha vbeta phase mask layout offset"
    " daxis dcurrent dvoltage",
    "computed": "model modelled modeled predicted prediction predict pred computed calc calculated"
    " calculation simulated simulation sim fitted ideal theoretical theory expected rigid rnea"
    ""
    " qfrcbias qfrcpassive qfrcconstraint coriolis gravity gravcomp friction fric reibung feedforward ff"
    " compensation dahl stribeck lugre coulomb viscous"
    " maxwell gms leuven pinn nnfm lstm gru mlp rnn tcn cnn transformer svm svr gpr neural network xgboost"
    " residual resid residuum droop error err diff deviation delta lag abweichung schleppfehler"
    " schleppabstand regelabweichung external ext limit limits lim max min maximum minimum upper lower"
    " limited threshold saturation tolerance",
    "set": "goal target targ tgt cmd cmds cmnd command commanded commands ref refs reference set setp sp"
    " setpoint setvalue setpos setvelo settorque desired des soll sollwert demand demanded des wanted"
    " request requested req planned plan trajectory traj profile nominal action actions ctrl inputpos"
    " inputvel controllerinput consigne consigna referencia riferimento 目标 目標 指令 给定",
    "electrical": "erpm electrical elec elangle eangle eltheta thetae thetael phie omegae omegael we"
    " elspeed elektrisch elektrische",
    "filtered": "filtered filt averaged avg smoothed smooth lowpass clean gefiltert",
    "estimated": "estimate estimated est hat observer observed obs kalman ekf ukf",
    "measured": "measured mess gemessen meas measurement mes actual act feedback fb fbk ist istwert sensed"
    " sensor real present raw observation actpos actvelo acttorque actcurrent"
    " 实际 反馈",
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
    "mrads": "mrad/s", "m_s": "m/s", "mm_s": "mm/s", "um_s": "um/s", "cm_s": "cm/s",
    "mrad_s": "mrad/s",
    "rad_s": "rad/s", "rads": "rad/s", "rad/sec": "rad/s", "rad_sec": "rad/s", "rad s^-1": "rad/s",
    "rad_s2": "rad/s^2", "rads2": "rad/s^2", "m_s2": "m/s^2", "ms2": "m/s^2",
    "rad_per_s": "rad/s", "deg_s": "deg/s", "°/s": "deg/s", "dps": "deg/s", "deg/sec": "deg/s",
    "deg_per_s": "deg/s", "1/min": "rpm", "min^-1": "rpm", "min-1": "rpm", "u/min": "rpm", "r/min": "rpm",
    "rev/min": "rpm", "об/мин": "rpm", "r.p.m.": "rpm",
    "rev_s": "rev/s", "rps": "rev/s", "counts_s": "counts/s", "cnt": "counts",
    "count": "counts", "inc": "counts", "ticks": "counts", "grad": "deg", "nm": "Nm", "n m": "N m",
    "n_m": "N m", "n*m": "N m", "n·m": "N m", "n.m": "N m",
    "mnm": "mNm", "ma": "mA", "mv": "mV", "degc": "degC", "c": "degC",
    "celsius": "degC", "°c": "degC", "sec": "s", "seconds": "s", "msec": "ms", "usec": "us", "µs": "us",
    "pct": "%", "percent": "%", "prozent": "%",
    "% rated": "%", "% of rated": "%", "% of max": "%", "‰": "‰", "permille": "‰", "per mille": "‰",
    "per thousand": "‰", "promille": "‰", "permil": "‰", "0.1%": "‰", "0.1 %": "‰", "1/1000": "‰",
    "hz": "rev/s",
    "kmh": "km/h", "km_h": "km/h", "kph": "km/h", "km/h": "km/h", "m_min": "m/min", "mph": "mph",
    "aeff": "A", "arms": "A", "a rms": "A", "a_rms": "A", "veff": "V", "vrms": "V", "v rms": "V",
    "pu": "pu", "p.u.": "pu", "per unit": "pu",
    "amps": "A", "volts": "V", "volt": "V", "turns": "turn", "revs": "rev",
    "rad": "rad", "deg": "deg", "rpm": "rpm", "counts": "counts", "ms": "ms", "us": "us", "ns": "ns",
    "mrad": "mrad", "rev": "rev",
}  # fmt: skip
"""In lower case; what is not here is taken as it is written."""
_OF_WEIGHTS = {
    "inlbs": "lbfin", "inlbf": "lbfin", "ftlbs": "lbfft", "ftlbf": "lbfft",
    "ozin": "ozfin", "inoz": "ozfin", "ozfin": "ozfin", "lbin": "lbfin", "inlb": "lbfin", "lbfin": "lbfin",
    "lbft": "lbfft", "ftlb": "lbfft", "lbfft": "lbfft", "kgcm": "kgfcm", "kgfcm": "kgfcm",
}  # fmt: skip
"""Torques by a weight and a length, in lower case without what is between the two."""
_WORDED = {
    "radians": "rad", "radian": "rad", "rads": "rad", "degrees": "deg", "degree": "deg", "grd": "deg",
    "rotations": "rev", "revolutions": "rev", "turns": "rev", "revs": "rev", "tr": "rev", "umdr": "rev",
    "seconds": "s", "second": "s", "secs": "s", "sec": "s", "minutes": "min", "minute": "min", "hours": "h",
    "milliseconds": "ms", "millisec": "ms", "millis": "ms", "microseconds": "us", "nanoseconds": "ns",
    "amps": "A", "amperes": "A", "ampere": "A", "milliamps": "mA", "mamps": "mA", "volts": "V",
    "millivolts": "mV", "newton": "N", "newtons": "N",
    "meters": "m", "metres": "m", "meter": "m", "metre": "m",
    "pulses": "counts", "ticks": "counts", "cts": "counts", "cnt": "counts", "cnts": "counts",
    "inc": "counts", "incs": "counts", "inkr": "counts", "qc": "counts",
}  # fmt: skip
"""Units by their words, as parts of one: degrees/sec, newton-meters."""
_BRACKETS = re.compile(r"\s*(?:\[([^\]]*)\]|\(([^)]*)\)|\bin\s+(\S+)$|\s/\s*(\S+)$)")
_TOKENS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[°µ]\w*|[^\W\d_a-zA-Z]+")
_RATED = ("%", "‰", "pu")
"""Parts of a rated value, which no log holds."""

_KINDS = {
    "time": ("s",), "angle": ("rad", "m"), "speed": ("rad/s", "m/s"), "current": ("A",), "voltage": ("V",),
    "torque": ("N m", "N"), "temperature": ("degC",), "acceleration": ("rad/s^2", "m/s^2"),
}  # fmt: skip


@dataclass(frozen=True)
class Name:
    """What a name says: `quantity` and `unit` are empty where it says nothing.

    Attributes:
        quantity: as in the table of words, or "other" for what is no signal of a drive.
        unit: one of `eccentric.logs`, "%", "‰" or "pu" (parts of a rated value).
        side: "m", "l" or empty.
        role: "measured", "estimated", "filtered", "electrical" (times the pole pairs), "set", "computed" or
            "other", where the name says so.
        whose: the words that say neither quantity nor role, as "a 1", "motor" and "axis 0".
        word: the one that the quantity is by.
        weak: whether that is a letter alone, which values may overrule.
        maker: who logs signals of this name in this unit, where nothing else says it.
    """

    text: str
    quantity: str = ""
    unit: str = ""
    side: str = ""
    role: str = ""
    word: str = ""
    weak: bool = False
    whose: str = ""
    maker: str = ""

    @property
    def is_rated(self) -> bool:
        """Whether it is a part of a rated value."""
        return self.unit in _RATED

    @property
    def commanded(self) -> bool:
        """Whether it is a set value."""
        return self.role == "set"

    @property
    def signal(self) -> bool:
        """Whether it may be a signal of the machine: a set value, a result and a flag of status are none."""
        return (
            self.role in ("", "measured", "estimated", "filtered", "electrical") and self.quantity != "other"
        )


def read_name(text: str, unit: str = "") -> Name:
    """Read the name of a column; `unit` is what the log itself says, in a row of units or as metadata.

    A text there that is no unit is read as a part of the name.
    """
    told = "" if spelled(unit) else unit.strip()
    brackets = [b for b in _BRACKETS.finditer(text) if not (b[1] or b[2] or "").strip().isdigit()]
    bracket = next((b for b in brackets if spelled(_inside(b))), next(iter(brackets), None))
    given = ("" if told else unit.strip()) or (_inside(bracket) if bracket else "")
    plain = text[: bracket.start()] + text[bracket.end() :] if bracket else text
    plain = f"{plain} {told}" if told else plain
    if (
        not given
        and len(plain) > 1
        and plain.lower() not in _NO_UNITS
        and dimension_of(spelled(plain)) in _KINDS
    ):
        return Name(text, dimension_of(spelled(plain)), spelled(plain))
    found, plain = (spelled(given), plain) if given else _suffix(plain)
    plain = _OUTPUT.sub("", plain)
    tokens = _TOKENS.findall(_letters(plain))
    # T is the time where it is all of a name, and not that of "T_des" and "MotT".
    said = [one for one in tokens if one != "T"] or tokens
    words = [word for one in said for word in _parts(one.lower())]
    # "feed forward", "LuGre" and "set point" are one word each, as is a name in parts.
    pairs = [first + second for first, second in itertools.pairwise(words)]
    named = [(_OF_WORD[w], w) for w in (*words, *pairs) if w in _OF_WORD]
    heads = _heads(words)
    named = [one for one in named if one[1] in heads] or named
    joined = "".join(words)
    if joined in _OF_WORD:
        named.insert(0, (_OF_WORD[joined], joined))
    if [w for w in words if not w.isdigit()][-1:] == ["effort"]:
        named.append(("torque", "effort"))
    role = _role(text, plain, words, pairs)
    by_suffix = "" if given else dimension_of(found)
    told = [q for q, _ in named if q in (*_KINDS, "supply") and q != "time"]
    fits = not told or any(by_suffix in ("", q) or (q, by_suffix) in _COMPATIBLE for q in told)
    if not fits and (by_suffix == "time" or _LETTER.search(text)):
        found = ""  # of speed_ms, AxisPos_A1, U_A
    quantity, word = _chosen(named, found)
    sided = {*words} & {"left", "right", "wheel", "l", "r", *_MOTOR, *_LINK}
    if word in ("tick", "ticks") and sided and not found:
        quantity, found = "angle", "counts"
    if not named and words[:1] == ["ms"] and not found:
        quantity, word, found = "time", "ms", "ms"  # ms_today
    if not named and words in (["counts"], ["pulses"]):
        quantity, word, found = "angle", words[0], "counts"
    if not named and words[:1] == ["f"] and not _HUNGARIAN.match(plain):
        quantity, word = "torque", "f"
    if not named and words[:1] == ["m"] and role in ("measured", "set"):
        quantity, word = "torque", "m"  # M_ist, M_soll
    if number := _OBJECT.search(plain):
        quantity, role = _OBJECTS.get(number[1].lower(), (quantity, role))
    if not quantity and _INDEX & set(words):
        quantity = "other"
    side = "l" if _LINK & set(words) else "m" if _MOTOR & set(words) else ""
    whose = " ".join(w for w in words if w not in _OF_WORD and w not in _OF_ROLE)
    return Name(text, quantity, found, side, role, word, len(word) == 1 and not found, whose)


_NO_UNITS = frozenset({"min", "hz", "count", "counts", "cnt", "inc", "ticks", "grad", "rev", "rads"})
"""Units that are names of other things where they are the whole name of a column."""
_HUNGARIAN = re.compile(r"f[A-Z][a-z]")
"""A floating-point number by its name, as fLoad: no force."""
_LETTER = re.compile(r"(?<![A-Za-z])[A-Z]\d*$|(?<=[a-z])[A-Z]\d+$")
_OUTPUT = re.compile(r"^(out\.|simout|yout|\"?model root\"?/)+", re.IGNORECASE)
"""What Simulink calls what holds all outputs, and dSPACE all signals: no side of a gear, and no model's."""


def _inside(bracket: re.Match[str]) -> str:
    return next((g for g in bracket.groups() if g), "")


_NO_ACCENTS = str.maketrans({"ß": "ss", "ł": "l", "Ł": "L", "ı": "i", "ø": "o", "đ": "d"})


def _letters(text: str) -> str:
    """A text without accents."""
    split = unicodedata.normalize("NFD", text.translate(_NO_ACCENTS))
    return unicodedata.normalize("NFC", "".join(c for c in split if not "\u0300" <= c <= "\u036f"))


def _heads(words: Sequence[str]) -> list[str]:
    """The words without those that stand for an adjective or a sensor beside another quantity.

    As in "current position", "current motor speed", "rotation speed" and "encoder velocity".
    """
    of = [_OF_WORD.get(w, "") if len(w) > 1 else "" for w in words]
    heads: list[str] = []
    for k, word in enumerate(words):
        after = [q for w, q in zip(words[k + 1 :], of[k + 1 :], strict=True) if w not in _MOTOR | _LINK]
        adjective = word == "current" and after[:1] != [""] and {*after[:1]} <= _KINDS.keys() - {"current"}
        motion = of[k] == "angle" and "speed" in after
        # Of "x direction position" and "direction speed": which way, or of which axis.
        way = of[k] == "direction" and {*of[:k], *of[k + 1 :]} & _KINDS.keys()
        sensor = word in ("encoder", "enc") and {*of[:k], *of[k + 1 :]} & (_KINDS.keys() - {"time"})
        if not ((adjective and after) or motion or way or sensor):
            heads.append(word)
    return [*heads, *(a + b for a, b in itertools.pairwise(words))]


def _parts(word: str) -> tuple[str, ...]:
    """A compound of two known words, as "motorcurrent", "cmdvel" and "Drehzahlsollwert"; else the word."""
    if word in _OF_WORD or word in _OF_ROLE:
        return (word,)
    if not word.isascii():
        # Chinese and Japanese write words without blanks.
        within = [w for w in (*_OF_WORD, *_OF_ROLE) if not w.isascii() and w in word]
        return tuple(w for w in within if not any(w != other and w in other for other in within)) or (word,)
    if len(word) < 6:
        return (word,)
    known = _OF_WORD.keys() | _OF_ROLE.keys() | _MOTOR | _LINK
    for at in range(3, len(word) - 2):
        # German compounds may have an "en" or "s" between the two.
        for first in (word[:at], word[:at].removesuffix("en"), word[:at].removesuffix("s")):
            if len(first) > 2 and first in known and word[at:] in known:
                return first, word[at:]
    return (word,)


def _role(text: str, plain: str, words: Sequence[str], pairs: Sequence[str]) -> str:
    """Where a column comes from, as its words say."""
    # "phase_current" is the motor's, "phase current A" that of one of three windings.
    whole = "phasecurrent" in pairs and not re.search(
        r"(?<![a-z])[abcuvw]\d?$|[123]$", text.strip(), re.IGNORECASE
    )
    said = {_OF_ROLE[w] for w in (*words, *pairs) if w in _OF_ROLE and not (whole and w == "phase")}
    if "status" in words and any(_OF_WORD.get(w) in _KINDS for w in words[words.index("status") :]):
        # Axis.StatusDrive.ActualTorque
        said = {_OF_ROLE[w] for w in (*words, *pairs) if w in _OF_ROLE and w != "status"}
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


_COMPATIBLE = {
    ("supply", "voltage"),
    ("supply", "current"),
    ("duty", "angle"),
    ("voltage", "angle"),
    ("torque", "ratio"),
}


_MAKERS = {
    "ODrive": ({"vel_estimate": "rev/s", "pos_estimate": "rev"}, ()),
    "moteus": ({"position": "rev", "velocity": "rev/s"}, ("q_current",)),
}
"""Controllers that log turns: the ends of the names of their signals, and of others that must be there."""


def made_by(names: Iterable[str]) -> dict[str, tuple[str, str]]:
    """Columns whose names are those of a controller that logs turns -> unit and controller."""
    ends = {name: re.split(r"[./ ]", name.lower())[-1] for name in names}
    return {
        name: (units[end], maker)
        for maker, (units, others) in _MAKERS.items()
        if {*others} <= {*ends.values()}
        for name, end in ends.items()
        if end in units
    }


def are_numbered(names: Iterable[str]) -> bool:
    """Whether all names are one letter with the number of the column, as R writes them: no quantity."""
    of = [re.fullmatch(r"([A-Za-z])(\d+)", name) for name in names]
    letters = {one[1] for one in of if one}
    return (
        len(of) > 2 and len(letters) == 1 and [int(one[2]) for one in of if one] == [*range(1, len(of) + 1)]
    )


def is_of_supply(name: Name) -> bool:
    """Whether it is a current of the supply, which is not that of the motor."""
    by_word = not name.unit and bool(_CURRENT.search(name.text))
    return name.quantity == "supply" and (is_like(name.unit, "A") or by_word)


_CURRENT = re.compile(
    r"curr|(?<![a-z])amp(s|ere|erage)?(?![a-z])|strom|ibus|idc|iin|(?<![a-z])i(?![a-z])", re.IGNORECASE
)
_OF_MOTOR = re.compile(
    r"(?<![a-z])i?q(?![a-z])|isq|imot|motor|phase|armature|winding|joint|axis", re.IGNORECASE
)


def is_of_motor(name: Name) -> bool:
    """Whether a current is that of the motor, by its name."""
    return name.side != "" or bool(_OF_MOTOR.search(name.text))


def of_a_carriage(unit: str) -> bool:
    """Whether a unit is one of length or velocity."""
    return is_like(unit, "m", "m/s")


def is_mass(unit: str) -> bool:
    """Whether a unit is one of mass."""
    return is_like(unit, "kg")


def is_like(unit: str, *others: str) -> bool:
    """Whether a unit is of the dimension of one of the others; a ratio, or none, is not."""
    if unit in ("", *_RATED, "1", "-"):
        return False
    try:
        own = parse_unit(unit, "", 1.0).dimension
    except InputError:
        return False
    return own in [parse_unit(other, "").dimension for other in others]


def dimension_of(unit: str) -> str:
    """The quantity that a unit belongs to, empty for % and 1; "other" for that of no signal."""
    if unit in ("", *_RATED, "1", "-") or not spelled(unit):
        return ""
    return next((quantity for quantity, units in _KINDS.items() if is_like(unit, *units)), "other")


def spelled(text: str) -> str:
    """A unit in the spelling of `eccentric.logs`; empty if it is none."""
    clean = " ".join(text.split())
    one = _OF_WEIGHTS.get(re.sub(r"[\s.*·_-]+", "", clean.lower())) or _SPELLINGS.get(clean.lower(), clean)
    if one in _RATED:
        return one
    try:
        parse_unit(one, "", 1.0)
    except InputError:
        # "turns/s", "N-m" and "min⁻¹"; one word alone may be of the name, as in "power meter".
        parts = re.sub(r"[^\W\d_]+", lambda word: _WORDED.get(word[0].lower(), word[0]), clean)
        parts = re.sub(r"(?<=[A-Za-z])-(?=[A-Za-z])", " ", parts.replace("⁻¹", "^-1").replace(" per ", "/"))
        alone = clean.lower() in ("second", "minute", "meter", "metre", "newton", "radian", "tr")
        return spelled(parts.removesuffix(".")) if parts != clean and not alone else ""
    return one


_ENDS = (r"[\s_.-]+([^\s_.-]+_[^\s_.-]+)$", r"[\s_.-]+([^\s_.-]+)$", r"(?<=[a-z])([A-Z][a-z]+|[A-Z]{2,})$")


def _suffix(text: str) -> tuple[str, str]:
    """The unit at the end of a name, as in `q_rad`, `w_rad_s`, `i_A_2`, `linkAngleDeg`, and the rest."""
    match = re.fullmatch(r"(.*?)([\s_.-]*\d+)?", text)
    body, number = (match[1], match[2] or "") if match else (text, "")
    if body.lower() in ("rpm", "erpm", "dps"):
        return spelled(body.lower().removeprefix("e")), text
    for (whole, more), pattern in itertools.product(((text, ""), (body, number)), _ENDS):
        tail = re.search(pattern, whole)
        if tail is None:
            continue
        said = tail[1]
        # A single letter is a unit only in its own case, and two words only where they are known as one.
        known = said.lower() in _SPELLINGS
        if (len(said) == 1 and said not in {"s", "A", "V", "C", "K", "N"}) or (
            said[-1].isdigit() and not known
        ):
            continue
        if "_" in said and not known:
            said = re.sub(r"_(?=(s|sec|min)$)", "/", said, flags=re.IGNORECASE)
            if "/" not in said:
                continue
        if found := spelled(said):
            return found, whole[: tail.start()] + more
    # A quantity over its unit, as ISO 80000 writes it: n/rpm; but rad/s is a unit as it stands.
    for whole, more in ((text, ""), (body, number)):
        quantity, slash, said = whole.partition("/")
        if slash and not spelled(quantity.strip()) and (found := spelled(said.strip())):
            return found, quantity + more
    return "", text
