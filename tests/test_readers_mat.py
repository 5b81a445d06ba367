"""MATLAB logs of every version give the same columns; damaged ones are refused and never end the process."""

from __future__ import annotations

import struct
import sys
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csc_array

from eccentric.core import InputError
from eccentric.logs import Log, read_log, stream_log

T = np.arange(4.0)


def mat_log(tmp_path: Path, variables: dict[str, Any]) -> Log:
    """Write a MAT file of version 5 and read it."""
    savemat(tmp_path / "log.mat", variables)
    return read_log(tmp_path / "log.mat")


def columns(log: Log) -> dict[str, list[Any]]:
    """Columns as lists, for comparison."""
    return {name: values.tolist() for name, values in log.columns.items()}


# MATLAB, versions 5 and 7


def test_mat_vectors_matrices_texts_and_scalars(tmp_path: Path) -> None:
    """Vectors of either shape, logicals, matrices, cells, char rows are columns; a scalar is a constant."""
    log = mat_log(
        tmp_path,
        {
            "log": {"time_s": T[:, None], "current_A": 2.0 * T[None, :], "on": T > 1.0},
            "m": np.stack([T, 3.0 * T], axis=1),
            "mode": np.array(["up", "up", "down", "down"], dtype=object),
            "grade": np.array(["a", "b", "c", "d"]),
            "rate": 250.0,
            "who": "me",
        },
    )
    assert columns(log) == {
        "time_s": [0.0, 1.0, 2.0, 3.0],
        "current_A": [0.0, 2.0, 4.0, 6.0],
        "on": [0.0, 0.0, 1.0, 1.0],
        "m(:,1)": [0.0, 1.0, 2.0, 3.0],
        "m(:,2)": [0.0, 3.0, 6.0, 9.0],
        "mode": ["up", "up", "down", "down"],
        "grade": ["a", "b", "c", "d"],
        "rate": [250.0] * 4,
        "who": ["me"] * 4,
    }
    assert log.notes == ()


def test_mat_variables_of_other_lengths_are_named(tmp_path: Path) -> None:
    """Rows are as many as most vectors have; the others are said to be left out, and why."""
    long = np.arange(20.0)
    log = mat_log(
        tmp_path,
        {"t": long, "i": long, "slow": long[:10], "gain": np.eye(3), "z": 1j * long, "fast": np.arange(90.0)},
    )
    assert list(log.columns) == ["t", "i"]
    gains = "gain(:,1) (3), gain(:,2) (3), gain(:,3) (3)"
    assert log.notes == (
        "left out, since it is neither numbers nor text: z",
        f"left out, since most variables have 20 rows: slow (10), {gains}, fast (90)",
    )


def test_mat_names_that_repeat_are_told_apart(tmp_path: Path) -> None:
    """Structures with fields of one name go by their full names, signals of a scope by their labels."""
    both = mat_log(tmp_path, {"a": {"t": T, "i": T}, "b": {"t": 2.0 * T}})
    assert sorted(both.columns) == ["a.t", "b.t", "i"]
    signals = np.array([(T, "u"), (-T, "i")], dtype=[("values", object), ("label", object)])
    scope = mat_log(tmp_path, {"scope": {"time": T, "signals": signals}})
    np.testing.assert_array_equal(scope.numbers("i"), -T)
    np.testing.assert_array_equal(scope.numbers("time"), T)
    rows = mat_log(tmp_path, {"s": np.array([(0.0, 5), (0.1, 6)], dtype=[("t", float), ("i", int)])})
    assert columns(rows) == {"t": [0.0, 0.1], "i": [5.0, 6.0]}


def element(kind: int, data: bytes, order: str = "<") -> bytes:
    """One data element of a MAT file of version 5: type, size, data up to a multiple of eight bytes."""
    return struct.pack(f"{order}II", kind, len(data)) + data + b"\0" * (-len(data) % 8)


def mat_table(name: str) -> bytes:
    """What MATLAB writes for a table: an opaque array (class 17) of its object system."""
    inner = element(6, struct.pack("<II", 13, 0)) + element(5, struct.pack("<ii", 1, 1)) + element(1, b"")
    words = (element(1, text.encode()) for text in (name, "MCOS", "table"))
    matrix = element(14, inner + element(6, struct.pack("<I", 1)))
    return element(14, element(6, struct.pack("<II", 17, 0)) + b"".join(words) + matrix)


