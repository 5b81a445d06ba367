"""Measured data in, identified parameters and named effects out."""
