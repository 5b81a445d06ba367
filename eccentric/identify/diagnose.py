"""Close the loop: fit the paper's model, attribute what is left, extend the model, measure the error again.

The stages, each with what it hands on:

    signals     channels -> smooth inputs of expressions, known parameters      (`signals_of`)
    balances    -> both residuals as linear designs on the training part         (`balances_of`)
    attribute   -> verdict and adopted effects                                    (`verdict.attribute`)
    extend      -> Model', its coefficients fitted on its own emitted module      (`refit`)
    score       -> held-out RMSE before and after; the held-out part is opened here and nowhere else
                   (the zero-phase low pass carries some 20 ms across its borders)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from eccentric.effects import Setting, library, load_effects
from eccentric.effects.effect import Effect
from eccentric.errors import InputError
from eccentric.identify.adapter import Signals, base_columns, candidate, compiled
from eccentric.identify.channels import Channels, read_channels
from eccentric.identify.filters import low_pass
from eccentric.identify.least_squares import bounded
from eccentric.identify.nulltest import sensor_noise
from eccentric.identify.refit import Refit, linear_friction, refit
from eccentric.identify.residual import Balance, make_balance, make_windows
from eccentric.identify.rig import Rig, read_rig
from eccentric.identify.uncertainty import improvement
from eccentric.identify.verdict import Attribution, attribute
from eccentric.model import Model, load_model, regressor

__all__ = ["Diagnosis", "diagnose"]

Array = np.ndarray
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Diagnosis:
    """What a diagnosis found.

    Attributes:
        logs, rig_name: file names; model: name or path of the base model.
        base: the paper's model; its fit is `paper`.
        setting: what the library of effects was made for.
        own: effects of the user's own file, if any.
        attribution: verdict, candidates, dependence.
        effects: adopted effects with their parameters, in order of adoption; empty without a name.
        paper, extended: fits of both models on the training part; the same object if nothing was adopted.
        rmse: balance -> model ("linear", "paper", "extended") -> held-out RMSE [N m].
        percent, interval: improvement of `balance` on the held-out part and its 95 % interval.
        noise_floor: RMS of the sensors' noise in the mechanical balance [N m].
    """

    logs: tuple[str, ...]
    rig_name: str
    model: str
    channels: Channels
    rig: Rig
    base: Model
    setting: Setting
    own: Path | None
    attribution: Attribution
    effects: tuple[tuple[Effect, dict[str, float]], ...]
    paper: Refit
    extended: Refit
    rmse: dict[str, dict[str, float]]
    balance: str
    percent: float
    interval: tuple[float, float]
    noise_floor: float


def diagnose(
    logs: Sequence[str | Path],
    rig_path: str | Path,
    model: str | None = None,
    effects: Path | None = None,
    tell: Progress | None = None,
) -> Diagnosis:
    """Diagnose one rig's logs.

    Args:
        logs: paths of logs of the same rig.
        rig_path: the rig file.
        model: name or path of the base model; by the rig's case if None.
        effects: a file with effects of the user's own.
        tell: told one line per stage.

    Raises:
        InputError: bad input, or a rig whose drive torque is not measured.
    """
    tell = tell or (lambda _: None)
    rig = read_rig(rig_path)
    if rig.estimate:
        raise InputError(
            f'{Path(rig_path).name}: {", ".join(sorted(rig.estimate))} = "estimate": required a number for'
            " diagnose; `eccentric fit` finds it"
        )
    channels = read_channels(logs, rig)
    base = load_model(model or rig.model)
    if "phi" in {q.name for q in base.parameters}:
        raise InputError(f"{base.name}: required a model of case C1 or C2 for diagnose, got one with a tilt")
    tell(f"{channels.counts['used']} rows used of {channels.rows_read}")
    signals = signals_of(channels, rig, base)
    balances, noise = balances_of(channels, base, signals)
    mechanical = next(b for b in balances if b.name == "mechanical")
    none = np.full(len(mechanical.lower), np.inf)
    friction = bounded(mechanical.base, mechanical.target, mechanical.lower, none).coefficients
    setting = setting_of(channels, base, signals, friction)
    offered = [*library(setting), *(load_effects(effects, setting) if effects else ())]
    names = {balance.name for balance in balances}
    offered = [e for e in offered if set(e.needs) <= setting.channels and e.balance in names]
    offered = [e for e in offered if _known(e, base, signals)]
    by_id = {effect.id: effect for effect in offered}
    candidates = [candidate(effect, base, signals, friction) for effect in offered]
    smooth = _smooth_channels(channels, signals)
    found = attribute(
        balances, smooth, candidates, signals.known["mu"], gravity_of(base, signals), noise, progress=tell
    )
    adopted = [(by_id[a.term.candidate.id], dict(a.term.shape)) for a in found.adopted]
    if found.verdict in {"unexplained", "nothing_missing"}:
        adopted = []
    tell("refitting on the emitted module")
    paper = refit(base, (), channels, signals, bounds=False)
    extended = refit(base, tuple(adopted), channels, signals) if adopted else paper
    rmse = {
        "mechanical": {
            "linear": linear_friction(paper, channels),
            "paper": paper.held_out("mechanical"),
            "extended": extended.held_out("mechanical"),
        }
    }
    if "electrical" in {b.name for b in balances}:
        rmse["electrical"] = {
            m: r.held_out("electrical") for m, r in (("paper", paper), ("extended", extended))
        }
    balance = found.adopted[0].balance if adopted else "mechanical"
    rows = channels.score_rows
    percent, interval = (
        improvement(paper.residuals[balance][rows], extended.residuals[balance][rows])
        if adopted
        else (0.0, (0.0, 0.0))
    )
    named = extended.effects if found.verdict == "named" else ()
    return Diagnosis(
        logs=tuple(Path(log).name for log in logs),
        rig_name=Path(rig_path).name,
        model=model or rig.model,
        channels=channels,
        rig=rig,
        base=base,
        setting=setting,
        own=effects,
        attribution=found,
        effects=named,
        paper=paper,
        extended=extended,
        rmse=rmse,
        balance=balance,
        percent=percent,
        interval=interval,
        noise_floor=_noise(channels, signals.known),
    )


def signals_of(channels: Channels, rig: Rig, model: Model) -> Signals:
    """Smooth signals that expressions are evaluated on.

    The current that effects depend on is (u - k_e omega_m)/R where there is a voltage: measured current on
    both sides of the balance would explain its own noise.
    """
    needed = {q.name for q in model.parameters} - {c.name for c in regressor(model)}
    friction = {"B_m", "C_m", "B_lT", "C_lT", "B_lN", "C_lN"}
    needed = {name for name in needed if name.removesuffix("_pos").removesuffix("_neg") not in friction}
    # Only the armature needs these, and without a voltage nothing is said of it.
    armature = {"R", "k_e"} if _voltage(channels) is None else set()
    # A torque signal is a current with k_i = 1 N m/A.
    needed -= {"k_i"} if channels.drive == "torque" else set()
    known = {
        name: rig.value(name)
        for name in sorted(needed)
        if name != "F_T" and (name not in armature or name in rig.known)
    }
    if "F_T" in needed:
        known["F_T"] = rig.known.get("F_T", known.get("M_l", 0.0) * known["g"])
    if channels.drive == "torque":
        known["k_i"] = 1.0
    values = {
        "theta_m": channels.theta_m,
        "omega_m": channels.omega_m,
        "alpha_m": channels.alpha_m,
        "t": elapsed(channels),
    }
    drive, voltage = _drive_current(channels), _voltage(channels)
    if voltage is not None:
        values["u"] = _smoothed(channels, voltage)
        values["i"] = (values["u"] - known["k_e"] * channels.omega_m) / known["R"]
    else:
        values["i"] = _smoothed(channels, drive)
    if channels.temperature is not None:
        values["temperature"] = channels.temperature
    starts = tuple(int(k) for k in np.flatnonzero(np.r_[True, np.diff(channels.segment) != 0]))
    dt = np.diff(channels.t, append=channels.t[-1] + np.median(np.diff(channels.t)))
    dt[[start - 1 for start in starts if start > 0]] = float(np.median(dt))
    return Signals(values, dt, starts, known)


def balances_of(channels: Channels, model: Model, signals: Signals) -> tuple[list[Balance], dict[str, float]]:
    """The balances of the training part, and what white noise leaves in a row of each [N m]."""
    known = signals.known
    drive = known["k_i"] * _drive_current(channels)
    inertia = known["J_m"] + known["mu"] ** 2 * known["J_l"]
    target = drive - inertia * channels.alpha_m - gravity_of(model, signals)
    columns = regressor(model)
    windows = make_windows(channels.t, channels.fit_rows, channels.segment)
    lower = np.array([-np.inf if c.bounds[0] is None else c.bounds[0] for c in columns])
    names = tuple(c.name for c in columns)
    balances = [
        make_balance("mechanical", windows, target, base_columns(model, signals), names, lower, target)
    ]
    unseen = np.where(channels.held_out, np.nan, drive)
    noise = {"mechanical": sensor_noise(unseen, windows)}
    voltage = _voltage(channels)
    if voltage is not None:
        clear = ~channels.held_out & _away_from_ends(channels)
        every = make_windows(channels.t, clear, channels.segment)
        residual = known["k_i"] / known["R"] * (voltage - known["k_e"] * channels.omega_m) - drive
        empty = np.empty((len(drive), 0))
        balances.append(make_balance("electrical", every, residual, empty, (), np.empty(0), target))
        noise["electrical"] = sensor_noise(unseen, every)
    return balances, noise


def gravity_of(model: Model, signals: Signals) -> Array:
    """Gravity torque of the model on the motor side (samples,) [N m]."""
    return compiled(model, model.balance("mechanical").sum_of("gravity"), signals)({}, {})


def setting_of(channels: Channels, model: Model, signals: Signals, friction: Array) -> Setting:
    """What the ranges of the library depend on, from the moving training rows."""
    rows = channels.fit_rows
    speed = np.abs(channels.omega_m[rows])
    current = signals.values["i"]
    loss = np.mean((base_columns(model, signals) @ friction)[rows] * channels.omega_m[rows])
    if "R" in signals.known and channels.drive == "current":
        loss += np.mean(signals.known["R"] * current[rows] ** 2)
    warm = channels.temperature
    present = {"current"}
    present |= {"voltage"} if _voltage(channels) is not None else set()
    present |= {"temperature"} if warm is not None else set()
    highest = float(np.quantile(speed, 0.99))
    return Setting(
        case="C1" if "theta_m" not in {q.name for q in model.inputs} else "C2",
        mu=signals.known["mu"],
        known=dict(signals.known),
        w_min=max(0.5 * float(np.quantile(speed, 0.002)), highest / 400),
        w_max=highest,
        current_max=float(np.quantile(np.abs(current[rows]), 0.995)),
        duration_s=float(np.max(elapsed(channels))),
        mean_loss_W=max(float(loss), 1e-12),
        temperature_mid=None if warm is None else float(np.median(warm[rows])),
        channels=frozenset(present),
        friction={c.name: float(x) for c, x in zip(regressor(model), friction, strict=True)},
    )


class _Smooth:
    """Channels as candidates and smooth terms take them."""

    def __init__(self, **values: Array | None) -> None:
        self.__dict__.update(values)


def _smooth_channels(channels: Channels, signals: Signals) -> _Smooth:
    return _Smooth(
        t=channels.t,
        theta_m=channels.theta_m,
        omega_m=channels.omega_m,
        alpha_m=channels.alpha_m,
        current=_smoothed(channels, _drive_current(channels)),
        voltage=signals.values.get("u"),
        temperature=channels.temperature,
    )


def elapsed(channels: Channels) -> Array:
    """Time since the start of each row's run [s]."""
    start = np.array([channels.t[channels.run == run][0] for run in range(int(channels.run.max()) + 1)])
    return channels.t - start[channels.run]


