"""Where arms come from: a file that describes a serial chain in, a checked `Chain` in SI units out.

In: the path of an arm file, `.toml` or `.json`, or of a URDF.  Out: `read_arm(path)`, a `Chain` whose joints
have the names, gear ratios and rotors of the file; what the file keeps symbolic is among its parameters, with
the file's numbers as defaults.
May import: `model` for chains, `logs` for units. Meshes are not read, and nothing is fetched.
"""

from eccentric.arms.arm_file import KEYS_OF_ARMS, read_arm
from eccentric.arms.parts import KEYS_OF_BODIES, KEYS_OF_JOINTS, complaints_of

__all__ = ["KEYS_OF_ARMS", "KEYS_OF_BODIES", "KEYS_OF_JOINTS", "complaints_of", "read_arm"]
