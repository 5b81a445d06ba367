"""What to measure next: the motion that tells apart what a log left open.

    motion      pieces of motion that a drive can follow, within the bounds, and their sequence
    question    all that a plan starts from: rivals, log, noise; from a diagnosis or its document
    separation  how far apart two rivals are on a motion, each fitted anew to log and motion
    choice      the sequence of pieces that separates the closest two; its chance; with added mass
    outcome     the plan: motion, rivals, probability
    detectable  without a log: the speed, mass and time that would show friction by F_N
    limits      every threshold, with its reason

In: a `Diagnosis`, or logs and its document, and `Bounds`.  Out: a `MeasurementPlan`.
May import: `diagnosis` and all rooms below it.
"""

from eccentric.planning.choice import require_link
from eccentric.planning.detectable import DetectionPlan, plan_detection, sought_of
from eccentric.planning.limits import DECIDES, FIRMWARE_HZ, HARDLY, RATE_HZ, SHOWN_AT_Z, WORTH_A_RUN
from eccentric.planning.motion import Bounds, Reference, read_bounds
from eccentric.planning.outcome import MeasurementPlan, planned
from eccentric.planning.question import Question, question_from, question_of
