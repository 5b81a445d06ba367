"""The results of the diagnosis benchmark as figures and as the table of misses."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.stats import beta

from benchmarks.asked import SURE
from benchmarks.diagnosis_jobs import Result
from benchmarks.record import Measured

# What leaves less than this part of the friction beyond the paper's own columns is an exact alias of them.
ALIAS = 0.002
PROVABLE = 3.0
"""Standard errors by which a fit that knows the truth has to predict the held-out part better."""
Check = Callable[[Result], bool]


def figures(results: Sequence[Result], slow: Sequence[Result]) -> dict[str, Measured]:
    """The required figures.

    Args:
        results: of all logs but the long ones.
        slow: of those.
    """
    single, pair, outside = (_of(results, kind) for kind in ("single", "pair", "outside"))
    faint = _of(results, "faint")
    sure = [r for r in [*single, *pair, *faint] if r.verdict == "named" and r.probability >= SURE]
    provable = _provable(faint)
    excess = _excess(single, lambda r, balance: r.rmse[balance])
    peers = _excess(single, lambda r, balance: r.peer["rmse"][balance] if r.peer else None)
    found = {
        "first": _fraction(
            single, lambda r: r.ranked[:1] == r.truth, lambda ranked, r: ranked[:1] == r.truth
        ),
        "three": _fraction(
            single, lambda r: r.truth[0] in r.ranked[:3], lambda ranked, r: r.truth[0] in ranked[:3]
        ),
        "wrong": _fraction(
            single,
            lambda r: r.named != [] and r.named[0] not in r.truth,
            lambda ranked, r: ranked != [] and ranked[0] not in r.truth,
        ),
        **{
            key: _fraction(
                _of(results, kind), lambda r: r.verdict != "nothing_missing", lambda ranked, _: ranked != []
            )
            for key, kind in (("false alarms", "control"), ("ordinary alarms", "ordinary"))
        },
        "outside": _fraction(outside, _honest),
        "both": _fraction(
            pair, lambda r: set(r.truth) <= set(r.named), lambda ranked, r: set(r.truth) <= set(ranked[:2])
        ),
        "faint": _fraction(provable, lambda r: r.named == r.truth),
        "sure": _fraction(sure, lambda r: r.named[0] in r.truth),
        # There is no figure for one that failed.
        "seconds": Measured(float(np.max([r.seconds or np.nan for r in slow]))),
        "memory": Measured(max(r.memory for r in [*results, *slow]) or float("nan")),
    }
    for key, part in (("oracle median", 0.5), ("oracle 90", 0.9)):
        peer = f"{np.quantile(peers, part):+.1f} %" if peers else ""
        value = float(np.quantile(excess, part)) if excess else float("nan")
        found[key] = Measured(
            value, f"{value:+.1f} % on {len(excess)} logs", f"PySINDy {peer}" if peer else ""
        )
    return found


def details(results: Sequence[Result]) -> list[str]:
    """Further figures, and every miss."""
    single, faint = _of(results, "single"), _of(results, "faint")
    hidden = [r for r in results if r.job.kind == "single" and r not in single]
    seconds = sorted(r.seconds for r in results if r.seconds) or [float("nan")]
    named = _excess([r for r in single if r.named == r.truth], lambda r, balance: r.rmse[balance])
    pair = _of(results, "pair")
    shown = [r for r in pair if r.oracle is not None and r.oracle.over_less > PROVABLE]
    missed = (
        [r for r in single if r.ranked[:1] != r.truth],
        [r for r in pair if not set(r.truth) <= set(r.named)],
        [r for r in _provable(faint) if r.named != r.truth],
    )
    rows = {
        **{
            f"{what}, although a fit that knows the truth predicts better than the answer by z > {PROVABLE:g}": (
                share(sum(r.oracle is not None and r.oracle.over_answer > PROVABLE for r in own), len(own))
            )
            for what, own in zip(("not first", "not both of two", "faint and not named"), missed, strict=True)
        },
        f"both of two effects named where a fit that lacks either predicts worse by z > {PROVABLE:g}": share(
            sum(set(r.truth) <= set(r.named) for r in shown), len(shown)
        ),
        "a wrong name, further names counted too": share(
            sum(bool(set(r.named) - set(r.truth)) for r in single), len(single)
        ),
        "named by a name that covers the true effect": share(sum(r.shared for r in single), len(single)),
        "faint effects with a wrong name": share(
            sum(bool(set(r.named) - set(r.truth)) for r in faint), len(faint)
        ),
        "abstained on a family of the library": share(
            sum(r.verdict in {"not_identifiable", "unexplained"} for r in single), len(single)
        ),
        "exact aliases of the paper's columns left alone": share(
            sum(r.verdict == "nothing_missing" for r in hidden), len(hidden)
        ),
        "held-out RMSE above the oracle's where the right name was given: median, 90th percentile": (
            f"{np.median(named):+.1f} %, {np.quantile(named, 0.9):+.1f} %" if named else "-"
        ),
        "seconds per log (15,000 rows), median": f"{np.median(seconds):.1f}",
    }
    lines = [
        "| further | measured (95 % interval) |",
        "|---|---|",
        *(f"| {k} | {v} |" for k, v in rows.items()),
        "",
    ]
    lines += [
        "Misses:",
        "",
        "| kind | seed | rig | truth | verdict | named | first three | depends |",
        "|---" * 8 + "|",
    ]
    return lines + [_miss(r) for r in results if not _good(r)]


def _of(results: Sequence[Result], kind: str) -> list[Result]:
    """The logs of a kind, those with an exact alias left out."""
    own = [r for r in results if r.job.kind == kind]
    return [r for r in own if min(r.beyond, default=1.0) > ALIAS] if kind in {"single", "pair"} else own


def _provable(results: Sequence[Result]) -> list[Result]:
    """Those that a fit which knows the truth predicts better than the paper's model."""
    return [r for r in results if r.oracle is not None and r.oracle.over_paper > PROVABLE]


