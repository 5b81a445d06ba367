"""Numerically stable steps: opaque SymPy functions with a derivative and a `rewrite` to their meaning.

SymPy cannot re-associate their contents, so the back ends evaluate them in the fixed order given in
`eccentric.emission.program.lower`; `meaning(expression)` restores the plain formula for proofs.

Motivation: F_N^2 = (a - b)^2 + 4 a b cos^2(theta_l/2) with a = M L omega_l^2, b the weight, is the paper's
(16) without its cancellation. Near the zero of F_N (theta_l = pi, a = b) every digit depends on two
differences, a - b and theta_l - pi; each is formed once, exactly, before anything is rounded.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any, ClassVar

import sympy as sp
from sympy.core.function import ArgumentIndexError

ZERO, ONE = sp.Integer(0), sp.Integer(1)


class OpaqueStep(sp.Function):
    """Base of the opaque steps: real, and never evaluated by SymPy.

    `_plain` is the plain formula, `_slopes` the derivatives by the arguments up to the last that is not a
    parameter; a step without slopes is never differentiated.
    """

    is_extended_real = True
    _plain: ClassVar[Callable[..., sp.Expr]]
    _slopes: ClassVar[Callable[..., tuple[sp.Expr, ...]]] = staticmethod(lambda *_: ())

    @classmethod
    def eval(cls, *args: Any) -> None:
        """Remain as written, even for numbers."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """The derivative by an argument; where it jumps, the one-sided slope."""
        slopes = self._slopes(*self.args)
        if not slopes:
            return super().fdiff(argindex)
        if argindex > len(slopes):
            raise ArgumentIndexError(self, argindex)
        return slopes[argindex - 1]

    def _eval_rewrite_as_meaning(self, *args: sp.Expr, **_: Any) -> sp.Expr:
        return self._plain(*args)


class Sgn(OpaqueStep):
    """sgn(x): 1, 0 or -1; sgn(0) = 0 (friction at standstill is set-valued), derivative 0 on both sides."""

    nargs = 1
    _plain = staticmethod(sp.sign)
    _slopes = staticmethod(lambda _: (ZERO,))


class Forward(OpaqueStep):
    """1 where x > 0, else 0: the gate of a coefficient that holds for one direction of motion."""

    nargs = 1
    _plain = staticmethod(lambda x: sp.Heaviside(x, 0))
    _slopes = staticmethod(lambda _: (ZERO,))


class Backward(OpaqueStep):
    """1 where x < 0, else 0."""

    nargs = 1
    _plain = staticmethod(lambda x: sp.Heaviside(-x, 0))
    _slopes = staticmethod(lambda _: (ZERO,))


class ByDirection(OpaqueStep):
    """ByDirection(x, a, b): a where x > 0, else b; a coefficient that differs between the directions."""

    nargs = 3
    _plain = staticmethod(lambda x, a, b: sp.Piecewise((a, x > 0), (b, True)))
    _slopes = staticmethod(lambda x, a, b: (ZERO, Forward(x), Backward(x)))


class Clipped(OpaqueStep):
    """Clipped(x, low, high): x, but at most high and at least low, for low <= 0 <= high."""

    nargs = 3
    _plain = staticmethod(lambda x, low, high: sp.Min(high, sp.Max(low, x)))

    @staticmethod
    def _slopes(x: sp.Expr, low: sp.Expr, high: sp.Expr) -> tuple[sp.Expr, ...]:
        over, under = Forward(x - high), Backward(x - low)
        return 1 - over - under, under, over


class Shrunk(OpaqueStep):
    """Shrunk(x, low, high): soft threshold, the excess of x over [low, high], and exactly 0 within it."""

    nargs = 3
    _plain = staticmethod(
        lambda x, low, high: sp.Piecewise((x - high, x > high), (x - low, x < low), (0, True))
    )

    @staticmethod
    def _slopes(x: sp.Expr, low: sp.Expr, high: sp.Expr) -> tuple[sp.Expr, ...]:
        over, under = Forward(x - high), Backward(x - low)
        return over + under, -under, -over


class Quotient(OpaqueStep):
    """Quotient(a, b): a/b, divided where used: a parameter b may be 0 if the result is never used."""

    nargs = 2
    _plain = staticmethod(lambda a, b: a / b)
    _slopes = staticmethod(lambda a, b: (1 / b, -a / b**2))


class AtZero(OpaqueStep):
    """AtZero(x, a, b): a where x = 0, else b."""

    nargs = 3
    _plain = staticmethod(lambda x, a, b: sp.Piecewise((a, sp.Eq(x, 0)), (b, True)))
    _slopes = staticmethod(lambda x, a, b: (ZERO, AtZero(x, ONE, ZERO), AtZero(x, ZERO, ONE)))


class BySign(OpaqueStep):
    """BySign(x, a, b, c): a where x > 0, b where x < 0, else c."""

    nargs = 4
    _plain = staticmethod(lambda x, a, b, c: sp.Piecewise((a, x > 0), (b, x < 0), (c, True)))

    @staticmethod
    def _slopes(x: sp.Expr, *_: sp.Expr) -> tuple[sp.Expr, ...]:
        return ZERO, BySign(x, ONE, ZERO, ZERO), BySign(x, ZERO, ONE, ZERO), BySign(x, ZERO, ZERO, ONE)


class HalfCosine(OpaqueStep):
    """Half-turn cosine: sin of the half angle from the top, of size |cos(mu theta_m/2)|.

    The half angle from the top is x = (theta_m - n H) mu/2 with H = pi/mu and n the odd number that brings x
    into [-pi/2, pi/2]. Its sign changes at theta_l = 0 like that of HalfSine, so only even products are
    meaningful. mu is a parameter and never differentiated by.
    """

    nargs = 2
    _plain = staticmethod(lambda theta_m, mu: -sp.cos(mu * theta_m / 2))
    _slopes = staticmethod(lambda theta_m, mu: (mu / 2 * HalfSine(theta_m, mu),))

    def _eval_rewrite_as_chord(self, theta_m: sp.Expr, mu: sp.Expr, **_: Any) -> sp.Expr:
        return mu / 2 * Chord(theta_m, mu)


class HalfSine(OpaqueStep):
    """Half-turn sine: cos of the half angle from the top, of size |sin(mu theta_m/2)|; see HalfCosine."""

    nargs = 2
    _plain = staticmethod(lambda theta_m, mu: sp.sin(mu * theta_m / 2))
    _slopes = staticmethod(lambda theta_m, mu: (-mu / 2 * HalfCosine(theta_m, mu),))


class Chord(OpaqueStep):
    """(2/mu) HalfCosine, independent of mu near the top: there it is the motor angle from the top itself.

    Two directions an angle x apart are separated by a chord 2 sin(x/2) on the unit circle; this is the chord
    between the link and the top, on the motor side. Emission writes HalfCosine as mu/2 Chord, so that mu/2 is
    part of a coefficient and not rounded again in every call.
    """

    nargs = 2
    _plain = staticmethod(lambda theta_m, mu: -2 / mu * sp.cos(mu * theta_m / 2))
    _slopes = staticmethod(lambda theta_m, mu: (HalfSine(theta_m, mu),))


class FromTop(OpaqueStep):
    """The motor angle from the nearest top of the link, theta_m - (k + 1/2) 2 pi/mu: at most pi/mu in size.

    It jumps at the bottom, so only periodic functions of it are meaningful.
    """

    nargs = 2
    _slopes = staticmethod(lambda *_: (ONE,))

    @staticmethod
    def _plain(theta_m: sp.Expr, mu: sp.Expr) -> sp.Expr:
        turn = 2 * sp.pi / mu
        return theta_m - turn * (sp.floor(theta_m / turn) + sp.Rational(1, 2))


class Bump(OpaqueStep):
    """The quadratic B-spline on whole-numbered knots, centred at 0: a bump 3 wide and 3/4 high, sums to 1.

    Written branch-free with the distances d of |x| to both knots as d + |d|, which is never negative. The
    slope is piecewise linear: x limited to the outer knots, minus three times x limited to the inner ones.
    """

    nargs = 1
    is_nonnegative = True

    @staticmethod
    def _plain(x: sp.Expr) -> sp.Expr:
        inner, outer = sp.Rational(1, 2), sp.Rational(3, 2)
        return sp.Max(0, outer - sp.Abs(x)) ** 2 / 2 - 3 * sp.Max(0, inner - sp.Abs(x)) ** 2 / 2

    @staticmethod
    def _slopes(x: sp.Expr) -> tuple[sp.Expr, ...]:
        half = sp.Rational(1, 2)
        inner, outer = (sp.Abs(x + knot) - sp.Abs(x - knot) for knot in (half, 3 * half))
        return (half * (outer - 3 * inner),)


class Bounded(OpaqueStep):
    """Bounded(x, b): x, limited to [-b, b]; b is beyond any physical value, or 0 to switch x off.

    The square of a bounded value does not overflow, so that no result is inf - inf or 0 inf. The bound is a
    pure number, in the unit of x, and a parameter.
    """

    nargs = 2
    _plain = staticmethod(lambda x, b: sp.Piecewise((0, sp.Eq(b, 0)), (x, True)))
    _slopes = staticmethod(lambda *_: (ONE,))


class SquareDifference(OpaqueStep):
    """v^2 - w^2 as (v - w)(v + w); w is a parameter stored as two numbers: v - w is exact near v = w."""

    nargs = 2
    _plain = staticmethod(lambda v, w: v**2 - w**2)
    _slopes = staticmethod(lambda v, w: (2 * v, -2 * w))


class Magnitude(OpaqueStep):
    """sqrt(p^2 + q^2); at p = q = 0 its gradient is taken as 0 (the apex of the cone F_N)."""

    nargs = 2
    is_extended_nonnegative = True
    _plain = staticmethod(lambda p, q: sp.sqrt(p**2 + q**2))
    _slopes = staticmethod(lambda p, q: (Along(p, q), Across(p, q)))


class Along(OpaqueStep):
    """p/sqrt(p^2 + q^2), 0 at p = q = 0."""

    nargs = 2
    _plain = staticmethod(lambda p, q: p / sp.sqrt(p**2 + q**2))


class Across(OpaqueStep):
    """q/sqrt(p^2 + q^2), 0 at p = q = 0."""

    nargs = 2
    _plain = staticmethod(lambda p, q: q / sp.sqrt(p**2 + q**2))


class Gated(OpaqueStep):
    """a b, and 0 if b is 0 even if the parameter a is not given (NaN): an inertia without acceleration."""

    nargs = 2
    _plain = staticmethod(lambda a, b: a * b)
    _slopes = staticmethod(lambda a, b: (b, a))


class Leading(OpaqueStep):
    """The leading digits of a parameter, few enough that integer multiples are exact; not differentiated."""

    nargs = 1
    _plain = staticmethod(lambda x: x)


STEPS: tuple[type[OpaqueStep], ...] = tuple(OpaqueStep.__subclasses__())
"""All of the steps above, in this order."""


@lru_cache(maxsize=20_000)
def meaning(expression: sp.Expr) -> sp.Expr:
    """The expression with every step replaced by its plain formula."""
    # As `expression.rewrite("meaning")` repeated, but shared subexpressions are rewritten only once.
    if not expression.args:
        return expression
    args = [meaning(arg) for arg in expression.args]
    if hasattr(expression, "_eval_rewrite_as_meaning"):
        return meaning(expression._eval_rewrite_as_meaning(*args))  # noqa: SLF001 - SymPy's name for it
    return expression.func(*args)
