"""Every limit of what a rig file may say, each with its reason."""

SMALLEST, LARGEST = 1e-15, 1e9
"""Sizes that a quantity can have besides zero, in SI: from the inertia of a watch's wheel to a ship's."""
LEAST_LOW_PASS_HZ = 1e-3
"""Below, the filter is singular in double precision at usual rates, and nothing of the motion remains."""
USUAL_PITCH_M = 0.01
"""Of a screw, where none is given: what builds up over a part of a turn then has a usual range of lengths."""
