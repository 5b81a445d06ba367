"""What each effect adds to a balance, as emitted, against its closed form with NumPy; and its energy."""

from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest
import sympy as sp

from eccentric.effects.forms import root
from eccentric.emission import load_module
from eccentric.model import load_model, meaning
from tests.extended import (
    BASE,
    CASES,
    END,
    J_L,
    J_M,
    K_E,
    K_I,
    M_L,
    MEAN,
    MU,
    NEUTRAL,
    WARM,
    G,
    L,
    M,
    R,
    Signals,
    briefly,
    call,
    effects,
    inputs,
    with_effect,
)

J = J_M + MU**2 * J_L


def sine_load(x: Signals) -> np.ndarray:
    """Gravity torque of C2 on the motor side."""
    return MU * M * G * L * np.sin(MU * x["theta_m"])


def normal_force(x: Signals, mass: float = M, g: float = G, shift: float = 0.0) -> np.ndarray:
    """Normal force of C2 from the components of the load."""
    centrifugal, weight = mass * L * (MU * x["omega_m"]) ** 2, (mass + M_L) * g
    angle = MU * x["theta_m"] + shift
    return np.hypot(centrifugal + weight * np.cos(angle), weight * np.sin(angle))


B_LN, C_LN, B_M, C_M, B_LT, C_LT = 0.004, 0.08, 0.0004, 0.008, 0.004, 0.08  # the defaults, Table 1


def friction(x: Signals, case: str, force: np.ndarray | None = None, *, viscous: float | np.ndarray = 1,
             dry: float | np.ndarray = 1) -> np.ndarray:  # fmt: skip
    """Mechanical friction torque by the paper's (7), viscous and dry friction times factors."""
    w, s = x["omega_m"], np.sign(x["omega_m"])
    if case == "C1":
        force = M * L * (MU * w) ** 2 if force is None else force
        across = 0.2 * 9.81  # Table 1's F_T, a parameter with that default
    else:
        force, across = normal_force(x) if force is None else force, 0.0
    damping = B_M + MU**2 * (B_LN * force + B_LT * across)
    return damping * w * viscous + (C_M + MU * (C_LN * force + C_LT * across)) * s * dry


def load(x: Signals, case: str, share: float) -> np.ndarray:
    """Torque passed on to the link: gravity, inertia, friction by F_N, a share of that without."""
    gravity = 0.0 if case == "C1" else sine_load(x)
    without = friction(x, case, np.zeros_like(x["omega_m"]))
    own = friction(x, case) - without
    return gravity + MU**2 * J_L * x["alpha_m"] + own + share * without


def rise(x: Signals, tau: float, state: str) -> np.ndarray:
    """Heating relative to that at the end of the log."""
    return x[state] / (MEAN * (1 - np.exp(-END / tau)))


def efficient(load: np.ndarray, w: np.ndarray, rho: float) -> np.ndarray:
    """Loss of a gear per unit of eta, by cases."""
    return np.where(load * w > 0, 1.0, rho) * np.abs(load) * np.sign(w)


def tilted(x: Signals, angle: float, phase: float) -> np.ndarray:
    """What a tilt adds to friction and load of C1."""
    centrifugal, weight = M * L * (MU * x["omega_m"]) ** 2, (M + M_L) * G * np.sin(angle)
    at = MU * x["theta_m"] + phase
    force = np.hypot(centrifugal + weight * np.cos(at), weight * np.sin(at))
    return friction(x, "C1", force) - friction(x, "C1") + MU * M * G * np.sin(angle) * L * np.sin(at)


def error_rate(x: Signals, rate: float, c: float, s: float) -> np.ndarray:
    """Slope of the motor angle's error over that angle, of an encoder that turns `rate` times as fast."""
    return s * np.cos(rate * x["theta_m"]) - c * np.sin(rate * x["theta_m"])


def by_the_motion(x: Signals, case: str) -> tuple[np.ndarray, np.ndarray]:
    """Changes of the normal force: by the velocity, times that [N]; by the motor angle [N/rad]."""
    turned = MU * x["theta_m"]
    pull, weight = M * L * (MU * x["omega_m"]) ** 2, (M + M_L) * G * (case == "C2")
    force = np.hypot(pull + weight * np.cos(turned), weight * np.sin(turned))
    force = np.where(force == 0.0, 1.0, force)
    faster = 2 * pull * (pull + weight * np.cos(turned)) / force
    return faster, -MU * pull * weight * np.sin(turned) / force


