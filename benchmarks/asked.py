"""Every figure required of the emitted code and of the diagnosis: limits are typed here and nowhere else.

Tests and the page of benchmarks read them by their keys. Bounds of accuracy that headers print are those of
`eccentric.emission`, so that what is required is what is promised.
"""

from __future__ import annotations

from benchmarks.record import Asked
from eccentric.emission.program import accuracy

_FORCE = 5  # units in the last place
# Of a call: instructions and bytes on a Cortex-M4F in single precision, instructions on x86-64 on average.
_COST = {"torque": (95, 550, 85), "torque and gradient": (165, 750, 150)}
SURE = 0.9
"""Least probability of a name that counts as certain."""


def _accuracy(real: str) -> dict[str, Asked]:
    """F_N within 5 units at random states with Table 1; else what the headers state, with Table 1 and with any."""
    load = f"of rotating_link, {real}"
    stated = {
        "force": (f"F_N, steady models, {real}", accuracy.NORMAL_FORCE, "ULP"),
        "friction": (f"friction torque, {real}", accuracy.FRICTION_TORQUE, "ULP"),
        "gradient": (f"its gradient, {real}, of its greatest value at that speed", accuracy.GRADIENT, "eps"),
        "accelerated": (f"F_N {load}, of M L (w^2 + abs alpha) + b", accuracy.ACCELERATED_FORCE, "eps"),
    }
    more = {
        "accelerated friction": (f"friction torque {load}", accuracy.ACCELERATED_FRICTION, "eps"),
        "accelerated gradient": (f"its gradient {load}", accuracy.ACCELERATED_GRADIENT, "eps"),
    }
    any_ = {("accelerated force" if key == "accelerated" else key): one for key, one in stated.items()} | more
    return {
        **{
            f"{key} {real}": Asked(
                f"{what}, Table 1, random states",
                "at most",
                _FORCE if key == "force" else bound.table_1,
                unit,
            )
            for key, (what, bound, unit) in stated.items()
        },
        **{
            f"any {key} {real}": Asked(f"{what}, any parameters", "at most", bound.anywhere, unit)
            for key, (what, bound, unit) in any_.items()
        },
        f"nan {real}": Asked(f"NaN, all with Table 1, {real}", "at most", 0),
    }


