"""A rig file says what is known of the bench, as one in memory does; what it cannot mean is refused."""

from __future__ import annotations

import dataclasses
import json
import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.rigs import Alignment, names_arm, read_arm_rig, read_rig

SHARED = Path(__file__).parents[1] / ".." / "shared" / "data" / "examples"
RIGS = Path(__file__).parents[1] / "examples" / "rigs"

MINIMAL = '[known]\ncase = "C2"\nmu = 0.2\n'


def written(tmp_path: Path, text: str, name: str = "rig.toml") -> Path:
    """Write a rig file."""
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def test_suffix_and_unit_text_say_the_same(tmp_path: Path) -> None:
    """A key with a unit suffix and a text with a unit give one and the same quantity in SI."""
    suffix = """
[known]
case = "C1"
M_kg = 0.5
M_l_kg = 0.2
L_m = 0.25
mu = 0.2
R_ohm = 1.0
k_i_Nm_per_A = 0.02
k_e_Vs_per_rad = 0.03
J_m_kgm2 = 2e-5
J_l_kgm2 = 0.04
g_m_s2 = 9.81
F_T_N = 1.962
"""
    texts = f"""
[known]
phi = "90 deg"
M = "500 g"
M_l = "0.2 kg"
L = "25 cm"
mu = "1/5"
R = "1000 mohm"
k_i = "20 mNm/A"
k_e = "{0.03 * math.pi * 2.0 / 60.0} V/rpm"
J_m = "200 g cm^2"
J_l = "0.04 kg m^2"
g = "981 cm/s^2"
F_T = "1962 mN"
"""
    expected = read_rig(written(tmp_path, suffix))
    actual = read_rig(written(tmp_path, texts, "texts.toml"))
    assert actual.known == pytest.approx(expected.known, rel=1e-14)
    assert actual.case == expected.case == "C1"


def test_toml_and_json_say_the_same(tmp_path: Path) -> None:
    """The same content in TOML and in JSON is the same rig but for its path."""
    toml = read_rig(written(tmp_path, MINIMAL))
    content = {"known": {"case": "C2", "mu": 0.2}}
    other = read_rig(written(tmp_path, json.dumps(content), "rig.json"))
    assert (toml.known, toml.case, toml.log.columns) == (other.known, other.case, other.log.columns)


@pytest.mark.parametrize(
    ("known", "case", "phi", "model"),
    [
        ('case = "C1"', "C1", math.pi / 2.0, "c1_perpendicular"),
        ('case = "C2"', "C2", 0.0, "c2_parallel"),
        ('case = "c2"', "C2", 0.0, "c2_parallel"),
        ('phi = "0 deg"', "C2", 0.0, "c2_parallel"),
        ("phi_rad = 0.5", None, 0.5, "rotating_link"),
        ('case = "C1"\nphi = "90 deg"', "C1", math.pi / 2.0, "c1_perpendicular"),
    ],
)
def test_case_and_tilt(tmp_path: Path, known: str, case: str | None, phi: float, model: str) -> None:
    """C1 is a tilt of 90 deg, C2 one of 0; each selects its model, any other tilt the general one."""
    rig = read_rig(written(tmp_path, f"[known]\n{known}\nmu = 0.2\n"))
    assert (rig.case, rig.known["phi"], rig.model) == (case, pytest.approx(phi), model)


def test_defaults(tmp_path: Path) -> None:
    """Without more: the paper's gravity, 25 Hz, no delay, zero angle or offset, nothing to estimate."""
    rig = read_rig(written(tmp_path, MINIMAL))
    assert rig.known["g"] == 9.81
    assert rig.sampling.low_pass_hz == 25.0
    assert rig.alignment == Alignment(0.0, 0.0, 0.0)
    assert rig.estimate == rig.aligned == frozenset()
    assert read_rig(written(tmp_path, f"theta_zero_rad = 0\n{MINIMAL}")).aligned == {"theta_zero_rad"}
    assert rig.log.columns is rig.log.drive is rig.sampling.moving_threshold_rad_s is None
    assert rig.warnings == ()


