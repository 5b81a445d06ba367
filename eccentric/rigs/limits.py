"""Every limit of what a rig file may say, each with its reason."""

SMALLEST, LARGEST = 1e-15, 1e9
"""Sizes that a quantity can have besides zero, in SI: from the inertia of a watch's wheel to a ship's."""
LEAST_LOW_PASS_HZ = 1e-3
"""Below, the filter is singular in double precision at usual rates, and nothing of the motion remains."""
LEAST_GRAVITY = 1e-9
"""M L cos(tilt) [kg m] from which gravity may show an inertia: less is the rounding of a level plane."""
USUAL_PITCH_M = 0.01
"""Of a screw, where none is given: what builds up over a part of a turn then has a usual range of lengths."""

# What a file of an arm may say.

LARGEST_OF_ARM = 1e9
"""Size of a number in SI: beyond a ship's inertia it is a unit that was left out; far beyond, squares of it
overflow in single precision."""
LARGEST_ANGLE = 6.284
"""A turn [rad], rounded: a plain number beyond is one of degrees."""
SMALLEST_INERTIA = 1e-15
"""Below the wheel of a watch [kg m^2], the tensor of a URDF is what a program for drawing left of 0; as it is
rounded, it would be that of no body."""
