"""A small fleet from end to end, and what goes wrong on the way: workers, files, rigs."""

from __future__ import annotations

import csv
import json
import os
import re
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eccentric
from eccentric.cli import main
from eccentric.core import whole_folder
from eccentric.fleet.cluster import Failed, connected, spread
from eccentric.fleet.gathered import Assigned, gather, plan_of
from eccentric.fleet.limits import WORKER_BYTES
from eccentric.fleet.sources import LogFile, find
from eccentric.fleet.work import Stored, read, work
from eccentric.identification import merged
from tests.dying import dying, hoarding

pytest.importorskip("pyarrow")
pytest.importorskip("distributed")

# `make test` has the parts of a fleet, each in a file of its own.
pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"),
]


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """Two workers for all tests of the file: to start them takes seconds."""
    with connected(None, 2) as client:
        yield client


@pytest.fixture(scope="module")
def address(cluster: Any) -> str:
    """The address of their scheduler, as `--scheduler` takes it."""
    return cluster.scheduler.address


@pytest.fixture(scope="module")
def found(fleet: Path, address: str, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Any]:
    """What a run on that fleet writes and returns."""
    out = tmp_path_factory.mktemp("found") / "out"
    before = _state(fleet)
    result = eccentric.diagnose_fleet(fleet / "logs", fleet / "rigs.csv", out, scheduler=address)
    assert _state(fleet) == before, "a log was written to"
    return out, result


def _state(folder: Path) -> dict[str, tuple[int, int]]:
    return {
        str(p): (p.stat().st_size, p.stat().st_mtime_ns) for p in sorted(folder.rglob("*")) if p.is_file()
    }


def _sums(out: Path, log: LogFile) -> Stored:
    """The sums of one log file."""
    (one,) = (row for row in read(out, log.joint) if row.name == log.name)
    return one