def misread(x: Signals, case: str, rate: float, c: float, s: float) -> np.ndarray:
    """Torque of inertia, gravity and friction at the error of the angle and its derivatives."""
    w, turned = x["omega_m"], MU * x["theta_m"]
    error = (c * np.cos(rate * x["theta_m"]) + s * np.sin(rate * x["theta_m"])) / rate
    slope = error_rate(x, rate, c, s)
    faster, further = by_the_motion(x, case)
    viscous = friction(x, case) - friction(x, case, viscous=0)
    per_force = MU**2 * B_LN * w + MU * C_LN * np.sign(w)
    gravity = MU**2 * M * G * L * np.cos(turned) * (case == "C2")
    inertial = J * (slope * x["alpha_m"] - rate**2 * error * w**2)
    return inertial + slope * (viscous + per_force * faster) + error * (gravity + per_force * further)


def geared(x: Signals, case: str, rate: float, c: float, s: float, shares: tuple[float, float]) -> np.ndarray:
    """What the motor feels of a link that turns by mu theta_m + e, to first order in e.

    shares: of the dry and of the viscous friction without F_N.
    """
    theta, w, alpha = x["theta_m"], x["omega_m"], x["alpha_m"]
    e = c * np.cos(rate * theta) + s * np.sin(rate * theta)
    slope = rate * (s * np.cos(rate * theta) - c * np.sin(rate * theta))
    faster, further = by_the_motion(x, case)
    per_force = MU**2 * B_LN * w + MU * C_LN * np.sign(w)
    unloaded = np.zeros_like(w)
    viscous = friction(x, case) - friction(x, case, viscous=0)
    viscous -= (1 - shares[1]) * (friction(x, case, unloaded) - friction(x, case, unloaded, viscous=0))
    dry = friction(x, case, viscous=0) - (1 - shares[0]) * friction(x, case, unloaded, viscous=0)
    gravity, turned = sine_load(x), MU * (M * G * L) * MU * np.cos(MU * theta)
    carried = MU**2 * J_L * alpha + (gravity * (case == "C2")) + dry + viscous
    felt = slope * (carried + viscous + per_force * faster)
    felt += e * (turned * (case == "C2") + per_force * further)
    return felt / MU + MU * J_L * (slope * alpha - rate**2 * e * w**2)


def twisted(x: Signals, kappa: float, own: float) -> np.ndarray:
    """What gravity and the link's inertia add where the link lags by kappa times its torque, case C2."""
    size = MU * (M * G * L)
    slope, bend = size * MU * np.cos(MU * x["theta_m"]), -size * MU**2 * np.sin(MU * x["theta_m"])
    rate = slope * x["alpha_m"] + bend * x["omega_m"] ** 2
    return -kappa * (load(x, "C2", own) * slope / MU**2 + J_L * rate)


