"""The motor and its circuit: flux, iron, winding, inverter, and the current sensor."""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp

from eccentric.effects.declared import constant_off, resistance_off
from eccentric.effects.effect import LOAD, TEMPERATURE, Effect, Plausible, Setting, Shape, Words
from eccentric.effects.forms import (
    addition,
    current,
    dt,
    heating,
    nonnegative,
    of_flux,
    positive,
    reference_temperature,
    relaxation,
    temperature,
    thermal_times,
)
from eccentric.model import MAGNETS, MOTORS, Sgn, State, quantity
from eccentric.model import vocabulary as v

# A winding without iron has none in the way of its own field, and turns in a field that stands still in all
# the iron there is.
WITH_IRON = {"motor": tuple(m for m in MOTORS if m != "coreless")}
BOTH = ("current", "voltage")
R = v.R.symbol


def kt_saturation(setting: Setting) -> Iterator[Effect]:
    """The one effect of the family; for c = 1/i_s^2 it is k_t = k_i/(1 + (i/i_s)^2).

    Far below i_s a log determines c alone: by the fraction c i_s^2 its coefficient would grow with i_s.
    """
    bend = nonnegative(
        "ktsat_c",
        "1/A^2",
        "relative fall of the torque constant per square of the current, at small ones",
        "c",
    )
    i_s = positive("ktsat_i", "A", "current at which it has fallen by half of c i_s^2", "i_s")
    square = current**2
    # With i_s at a third of the largest current, that current takes nine tenths of all that there is to lose.
    largest, lowest = setting.current_max, setting.current_max / 3.0
    yield of_flux(
        "kt_saturation",
        [(bend, -square / (1 + square / i_s.symbol**2))],
        setting,
        # The largest c of those forms whose torque constant is positive at any current, c i_s^2 <= 1; of the
        # others the log has to keep it so.
        bounds=((0.0, lowest**-2),),
        depends_on=("current",),
        formula="k_i and k_e times 1 - c i^2/(1 + (i/i_s)^2)",
        reference="form of our own; armature reaction: A. E. Fitzgerald, C. Kingsley and S. D. Umans,"
        " Electric Machinery",
        shapes=(Shape(i_s, lowest, 20.0 * largest, "log", 10),),
        only_with=WITH_IRON,
        words=Words(
            headline="a torque constant that falls at high current",
            meaning="Saturation of the iron: torque constant and back-EMF constant fall at high current.",
            hint="high currents at low speed: hold the link horizontal, or accelerate hard",
            kin=LOAD,
        ),
    )


def magnet_temperature(setting: Setting) -> Iterator[Effect]:
    """The one effect of the family; none if no temperature is logged.

    The voltage alone identifies R/k_i, and does not tell which of both changes: `resistance_temperature`.
    """
    if setting.temperature_mid is None or setting.by_voltage:
        return
    fall = nonnegative("magnet_a", "1/K", "relative fall of the motor's flux per kelvin", "a")
    # The temperature of the declared constants is not in the rig file, so this is free.
    cold = quantity("magnet_0", "1", "relative error of the declared constants at T_0", letter="k_0")
    known = Plausible(
        100 * fall.symbol,
        "%/K",
        0.02,
        0.20,
        "neomagnetsupplier.com, Types of Magnets, 2008: ferrite 0.20, NdFeB 0.12, SmCo 0.04, Alnico 0.02 %/K",
        "the temperature coefficient of the flux",
        above="the magnets are not the only cause",
        below="less than any magnet, or a sensor that warms up more than the magnets",
    )
    zero = reference_temperature("magnet", setting.temperature_mid)
    yield of_flux(
        "magnet_temperature",
        [(fall, zero.symbol - temperature), (cold, sp.Integer(1))],
        setting,
        # No magnet loses 1 % per kelvin, and no data sheet is off by half.
        bounds=((0.0, 0.01), (-0.5, 0.5)),
        depends_on=("temperature", "current"),
        needs=("temperature",),
        formula="k_i and k_e times 1 + k_0 - a (T - T_0)",
        reference="T. J. E. Miller, Brushless Permanent-Magnet and Reluctance Motor Drives, Oxford"
        " University Press, 1989",
        definitions=(zero,),
        inputs=(v.temperature,),
        only_with={"motor": MAGNETS},
        plausible=(known, constant_off(cold.symbol, "torque constant at the median temperature", warm=True)),
        words=Words(
            headline="torque and back-EMF constants that fall as the magnets warm up",
            meaning=(
                "The flux of permanent magnets falls with temperature, reversibly: by 0.1 % per kelvin for"
                " neodymium, 0.2 % for ferrite, 0.04 % for samarium-cobalt; torque constant and back-EMF"
                " constant fall with it."
            ),
            hint="drive the motor externally with its terminals open, cold and warm, and read the voltage",
            kin=TEMPERATURE,
            tell_apart={
                "resistance_temperature": "Hold the rotor locked at a constant current while it warms: only R"
                " shows."
            },
        ),
    )


