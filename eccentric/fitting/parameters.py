"""A fit as parameters to emit: a value for every letter of the model, and the origin of each."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eccentric.fitting.columns import k_e
from eccentric.fitting.problem import own_letters

if TYPE_CHECKING:
    from eccentric.estimation import Estimate
    from eccentric.fitting.identify import Fit

__all__ = ["emitted_parameters"]


def emitted_parameters(fit: Fit) -> tuple[dict[str, float | None], dict[str, str]]:
    """Return values for every parameter of the model, known and fitted, and the origin of each in words.

    A combination is assigned to one letter, and the others have a value that does not change it (B_lT = C_lT
    = 0; k_e = 0 with the back-EMF damping in B_m; k_i = 1 N m/A): the notes say so.
    """
    problem = fit.problem
    fitted = {q.name for q in problem.model.friction_parameters}
    own = {name: value for name, value in own_letters(problem.model).items() if name not in fitted}
    values: dict[str, float | None] = {n: x for n, x in problem.rig.known.items() if n not in own}
    notes = dict.fromkeys(values, "known, from the rig")
    for name, e in fit.searched.items():
        values[name], notes[name] = e.value, _words(e)
    _put_scale(fit, values, notes)
    for c in problem.coefficients:
        if c.role not in ("friction", "inertia", "load"):
            continue
        e = _mechanical(fit, c.name)
        values[c.parameter], notes[c.parameter] = e.value, _words(e)
        if c.parameter != c.letter or k_e in c.expression.free_symbols:
            shown = _mechanical_name(fit, c.name)
            notes[c.parameter] += "" if shown in (c.parameter, "J") else f"; contains all of {shown}"
    if any(c.role == "inertia" for c in problem.coefficients):
        values["J_l"], notes["J_l"] = 0.0, "convention: J_m contains all of the inertia J_m + mu^2 J_l"
    fields = problem.emitted.letters
    for name in fields:
        if name in values:
            continue
        if name in own:
            values[name], notes[name] = own[name], "the model's own, not fitted"
        elif name in ("F_T", "J_m", "J_l"):
            values[name], notes[name] = None, "not known, not needed"
        else:
            values[name], notes[name] = (1.0 if name in ("R", "k_i") else 0.0), "convention: not identified"
    return {name: values[name] for name in fields}, {name: notes[name] for name in fields}


def _put_scale(fit: Fit, values: dict[str, float | None], notes: dict[str, str]) -> None:
    """Set k_i and R so that their ratio is the identified scale; without one, 1 N m represents 1 V or 1 A."""
    problem = fit.problem
    if problem.scale is None:
        return
    column = next((c for c in problem.coefficients if c.role == "scale"), None)
    s = fit.coefficients[column.name].value if column else 1.0
    text = (
        _words(fit.coefficients[column.name])
        if column
        else f"no scale identified: N m represents {problem.unit}"
    )
    if problem.unit == "A":
        values["k_i"], notes["k_i"] = 1.0 / s, f"from 1/k_i {text}"
        return
    known = problem.rig.known
    if "k_i" not in known and "R" not in known:
        values["k_i"], notes["k_i"] = 1.0, "convention: only R/k_i shows in a voltage"
    if "R" in known:
        values["k_i"], notes["k_i"] = known["R"] / s, f"from R/k_i {text}"
    else:
        values["R"], notes["R"] = s * (values["k_i"] or 1.0), f"from R/k_i {text}"


def _mechanical_name(fit: Fit, name: str) -> str:
    """The combination in newton metres for a coefficient: they have the same order."""
    if not any(c.role == "scale" for c in fit.problem.coefficients):
        return name
    names = [c.name for c in fit.problem.coefficients if c.role != "offset"]
    return list(fit.combinations)[names.index(name)]


def _mechanical(fit: Fit, name: str) -> Estimate:
    shown = _mechanical_name(fit, name)
    return fit.coefficients[name] if shown == name else fit.combinations[shown]


def _words(e: Estimate) -> str:
    low, high = e.interval
    bound = f", at its {e.bound_active} bound" if e.bound_active else ""
    error = "" if e.widened else f", std error {e.std_error:.2g}"
    unit = "" if e.unit == "1" else f" {e.unit}"
    return f"fitted: {e.value:.4g}{unit}{error}, 95 % interval {low:.4g} to {high:.4g}{bound}"