def test_unknown_quantities_have_ranges(tmp_path: Path) -> None:
    """A quantity under [unknown] is a range in SI, and asking for its value is refused."""
    rig = read_rig(written(tmp_path, MINIMAL + '[unknown]\nM_l_kg = [0.0, 0.2]\nM = ["0 g", "80 g"]\n'))
    assert rig.unknown == {"M_l": (0.0, 0.2), "M": (0.0, 0.08)}
    with pytest.raises(InputError, match=r"rig\.toml: expected \[known\] M_l here"):
        rig.value("M_l")


def test_step_up_drive_is_allowed_with_a_warning(tmp_path: Path) -> None:
    """Mu above 1 is possible and unusual."""
    rig = read_rig(written(tmp_path, '[known]\ncase = "C2"\nmu = 3\n'))
    assert rig.known["mu"] == 3.0
    assert "mu = 3 is above 1" in rig.warnings[0]


def test_a_column_that_is_no_channel_is_told_with_the_channel_that_may_be_meant(tmp_path: Path) -> None:
    """What is listed already is not meant; what resembles nothing has no hint."""
    listed = 'columns = ["time_s", "theta_m_rad", "curent_A", "theta_m_radd", "note"]\n'

    assert read_rig(written(tmp_path, listed + MINIMAL)).warnings == (
        "column 'curent_A' is not a channel, ignored; did you mean 'current_A'?",
        "column 'theta_m_radd' is not a channel, ignored",
        "column 'note' is not a channel, ignored",
    )


def test_inertia_less_than_that_of_the_mass_is_warned_of(tmp_path: Path) -> None:
    """J_l includes M L^2: less than it is possible for no link, as much as it for a massless one."""
    mass = '[known]\ncase = "C2"\nmu = 0.2\nM_kg = 0.5\nL_m = 0.25\nJ_l_kgm2 = '

    (warning,) = read_rig(written(tmp_path, mass + "0.004\n")).warnings

    assert warning.startswith("J_l = 0.004 kg m^2 is less than M L^2 = 0.03125 kg m^2")
    assert read_rig(written(tmp_path, mass + "0.03125\n")).warnings == ()


@pytest.mark.parametrize(
    ("wish", "length_s"),
    [
        ("", 0.0),
        ('average_over = "run"', math.inf),
        ('average_over = "100 ms"', 0.1),
        ("average_over = 0.2", 0.2),
    ],
)
def test_average_is_a_time_or_a_run(tmp_path: Path, wish: str, length_s: float) -> None:
    """A time in seconds or with its unit, a whole run, or none; only a time low-passes the drive as well."""
    rig = read_rig(written(tmp_path, f"{wish}\n{MINIMAL}"))
    assert rig.sampling.average_over == pytest.approx(length_s)
    assert rig.sampling.drive_low_pass_hz == (25.0 if 0.0 < length_s < math.inf else None)


def test_constant_load_may_have_either_sign(tmp_path: Path) -> None:
    """A load is known, or known by a range, in any unit of torque."""
    assert read_rig(written(tmp_path, MINIMAL + 'T_load = "-35 Ncm"\n')).known["T_load"] == pytest.approx(
        -0.35
    )
    unknown = read_rig(written(tmp_path, MINIMAL + "[unknown]\nT_load_Nm = [-0.1, 0.1]\n")).unknown
    assert unknown == {"T_load": (-0.1, 0.1)}


def test_runs_to_read_are_named(tmp_path: Path) -> None:
    """Names and patterns are kept for the log; none means all."""
    assert read_rig(written(tmp_path, 'runs = ["a", "b_*"]\n' + MINIMAL)).log.runs == ("a", "b_*")
    assert read_rig(written(tmp_path, MINIMAL)).log.runs == ()


def test_the_parts_of_a_drive_are_kept_by_kind(tmp_path: Path) -> None:
    """Several parts of one kind are joined by a plus sign; what a rig does not say is not there."""
    text = 'gear = "planetary + belt"\nlubricant = "grease"\n[known]\ncase = "C1"\nmu = "1/5"'
    rig = read_rig(written(tmp_path, text))

    assert {"gear": ("planetary", "belt"), "lubricant": ("grease",)} == rig.parts


