"""Logs and rigs of a fleet: joints and periods by folders and names, rigs by tables."""

from __future__ import annotations

from pathlib import Path

import pytest

from eccentric.core import InputError
from eccentric.fleet.gathered import Assigned
from eccentric.fleet.sources import find, in_order

RIG = '[known]\ncase = "C2"\nM_kg = 0.5\nL_m = 0.3\nmu = 0.2\nk_i_Nm_per_A = 0.06\n'


def _touch(folder: Path, *names: str) -> None:
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text("x")


def _of(path: object, pattern: str | None = None) -> list[tuple[str, str, str]]:
    return [(log.joint, log.period, log.name) for log in find(str(path), pattern)[0]]


def test_folders_tell_joint_and_period(tmp_path: Path) -> None:
    """Hive partitions in any order; year and month together are the period, numbers with leading zeros."""
    _touch(
        tmp_path,
        "joint=A/year=2025/month=3/a.parquet",
        "month=2025-04/joint=A/b.csv.gz",
        "joint=A/month=1/c.mat",
    )

    assert _of(tmp_path) == [
        ("A", "01", "joint=A/month=1/c.mat"),
        ("A", "2025-03", "joint=A/year=2025/month=3/a.parquet"),
        ("A", "2025-04", "month=2025-04/joint=A/b.csv.gz"),
    ]


def test_a_pattern_without_an_extension_takes_them_all(tmp_path: Path) -> None:
    """The extension belongs to no period."""
    _touch(tmp_path, "J1_2025-01.parquet", "J1_2025-02.csv.gz")

    assert [("J1", "2025-01"), ("J1", "2025-02")] == [w[:2] for w in _of(tmp_path, "{joint}_{period}")]


def test_a_glob_finds_what_its_folder_finds(tmp_path: Path) -> None:
    """Partitions count wherever they are in a glob, also in its fixed part."""
    _touch(tmp_path, "joint=A/month=01/a.parquet", "joint=B/month=01/a.parquet", "joint=B/month=02/a.parquet")

    assert _of(tmp_path / "joint=*/month=01/*.parquet") == _of(tmp_path)[:1] + _of(tmp_path)[1:2]
    assert [j for j, _, _ in _of(tmp_path / "joint=B/*/*.parquet")] == ["B", "B"]


def test_a_pattern_reads_file_names(tmp_path: Path) -> None:
    """What a pattern does not fit, and what no folder tells, is a problem; hidden files and rigs are not."""
    _touch(
        tmp_path, "J1_2025-01.parquet", "J2_2025-01.parquet", "odd.parquet", ".hidden_1.parquet", "rig.json"
    )

    logs, problems = find(str(tmp_path), "{joint}_{period}.parquet")

    assert [("J1", "2025-01"), ("J2", "2025-01")] == [(log.joint, log.period) for log in logs]
    assert ["odd.parquet"] == [p.file for p in problems]
    with pytest.raises(InputError, match=r"expected folders joint=.*, .* and so 2 more"):
        find(str(tmp_path))
    with pytest.raises(InputError, match="each once"):
        find(str(tmp_path), "{joint}.parquet")
    with pytest.raises(InputError, match="found none"):
        find(str(tmp_path / "*.mat"))


def test_periods_are_in_the_order_of_time() -> None:
    """Numbers count by their size, whatever their width."""
    assert ["2024-12", "2025-9", "2025-10", "2026-1"] == in_order(["2025-10", "2026-1", "2025-9", "2024-12"])


def test_a_raised_digit_is_no_number() -> None:
    """A superscript is a digit to Unicode, and no number; digits of another script are one."""
    assert ["9²", "10²", "١١"] == in_order(["١١", "10²", "9²"])


def test_a_table_gives_joints_their_own_values(tmp_path: Path) -> None:
    """A value replaces that of the rig file, by whichever of its keys; an empty one leaves it."""
    (tmp_path / "arm.toml").write_text(RIG)
    (tmp_path / "rigs.csv").write_text("joint,rig,M,L_m\nA,arm.toml,700 g,\nB,arm.toml,,0.25\n")
    rigs = Assigned(str(tmp_path / "rigs.csv"))

    assert (rigs.rig("A").known["M"], rigs.rig("A").known["L"]) == (pytest.approx(0.7), 0.3)
    assert (rigs.rig("B").known["M"], rigs.rig("B").known["L"]) == (0.5, 0.25)
    with pytest.raises(InputError, match=r"rigs.csv: expected a rig of joint C"):
        rigs.rig("C")


def test_a_table_may_be_toml_and_a_rig_may_be_for_all(tmp_path: Path) -> None:
    """The same in TOML; a rig file alone is every joint's."""
    (tmp_path / "arm.toml").write_text(RIG)
    (tmp_path / "rigs.toml").write_text('[joints.A]\nrig = "arm.toml"\nknown = { M = "700 g" }\n')

    assert Assigned(str(tmp_path / "rigs.toml")).rig("A").known["M"] == pytest.approx(0.7)
    assert Assigned(str(tmp_path / "arm.toml")).rig("any").known["M"] == 0.5


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("rigs.csv", "joint,file\nA,arm.toml\n", "expected columns joint and rig"),
        ("rigs.csv", "joint,rig\nA,arm.toml\nA,arm.toml\n", "line 3: expected each joint only once"),
        ("rigs.csv", "joint,rig,M\nA,arm.toml\n", "line 2: expected 3 entries"),
        ("rigs.csv", "joint,rig,rig\nA,arm.toml,b.toml\n", "expected each column only once, got"),
        ("rigs.csv", "joint,rig\nSt\xfcck,arm.toml\n", "expected UTF-8 text, but byte 12 is not"),
        ("rigs.csv", f"joint,rig\nA,{'x' * 200_000}\n", r"after line 1: not a table .*field larger"),
        ("rigs.toml", "[joints.A]\nmass = 1\n", "unknown key 'mass'"),
        ("rigs.toml", "[joints.A]\nknown = {}\n", "expected the path of a rig file"),
        ("rigs.toml", "drive = 3\n", "drive: expected one of current, voltage, torque, none"),
    ],
)
def test_a_table_that_is_wrong_says_where(name: str, text: str, message: str, tmp_path: Path) -> None:
    """File, line or key, what is required."""
    (tmp_path / name).write_text(text if "drive" not in text else text + RIG, encoding="latin-1")

    with pytest.raises(InputError, match=message):
        Assigned(str(tmp_path / name))


def test_a_value_that_is_wrong_names_the_joint(tmp_path: Path) -> None:
    """The message of a joint's rig opens with table and joint."""
    (tmp_path / "arm.toml").write_text(RIG)
    (tmp_path / "rigs.csv").write_text("joint,rig,M_kg\nA,arm.toml,-1\n")

    with pytest.raises(
        InputError, match=r"rigs.csv \(joint A\): \[known\] M_kg: expected a value at least 0"
    ):
        Assigned(str(tmp_path / "rigs.csv")).rig("A")


def test_known_that_is_no_table_names_the_rig_file(tmp_path: Path) -> None:
    """Such as a number in its place."""
    (tmp_path / "arm.toml").write_text("known = 3\n")
    (tmp_path / "rigs.csv").write_text("joint,rig\nA,arm.toml\n")

    with pytest.raises(InputError, match=r"arm.toml: known: expected a table, got 3"):
        Assigned(str(tmp_path / "rigs.csv")).rig("A")
