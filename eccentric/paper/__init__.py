"""The paper: findings about it, computed from the derivation, and its figures from the emitted modules.

    audit    discrepancies in the paper, computed from the derivation, with our interpretation
    figures  figures 2, 4 and 5

May import: `model`, `emission`.
"""

from eccentric.paper.audit import PRINTED, agrees, findings, polynomial, table_1
from eccentric.paper.figures import (
    Section,
    draw,
    figure_2,
    figure_4,
    figure_5,
    friction_surface,
    sections,
    steady_curves,
)
