"""What a rig may do that the paper's model lacks: one builder per family, with code of the bench's own.

`EFFECTS` maps a family's id to its builder, `builder(strength, rng, setting, variant) -> Effect`: the shape
is drawn by `rng`, the amplitude is a first guess for `strength` (fraction of the friction rms), which the
simulation then measures and corrects.
"""

from . import circuit, geometry, history, loads, speed, warmth
from .record import PORTS, Builder, Effect, Law, Setting

EFFECTS: dict[str, Builder] = {
    **speed.FAMILIES,
    **warmth.FAMILIES,
    **geometry.FAMILIES,
    **loads.FAMILIES,
    **history.FAMILIES,
    **circuit.FAMILIES,
}

__all__ = ["EFFECTS", "PORTS", "Builder", "Effect", "Law", "Setting"]
