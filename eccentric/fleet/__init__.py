"""Fleets: the logs of many joints over many periods, what drifts, and what changed.

    sources    LOGS -> files, each of a joint and a period; what could not be done
    sums       a file -> its sums
    work       what a worker does; the sums as Parquet, a file for each joint and period
    cluster    Dask: work spread, survived workers
    gathered   the sums of all files, and which rig is whose
    periods    sums -> coefficients with intervals, by joint and period; temperatures from the fleet
    drift      a test for each coefficient, at a false discovery rate; joints that cannot be judged
    found      what changed
    run        the whole run
    limits     every threshold, with its reason

In: paths of logs and rigs. Out: `FleetFound`, and the sums of a fleet on disk.
May import: `identification` and all rooms below it. No log is ever written to.
"""

from eccentric.fleet.cluster import connected
from eccentric.fleet.drift import FRICTION, RESIDUAL, FleetChange
from eccentric.fleet.found import Drifting, Examined, FleetFound, Suspect
from eccentric.fleet.gathered import Assigned, gather, plan_of
from eccentric.fleet.limits import RATE
from eccentric.fleet.periods import History, Period
from eccentric.fleet.run import FleetRequest, run_fleet
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
