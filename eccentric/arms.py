"""`read_arm` under the name that scripts have imported it by."""

from eccentric.rigs import read_arm

__all__ = ["read_arm"]