CODE: dict[str, Asked] = {
    **_accuracy("float"),
    **_accuracy("double"),
    **{
        f"{kind} {what}": Asked(f"Cortex-M4F, {what}, {kind}", "at most", cost[k])
        for k, kind in enumerate(("instructions", "bytes"))
        for what, cost in _COST.items()
    },
    **{
        f"host {what} {real}": Asked(f"x86-64, {what}, {real}, instructions", "at most", cost[2])
        for real in ("float", "double")
        for what, cost in _COST.items()
    },
    "text torque alone": Asked("Cortex-M4F, torque alone, fixed parameters, text", "at most", 700, "B"),
    "constants torque alone": Asked("the same, constants", "at most", 64, "B"),
    "stack torque alone": Asked("the same, stack", "at most", 64, "B"),
    "step instructions": Asked("Cortex-M4F, time step with friction at rest, instructions", "at most", 160),
    "step numpy": Asked("NumPy, time step with friction at rest, 1e6, an element", "at most", 30, "ns"),
    **{
        f"export {name} {what}": Asked(f"{name}: {text}", "at most", limit, unit)
        for name, rest in {
            "MuJoCo": 0.0,
            "mujoco-warp": None,
            "Newton": None,
            "FMU in FMPy": 0.0,
        }.items()
        for what, text, limit, unit in (
            ("torque", "friction torque beside the emitted one", 1e-6, "relative"),
            ("swing", "end of a swing, steps of 2 ms, beside `friction_step` at 0.1 ms", 1.0, "mrad"),
            ("rest", "drift in 5 s of a link that friction holds", rest, "mrad"),
        )
        if limit is not None
    },
    "step jax": Asked("JAX, 4,096 drives, 5,000 steps: time over that of a naive step", "at most", 1.5),
    **{
        f"simulated {horizon:g} s": Asked(
            f"bundled log, simulated over {horizon:g} s: error of the extended over that of the paper's model",
            "at most",
            0.2,
        )
        for horizon in (0.1, 0.5, 2.0)
    },
    "simulated speed": Asked("NumPy, 12 runs at 1 kHz at once: times as fast as real time", "at least", 100),
    "servo all": Asked("hobby servo with its controller, whole runs: error over all", "at most", 33, "mrad"),
    "servo held out": Asked("the same over those held out", "at most", 33, "mrad"),
    "update 4": Asked("Cortex-M4F, update of 4 coefficients, instructions", "at most", 420),
    "update 6": Asked("Cortex-M4F, update of 6 coefficients, instructions", "at most", 750),
    "learned": Asked("learned in the field, 1e7 samples: error over that of a batch fit", "at most", 2),
    "false alarms of friction": Asked("the same: false alarms", "at most", 1),
    "broken": Asked("the same: numbers that are not finite", "at most", 0),
    "loop cycles": Asked("in a loop, 200 drives: limit cycles where there is as much friction", "at most", 0),
    "loop chatter": Asked(
        "the same: chatter at rest above that of the feedback, worst, over Coulomb", "at most", 1, "%"
    ),
    "loop steps": Asked("the same: on the worst task, median", "at most", 1, "%"),
    "loop tracking": Asked("the same: tracking error over the best peer's, worst task", "at most", 1.15),
    "loop sine": Asked("the same: tracking error over that without compensation, sine", "at most", 0.5),
    "loop point": Asked("the same: point to point", "at most", 0.5),
    "loop torque mode": Asked(
        "torque mode, friction 10 % over-estimated: drives that run away", "at most", 0
    ),
    "flags": Asked("combinations of compiler, processor and flags beyond the bounds", "at most", 0),
    "bits": Asked("self-tests of 200,000 inputs with other bits", "at most", 0),
    "alarms": Asked("alarms of Frama-C's Eva", "at most", 0),
    "misra": Asked("MISRA C:2012 deviations that no header declares", "at most", 0),
    "fma": Asked("calls of fma in the emitted C", "at most", 0),
    "libmvec": Asked("C, array, native: time over that of libmvec with -ffast-math", "at most", 1.1),
    "v3": Asked("C, array, x86-64-v3, an element", "at most", 2, "ns"),
    "lambdify": Asked("NumPy, torque, 1e6: times as fast as lambdify(cse)", "at least", 7),
    "numba": Asked("NumPy, torque, 1e6: times as fast as numba", "at least", 1.5),
    "lambdify gradient": Asked("NumPy, gradient, 1e6: times as fast as lambdify(cse)", "at least", 10),
    "naive 1": Asked("NumPy, torque, 1: time over that of naive NumPy", "at most", 2),
    "naive 100": Asked("NumPy, torque, 100: time over that of naive NumPy", "at most", 2),
    "compiled": Asked("`eccentric.compile`, a call on floats", "at most", 0.5, "us"),
    "compiled 1": Asked("`eccentric.compile`, a call on arrays of 1", "at most", 3, "us"),
    "compiled 100": Asked("`eccentric.compile`, a call on arrays of 100", "at most", 3, "us"),
    "found": Asked("`eccentric.compile`, cached, in a fresh process that has NumPy", "at most", 0.2, "s"),
    "arm motor torque 7": Asked(
        "arm of 7 joints, x86-64: all wrenches and load friction, instructions", "at most", 2900
    ),
    "arm inverse 7": Asked("the same: inverse dynamics alone", "at most", 2500),
    **{
        # 0.42 times what Pinocchio 4.1 takes for its `rnea` without loads or friction.
        f"arm inverse {n}": Asked(f"arm of {n} joints: inverse dynamics", "at most", int(0.42 * peer))
        for n, peer in ((1, 942), (3, 2916), (12, 11803))
    },
    "arm numpy": Asked("arm of 7 joints, NumPy, 1e5 samples, a sample", "at most", 1.0, "us"),
    "arm compiled": Asked("the same, compiled", "at most", 0.25, "us"),
    "arm pinocchio": Asked(
        "random arms of 1 to 12 joints, NumPy: deviation from Pinocchio", "at most", 1e-12
    ),
    "arm emitted 7": Asked("arm of 7 joints, derived and emitted", "at most", 20, "s"),
    "arm emitted 12": Asked("arm of 12 joints, derived and emitted", "at most", 40, "s"),
    "derive": Asked("`make derive`, all models: time over `import sympy`", "at most", 10),
}

