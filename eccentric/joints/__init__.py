"""The joints of an arm from its logs: each joint is treated as a single drive, loaded by all others.

In: logs and the rig of an arm.  Out: `fit_arm` -> `ArmFit` (the load that the friction of each joint depends
on, if any), `diagnose_arm` -> `ArmDiagnosis` (the effects missing in each joint).

    base_parameters  inertial parameters as numbers, and their identifiable combinations
    joint_model  one joint as a model with external torques and loads as inputs
    arm_log      the logs of all joints; one joint as a log of one drive
    bodies       bodies identified from all joints at once, and physically consistent ones
    fitted       the fit of every joint as a single drive, and the load its friction depends on
    diagnosed    the diagnosis of every joint as a single drive
    extended_arm  the arm model with the fitted friction of every joint, effects included
    predicting   prediction of other runs by a fit, and identification of their payload

May import: `diagnosis` and all rooms below it.
"""

from eccentric.joints.arm_log import ArmLog
from eccentric.joints.bodies import IdentifiedBodies
from eccentric.joints.diagnosed import (
    ArmDiagnosis,
    JointDiagnosis,
    arm_name,
    diagnose_arm,
    extended_arm,
    why_not_emitted,
)
from eccentric.joints.fitted import ArmFit, JointFit, fit_arm, gain_of, payload_of, predicted