def magnetic_hysteresis(setting: Setting) -> Iterator[Effect]:
    """Duhem's model, with branches that meet exponentially, and the play operator, with parallel ones."""
    # Of this sign the torque lags the current: of the other, every cycle of the current would give energy.
    A = nonnegative(
        "hysteresis_A", "N m", "half the difference in torque between falling and rising current", "A"
    )
    width = positive("hysteresis_i", "A", "change of current within which the branches meet", "i_h")
    last = quantity("hysteresis_last", "A", "current one time step ago", letter="i_old")
    play = quantity("hysteresis_p", "1", "play of the current, in half widths", letter="p")
    words = Words(
        title="Magnetic hysteresis",
        meaning="Magnetic hysteresis: the torque lags behind the current, whatever the rate.",
        hint="rising and falling current through the same value, at rest against a stop or at constant speed",
    )
    largest, step = setting.current_max, current - last.symbol
    branch = relaxation(
        "hysteresis_z", "branch of the hysteresis, -1 to 1", sp.Abs(step), width.symbol, step, letter="z"
    )
    yield addition(
        "magnetic_hysteresis",
        [(A, branch.symbol)],
        kind="actuator",
        depends_on=("current", "history"),
        formula="A z, dz = (di - |di| z)/width",
        reference="B. D. Coleman and M. L. Hodgdon, Int. J. Engineering Science 24(6), 1986",
        shapes=(Shape(width, 0.03 * largest, 2.0 * largest, "log", 7),),
        states=(State(last, sp.Integer(0), current), branch),
        needs=("current",),
        only_with=WITH_IRON,
        words=words,
        headline="magnetic hysteresis between current and torque by Duhem's model",
    )
    scaled = current / width.symbol
    follow = State(play, sp.Integer(0), sp.Max(scaled - 1, sp.Min(scaled + 1, play.symbol)))
    yield addition(
        "magnetic_hysteresis",
        [(A, scaled - play.symbol)],
        variant="play",
        kind="actuator",
        depends_on=("current", "history"),
        formula="A (i/width - p), p the play of i/width",
        reference="M. Brokate and J. Sprekels, Hysteresis and Phase Transitions, Springer, 1996",
        shapes=(Shape(width, 0.02 * largest, 0.8 * largest, "log", 4),),
        states=(follow,),
        needs=("current",),
        only_with=WITH_IRON,
        words=words,
        headline="magnetic hysteresis between current and torque by the play operator",
    )


def current_bias(setting: Setting) -> Iterator[Effect]:
    """The one effect of the family; without a voltage it is an alias of `coulomb_asymmetry`."""
    if setting.by_voltage:
        return
    bias = quantity("bias_i", "A", "measured current minus the true one", letter="i_0")
    yield addition(
        "current_bias",
        [(bias, v.k_i.symbol)],
        circuit=[-R],
        kind="actuator",
        balance="electrical",
        depends_on=("current",),
        formula="i - bias for i",
        reference="D.-W. Chung and S.-K. Sul, IEEE Trans. Industry Applications 34(2), 1998",
        needs=BOTH,
        words=Words(
            headline="an offset of the current sensor",
            meaning="The current sensor has an offset, which shows in both balances.",
            hint="read the current with the drive switched off",
        ),
    )