def _known(effect: Effect, base: Model, signals: Signals) -> bool:
    """Whether the rig knows every parameter of the base model that the effect uses."""
    unknown = {q.name for q in base.parameters} - set(signals.known)
    unknown -= {str(t.coefficient) for t in base.balance("mechanical").terms}
    used = set().union(
        *(d.value.free_symbols for d in effect.definitions),
        *(s.update.free_symbols for s in effect.states),
        *(t.basis.free_symbols for terms in effect.terms.values() for t in terms),
    )
    return not unknown & {s.name for s in used}


def _voltage(channels: Channels) -> Array | None:
    """The armature voltage, where there is a current to go with it."""
    return channels.voltage if channels.drive == "current" else None


def _drive_current(channels: Channels) -> Array:
    """The measured drive: current, or a torque signal as a current with k_i = 1 N m/A."""
    if channels.drive == "current" and channels.current is not None:
        return channels.current
    if channels.drive == "torque" and channels.torque is not None:
        return channels.torque
    raise InputError(
        "diagnose: required a measured drive torque (a current channel with k_i, or a torque channel);"
        f" this rig is driven by {channels.drive} alone: use `eccentric fit`"
    )


def _smoothed(channels: Channels, x: Array) -> Array:
    """The 25 Hz zero-phase low pass of a channel, stretch by stretch."""
    out = np.array(x, float)
    for segment in np.unique(channels.segment):
        rows = channels.segment == segment
        if np.count_nonzero(rows) > 30:
            rate = 1.0 / float(np.median(np.diff(channels.t[rows])))
            passed = low_pass(out[rows], rate, 25.0)
            out[rows] = out[rows] if passed is None else passed
    return out


def _away_from_ends(channels: Channels) -> Array:
    """Rows half a second clear of the ends of every stretch: filters settle there."""
    clear = np.zeros(len(channels.t), bool)
    for segment in np.unique(channels.segment):
        rows = np.flatnonzero(channels.segment == segment)
        time = channels.t[rows]
        clear[rows] = (time > time[0] + 0.5) & (time < time[-1] - 0.5)
    return clear


def _noise(channels: Channels, known: Mapping[str, float]) -> float:
    """RMS of the drive torque's white noise per row, from its fourth differences."""
    joined = np.diff(channels.segment, 4) == 0
    difference = np.diff(known["k_i"] * _drive_current(channels), 4)[joined]
    return float(1.4826 * np.median(np.abs(difference - np.median(difference))) / np.sqrt(70.0))