@pytest.mark.parametrize(
    ("gear", "mu", "expected"), [("worm", "1", ("output",)), ("worm", "1/60", None), ("belt", "1", None)]
)
def test_a_reducer_of_ratio_one_hides_the_angle_of_its_motor(
    tmp_path: Path, gear: str, mu: str, expected: tuple[str, ...] | None
) -> None:
    """A worm gear has no ratio of 1: the log is on its output. A belt may have it."""
    text = f'gear = "{gear}"\n[known]\ncase = "C1"\nmu = "{mu}"'

    assert expected == read_rig(written(tmp_path, text)).parts.get("angle")


def test_estimate_is_kept_for_the_fit(tmp_path: Path) -> None:
    """What is to be estimated starts from 0 and is named."""
    rig = read_rig(written(tmp_path, 'input_delay_s = 0.025\ntheta_zero_rad = "estimate"\n' + MINIMAL))
    assert (rig.alignment.input_delay_s, rig.alignment.theta_zero_rad) == (0.025, 0.0)
    assert rig.estimate == {"theta_zero_rad"}


C2 = '[known]\ncase = "C2"\n'
BAD_BELOW = {
    "M_kg = -0.5": "M_kg: expected a value at least 0 kg, got -0.5",
    "mu = 0": "mu: expected a value above 0, got 0",
    "mu = -0.2": "mu: expected a value above 0",
    "R_ohm = 0.0": "R_ohm: expected a value above 0 ohm, got 0.0",
    "k_i_Nm_per_A = 0.0": "k_i_Nm_per_A: expected a value above 0 N m/A",
    "J_m_kgm2 = nan": "J_m_kgm2: expected a finite number, got nan",
    "L_m = inf": "L_m: expected a finite number, got inf",
    "L_m = true": "L_m: expected a number, got True",
    "L_m = [1]": "L_m: expected a number, got [1]",
    "k_e = 0.2": 'expected a text with a unit, as in k_e = "0.1 V s/rad", got 0.2',
    'k_e = "0.2 V"': "k_e: expected a unit like",
    'k_e = "0.2 V s/furlong"': "unknown unit 'furlong' in 'V s/furlong'",
    "M_g = 500": "[known]: unknown key 'M_g'; did you mean 'M_kg'?",
    'M_kg = 0.5\nM = "0.5 kg"': "expected M only once, got twice",
    "M_kg = 0.5\n[unknown]\nM_kg = [0.0, 1.0]": "expected M only once",
    "[unknown]\nM_l_kg = 0.2": "expected a range of two values, [lower, upper],",
    "[unknown]\nM_l_kg = [0.2, 0.1]": "expected a range with lower below upper",
    "[unknown]\nM_l_kg = [-0.2, 0.1]": "expected a value at least 0 kg, got -0.2",
    'Mass = "489 g"': "[known]: unknown key 'Mass'; known are M, M_l, L, mu",
    'mu = "1:5"': "mu: expected a ratio with '/', as in '1/5', got '1:5'",
    "zz = 3": "'zz'; known are M_kg, M_l_kg, L_m, mu, R_ohm, k_i_Nm_per_A",
    'zz = "3 kg"': "'zz'; known are M, M_l, L, mu, R, k_i, k_e, J_m, J_l, g, F_T",
    '[columns]\nspeed = "n"': "[columns]: unknown key 'speed'",
    "[columns]\ntime = 3": "[columns] time: expected a table, got 3",
    '[columns]\ntime = {unit = "s"}': "expected a column name or arithmetic, got None",
    '[columns]\ntime = {column = "t", unit = "V"}': "time: expected a unit like s, ms, us",
    '[columns]\ntime = {column = "t", units = "s"}': "'units'; did you mean 'unit'?",
    '[columns]\nrun = {column = "t", unit = "s"}': "run: expected no unit",
    '[columns]\ntheta_m = {column = "q", unit = "counts"}': "encoder_counts_per_rev",
    '[columns]\ntheta_m = "a"\ntheta_l = "b"': "expected only one of theta_m and theta_l",
    '[columns]\ncurrent = "a"\nvoltage = "a"': "expected a column of its own for current",
}
"""Entries of [known], and tables below it."""
BAD_ABOVE = {
    "holdout = 3": "unknown key 'holdout'; did you mean 'holdout_runs'?",
    'drive = "steam"': "expected one of current, voltage, torque, none",
    'drive = ["current"]': "expected one of current, voltage, torque, none, got ['current']",
    "input_delay_s = -0.1": "input_delay_s: expected a finite number of at least 0",
    'input_delay_s = "guess"': 'input_delay_s: expected a number or "estimate"',
    "holdout_intervals_s = [[2.0, 1.0]]": "expected intervals with start before end",
    "holdout_intervals_s = [1.0]": "a range of two values",
    'holdout_runs = "a"': "holdout_runs: expected a list of names, got 'a'",
    'runs = "a"': "runs: expected a list of names, got 'a'",
    "average_over = 0": "average_over: expected a finite number above 0, got 0",
    'average_over = "0.1 kg"': "average_over: expected a unit like s",
    'average_over = "-0.1 s"': "expected a finite number above 0, got -0.1",
    'average_over = "log"': "average_over: ",
    "encoder_counts_per_rev = 0": "expected a finite number above 0, got 0",
    'gear = "harmonic"': "gear: expected one of strain wave, planetary, worm, ",
    'motor = "coreles"': "got 'coreles'; did you mean 'coreless'?",
    'bearing = ["ball"]': "bearing: expected one of ball, roller, plain, air, none",
    'gear = "worm + none"': "or several joined by +, got",
}
"""Entries at the top."""
BAD = {
    "": "expected [known] case (C1 or C2) or the tilt phi",
    '[known]\ncase = "C3"': "case: expected C1 or C2, got 'C3'",
    '[known]\ncase = "C1"\nphi = "10 deg"': "case C1 means phi = 90 deg",
    "[known]\nphi_rad = 2.0": "phi_rad: expected a value at least 0 and at most 1.5708 rad, got 2.0",
    "known = 3\n": "[known]: expected a table, got 3",
    'gear = "none"\n[known]\ncase = "C2"\nmu = "1/5"': "gear: expected a gear with mu = 0.2, got",
    "[known\n": "rig.toml: not valid TOML: ",
    "\nname = bench\n": 'rig.toml: expected a text in quotes, name = "bench", got',
    C2 + "mu = 1\nmu = 2\n": "rig.toml: expected each key and table only once, got 'mu = 2' again in line 4",
    "gear = 1\ngear = 2": "got 'gear = 2' again in line 2",
    "[known]\n[unknown]\n[known]\n": "got '[known]' again in line 3",
    "\nname = bench x\n": "rig.toml: not valid TOML: Invalid value (at line 2, column 8)",
    **{C2 + below: said for below, said in BAD_BELOW.items()},
    **{f"{above}\n{C2}": said for above, said in BAD_ABOVE.items()},
}


