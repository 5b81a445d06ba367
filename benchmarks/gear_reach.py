"""Gear losses that build up over an angle after a reversal (mujoco#3528): judged on the bench and on the servo.

    python benchmarks/gear_reach.py DATA

The law is an effect of one's own, which competes with the library: `effects` below. On the bench it is planted, with
three angles; on the servo, whose gear losses are large, it is fitted in the place of those of the library. Writes its
table into docs/measured-rigs.md.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from math import copysign, exp
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import eccentric
from benchmarks.measured_logs import ROOT, measured_log
from eccentric.effects import Effect, Setting, Shape, Words
from eccentric.effects.forms import addition, dt, nonnegative, omega_m, positive, relaxation, speed
from eccentric.effects.loads import gear_loads
from eccentric.model import Load, Role
from eccentric.virtual_bench import PlantedEffect, random_scenario, simulate, write

PAGE = ROOT / "docs" / "measured-rigs.md"
MARK = re.compile(r"(<!-- gear reach -->\n).*?(<!-- end -->)", re.DOTALL)
SEED, MU, BACK = 901, 0.2, 0.4
ANGLES = (0.02, 0.1, 0.4)
"""At the link, over which the loss builds up on the bench [rad]."""
BESIDE = "resistance_temperature"
SERVO = {
    "in proportion, differing by direction": "gear_efficiency[transmitted]",
    "the same, with an angle of build-up": "gear_reach[transmitted]",
    "progressive": "load_dependent[progressive]",
    "progressive, with an angle of build-up": "gear_reach[transmitted,progressive]",
}


def effects(setting: Setting) -> Iterator[Effect]:
    """mu_avg |T| z + mu_dif T z^2 with z' = (w - |w| z)/h, by losses driving and back-driven; and progressive."""
    driving = nonnegative("reach_eta", "1", "loss of the gear per torque, driving", "eta")
    back = nonnegative("reach_back", "1", "loss of the gear per torque, back-driven", "eta_b")
    square = nonnegative("reach_eta_2", "1/(N m)", "growth of the loss with the torque", "eta_2")
    h = positive("reach_h", "rad", "motor angle over which the loss builds up", "h")
    for load in gear_loads("reach", setting):
        state = relaxation("reach_z", "part of the loss", speed * dt, h.symbol, omega_m, letter="z")
        size, z, torque = sp.Abs(load.torque), state.symbol, load.torque
        split = [(driving, (size * z + torque * z**2) / 2), (back, (size * z - torque * z**2) / 2)]
        for ending, columns in (
            ("", split),
            (",progressive", [(square, torque**2 * z), (driving, size * z)]),
        ):
            yield addition(
                "gear_reach",
                columns,
                variant=load.variant + ending,
                role=Role.COULOMB,
                load=Load.TRANSMITTED,
                depends_on=(load.variable, "history"),
                formula="mu_avg |T| z + mu_dif T z^2, z' = (w - |w| z)/h",
                reference="github.com/google-deepmind/mujoco, issue 3528",
                shapes=(*load.shapes, Shape(h, 2e-3 / setting.mu, 2.0 / setting.mu, "log", 8)),
                states=(state,),
                definitions=load.definitions,
                inputs=load.inputs,
                words=Words(headline="gear losses that build up over an angle after a reversal"),
            )


def planted(h: float) -> Callable[[], dict[str, Any]]:
    """The law on the bench's port, by gravity; h at the motor."""

    def start() -> dict[str, Any]:
        z, travel = 0.0, 0.0

        def torque(s: Any, a: float) -> float:
            nonlocal z, travel
            if s.w_mid:
                way = copysign(1.0, s.w_mid)
                z = way + (z - way) * exp(-(s.travel - travel) / h)
            travel = s.travel
            return 0.5 * a * ((1.0 + BACK) * abs(s.gravity) * z + (1.0 - BACK) * s.gravity * z * z)

        return {"torque": torque}

    return start


def on_the_bench(angle: float) -> list[str]:
    """What the library names on a log with the law, and held-out errors: without it, by the library, by the law."""
    like = random_scenario(np.random.default_rng(SEED), case="C2", mu=MU, log_type="traj",
                           effects=(("gear_efficiency", 0.12),), noise=0.004)  # fmt: skip
    effect = PlantedEffect(
        "gear_reach", "", like.effects[0].amplitude, planted(angle / MU), (), strength=0.12
    )
    with tempfile.TemporaryDirectory() as folder:
        log, rig, _ = write(simulate(replace(like, effects=(effect,))), Path(folder) / "log.csv.gz")
        found, own = (eccentric.diagnose(log, rig, effects=file) for file in (None, __file__))
    errors = [one.document["rmse_holdout_Nm"]["mechanical"]["extended"] for one in (found, own)]
    named = [one["id"] for one in own.document["effects"]]
    if not named or not named[0].startswith("gear_reach"):
        raise SystemExit(f"bench, {angle} rad: expected the law itself to be named, got {named}")
    plain = found.document["rmse_holdout_Nm"]["mechanical"]["paper"]
    ids = " and ".join(f"`{one['id']}`" for one in found.document["effects"]) or found.verdict
    return [f"bench, {angle:g} rad", ids, *(f"{1e3 * x:.3g}" for x in (plain, *errors))]


def on_the_servo(data: Path) -> list[list[str]]:
    """Held-out errors [mV] of the servo's log by each law of its gear, the winding's temperature beside it."""
    models = {label: f"c2_parallel+{effect}+{BESIDE}" for label, effect in SERVO.items()}
    found = eccentric.compare(*measured_log(data, "bam_xl330_pendulum"), list(models.values()), __file__)
    rmse = {one["name"]: one["rmse_holdout_V"] for one in found.document["models"]}
    return [[label, f"{1e3 * rmse[model]:.3g}"] for label, model in models.items()]


def main() -> None:
    """Judge, and write both tables into the page."""
    parser = argparse.ArgumentParser(description="Gear losses with an angle of build-up.")
    parser.add_argument("data", type=Path, help="folder of the measured sets")
    data = parser.parse_args().data
    bench = [["log", "the library names", "paper [mN m]", "library [mN m]", "the law itself [mN m]"]]
    bench += [["---", "---", "--:", "--:", "--:"], *map(on_the_bench, ANGLES)]
    servo = [["gear losses of the servo", "held out [mV]"], ["---", "--:"], *on_the_servo(data)]
    text = "\n".join("".join(f"| {' | '.join(row)} |\n" for row in rows) for rows in (bench, servo))
    page = PAGE.read_text(encoding="utf-8")
    if len(MARK.findall(page)) != 1:
        raise SystemExit(f"{PAGE}: expected one place for the tables, <!-- gear reach --> ... <!-- end -->")
    PAGE.write_text(MARK.sub(lambda m: m[1] + text + m[2], page), encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
