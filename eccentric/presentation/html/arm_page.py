"""The page of an arm: its joints in a table, each with a page of its own, and its bodies."""

from __future__ import annotations

from typing import Any

from eccentric.joints import ArmDiagnosis, arm_name, why_not_emitted
from eccentric.presentation.arm import arm_diagnosis_sentence
from eccentric.presentation.diagnosis_text import VERDICTS, verdict_words
from eccentric.presentation.html.text import number, range_of

NOTE = (
    "Errors are RMS values on the held-out part. Each joint is treated as one drive, with the loads from the"
    " other joints as inputs; its own page shows what is missing. The header of its emitted model says which"
    " values of the emitted arm's bearing_loads are its inputs."
)


def _emitted(found: ArmDiagnosis) -> str:
    """What is emitted of the arm as a whole, for the note."""
    if why := why_not_emitted(found):
        return f"The arm as a whole is not emitted: {why}."
    name = arm_name(found)
    return f"The arm with the friction of all joints as fitted is emitted next to this page as {name}."


def arm_view(found: ArmDiagnosis) -> dict[str, Any]:
    """The variables of the template."""
    joints = [
        {
            "href": f"joint_{joint.number}/report.html",
            "name": f"{joint.number} {joint.name}",
            "verdict": verdict_words(joint.verdict, joint.fits_the_rig),
            "effects": ", ".join(effect.id for effect, _ in joint.found.effects) or "-",
            **{model: number(error) for model, error in joint.found.score.rmse["mechanical"].items()},
            "noise": number(joint.found.noise_floor),
            "unit": joint.found.unit,
        }
        for joint in found.joints
    ]
    sums, bodies = [], ""
    if (identified := found.bodies) is not None:
        bodies = (
            "Identified from all joints at once; the values are physically realizable."
            if identified.bodies.explain
            else "Identified from all joints at once; the values are not physically realizable."
        )
        sums = [
            {"words": words, "value": number(e.value), "interval": range_of(e.interval), "unit": e.unit}
            for words, e in zip(identified.sums, identified.estimates.values(), strict=True)
        ]
    return {
        "title": f"What is the arm's model missing? {', '.join(found.names)}",
        "verdict": found.verdict,
        "verdict_words": VERDICTS[found.verdict],
        "sentence": arm_diagnosis_sentence(found),
        "note": f"{NOTE} {_emitted(found)}",
        "joints": joints,
        "bodies": bodies,
        "sums": sums,
        "warnings": list(found.warnings),
    }
