"""What was identified from a log, beside what others state of its rig: the tables "What was identified"."""

from __future__ import annotations

from benchmarks.measured_page import Cell, Table, table
from eccentric.diagnosis import Diagnosis


def _identified(found: Diagnosis, shown: dict[str, tuple[str, float]]) -> dict[str, list[Cell]]:
    """Estimates of the shipped model: name -> label with the unit, factor to that unit."""
    every = found.models.extended.estimates
    return {
        label: [factor * every[name].value, [factor * x for x in every[name].interval]]
        for name, (label, factor) in shown.items()
        if name in every
    }


def _with_known(rows: dict[str, list[Cell]], known: dict[str, Cell]) -> dict[str, list[Cell]]:
    """A column more: what others say."""
    return {label: [*row, known.get(label)] for label, row in rows.items()}


def _servo(found: Diagnosis) -> Table:
    shown = {
        "R/k_i": ("R/k_i [V/(N m)]", 1.0),
        "k_e": ("k_e [V s/rad]", 1.0),
        "J_m": ("J_m, rotor and gear [g m^2]", 1e3),
        "theta_zero_rad": ("zero angle [rad]", 1.0),
        "C_m": ("C, Coulomb [mN m]", 1e3),
        "B_m": ("B, viscous [mN m s/rad]", 1e3),
        "C_lN": ("C_lN, by F_N [mm]", 1e3),
        "B_lN": ("B_lN, by F_N [mm s/rad]", 1e3),
        "load_eta": ("eta, by the load", 1.0),
        "load_eta_2": ("eta_2, by its square [1/(N m)]", 1.0),
        "resistance_alpha": ("alpha, of the resistance [%/K]", 100.0),
    }
    # Fits of this servo by others: R 2.8 to 4.8 ohm, k_t 0.32 to 0.39 N m/A, inertia 1.6 to 1.8 g m^2.
    published: dict[str, Cell] = {
        "R/k_i [V/(N m)]": [2.8 / 0.39, 4.8 / 0.32],
        "k_e [V s/rad]": [0.32, 0.39],
        "J_m, rotor and gear [g m^2]": [1.6, 1.8],
        "alpha, of the resistance [%/K]": 0.39,
    }
    rows = _with_known(_identified(found, shown), published)
    return table(["quantity", "value", "95 % interval", "elsewhere"], rows)


def _screw(found: Diagnosis) -> Table:
    shown = {
        "C_m": ("C, Coulomb [mN m]", 1e3),
        "B_m": ("B, viscous [mN m s/rad]", 1e3),
        "T_load": ("constant load [mN m]", 1e3),
        "stribeck_A": ("A, Stribeck torque [mN m]", 1e3),
        "stribeck_v": ("v, Stribeck velocity [rad/s]", 1.0),
    }
    shown = {name: how for name, how in shown.items() if name in found.models.extended.estimates}
    return table(["quantity", "value", "95 % interval"], _identified(found, shown))


def _disc(found: Diagnosis) -> Table:
    scale, values, channels = found.models.linear.scale or 1.0, found.models.linear.values, found.channels
    estimates = found.models.linear.estimates
    rows: dict[str, list[Cell]] = {
        "input delay [ms]": [1e3 * channels.alignment.input_delay_s, None, None],
        "zero angle [rad]": [
            estimates["theta_zero_rad"].value,
            list(estimates["theta_zero_rad"].interval),
            None,
        ],
        "offset [V]": [
            estimates["voltage_offset_V"].value,
            list(estimates["voltage_offset_V"].interval),
            None,
        ],
        # The simulator of the source: J, tau and K of a model with viscous friction only.
        "R/k_i [V/(N m)]": [scale, list(estimates["R/k_i"].interval), 0.397973 / (10.5082 * 2.44211e-4)],
        "inertia [g m^2]": [1e3 * (values["J_m"] + values["J_l"]), None, 0.244211],
        "Coulomb [V]": [scale * estimates["C_m"].value, [scale * x for x in estimates["C_m"].interval], None],
        "viscous and back-EMF [V s/rad]": [
            scale * estimates["B_m"].value,
            [scale * x for x in estimates["B_m"].interval],
            1.0 / 10.5082,
        ],
    }
    return table(["quantity", "value", "95 % interval", "simulator of the source"], rows)


def _direct(found: Diagnosis) -> Table:
    values, g = found.models.extended.values, 9.81
    arm = found.models.extended.estimates["L"]
    # 0.546 kg at 0.5 m; rod and mount, 0.13 kg, put the centre of the whole at 0.45 m: a rod of 0.48 m.
    inertia = 0.546 * 0.5**2 + 0.13 * 0.48**2 / 3 + 36 * 6.07e-5
    gravity = [values["M"] * g * length for length in (arm.value, *arm.interval)]
    rows = _identified(found, {"C_m": ("C, Coulomb [N m]", 1.0), "B_m": ("B, viscous [N m s/rad]", 1.0)})
    known: dict[str, Cell] = {
        "gravity torque, arm level [N m]": 0.676 * g * 0.45,
        "inertia [kg m^2]": inertia,
    }
    rows = {
        "gravity torque, arm level [N m]": [gravity[0], gravity[1:]],
        "inertia [kg m^2]": [values["J_m"] + values["J_l"], None],
        **rows,
    }
    return table(["quantity", "value", "95 % interval", "from the geometry"], _with_known(rows, known))


IDENTIFIED = {
    "bam_xl330_pendulum": _servo,
    "tro2021_drive1": _screw,
    "tro2021_drive3": _screw,
    "tue_unbalanced_disc": _disc,
    "dfki_ak80_pendulum": _direct,
}