Torque = Callable[[Signals], np.ndarray]
# (case, id, parameters, torque that the effect adds to friction and load [N m], NumPy from the physics)
MECHANICAL: list[tuple[str, str, dict[str, float], Torque]] = [
    *(
        ("C1", f"stribeck[d={d:g}]", {"stribeck_A": 0.3, "stribeck_v": 12.0},
         lambda x, d=d: 0.3 * np.exp(-((np.abs(x["omega_m"]) / 12) ** d)) * np.sign(x["omega_m"]))
        for d in (0.5, 1, 1.5, 2)
    ),
    ("C2", "quadratic_drag", {"drag_2": 2e-4}, lambda x: 2e-4 * x["omega_m"] * np.abs(x["omega_m"])),
    ("C2", "cubic_drag", {"drag_3": 3e-6}, lambda x: 3e-6 * x["omega_m"] ** 3),
    *(
        ("C1", f"sublinear_viscous[n={n:g}]", {"thinning_B": 0.01, "thinning_w": 8.0},
         lambda x, n=n: 0.01 * x["omega_m"] * (1 + (x["omega_m"] / 8) ** 2) ** ((n - 1) / 2))
        for n in (0.5, 0)
    ),
    ("C1", "oneway_windage[+]", {"windage_pos": 1e-4}, lambda x: 1e-4 * np.maximum(x["omega_m"], 0) ** 2),
    ("C1", "oneway_windage[-]", {"windage_neg": 1e-4}, lambda x: -1e-4 * np.minimum(x["omega_m"], 0) ** 2),
    ("C1", "eddy_current", {"eddy_D": 0.01, "eddy_w": 20.0},
     lambda x: 0.01 * x["omega_m"] * 400 / (400 + x["omega_m"] ** 2)),
    ("C1", "coulomb_asymmetry", {"coulomb_asym": 0.03}, lambda x: 0.03 * (x["omega_m"] != 0)),
    ("C1", "viscous_asymmetry", {"viscous_asym": 0.002}, lambda x: 0.002 * np.abs(x["omega_m"])),
    ("C1", "viscosity_temperature", {"viscosity_b": 0.03},
     lambda x: friction(x, "C1", viscous=np.exp(-0.03 * (x["temperature"] - WARM)) - 1, dry=0)),
    ("C1", "viscosity_temperature[arrhenius]", {"viscosity_E": 2500.0},
     lambda x: friction(x, "C1", dry=0,
     viscous=np.expm1(2500 / (273.15 + x["temperature"]) - 2500 / 298.15))),
    ("C1", "viscosity_temperature[bearing]", {"viscosity_B": 0.01, "viscosity_b": 0.03},
     lambda x: 0.01 * x["omega_m"] * np.expm1(-0.03 * (x["temperature"] - WARM))),
    ("C1", "coulomb_temperature", {"coulomb_b": 0.02},
     lambda x: friction(x, "C1", viscous=0, dry=0.02 * (x["temperature"] - WARM))),
    ("C1", "coulomb_temperature[bearing]", {"coulomb_C": 0.02},
     lambda x: 0.02 * np.sign(x["omega_m"]) * (x["temperature"] - WARM)),
    ("C2", "hidden_thermal_drift", {"heat_b": 0.4, "heat_tau": 50.0},
     lambda x: friction(x, "C2") * np.expm1(-0.4 * rise(x, 50, "heat_P"))),
    ("C1", "hidden_thermal_drift[viscous]", {"heat_b": 0.4, "heat_tau": 50.0},
     lambda x: friction(x, "C1", dry=0) * np.expm1(-0.4 * rise(x, 50, "heat_P"))),
    ("C1", "hidden_thermal_drift[bearing]", {"heat_B": 0.01, "heat_b": 0.4, "heat_tau": 50.0},
     lambda x: 0.01 * x["omega_m"] * np.expm1(-0.4 * rise(x, 50, "heat_P"))),
    ("C1", "hidden_thermal_drift[coulomb]", {"heat_C": 0.1, "heat_tau": 50.0},
     lambda x: -0.1 * np.sign(x["omega_m"]) * rise(x, 50, "heat_P")),
    ("C1", "link_harmonic_friction[n=5]", {"link_harmonic_c5": 0.02, "link_harmonic_s5": -0.03},
     lambda x: (0.02 * np.cos(x["theta_m"]) - 0.03 * np.sin(x["theta_m"])) * np.sign(x["omega_m"])),
    ("C1", "link_harmonic_friction[n=1]", {"link_harmonic_c1": 0.02, "link_harmonic_s1": -0.03},
     lambda x: (0.02 * np.cos(x["theta_m"] / 5) - 0.03 * np.sin(x["theta_m"] / 5)) * np.sign(x["omega_m"])),
    ("C1", "motor_harmonic_friction[n=3]", {"motor_harmonic_c3": 0.02, "motor_harmonic_s3": -0.03},
     lambda x: (0.02 * np.cos(3 * x["theta_m"]) - 0.03 * np.sin(3 * x["theta_m"])) * np.sign(x["omega_m"])),
    ("C1", "nonsynchronous_friction", {"nonsync_c": 0.02, "nonsync_s": -0.03, "nonsync_order": 3.57},
     lambda x: (0.02 * np.cos(3.57 * x["theta_m"]) - 0.03 * np.sin(3.57 * x["theta_m"]))
     * np.sign(x["omega_m"])),
    ("C1", "cogging[n=24]", {"cogging_c24": 0.02, "cogging_s24": 0.05},
     lambda x: 0.02 * np.cos(24 * x["theta_m"]) + 0.05 * np.sin(24 * x["theta_m"])),
    ("C1", "kt_ripple[n=7]", {"kt_ripple_c7": 0.1, "kt_ripple_s7": -0.2},
     lambda x: -K_I * x["i"] * (0.1 * np.cos(7 * x["theta_m"]) - 0.2 * np.sin(7 * x["theta_m"]))),
    ("C1", "local_defect", {"defect_A": 0.2, "defect_angle": 1.1, "defect_width": 0.7},
     lambda x: 0.2 * np.exp((np.cos(MU * x["theta_m"] - 1.1) - 1) / 0.49) * np.sign(x["omega_m"])),
    *(
        (case, "load_dependent[transmitted]", {"load_eta": 0.15, "load_share": 0.3},
         lambda x, case=case: 0.15 * np.abs(load(x, case, 0.3)) * np.sign(x["omega_m"]))
        for case in CASES
    ),
    *(
        (case, "load_dependent[progressive]", {"load_eta_2": 0.7, "load_eta": 0.15, "load_share": 0.3},
         lambda x, case=case: (0.7 * load(x, case, 0.3) ** 2 + 0.15 * np.abs(load(x, case, 0.3)))
         * np.sign(x["omega_m"]))
        for case in CASES
    ),
    ("C2", "load_dependent[gravity]", {"load_eta": 0.15},
     lambda x: 0.15 * np.abs(sine_load(x)) * np.sign(x["omega_m"])),
    *(
        (case, f"stribeck_load[{variant},d={d}]", {"loadrise_eta": 0.15, "loadrise_v": 12.0, **more},
         lambda x, case=case, d=d, variant=variant: 0.15 * np.exp(-((np.abs(x["omega_m"]) / 12) ** d))
         * np.abs(sine_load(x) if variant == "gravity" else load(x, case, 0.3)) * np.sign(x["omega_m"]))
        for d in (1, 2)
        for case, variant, more in (
            ("C1", "transmitted", {"loadrise_share": 0.3}),
            ("C2", "transmitted", {"loadrise_share": 0.3}),
            ("C2", "gravity", {}),
        )
    ),
    ("C2", "stribeck_load[F_N]", {"loadrise_C": 0.05, "loadrise_v": 30.0}, lambda x: MU * 0.05
     * normal_force(x) * np.exp(-((x["omega_m"] / 30) ** 2)) * np.sign(x["omega_m"])),
    ("C1", "stribeck_temperature", {"filmrise_A": 0.3, "filmrise_v": 12.0, "filmrise_b": 0.03},
     lambda x: 0.3 * np.sign(x["omega_m"])
     * np.exp(-np.abs(x["omega_m"]) / (12.0 * np.exp(0.03 * (x["temperature"] - WARM))))),
    ("C2", "bearing_load[degressive]", {"bearing_C": 0.05}, lambda x: MU * 0.05
     * np.sqrt(normal_force(x) * (M + M_L) * G) * np.sign(x["omega_m"])),
    ("C2", "bearing_load[progressive]", {"bearing_C": 0.05}, lambda x: MU * 0.05
     * np.sqrt(normal_force(x) ** 3 / ((M + M_L) * G)) * np.sign(x["omega_m"])),
    ("C2", "bearing_load[preload]", {"bearing_Cp": 0.05, "bearing_Fp": 3.0},
     lambda x: MU * 0.05 * np.hypot(normal_force(x), 3.0) * np.sign(x["omega_m"])),
    ("C1", "gear_efficiency[transmitted]", {"gear_eta": 0.2, "gear_share": 0.3, "gear_rho": 0.3},
     lambda x: 0.2 * efficient(load(x, "C1", 0.3), x["omega_m"], 0.3)),
    *(
        (case, f"gear_efficiency[{variant},driven]", {"gear_eta": 0.2, "gear_rho": 2.5, **more},
         lambda x, case=case, variant=variant: 0.2
         * efficient(sine_load(x) if variant == "gravity" else load(x, case, 0.3), x["omega_m"], 2.5))
        for case, variant, more in (
            ("C1", "transmitted", {"gear_share": 0.3}),
            ("C2", "transmitted", {"gear_share": 0.3}),
            ("C2", "gravity", {}),
        )
    ),
    ("C2", "gear_efficiency[gravity]", {"gear_eta": 0.2, "gear_rho": 0.3},
     lambda x: 0.2 * efficient(sine_load(x), x["omega_m"], 0.3)),
    ("C1", "presliding", {"presliding_A": 0.1}, lambda x: 0.1 * (x["presliding_z"] - np.sign(x["omega_m"]))),
    ("C1", "presliding[lugre]",
     {"presliding_A": 0.1, "presliding_D": 0.02, "presliding_v": 9.0, "presliding_r": 0.5},
     lambda x: 0.1 * (x["presliding_z"] - np.sign(x["omega_m"])) + 0.02 * (x["omega_m"]
     - np.abs(x["omega_m"]) * x["presliding_z"] / (1 + 0.5 * np.exp(-((x["omega_m"] / 9) ** 2))))),
    ("C1", "backlash", {"backlash_B": 0.01, "backlash_C": 0.2},
     lambda x: -np.sign(x["backlash_left"])
     * (MU**2 * 0.01 * x["omega_m"] + MU * 0.2 * np.sign(x["omega_m"]))),
    ("C2", "backlash", {"backlash_G": 0.9, "backlash_C": 0.02}, lambda x: -np.sign(x["backlash_left"])
     * (0.9 * sine_load(x) + MU * 0.02 * normal_force(x) * np.sign(x["omega_m"]))),
    ("C2", "backlash[lag]", {"backlash_T": 0.1},
     lambda x: -0.1 * x["backlash_side"] * (1 - 2 * x["backlash_left"]) * np.cos(MU * x["theta_m"])),
    ("C1", "cable_spring", {"cable_k": 0.01, "cable_0": 0.02}, lambda x: 0.01 * MU * x["theta_m"] + 0.02),
    ("C1", "gravity_tilt", {"tilt_c": 0.01, "tilt_s": 0.02},
     lambda x: 0.01 * np.cos(MU * x["theta_m"]) + 0.02 * np.sin(MU * x["theta_m"])),
    ("C1", "gravity_tilt[load]", {"tilt_angle": 0.2, "tilt_phase": 0.7}, lambda x: tilted(x, 0.2, 0.7)),
    ("C2", "gravity_tilt", {"tilt_angle": 0.5}, lambda x: sine_load(x) * (np.cos(0.5) - 1)
     - friction(x, "C2") + friction(x, "C2", normal_force(x, g=G * np.cos(0.5)))),
    ("C2", "angle_offset", {"offset_angle": 0.3}, lambda x: friction(x, "C2", normal_force(x, shift=0.3))
     - friction(x, "C2") + MU * M * G * L * (np.sin(MU * x["theta_m"] + 0.3) - np.sin(MU * x["theta_m"]))),
    ("C2", "angle_offset[torque]", {"offset_torque": 0.03}, lambda x: 0.03 * np.cos(MU * x["theta_m"])),
    ("C2", "mass_mismatch", {"mass_ratio": 0.4},
     lambda x: friction(x, "C2", normal_force(x, mass=1.4 * M)) - friction(x, "C2") + 0.4 * sine_load(x)),
    ("C2", "mass_mismatch[inertia]", {"mass_ratio": 0.4}, lambda x: 0.4 * sine_load(x) - friction(x, "C2")
     + friction(x, "C2", normal_force(x, mass=1.4 * M)) + MU**2 * 0.4 * M * L**2 * x["alpha_m"]),
    ("C2", "mass_mismatch[torque]", {"mass_torque": 0.2}, lambda x: 0.2 * sine_load(x)),
    ("C1", "inertia_mismatch", {"inertia_ratio": 0.5}, lambda x: 0.5 * J * x["alpha_m"]),
    ("C2", "ki_mismatch", {"current_scale": 0.2}, lambda x: 0.2 * (J * x["alpha_m"] + sine_load(x))),
    ("C1", "kt_saturation", {"ktsat_c": 0.01, "ktsat_i": 10.0},
     lambda x: K_I * x["i"] - K_I * x["i"] / (1 + (x["i"] / 10) ** 2)),
    ("C1", "magnet_temperature", {"magnet_a": 0.002, "magnet_0": 0.1},
     lambda x: K_I * x["i"] * (0.002 * (x["temperature"] - WARM) - 0.1)),
    ("C1", "magnetic_hysteresis", {"hysteresis_A": 0.03}, lambda x: 0.03 * x["hysteresis_z"]),
    ("C1", "magnetic_hysteresis[play]", {"hysteresis_A": 0.03, "hysteresis_i": 2.0},
     lambda x: 0.03 * (x["i"] / 2 - x["hysteresis_p"])),
    ("C1", "current_bias", {"bias_i": 0.4}, lambda x: np.full_like(x["i"], K_I * 0.4)),
    ("C1", "wear_runin", {"wear_C": 0.05, "wear_tau": 20.0},
     lambda x: 0.05 * np.exp(-x["t"] / 20) * np.sign(x["omega_m"])),
    ("C1", "wear_runin[travel]", {"wear_C": 0.05, "wear_x": 300.0},
     lambda x: 0.05 * np.exp(-x["wear_s"] / 300) * np.sign(x["omega_m"])),
    ("C1", "time_drift", {"drift_C": 0.001}, lambda x: 0.001 * x["t"] * np.sign(x["omega_m"])),
    ("C1", "time_drift[all]", {"drift_rate": -0.004}, lambda x: -0.004 * x["t"] * friction(x, "C1")),
    ("C1", "sensor_delay", {"delay_d": 0.01}, lambda x: -0.01 * K_I * x["delay_slope"]),
    *(
        (case, f"encoder_eccentricity[{where}]", {"eccentric_c": 0.02, "eccentric_s": -0.03},
         lambda x, case=case, rate=rate: misread(x, case, rate, 0.02, -0.03))
        for where, rate in (("motor", 1.0), ("link", MU))
        for case in CASES
    ),
    *(
        (case, f"kinematic_error[{where},n={n}]",
         {"kinematic_c": 0.02, "kinematic_s": -0.03, "kinematic_share": 0.3, "kinematic_share_B": 0.6},
         lambda x, case=case, rate=n * rate: geared(x, case, rate, 0.02, -0.03, (0.3, 0.6)))
        for where, rate in (("motor", 1.0), ("link", MU))
        for n in (1, 2)
        for case in CASES
    ),
    ("C2", "joint_compliance", {"compliance": 0.01, "compliance_share": 0.3},
     lambda x: twisted(x, 0.01, 0.3)),
]  # fmt: skip
# (id, parameters, voltage that the effect takes [V])
ELECTRICAL: list[tuple[str, dict[str, float], Torque]] = [
    ("current_bias", {"bias_i": 0.4}, lambda x: np.full_like(x["i"], -R * 0.4)),
    ("inverter_deadtime", {"deadtime_u": 0.7, "deadtime_i": 0.3}, lambda x: 0.7 * np.tanh(x["i"] / 0.3)),
    ("resistance_temperature", {"resistance_alpha": 0.004},
     lambda x: R * x["i"] * 0.004 * (x["temperature"] - WARM)),
    ("resistance_temperature[hidden]", {"resistance_rise": 0.2, "resistance_tau": 30.0},
     lambda x: 0.2 * R * x["i"] * rise(x, 30, "resistance_P")),
    ("ke_mismatch", {"armature_k": 0.003}, lambda x: 0.003 * x["omega_m"]),
    ("resistance_mismatch", {"armature_R": 0.1}, lambda x: 0.1 * x["i"]),
    ("armature_inductance", {"armature_L": 0.002}, lambda x: 0.002 * x["armature_slope"]),
    ("sensor_delay", {"delay_d": 0.01}, lambda x: 0.01 * R * x["delay_slope"]),
    *(
        (f"encoder_eccentricity[{where}]", {"eccentric_c": 0.02, "eccentric_s": -0.03},
         lambda x, rate=rate: K_E * x["omega_m"] * error_rate(x, rate, 0.02, -0.03))
        for where, rate in (("motor", 1.0), ("link", MU))
    ),
]  # fmt: skip


