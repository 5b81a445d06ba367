"""Fleets: the logs of many joints over many periods, what drifts, and what changed.

    sources       LOGS -> files, each of a joint and a period;   assigned  RIGS -> the rig of a joint
    sums          a file -> its sums;  store  sums as Parquet, a file for each joint and period
    work          what a worker does;  cluster  Dask: work spread, survived workers;  gathered  both together
    periods       sums -> coefficients with intervals, by joint and period
    temperatures  those of joints with bad sensors, from the fleet
    doubts        joints that cannot be judged, or have the rig of another
    drift         a test for each coefficient, at a false discovery rate
    changed       a joint against its own past, by its sums;  sample  logs for a diagnosis
    found         what changed in words;  tables  all of it as files;  problems  what could not be done
    page          what the page shows
    run           the whole run
    limits        every threshold, with its reason

In: paths of logs and rigs. Out: `FleetFound`, and the sums of a fleet on disk.
May import: `diagnosis` and all rooms below it. No log is ever written to.
"""

from eccentric.fleet.assigned import Assigned
from eccentric.fleet.cluster import connected
from eccentric.fleet.found import Drifting, Examined, FleetFound, Suspect
from eccentric.fleet.gathered import gather, plan_of
from eccentric.fleet.limits import RATE
from eccentric.fleet.page import fleet_page, fleet_sentence, joints_without_logs
from eccentric.fleet.problems import NOT_GROUPED, NOT_TESTED, SCHEDULER, UNREAD, FleetProblem, as_csv
from eccentric.fleet.run import FleetRequest, run_fleet
from eccentric.fleet.sample import Sample
from eccentric.fleet.sources import find
from eccentric.fleet.tables import changes_csv, document_of, write_coefficients
from eccentric.fleet.work import give_back

__all__ = [
    "NOT_GROUPED",
    "NOT_TESTED",
    "RATE",
    "SCHEDULER",
    "UNREAD",
    "Assigned",
    "Drifting",
    "Examined",
    "FleetFound",
    "FleetProblem",
    "FleetRequest",
    "Sample",
    "Suspect",
    "as_csv",
    "changes_csv",
    "connected",
    "document_of",
    "find",
    "fleet_page",
    "fleet_sentence",
    "gather",
    "give_back",
    "joints_without_logs",
    "plan_of",
    "run_fleet",
    "write_coefficients",
]
