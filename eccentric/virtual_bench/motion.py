"""The motion of the rig at one step of the simulation, as seen by the laws of the effects."""

from eccentric.virtual_bench.plant import Plant


class Motion:
    """The motion of the rig at this step, as seen by the effects; torques in N m on the motor side."""

    __slots__ = (
        "acting",
        "alpha",
        "dry",
        "gravity",
        "i",
        "link",
        "link_dry",
        "link_viscous",
        "normal",
        "plant",
        "t",
        "temperature",
        "theta",
        "travel",
        "v",
        "viscous",
        "w",
        "w_before",
        "w_link",
        "w_mid",
    )

    def __init__(self, plant: Plant, theta: float = 0.0, w: float = 0.0, effects: int = 0) -> None:
        self.plant = plant  # the rig that moves: it need not be the one for which an effect was drawn
        self.t = 0.0  # time [s]
        self.theta = theta  # motor angle at the end of the step
        self.w = w  # motor speed at the end of the step [rad/s]
        self.w_before = w  # motor speed at the start of the step
        self.w_mid = w  # motor speed extrapolated to the middle of the step
        self.alpha = 0.0  # motor acceleration over the last step [rad/s^2]
        self.link = plant.mu * theta  # link angle in the middle of the step
        self.w_link = plant.mu * w  # link speed [rad/s]
        self.i = 0.0  # armature current, mean over the step [A]
        self.v = 0.0  # voltage less the declared back EMF [V]
        self.temperature = plant.Tamb  # of both lubricant and winding [deg C]
        self.travel = 0.0  # distance travelled by the motor [rad]
        self.normal = 0.0  # normal force in the link joint [N]
        self.gravity = 0.0  # gravity torque of eq. (5)
        self.link_dry = 0.0  # Coulomb level of the link joint
        self.link_viscous = 0.0  # viscous coefficient of the link joint [N m s/rad]
        self.dry = 0.0  # Coulomb level of the paper's friction, motor and link
        self.viscous = 0.0  # viscous coefficient of the paper's friction
        self.acting = [0.0] * effects  # value of each effect's law at this step
