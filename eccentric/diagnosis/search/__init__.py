"""What a model lacks: residuals of a log and a library of effects in, one verdict out.

    balances      FitData -> both balances as linear designs; motor orders that stand out in a residual;
                  signals without the noise of the target, for what a candidate gains by chance
    from_effect   an effect becomes a candidate: torque columns with a few shapes; which effects are offered
    candidate     a candidate and its variants, refined; smooth terms in a variable, where no effect explains
                  what is left
    screen        candidates on one balance: scored, refined, cross-validated
    crossval      cross-validation by blocks of time, with bounds; rows that are correlated
    stability     how often an effect is found on variants of the log; what it gains by chance
    attribution   the search on a balance: adopt, compare, try smooth terms on the rest; which loads the
                  friction of a joint follows
    two_balances  the search on both balances: what one of them shows is taken out of the other
    verdict       one verdict, a ranked list, the measurement that would decide
    limits        every threshold, with its reason

In: `FitData`, a `Model`, a `Rig`. Out: an `Attribution`.
May import: `identification`, `signals`, `rigs`, `effects`, `model`.
"""

from eccentric.diagnosis.search.attribution import required_over, searched_loads
from eccentric.diagnosis.search.balances import balances_of, instruments_of, setting_of, variables_of
from eccentric.diagnosis.search.candidate import Candidate, Variant, refined
from eccentric.diagnosis.search.crossval import (
    Gram,
    bounded_solve,
    bounded_solve_each,
    sum_of_each,
    unexplained,
)
from eccentric.diagnosis.search.from_effect import candidate_of, offered
from eccentric.diagnosis.search.limits import (
    AT_FLOOR,
    CONFIRMED,
    IN_A_DRAW,
    LEAST_DEVIANCE,
    LEAST_PERIODS,
    LEAST_SHARE,
    PARTS,
    STABLE,
    SURE,
)
from eccentric.diagnosis.search.screen import Screen, fitted_variants
from eccentric.diagnosis.search.verdict import (
    Adopted,
    Attribution,
    NextMeasurement,
    attribute,
    next_measurement,
    unconfirmed,
)
