"""Channels on clocks of their own: slow or short ones do not cost the rows of the others."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.logs import read_log
from eccentric.logs.clocks import Recorded, on_one_clock

T = np.arange(6000) / 100.0


def channel(name: str, time: np.ndarray, values: np.ndarray | None = None) -> Recorded:
    """A channel that is 2 t + 0.5, if no values are given."""
    return Recorded(name, time, 2.0 * time + 0.5 if values is None else values)


def test_a_topic_published_twice_costs_no_rows() -> None:
    """All 60 s remain; the parameter keeps its last value."""
    time = np.array([0.0, 0.1])
    found = on_one_clock([channel("q", T), channel("gain", time, np.array([1.0, 2.0]))], "log")

    np.testing.assert_array_equal(found.columns["time_s"], T)
    np.testing.assert_array_equal(found.columns["gain"], np.where(T < 0.1, 1.0, 2.0))


def test_a_slow_or_short_channel_has_no_value_outside_its_time() -> None:
    """A temperature of 1 Hz from 10 to 50 s, and a topic of the full rate that was on for a third."""
    slow, short = channel("slow", np.arange(10.0, 50.5)), channel("short", T[2000:4000])
    found = on_one_clock([channel("q", T), slow, short], "log")

    np.testing.assert_array_equal(found.columns["time_s"], T)
    for one, step in ((slow, 1.0), (short, 0.01)):
        begin, end = one.time[0], one.time[-1]
        values, inside = found.columns[one.name], (begin <= T) & (end >= T)
        np.testing.assert_allclose(values[inside], 2.0 * T[inside] + 0.5, rtol=1e-12)
        assert np.all(np.isnan(values[(begin - 1.01 * step > T) | (end + 1.01 * step < T)]))
    assert any("outside their own time: slow, short" in note for note in found.notes)


def test_a_mode_has_no_value_before_its_first() -> None:
    """Text is empty there, and keeps its last value to the end."""
    modes = Recorded("mode", np.array([30.0, 31.0]), np.array(["home", "run"]))
    found = on_one_clock([channel("q", T), modes], "log")

    assert {"": 2900, "home": 200, "run": 2900} == dict(
        zip(*np.unique(found.columns["mode"], return_counts=True), strict=True)
    )


def test_channels_of_a_similar_rate_end_the_log() -> None:
    """Half the rate, from 5 to 55 s: nothing is known of it outside, and rows that lack it are left out."""
    found = on_one_clock([channel("q", T), channel("i", T[500:5500:2])], "log")

    assert found.columns["q"][0] == pytest.approx(10.5)
    assert len(found.columns["q"]) == 4999
    assert not np.any(np.isnan(found.columns["i"]))


def test_channels_that_share_no_time_are_refused() -> None:
    """One ends before the other begins."""
    with pytest.raises(InputError, match="expected channels that share a time"):
        on_one_clock([channel("q", T), channel("i", T + 100.0)], "log")


def test_slow_columns_beside_full_ones_are_no_topics(tmp_path: Path) -> None:
    """A plain CSV with angle and current in each row, and two staggered slow columns, keeps its rows."""
    rows = [
        f"{k / 100},{np.sin(k / 100):.6f},{np.cos(k / 100):.6f},"
        f"{'25' if k % 100 == 0 and k <= 1000 else ''},{'24' if k % 100 == 50 else ''}"
        for k in range(5000)
    ]
    (tmp_path / "log.csv").write_text("\n".join(["t,q,i,temp,bus", *rows, ""]))
    log = read_log(tmp_path / "log.csv")

    assert log.rows == 5000
    assert np.count_nonzero(np.isfinite(log.numbers("temp"))) == 11
