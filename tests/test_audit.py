"""The audit: Table 1 to all printed digits, and the findings as numbers calculated manually."""

import math
from fractions import Fraction

import pytest
import sympy as sp

from eccentric.cli import main
from eccentric.paper import PRINTED, agrees, findings, polynomial, table_1
from tests import paper

MU = [sp.Rational(1, 5), sp.Rational(1, 30)]


@pytest.mark.parametrize("mu", MU, ids=str)
def test_table_1_to_all_printed_digits(mu: sp.Rational) -> None:
    """The derivation gives every printed digit, and exactly what the hand-transcribed closed forms give."""
    by_hand = paper.polynomial_c1(1, paper.table_1(mu=str(mu)))
    derived = polynomial(mu)

    assert [Fraction(str(value)) for value in derived] == list(by_hand)
    assert all(
        agrees(text, value) for text, value in zip(paper.TABLE_1_POLYNOMIAL[str(mu)], derived, strict=True)
    )
    assert paper.TABLE_1_POLYNOMIAL[str(mu)] == PRINTED[mu]


def test_agreement_sees_one_unit_in_the_last_digit() -> None:
    """The comparison with printed digits can fail."""
    assert agrees("4.7139e-3", sp.Rational("0.00471392"))
    assert not agrees("4.7138e-3", sp.Rational("0.00471392"))
    assert not agrees("4.7140e-3", sp.Rational("0.00471392"))


@pytest.mark.parametrize(
    ("finding", "figures"),
    [
        (0, ["4.7139e-03", "3.9392e-02", "4.4087e-03", "1.3232e-02", "5.4987e-03", "1.17872e-01"]),
        (1, ["4.7139e-03", "1.3505e-03"]),
        (
            2,
            [
                *("0.0464", "0.1179", "0.1711", "7.411882"),
                *("0.1183 N m at (0.02 rad/s, 3.14 rad)", "0.0465 N m at (7.41 rad/s, 3.14 rad)"),
            ],
        ),
        (3, ["0.0200", "0.0318"]),
        (4, ["-0.03939", "-0.02339"]),
        (5, ["mu > 0", "sgn(mu omega_m) = sgn(omega_m) for every positive mu"]),
        (6, ["F_N = M_l*g", "1.962 N", "0.0314 N m"]),
        (7, ["0.0228 N m", "F = 0.1711 N m, of which 0.1482", "F = 0.0464 N m, of which 0.0236"]),
        (8, ["u from 5.45 V at theta_l = 4.14 rad to 32.41 V at 1.21 rad"]),
        (9, ["2*L*M*mu^3*(3*B_lN*mu*omega_m + C_lN) at the bottom", "at the top it is -s times that"]),
    ],
)
def test_findings_give_the_figures_worked_out_by_hand(finding: int, figures: list[str]) -> None:
    """Each finding shows its numbers, worked out with the closed forms, not read off the program."""
    text = findings()[finding]

    assert [figure for figure in figures if figure not in text] == []


def test_audit_prints_table_and_findings(capsys: pytest.CaptureFixture[str]) -> None:
    """`eccentric audit` prints both gear ratios and the numbered findings."""
    assert 0 == main(["audit"])
    printed = capsys.readouterr().out

    assert table_1() in printed
    assert 8 == printed.count("agrees\n")
    assert "DIFFERS" not in printed


@pytest.mark.parametrize("speed", [3.0, 7.0, 8.0, 20.0])
def test_friction_at_the_top_bends_down_below_the_critical_velocity_and_up_above(speed: float) -> None:
    """By the closed forms: at the bottom it bends up at every speed."""
    p = paper.table_1(float)

    def bend(angle: float) -> float:
        before, here, after = (
            paper.friction_torque_c2(angle / p.mu, w / p.mu, p) for w in (speed - 0.01, speed, speed + 0.01)
        )
        return after - 2.0 * here + before

    assert (True, speed > 7.411882) == (bend(0.0) > 0.0, bend(math.pi) > 0.0)
