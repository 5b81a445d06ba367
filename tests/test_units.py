"""Units of users become SI, and what is no unit, or the wrong one, is refused."""

from __future__ import annotations

import math

import pytest

from eccentric.core import InputError
from eccentric.logs import parse_unit, parse_value, require_unit

TURN = 2.0 * math.pi
VALUES = {
    "60 rpm": ("rad/s", TURN),
    "1 rev/s": ("rad/s", TURN),
    "180 deg/s": ("rad/s", math.pi),
    "500 counts": ("rad", math.pi),
    "250 ms": ("s", 0.25),
    "40 us": ("s", 4e-5),
    "500 g": ("kg", 0.5),
    "25 cm": ("m", 0.25),
    "-30 mA": ("A", -0.03),
    "1.5e3 mV": ("V", 1.5),
    "20 mNm/A": ("N m/A", 0.02),
    "20 mN m / A": ("N m/A", 0.02),
    "0.2 V s/rev": ("V s/rad", 0.2 / TURN),
    "0.2 Vs/rev": ("V s/rad", 0.2 / TURN),
    "6 V/krpm": ("V s/rad", 6.0 * 60.0 / (1000.0 * TURN)),
    "200 g cm^2": ("kg m^2", 2e-5),
    "200 gcm2": ("kg m^2", 2e-5),
    "3 kg m²": ("kg m^2", 3.0),
    "850 mΩ": ("ohm", 0.85),
    "2 \u2126": ("ohm", 2.0),
    "180 degrees": ("rad", math.pi),
    "180 °": ("rad", math.pi),
    "180 °/s": ("rad/s", math.pi),
    "36 km/h": ("m/s", 10.0),
    "25 mph": ("m/s", 25.0 * 1609.344 / 3600.0),
    "90 m/min": ("m/s", 1.5),
    "9.81 m/s/s": ("m/s^2", 9.81),
    "9.81 m s^-2": ("m/s^2", 9.81),
    "2 N m/(rad/s)": ("N m s", 2.0),
    "0.02 V s": ("N m/A", 0.02),
    "1/30": ("1", 1.0 / 30.0),
    "20 %": ("1", 0.2),
    "300 K": ("degC", 26.85),
    "-5 degC": ("degC", -5.0),
}


@pytest.mark.parametrize("text", VALUES)
def test_value_with_unit_in_si(text: str) -> None:
    """A number with a unit has the SI value that the definition of the unit gives (2000 counts per turn)."""
    required, expected = VALUES[text]
    counts = 1000.0 if "counts" in text else None
    assert parse_value(text, required, "rig", counts) == pytest.approx(expected, rel=1e-14, abs=1e-12)


BAD = {
    "furlong": ("m", "unknown unit 'furlong'; known are m, cm, mm$"),
    "RPM": (
        "rad/s",
        "unknown unit 'RPM'; did you mean 'rpm'\\? known are rad/s, deg/s, rev/s, rpm, counts/s$",
    ),
    "N m/amp": ("N m/A", "unknown unit 'amp' in 'N m/amp'; did you mean 'N m/A'\\?"),
    "Hz": ("rad/s", "unknown unit 'Hz'"),
    "V": ("N m/A", "expected a unit like N m/A, mNm/A, V s/rad, .*, got 'V'"),
    "counts": ("rad", "requires encoder_counts_per_rev"),
    "V/rad s": ("V s/rad", "ambiguous after '/': write parentheses"),
    "N m/": ("N m", "incomplete"),
    "*m": ("m", "without a unit before it"),
    "(m": ("m", "unmatched '\\('"),
    "m)": ("m", "unmatched '\\)'"),
    "": ("m", "got an empty text"),
    "m^99": ("m", "power above 9"),
    "m$": ("m", "not understood at '\\$'"),
}


@pytest.mark.parametrize("text", BAD)
def test_bad_unit_is_refused(text: str) -> None:
    """What is no unit, ambiguous, or of another dimension is refused, and where is said."""
    required, expected = BAD[text]
    with pytest.raises(InputError, match=f"^rig: .*{expected}"):
        require_unit(text, required, "rig")


@pytest.mark.parametrize("text", ["kg", "1/0 kg", "0.5", "a lot", ""])
def test_bad_value_is_refused(text: str) -> None:
    """A value for a mass needs a finite number and a unit of mass."""
    with pytest.raises(InputError, match=r"^rig: M: "):
        parse_value(text, "kg", "rig: M")


def test_kelvin_inside_a_product_is_a_difference() -> None:
    """1/K has no offset: a coefficient per kelvin is one per degree Celsius."""
    assert parse_unit("1/K", "rig").to_si(0.004) == parse_unit("1/degC", "rig").to_si(0.004) == 0.004
