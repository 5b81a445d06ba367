"""How firmware calls an extended model: the functions that together contain every effect that was adopted."""

from __future__ import annotations

from collections.abc import Sequence

from eccentric.diagnosis import Diagnosis, extended_model, is_result_name, result_name, undecided
from eccentric.effects import Effect
from eccentric.exports import Exported, ExportedArm, ExportedDrive
from eccentric.identification import Emitted, Refit
from eccentric.model import Extension, Interface, Model, interface_of, needed

GRAVITY = "gravity_torque"
DRIVES = "current", "voltage"
"""Outputs that contain every mechanical effect: the drive that a motion requires."""
FRICTION = "mechanical_friction_torque", "friction_torque"


def calls(found: Diagnosis) -> list[str]:
    """How firmware calls the model and, with hidden states, steps them.

    It calls the friction torque, and what contains the effects that are no friction; without a scale, the
    drive that a motion requires, in its own unit.
    """
    fitted, name = found.result, result_name(found)
    emitted, states = Emitted(fitted.model), [s.quantity.name for s in fitted.model.states]
    model = extended_model(found)
    named = found.rig.axis.named

    def call(function: str, given: Sequence[str] | None = None) -> str:
        if given is None:
            given = [f"state.{a}" if a in states else a for a in emitted.inputs_of(function)]
        arguments = [*map(named, given), f"&{name}_default"]
        return f"{name}_{named(function)}({', '.join(arguments)})"

    torque = call(model.first_function)
    elsewhere = [
        f"  {effect} is {'not only' if in_torque else 'not'} friction;"
        f" {'the rest' if in_torque else 'it'} is in {call(function)}"
        for effect, function, in_torque in other_functions(model)
    ]
    elsewhere += zero_line(found, [torque, *elsewhere])
    if not found.models.fits_the_rig:
        return []
    if not states:
        if fitted.effects or found.asked.request.including:
            return [f"{_undecided(found)}to call{' it' * bool(_undecided(found))}: {torque}", *elsewhere]
        base = found.models.base.name
        plain = found.rig.axis.term("the paper's model")
        whose = f"{base}, refitted" if is_result_name(base) else f"{plain}, fitted"
        return [f"nothing was added; to call {whose}: {torque}"]
    stepped = [a for a in emitted.inputs_of("next_state") if a not in states]
    return [
        f"start from {name}_state state = {name}_initial_state, then call in every cycle, in this order:",
        f"  {torque}",
        *elsewhere,
        f"  {call('step', ['&state', *stepped])}",
    ]


def zero_line(found: Diagnosis, called: Sequence[str]) -> list[str]:
    """From where the angle of a call counts, unless the logged one counts from there."""
    of_link = found.channels.alignment.theta_zero_rad
    if not of_link or not any("theta_m" in line for line in called):
        return []
    zero = of_link / found.setting.mu
    shift = f"{'-' if zero > 0.0 else '+'} {abs(zero):.6g} rad"
    return [f"  theta_m is 0 where the mass hangs lowest: the logged motor angle {shift}"]


def _undecided(found: Diagnosis) -> str:
    """What the emitted model has of a tie; "" without one."""
    if not (tied := undecided(found)):
        return ""
    return f"the emitted model has {' and '.join(tied)} of the tied candidates: do not rely on it yet; "


def other_functions(model: Model) -> list[tuple[str, str, bool]]:
    """The mechanical effects of an extended model, by id, that its first function does not wholly contain.

    With each the function that does, the gravity torque where it can, else the drive that a motion requires;
    and whether the first function contains a part of it.
    """
    outputs, first = interface_of(model), model.first_function
    mechanical = model.expand(model.balance("mechanical").residual()).free_symbols
    found = []
    for effect in model.extensions:
        if first in DRIVES or mechanical.isdisjoint(q.symbol for q in effect.parameters):
            continue
        in_first = _contains(model, outputs, first, effect)
        if _contains(model, outputs, GRAVITY, effect):
            found.append((effect.name, GRAVITY, in_first))
        elif not in_first:
            drives = [drive for drive in DRIVES if _contains(model, outputs, drive, effect)]
            found += [(effect.name, drive, False) for drive in drives[:1]]
    return found


