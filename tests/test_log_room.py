"""A log that does not fit into memory is one line, before it is read; how much memory there is is found."""

from __future__ import annotations

import gzip
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.logs import foreign, read_log

ROWS = 1000


def _csv(path: Path) -> None:
    path.write_bytes(gzip.compress(b"t,i\n" + b"1,2\n" * ROWS))


def _empty_lines(path: Path) -> None:
    path.write_text("t,i\n" + "1,2\n" * 10 + "\n" * ROWS)


def _json(path: Path) -> None:
    path.write_text(json.dumps({"entries": [{"t": 1, "i": 2}] * ROWS}))


def _json_by_columns(path: Path) -> None:
    path.write_text(json.dumps({"mass": 1.0, "t": [1] * ROWS, "i": [2] * ROWS}))


def _json_with_lists(path: Path) -> None:
    path.write_text(json.dumps([{"t": 1, "i": 2, "q": [3, 4]}] * ROWS))


def _mat(path: Path) -> None:
    from scipy.io import savemat

    savemat(path, {"log": {"t": np.zeros(ROWS, np.int8), "i": np.zeros(ROWS)}}, do_compression=True)


def _mat_7_3(path: Path) -> None:
    h5py = pytest.importorskip("h5py", exc_type=ImportError)
    with h5py.File(path, "w", userblock_size=512) as file:
        for name in "ti":
            file.create_dataset(f"log/{name}", data=np.zeros((1, ROWS)), compression="gzip")
    with path.open("r+b") as head:
        head.write(b"MATLAB 7.3".ljust(124) + b"\x00\x02IM")


def _parquet(path: Path) -> None:
    arrow, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    parquet.write_table(arrow.table({"t": np.zeros(ROWS), "i": np.zeros(ROWS)}), path)


@pytest.mark.parametrize(
    ("name", "make"),
    [
        ("log.csv.gz", _csv),
        ("empty.csv", _empty_lines),
        ("log.json", _json),
        ("columns.json", _json_by_columns),
        ("lists.json", _json_with_lists),
        ("log.mat", _mat),
        ("log73.mat", _mat_7_3),
        ("log.parquet", _parquet),
    ],
    ids=["csv", "empty lines", "json", "json by columns", "json with lists", "mat", "mat 7.3", "parquet"],
)
def test_a_log_that_memory_does_not_hold_is_one_line(
    name: str, make: Callable[[Path], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 1,000 rows a tenth of the memory for them holds a tenth; with enough of it the log is read."""
    make(tmp_path / name)
    assert read_log(tmp_path / name).rows >= 10
    monkeypatch.setattr(foreign, "free_memory", lambda: 30_000)

    with pytest.raises(InputError) as refused:
        read_log(tmp_path / name)
    said = str(refused.value).removeprefix(f"{tmp_path / name}: ")
    most = int(said.removeprefix("expected at most ").split()[0].replace(",", ""))
    assert "rows of this kind, for which the 3e-05 GB of free memory suffice, got 1,0" in said
    assert 10 < most < ROWS / 5


def test_rows_are_counted_before_they_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two million short rows are refused within a fraction of the time that reading them takes."""
    path = tmp_path / "log.csv.gz"
    path.write_bytes(gzip.compress(b"t\n" + b"1\n" * 2_000_000))
    monkeypatch.setattr("csv.reader", lambda *_, **__: pytest.fail("a row must not be read"))
    monkeypatch.setattr(foreign, "free_memory", lambda: 100_000_000)

    with pytest.raises(InputError, match=r"got 2,000,00\d rows with 2,000,00\d values, for about"):
        read_log(path)


def _system(root: Path, **files: str) -> Path:
    """A root folder with these files of the system."""
    paths = {
        "meminfo": "proc/meminfo",
        "groups": "proc/self/cgroup",
        "top": "sys/fs/cgroup/memory.max",
        "job": "sys/fs/cgroup/batch/job/memory.max",
        "used": "sys/fs/cgroup/batch/job/memory.current",
        "kinds": "sys/fs/cgroup/batch/job/memory.stat",
        "v1": "sys/fs/cgroup/memory/memory.limit_in_bytes",
        "v1_used": "sys/fs/cgroup/memory/memory.usage_in_bytes",
        "v1_kinds": "sys/fs/cgroup/memory/memory.stat",
    }
    for name, text in files.items():
        (root / paths[name]).parent.mkdir(parents=True, exist_ok=True)
        (root / paths[name]).write_text(text)
    return root


MACHINE = {"meminfo": "MemTotal:  9000 kB\nMemFree:  1000 kB\nMemAvailable:  5000 kB\n"}
GROUP = {
    "groups": "0::/batch/job\n",
    "top": "max\n",
    "used": "3000000\n",
    "kinds": "anon 1000000\ninactive_file 500000\n",
}


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        (MACHINE, 5_120_000),
        (MACHINE | GROUP | {"job": "4000000\n"}, 1_500_000),
        (MACHINE | GROUP | {"job": "max\n"}, 5_120_000),
        (MACHINE | GROUP | {"job": "1000000\n"}, 0),
        (MACHINE | {"v1": "4000000", "v1_used": "3000000", "v1_kinds": "inactive_file 0\n"}, 1_000_000),
    ],
    ids=["machine", "group", "group without a limit", "group that is full", "group of version 1"],
)
def test_the_least_of_all_limits_counts(files: dict[str, str], expected: int, tmp_path: Path) -> None:
    """What the machine has available, in 1024 bytes, or what the control group of the process leaves."""
    assert expected == foreign.free_memory(_system(tmp_path, **files))


def test_the_limit_of_the_process_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """After `ulimit -v` it is what has not been taken of that, in pages."""
    resource = pytest.importorskip("resource")
    _system(tmp_path, **MACHINE)
    (tmp_path / "proc/self").mkdir()
    (tmp_path / "proc/self/statm").write_text("100 50 10 1 0 20 0\n")
    page = resource.getpagesize()
    monkeypatch.setattr(resource, "getrlimit", lambda _: (101 * page, 101 * page))

    assert page == foreign.free_memory(tmp_path)


def test_a_system_that_says_nothing_has_some(tmp_path: Path) -> None:
    """Without the files of Linux it is the memory that is built in."""
    assert 1e8 < foreign.free_memory(tmp_path)