DIAGNOSIS: dict[str, Asked] = {
    "first": Asked("right family first", "at least", 0.95),
    "three": Asked("right family among the first three", "at least", 0.97),
    "wrong": Asked("wrong name given", "at most", 0.03),
    "false alarms": Asked("false alarms on controls", "at most", 1 / 60),
    "ordinary alarms": Asked("false alarms on controls with ordinary drives", "at most", 1 / 60),
    "outside": Asked("`unexplained` with the right variable, outside the library", "at least", 1),
    "both": Asked("both of two effects named", "at least", 0.9),
    "faint": Asked(
        "faint effects named rightly where a fit that knows the truth predicts better by z > 3",
        "at least",
        0.85,
    ),
    "oracle median": Asked("held-out RMSE above the oracle's, median", "at most", 1, "%"),
    "oracle 90": Asked("held-out RMSE above the oracle's, 90th percentile", "at most", 10, "%"),
    "sure": Asked(f"named with probability {SURE:g} or more, and right", "at least", 0.9),
    "diagnose seconds": Asked("`diagnose` of the bundled log: processor time", "at most", 4, "s"),
    "diagnose ratio": Asked("`diagnose`: processor time over that of an earlier commit", "at most", 0.45),
    "first seconds": Asked("`diagnose`: first run in a new environment", "at most", 8, "s"),
    "fit seconds": Asked("`fit` of the bundled log: processor time", "at most", 1.5, "s"),
    "fit ratio": Asked("`fit`: processor time over that of an earlier commit", "at most", 0.45),
    "mutants": Asked("small changes to the sources that the tests notice", "at least", 0.9),
    "tests": Asked("`make test` on two idle cores", "at most", 4, "min"),
    "seconds": Asked("50,000 rows, whole library", "at most", 20, "s"),
    "memory": Asked("memory of the process, up to 50,000 rows", "at most", 1, "GB"),
    "long seconds": Asked("an hour at 1 kHz, 3.6 million rows, whole library", "at most", 180, "s"),
    "long memory hour": Asked("the same: memory of the process", "at most", 1.5, "GB"),
    "long memory hours": Asked("30 million rows, whole library: memory of the process", "at most", 1.5, "GB"),
    "long fit hour": Asked(
        "fit of 3.6 million rows: processor time over that of a bare PyArrow scan", "at most", 10
    ),
    "long fit hours": Asked("fit of 30 million rows: the same", "at most", 10),
    "fleet found": Asked("fleet of 1,000 joints, 12 months: joints that degrade, found", "at least", 1),
    "fleet alarms": Asked("the same: joints without a change that are called changed", "at most", 1),
    "fleet family": Asked("the same: right family named", "at least", 0.9),
    "fleet cost": Asked("the same: coefficients, one worker, time over a bare PyArrow scan", "at most", 10),
    "fleet memory": Asked("the same: memory of a worker", "at most", 1, "GB"),
    "fleet two": Asked("the same: two workers, times as fast as one", "at least", 1.7),
    **{
        f"coverage {kind}": Asked(f"95 % intervals that hold the truth: {what}", "at least", 0.92, up_to=0.97)
        for kind, what in (
            ("inertia", "inertia"),
            ("friction", "friction coefficients"),
            ("effect", "parameters of an effect"),
        )
    },
    "arms first": Asked("arms: right family and joint first", "at least", 0.9),
    "arms wrong": Asked("arms: wrong name given", "at most", 0.03),
    "arms alarms": Asked("arms: false alarms on controls", "at most", 0),
    "drafted": Asked(
        "drafted rigs, logs renamed and rescaled: columns with the right channel and unit",
        "at least",
        90,
        "%",
    ),
    "drafted silently wrong": Asked("the same: wrong without a doubt stated", "at most", 0),
    "drafted decoys": Asked("real names among decoys: wrong without a doubt stated", "at most", 0),
    "drafted fits": Asked("the same: fitted with at most three values typed", "at least", 100, "%"),
    "strangers": Asked("strangers' logs: drafted right, honestly asked, or refused", "at least", 95, "%"),
    "strangers wrong": Asked("the same: wrong without a doubt stated, or a traceback", "at most", 0),
    "strangers faults": Asked("small inputs that once failed: answered as wanted", "at least", 100, "%"),
    "plan right": Asked("tied logs: right family named after the planned motion", "at least", 0.95),
    "plan stated": Asked("the same: stated probability, from what happened", "at most", 0.1),
    "plan seconds": Asked("the same: processor time of a plan", "at most", 60, "s"),
    "plan broken": Asked("the same: limits broken by drives 10 % off", "at most", 0),
    "term median": Asked(
        "a term without a cause: its gain over the best learned one's, median", "at least", 0.9
    ),
    "term least": Asked("the same: least", "at least", 0.7),
    "term coefficients": Asked("the same: coefficients, at most", "at most", 24),
    "term worse": Asked("the same: drives that it predicts worse, beyond the interval", "at most", 0),
    "term outside": Asked(
        "the same: thirds of the speeds, left out, where it predicts worse, beyond the interval", "at most", 0
    ),
    "term controls": Asked("the same: controls whose next log it predicts worse", "at most", 0),
    "readers": Asked("fuzzed inputs neither taken nor refused in one line", "at most", 0),
}
