"""`show` under the name that scripts import it by."""

from eccentric.core import show

__all__ = ["show"]
