"""Effects with memory: states that the log does not show."""

from math import exp

from eccentric.virtual_bench.effects.record import Builder, Law, PlantedEffect, Request, sign
from eccentric.virtual_bench.plant import Motion

_MICRO_DAMPING_S = 0.01  # sigma_1/sigma_0 of the bristles


def presliding(request: Request) -> PlantedEffect:
    """Compliant contact (seal, grease, strain-wave gear) that builds up torque over x0 after each reversal.

    Dahl 1968: dz = dx/x0 (1 - z sgn dx), solved exactly over each step. LuGre (Canudas de Wit 1995) has a
    level g that falls with the speed, here towards 0.6 of its value at rest, over which the bristles bend as
    well, dz = dx/x0 (1 - z sgn(dx)/g), and a torque in proportion to dz/dt.
    """
    x0 = request.draw(0.08, 0.3)
    reach, vs = x0 / request.plant.mu, 0.1 * request.setting.top_speed
    falls = request.variant == "lugre"

    def start() -> dict[str, Law]:
        z, travel = 0.0, 0.0

        def torque(s: Motion, a: float) -> float:
            nonlocal z, travel
            way = sign(s.w_mid)
            level = 0.6 + 0.4 * exp(-((s.w_mid / vs) ** 2)) if falls else 1.0
            z = way * level + (z - way * level) * exp(-(s.travel - travel) / (reach * level))
            travel = s.travel
            rate = (s.w_mid - abs(s.w_mid) * z / level) / reach if falls else 0.0
            return a * (z + _MICRO_DAMPING_S * rate)

        return {"torque": torque}

    form = (
        f"A (z + {_MICRO_DAMPING_S} dz/dt), dz/dx = (1 - z sgn(w)/g)/x0, g = 0.6 + 0.4 exp(-(w/vs)^2)"
        if falls
        else "A z, dz/dx = (1 - z sgn w)/x0"
    )
    shape = (x0, vs) if falls else (x0,)
    return PlantedEffect(
        "presliding",
        form,
        request.torque(),
        start,
        ("history", "direction"),
        shape,
        variant=request.variant,
    )


def magnetic_hysteresis(request: Request) -> PlantedEffect:
    """Remanent magnetisation: the torque lags the current in a loop of half-width A in torque.

    An elastic-plastic element of the current, dz = di/i0 within [-1, 1]. Duhem's smooth form was tried: the
    drive's ripple at each pulse pulls its loop to the centre, but iron does not follow changes that small.
    """
    i0 = request.draw(0.3, 0.6) * request.setting.current

    def start() -> dict[str, Law]:
        z, last = 0.0, 0.0

        def torque(s: Motion, a: float) -> float:
            nonlocal z, last
            z = min(1.0, max(-1.0, z + (s.i - last) / i0))
            last = s.i
            return a * z

        return {"torque": torque}

    return PlantedEffect(
        "magnetic_hysteresis",
        "A z, dz = di/i0 within [-1, 1]",
        request.torque(1.3),
        start,
        ("current", "history"),
        (i0,),
    )


BUILDERS: tuple[Builder, ...] = (
    presliding,
    magnetic_hysteresis,
)
