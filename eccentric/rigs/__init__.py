"""What the user knows of the test bench: a rig file in, checked values in SI units out."""
