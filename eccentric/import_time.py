"""When this process imported the toolkit: it may not run sources that were changed later."""

from time import time

imported_at = time()
