"""Bad rigs of a linear axis: one line each, which names the file, the key, what is required and what came."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eccentric
from eccentric import InputError
from eccentric.rigs import read_rig, rig_complaints
from tests.carriage import RIG, logged

MM: dict[str, Any] = {"column": "q_m", "unit": "mm"}


def changed(**entries: Any) -> dict[str, Any]:
    """The rig with other entries; those of [columns] go into that table."""
    columns = {key: value for key, value in entries.items() if key in {"position", "velocity", "force"}}
    others = {key: value for key, value in entries.items() if key not in columns}
    return RIG | others | {"columns": RIG["columns"] | columns}


@pytest.mark.parametrize(
    ("rig", "message"),
    [
        (
            {key: x for key, x in RIG.items() if key != "kind"},
            'rig: force: expected kind = "linear" with this key',
        ),
        (changed(kind="liner"), "rig: kind: expected one of turning, linear, got 'liner'; did you"),
        (changed(kind=3), "rig: kind: expected one of turning, linear, got 3"),
        (
            changed(position={"column": "q_m", "unit": "deg"}),
            "rig: [columns] position: expected a unit like m, cm, mm, got 'deg'",
        ),
        (
            changed(position={"column": "q_m", "unit": "counts"}),
            "rig: [columns] position: unit 'counts' requires",
        ),
        (
            changed(velocity={"column": "v", "unit": "rpm"}),
            "rig: [columns] velocity: expected a unit like m/s, mm/s, m/min, km/h, mph, got 'rpm'",
        ),
        (
            changed(force={"column": "u_V", "unit": "Nm"}),
            "rig: [columns] force: expected a unit like N, kN, mN, got 'Nm'",
        ),
        (
            changed(force={"column": "u_V", "gain": "35 Nm/V"}),
            "rig: [columns] force gain: expected a unit like N/V, got 'Nm/V'",
        ),
        (changed(force={"column": "u_V", "gain": 35}), 'expected a gain with its unit, as in "35 N/V"'),
        (changed(force={"column": "u_V", "gain": "0 N/V"}), "expected a gain other than 0"),
        (
            changed(force={"column": "u_V", "unit": "A", "gain": "35 N/V"}),
            "force gain: expected a unit like N/A",
        ),
        (changed(position={**MM, "gain": "2 N/V"}), "[columns] position: unknown key 'gain'"),
        (changed(known={"mass": "95 Nm"}), "rig: [known] mass: expected a unit like kg, g, got 'Nm'"),
        (changed(known={"mass": 95}), 'rig: [known] mass: expected a text with a unit, as in mass = "0.1'),
        (changed(known={"mass_kg": -1}), "rig: [known] mass_kg: expected a value at least 0 kg"),
        (changed(known={"pitch": "0 mm"}), "rig: [known] pitch: expected a value above 0 m"),
        (changed(known={"J_m_kgm2": 1}), "rig: [known]: unknown key 'J_m_kgm2'"),
        (changed(known={"case": "C1"}), "rig: [known]: unknown key 'case'"),
        (changed(known={"mass_kg": 1, "mass": "1 kg"}), "rig: expected mass only once, got twice"),
        (changed(unknown={"pitch_m": [0.01, 0.02]}), "[unknown] pitch: expected a value in [known]"),
        (changed(theta_zero_rad=0.1), "rig: unknown key 'theta_zero_rad'"),
        (changed(encoder_counts_per_rev=100), "rig: unknown key 'encoder_counts_per_rev'"),
        (changed(encoder_step_m=0), "rig: encoder_step_m: expected a finite number above 0, got 0"),
        (changed(moving_threshold_m_s=-1), "rig: moving_threshold_m_s: "),
        (changed(drive="torque"), "rig: drive: expected one of current, voltage, force, none, got 'torque'"),
    ],
    ids=lambda x: x[:60] if isinstance(x, str) else "",
)
def test_a_bad_rig_is_refused_in_one_line(rig: dict[str, Any], message: str) -> None:
    """The message names the key as it is in the file, what is required and what was received."""
    with pytest.raises(InputError) as refused:
        read_rig(rig)

    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


def test_keys_of_a_linear_axis_are_none_of_a_turning_one() -> None:
    """Without its kind, a rig of a carriage is told to name it; with the other one, its keys are unknown."""
    rig = {"known": {"case": "C1"}, "columns": RIG["columns"]}
    with pytest.raises(InputError, match=r'rig: force: expected kind = "linear" with this key'):
        read_rig(rig)
    with pytest.raises(InputError, match=r"\[columns\]: unknown key 'position'"):
        read_rig({**rig, "kind": "turning"})


def test_keys_of_another_table_are_sent_where_they_belong() -> None:
    """The check knows the tables of a carriage: what a turning drive has is unknown here, not misplaced."""
    complaints, _ = rig_complaints(RIG | {"mass": "95 kg", "position": "q_m", "case": "C1", "k_i": "1 Nm/A"})
    columns = {**RIG["columns"], "kind": "linear", "pitch_m": 0.01}
    others, _ = rig_complaints(RIG | {"columns": columns})
    found, more = ([one.text for one in told] for told in (complaints, others))

    assert found[:2] == [
        "rig: mass: this key belongs under [known]",
        "rig: position: this key belongs under [columns]",
    ]
    assert [said.partition(";")[0] for said in found[2:]] == [
        "rig: unknown key 'case'",
        "rig: unknown key 'k_i'",
    ]
    assert more == [
        "rig: [columns] kind: this key belongs at the top, above all tables",
        "rig: [columns] pitch_m: this key belongs under [known]",
    ]


def test_a_wrong_unit_is_one_complaint() -> None:
    """A force constant in Nm/A is there, if wrong: it is not said to be missing as well."""
    log = logged(0, seconds=6.0, runs=1)
    columns = {"time": "t_s", "position": "q_m", "current": "u_V"}
    rig = {"kind": "linear", "known": {"k_f": "35 Nm/A"}, "columns": columns}
    (found,) = eccentric.check_rig(log, rig).complaints
    del rig["known"]
    (missing,) = eccentric.check_rig(log, rig).complaints

    assert "[known] k_f: expected a unit like N/A" in found
    assert missing.startswith('rig: expected [known] k_f, as in k_f = "0.05 N/A"')


def test_messages_of_a_fit_have_the_words_of_the_axis() -> None:
    """What only the log shows is refused in the same words: no position, a current without k_f."""
    log = logged(0, seconds=3.0, runs=1)
    with pytest.raises(InputError, match=r"position \(column 'position_m'\) or velocity \(column 'velo"):
        eccentric.fit({"time_s": log["t_s"], "force_N": log["u_V"]}, {"kind": "linear"})
    current = {"time_s": log["t_s"], "position_m": log["q_m"], "current_A": log["u_V"]}
    with pytest.raises(InputError, match=r"expected \[known\] k_f to convert the current to force"):
        eccentric.fit(current, {"kind": "linear"})


def test_a_model_of_another_kind_is_refused() -> None:
    """A turning drive's model has no place on a carriage, nor the other way round."""
    log = logged(0, seconds=3.0, runs=1)
    with pytest.raises(
        InputError, match="c1_perpendicular requires kind = 'turning', got 'linear'; linear_axis"
    ):
        eccentric.fit(log, RIG, "c1_perpendicular")
    turning = {"time_s": log["t_s"], "theta_m_rad": log["q_m"], "torque_Nm": log["u_V"]}
    known = {"case": "C1", "mu": "1", "M": "0 kg", "L": "0 m"}
    with pytest.raises(InputError, match="linear_axis requires kind = 'linear', got 'turning'; c1_perp"):
        eccentric.fit(turning, {"known": known}, "linear_axis")


