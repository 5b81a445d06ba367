"""Where the measured logs and their rig files are; the logs are not bundled."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SETS = {
    "bam_xl330_pendulum": "bam_xl330_pendulum",
    "tro2021_drive1": "tro2021_screw_drives",
    "tro2021_drive3": "tro2021_screw_drives",
    "tue_unbalanced_disc": "tue_unbalanced_disc",
    "dfki_ak80_pendulum": "dfki_ak80_pendulum",
}
"""Rig file -> folder of its log."""


def measured_log(data: Path, name: str) -> tuple[Path, Path]:
    """Log and rig file of a measured rig; `data` has one folder for each set of logs."""
    return data / SETS[name] / "data.csv.gz", ROOT / "examples" / "rigs" / f"{name}.toml"
