"""Logs of recorders: real files, written by each format's own library, come out as columns on one clock."""

from __future__ import annotations

import contextlib
import pickle
import sqlite3
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.logs import Log, read_log, stream_log
from tests import recordings
from tests.recordings import ANGLE, CURRENT, T

MARK = "a mark that unpickling would leave"


@pytest.fixture
def read(tmp_path: Path) -> Callable[[str, bytes], Log]:
    """Return a function that reads bytes as a log with that name."""

    def run(name: str, content: bytes) -> Log:
        (tmp_path / name).write_bytes(content)
        return read_log(tmp_path / name)

    return run


CASES = {
    "log.mf4": ("asammdf", recordings.mdf_bytes, "angle", "current"),
    "log.tdms": ("nptdms", recordings.tdms_bytes, "angle", "current"),
    "log.ulg": ("pyulog", recordings.ulog_bytes, "drive.angle", "motor.current"),
    "log.db3": ("rosbags", recordings.bag_bytes, "joint_states.position.elbow", "current.data"),
    "log.mcap": ("rosbags", recordings.mcap_bytes, "joint_states.position.elbow", "current.data"),
}


@pytest.mark.parametrize("name", CASES)
def test_channels_with_two_clocks_become_columns_on_the_faster(
    name: str, read: Callable[[str, bytes], Log]
) -> None:
    """The angle keeps its rows, the current of half the rate is interpolated, and a note says both."""
    library, content, angle, current = CASES[name]
    pytest.importorskip(library, reason=f"{library} is not installed")
    if name == "log.mcap":
        pytest.importorskip("mcap", reason="mcap is not installed")
    log = read(name, content())
    shared = T <= T[::2][-1]  # the last row of the angle is after the last of the current

    assert log.numbers("time_s") == pytest.approx(T[shared], abs=2e-6)
    assert log.numbers(angle) == pytest.approx(ANGLE[shared], rel=1e-12)
    # 700 ns between the recording of a topic and the stamp of the other are in the bags.
    assert log.numbers(current) == pytest.approx(2.0 * T[shared] + 1.0, abs=2e-6)
    assert CURRENT[-1] == pytest.approx(log.numbers(current)[-1], abs=2e-6)
    said = "; ".join(log.notes)
    assert f"put on the clock of {angle}" in said
    assert f"{current} linearly" in said


def test_units_that_a_file_states_are_kept(read: Callable[[str, bytes], Log]) -> None:
    """MDF, TDMS and HDF5 state units; nothing is converted by them."""
    for library, name, content, column, unit in (
        ("asammdf", "log.mf4", recordings.mdf_bytes, "angle", "rad"),
        ("nptdms", "log.tdms", recordings.tdms_bytes, "angle", "rad"),
        ("h5py", "log.h5", recordings.hdf5_bytes, "angle", "deg"),
    ):
        pytest.importorskip(library, reason=f"{library} is not installed")
        assert unit == read(name, content()).units[column]


def test_an_hdf5_file_is_read_without_what_it_links_to(read: Callable[[str, bytes], Log]) -> None:
    """Datasets in groups are columns; a link to another file is not followed."""
    pytest.importorskip("h5py", reason="h5py is not installed")
    log = read("log.hdf5", recordings.hdf5_bytes())

    assert log.numbers("angle") == pytest.approx(np.degrees(ANGLE), rel=1e-12)
    assert log.numbers("time") == pytest.approx(T)
    assert any("link" in note and "away" in note for note in log.notes)


@pytest.mark.parametrize("suffix", [".h5", ".mat"])
def test_values_in_other_files_are_left_out(suffix: str, tmp_path: Path) -> None:
    """External storage, virtual datasets and links, also in groups and cells; MAT 7.3 also in slices."""
    h5py = pytest.importorskip("h5py", reason="h5py is not installed")
    (tmp_path / "secret").write_bytes(bytes(range(40)))
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["x"] = np.arange(40.0)
    path = tmp_path / f"log{suffix}"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["time"] = np.arange(40.0)
        layout = h5py.VirtualLayout(shape=(40,), dtype="f8")
        layout[:] = h5py.VirtualSource(tmp_path / "other.h5", "x", shape=(40,))
        for group in (file, file.create_group("drive")):
            group.create_dataset(
                f"stored{len(group)}", (40,), "u1", external=[(str(tmp_path / "secret"), 0, 40)]
            )
            group.create_virtual_dataset(f"virtual{len(group)}", layout)
            group[f"linked{len(group)}"] = h5py.ExternalLink(str(tmp_path / "other.h5"), "/x")
        stored = next(name for name in file if name.startswith("stored"))
        file.create_dataset("cell", data=np.array([file[stored].ref], dtype=h5py.ref_dtype))
    if suffix == ".mat":
        with path.open("r+b") as raw:
            raw.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")

    for found in (read_log(path), stream_log(path).read()):
        assert {"time"} == set(found.columns)
        assert any("other files" in note and "stored" in note and "virtual" in note for note in found.notes)
        assert any("link" in note for note in found.notes)


