"""What the check of a log found wrong, as a sentence of the answer."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from eccentric.diagnosis import Diagnosis
from eccentric.presentation import diagnosis_sentence
from eccentric.signals.table import Finding


@pytest.mark.parametrize(
    ("open_", "text", "expected"),
    [
        (False, "k_i is 0.1 N m/A by the voltage", "k_i is 0.1 N m/A by the voltage."),
        (True, "k_i is 0.1 N m/A by the torque", "k_i is 0.1 N m/A by the torque."),
        (False, "the voltage is 1000 times too large: mV?", "The voltage is 1000 times too large: mV?"),
    ],
)
def test_a_quantity_keeps_its_letter_and_a_question_its_mark(
    bundled: tuple[Diagnosis, Path], open_: bool, text: str, expected: str
) -> None:
    """Whether the rig declares the quantity or leaves it open."""
    found, _ = bundled
    rig = found.rig
    if open_:
        known = {letter: x for letter, x in rig.known.items() if letter != "k_i"}
        rig = replace(rig, known=known, unknown={"k_i": (0.01, 1.0)})
    intake = replace(found.channels.intake, findings=(Finding("contradiction", "k_i", text, 1, "warning"),))
    drive = replace(found.data.drive, channels=replace(found.channels, rig=rig, intake=intake))
    doubted = replace(found, data=replace(found.data, drive=drive))

    assert diagnosis_sentence(doubted).endswith(f"). {expected}")
