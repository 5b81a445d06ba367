"""When this process imported the toolkit: sources that were changed later may not be what it runs."""

from time import time

imported_at = time()
