"""Data quality: clipped, frozen and missing data, and contradictions with the rig.

In: the logged table, the channels made of it, the rig.  Out: findings (`assess`), warnings first.
May import: `rigs`, `model`, and of `signals` the files below `channels.py`, which asks for the findings.
"""

from eccentric.signals.quality.against_rig import beside_the_rig, shared_cause
from eccentric.signals.quality.findings import assess
from eccentric.signals.quality.ratios import Ratio
