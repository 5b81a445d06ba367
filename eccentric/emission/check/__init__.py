"""Checks of an emitted C source for its user: a self-test, and a driver for a proof.

In: a Model and its emitted files. Out: `render_check`, file name -> text.
"""

from eccentric.emission.check.files import complete, joints_of, limits, proof_command, render_check, views