# In `make test` each effect is in a module without derivatives; in whole ones among the slow tests.
Made = Callable[[str, str], ModuleType]
made_either_way = pytest.mark.parametrize(
    "made",
    [briefly, pytest.param(lambda *of: with_effect(*of).module, marks=pytest.mark.slow)],
    ids=["brief", "whole"],
)


@made_either_way
@pytest.mark.parametrize(
    ("case", "effect_id", "values", "torque"),
    MECHANICAL,
    ids=[f"{case}-{name}" for case, name, *_ in MECHANICAL],
)
def test_torques_are_those_of_the_formulas(
    case: str, effect_id: str, values: dict[str, float], torque: Torque, made: Made
) -> None:
    """What the mechanical balance loses by an effect is its closed form."""
    module, given = made(case, effect_id), inputs()
    without = call(module, "mechanical_residual", given, **dict.fromkeys(set(values) & set(NEUTRAL), 0.0))
    actual = without - call(module, "mechanical_residual", given, **values)

    # sqrt|w| is kept off its infinite slope at 0 by 1e-6 of its coefficient.
    rooted = any(part in effect_id for part in ("0.5", "1.5", "sqrt"))
    np.testing.assert_allclose(actual, torque(given), rtol=1e-10, atol=1e-6 if rooted else 1e-11)


