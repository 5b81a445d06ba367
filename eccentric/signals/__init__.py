"""Logs and a rig in, motor-side signals in SI units out: masks, hold-out, the rows of a comparison."""
