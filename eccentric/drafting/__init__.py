"""From a log that nobody has described to the draft of its rig file, and a rig file checked as a whole.

In: a `Log`.  Out: a `Draft`: for each channel a column and a unit (`Proposal`), for each other line of the
rig its value or a question (`RigLine`), each with its evidence in words and any doubt; as TOML (`toml_of`).

    words       what a name says: quantity, unit, side
    columns     what values show by themselves: steps, wraps, whole numbers
    clock       the time, its unit, the runs
    motion      which column is the slope of another
    balance     how far motion explains a column: friction, speed, inertia, gravity
    units       units of time, angle and speed that agree
    drives      current, torque or voltage
    others      temperature, supply, flags
    questions   the other lines, and what no log shows
    draft       all of it
    toml        the draft as a rig file
    of_arm      the same for all joints of an arm, columns by pattern
    against     a rig file held against the draft

May import: `logs`, `rigs`, and `model` for the chain of an arm. Names are evidence among others; nothing is
fitted here.
"""

from eccentric.drafting.against import log_complaints
from eccentric.drafting.draft import Draft, draft_of
from eccentric.drafting.of_arm import draft_of_arm
from eccentric.drafting.proposal import Proposal, RigLine
from eccentric.drafting.toml import toml_of

__all__ = ["Draft", "Proposal", "RigLine", "draft_of", "draft_of_arm", "log_complaints", "toml_of"]
