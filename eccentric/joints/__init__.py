"""The joints of an arm from its logs: each is the log of one drive, loaded by the motion of all others.

In: logs and the rig of an arm.  Out: `fit_arm` -> `ArmFit` (which load the friction of each joint follows,
and where Coulomb and viscous friction is enough), `diagnose_arm` -> `ArmDiagnosis` (what each joint lacks).

    base_parameters  inertial parameters as numbers, and the sums of them that torques depend on
    joint_model  one joint as a model whose inputs are what it meets
    arm_log      the logs of all joints; one joint as a log of one drive
    bodies       the bodies identified from all joints at once, and those that could exist
    fitted       every joint fitted by the rooms of one drive, and which load its friction follows
    diagnosed    every joint diagnosed by them
    extended_arm  the arm with the friction of every joint as it was fitted, effects included
    predicting   other runs predicted by a fit, and the payload that they have

May import: `diagnosis` and all rooms below it.
"""

from eccentric.joints.arm_log import ArmLog
from eccentric.joints.bodies import IdentifiedBodies
from eccentric.joints.diagnosed import ArmDiagnosis, JointDiagnosis, diagnose_arm
from eccentric.joints.extended_arm import arm_name, extended_arm, why_not_emitted
from eccentric.joints.fitted import ArmFit, JointFit, fit_arm, gain_of
from eccentric.joints.predicting import payload_of, predicted