def test_a_matlab_table_is_named_as_what_cannot_be_read(tmp_path: Path) -> None:
    """Beside vectors a table is a note; alone it is the reason of the refusal, with what to do."""
    plain = BytesIO()
    savemat(plain, {"t": T})
    path = tmp_path / "log.mat"
    path.write_bytes(plain.getvalue() + mat_table("Run7"))
    log = read_log(path)
    assert list(log.columns) == ["t"]
    (note,) = log.notes
    assert note.startswith("left out, since only MATLAB reads its tables")
    assert note.endswith(": Run7")
    path.write_bytes(plain.getvalue()[:128] + mat_table("Run7"))
    with pytest.raises(InputError, match=r"got none; left out, .* save table2struct\(T, 'ToScalar', true\)"):
        read_log(path)


VARIABLES = {
    "log": {"time_s": T, "on": T > 1.0},
    "mode": np.array(["up", "down", "down", "up"], dtype=object),
    "grade": np.array(["a", "b", "c", "d"]),
    "rate": 250.0,
}


def test_mat_is_the_same_compressed_and_in_the_other_byte_order(tmp_path: Path) -> None:
    """Version 7 is version 5 with each variable compressed; both come in both byte orders."""
    plain = columns(mat_log(tmp_path, VARIABLES))
    savemat(tmp_path / "log.mat", VARIABLES, do_compression=True)
    assert columns(read_log(tmp_path / "log.mat")) == plain
    numbers = struct.pack(">4d", *T)
    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x01\x00MI"
    parts = ((6, struct.pack(">II", 6, 0)), (5, struct.pack(">ii", 4, 1)), (1, b"time_s"), (9, numbers))
    matrix = b"".join(element(kind, data, ">") for kind, data in parts)
    (tmp_path / "log.mat").write_bytes(head + element(14, matrix, ">"))
    assert columns(read_log(tmp_path / "log.mat")) == {"time_s": plain["time_s"]}


@pytest.mark.parametrize("value", [0, 3, 25, 255])
def test_no_wrong_number_in_a_mat_file_ends_the_process(tmp_path: Path, value: int) -> None:
    """Whatever type, size or flag is wrong, the file is read or refused: SciPy alone crashes on some."""
    path = tmp_path / "log.mat"
    savemat(path, VARIABLES)
    valid = path.read_bytes()
    outcomes = set()
    for place in range(128, len(valid), 4):
        path.write_bytes(valid[:place] + bytes([value]) + valid[place + 1 :])
        try:
            read_log(path)
        except InputError:
            outcomes.add("refused")
        else:
            outcomes.add("read")
    assert outcomes == {"read", "refused"}


BAD_MAT = {
    "version 4": (
        lambda path: savemat(path, {"t": T}, format="4"),
        "not that of version 5 or later; save with -v7",
    ),
    "sparse": (
        lambda path: savemat(path, {"t": csc_array(np.eye(4))}),
        r"a sparse array is not a signal; save with full",
    ),
    "too large": (
        lambda path: path.write_bytes(b"MATLAB 5.0".ljust(124) + b"\x00\x01IM" + huge()),
        "an array has an impossible size",
    ),
    "cut": (
        lambda path: path.write_bytes(b"MATLAB 5.0".ljust(124) + b"\x00\x01IM" + huge()[:20]),
        "it breaks off",
    ),
}


def huge() -> bytes:
    """A cell array that says it has four thousand million cells, which a file of that size cannot have."""
    parts = ((6, struct.pack("<II", 1, 0)), (5, struct.pack("<ii", 65536, 65536)), (1, b"c"))
    return element(14, b"".join(element(kind, data) for kind, data in parts))


@pytest.mark.parametrize("name", BAD_MAT)
def test_a_mat_file_that_cannot_be_a_log_is_refused(tmp_path: Path, name: str) -> None:
    """One line says why, before any memory is allocated."""
    write, expected = BAD_MAT[name]
    write(tmp_path / "log.mat")
    with pytest.raises(InputError, match=rf"log\.mat: expected a valid MAT file, got .*{expected}"):
        read_log(tmp_path / "log.mat")


# MATLAB, version 7.3


@pytest.fixture
def hdf5(tmp_path: Path) -> Any:
    """Return an open HDF5 file, log.mat, with the head that MATLAB writes before it."""
    h5py = pytest.importorskip("h5py", reason="the extra mat73 is not installed")
    path = tmp_path / "log.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        yield file
    # The file is closed by the test's call of `finished`.