def share_words(fitted: Refit, effect: Effect) -> str:
    """How large an effect is: of the friction if it is friction, else of the torque that it is a part of."""
    share, model = 100 * fitted.shares.get(effect.id, 0.0), fitted.model
    outputs = interface_of(model)
    is_friction = any(_contains(model, outputs, function, effect) for function in FRICTION)
    if is_friction and not _contains(model, outputs, GRAVITY, effect):
        return f"{share:.1f} % of the friction"
    return model.axis.text(f"{share:.1f} % of the drive torque net of inertia and gravity")


def _contains(model: Model, outputs: Interface, function: str, effect: Effect | Extension) -> bool:
    """Whether a function depends on a parameter of the effect."""
    name, own = model.axis.named(function), {q.symbol for q in effect.parameters}
    for output in outputs.outputs:
        if output.name == name:
            made = output.expressions()
            values = [value for _, value in made.results]
            values += [one.value for one in needed(made.definitions, values)]
            return any(value.free_symbols & own for value in values)
    return False


# How close the friction of an export is to the drive's, in words.


def export_lines(drive: ExportedDrive | ExportedArm, exported: Exported) -> list[str]:
    """What a person reads of an export; values at the joint, on the link side of the gear."""
    if isinstance(drive, ExportedArm):
        joints = ", ".join(joint.name for joint in drive.joints)
        lines = [f"friction: exact, at the bearing loads that MuJoCo computes, of the joints {joints}"]
        if drive.without_friction:
            lines.append("all friction coefficients are 0: give those of a fit with --parameters")
        return lines
    law = exported.law
    low, high = drive.link_speeds
    whence = ", as in the log" if drive.identified else ""
    lines = []
    if law is None:
        lines.append("friction: exact")
    elif law.exact and not drive.takes("alpha_m"):
        lines.append("friction: exact, since its coefficients are constant")
    else:
        share = 100.0 * law.error_rms / law.friction_rms
        lines.append(
            f"friction: the best fit with constant coefficients, link speeds {low:.4g} to {high:.4g} rad/s"
            f"{whence}: error {law.error_rms:.3g} N m RMS ({share:.2g} % of the friction),"
            f" {law.error_max:.3g} N m at most"
        )
        if drive.takes("alpha_m"):
            lines.append(
                "friction that depends on the acceleration is left out: the error is at constant speed"
            )
        least, most = (f"{x:.4g}" for x in law.breakaway)
        own = f"+-{least} N m" if least == most else f"{least} to {most} N m, depending on the angle"
        back, forth = f"{law.lower:.4g}", f"{law.upper:.4g}"
        held = f"+-{forth} N m" if back == forth else f"{back} N m backwards and {forth} N m forwards"
        lines.append(f"at rest the export holds {held}, the drive {own}")
    if exported.left_out > 1e-9 * max(drive.p.M * drive.p.g * drive.p.L, 1e-9):
        lines.append(
            f"left out: a torque at the joint of up to {exported.left_out:.3g} N m that is not friction"
            " (cogging, a spring, a load)"
        )
    file, missing = exported.unwritten
    if missing:
        it = "it" if len(missing) == 1 else "them"
        # A fit gives all inertias a value, and takes no more from --parameters.
        fitted = None not in (drive.p.J_m, drive.p.J_l)
        mend = f"declare {it} in the rig file and fit again" if fitted else f"give {it} with --parameters"
        lines.append(f"left out: the pendulum {file}, which requires {' and '.join(missing)}: {mend}")
    if drive.model.back_emf_in_friction:
        lines.append(
            "friction contains the back-EMF: drive the joint by k_i u/R, the torque of the voltage u"
        )
    return lines


def left_out_sentence(model: Model, whole: float, other: float) -> str:
    """What a compensation of the friction leaves out [N m]: of it, `other` is not the pendulum's gravity."""
    axis = model.axis
    largest, rest = (f"{x:.3g} {axis.unit('N m')}" for x in (whole, other))
    beyond = "" if rest == largest else f"; {rest} of it beyond gravity"
    return (
        f"the compensation leaves out a {axis.term('torque')} of up to {largest}{axis.text(' (motor side)')}"
        f" that is not friction (gravity, cogging, a spring, a load{beyond}): add"
        f" {model.name}_{axis.named('gravity_torque')}"
    )
