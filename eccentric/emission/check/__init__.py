"""What checks an emitted C source on its user's side: a self-test, and a driver for its proof.

In: a Model and its emitted files. Out: `render_check`, file name -> text.
"""

from eccentric.emission.check.files import render_check, views

__all__ = ["render_check", "views"]
