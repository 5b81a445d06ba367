"""A chain of one joint is the paper: the rotating link, and by it the cases C1 and C2."""

from types import SimpleNamespace

import sympy as sp

from eccentric.model import Body, Chain, Joint, Load, Model, arm, load_model, meaning, recursion, symbols
from eccentric.model import vocabulary as v
from tests import paper

M, M_l, L, g, phi, mu, J_m, J_l = symbols(v.M, v.M_l, v.L, v.g, v.phi, v.mu, v.J_m, v.J_l)
theta_m, omega_m, alpha_m = symbols(v.theta_m, v.omega_m, v.alpha_m)
theta_l, omega_l, alpha_l = symbols(v.theta_l, v.omega_l, v.alpha_l)

# The paper's link: M_l balanced about the axis, M at the distance L; J_l includes M L^2.
CHAIN = Chain(
    "link",
    [Joint(mu=mu, J_m=J_m)],
    [Body(M_l, inertia=[[0, 0, 0], [0, 0, 0], [0, 0, J_l - M * L**2]])],
    gravity=(0, -g * sp.cos(phi), -g * sp.sin(phi)),
    payload=Body(M, (0, -L, 0)),
    parameters=(v.M, v.M_l, v.L, v.mu, v.g, v.phi, v.J_m, v.J_l),
)
FOUND = recursion(CHAIN)
MODEL = arm(CHAIN, "One joint", found=FOUND)
OURS = {sp.Symbol(f"{x.name}_0", real=True): x for x in (theta_m, omega_m, alpha_m)}


def plain(expression: sp.Expr) -> sp.Expr:
    """In the paper's letters, without definitions and stable steps."""
    expanded = meaning(MODEL.expand(expression))
    names = {s: sp.Symbol(s.name.removesuffix("_0"), **s.assumptions0) for s in expanded.free_symbols}
    return expanded.xreplace(names).xreplace({sp.Symbol(x.name, real=True): x for x in OURS.values()})


def is_zero(expression: sp.Expr) -> bool:
    """Whether it vanishes once sin^2 is 1 - cos^2."""
    squares = {sp.sin(x) ** 2: 1 - sp.cos(x) ** 2 for x in (mu * theta_m, phi)}
    return sp.expand(sp.expand(expression).subs(squares)) == 0


def of_model(model: Model, expression: sp.Expr) -> sp.Expr:
    """The same of one of the paper's models, on the motor side."""
    return meaning(model.expand(expression)).subs(
        {theta_l: mu * theta_m, omega_l: mu * omega_m, alpha_l: mu * alpha_m}
    )


def test_the_normal_force_is_that_of_the_rotating_link() -> None:
    """F_N^2, with acceleration, in a tilted plane."""
    general = load_model("rotating_link")
    ours = plain(FOUND.bearings[0].loads[Load.NORMAL]) ** 2

    assert is_zero(ours - of_model(general, general.equation("normal_force").right))


def test_the_normal_force_is_that_of_the_papers_cases() -> None:
    """Equations (8) and (16), as the paper prints them."""
    steady = (plain(FOUND.bearings[0].loads[Load.NORMAL]) ** 2).subs(alpha_m, 0)
    names = SimpleNamespace(M=M, M_l=M_l, L=L, g=g, mu=mu)

    assert is_zero(steady.subs(phi, 0) - paper.normal_force_c2(theta_m, omega_m, names, sp) ** 2)
    assert is_zero(steady.subs(phi, sp.pi / 2) - paper.normal_force_c1(omega_m, names) ** 2)


def test_the_axial_force_is_the_weight_along_the_axis() -> None:
    """The transversal force of the derivation: the whole weight times sin(phi)."""
    ours = plain(FOUND.bearings[0].loads[Load.TRANSVERSAL])

    assert is_zero(ours**2 - load_model("rotating_link").equation("transversal_force").right ** 2)


def test_the_torque_is_that_of_the_rotating_link() -> None:
    """The gear passes on J_l alpha_l and the gravity torque of (5) over mu."""
    general = load_model("rotating_link")
    expected = of_model(general, general.equation("torque_on_link").right).subs(v.f_l.symbol, 0)

    assert is_zero(plain(FOUND.torques[0]) - expected)


def test_the_balances_are_those_of_the_rotating_link() -> None:
    """Motor, gear, gravity and all friction by F_N, F_T and free of load: the same two residuals."""
    general = load_model("rotating_link")
    # One symbol for F_N, which is compared above; what the paper does not have is switched off.
    force = sp.Symbol("force", nonnegative=True)
    lacking = {sp.Symbol(x, nonnegative=True): 0 for x in ("B_lM", "C_lM", "B_lG", "C_lG")}
    for name in ("mechanical", "electrical"):
        ours = MODEL.balance(f"{name}_0").residual().xreplace({FOUND.bearings[0].loads[Load.NORMAL]: force})
        theirs = general.balance(name).residual().xreplace({v.F_N.symbol: force})
        theirs = meaning(general.expand(theirs)).subs(v.F_T.symbol, (M + M_l) * g)
        known = {sp.Abs(sp.cos(phi)): sp.cos(phi), sp.Abs(sp.sin(phi)): sp.sin(phi)}
        halves = {theta_m: 2 * theta_m / mu}
        difference = (theirs - plain(ours).subs(lacking)).subs(known).subs(halves)

        assert sp.expand(sp.expand_trig(difference)) == 0, name


def test_a_link_in_the_plane_of_its_bearing_bends_by_gravity_alone() -> None:
    """The mass turns in the plane of the bearing; its weight along the axis bends at the distance L."""
    bending = plain(FOUND.bearings[0].loads[Load.BENDING])

    assert is_zero(bending**2 - (M * g * L * sp.sin(phi)) ** 2)
