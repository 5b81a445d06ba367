"""Motion of a frame in a moving carrier, differentiated in time with SymPy; Newton and Euler for its body.

A carrier has the rotation R(t) and the origin r(t). Its angular velocity w, in its own components, is defined
by R' = R S(w); r'' = R a. A frame moves in it with origin s(t) and rotation Q(t). All components below are in
the carrier: the factors after R.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import sympy as sp

from eccentric.model.chain.links import skew
from eccentric.model.quantity import Definition, quantity

t = sp.Symbol("t", real=True)
AXES = "xyz"


def letters(name: str) -> sp.ImmutableMatrix:
    """Three symbols name_x, name_y, name_z, as a column."""
    return sp.ImmutableMatrix(sp.symbols([f"{name}_{axis}" for axis in AXES], real=True))


def _of_time(name: str) -> sp.Matrix:
    return sp.Matrix([sp.Function(f"{name}_{axis}", real=True)(t) for axis in AXES])


w, alpha, a, s = letters("w"), letters("alpha"), letters("a"), letters("s")
s_dot, s_ddot = letters("s^'"), letters("s^''")
U = sp.ImmutableMatrix(3, 3, lambda i, k: sp.Symbol(f"U_{AXES[i]}{AXES[k]}", real=True))
cosine, sine, rate_l, acceleration_l = sp.symbols("cosine sine omega_l alpha_l", real=True)

_R = sp.Matrix(3, 3, lambda i, k: sp.Function(f"R_{i}{k}", real=True)(t))
_r, _w, _s = _of_time("r"), _of_time("w"), _of_time("s")
_angle = sp.Function("theta_l", real=True)(t)


def _rate(matrix: sp.Matrix) -> sp.Matrix:
    """The derivative in time, with R' = R S(w) and r'' = R a."""
    rotation_rate, origin_acceleration = _R * skew(_w), _R * a
    rules = {entry.diff(t): rotation_rate[k] for k, entry in enumerate(_R)}
    rules |= {entry.diff(t, 2): origin_acceleration[k] for k, entry in enumerate(_r)}
    return matrix.diff(t).xreplace(rules)


def _seen(matrix: sp.Matrix) -> sp.Matrix:
    """The factor after R: the same for every row of R, extracted here from the first."""
    columns = [sp.expand(matrix[0, k]) for k in range(matrix.cols)]
    return sp.Matrix(3, matrix.cols, lambda i, k: columns[k].coeff(_R[0, i]))


@cache
def _by_letters() -> list[tuple[sp.Expr, sp.Expr]]:
    """Each function of time and its symbol, derivatives first."""
    return [
        *zip(_s.diff(t, 2), s_ddot, strict=True),
        *zip(_s.diff(t), s_dot, strict=True),
        *zip(_s, s, strict=True),
        *zip(_w.diff(t), alpha, strict=True),
        *zip(_w, w, strict=True),
        (_angle.diff(t, 2), acceleration_l),
        (_angle.diff(t), rate_l),
        (sp.cos(_angle), cosine),
        (sp.sin(_angle), sine),
    ]


def _written(matrix: sp.Matrix) -> sp.ImmutableMatrix:
    for function, letter in _by_letters():
        matrix = matrix.subs(function, letter)
    return sp.ImmutableMatrix(matrix)


def pythagoras(entry: sp.Expr, angle: sp.Expr) -> sp.Expr:
    """The entry expanded, with sin^2 = 1 - cos^2."""
    return sp.expand(sp.expand(entry).subs(sp.sin(angle) ** 2, 1 - sp.cos(angle) ** 2))


@cache
def turning() -> sp.ImmutableMatrix:
    """U = R^T R'': the acceleration of a point of the carrier is a + U s, with w and alpha = w'."""
    return _written(_seen(_rate(_rate(_R))))


@cache
def acceleration() -> sp.ImmutableMatrix:
    """R^T (r + R s)'': the acceleration of a point at s(t) in the carrier."""
    total = _written(_seen(_rate(_rate(_r + _R * _s))))
    by_position = total.jacobian(s)
    rest = total.xreplace(dict.fromkeys(s, sp.Integer(0)))
    if sp.expand(by_position - turning()) != sp.zeros(3):
        raise AssertionError("the factor of s is R^T R''")
    return sp.ImmutableMatrix(U * s + rest)


@dataclass(frozen=True)
class Turned:
    """A frame that turns in its carrier by theta_l about one of the carrier's axes."""

    rotation: sp.ImmutableMatrix  # Q, its axes as columns
    velocity: sp.ImmutableMatrix  # its angular velocity in its own components, in w of the carrier
    # its time derivative, in alpha of the carrier and the frame's velocity (symbols w)
    acceleration: sp.ImmutableMatrix


@cache
def turned(axis: int) -> Turned:
    """The frame that turns about x (0), y (1) or z (2)."""
    following, last = (axis + 1) % 3, (axis + 2) % 3
    Q = sp.eye(3)
    Q[following, following] = Q[last, last] = sp.cos(_angle)
    Q[last, following], Q[following, last] = sp.sin(_angle), -sp.sin(_angle)
    # R Q is the rotation of the frame: (R Q)' = (R Q) S(velocity).
    spin = (Q.T * _seen(_rate(_R * Q))).applyfunc(lambda entry: pythagoras(entry, _angle))
    velocity = sp.Matrix([spin[2, 1], spin[0, 2], spin[1, 0]])
    change = velocity.diff(t)
    # It is shorter in terms of the frame's velocity: Q^T w = own - theta' e, solved for w of the carrier.
    own = letters("own")
    back = dict(zip(_w, Q * (own - velocity.subs(dict.fromkeys(_w, 0))), strict=True))
    change = change.xreplace({f.diff(t): x for f, x in zip(_w, alpha, strict=True)}).xreplace(back)
    change = change.applyfunc(lambda entry: pythagoras(entry, _angle)).xreplace(
        dict(zip(own, w, strict=True))
    )
    return Turned(_written(Q), _written(velocity), _written(change))