def finished(file: Any) -> Path:
    """Close the file and write MATLAB's own head into its first 512 bytes."""
    path = Path(file.filename)
    file.close()
    head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
    path.write_bytes(head.ljust(512, b"\0") + path.read_bytes()[512:])
    return path


def matlab(file: Any, name: str, data: object, kind: str = "double") -> Any:
    """Write a variable as MATLAB does: transposed, with its class beside it."""
    item = file.create_dataset(name, data=np.asarray(data).T)
    item.attrs["MATLAB_class"] = np.bytes_(kind)
    return item


def test_mat_7_3_gives_what_version_5_gives(hdf5: Any) -> None:
    """Vectors, matrices, logicals, char rows, cells, structures, structure arrays: as in version 5."""
    h5py = pytest.importorskip("h5py")
    matlab(hdf5, "log/time_s", T[:, None])
    matlab(hdf5, "log/current_A", 2.0 * T[None, :])
    matlab(hdf5, "on", (T > 1.0).astype(np.uint8)[:, None], "logical")
    matlab(hdf5, "m", np.stack([T, 3.0 * T], axis=1))
    matlab(hdf5, "grade", np.array([[ord(c)] for c in "abcd"], dtype=np.uint16), "char")
    matlab(hdf5, "who", np.array([[ord(c) for c in "me"]], dtype=np.uint16), "char")
    matlab(hdf5, "rate", [[250.0]])
    empty = matlab(hdf5, "empty", np.zeros(2, dtype=np.uint64))
    empty.attrs["MATLAB_empty"] = 1
    words = [
        matlab(hdf5, f"#refs#/{k}", np.array([[ord(c) for c in word]], dtype=np.uint16), "char").ref
        for k, word in enumerate(["up", "up", "down", "down"])
    ]
    matlab(hdf5, "mode", np.array(words, dtype=h5py.ref_dtype)[:, None], "cell")
    for field, values in {"label": ["u", "i"], "values": [T, -T]}.items():
        parts = [
            matlab(hdf5, f"#refs#/{field}{k}", np.array([[ord(value)]], dtype=np.uint16), "char").ref
            if isinstance(value, str)
            else matlab(hdf5, f"#refs#/{field}{k}", value[:, None]).ref
            for k, value in enumerate(values)
        ]
        hdf5.create_dataset(f"signals/{field}", data=np.array(parts, dtype=h5py.ref_dtype)[:, None])
    table = matlab(hdf5, "Run7", np.zeros((1, 6), dtype=np.uint32), "table")
    table.attrs["MATLAB_object_decode"] = 3
    log = read_log(finished(hdf5))
    assert columns(log) == {
        "time_s": [0.0, 1.0, 2.0, 3.0],
        "current_A": [0.0, 2.0, 4.0, 6.0],
        "on": [0.0, 0.0, 1.0, 1.0],
        "m(:,1)": [0.0, 1.0, 2.0, 3.0],
        "m(:,2)": [0.0, 3.0, 6.0, 9.0],
        "mode": ["up", "up", "down", "down"],
        "grade": ["a", "b", "c", "d"],
        "u": T.tolist(),
        "i": (-T).tolist(),
        "rate": [250.0] * 4,
        "who": ["me"] * 4,
    }
    (note,) = log.notes
    assert note.endswith(": Run7")


def test_a_square_matrix_of_mat_7_3_is_read_by_columns(hdf5: Any) -> None:
    """As many columns as rows, read in parts: a column stays a column."""
    square = np.arange(16.0).reshape(4, 4)
    matlab(hdf5, "time_s", T[:, None])
    matlab(hdf5, "m", square)
    stream = stream_log(finished(hdf5))
    (batch,) = stream.batches()

    for k in range(4):
        np.testing.assert_array_equal(square[:, k], batch.columns[f"m(:,{k + 1})"])


def test_mat_7_3_without_its_extra_names_it(hdf5: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without h5py, a log of version 7.3 says what to install."""
    matlab(hdf5, "t", T)
    path = finished(hdf5)
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(InputError, match=r'h5py is required for MAT 7\.3: pip install "eccentric\[mat73\]"'):
        read_log(path)


def test_damaged_mat_7_3_is_refused(hdf5: Any) -> None:
    """A file that breaks off inside its HDF5 part is one line."""
    matlab(hdf5, "t", T)
    path = finished(hdf5)
    path.write_bytes(path.read_bytes()[:700])
    with pytest.raises(InputError, match=r"expected a valid MAT 7\.3 file, got one that is damaged"):
        read_log(path)