def test_an_mdf_file_runs_nothing(read: Callable[[str, bytes], Log]) -> None:
    """Attachments are ignored, and a channel behind a formula is left out; both are said."""
    pytest.importorskip("asammdf", reason="asammdf is not installed")
    log = read("log.mf4", recordings.mdf_bytes())

    assert "computed" not in log.columns
    assert any("formula" in note and "computed" in note for note in log.notes)
    assert "attachments are ignored" in log.notes


def test_a_bag_leaves_nothing_beside_it(tmp_path: Path) -> None:
    """No file of SQLite is made; where its write-ahead log has messages, the bag is refused."""
    pytest.importorskip("rosbags", reason="rosbags is not installed")
    path = tmp_path / "log.db3"
    path.write_bytes(recordings.bag_bytes())
    with contextlib.closing(sqlite3.connect(path)) as file:
        file.execute("PRAGMA journal_mode=WAL")
    rows = read_log(path).rows

    assert ["log.db3"] == [one.name for one in tmp_path.iterdir()]
    assert rows > 0
    with contextlib.closing(sqlite3.connect(path)) as file:
        file.execute("DELETE FROM messages WHERE id = 1")
        file.commit()
        with pytest.raises(
            InputError, match=r"expected a bag that was closed, got one with log\.db3-wal next to it"
        ):
            read_log(path)
    assert read_log(path).rows > 0


class Marking:
    """An object that leaves a mark when it is unpickled."""

    def __reduce__(self) -> tuple[object, tuple[str]]:
        return exec, (f"import builtins; builtins.unpickled = {MARK!r}",)


def test_a_numpy_archive_is_read_and_its_pickles_are_not(tmp_path: Path) -> None:
    """Vectors and columns of matrices are columns; Python objects are left out unread, with a note."""
    import builtins

    path = tmp_path / "log.npz"
    np.savez(
        path,
        time_s=T,
        both=np.column_stack([ANGLE, -ANGLE]),
        bad=np.array([Marking()] * len(T), dtype=object),
    )
    log = read_log(path)

    assert log.numbers("both(:,2)") == pytest.approx(-ANGLE)
    assert not hasattr(builtins, "unpickled")
    assert any("Python objects" in note and "bad" in note for note in log.notes)
    pickle.loads(pickle.dumps(Marking()))  # noqa: S301 - shows that the mark works
    assert builtins.unpickled == MARK  # pyright: ignore[reportAttributeAccessIssue]
    del builtins.unpickled  # pyright: ignore[reportAttributeAccessIssue]


def test_json_messages_are_read_and_other_encodings_named(read: Callable[[str, bytes], Log]) -> None:
    """Foxglove's JSON messages become columns; a topic in protobuf is left out with a note."""
    pytest.importorskip("mcap", reason="mcap is not installed")
    log = read("log.mcap", recordings.json_mcap_bytes())

    assert log.numbers("drive.angle") == pytest.approx(ANGLE)
    assert any("/camera" in note and "protobuf" in note for note in log.notes)


ALL = {
    "log.npz": ("numpy", recordings.npz_bytes),
    "log.h5": ("h5py", recordings.hdf5_bytes),
    **{name: (library, content) for name, (library, content, *_) in CASES.items()},
}


@pytest.mark.parametrize("name", ALL)
def test_a_cut_or_foreign_file_is_one_line(name: str, read: Callable[[str, bytes], Log]) -> None:
    """Half a file, its first bytes, and text under the same name: a log, or one line that names the file."""
    library, content = ALL[name]
    pytest.importorskip(library, reason=f"{library} is not installed")
    if name == "log.mcap":
        pytest.importorskip("mcap", reason="mcap is not installed")
    whole, refused = content(), 0
    for part in (whole[: len(whole) // 2], whole[:40], whole[:-7], b"time,angle\n0,1\n", b""):
        try:
            read(name, part)
        except InputError as error:
            said = str(error)
            assert name in said
            assert "\n" not in said
            refused += 1
    assert refused >= 3


@pytest.mark.parametrize("name", ALL)
def test_a_missing_library_is_named_with_its_extra(
    name: str, read: Callable[[str, bytes], Log], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without the library of a format the line says what to install."""
    import importlib
    import sys

    if name == "log.npz":
        pytest.skip("NumPy is always there")
    for module in (
        "h5py",
        "asammdf",
        "nptdms",
        "pyulog",
        "rosbags",
        "rosbags.typesys",
        "mcap",
        "mcap.reader",
    ):
        monkeypatch.setitem(sys.modules, module, None)
    importlib.invalidate_caches()
    with pytest.raises(InputError, match=r'is required for \.\w+: pip install "eccentric\[\w+\]"'):
        read(name, b"x")
