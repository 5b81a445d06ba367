"""Conditions on the parameters of a model, beside the sign of each: when a time step has one solution."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from eccentric.emission.program.program import Condition, Routine
from eccentric.model import Model, levels
from eccentric.model import vocabulary as v


def stepped(routines: Iterable[Routine]) -> frozenset[str]:
    """The names of those that solve for a motion, from a torque."""
    return frozenset(r.name for r in routines if any(x.quantity.name == v.torque.name for x in r.inputs))


def conditions(model: Model) -> tuple[Condition, ...]:
    """Those of dry friction that follows loads with the acceleration in them, such as the transmitted torque.

    At rest such friction takes a share of an acceleration. Where that is as large as the inertia, a time step
    has no solution or several. The shares of several loads add up: each condition has the sum up to its
    parameter, so that the first one that fails names the parameter with which the sum becomes too large. If
    the slope of a load depends on the state, as that of F_N of the rotating link, parameters alone decide
    nothing: `inertial_loss` evaluates it.
    """
    alpha, omega = v.alpha_m.symbol, v.omega_m.symbol
    if model.declares is not None:
        return ()
    terms = tuple(t for t in model.balance("mechanical").terms if t.kind == "friction")
    if not any(alpha in model.expand(t.value).free_symbols for t in terms):
        return ()
    found = levels(model, omega, terms)

    def expanded(e: sp.Expr) -> sp.Expr:
        for a in reversed(found.definitions):
            e = e.xreplace({a.target: a.value})
        return model.expand(e)

    place = {q.symbol: k for k, q in enumerate(model.parameters)}
    listed: dict[sp.Expr, Condition] = {}
    for level in (found.forward.dry, found.backward.dry):
        # A level that is cut at 0 has the slope of what is cut.
        dry = sp.expand(
            level.replace(sp.Max, lambda *x: sp.Add(*x) if 0 in x and len(x) == 2 else sp.Max(*x))
        )
        shares: list[list[tuple[sp.Symbol, sp.Expr]]] = []  # of each load, by its sign
        for load in sorted(dry.free_symbols - model.parameter_symbols, key=str):
            gain = sp.diff(expanded(load), alpha)
            if gain == 0 or not gain.free_symbols <= model.parameter_symbols:
                continue
            share = []
            for sign in (1, -1):
                slope = sp.diff(dry.xreplace({sp.Abs(load): sign * load}), load).subs({omega: 0, load: 0})
                own = sorted(slope.free_symbols & place.keys(), key=place.__getitem__)
                if own and slope.free_symbols <= model.parameter_symbols:
                    share.append((own[-1], sp.Abs(slope * gain)))
            shares += [share] if share else []
        sums: Iterable[sp.Expr] = [sp.Integer(0)]
        for share in sorted(shares, key=lambda share: place[share[0][0]]):
            added = {before + loss: last for before in sums for last, loss in share}
            sums = added.keys()
            for loss, last in added.items():
                listed.setdefault(loss, Condition(last, loss, model.inertia))
    return tuple(listed.values())