# Newton and Euler for a body: the accelerations of its mass points, summed.
#
# A point at rho in the frame of the body is accelerated by a + U rho. The force is the sum of this over the
# mass, the moment about the origin that of rho x (a + U rho). Both are linear in the moments of mass: m, h
# (first) and Sigma (second).
m = sp.Symbol("m", real=True)
h, rho = letters("h"), letters("rho")
Sigma = sp.ImmutableMatrix(
    3, 3, lambda i, k: sp.Symbol(f"Sigma_{AXES[min(i, k)]}{AXES[max(i, k)]}", real=True)
)
J_m, omega_m, alpha_m = sp.symbols("J_m omega_m alpha_m", real=True)


def _of_point() -> sp.ImmutableMatrix:
    """Acceleration of a point at rest in the body."""
    at_rest = dict.fromkeys((*s_dot, *s_ddot), sp.Integer(0))
    return acceleration().xreplace(at_rest | dict(zip(s, rho, strict=True)))


def _sum_of_mass(density: sp.Expr) -> sp.Expr:
    """The sum over the mass points of a polynomial in rho: 1 is m, rho_i is h_i, rho_i rho_k is Sigma_ik."""
    total = sp.Integer(0)
    for powers, coefficient in sp.Poly(sp.expand(density), *rho).terms():
        axes = [k for k, power in enumerate(powers) for _ in range(power)]
        moment = (m, *(h[k] for k in axes[:1]), *(Sigma[i, axes[0]] for i in axes[1:]))[len(axes)]
        total += sp.collect(coefficient, U) * moment
    # U_zz Sigma_yz - U_yy Sigma_yz as (U_zz - U_yy) Sigma_yz
    return sp.collect(sp.expand(total), list(Sigma))


@cache
def force() -> sp.ImmutableMatrix:
    """Newton: the sum of forces on the body, m times the acceleration of its centre of mass."""
    return _of_point().applyfunc(_sum_of_mass)


@cache
def moment() -> sp.ImmutableMatrix:
    """Euler: the sum of moments on the body about the origin of its frame."""
    return sp.ImmutableMatrix(rho.cross(_of_point())).applyfunc(_sum_of_mass)


@cache
def rotor(axis: int) -> sp.ImmutableMatrix:
    """The moment of a turning rotor on its carrier, in excess of that of a locked one.

    The rotor turns by theta_m about an axis of its carrier, its axis of symmetry, with inertia J_m; in terms
    of w of the carrier, omega_m and alpha_m of the rotor.
    """
    frame, angle = turned(axis), sp.Symbol("angle", real=True)
    across, along, own = sp.Symbol("across"), sp.Symbol("along"), letters("own")
    mass = {Sigma[i, k]: sp.Integer(0) for i in range(3) for k in range(i)} | dict.fromkeys(h, sp.Integer(0))
    mass |= {Sigma[k, k]: along if k == axis else across for k in range(3)}
    # Its w and alpha are those of a frame turning in the carrier.
    velocity = frame.velocity.xreplace(dict(zip(w, own, strict=True)))
    change = frame.acceleration.xreplace(dict(zip(w, velocity, strict=True)))
    motion = dict(zip(alpha, change, strict=True)) | dict(zip(w, velocity, strict=True))
    torque = moment().xreplace(dict(zip(U, turning(), strict=True)) | mass).xreplace(motion)
    torque = (frame.rotation * torque).xreplace(dict(zip(own, w, strict=True)))
    torque = torque.xreplace({rate_l: omega_m, acceleration_l: alpha_m})
    locked = {omega_m: sp.Integer(0), alpha_m: sp.Integer(0), cosine: sp.Integer(1), sine: sp.Integer(0)}
    beyond = (torque - torque.xreplace(locked)).xreplace({cosine: sp.cos(angle), sine: sp.sin(angle)})
    # The inertia about the axis is the sum of both second moments across it.
    return sp.ImmutableMatrix(
        beyond.applyfunc(lambda entry: sp.factor(pythagoras(entry, angle)).subs(across, J_m / 2))
    )


class Steps:
    """Ordered definitions; a call defines a value and returns its symbol."""

    def __init__(self) -> None:
        self.definitions: list[Definition] = []

    def __call__(self, name: str, unit: str, meaning: str, value: sp.Expr) -> sp.Expr:
        """A symbol for the value; numbers, symbols and their negatives are returned unchanged."""
        if value.is_Atom or (-value).is_Symbol:
            return value
        definition = Definition(quantity(name, unit, meaning), value)
        self.definitions.append(definition)
        return definition.symbol

    def vector(self, name: str, unit: str, meaning: str, values: sp.MatrixBase) -> sp.ImmutableMatrix:
        """The same for three components, name_x, name_y, name_z."""
        return sp.ImmutableMatrix(
            [self(f"{name}_{AXES[k]}", unit, f"{meaning}, component {AXES[k]}", values[k]) for k in range(3)]
        )


def substituted(
    template: sp.MatrixBase, *pairs: tuple[Sequence[sp.Expr], Sequence[sp.Expr]]
) -> sp.ImmutableMatrix:
    """A derived formula with values in place of its symbols; zeros and ones fold."""
    values = {
        letter: value
        for letters, entries in pairs
        for letter, value in zip(letters, entries, strict=True)
        if letter != value
    }
    return sp.ImmutableMatrix(template.xreplace(values))
