"""What `diagnose` takes besides the bundled rig, and what it refuses in one line."""

import gzip
import re
from pathlib import Path

import pytest

from eccentric.cli import main
from eccentric.diagnosis import diagnose
from eccentric.presentation import diagnosis_document, diagnosis_sentence
from eccentric.presentation.html.gather import report_data
from tests import screw

ROOT = Path(__file__).resolve().parent.parent
LOG = ROOT / "examples" / "bench" / "bench.csv.gz"
TOML = ROOT / "examples" / "bench" / "bench.toml"


def rig_with(tmp_path: Path, *changes: tuple[str, str]) -> Path:
    """The bundled rig with lines changed."""
    text = TOML.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "rig.toml").write_text(text, encoding="utf-8")
    return tmp_path / "rig.toml"


@pytest.mark.slow
def test_torque_signal_needs_no_motor_constants(tmp_path: Path) -> None:
    """A rig with a torque signal is diagnosed without k_i, R and k_e, and says nothing of the armature."""
    rig = rig_with(
        tmp_path,
        ('drive = "current"', 'drive = "torque"'),
        ('voltage = "voltage_V"\ncurrent = "current_A"', 'torque = "current_A * 0.063"'),
        ('R = "1 ohm"\n', ""),
        ('k_i = "63 mNm/A"\n', ""),
        ('k_e = "0.063 V s/rad"\n', ""),
    )
    found = diagnose([LOG], rig)

    assert ["link_harmonic_friction"] == [effect.family for effect, _ in found.effects]
    assert {"mechanical"} == set(found.score.rmse)


@pytest.mark.slow
def test_voltage_alone_names_the_same_effect(tmp_path: Path) -> None:
    """With R and k_i known the voltage gives newton metres, and the effect is that of the current."""
    rig = rig_with(tmp_path, ('drive = "current"', 'drive = "voltage"'), ('\ncurrent = "current_A"', ""))
    found = diagnose([LOG], rig)

    assert ["link_harmonic_friction"] == [effect.family for effect, _ in found.effects]
    assert "N m" == found.unit


@pytest.mark.slow
def test_zero_angle_to_be_found_does_not_hide_behind_an_effect(tmp_path: Path) -> None:
    """A zero angle that the rig leaves open is estimated with the effect, not named as another one."""
    rig = rig_with(
        tmp_path,
        ('drive = "current"', 'drive = "current"\ntheta_zero_rad = "estimate"'),
        ('voltage = "voltage_V"\n', ""),
    )
    found = diagnose([LOG], rig)

    assert ["link_harmonic_friction"] == [effect.family for effect, _ in found.effects]


@pytest.mark.slow
def test_zero_angle_and_offset_are_told_once_as_they_were_planted(tmp_path: Path) -> None:
    """Both are in the result once, under the rig's names; their intervals hold what was added to the log.

    The effect is named beside them.
    """
    rig = rig_with(
        tmp_path,
        (
            'drive = "current"',
            'drive = "voltage"\ntheta_zero_rad = "estimate"\nvoltage_offset_V = "estimate"',
        ),
        ('theta_m = "theta_m_rad"', 'theta_m = "theta_m_rad + 0.25"'),
        ('voltage = "voltage_V"\ncurrent = "current_A"', 'voltage = "voltage_V + 0.3"'),
    )
    found = diagnose([LOG], rig)
    assert ["link_harmonic_friction"] == [effect.family for effect, _ in found.effects]
    said = diagnosis_document(found)["rig_identified"]
    shown = {fact.name: fact.value for fact in report_data(found).log.facts}

    assert {"theta_zero_rad", "voltage_offset_V"} == set(said)
    # 0.25 rad at the motor are a fifth of that at the link.
    for name, label, planted in (
        ("theta_zero_rad", "zero angle", 0.25 / 5),
        ("voltage_offset_V", "voltage offset", 0.3),
    ):
        low, high = said[name]["interval_95"]
        assert low <= planted <= high
        assert f"{said[name]['value']:.4g}" == shown[label].split()[0]


@pytest.mark.slow
def test_logs_may_begin_at_any_time(tmp_path: Path) -> None:
    """Two logs, the later one with earlier time stamps, are two runs and not an error."""
    rig = rig_with(tmp_path, ("holdout_intervals_s", "# holdout_intervals_s"))

    lines = gzip.decompress(LOG.read_bytes()).decode().splitlines()
    shifted = [
        lines[0],
        *(f"{float(line.split(',')[0]) + 1000:.3f},{line.split(',', 1)[1]}" for line in lines[1:]),
    ]
    (tmp_path / "late.csv").write_text("\n".join(shifted[:9000]) + "\n", encoding="utf-8")
    (tmp_path / "early.csv").write_text("\n".join([lines[0], *lines[6000:]]) + "\n", encoding="utf-8")
    found = diagnose([tmp_path / "late.csv", tmp_path / "early.csv"], rig)

    assert ["link_harmonic_friction"] == [effect.family for effect, _ in found.effects]
    assert found.setting.duration_s < 61.0


