"""Every limit of what a file of an arm may say, each with its reason."""

LARGEST = 1e9
"""Size of a number in SI: beyond a ship's inertia it is a unit that was left out; far beyond, squares of it
overflow in single precision."""
