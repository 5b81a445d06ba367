"""What a rig declares of its body and motor, against the closed forms of the paper."""

import math
from typing import Any

import pytest

from eccentric.rigs import Rig, read_rig
from eccentric.signals.quality.ratios import gravity_of, inertia_of, torque_per_unit, upright_gravity_of

M, L, MU, J_M, J_L, K_I, R = 0.5, 0.25, 0.2, 2e-4, 0.04, 0.02, 1.6
KNOWN = {
    "M_kg": M, "L_m": L, "mu": MU, "J_m_kgm2": J_M, "J_l_kgm2": J_L, "k_i_Nm_per_A": K_I, "R_ohm": R,
}  # fmt: skip


def rig(without: str = "", **place: Any) -> Rig:
    """Return a rig in a plane that the case or the tilt gives, one quantity left out."""
    return read_rig({"known": {k: x for k, x in KNOWN.items() if k != without} | place})


@pytest.mark.parametrize(
    ("place", "expected"),
    [({"case": "C2"}, 1.0), ({"case": "C1"}, 0.0), ({"phi_rad": 1.1}, math.cos(1.1))],
    ids=["upright", "level", "tilted"],
)
def test_gravity_is_the_weight_of_the_mass_in_the_plane_at_the_motor(
    place: dict[str, Any], expected: float
) -> None:
    """Mu M L g cos(phi); in a level plane none is left, not even the rounding of cos(pi/2)."""
    upright = MU * M * L * 9.81

    assert gravity_of(rig(**place)) == pytest.approx(expected * upright, rel=1e-14, abs=0.0)
    assert upright_gravity_of(rig(**place)) == pytest.approx(upright, rel=1e-14)


def test_the_inertia_is_that_of_rotor_and_link_at_the_motor() -> None:
    """J_m + mu^2 J_l."""
    assert inertia_of(rig(case="C1")) == pytest.approx(J_M + MU**2 * J_L, rel=1e-14)


@pytest.mark.parametrize(("drive", "expected"), [("torque", 1.0), ("current", K_I), ("voltage", K_I / R)])
def test_a_unit_of_the_drive_is_worth_its_torque_at_rest(drive: str, expected: float) -> None:
    """k_i for a current, k_i/R for a voltage, without k_e: at rest there is no back-EMF."""
    assert torque_per_unit(drive, rig(case="C2")) == pytest.approx(expected, rel=1e-14)


def test_what_is_not_declared_is_none() -> None:
    """One quantity that is missing is enough."""
    expected = [None] * 5

    assert expected == [
        gravity_of(rig("L_m", case="C2")),
        gravity_of(rig("mu", case="C2")),
        inertia_of(rig("J_l_kgm2", case="C2")),
        torque_per_unit("current", rig("k_i_Nm_per_A", case="C2")),
        torque_per_unit("voltage", rig("R_ohm", case="C2")),
    ]