@pytest.mark.parametrize(
    ("effects", "said"),
    [("model.py", "a name that no file"), ("missing.py", "missing.py")],
    ids=["name taken", "missing effects"],
)
def test_what_cannot_be_diagnosed_is_one_line(
    effects: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What diagnose cannot take is named in one line, status 2, and nothing is written."""
    rig = rig_with(tmp_path)
    more = ["--effects", str(tmp_path / effects)]
    status = main(["diagnose", str(LOG), "--rig", str(rig), *more, "--out", str(tmp_path / "out")])
    error = [line for line in capsys.readouterr().err.splitlines() if "warning" not in line]

    assert (2, 1) == (status, len(error))
    assert said in error[0]
    assert not (tmp_path / "out").exists()


def test_two_scripts_of_one_name_are_refused_before_the_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Both would be copied into the result by this name; the log is not even opened."""
    scripts = [str(tmp_path / name) for name in ("a/x.py", "b/x.py")]
    arguments = ["no.csv", "--rig", "no.toml", "--effects", scripts[0], "--model", scripts[1]]
    status = main(["diagnose", *arguments, "--out", str(tmp_path / "out")])

    said = "--effects and --model: expected files of different names, got x.py twice"
    assert (2, f"eccentric: error: {said}\n") == (status, capsys.readouterr().err)


def test_a_model_with_a_hidden_state_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """An effect with a memory is diagnose's to add: a base model that has one is named in one line."""
    model = tmp_path / "bristles.py"
    model.write_text(
        "from eccentric.model import load_model\n"
        "from tests.extended import effects\n\n"
        'model = effects("C2")["presliding"].extend(load_model("c2_parallel"))\n',
        encoding="utf-8",
    )
    arguments = [str(LOG), "--rig", str(TOML), "--model", str(model), "--out", str(tmp_path / "out")]
    status = main(["diagnose", *arguments])
    error = [line for line in capsys.readouterr().err.splitlines() if "warning" not in line]

    assert (2, 1) == (status, len(error))
    assert "diagnose requires a model without hidden states, got one with presliding_z" in error[0]


@pytest.mark.parametrize("command", ["fit", "diagnose"])
def test_a_model_of_another_case_is_refused(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A model without gravity is not that of a rig which swings against it: the same line from both."""
    arguments = [str(LOG), "--rig", str(TOML), "--model", "c1_perpendicular", "--out", str(tmp_path / "out")]
    status = main([command, *arguments])

    said = f"{TOML}: model c1_perpendicular requires case C1, got case C2; c2_parallel fits it"
    assert (2, f"eccentric: error: {said}\n") == (status, capsys.readouterr().err)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("command", ["fit", "diagnose"])
def test_one_run_is_too_little_to_hold_out(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The error on one whole run has no interval: both commands require a second one with the same line."""
    rig, log = tmp_path / "rig.toml", screw.write_log(tmp_path / "log.csv", {})
    rig.write_text('holdout_runs = ["speed_6"]\n' + screw.RIG, encoding="utf-8")
    status = main([command, str(log), "--rig", str(rig), "--out", str(tmp_path / "out")])

    said = (
        "log.csv: expected at least 2 moving whole runs to hold out, got 1:"
        f' in {rig}, a time, such as "0.1 s" as average_over gives more'
    )
    assert (2, f"eccentric: error: {said}\n") == (status, capsys.readouterr().err)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("k_e", ["0.05", pytest.param("0.03", marks=pytest.mark.slow)])
def test_a_wrong_constant_of_the_rig_is_told_as_what_it_is(tmp_path: Path, k_e: str) -> None:
    """The sentence gives the quantity, its value by the log and that of the rig, and says it once."""
    rig = rig_with(tmp_path, ('k_e = "0.063 V s/rad"', f'k_e = "{k_e} V s/rad"'))
    said = diagnosis_sentence(diagnose([LOG], rig))
    (value,) = re.findall(
        rf"the right value of k_e: (\S+) V s/rad, the rig file has {k_e} \(ke_mismatch,", said
    )

    # The bench has 0.063 V s/rad; its encoder and its low pass cost some per mille.
    assert float(value) == pytest.approx(0.063, rel=5e-3)
    assert 1 == said.lower().count("k_e")


@pytest.mark.parametrize("command", ["fit", "diagnose", "compare"])
def test_a_chain_of_joints_is_no_model_of_one_drive(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its balances are one for each joint: the one of a drive is what is missing, in one line."""
    model = ["serial_chain"] if command == "compare" else ["--model", "serial_chain"]

    assert 2 == main([command, str(LOG), "--rig", str(TOML), *model, "--out", str(tmp_path / "out")])
    assert capsys.readouterr().err == (
        "eccentric: error: model serial_chain: expected a mechanical balance of one drive,"
        " got mechanical_0, electrical_0, mechanical_1, electrical_1\n"
    )
