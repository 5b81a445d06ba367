"""A run of a fleet that ends early, or with joints that cannot be judged."""

from __future__ import annotations

import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import eccentric
from eccentric.cli import main
from eccentric.fleet import cluster as cluster_of_fleet
from eccentric.fleet.cluster import connected
from eccentric.fleet.gathered import Assigned, gather, plan_of
from eccentric.fleet.sources import find

pytest.importorskip("pyarrow")
pytest.importorskip("distributed")

pytestmark = pytest.mark.filterwarnings(
    "ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)


@pytest.mark.skipif(os.name != "posix", reason="a terminal's Ctrl-C goes to a process group only here")
@pytest.mark.parametrize("seconds", [0.2, pytest.param(4.0, marks=pytest.mark.slow)])
def test_ctrl_c_is_one_line(fleet: Path, tmp_path: Path, seconds: float) -> None:
    """A terminal sends it to workers as well: none of them complains, and none keeps the output open."""
    words = [sys.executable, "-m", "eccentric", "fleet", str(fleet / "logs")]
    words += ["--rigs", str(fleet / "rigs.csv"), "--out", str(tmp_path / "out"), "--workers", "2"]
    run = subprocess.Popen(words, stderr=subprocess.PIPE, start_new_session=True, text=True)
    while not (tmp_path / "out").exists():  # before that, Python reads its modules
        time.sleep(0.05)
    time.sleep(seconds)
    for _ in range(3):  # nobody waits who has seen nothing happen yet
        os.killpg(run.pid, signal.SIGINT)
        time.sleep(0.1)
    _, error = run.communicate(timeout=60)

    # Python itself may end by the last of them: to a shell both are 130.
    assert run.returncode in {130, -signal.SIGINT}
    assert error.splitlines() == [
        "eccentric: interrupted: what is done is kept, and the same command goes on from there"
    ]


@pytest.mark.slow
def test_a_scheduler_that_goes_away_ends_in_one_line(fleet: Path, tmp_path: Path) -> None:
    """What was done until then is kept and named, and started again the rest is done."""
    place, out = tmp_path / "scheduler.json", tmp_path / "out"
    dask = Path(sys.executable).with_name("dask")
    arguments = ["--scheduler-file", str(place), "--dashboard-address", "127.0.0.1:0"]
    started = [subprocess.Popen([dask, "scheduler", "--host", "127.0.0.1", "--port", "0", *arguments])]
    try:
        while not place.exists() or not place.read_text():
            time.sleep(0.1)
        started.append(subprocess.Popen([dask, "worker", "--nthreads", "1", "--no-nanny", *arguments]))
        address = json.loads(place.read_text())["address"]
        rigs, logs = Assigned(str(fleet / "rigs.csv")), find(str(fleet / "logs"))[0]
        plan = plan_of(logs, rigs, out)
        with connected(address, 1) as client:

            def told(part: float, _: str) -> None:
                if part > 0.0:
                    started[0].kill()

            problems, done = gather(plan, client, out, told)
    finally:
        for process in started:
            process.kill()
            process.wait()

    assert ["scheduler"] == [p.kind for p in problems]
    assert 0 < done < 72
    assert f"{72 - done} of 72 files to do" in problems[0].text
    assert plan_of(logs, rigs, out).files == 72 - done


def test_a_scheduler_without_workers_ends_in_one_line(
    fleet: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After a time it is no longer waited for: one problem, that says how many files are to be done."""
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(cluster_of_fleet, "ALIVE_S", 0.1)
    monkeypatch.setattr(cluster_of_fleet, "WORKERLESS_S", 0.3)
    plan = plan_of(find(str(fleet / "logs"))[0], Assigned(str(fleet / "rigs.csv")), tmp_path)

    with (
        distributed.LocalCluster(n_workers=0, dashboard_address="127.0.0.1:0") as idle,
        connected(idle.scheduler_address, 1) as client,
    ):
        problems, done = gather(plan, client, tmp_path, lambda part, what: None)

    assert (done, [p.kind for p in problems]) == (0, ["scheduler"])
    assert "72 of 72 files to do (no worker for 0.3 s)" in problems[0].text


def test_a_scheduler_that_is_not_there_is_one_line(
    fleet: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Exit status 2, and the address."""
    monkeypatch.setattr(cluster_of_fleet, "CONNECT", "100ms")
    logs, table, out = (str(path) for path in (fleet / "logs", fleet / "rigs.csv", tmp_path / "o"))
    arguments = ["fleet", logs, "--rigs", table, "--out", out]

    status = main([*arguments, "--scheduler", "tcp://127.0.0.1:9"])

    assert status == 2
    assert "--scheduler tcp://127.0.0.1:9: expected a Dask scheduler there" in capsys.readouterr().err


# Joints that cannot be judged, and rigs of other joints.


def rows_of(table: Path) -> list[dict[str, str]]:
    """The rows of a table."""
    with table.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def write_rows(table: Path, rows: list[dict[str, str]]) -> None:
    """Write them in its place."""
    with table.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


@pytest.mark.slow
def test_a_joint_with_the_rig_of_another_is_not_judged_and_a_late_one_is_told(tmp_path: Path) -> None:
    """A wrong rig takes a joint out of the tests, and changes those of no other; a missing month is said."""
    eccentric.bench_fleet(tmp_path / "fleet", joints=4, months=6, degrading=1, bad_sensors=0, seconds=30.0)
    logs, table = tmp_path / "fleet" / "logs", tmp_path / "fleet" / "rigs.csv"
    shutil.rmtree(next(logs.glob("joint=*4/*06")))
    right = eccentric.diagnose_fleet(logs, table, tmp_path / "right", workers=1)
    rows = rows_of(table)
    changed = {one.joint for one in right.drifting}
    wrong = next(row for row in rows if row["joint"] not in changed)
    wrong["M_kg"] = str(3.0 * float(wrong["M_kg"]))
    write_rows(table, rows)
    again = eccentric.diagnose_fleet(logs, table, tmp_path / "again", workers=1)

    assert (right.document["joints_tested"], again.document["joints_tested"]) == (4, 3)
    assert list(right.document["joints_behind"].values()) == ["2025-05"]
    assert "1 joint without a result in the last period" in right.summary()
    assert {one.joint for one in again.drifting} == changed
    tested = [_tests(tmp_path / out) for out in ("right", "again")]
    assert wrong["joint"] in {joint for joint, _ in tested[0]}
    assert wrong["joint"] not in {joint for joint, _ in tested[1]}
    assert {joint for joint, called in tested[1] if called == "1"} == changed


def _tests(out: Path) -> set[tuple[str, str]]:
    """The joints of changes.csv, each with whether it is said to have changed."""
    return {(row["joint"], row["joint_changed"]) for row in rows_of(out / "changes.csv")}


def test_what_cannot_be_judged_is_told(tmp_path: Path) -> None:
    """Four periods are too few to test; three times the mass is another joint's; no mass is told once."""
    eccentric.bench_fleet(tmp_path / "fleet", joints=3, months=4, degrading=1, bad_sensors=0, seconds=15.0)
    table = tmp_path / "fleet" / "rigs.csv"
    rows = rows_of(table)
    _, heavy, without = (row["joint"] for row in rows)
    rows[1]["M_kg"] = str(3.0 * float(rows[1]["M_kg"]))
    rows[2]["M_kg"] = ""
    write_rows(table, rows)

    found = eccentric.diagnose_fleet(tmp_path / "fleet" / "logs", table, tmp_path / "out", workers=1)
    problems = [(one.joint, one.kind) for one in found.problems]

    assert problems == sorted(
        [*((row["joint"], "not tested") for row in rows[:2]), (heavy, "another rig"), (without, "no rig")]
    )
    assert "No joint could be tested for a change" in found.summary()
    (rig,) = [one.text for one in found.problems if one.kind == "another rig"]
    assert "got 0.3" in rig
