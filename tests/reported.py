"""A made-up report: 0.03 sin(2 theta_l) against the motion, which only the extended model has."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np

from eccentric.presentation.html.arrays import BalanceResiduals, Channel, ResidualRows
from eccentric.presentation.html.data import (
    AddedEffect,
    CandidateRow,
    Conclusion,
    ExtendedModel,
    Fact,
    Formula,
    Gain,
    HeldOutErrors,
    LogQuality,
    Parameter,
    ReportData,
    SearchTable,
    Source,
)
from eccentric.signals import Finding

HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)>&\"'$$x$$"
TURN = 2.0 * np.pi
ADOPTED = CandidateRow(
    "wobble[n=2]", "wobble", "mechanical", 0.002, 0.97, True, "s sin(2 theta_l) sgn w", ("twin",)
)
RIVAL = CandidateRow("dent", "dent", "mechanical", 0.004, 0.03, False, "A exp(-x^2)", hint="whole turns")


def rows_of(n: int, runs: int = 1) -> ResidualRows:
    """Rows at 250 Hz whose speed changes sign every 2 s; two tenths of every run are held out."""
    per = n // runs
    t = np.concatenate([np.arange(per) / 250.0] * runs)
    run = np.repeat(np.arange(runs), per)
    omega = np.where(np.floor(t / 2.0) % 2 == 0, 1.0, -1.0) * (20.0 + 10.0 * np.sin(0.7 * t))
    theta_l = 0.2 * np.cumsum(omega) / 250.0
    held = np.floor(np.arange(per * runs) / max(per // 10, 1)) % 5 == 2
    channels = (
        Channel("velocity", "motor velocity", "rad/s", omega),
        Channel("link_angle", "link angle", "rad", theta_l, TURN),
        Channel("current", "current", "A", 2.0 * np.sign(omega) + 0.01 * omega),
        Channel("time", "time in the run", "s", t),
    )
    return ResidualRows(t, run, tuple(f"run {k + 1}" for k in range(runs)), ~held, held, channels)


def balance_of(rows: ResidualRows, unit: str = "N m", effect: bool = True) -> BalanceResiduals:
    """The mechanical balance of such rows."""
    omega, angle = (rows.channels[k].values for k in (0, 1))
    noise = np.random.default_rng(5).normal(0.0, 0.004, len(omega))
    added = 0.03 * np.sin(2.0 * angle) * np.sign(omega)
    known = 0.1 * np.sign(omega) + 0.002 * omega
    paper = noise + added
    held = rows.held_out
    rmse = {"linear": 0.04, "paper": float(np.sqrt(np.mean(paper[held] ** 2)))}
    rmse["extended"] = float(np.sqrt(np.mean(noise[held] ** 2))) if effect else rmse["paper"]
    extended = noise if effect else None
    return BalanceResiduals(
        "mechanical", "friction", unit, rows, paper, extended, 1.3 * paper, known + paper, rmse, 0.004
    )


def sample(n: int = 5000, runs: int = 1, text: str = "", unit: str = "N m", **changes: Any) -> ReportData:
    """The report of n rows; `text` is put into every string that may come from a log, a rig or a user."""
    rows = rows_of(n, runs)
    if text:
        channels = tuple(replace(c, label=c.label + text) for c in rows.channels)
        rows = replace(rows, run_names=tuple(name + text for name in rows.run_names), channels=channels)
    data = ReportData(
        source=Source(
            logs=(f"made{text}.csv",),
            rig=f"rig{text}.toml",
            model="c2_parallel",
            model_title=f"Gravity parallel{text}",
            command=f"eccentric diagnose made.csv{text}",
            version="0",
        ),
        conclusion=Conclusion(
            verdict="named",
            sentence=f"Missing: wobble[n=2]{text}.",
            depends_on=("link_angle", "direction"),
            closest="",
            next_measurement=f"Turn slowly.{text}",
        ),
        errors=HeldOutErrors(
            holdout=f"two of ten{text}",
            balances=(balance_of(rows, unit),),
            gain=Gain("mechanical", 85.0, (80.0, 90.0)),
            further=(),
        ),
        search=SearchTable(
            candidates=(
                replace(ADOPTED, formula=ADOPTED.formula + text),
                replace(RIVAL, hint=f"turns{text}", headline=f"a dent{text}"),
            ),
            tied=(),
            chance={"mechanical": (900.0, 16.0)},
        ),
        extended=ExtendedModel(
            effects=(
                AddedEffect(
                    "wobble[n=2]",
                    "mechanical",
                    f"A bent shaft{text}.",
                    f"s sin{text}",
                    f"someone{text}",
                    "12.0 % of the friction",
                    f"a shaft that wobbles{text}",
                    follows=(rows.channels[1],),
                ),
            ),
            parameters=(
                Parameter("wobble_s2", f"sine{text}", unit, 0.03, "effect", 2e-5, (0.0299, 0.0301)),
                Parameter("C_m", "Coulomb friction", unit, 0.0, "friction", 0.001, (0.0, 0.002), "lower"),
                Parameter("M", f"mass{text}", "kg", 0.5, "rig"),
            ),
            equations=(Formula("<math display='block'><mi>f</mi></math>", f"friction{text}"),),
        ),
        log=LogQuality(
            facts=(Fact(f"sampling{text}", f"250 Hz{text}", f"even{text}"),),
            findings=(Finding("saturation", f"current{text}", f"It is cut off.{text}", 12, "warning"),),
            warnings=(f"a column is odd{text}",),
        ),
        files=((f"model{text}.py", f"the model{text}"),),
    )
    return changed(data, **changes)


def changed(data: ReportData, **changes: Any) -> ReportData:
    """The report with other fields, each given by its own name, whichever part of the report it is in."""
    for part in (field.name for field in fields(data) if field.name != "files"):
        old = getattr(data, part)
        own = {name: value for name, value in changes.items() if hasattr(old, name)}
        data = replace(data, **{part: replace(old, **own)})
    return data


def nothing_missing(data: ReportData) -> ReportData:
    """The same log with nothing adopted."""
    (balance,) = data.errors.balances
    plain = replace(balance, extended=None, rmse={**balance.rmse, "extended": balance.rmse["paper"]})
    others = tuple(replace(c, adopted=False) for c in data.search.candidates)
    return changed(
        data, verdict="nothing_missing", balances=(plain,), gain=None, effects=(), candidates=others,
        sentence="Nothing is missing.", next_measurement="",
    )  # fmt: skip