def _problems(out: Path) -> list[dict[str, str]]:
    with (out / "problems.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_what_changed_is_found_and_named(fleet: Path, found: tuple[Path, Any]) -> None:
    """Each joint that the bench changed is found, since when it changed, by its cause; no other is."""
    out, result = found
    truth = json.loads((fleet / "truth.json").read_text(encoding="utf-8"))
    kinds = {"viscous": "viscous", "coulomb": "Coulomb", "load": "load", "current offset": "offset"}

    by_joint = {one.joint: one for one in result.drifting}

    assert set(truth) == set(by_joint)
    for joint, sealed in truth.items():
        one = by_joint[joint]
        assert kinds.get(sealed["way"], sealed["way"]) in one.what
        assert one.since == sealed["since"]
        assert one.sensor == sealed["sensor"]
        assert one.after < 0.5 * one.before
        assert (out / one.report).is_file()
    assert result.problems == ()
    assert result.drifting[-1].sensor


def test_the_folder_has_what_a_program_needs(found: tuple[Path, Any]) -> None:
    """Coefficients of each period with intervals, sums of each joint and period, the tests, the document."""
    from pyarrow import parquet

    out, result = found
    rows = parquet.ParquetFile(out / "coefficients" / "period=2025-06.parquet").read().to_pylist()
    content = json.loads((out / "fleet.json").read_text(encoding="utf-8"))

    assert len(rows) == 12 * 6
    assert all(row["lower"] < row["value"] < row["upper"] for row in rows)
    assert len(list((out / "sums").glob("joint=*/part-*.parquet"))) == 12
    assert sum(len(read(out, f"J{n:02d}")) for n in range(1, 13)) == 72
    assert content["format"] == "eccentric-fleet/1"
    assert content["drifting"] == [dict(entry) for entry in result.document["drifting"]]
    assert (out / "changes.csv").read_text(encoding="utf-8").count("\n") == 1 + 12 * 8


def test_the_page_opens_offline(found: tuple[Path, Any]) -> None:
    """It fetches nothing, and leads to the reports of the joints that changed."""
    out, result = found
    page = (out / "report.html").read_text(encoding="utf-8")

    assert "default-src 'none'" in page
    assert "http" not in page.replace("http-equiv", "")
    for one in result.drifting:
        assert f'<a href="{one.report}">{one.joint}</a>' in page


def test_the_report_of_a_joint_can_be_repeated(
    fleet: Path, found: tuple[Path, Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """It says why it was made; its command, with its rig and the log of the last period, finds the same."""
    out, _ = found
    document = json.loads((out / "joints" / "J03" / "diagnosis.json").read_text(encoding="utf-8"))
    page = (out / "joints" / "J03" / "report.html").read_text(encoding="utf-8")
    assert "Joint J03 changed, since 2025-" in page
    words = shlex.split(re.findall(r"eccentric (diagnose [^<]*) --out DIR", page)[0])
    shutil.copy(out / "joints" / "J03.rig.json", tmp_path)
    shutil.copy(fleet / "logs" / "joint=J03" / "month=2025-06" / "log.parquet", tmp_path)
    monkeypatch.chdir(tmp_path)

    assert main([*words, "--out", "again"]) == 0
    again = json.loads((tmp_path / "again" / "diagnosis.json").read_text(encoding="utf-8"))
    assert again["verdict"] == document["verdict"]
    assert again["rows"]["used"] == document["rows"]["used"]


def test_only_what_is_new_or_changed_is_read(fleet: Path, found: tuple[Path, Any], tmp_path: Path) -> None:
    """Nothing is read twice; a log that changed is, those of another rig are, and next month alone."""
    out, _ = found
    logs, rigs = tmp_path / "logs", tmp_path / "rigs.csv"
    shutil.copytree(fleet / "logs", logs)
    for file in fleet.glob("*.*"):
        shutil.copy(file, tmp_path)

    def left() -> set[tuple[str, str]]:
        jobs = plan_of(find(str(logs))[0], Assigned(str(rigs)), out).jobs
        return {(joint, job.log.period) for joint in jobs for job in jobs[joint]}

    assert left() == set()
    changed = logs / "joint=J07" / "month=2025-02" / "log.parquet"
    os.utime(changed, ns=(0, 1))
    shutil.copytree(logs / "joint=J09" / "month=2025-06", logs / "joint=J09" / "month=2025-07")
    assert left() == {("J07", "2025-02"), ("J09", "2025-07")}
    rigs.write_text(rigs.read_text().replace("\nJ11,elbow", "\nJ11,shoulder").replace("\nJ12,", "\nJ13,"))
    header, *rows = rigs.read_text().splitlines()
    heavier = [row.replace(",0.2,", ",0.25,") if row.startswith("J01,") else row for row in rows]
    rigs.write_text("\n".join([header, *heavier]))
    assert {("J01", f"2025-0{k}") for k in range(1, 7)} <= left()


def test_a_run_that_was_ended_goes_on_where_it_was(
    fleet: Path, found: tuple[Path, Any], cluster: Any, tmp_path: Path
) -> None:
    """Ended after some files, the next run does the others only; the sums are those of one run."""
    logs, rigs = find(str(fleet / "logs"))[0][:24], Assigned(str(fleet / "rigs.csv"))

    def told(part: float, _: str) -> None:
        if part > 0.3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        gather(plan_of(logs, rigs, tmp_path), cluster, tmp_path, told)
    again = plan_of(logs, rigs, tmp_path)
    problems, done = gather(again, cluster, tmp_path, lambda part, what: None)

    assert again.reused >= 8
    assert (problems, done) == ([], 24 - again.reused)
    for log in logs:
        mine, theirs = (_sums(out, log) for out in (tmp_path, found[0]))
        np.testing.assert_array_equal(mine.sums.triangles, theirs.sums.triangles)


def test_sums_outlive_their_logs_but_not_a_change_of_them(fleet: Path, address: str, tmp_path: Path) -> None:
    """A log in an archive still counts, and is told; the sums of one that has become unreadable do not."""
    logs, out = tmp_path / "logs", tmp_path / "out"
    for joint in ("J01", "J02"):
        shutil.copytree(fleet / "logs" / f"joint={joint}", logs / f"joint={joint}")
    first = eccentric.diagnose_fleet(logs, fleet / "rigs.csv", out, scheduler=address)
    shutil.rmtree(logs / "joint=J01" / "month=2025-06")
    broken = logs / "joint=J02" / "month=2025-06" / "log.parquet"
    broken.write_bytes(broken.read_bytes()[:3000])

    again = eccentric.diagnose_fleet(logs, fleet / "rigs.csv", out, scheduler=address)

    assert (first.gone, first.reused, len(first.problems)) == ((), 0, 0)
    assert again.gone == ("joint=J01/month=2025-06/log.parquet",)
    assert (again.files, again.reused) == (1, 10)
    assert [(p.joint, p.period) for p in again.problems] == [("J02", "2025-06")]
    told = again.summary().splitlines()[0]
    assert told.startswith(
        "2 joints; 0 logs read, 10 unchanged; 1 could not be used; the sums of 1 log no longer there"
    )
    assert _joints(out, "2025-06") == {"J01"}

    shutil.rmtree(logs / "joint=J01")
    moved = logs / "joint=J02" / "month=2025-05" / "log.parquet"
    moved.rename(moved.with_name("moved.parquet"))
    last = eccentric.diagnose_fleet(logs, fleet / "rigs.csv", out, scheduler=address)

    assert [name.split("/")[0] for name in last.gone] == ["joint=J01"] * 6
    assert (last.files, last.reused) == (2, 4)
    assert _joints(out, "2025-06") == {"J01"}
    assert _joints(out, "2025-05") == {"J01", "J02"}


def test_joints_without_a_log_and_reports_of_no_change_are_told_and_gone(
    fleet: Path, address: str, tmp_path: Path
) -> None:
    """A table may hold more joints than have logs; the report of a joint that is found unchanged goes."""
    out = tmp_path / "out"
    shutil.copytree(fleet / "logs" / "joint=J01", tmp_path / "logs" / "joint=J01")
    eccentric.diagnose_fleet(tmp_path / "logs", fleet / "rigs.csv", out, scheduler=address)
    for joint in ("J01", "J02"):
        with whole_folder(out / "joints" / joint, "diagnose") as folder:
            (folder / "report.html").write_text("once")
        for name in (f"{joint}.json", f"{joint}.rig.json"):
            (out / "joints" / name).write_text("{}")

    found = eccentric.diagnose_fleet(tmp_path / "logs", fleet / "rigs.csv", out, scheduler=address)

    assert (found.drifting, found.problems) == ((), ())
    assert "11 joints in the rig table without a log (J02, J03" in found.summary()
    assert found.document["joints_without_log"] == [f"J{k:02d}" for k in range(2, 13)]
    # J02 has no log and no sums here: nothing was found of it, and what an earlier run found stays.
    kept = {path.relative_to(out / "joints").as_posix() for path in (out / "joints").rglob("[!.]*")}
    assert kept == {"J02", "J02/report.html", "J02.json", "J02.rig.json"}


def _joints(out: Path, period: str) -> set[str]:
    """The joints with coefficients in a period."""
    from pyarrow import parquet

    rows = parquet.ParquetFile(out / "coefficients" / f"period={period}.parquet").read()
    return set(rows["joint"].to_pylist())


def test_files_joints_and_periods_that_fail_are_named(fleet: Path, address: str, tmp_path: Path) -> None:
    """A corrupt file, one of another schema, a joint without rig, one at rest: each named, all else done."""
    import pyarrow as pa
    from pyarrow import parquet

    logs, out = tmp_path / "logs", tmp_path / "out"
    for joint in ("J01", "J04", "J07", "J08"):
        shutil.copytree(fleet / "logs" / f"joint={joint}", logs / f"joint={joint}")
    corrupt = logs / "joint=J01" / "month=2025-02" / "log.parquet"
    corrupt.write_bytes(corrupt.read_bytes()[:3000])
    other = logs / "joint=J04" / "month=2025-03" / "log.parquet"
    parquet.write_table(pa.table({"t": [0.0, 1.0], "speed": [1.0, 2.0]}), other)
    still = logs / "joint=J07" / "month=2025-04" / "log.parquet"
    table = parquet.ParquetFile(still).read()
    moved = np.where(np.asarray(table["time_s"]) < 2.0, table["theta_m_rad"], 0.0)
    parquet.write_table(table.set_column(1, "theta_m_rad", pa.array(moved)), still)
    stranger = logs / "joint=X" / "month=2025-01" / "log.parquet"
    stranger.parent.mkdir(parents=True)
    shutil.copy(fleet / "logs" / "joint=J08" / "month=2025-01" / "log.parquet", stranger)
    rigs = fleet / "rigs.csv"

    status = main(["fleet", str(logs), "--rigs", str(rigs), "--out", str(out), "--scheduler", address])

    named = {(row["joint"], row["period"], row["kind"]) for row in _problems(out)}
    assert status == 1
    assert named >= {
        ("J01", "2025-02", "cannot be used"),
        ("J04", "2025-03", "cannot be used"),
        ("J07", "2025-04", "not excited"),
        ("X", "", "no rig"),
    }
    assert len(named) == 4
    assert sum(len(read(out, joint)) for joint in ("J01", "J04", "J07", "J08")) == 4 * 6 - 2
    assert "Traceback" not in (out / "problems.csv").read_text(encoding="utf-8")


def test_the_number_of_workers_and_the_order_of_files_do_not_matter(
    fleet: Path, found: tuple[Path, Any], tmp_path: Path
) -> None:
    """One process that takes the files backwards has the sums of two workers, to 1e-9."""
    logs = find(str(fleet / "logs"))[0][::-1][:24]
    plan = plan_of(logs, Assigned(str(fleet / "rigs.csv")), tmp_path)

    for job in (job for jobs in plan.jobs.values() for job in jobs):
        (mine,), theirs = work([job]), _sums(found[0], job.log)
        assert isinstance(mine, Stored)
        np.testing.assert_allclose(
            merged(mine.sums.triangles), merged(theirs.sums.triangles), rtol=1e-9, atol=1e-9
        )


def test_a_worker_that_is_killed_is_survived(cluster: Any, tmp_path: Path) -> None:
    """What its worker died of once is done elsewhere; what kills every worker is named; all else is done."""
    items = [tmp_path / name for name in ("a", "b", "once", "always", "c", "d")]
    tasks = [items[:3], items[3:]]

    results = {item.name: result for item, result in spread(cluster, dying, tasks)}

    assert {name: name for name in ("a", "b", "c", "d", "once")} == {
        name: result for name, result in results.items() if name != "always"
    }
    assert isinstance(results["always"], Failed)
    assert "every worker that took it died" in str(results["always"])


def test_a_worker_whose_memory_is_nearly_full_goes_on() -> None:
    """Nine tenths of it are kept: what comes next is done all the same, by the same process."""
    with connected(None, 1) as client:
        first = client.submit(hoarding, [int(0.9 * WORKER_BYTES) - 100_000_000], pure=False)
        (before,) = first.result(timeout=60.0)
        (after,) = client.submit(hoarding, [1], pure=False).result(timeout=60.0)

    assert before == after
