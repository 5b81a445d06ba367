"""A model declares its outputs, and every back end prints what is declared."""

import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import cffi
import jax
import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.emission import Choice, executed, render
from eccentric.model import (
    Expressions,
    Input,
    Interface,
    Model,
    Output,
    drive_interface,
    load_model,
    meaning,
    symbols,
)
from eccentric.model import vocabulary as v
from tests import jaxed
from tests.compiled import FLAGS

OMEGA = np.linspace(-40.0, 40.0, 9)
THETA = np.linspace(-7.0, 9.0, 9)


def with_power_and_energy(model: Model) -> Interface:
    """Those of a drive, the power of its friction, and the energy of its mass."""
    given = drive_interface(model)
    friction = next(x for x in given.outputs if x.name == "mechanical_friction_torque")
    M, L, mu, omega_m = symbols(v.M, v.L, v.mu, v.omega_m)

    def power() -> Expressions:
        ((_, torque),) = (found := friction.expressions()).results
        return replace(found, results=(("", torque * omega_m),))

    def energy() -> Expressions:
        return Expressions((("moving", M * (L * mu * omega_m) ** 2 / 2), ("at_rest", M * 0)))

    own = (
        replace(friction, name="friction_power", unit="W", meaning="power of friction", expressions=power),
        Output("energies", "J", "energy of the mass", (Input(v.omega_m),), energy),
    )
    return replace(
        given, outputs=(*given.outputs, *own), constants={**given.constants, "ENERGIES": "energies"}
    )


MODEL = replace(load_model("c2_parallel"), name="declared", declares=with_power_and_energy)


def test_numpy_and_jax_print_what_is_declared() -> None:
    """Power is torque times velocity, and the energy M (L mu omega_m)^2/2, with Table 1."""
    numpy = executed(render(MODEL, backends=("numpy",)), "declared")
    with jax.enable_x64(True):
        for module in (numpy, jaxed.executed(MODEL)):
            torque = module.mechanical_friction_torque(THETA, OMEGA)
            energy = module.energies(OMEGA)

            assert ("moving", "at_rest") == module.ENERGIES
            np.testing.assert_allclose(module.friction_power(THETA, OMEGA), torque * OMEGA, 1e-14)
            np.testing.assert_allclose(energy[:, 0], 0.5 * (0.25 * 0.2 * OMEGA) ** 2 / 2, 1e-14)
            assert np.all(energy[:, 1] == 0.0)


def test_c_prints_what_is_declared(tmp_path: Path) -> None:
    """The same under its prefix; it compiles silently."""
    files = render(MODEL, backends=("numpy", "c99"))
    for file, text in files.items():
        (tmp_path / file).write_text(text, encoding="utf-8")
    subprocess.run(
        ["gcc", *FLAGS, "-shared", "-fPIC", "declared.c", "-o", "declared.so", "-lm"],
        check=True,
        cwd=tmp_path,
    )
    ffi = cffi.FFI()
    ffi.cdef("double declared_friction_power_double(double, double, void *);")
    ffi.cdef("extern char declared_default_double;")
    library: Any = ffi.dlopen(str(tmp_path / "declared.so"))
    expected = executed(files, "declared").friction_power(THETA, OMEGA)
    coefficients = ffi.addressof(library, "declared_default_double")
    found = [
        library.declared_friction_power_double(*x, coefficients)
        for x in zip(THETA.tolist(), OMEGA.tolist(), strict=True)
    ]

    # The coefficients of C are from 50 digits, those of NumPy from double precision.
    np.testing.assert_allclose(found, expected, 1e-14)


def test_a_choice_knows_what_is_declared() -> None:
    """It is emitted alone, and listed where a name is unknown."""
    module = executed(render(MODEL, backends=("numpy",), choice=Choice(("friction_power",))), "declared")
    assert {"Parameters", "friction_power"} == set(module.__all__)
    with pytest.raises(InputError, match=r"expected one of .*, friction_power, energies, got 'power'"):
        render(MODEL, backends=("numpy",), choice=Choice(("power",)))


def test_the_outputs_of_one_drive_follow_from_its_balances() -> None:
    """Friction is the sum of the friction terms; the armature's parameters are those of its terms."""
    model = load_model("rotating_link")
    outputs = {output.name: output for output in drive_interface(model).outputs}
    ((_, friction),) = outputs["mechanical_friction_torque"].expressions().results
    stated = outputs["mechanical_friction_torque"].expressions().definitions
    for a in reversed(stated):
        friction = friction.xreplace({a.target: a.value})
    expected = model.expand(model.balance("mechanical").sum_of("friction"))

    assert 0 == (meaning(friction) - meaning(expected)).expand()
    assert ("R", "k_i", "k_e") == outputs["friction_torque"].needs
    assert ("J_m", "J_l") == outputs["voltage"].requires
