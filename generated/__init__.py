"""Friction models of drives that swing an unbalanced mass, written by `make derive`; they need only NumPy."""
