"""The bounds that headers state with any parameters, at random ones and at the worst that a search found.

The search drew drives and states as `tests/random_drives.py` does, and then went on from the worst: states
beside it, letters a little changed. In single precision the emitted double was its exact value, in double
precision 50 digits; errors in double were less by a quarter and more, in units of their own.
"""

import numpy as np
import pytest

from tests import accelerated, accuracy, random_drives
from tests.compiled import Real
from tests.emitted import every_model_in_both
from tests.promised import NAMES, at_50_digits, bounds

DRAWN, SIZE = 300, 200  # drives; states of each in each of the ways to draw them
EXACTLY, BESIDE = 40, 5  # the same where each state is held to 50 digits
LINK = {"M": 2.446616486591386, "M_l": 0.0, "L": 0.5358337833409316, "mu": 1.872632131690714}
LINK |= {"g": 12.315008914265594, "B_lN": 0.5128516915702912, "C_lN": 0.048753563342009906}
# Function, letters other than Table 1's, state in single precision, and its error there.
STEADY_WORST = {
    "force": (
        "normal_force",
        {"M": 26.838785548102898, "M_l": 0.14609862904146215, "L": 2.376451041540727}
        | {"mu": 0.05066639077390469},
        (9173.384765625, 38.71495819091797),
        5.87,
    ),
    "force of a light drive": (
        "normal_force",
        {"M": 0.02210742861192505, "M_l": 0.03608786646245318, "L": 0.06607916987205327}
        | {"mu": 0.1515134663492753, "g": 0.11122828572329603},
        (83.82003021240234, 15.544717788696289),
        6.89,
    ),
    "force, Table 1": ("normal_force", {"mu": 0.2}, (9456.8837890625, 41.394344329833984), 5.60),
    "friction": (
        "friction_torque",
        {"M": 1.1168226301770487, "M_l": 0.0, "L": 0.5034250892461984, "mu": 1.3111413087369048}
        | {"R": 1.0996616943893935, "k_i": 0.020592561335696893, "k_e": 0.012822891294315023}
        | {"B_lN": 0.00265502096537544, "C_lN": 0.003473664167873224}
        | {"B_m": 0.0003035483506610023, "C_m": 0.00011679998146806672},
        (8013.68115234375, -4.077925205230713),
        7.38,
    ),
    "jacobian, Table 1": (
        "friction_torque_jacobian", {"mu": 1 / 30}, (-186.1697998046875, 240.3008575439453), 6.46
    ),
    "gradient": (
        "friction_torque_gradient",
        {"M": 10.541943691561505, "M_l": 21.528586132927153, "L": 0.04388134979939811}
        | {"mu": 1.4176072747048005, "k_e": 0.0, "B_lN": 0.0, "C_lN": 0.00011350114667115457}
        | {"B_m": 0.0, "C_m": 0.0},
        (-13.238251686096191, 0.15450066328048706),
        13.30,
    ),
    "gradient, Table 1": (
        "friction_torque_gradient", {"mu": 1 / 30}, (-4706.60595703125, 18.66274070739746), 5.66
    ),
}  # fmt: skip
LINK_WORST = {
    "gravity": ("normal_force", {"mu": 1 / 30}, (6.877297, -25.12114, -9.548255), 8.02),
    "force": ("normal_force", LINK, (-10.012358665466309, 0.18035829067230225, 0.10416904091835022), 10.06),
    "friction": (
        "friction_torque",
        LINK | {"k_e": 0.0, "B_m": 0.0, "C_m": 0.0},
        (-10.012358665466309, 0.18035829067230225, 0.10406848043203354),
        10.64,
    ),
    "jacobian, Table 1": (
        "friction_torque_jacobian",
        {"mu": 1 / 30, "phi": 1.5707963164856402},
        (-4.181735992431641, 4.658317629946396e-05, -8.200853329753954e-09),
        10.95,
    ),
    "gradient": (
        "friction_torque_gradient",
        LINK | {"k_e": 0.0, "B_m": 0.0, "C_m": 0.0, "C_lN": 0.048758569342832535},
        (-10.012358665466309, 0.18035829067230225, 0.1043097972869873),
        10.28,
    ),
}


def letters(changed: dict[str, float]) -> dict[str, float]:
    """Return Table 1 in double with letters changed, the same in both directions of motion."""
    values = {letter: float(value) for letter, value in vars(accuracy.decimals()).items()}
    return random_drives.directed(values | {"phi": 0.0} | changed, 1.0)


def held(name: str, changed: dict[str, float]) -> dict[str, int]:
    """Return what is promised of each function with these letters."""
    table_1 = set(changed) <= {"mu", "phi"}
    return {key: one.table_1 if table_1 else one.anywhere for key, one in bounds(name).items()}


FEW = ("c2_parallel", accelerated.NAME)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in FEW else pytest.mark.slow) for name in NAMES]
)
def test_any_parameters(name: str) -> None:
    """In single precision every bound holds whatever the parameters, the double being exact beside it."""
    random = np.random.default_rng(20)
    worst: dict[str, float] = {}
    for _ in range(DRAWN):
        values = random_drives.drawn(random)
        states = random_drives.states(name, values, random, SIZE)
        for function, found in random_drives.errors(name, values, states).items():
            worst[function] = float(np.maximum(worst.get(function, 0.0), np.max(found)))  # NaN stays
    for function, one in bounds(name).items():
        assert worst[function] <= one.anywhere, function


@every_model_in_both
def test_any_parameters_at_50_digits(name: str, dtype: Real) -> None:
    """The same at 50 digits in both precisions, at fewer states."""
    random = np.random.default_rng(21)
    for _ in range(EXACTLY):
        values = random_drives.drawn(random)
        states = [x.astype(dtype) for x in random_drives.states(name, values, random, BESIDE)]
        for function, worst in at_50_digits(name, values, states).items():
            assert worst <= bounds(name)[function].anywhere, (function, values)


@pytest.mark.parametrize(
    ("name", "case"),
    [*(("c2_parallel", case) for case in STEADY_WORST), *((accelerated.NAME, case) for case in LINK_WORST)],
)
def test_the_worst_that_were_found(name: str, case: str) -> None:
    """The worst states of the search have the errors that it found, of 50 digits, and keep the bounds."""
    function, changed, state, found = (LINK_WORST if name == accelerated.NAME else STEADY_WORST)[case]
    states = [np.array([x], np.float32) for x in state]
    error = at_50_digits(name, letters(changed), states)[function]

    assert (pytest.approx(found, abs=0.01), True) == (error, error <= held(name, changed)[function])