@made_either_way
@pytest.mark.parametrize(
    ("effect_id", "values", "voltage"), ELECTRICAL, ids=[name for name, *_ in ELECTRICAL]
)
def test_voltages_are_those_of_the_formulas(
    effect_id: str, values: dict[str, float], voltage: Torque, made: Made
) -> None:
    """What the electrical balance loses by an effect is its closed form, as a torque times k_i/R."""
    module, given = made("C1", effect_id), inputs()
    actual = call(module, "electrical_residual", given) - call(module, "electrical_residual", given, **values)

    np.testing.assert_allclose(actual, K_I / R * voltage(given), rtol=1e-10, atol=1e-12)


def test_every_effect_has_its_closed_form() -> None:
    """No id of the library, harmonics of further orders apart, is without a spot value above."""
    spotted = {effect_id for _, effect_id, *_ in MECHANICAL} | {effect_id for effect_id, *_ in ELECTRICAL}
    offered = {e.id for case in CASES for e in effects(case).values() if not e.evidence.repeats}

    # By gear efficiency and load the transmitted torque is the same definition; C1 has it above.
    assert offered - spotted == set()


def test_current_and_voltage_ask_for_what_the_balances_say() -> None:
    """The emitted current and voltage, put back into both balances, leave nothing: a bias acts in both."""
    module, given = with_effect("C1", "current_bias").module, inputs()
    values = {"bias_i": 0.4}
    given["i"] = call(module, "current", given, **values)
    given["u"] = call(module, "voltage", given, **values)

    np.testing.assert_allclose(call(module, "mechanical_residual", given, **values), 0.0, atol=1e-12)
    np.testing.assert_allclose(call(module, "electrical_residual", given, **values), 0.0, atol=1e-12)


