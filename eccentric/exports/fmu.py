"""A drive as an FMU: FMI 3.0, co-simulation, in C99 source, with the emitted C inside.

The unit steps with `friction_step`, so that a drive at rest stays at rest whatever the communication step is.
(Modelica Association, Functional Mock-up Interface 3.0, 2022.)
"""

from __future__ import annotations

import hashlib
import html
import io
import zipfile
from dataclasses import dataclass

from eccentric.emission import inputs_of, plain, render, template
from eccentric.exports.drive import ExportedDrive
from eccentric.exports.export import Exported, decimal, head

_STEP = "0.0001"
"""Longest internal step [s]: its error is of first order, 0.1 mrad where a link comes to rest."""
_EPOCH = (1980, 1, 1, 0, 0, 0)
"""The time of files in the archive, the earliest that it can hold: the same export is the same file."""


@dataclass(frozen=True)
class _Variable:
    """A variable of the FMU, as its templates take it."""

    reference: int
    name: str
    described: str
    causality: str
    start: str = "0.0"
    initial: str = ""

    @property
    def symbol(self) -> str:
        """Its name in C."""
        return f"PARAMETER_{self.name}" if self.causality == "parameter" else self.name.upper()

    @property
    def variability(self) -> str:
        """Whether it may change while the unit runs."""
        return "fixed" if self.causality == "parameter" else "continuous"


def write(drive: ExportedDrive) -> Exported:
    """NAME.fmu: input `torque` of the motor, outputs `theta_m`, `omega_m`, `friction`, and the parameters.

    Raises:
        InputError: an inertia is not known.
    """
    drive.require("J_m", "J_l")
    name, variables = drive.name, _variables(drive)
    sources = render(drive.model, "eccentric export", drive.origin, ("c99",))
    listed = repr([(q.name, q.start) for q in variables])
    token = hashlib.sha256("".join([listed, *sources.values()]).encode()).hexdigest()[:32]
    inputs = {"theta_m": "v[THETA_M]", "omega_m": "v[OMEGA_M]", "alpha_m": "drive->acceleration"}
    inputs |= {"torque": "torque", "dt": "dt"} | {x: f"v[{x.upper()}]" for x in drive.other_inputs()}
    step, gravity = (getattr(drive.module, name, None) for name in ("friction_step", "gravity_torque"))
    names = head(drive) | {
        "token": token,
        "variables": variables,
        "parameters": [q for q in variables if q.causality == "parameter" and q.name != "step"],
        "others": [q for q in variables if q.name in drive.other_inputs()],
        "by_acceleration": "alpha_m" in inputs_of(step),
        "gravity": ", ".join(inputs[x] for x in inputs_of(gravity)) if gravity else "",
        "taken": ", ".join(inputs[x] for x in inputs_of(step)),
    }
    escaped = names | {"title": html.escape(str(names["title"]))}
    files = {
        "modelDescription.xml": template("exports/model_description.xml").render(escaped),
        "sources/buildDescription.xml": template("exports/build_description.xml").render(names),
        f"sources/{name}_fmi3.c": template("exports/fmu.c").render(names),
        f"sources/{name}.c": sources[f"{name}.c"],
        f"sources/{name}.h": sources[f"{name}.h"],
    }
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as zipped:
        for file, text in files.items():
            zipped.writestr(zipfile.ZipInfo(file, _EPOCH), text, zipfile.ZIP_DEFLATED)
    return Exported({f"{name}.fmu": archive.getvalue()})


_STARTS = {"temperature": "25.0"}
"""Values of inputs that nothing is connected to, other than 0: a room's temperature in degC."""


def _variables(drive: ExportedDrive) -> list[_Variable]:
    """All but the time, in the order of their references."""
    meanings = {q.name: f"{q.meaning} [{q.unit}]" for q in (*drive.model.inputs, *drive.model.parameters)}
    listed = [
        ("torque", "motor torque [N m]", "input", "0.0", ""),
        *((x, meanings[x], "input", _STARTS.get(x, "0.0"), "") for x in drive.other_inputs()),
        ("theta_m", meanings.get("theta_m", "motor angle [rad]"), "output", "0.0", "exact"),
        ("omega_m", meanings["omega_m"], "output", "0.0", "exact"),
        ("friction", "friction torque [N m]", "output", "0.0", "calculated"),
        ("step", "longest step [s]", "parameter", _STEP, "exact"),
        *(
            (q.name, meanings[q.name], "parameter", decimal(getattr(drive.p, q.name)), "exact")
            for q in drive.model.parameters
            if getattr(drive.p, q.name) is not None
        ),
    ]
    return [
        _Variable(k, name, html.escape(plain(meaning)), causality, start, initial)
        for k, (name, meaning, causality, start, initial) in enumerate(listed, 1)
    ]
