"""Two figures of the report in matplotlib: the residual of the balance, and friction over the velocity."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from eccentric.report.arrays import BalanceResiduals, Channel
from eccentric.report.data import ReportData
from eccentric.report.panels import Panel, friction_panel, residual_panel
from eccentric.report.text import curve_name

__all__ = ["plot_report"]

# Okabe and Ito's colours, as in the figures of the page: colour, dash, mark.
_STYLES = {
    "measured": ("#8a8a8a", "-", "o"),
    "linear": ("#cc79a7", ":", ""),
    "paper": ("#d55e00", "--", ""),
    "extended": ("#0072b2", "-", ""),
    "before": ("#d55e00", "--", "o"),
    "after": ("#0072b2", "-", "o"),
    "effect": ("#009e73", "-.", ""),
}
_WITH_BARS = {"measured", "before", "after"}


def plot_report(data: ReportData, left: Any, right: Any) -> None:
    """Draw the first figures of the report on two matplotlib axes.

    On the left the residual before and after, over the signal that it depends on most; on the right measured
    and predicted friction over the motor velocity, or the residual if the balance contains no friction.
    Points are means over bins; bars extend from the 10 % to the 90 % quantile of their rows.
    """
    balance, said = data.errors.balances[0], data.source.axis.said
    order = {key: k for k, key in enumerate(data.conclusion.depends_on)}
    channels = sorted(balance.rows.channels, key=lambda c: order.get(c.key, len(order)))
    panels = (residual_panel(balance, channel) for channel in channels)
    _draw(left, next((panel for panel in panels if panel is not None), None), balance, "residual", said)
    velocity = balance.rows.channel("velocity")
    friction = None if velocity is None else friction_panel(balance, velocity)
    if friction is not None:
        _draw(right, friction, balance, balance.quantity, said)
    else:
        _draw(right, _residual(balance, velocity), balance, "residual", said)
    added = ", ".join(effect.id for effect in data.extended.effects) or data.conclusion.verdict.replace(
        "_", " "
    )
    left.figure.suptitle(f"{', '.join(data.source.logs)}: {added}", fontsize=9.0)


def _residual(balance: BalanceResiduals, channel: Channel | None) -> Panel | None:
    return None if channel is None else residual_panel(balance, channel)


def _draw(
    axes: Any, panel: Panel | None, balance: BalanceResiduals, quantity: str, said: Callable[[str], str]
) -> None:
    if panel is None:
        axes.set_axis_off()
        return
    for name, curve in panel.curves.items():
        color, line, mark = _STYLES[name]
        if name in _WITH_BARS:
            axes.vlines(panel.at, curve.low, curve.high, color=color, alpha=0.35, linewidth=2.0)
        style = {"color": color, "linestyle": line, "marker": mark, "markersize": 3.0}
        axes.plot(panel.at, curve.middle, label=said(curve_name(name)), **style)
    against = " × sgn ω" if panel.against_motion else ""
    axes.set_xlabel(f"{panel.channel.label} [{panel.channel.unit}]")
    axes.set_ylabel(said(f"{quantity}{against} [{balance.unit}]"))
    axes.grid(linewidth=0.3)
    axes.legend(frameon=False, fontsize=8.0)
