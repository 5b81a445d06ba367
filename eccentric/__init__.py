"""Friction models of drives that swing an unbalanced mass: derived, emitted, held against measured data.

The pipeline, each stage in the package of its name:

    derive    derivations/*.py         first principles -> Model        (eccentric.model)
    emit      Model -> Program         -> NumPy module, C99 header and source   (eccentric.emit, templates/)
    identify  log + rig -> channels    -> fit, residual                 (eccentric.identify)

`eccentric.bench` simulates a test bench with code of its own; `eccentric.cli` is the command line.
Imports run one way: model <- emit <- identify <- cli.
"""

__version__ = "0.1.0"
