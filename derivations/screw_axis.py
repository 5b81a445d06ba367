"""A linear axis driven by a screw: the carriage with the screw angle known from the pitch.

Friction may then vary over a turn of the screw.
Run it to read the derivation: python derivations/screw_axis.py
"""

from dataclasses import replace

from eccentric.core import show
from eccentric.model import load_model, quantity

carriage = load_model("linear_axis")
# The toolkit's symbol of a gear: the screw angle is mu times the position.
turns = quantity("mu", "1/m", "2 pi over the pitch of the screw", "", "positive")

model = replace(
    carriage,
    name="screw_axis",
    title=f"{carriage.title}, with a screw of known pitch",
    parameters=(*carriage.parameters, turns),
)

if __name__ == "__main__":
    show(model)
