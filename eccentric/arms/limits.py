"""Every limit of what a file of an arm may say, each with its reason."""

LARGEST = 1e9
"""Size of a number in SI: beyond a ship's inertia it is a unit that was left out; far beyond, squares of it
overflow in single precision."""
LARGEST_ANGLE = 6.284
"""A turn [rad], rounded: a plain number beyond is one of degrees."""
SMALLEST_INERTIA = 1e-15
"""Below the wheel of a watch [kg m^2], the tensor of a URDF is what a program for drawing left of 0; as it is
rounded, it would be that of no body."""
