"""Fleets: drift and changes in the logs of many joints over many periods.

    sources    LOGS -> files, each with joint and period; problems
    sums       a file -> its sums
    work       a worker's task; the sums as Parquet files by joint
    cluster    Dask: distribution of the work, recovery from dying workers
    gathered   the sums of all files; the rig of each joint
    periods    sums -> coefficients with intervals, by joint and period; temperatures from the fleet
    drift      a test for each coefficient, at a false discovery rate; joints that cannot be judged
    found      the explanation of each change
    run        the complete run
    limits     every threshold, with its reason

In: paths of logs and rigs. Out: `FleetFound`, and the sums of a fleet on disk.
May import: `identification` and all rooms below it. No log is ever written to.
"""

from eccentric.fleet.cluster import connected
from eccentric.fleet.drift import FRICTION, RESIDUAL, FleetChange
from eccentric.fleet.gathered import Assigned, gather, plan_of
from eccentric.fleet.limits import RATE
from eccentric.fleet.periods import History, Period
from eccentric.fleet.run import Drifting, Examined, FleetFound, FleetRequest, Suspect, run_fleet
from eccentric.fleet.sources import (
    NOT_GROUPED,
    NOT_TESTED,
    SCHEDULER,
    UNREAD,
    FleetProblem,
    as_csv,
    find,
    in_order,
)
from eccentric.fleet.work import Sample, arrow_of, give_back
