"""Delay of the current sensor."""

from __future__ import annotations

import sympy as sp

from eccentric.effects.effect import Effect, Evidence, Setting, Words
from eccentric.effects.forms import current_slope
from eccentric.model import Change, Quantity, State, Term, quantity
from eccentric.model import vocabulary as v

delay = quantity("delay_d", "s", "delay of the measured current relative to angle and voltage", letter="d")
square = quantity(
    "delay_q", "s^2", "half the squared delay, minus the lag of the difference quotient", letter="q"
)
BOUNDS = (-0.02, 0.07)
REFERENCE = "standard form: second order of the Taylor series i(t + d) = i + d di/dt + q d2i/dt2"
WORDS = Words(
    headline="a delay of the current sensor",
    meaning=(
        "The current is measured late, which shows in both balances in proportion to the rate of the current."
    ),
    hint="a voltage step with a locked rotor: voltage and current should change together",
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The one effect of the family; its derivatives are states.

    It requires a voltage as well as the current: otherwise the current in the balance would be the model's,
    with the noise of the acceleration.
    """
    if setting.by_voltage:
        return ()
    slope, states = current_slope("delay")
    last = quantity(
        "delay_slope_last", "A/s", "rate of change of the current one time step ago", letter="i_old^'"
    )
    bend = quantity("delay_bend", "A/s^2", "second derivative of the current", letter="i^''")
    states = (
        *states,
        State(last, sp.Integer(0), slope),
        State(bend, sp.Integer(0), (slope - last.symbol) / v.dt.symbol),
    )
    columns = ((delay, slope, BOUNDS), (square, bend.symbol, (None, None)))
    terms = {
        "mechanical": tuple(_term(q, -v.k_i.symbol * x, b) for q, x, b in columns),
        "electrical": tuple(_term(q, v.R.symbol * x, b) for q, x, b in columns),
    }
    return (
        Effect(
            family="sensor_delay",
            balance="electrical",
            formula="i(t + d), to second order i + d di/dt + q d2i/dt2, for i",
            reference=REFERENCE,
            change=Change(terms, states=states),
            evidence=Evidence(
                depends_on=("history", "current"),
                needs=("current", "voltage"),
                second_order=("inertia_mismatch",),
            ),
            coefficients=(delay, square),
            words=WORDS,
        ),
    )


def _term(q: Quantity, basis: sp.Expr, bounds: tuple[float | None, float | None]) -> Term:
    return Term(q.name, "actuator", q.symbol, basis, REFERENCE, bounds)
