"""Long logs: one pass in constant memory, then the windows of the log that say all that more would say.

    survey   a log -> its windows, each with its states and sums, on cells of 20 ms
    choice   windows -> those to be read, and what they miss
    reading  logs -> logs whole, or the chosen windows of each
    limits   every threshold, with its reason

In: logs and a `Rig`. Out: `Log`s; one of windows has an `Excerpt`.
"""

from eccentric.signals.long.limits import FIT_POINTS, SEARCH_POINTS
from eccentric.signals.long.reading import read_long, read_long_joints
