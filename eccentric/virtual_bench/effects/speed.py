"""Effects of speed and direction."""

from math import asinh, exp

from eccentric.virtual_bench.effects.record import PlantedEffect, Request, simply
from eccentric.virtual_bench.plant import Motion


def stribeck(request: Request) -> PlantedEffect:
    """Dry friction that falls from breakaway to its kinetic level (Stribeck 1902; Bo and Pavelescu 1982)."""
    vs, power = request.draw(0.06, 0.14) * request.setting.top_speed, float(request.rng.choice([1.0, 2.0]))
    return request.effect(
        "A exp(-(|w|/vs)^d) sgn w",
        request.torque(2.0),
        simply(rise=lambda s, a: a * exp(-((abs(s.w_mid) / vs) ** power))),
        ("velocity",),
        (vs, power),
    )


def quadratic_drag(request: Request) -> PlantedEffect:
    """Turbulent air drag."""
    return request.effect(
        "A w |w|",
        request.torque() / request.setting.speed**2,
        simply(drag=lambda s, a: a * abs(s.w_mid)),
        ("velocity",),
    )


def cubic_drag(request: Request) -> PlantedEffect:
    """Drag proportional to the cube of the speed, as for fans near their design point."""
    return request.effect(
        "A w^3",
        request.torque() / request.setting.speed**3,
        simply(drag=lambda s, a: a * s.w_mid**2),
        ("velocity",),
    )


def oneway_windage(request: Request) -> PlantedEffect:
    """Quadratic drag in one direction only, as from a one-sided scoop."""
    way = float(request.rng.choice([-1.0, 1.0]))
    return request.effect(
        "A w |w| for w of one sign",
        request.torque(1.4) / request.setting.speed**2,
        simply(drag=lambda s, a: a * abs(s.w_mid) if s.w_mid * way > 0.0 else 0.0),
        ("velocity", "direction"),
        (way,),
    )


def coulomb_asymmetry(request: Request) -> PlantedEffect:
    """Dry friction higher in one direction (helical gears, lip seals)."""
    way = float(request.rng.choice([-1.0, 1.0]))
    return request.effect(
        "A sgn w for w of one sign",
        request.torque(1.4),
        simply(dry=lambda s, a: a if s.w_mid * way > 0.0 else 0.0),
        ("direction",),
        (way,),
    )


def viscous_asymmetry(request: Request) -> PlantedEffect:
    """Viscous friction higher in one direction."""
    way = float(request.rng.choice([-1.0, 1.0]))
    return request.effect(
        "A w for w of one sign",
        request.torque(1.4) / request.setting.speed,
        simply(viscous=lambda s, a: a if s.w_mid * way > 0.0 else 0.0),
        ("velocity", "direction"),
        (way,),
    )


def eddy_current(request: Request) -> PlantedEffect:
    """Eddy-current brake: drag that peaks at the speed wc and falls beyond it (Smythe 1942)."""
    wc = request.draw(0.15, 0.35) * request.setting.top_speed
    return request.effect(
        "A w/(1 + (w/wc)^2)",
        request.torque(2.5) / wc,
        simply(drag=lambda s, a: a / (1.0 + (s.w_mid / wc) ** 2)),
        ("velocity",),
        (wc,),
    )


def sublinear_viscous(request: Request) -> PlantedEffect:
    """Shear-thinning grease: Eyring's law (1936), Cross's (1965), or a power law (Sisko 1958).

    Above the speed wc, viscous friction grows less than proportionally.
    """
    wc, name = request.draw(0.03, 0.12) * request.setting.top_speed, request.variant
    forms = {
        "Eyring": ("A wc asinh(w/wc)", lambda x: asinh(x) / x if x else 1.0),
        "Cross": ("A w/(1 + (|w|/wc)^(2/3))", lambda x: 1.0 / (1.0 + x ** (2.0 / 3.0))),
        "power law": ("A wc (|w|/wc)^0.6 sgn w above 0.01 wc", lambda x: max(x, 0.01) ** -0.4),
    }
    form, thinned = forms[name]
    return request.effect(
        form,
        request.torque(3.0) / request.setting.top_speed,
        simply(viscous=lambda s, a: a * thinned(abs(s.w_mid) / wc)),
        ("velocity",),
        (wc,),
        variant=name,
    )