def test_scales_compose() -> None:
    """Viscosity by temperature and a drift of all friction multiply."""
    model, x = load_model(BASE["C2"]), inputs()
    model = effects("C2")["viscosity_temperature"].extend(model, {"viscosity_b": 0.03})
    model = effects("C2")["time_drift[all]"].extend(model, {"drift_rate": 0.005})
    falls = np.exp(-0.03 * (x["temperature"] - WARM))

    actual = call(load_module(model), "mechanical_friction_torque", x)

    np.testing.assert_allclose(actual, friction(x, "C2", viscous=falls) * (1 + 0.005 * x["t"]), rtol=1e-12)


@pytest.mark.parametrize("x", [-9.0, -0.25, 0.0, 1e-3, 2.0])
def test_a_root_of_a_magnitude_is_a_millionth_off_at_most(x: float) -> None:
    """sqrt(|x|), and exactly 0 where x is."""
    letter = sp.Symbol("x", real=True)
    symbol, definitions = root("test", letter, "x")
    values: dict[sp.Expr, float] = {letter: x}
    for one in definitions:
        values[one.quantity.symbol] = float(meaning(one.value).subs(values))

    assert abs(x) ** 0.5 == pytest.approx(values[symbol], abs=1.000001e-6)
    assert x != 0.0 or values[symbol] == pytest.approx(0.0, abs=1e-15)


