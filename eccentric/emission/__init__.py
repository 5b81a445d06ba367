"""Emission: Model to Program to text. It knows no data; the templates know no physics."""

from eccentric.emission.build import build_program
from eccentric.emission.hot import load_module
from eccentric.emission.program import Assignment, Input, Program, Routine, differentiate, needed
from eccentric.emission.render import render, render_program
from eccentric.emission.write import complete, differences, write

__all__ = [
    "Assignment",
    "Input",
    "Program",
    "Routine",
    "build_program",
    "complete",
    "differences",
    "differentiate",
    "load_module",
    "needed",
    "render",
    "render_program",
    "write",
]
