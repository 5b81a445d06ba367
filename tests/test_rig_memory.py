"""A rig in memory says what its file would say."""

from __future__ import annotations

import dataclasses
import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.rigs import names_arm, read_rig

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
