"""What the user knows about the test bench: a rig in, checked values in SI units out.

In: the path of a TOML or JSON file, or its content. Out: a `Rig`, composed of what the log holds (`LogMap`,
with a `ColumnSource` for each channel that it maps), `Sampling`, `NamedHoldout` and `Alignment`, and with an
`AddedMass` for runs that carry one and a `Controller` where it says how the drive is controlled; the tables
of what a rig file may contain (`KEYS`, `KNOWNS`, `CHANNELS`, `ALIGNMENT`). A rig that names an arm: an
`ArmRig`, with a `Rig` for each joint. `rig_complaints` and `arm_rig_complaints` list all that is wrong at
once. `read_arm` reads an arm file, TOML, JSON or URDF: a `Chain` whose joints have the names, gear ratios
and rotors of the file; meshes are not read, and nothing is fetched.
May import: `logs` for units, `model` for the vocabulary and chains.
"""

from eccentric.rigs.arm_parts import KEYS_OF_BODIES, KEYS_OF_JOINTS
from eccentric.rigs.arm_rig import KEYS_OF_ARMS, NUMBER, ArmRig, names_arm, read_arm, read_arm_rig
from eccentric.rigs.complaints import Complaint, arm_rig_complaints, rig_complaints
from eccentric.rigs.controller import STATES, Controller
from eccentric.rigs.entries import plain_entries, read_pair
from eccentric.rigs.known import KNOWNS, AddedMass, knowns_of, mass_alone, read_mass
from eccentric.rigs.rig import COASTING, KEYS, Rig, alignment_of, read_rig, rig_of
from eccentric.rigs.sources import (
    ALIGNMENT,
    CHANNELS,
    Alignment,
    ColumnSource,
    ForceGain,
    LogMap,
    NamedHoldout,
    Sampling,
    channels_of,
    gain_of,
)
