"""Residuals and a library of effects in, one verdict out."""