# No effect makes or loses energy that it must not: torque and back-EMF, friction, hysteresis.


FLUX = {
    "kt_ripple[n=7]": {"kt_ripple_c7": 0.1, "kt_ripple_s7": -0.2},
    "kt_saturation": {"ktsat_c": 0.008, "ktsat_i": 10.0},
    "magnet_temperature": {"magnet_a": 0.008, "magnet_0": -0.1},
}


@pytest.mark.parametrize("effect_id", FLUX)
def test_power_into_the_back_emf_is_the_power_of_the_torque(effect_id: str) -> None:
    """With k_e = k_i in SI units, u i - R i^2 = tau w at every angle, speed and current; tau is not k_i i."""
    values = FLUX[effect_id] | {"k_e": K_I}
    module, given = briefly("C1", effect_id), inputs() | {"u": np.zeros(40)}
    friction_and_inertia = call(module, "mechanical_friction_torque", given) + J * given["alpha_m"]
    torque = call(module, "mechanical_residual", given, **values) + friction_and_inertia
    voltage = -call(module, "electrical_residual", given, **values) * R / K_I

    np.testing.assert_allclose(
        voltage * given["i"] - R * given["i"] ** 2, torque * given["omega_m"], rtol=1e-10, atol=1e-12
    )
    assert np.max(np.abs(torque / (K_I * given["i"]) - 1.0)) > 0.1


