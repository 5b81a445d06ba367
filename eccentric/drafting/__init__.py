"""From a log that nobody has described to the draft of its rig file, and a rig file checked as a whole.

In: a `Log`.  Out: a `Draft`: for each channel a column and a unit (`Proposal`), for each other line of the
rig its value or a question (`RigLine`), each with its evidence in words and any doubt; as TOML (`toml_of`).

    words       what a name says: quantity, unit, side, and whether it is measured, set or computed
    joints      which columns belong to which of several joints
    columns     what values show by themselves: steps, wraps, whole numbers; which is the slope of another
    units       the time, its unit and the runs; units of angle and speed that agree
    balance     how far motion explains a column: friction, speed, inertia, gravity; the gear
    carriage    the load of a drive that moves a carriage
    drives      current, torque or voltage
    others      temperature, supply, duty cycles, flags
    questions   the other lines, and what no log shows
    proposal    a column and a unit for a channel, with the evidence
    draft       all of it
    written     the draft as a rig file
    of_arm      the same for all joints of an arm, columns by pattern
    against     a rig file checked against the draft
    limits      every threshold, with its reason

May import: `logs`, `rigs`, `signals` for a line in the drive, `model` for the chain of an arm. Nothing is
fitted here, and names are evidence among others.
"""

from eccentric.drafting.against import log_complaints
from eccentric.drafting.draft import Draft, draft_of
from eccentric.drafting.of_arm import draft_of_arm
from eccentric.drafting.proposal import Proposal, RigLine
from eccentric.drafting.units import by_rate, clock_in, upright
from eccentric.drafting.written import folded, toml_of
