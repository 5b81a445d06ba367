"""What a log offers to a base model before the search: the drive, both balances, effects and candidates."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from eccentric.core import InputError
from eccentric.diagnosis.limits import LEAST_DIFFERENCE, LEAST_OTHERS, LEAST_SHARE_OF_LOAD
from eccentric.diagnosis.search import (
    LEAST_PERIODS,
    Candidate,
    balances_of,
    candidate_of,
    fitted_variants,
    instruments_of,
    offered,
    setting_of,
)
from eccentric.effects import FAMILIES, Effect, Setting
from eccentric.identification import (
    BalanceDesign,
    FitData,
    Signals,
    drive_of,
    fit_data_of,
    loaded_model,
    with_model_current,
)
from eccentric.model import TURNING, AxisKind, Model
from eccentric.model import vocabulary as v
from eccentric.signals import LEAST_HELD_OUT, Channels, require_rows


@dataclass(frozen=True)
class SearchRequest:
    """Restrictions of the search, each a list of families or ids of effects.

    including: part of the model from the start; without: not offered; only: nothing else is offered (all if
    empty); empirical: whether a term without a cause is added to what was found.
    """

    including: tuple[str, ...] = ()
    without: tuple[str, ...] = ()
    only: tuple[str, ...] = ()
    empirical: bool = False

    def restricted(self, offered: Sequence[Effect]) -> tuple[Effect, ...]:
        """The effects that the search may choose from.

        Raises:
            InputError: a name is neither a family nor the id of an effect; or nothing remains of `only`.
        """
        for word, names in (("without", self.without), ("only", self.only)):
            for name in names:
                _require_known(word, name, offered)
        left = tuple(
            effect
            for effect in offered
            if not _named(effect, self.without) and (not self.only or _named(effect, self.only))
        )
        if self.only and not left:
            raise InputError(
                "only",
                "a family that this log can show",
                f"{', '.join(self.only)}; it can show {', '.join(_families(offered))}",
            )
        return left


def members(word: str, name: str, offered: Sequence[Effect]) -> list[Effect]:
    """The effects that a name stands for: a family, or one id.

    Raises:
        InputError: there is no such effect, or this log cannot show it; `word` begins the message.
    """
    _require_known(word, name, offered)
    found = [effect for effect in offered if _named(effect, (name,))]
    if not found:
        raise InputError(
            word, "an effect that this log can show", f"{name}; it can show {', '.join(_families(offered))}"
        )
    return found


def _named(effect: Effect, names: Iterable[str]) -> bool:
    return any(name in (effect.id, effect.family) for name in names)


def _families(offered: Iterable[Effect]) -> list[str]:
    return list(dict.fromkeys(effect.family for effect in offered))


def _require_known(word: str, name: str, offered: Sequence[Effect]) -> None:
    families = dict.fromkeys([*FAMILIES, *_families(offered)])
    ids = [effect.id for effect in offered]
    if name in families or name in ids:
        return
    family = name.partition("[")[0]
    own = [effect_id for effect_id in ids if effect_id.partition("[")[0] == family]
    if own:
        raise InputError(word, "an effect", f"{name}; of {family} there are {', '.join(own)}")
    if family in families:
        return
    near = difflib.get_close_matches(family, families, 1)
    hint = f" (did you mean {near[0]}?)" if near else ""
    raise InputError(word, "an effect", f"{name}{hint}; there are {', '.join(families)}")


Array = np.ndarray


@dataclass(frozen=True)
class Stage:
    """A log with a base model, ready for a search or a fit."""

    plain: Model  # the base model as given
    base: Model  # with the constant load of the rig
    data: FitData
    balances: Sequence[BalanceDesign]  # residuals of the training part
    noise: dict[str, float]  # of a window, by balance
    friction: Array  # coefficients of a first fit
    instruments: Signals | None  # signals without the noise of the target, None where there are none
    setting: Setting
    differing: tuple[str, ...]  # warnings of runs unlike the others
    offered: tuple[Effect, ...]  # the effects of the library that the log can show

    def candidates(self, effects: Sequence[Effect]) -> list[Candidate]:
        """The effects as the search compares them."""
        # With a voltage alone, effects of the armature show in the mechanical balance.
        drive = self.data.drive
        only = "mechanical" if drive.by_voltage else None
        current = drive.slow_current() if drive.measured_twice else None
        given = self.base, self.data.signals, self.friction, only, current, self.instruments
        parts, seen = drive.channels.rig.parts, [effect.periods_seen(self.setting) for effect in effects]
        return [
            replace(candidate_of(e, *given), possible=not e.lacks(parts) and x >= LEAST_PERIODS, periods=x)
            for e, x in zip(effects, seen, strict=True)
        ]

    def with_friction(self, friction: Array, effects: Path | None) -> Stage:
        """The stage with effects that use this friction: coefficients in the order of the balance's columns.

        effects: a file of the user's own. What the drive needs in all is still that of the first fit, since
        friction beside an effect is not all of it.
        """
        own = dict(zip(self.setting.friction, map(float, friction), strict=False))
        setting = replace(self.setting, friction=own)
        names = {balance.name for balance in self.balances}
        rig = self.data.drive.channels.rig
        return replace(
            self, setting=setting, offered=offered(setting, effects, self.data, rig, self.base, names)
        )

    def chosen(
        self, word: str, names: Sequence[str]
    ) -> list[tuple[Effect, dict[str, float], dict[str, float]]]:
        """For each name its best effect on the training part: values of its shapes, and its coefficients.

        Raises:
            InputError: a name is unknown, given twice, or nothing in the log determines it.
        """
        if twice := [name for k, name in enumerate(names) if name in names[:k]]:
            raise InputError(word, "each effect", f"{twice[0]} twice", why="only once")
        pools = [members(word, name, self.offered) for name in names]
        found = fitted_variants(self.balances, [self.candidates(pool) for pool in pools], self.noise)
        chosen = []
        for name, pool, one in zip(names, pools, found, strict=True):
            if one is None:
                raise InputError(word, "an effect that this log determines", name)
            variant, coefficients = one
            effect = next(e for e in pool if e.id == variant.candidate.id)
            own = dict(zip((q.name for q in effect.coefficients), coefficients, strict=False))
            chosen.append((effect, dict(variant.values), own))
        return chosen


def stage_of(channels: Channels, plain: Model, effects: Path | None, where: str) -> Stage:
    """The stage of a log; `effects` is a file of the user's own, `where` names the log in messages.

    Raises:
        InputError: the model has a tilt in a level plane, hidden states, or what is found from the current;
            the rig lacks what it needs; or there are too few rows to hold out.
    """
    _require_supported(plain, channels)
    rig = channels.rig
    drive = drive_of(channels, rig, plain)
    base = loaded_model(plain, rig)
    return staged(plain, base, fit_data_of(drive, rig, base), effects, where)


def staged(plain: Model, base: Model, data: FitData, effects: Path | None, where: str) -> Stage:
    """The stage of a log whose drive is known already; arguments as in `Stage` and `stage_of`.

    Raises:
        InputError: there are too few rows to fit or to hold out.
    """
    drive, rig = data.drive, data.drive.channels.rig
    require_rows(data.rows, "score", LEAST_HELD_OUT, where)
    balances, noise = balances_of(data, rig, base)
    mechanical = next(balance for balance in balances if balance.name == "mechanical")
    friction = mechanical.solve().values
    # As for a fit: with fewer rows than this for each coefficient, chance decides.
    require_rows(data.rows, "train", data.rows.per_coefficient * len(friction), where)
    if not drive.measured_twice:
        data = with_model_current(data, base, friction)
    setting = setting_of(data, base, friction)
    names = {balance.name for balance in balances}
    every = offered(setting, effects, data, rig, base, names)
    instruments = instruments_of(data, base, friction)
    differing = runs_that_differ(
        mechanical, drive.torque(), friction, drive.channels.time.run_names, rig.axis
    )
    return Stage(plain, base, data, balances, noise, friction, instruments, setting, differing, every)


def _require_supported(model: Model, channels: Channels) -> None:
    rig, name = channels.rig, model.name
    own, states = rig.axis.term("the paper's"), ", ".join(state.quantity.name for state in model.states)
    mechanical = model.balance("mechanical")
    used = model.expand(mechanical.sum_of("friction", "conservative", "actuator")).free_symbols
    if model.tilted and rig.case == "C1":
        level = f"got case C1; {rig.model} is its model"
        raise InputError(name, problem=f"diagnose requires a plane of motion that is not level, {level}")
    if states:
        raise InputError(
            name,
            problem=f"diagnose requires a model without hidden states, got one with {states}"
            " (diagnose adds the effect that has them itself)",
        )
    if any("electrical" in extension.change.terms for extension in model.extensions):
        raise InputError(
            name,
            problem=f"diagnose requires a model with {own} armature, got one extended by an electrical"
            " effect (diagnose adds it itself)",
        )
    if {v.i.symbol, v.u.symbol} & used:
        raise InputError(
            name,
            problem="diagnose requires a model without effects of current or voltage, got one"
            " with some (diagnose adds them itself)",
        )
    if v.temperature.symbol in used and channels.temperature is None:
        raise InputError(name, problem="diagnose requires a temperature in the log, got none")


def runs_that_differ(
    balance: BalanceDesign, torque: Array, friction: Array, names: Sequence[str], axis: AxisKind = TURNING
) -> tuple[str, ...]:
    """A warning for each run of the training part whose friction or gain is unlike that of all the others.

    In each run the drive torque is a factor on the known load (inertia and gravity) plus a factor on the
    friction of the fit of all runs. A factor outside the range of the others by more than this range, and by
    a tenth, is another one.

    Args:
        balance: the mechanical one, its target being torque minus load.
        torque: drive torque on the samples (n,) [N m].
        friction: coefficients of its base, fitted on all runs.
        names: of the runs, by their numbers.
        axis: of the drive.
    """
    rows = balance.rows
    own, pooled = rows.mean(torque), balance.columns @ friction
    load = own - balance.target
    loaded = np.std(load) > LEAST_SHARE_OF_LOAD * np.std(own)
    columns = np.column_stack([pooled, load] if loaded else [pooled])
    target = own if loaded else balance.target
    runs = np.unique(rows.run)
    if len(runs) <= LEAST_OTHERS:
        return ()
    factors = np.array(
        [np.linalg.lstsq(columns[rows.run == run], target[rows.run == run], rcond=None)[0] for run in runs]
    )
    what = (("friction", "friction"), ("gain of the drive", f"drive {axis.term('torque')} for the same load"))
    return tuple(
        f"run {names[int(runs[k])]}: its {name} differs from that of the other runs: {meaning} {value:.3g}"
        f" times that of all runs together, {low:.3g} to {high:.3g} times in the others; leave it out,"
        " or diagnose it alone"
        for (name, meaning), column in zip(what, factors.T, strict=False)
        for k, value, low, high in _outside(column)
    )


def _outside(factors: Array) -> Iterator[tuple[int, float, float, float]]:
    """(place, factor, range of the others) of each that is far outside."""
    for k, value in enumerate(factors):
        others = np.delete(factors, k)
        low, high = float(others.min()), float(others.max())
        if max(value - high, low - value) > max(high - low, LEAST_DIFFERENCE * abs(float(np.median(others)))):
            yield k, float(value), low, high
