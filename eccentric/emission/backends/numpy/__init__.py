"""The NumPy module of a Program."""