def test_saturation_far_below_its_current_is_one_coefficient() -> None:
    """There k_t is k_i (1 - c i^2) whatever i_s: the coefficient is what a log determines."""
    module, given = briefly("C1", "kt_saturation"), inputs()
    plain = call(module, "mechanical_residual", given)
    found = [
        plain
        - call(module, "mechanical_residual", given, ktsat_c=1e-3, ktsat_i=far * np.max(np.abs(given["i"])))
        for far in (100.0, 1000.0)
    ]

    for one in found:
        np.testing.assert_allclose(one, 1e-3 * K_I * given["i"] ** 3, rtol=2e-4, atol=1e-9)


@pytest.mark.parametrize("effect_id", ["time_drift[all]", "coulomb_temperature"])
def test_friction_never_drives(effect_id: str) -> None:
    """At both ends of the search, from -60 to 120 degC and up to ten times the log, it opposes the motion."""
    given, module = inputs(), briefly("C1", effect_id)
    (shape,) = effects("C1")[effect_id].shapes
    for value in (shape.low, shape.high):
        for part in np.linspace(0.0, 1.0, 11):
            at = given | {"t": np.full(40, 10 * END * part), "temperature": np.full(40, 180 * part - 60)}
            torque = call(module, "mechanical_friction_torque", at, **{shape.quantity.name: value})

            assert np.min(torque * given["omega_m"]) >= 0.0


@pytest.mark.parametrize("effect_id", ["magnetic_hysteresis", "magnetic_hysteresis[play]"])
def test_hysteresis_takes_energy(effect_id: str) -> None:
    """A motor that turns against a spring as its current cycles loses work, for every allowed coefficient."""
    (low, high), *_ = effects("C1")[effect_id].bounds
    assert (0.0, None) == (low, high)

    module, rng = briefly("C1", effect_id), np.random.default_rng(3)
    time = np.linspace(0.0, 2.0 * np.pi, 201)[1:]
    for _ in range(5):
        waves = rng.normal(size=(4, 2))
        current = 6.0 * np.sum([a * np.sin(k * time + b) for k, (a, b) in enumerate(waves, 1)], axis=0)
        now, work = dict.fromkeys(module.STATES, 0.0), [0.0, 0.0]
        for turn in range(2):  # the first one ends on the loop
            for before, i in zip(np.roll(current, 1), current, strict=True):
                x = (
                    inputs(1)
                    | {name: np.array([value]) for name, value in now.items()}
                    | {"i": np.array([i])}
                )
                now = dict(zip(module.STATES, np.ravel(call(module, "next_state", x)).tolist(), strict=True))
                x |= {name: np.array([value]) for name, value in now.items()}
                with_it, without = (
                    call(module, "mechanical_residual", x, hysteresis_A=a).item() for a in (0.03, 0.0)
                )
                work[turn] += (with_it - without) * (i - before)

        assert work[1] < 0.0
