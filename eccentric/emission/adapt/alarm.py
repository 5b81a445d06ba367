"""The alarm: two cumulative sums of the standardised innovation, one for each sign of a change.

A sum S = max(0, S + z - k) gives an alarm above h (Page, Biometrika 41, 1954). From S = u it takes on average
L(u) samples, which solve the integral equation

    L(u) = 1 + L(0) P(z <= k - u) + integral over 0 < x < h of L(x) p(x + k - u)

(Brook and Evans, Biometrika 59, 1972, as a Markov chain; here by Nystroem's method on Gauss-Legendre nodes).
h follows from the mean number of samples between false alarms; it is not a typed-in constant.

A delay is Lorden's (Annals of Mathematical Statistics 42, 1971): the mean, at the worst moment that the
samples before the change can prepare. For a sum that is when it is 0, so that the delay is L(0) after the
change. Of all tests with the same mean time between false alarms, one sum with k at half the shift has the
least (Moustakides, Annals of Statistics 14, 1986): no test is below. That least delay grows as Lorden's
2 ln(between)/shift^2 for ever rarer false alarms; at finite ones this leaves out a constant: no bound.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr

_NODES = 200


@dataclass(frozen=True)
class Alarm:
    """The threshold of the alarm, and what is known of it.

    Attributes:
        shift: the change of the innovation that it is made for, in its standard deviations.
        reference: k, half the shift: the optimum for it.
        threshold: h.
        between: mean number of samples between false alarms, of both sums together.
        delay: mean number of samples until that change is announced, at the worst moment: from sums of 0.
        bound: the least such delay of any test with these false alarms: of one sum, which knows the sign.
        lorden: what the bound grows as for ever rarer false alarms, 2 ln(between)/shift^2.
    """

    shift: float
    reference: float
    threshold: float
    between: float
    delay: float
    bound: float
    lorden: float


def run_length(reference: float, threshold: float, mean: float = 0.0) -> float:
    """Mean number of samples until one sum exceeds the threshold, from 0.

    Args:
        reference: k; threshold: h; mean: that of the innovation, which is normal with standard deviation 1.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    x, w = (nodes + 1) * threshold / 2, weights * threshold / 2
    start = np.concatenate(([0.0], x))
    offset = reference - mean
    kernel = np.exp(-((x[None, :] + offset - start[:, None]) ** 2) / 2) / math.sqrt(2 * math.pi) * w
    system = np.eye(_NODES + 1)
    system[:, 1:] -= kernel
    system[:, 0] -= ndtr(offset - start)
    return float(np.linalg.solve(system, np.ones(_NODES + 1))[0])


def alarm_of(shift: float, false_alarms: float) -> Alarm:
    """The alarm for a change of `shift` standard deviations, with that many samples between false alarms.

    The two sums are never above 0 together for long, and their rates add up (van Dobben de Bruyn 1968).
    """
    reference = shift / 2
    threshold = threshold_of(reference, 2 * false_alarms)
    return Alarm(
        shift=shift,
        reference=reference,
        threshold=threshold,
        between=run_length(reference, threshold) / 2,
        delay=run_length(reference, threshold, shift),
        bound=run_length(reference, threshold_of(reference, false_alarms), shift),
        lorden=2 * math.log(false_alarms) / shift**2,
    )


def threshold_of(reference: float, between: float) -> float:
    """The threshold of one sum with that many samples between false alarms on average."""

    def excess(threshold: float) -> float:
        return math.log(run_length(reference, threshold) / between)

    # A run length grows as exp(2 k h): this is beyond the root, and far from where a solution loses digits.
    highest = (math.log(2 * between) + 4) / (2 * reference)
    return float(brentq(excess, 1e-3, highest, xtol=1e-9))
