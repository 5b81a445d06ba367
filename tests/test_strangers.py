"""Logs that strangers published are drafted right, with honest questions, or refused where that is right."""

from __future__ import annotations

import tomllib
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from benchmarks.strangers import ASKED, DATA, REFUSED, RIGHT, judged_log, logs_of
from benchmarks.strangers_faults import CHECKS

THERE = pytest.mark.skipif(not DATA.is_dir(), reason="the logs are not bundled")


def _logs() -> Iterator[Any]:
    for folder, entry, _ in logs_of(DATA):
        yield pytest.param(folder, entry, id=f"{folder.name}/{entry['file']}")


@THERE
@pytest.mark.parametrize(("folder", "entry"), list(_logs()))
def test_nothing_is_wrong_without_a_doubt(folder: Path, entry: Mapping[str, Any]) -> None:
    """By what the source of the log says of its columns."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = judged_log(folder, entry)

    assert found.verdict in (RIGHT, ASKED, REFUSED), found.reasons


@THERE
def test_every_small_input_has_a_check() -> None:
    """What is wanted of it, as far as a machine can tell."""
    names = {about.parent.name for about in (DATA / "faults").glob("*/about.toml")}
    commands = [tomllib.loads(p.read_text())["command"] for p in (DATA / "faults").glob("*/about.toml")]

    assert names == set(CHECKS)
    assert all(commands)
