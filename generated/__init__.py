"""Friction models of drives that swing an unbalanced mass, written by `make derive`; NumPy is all they need."""
