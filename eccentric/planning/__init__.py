"""What to measure next: a motion to decide between the remaining candidates of a diagnosis.

    motion      feasible pieces of motion within the bounds, and their sequence
    question    the inputs of a plan: rivals, log, noise; from a diagnosis or its document
    separation  the distance of two rivals on a motion, each refitted to log and motion
    choice      the sequence of pieces that best separates the rivals; its probability; added mass
    outcome     the plan: motion, rivals, probability
    detectable  without a log: the speed, mass and time that would show friction by F_N
    limits      every threshold, with its reason

In: a `Diagnosis`, or logs and its document, and `Bounds`.  Out: a `MeasurementPlan`.
May import: `diagnosis` and all rooms below it.
"""

from eccentric.planning.detectable import DetectionPlan, plan_detection, sought_of
from eccentric.planning.limits import DECIDES, FIRMWARE_HZ, HARDLY, RATE_HZ, SHOWN_AT_Z, WORTH_A_RUN
from eccentric.planning.motion import Bounds, Reference, read_bounds
from eccentric.planning.outcome import MeasurementPlan, planned, require_link
from eccentric.planning.question import Question, question_from, question_of
