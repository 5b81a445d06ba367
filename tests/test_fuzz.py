"""Whatever a user's file contains, it is read or refused in one line: no other exception, no hang."""

from __future__ import annotations

from datetime import timedelta

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from tests.fuzzing import TARGETS

EXTRAS = {
    ".parquet": "pyarrow",
    ".mat (7.3)": "h5py",
    ".h5": "h5py",
    ".mf4": "asammdf",
    ".db3": "rosbags",
    ".mcap": "mcap",
    ".ulg": "pyulog",
    ".tdms": "nptdms",
    ".bag": "rosbags",
    ".xlsx": "openpyxl",
    "arm .urdf": "yourdfpy",
}


@pytest.mark.parametrize("name", TARGETS)
@pytest.mark.filterwarnings("ignore::SyntaxWarning")  # Python's parser on odd arithmetic
@settings(
    max_examples=60,
    deadline=timedelta(seconds=5),
    phases=(Phase.generate,),
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_random_and_damaged_input_is_read_or_refused(name: str, data: st.DataObject) -> None:
    """Bytes, damaged files, odd rigs and odd arithmetic end in a value or in an InputError of one line."""
    if name in EXTRAS:
        pytest.importorskip(EXTRAS[name], reason=f"{EXTRAS[name]} is not installed")
    target = TARGETS[name]
    assert target.take(data.draw(target.inputs)) in {"accepted", "refused"}


ODD_RIGS = {
    "digits.json": b'{"known": {"M_kg": ' + b"1" * 5000 + b"}}",
    "digits.toml": b"[known]\nM_kg = " + b"1" * 5000,
    "deep.json": b"[" * 100_000,
    "deep.toml": b"a = " + b"[" * 100_000,
}


@pytest.mark.parametrize("name", ODD_RIGS)
def test_a_rig_that_is_too_much_for_its_parser_is_refused(name: str) -> None:
    """Numbers of thousands of digits and endless brackets are one line, too."""
    suffix = name[name.index(".") :]
    assert TARGETS[f"rig {suffix}"].take(ODD_RIGS[name]) == "refused"


def test_a_rig_with_a_byte_order_mark_is_read() -> None:
    """Editors of Windows write one; it says nothing."""
    assert TARGETS["rig .toml"].take(b"\xef\xbb\xbf[known]\ncase = 'C2'\n") == "accepted"


@pytest.mark.slow
@pytest.mark.parametrize("name", TARGETS)
def test_the_fuzz_reaches_both_ends(name: str) -> None:
    """Of the inputs of each target some are accepted and some refused."""
    if name in EXTRAS:
        pytest.importorskip(EXTRAS[name], reason=f"{EXTRAS[name]} is not installed")
    found: set[str] = set()

    @settings(max_examples=300, phases=(Phase.generate,), deadline=None)
    @given(TARGETS[name].inputs)
    def look(content: object) -> None:
        if found != {"accepted", "refused"}:
            found.add(TARGETS[name].take(content))

    look()
    assert found == {"accepted", "refused"}
