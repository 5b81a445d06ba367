"""What a model lacks: residuals of a log and a library of effects in, one verdict out.

    balances      FitData -> both balances as linear designs, the setting of the library
    periods       orders of the motor that stand out in a residual
    offer         which effects of the library a log can show
    instruments   signals without the noise of the target, for what a candidate gains by chance
    from_effect   an effect becomes a candidate: columns of torque with a few shapes
    screen        candidates on one balance: scored, refined, cross-validated
    fitted_variants  effects that a person names, fitted without a search
    attribution   the search on a balance: adopt, compare, try smooth terms on the rest
    both          the search on both balances: what one of them shows is taken out of the other
    loads         which loads the friction of a joint follows
    measurements  what to measure where no effect explains the structure
    runs          recordings that differ, before they are pooled
    verdict       one verdict, a ranked list, the measurement that would decide
    limits        every threshold, with its reason

In: `FitData`, a `Model`, a `Rig`. Out: an `Attribution`.
May import: `fitting`, `signals`, `rigs`, `effects`, `model`.
"""

from eccentric.search.attribution import Search
from eccentric.search.balances import balances_of, setting_of, variables_of
from eccentric.search.candidate import Candidate, Variant
from eccentric.search.crossval import bounded_solve
from eccentric.search.fitted_variants import fitted_variants
from eccentric.search.from_effect import candidate_of
from eccentric.search.instruments import instruments_of
from eccentric.search.limits import (
    AT_FLOOR,
    CONFIRMED,
    IN_A_DRAW,
    LEAST_DEVIANCE,
    LEAST_SHARE,
    PARTS,
    STABLE,
    SURE,
)
from eccentric.search.loads import LoadSearch, required_over, searched_loads
from eccentric.search.offer import offered
from eccentric.search.refinement import refined
from eccentric.search.runs import runs_that_differ
from eccentric.search.screen import Screen
from eccentric.search.verdict import Adopted, Attribution, Ranked, attribute, unconfirmed

__all__ = [
    "AT_FLOOR",
    "CONFIRMED",
    "IN_A_DRAW",
    "LEAST_DEVIANCE",
    "LEAST_SHARE",
    "PARTS",
    "STABLE",
    "SURE",
    "Adopted",
    "Attribution",
    "Candidate",
    "LoadSearch",
    "Ranked",
    "Screen",
    "Search",
    "Variant",
    "attribute",
    "balances_of",
    "bounded_solve",
    "candidate_of",
    "fitted_variants",
    "instruments_of",
    "offered",
    "refined",
    "required_over",
    "runs_that_differ",
    "searched_loads",
    "setting_of",
    "unconfirmed",
    "variables_of",
]