@pytest.mark.parametrize("text", BAD)
def test_bad_rig_is_refused_in_one_line(tmp_path: Path, text: str) -> None:
    """What a rig cannot mean is refused with file, key, what is required and what came."""
    with pytest.raises(InputError) as caught:
        read_rig(written(tmp_path, text))
    message = str(caught.value)
    assert message.startswith(str(tmp_path / "rig.toml"))
    assert BAD[text] in message
    assert "\n" not in message


def test_bad_json_is_refused(tmp_path: Path) -> None:
    """JSON that is cut off, holds a list or a key twice is refused."""
    for text, expected in (
        ('{"known": ', r"not valid JSON: Expecting value: line 1 column 11"),
        ("[1]", r"expected a table, got \[1\]"),
        ('{"drive": "current", "drive": "voltage"}', "expected each key only once, got 'drive' twice"),
    ):
        with pytest.raises(InputError, match=expected):
            read_rig(written(tmp_path, text, "rig.json"))


def test_missing_file_directory_and_suffix_are_refused(tmp_path: Path) -> None:
    """No file, a folder with a rig's name, and a file that is neither TOML nor JSON."""
    (tmp_path / "folder.toml").mkdir()
    for name, expected in (
        ("none.toml", "no such file"),
        ("folder.toml", "expected a regular file, got a directory"),
        ("rig.yaml", "expected a rig file .toml or .json, got '.yaml'"),
    ):
        with pytest.raises(InputError, match=expected):
            read_rig(tmp_path / name)