def test_all_that_is_wrong_is_listed() -> None:
    """`rig --check` names every wrong entry of the rig, and a column that the log does not have."""
    log = logged(0, seconds=3.0, runs=1)
    bad = changed(known={"mass": "95 Nm", "pitch": "1 rad"}, position="x_m")
    found = eccentric.check_rig(log, bad).complaints

    assert len(found) == 3
    assert all(any(part in line for line in found) for part in ("mass", "pitch", "x_m"))


def test_a_good_rig_is_checked_in_its_own_units() -> None:
    """What the log determines is listed with units of a carriage."""
    found = eccentric.check_rig(logged(0, seconds=6.0, runs=1), RIG)

    assert found.complaints == ()
    assert [line.split(" = ")[0] for line in found.estimated[:4]] == ["B", "C", "mass", "F_load"]
    assert " kg, " in found.estimated[2]
    assert np.all(["rad" not in line.split() for line in found.estimated])


def test_a_draft_says_what_an_amplifiers_reference_is_to_be() -> None:
    """A voltage alone drives a carriage as that of its motor; a reference is a force, by a gain."""
    drafted = eccentric.draft_rig(Path("examples/slide/slide.csv.gz"))

    (said,) = drafted.doubts
    assert said.startswith("voltage = u_V: of an amplifier's reference put the force")
    assert 'gain = "35 N/V"' in said


def test_a_wrong_kind_is_one_line() -> None:
    """Not one for each key of the other axis; what else is wrong is listed beside it."""
    turning = {"case": "C1", "mu": 1, "M": "0 kg", "L": "0 m", "k_i": "0.05 N m/A", "R": "-1 ohm"}
    columns = {"time": "t", "theta_m": "q", "current": "i"}
    found, _ = rig_complaints({"kind": "linear", "columns": columns, "known": turning})
    texts = [one.text for one in found]

    assert texts[0].startswith('rig: kind: expected "turning" by theta_m, case, mu, M, L')
    assert ["R"] == [one.key for one in found[1:]]
    found, _ = rig_complaints(
        {"drive": "force", "columns": {"position": "x", "force": "F"}, "known": {"mass": "1 kg"}}
    )
    assert [one.key for one in found] == ["kind"]
