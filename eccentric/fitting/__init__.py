"""Signals and a model in, coefficients with uncertainty out. The first room that knows a model."""