@pytest.mark.skipif(not SHARED.exists(), reason="the shared example logs are not beside this clone")
@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_sidecars_are_rigs_as_they_stand(number: int) -> None:
    """Every sidecar of the shared examples is read, with its values."""
    path = SHARED / f"example{number}.json"
    content = json.loads(path.read_text())
    rig = read_rig(path)
    assert rig.case == content["known"]["case"]
    assert rig.known["k_i"] == content["known"]["k_i_Nm_per_A"]
    assert rig.known["J_l"] == content["known"]["J_l_kgm2"]
    assert rig.sampling.moving_threshold_rad_s == content["moving_threshold_rad_s"]
    assert [list(pair) for pair in rig.holdout.intervals_s] == content["holdout_intervals_s"]
    assert rig.log.columns is not None
    assert [source.text for source in rig.log.columns.values()] == content["columns"]
    assert rig.warnings == ()


@pytest.mark.parametrize("path", sorted(RIGS.glob("*.toml")), ids=lambda path: path.stem)
def test_example_rigs_are_read(path: Path) -> None:
    """Every rig under examples/rigs is read without a warning; that of an arm, for each of its joints."""
    rigs = read_arm_rig(path).joints if names_arm(path) else (read_rig(path),)

    assert {()} == {rig.warnings for rig in rigs}


# A rig in memory says what its file would say.


EXAMPLES = Path(__file__).parents[1] / "examples"
FILES = [
    path
    for path in [*sorted(EXAMPLES.rglob("*.toml")), EXAMPLES / "bench" / "bench.json"]
    if path.parent.name != "arms" and not names_arm(path)
]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_the_content_of_a_file_is_the_same_rig(path: Path) -> None:
    """Every rig of the examples, parsed and handed over, is the rig that its file is, name and path apart."""
    text = path.read_text(encoding="utf-8")
    content = tomllib.loads(text) if path.suffix == ".toml" else json.loads(text)
    expected, actual = (dataclasses.replace(read_rig(x), path="", name="") for x in (path, content))

    assert expected == actual
    assert ("rig", content.get("name", "rig")) == (read_rig(content).path, read_rig(content).name)


def test_tuples_and_numbers_of_numpy_are_those_of_a_file() -> None:
    """Python types other than lists and floats mean the same."""
    plain = {"known": {"case": "C2", "mu": 0.2}, "holdout_intervals_s": [[1.0, 2.0]], "runs": ["a", "b"]}
    rich = {
        "known": {"case": "C2", "mu": np.float32(0.5) * np.float64(0.4)},
        "holdout_intervals_s": np.array([[1, 2]]),
        "runs": ("a", "b"),
    }

    assert read_rig(plain) == read_rig(rich)


def test_a_rig_is_its_own_rig() -> None:
    """What was read once is not read again."""
    rig = read_rig({"known": {"case": "C1"}})

    assert rig is read_rig(rig)


@pytest.mark.parametrize(
    ("content", "line"),
    [
        (3, "rig: expected a path, a mapping or a Rig, got int"),
        ({"known": {"case": "C2", "M": object()}}, "rig: expected the content of a JSON file (got object)"),
        ({"known": {"case": "C3"}}, "rig: [known] case: expected C1 or C2, got 'C3'"),
        ({"knwon": {}}, "rig: unknown key 'knwon'; did you mean 'known'?"),
    ],
    ids=["number", "object", "case", "key"],
)
def test_what_is_no_rig_is_refused_in_one_line(content: Any, line: str) -> None:
    """As with a file, in place of whose path the line begins with "rig"."""
    with pytest.raises(InputError) as error:
        read_rig(content)

    assert line == str(error.value)