def inverter_deadtime(setting: Setting) -> Iterator[Effect]:
    """The one effect of the family; tanh is written with exp(-2|x|), which never overflows.

    With exp in the numerator as well, expanding would turn exp(-2|x|)/(1 + exp(-2|x|)) into 1/(exp(2|x|) +
    1).
    """
    V = nonnegative("deadtime_u", "V", "voltage lost at high current", "V")
    i_0 = positive("deadtime_i", "A", "current within which it changes sign", "i_0")
    small = sp.exp(-2 * sp.Abs(current) / i_0.symbol)
    yield addition(
        "inverter_deadtime",
        [(V, Sgn(current) * (2 / (1 + small) - 1))],
        kind="actuator",
        balance="electrical",
        depends_on=("current", "voltage"),
        formula="V tanh(i/i_0)",
        reference="smoothed; S.-G. Jeong and M.-H. Park, IEEE Trans. Industrial Electronics 38(2), 1991",
        shapes=(Shape(i_0, 0.002 * setting.current_max, 0.2 * setting.current_max, "log", 6),),
        needs=BOTH,
        words=Words(
            headline="the voltage lost to the dead time of the inverter",
            meaning="Dead time of the inverter, drop across switches or brushes: a voltage drop with"
            " the sign of the current.",
            hint="currents that pass slowly through zero in both directions, with a locked rotor",
        ),
    )


def resistance_temperature(setting: Setting) -> Iterator[Effect]:
    """By the logged temperature, if there is one, or by the winding's own heat R i^2."""
    alpha = quantity(
        "resistance_alpha", "1/K", "relative rise of the winding's resistance per kelvin", letter="alpha"
    )
    # The temperature of the declared R is not in the rig file, so this is free.
    cold = quantity("resistance_r0", "1", "relative error of the declared resistance at T_0", letter="r_0")
    rise = nonnegative("resistance_rise", "1", "relative rise of the resistance over the log", "r")
    tau = positive("resistance_tau", "s", "thermal time constant of the winding", "tau")
    reference = (
        "standard form; thermal models: A. Boglietti et al., IEEE Trans. Industrial Electronics 56(3), 2009"
    )
    # R_20 (1 + 0.00393 (T - 20 degC)) rises by 0.43 % of itself per kelvin at 0 degC, by 0.25 % at 180 degC.
    copper = Plausible(
        100 * alpha.symbol,
        "%/K",
        0.25,
        0.43,
        "IEC 60028, International standard of resistance for copper, 1925: 0.393 %/K at 20 degC",
        "the temperature coefficient of the resistance",
        0.393,
        "copper's",
        above="the winding is not the only cause",
        below="a part of the resistance that is not copper, or a sensor that warms up more than the winding",
    )
    warming = Plausible(
        100 * rise.symbol,
        "%",
        0.0,
        63.0,
        "copper, IEC 60028, 1925, from 20 degC to 180 degC, class H of IEC 60085, 2007",
        "the rise of the resistance over the log",
        above="more than a winding survives",
    )
    words = Words(
        title="A winding resistance that rises with temperature",
        meaning="The winding's resistance rises with its temperature, logged or computed from R i^2.",
        hint="the locked rotor at a constant current: the voltage then shows only the resistance",
        kin=TEMPERATURE,
    )
    drop = R * current
    if setting.temperature_mid is not None:
        zero = reference_temperature("resistance", setting.temperature_mid)
        columns = [(alpha, drop * (temperature - zero.symbol)), (cold, drop)]
        yield addition(
            "resistance_temperature",
            columns if not setting.by_voltage else columns[:1],
            kind="actuator",
            balance="electrical",
            depends_on=("temperature", "current"),
            formula="R (1 + r_0 + alpha (T - T_0)) for R",
            reference=reference,
            definitions=(zero,),
            inputs=(v.temperature,),
            needs=(*BOTH, "temperature"),
            plausible=(copper,) if setting.by_voltage else (copper, resistance_off(cold.symbol)),
            words=words,
            headline="a winding resistance that rises with temperature",
        )
    warm, definitions, state = heating("resistance", setting, drop * current, tau.symbol)
    yield addition(
        "resistance_temperature",
        [(rise, drop * warm)],
        variant="hidden",
        kind="actuator",
        balance="electrical",
        depends_on=("current", "time"),
        formula="R (1 + r rise) for R, tau d(rise)/dt = R i^2/mean - rise",
        reference=reference,
        shapes=(Shape(tau, *thermal_times(setting), "log", 8),),
        definitions=definitions,
        states=(state,),
        plausible=(warming,),
        needs=BOTH,
        words=words,
        headline="a winding resistance that rises as the winding heats up",
    )


