"""The version: of the package, of what it emits, of its reports."""

__version__ = "0.2.0b1"
