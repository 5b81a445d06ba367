"""The extended model as a derivation script that can be read, run and edited."""

from __future__ import annotations

import pprint
from pathlib import Path

from eccentric.diagnosis.outcome import Diagnosis
from eccentric.emission import plain

__all__ = ["extended_name", "script"]


def extended_name(found: Diagnosis) -> str:
    """Name of the extended model, and of its emitted trio."""
    return f"{found.models.base.name}_extended"


def _base(found: Diagnosis) -> str:
    """How the script loads the base model: by name, or the script of the user's own that lies beside it."""
    own = Path(found.asked.model)
    return f"Path(__file__).with_name({own.name!r})" if own.suffix == ".py" else repr(found.models.base.name)


def script(found: Diagnosis) -> str:
    """The text of model.py: the base model, the effects with their values, the fitted coefficients.

    It is a derivation like any other: `python model.py` prints it, `eccentric emit model.py` emits it.
    """
    adopted = found.models.shipped.effects
    names = ", ".join(effect.id for effect, _ in adopted) or "no effect"
    origin = plain(", ".join(found.asked.logs))
    setting = pprint.pformat(found.setting, width=100, compact=True)
    # A set prints in another order in every run.
    channels = found.setting.channels
    setting = setting.replace(repr(channels), f"frozenset({sorted(channels)})")
    setting = setting.replace("Setting(", "Setting(base=model,\n        ", 1)
    chosen = pprint.pformat([(effect.id, own) for effect, own in adopted], width=100)
    letters = {q.name for q in found.models.shipped.model.parameters}
    values = {k: v for k, v in found.models.shipped.values.items() if k in letters and v is not None}
    notes = {
        name: f"fitted: {e.value:.4g}, 95 % interval {e.interval[0]:.4g} to {e.interval[1]:.4g}"
        for name, e in found.models.shipped.estimates.items()
    }
    drive = found.data.drive
    if drive.scale is not None and found.unit == "N m":
        letters_of = "R/k_i, with k_i = 1 N m/A" if drive.by_voltage else "k_i"
        notes["R" if drive.by_voltage else "k_i"] = f"{letters_of}: identified through gravity or inertia"
        if drive.by_voltage and "k_e" not in found.rig.known and "back_emf" not in drive.open:
            notes["B_m"] = f"{notes.get('B_m', '')}; contains k_e k_i/R, which this log cannot tell from it"
    load = ("", "")
    if "T_load" in {q.name for q in found.models.base.parameters}:
        load = (
            "from eccentric.effects.constant_load import effect as constant_load\n",
            "model = constant_load.extend(model)\n",
        )
    own = ""
    if found.asked.effects is not None:
        own = f"\noffered += load_effects(Path(__file__).with_name({found.asked.effects.name!r}), setting)"
    return f'''"""{plain(f"{found.models.base.title}, extended by {names}")}.

Written by `eccentric diagnose` from {origin}.
A derivation like any other: run it to read it, edit it, emit it with `eccentric emit model.py --out DIR`.
"""

from pathlib import Path

from eccentric.effects import Setting, library, load_effects
{load[0]}from eccentric.model import load_model
from eccentric.model.defaults import with_values
from eccentric.output import show

# The paper's model.
model = load_model({_base(found)})
{load[1]}
# What the log spans; the ranges of the library of effects follow from it.
setting = {setting}
offered = [*library(setting)]{own}
effects = {{effect.id: effect for effect in offered}}

# What the model lacks on this log.
for name, values in {chosen}:
    model = effects[name].extend(model, values)

model = with_values(
    model,
    {pprint.pformat(values, width=96, indent=1)},
    name={extended_name(found)!r},
    notes={pprint.pformat(notes, width=96)},
    title={f"{found.models.base.title}, extended by {names}"!r},
)

if __name__ == "__main__":
    show(model)
'''