def _fraction(
    results: Sequence[Result], own: Check, peer: Callable[[list[str], Result], bool] | None = None
) -> Measured:
    count, answered = sum(map(own, results)), [r for r in results if r.peer is not None]
    text = ""
    if peer is not None and answered:
        text = f"PySINDy {share(sum(peer((r.peer or {})['ranked'], r) for r in answered), len(answered))}"
    return Measured(count / len(results) if results else float("nan"), share(count, len(results)), text)


def _excess(results: Sequence[Result], rmse: Callable[[Result, str], float | None]) -> list[float]:
    """The excess of the held-out RMSE over the oracle's in per cent, if there is one."""
    found = [(rmse(r, r.oracle.balance), r.oracle.rmse) for r in results if r.oracle is not None]
    return [100 * (own / least - 1) for own, least in found if own is not None]


def _honest(r: Result) -> bool:
    return r.verdict == "unexplained" and r.truth[0] in r.depends[:2]


def _good(r: Result) -> bool:
    if r.job.kind in {"control", "ordinary"}:
        return r.verdict == "nothing_missing"
    if r.job.kind == "outside":
        return _honest(r)
    alias = r.job.kind in {"single", "pair"} and min(r.beyond, default=1.0) <= ALIAS
    return alias or set(r.named) == set(r.truth)


def _miss(r: Result) -> str:
    truth = ", ".join(f"{t} {b:.3f}" for t, b in zip(r.truth, r.beyond, strict=False))
    lists = (r.named, r.ranked[:3], r.depends[:3])
    cells = [
        f"{r.job.kind} {r.job.outside or ''}",
        r.job.seed,
        r.note,
        truth,
        r.verdict,
        *map(", ".join, lists),
    ]
    return f"| {' | '.join(map(str, cells))} |"


def share(count: int, total: int) -> str:
    """A fraction with its 95 % Clopper-Pearson interval."""
    if total == 0:
        return "-"
    low = 0.0 if count == 0 else float(beta.ppf(0.025, count, total - count + 1))
    high = 1.0 if count == total else float(beta.ppf(0.975, count + 1, total - count))
    return f"{count}/{total} = {count / total:.2f} ({low:.2f} to {high:.2f})"