_KELVIN = 273.15


def viscosity_temperature(request: Request) -> PlantedEffect:
    """Oil that thins as it warms: exponentially (Reynolds 1886), or by Arrhenius' law."""
    cold = request.plant.Tamb
    if request.variant == "exponential":
        form, size, bound = (
            "b w (exp(-A (T - Tamb)) - 1)",
            request.strength * 4.0 / request.setting.warming,
            0.15,
        )

        def factor(temperature: float, a: float) -> float:
            return exp(-a * (temperature - cold)) - 1.0
    else:
        form, size, bound = (
            "b w (exp(A (1/T - 1/Tamb)) - 1), T in K",
            request.strength * 4e5 / request.setting.warming,
            1.5e4,
        )

        def factor(temperature: float, a: float) -> float:
            return exp(a * (1.0 / (temperature + _KELVIN) - 1.0 / (cold + _KELVIN))) - 1.0

    return request.effect(
        form,
        size,
        simply(**{"warm viscous": lambda s, a: factor(s.temperature, a)}),
        ("temperature", "velocity"),
        (cold,),
        bound=bound,
        needs_temperature=True,
    )


def coulomb_temperature(request: Request) -> PlantedEffect:
    """Dry friction that falls linearly with temperature."""
    cold = request.plant.Tamb
    return request.effect(
        "-A (T - Tamb) c sgn w",
        1.5 * request.strength / request.setting.warming,
        simply(**{"warm dry": lambda s, a: -a * (s.temperature - cold)}),
        ("temperature",),
        (cold,),
        bound=0.8 / request.setting.warming,
        needs_temperature=True,
    )


def stribeck_temperature(request: Request) -> PlantedEffect:
    """Rise of dry friction near rest whose characteristic speed grows as the oil thins (Hersey 1914)."""
    cold, vs = request.plant.Tamb, request.draw(0.05, 0.1) * request.setting.top_speed
    thins = request.draw(0.03, 0.06)
    return request.effect(
        "A exp(-|w| exp(-b (T - Tamb))/vs) sgn w",
        request.torque(1.5),
        simply(rise=lambda s, a: a * exp(-abs(s.w_mid) * exp(-thins * (s.temperature - cold)) / vs)),
        ("temperature", "velocity"),
        (vs, thins),
        needs_temperature=True,
    )


def hidden_thermal_drift(request: Request) -> PlantedEffect:
    """All friction falls as the drive warms, and the log has no temperature column."""
    cold = request.plant.Tamb

    def falls(s: Motion, a: float) -> float:
        return -a * (s.temperature - cold)

    return request.effect(
        "-A (T - Tamb) f, T heated by the losses and not logged",
        1.5 * request.strength / request.setting.warming,
        simply(**dict.fromkeys(("warm dry", "warm viscous", "warm rise"), falls)),
        ("time", "history"),
        (cold,),
        bound=0.8 / request.setting.warming,
        hides_temperature=True,
    )


def wear_runin(request: Request) -> PlantedEffect:
    """Dry friction of a fresh surface, worn off with the distance travelled (Archard 1953)."""
    distance = request.draw(0.15, 0.35) * request.setting.speed * request.setting.seconds
    return request.effect(
        "A exp(-s/s0) sgn w, s the motor's travel",
        request.torque(2.5),
        simply(dry=lambda s, a: a * exp(-s.travel / distance)),
        ("time", "history"),
        (distance,),
    )


def time_drift(request: Request) -> PlantedEffect:
    """Dry friction that grows steadily with time, as a drying grease does."""
    seconds = request.setting.seconds
    return request.effect(
        "A (t/t_end) sgn w",
        request.torque(1.7),
        simply(dry=lambda s, a: a * s.t / seconds),
        ("time",),
        (seconds,),
    )