def armature_inductance(_: Setting) -> Iterator[Effect]:
    """The one effect of the family."""
    inductance = nonnegative("armature_L", "V s/A", "inductance of the armature", "L_a")
    slope, states = _current_slope("armature")
    yield addition(
        "armature_inductance",
        [(inductance, slope)],
        kind="actuator",
        balance="electrical",
        depends_on=("current",),
        formula="L di/dt",
        reference="standard form; armature circuit: W. Leonhard, Control of Electrical Drives, Springer",
        states=states,
        needs=BOTH,
        words=Words(
            headline="the inductance of the armature",
            meaning="The winding's inductance, which the paper neglects: a voltage proportional to"
            " the rate of change of the current.",
            hint="voltage steps with a locked rotor, finely sampled; a sensor's delay shows in the torque as"
            " well",
        ),
    )


CURRENT_DELAYS_S = (-0.02, 0.07)
"""Bounds of the delay of a current sensor."""


def sensor_delay(setting: Setting) -> Iterator[Effect]:
    """The one effect of the family; its derivatives are states.

    It requires a voltage as well as the current: otherwise the current in the balance would be the model's,
    with the noise of the acceleration.
    """
    if setting.by_voltage:
        return
    delay = quantity(
        "delay_d", "s", "delay of the measured current relative to angle and voltage", letter="d"
    )
    square = quantity(
        "delay_q", "s^2", "half the squared delay, minus the lag of the difference quotient", letter="q"
    )
    slope, states = _current_slope("delay")
    last = quantity(
        "delay_slope_last", "A/s", "rate of change of the current one time step ago", letter="i_old^'"
    )
    bend = quantity("delay_bend", "A/s^2", "second derivative of the current", letter="i^''")
    yield addition(
        "sensor_delay",
        [(delay, -v.k_i.symbol * slope), (square, -v.k_i.symbol * bend.symbol)],
        circuit=[R * slope, R * bend.symbol],
        kind="actuator",
        balance="electrical",
        bounds=(CURRENT_DELAYS_S, (None, None)),
        depends_on=("history", "current"),
        formula="i(t + d), to second order i + d di/dt + q d2i/dt2, for i",
        reference="standard form: second order of the Taylor series i(t + d) = i + d di/dt + q d2i/dt2",
        states=(
            *states,
            State(last, sp.Integer(0), slope),
            State(bend, sp.Integer(0), (slope - last.symbol) / dt),
        ),
        needs=BOTH,
        second_order=("inertia_mismatch",),
        words=Words(
            headline="a delay of the current sensor",
            meaning="The current is measured late, which shows in both balances in proportion to the rate of"
            " the current.",
            hint="a voltage step with a locked rotor: voltage and current should change together",
        ),
    )


def _current_slope(name: str) -> tuple[sp.Symbol, tuple[State, State]]:
    """Rate of change of the current [A/s] as a state, and the states it needs: the last difference quotient.

    It lags by one and a half time steps, and the current should be low-passed first.
    """
    last = quantity(f"{name}_last", "A", "current one time step ago", letter="i_old")
    slope = quantity(f"{name}_slope", "A/s", "rate of change of the current", letter="i^'")
    states = (State(last, sp.Integer(0), current), State(slope, sp.Integer(0), (current - last.symbol) / dt))
    return slope.symbol, states
