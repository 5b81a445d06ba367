"""The loop: fit, search, extend, refit, score; and the result as a script.

    loop          logs, rig -> Diagnosis, everything that was found: every stage in order
    search        what a model lacks: candidates, null level, verdict
    stage         the request; what a log offers to a base model before the search; runs that differ
    models        the models after the search; the best effect or shipped model where none is adopted; what
                  was found beside what is known of it from elsewhere
    score         held-out errors before and after, run by run where there are enough; what is left there
                  that is periodic in the motor angle
    empirical     a term without a cause: which variables it follows, how many pieces, its coefficients
    contest       models on the same rows, extended by effects or not
    model_script  the extended model as a derivation, and the base model where it was given as an object
    limits        every threshold, with its reason

In: logs and a rig. Out: a `Diagnosis`.
May import: `identification` and all rooms below it.
"""

from eccentric.diagnosis.contest import BASELINE, Contest, Entry, contest
from eccentric.diagnosis.empirical import Empirical, fit_empirical, variables_followed
from eccentric.diagnosis.limits import PROVABLE, ROUNDING
from eccentric.diagnosis.loop import BASE, Asked, Diagnosis, diagnose, diagnosed, staged_log
from eccentric.diagnosis.model_script import (
    base_source,
    extended_model,
    is_result_name,
    result_name,
    script,
    undecided,
)
from eccentric.diagnosis.models import RangeCheck, constant_first
from eccentric.diagnosis.score import OverRuns, leave_runs_out, only_below, orders_of
from eccentric.diagnosis.search import (
    IN_A_DRAW,
    LEAST_DEVIANCE,
    LEAST_SHARE,
    PARTS,
    STABLE,
    SURE,
    Candidate,
    NextMeasurement,
    Screen,
    Variant,
    balances_of,
    bounded_solve,
    candidate_of,
    next_measurement,
    refined,
    required_over,
    searched_loads,
)
from eccentric.diagnosis.stage import SearchRequest, staged
