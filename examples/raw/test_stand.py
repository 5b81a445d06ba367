"""The test stand of docs/tutorial-raw.md: a drive of the virtual bench, and a logger with its own units.

    python test_stand.py monday.csv                        a sum of sines
    python test_stand.py tuesday.csv plan/reference.csv    the planned motion

The logger writes header lines, semicolons, decimal commas, a row of units, and the set point of its
controller in addition to the measured signals. The drive is simulated: the page gives its known values, the
planted effect is below.
"""

import sys
from pathlib import Path

import numpy as np

from eccentric.virtual_bench import on_reference, random_scenario, simulate

MU, EFFECT, SEED = 1.0 / 30.0, ("eddy_current", 0.06), 5
ZERO_DEG = 127.5  # of the logger


def main() -> None:
    """Simulate a measurement and write it as the logger would."""
    out, *planned = map(Path, sys.argv[1:])
    scenario = random_scenario(
        np.random.default_rng(SEED),
        case="C1",
        mu=MU,
        log_type="traj",
        effects=[EFFECT],
        noise=0.004,
        seconds=40.0,
    )
    run = simulate(scenario)
    if planned:
        reference = np.genfromtxt(planned[0], delimiter=",", names=True)
        start = reference["theta_m_rad"][0] - np.radians(ZERO_DEG)
        following = on_reference(run.scenario, reference["time_s"], reference["omega_m_rad_s"], start)
        run = simulate(following, again=True)
    log = run.columns
    columns = (
        1e3 * log["time_s"],
        np.degrees(log["theta_m_rad"]) + ZERO_DEG,
        log["omega_m_rad_s"] * 30.0 / np.pi,
        run.scenario.course.reference(log["time_s"]) * 30.0 / np.pi,
        1e3 * log["current_A"],
    )
    form = "{:.0f};{:.3f};{:.1f};{:.1f};{:.0f}"
    rows = (form.format(*row) for row in zip(*columns, strict=True))
    head = ["Scope;axis 1", f"Samples;{len(log['time_s'])}", "", "T;Pos;n;n_set;Iq", "ms;deg;1/min;1/min;mA"]
    text = "\n".join([*head, *rows]).replace(".", ",") + "\n"
    out.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
