"""What a terminal shows and a file does not: colour and bars; and a line now and then where there is none."""

from __future__ import annotations

import io
import platform
import sys

import pytest

from eccentric import cli
from eccentric.cli import arguments, doctor
from eccentric.cli.arguments import coloured

PLAIN = {"NO_COLOR": "", "TERM": "xterm"}


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self) -> bool:
        """Whether it is one."""
        return True


class Clock:
    """A clock that is set by hand [s]."""

    now = 0.0

    def __call__(self) -> float:
        """The time."""
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """The clock of the progress, which is on."""
    made = Clock()
    monkeypatch.setattr(arguments.time, "monotonic", made)
    monkeypatch.delenv("ECCENTRIC_PROGRESS", raising=False)
    return made


@pytest.mark.parametrize(
    ("stream", "environment", "expected"),
    [
        (Terminal(), PLAIN, "\x1b[31mno\x1b[0m"),
        (Terminal(), PLAIN | {"NO_COLOR": "1"}, "no"),
        (Terminal(), PLAIN | {"TERM": "dumb"}, "no"),
        (io.StringIO(), PLAIN, "no"),
    ],
    ids=["terminal", "NO_COLOR", "dumb", "file"],
)
def test_colour_is_for_terminals_that_want_it(
    stream: io.StringIO, environment: dict[str, str], expected: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """NO_COLOR counts if it is not empty, as its specification says."""
    for name, value in environment.items():
        monkeypatch.setenv(name, value)

    assert expected == coloured("no", "error", stream)


def test_an_error_at_a_terminal_is_red(monkeypatch: pytest.MonkeyPatch) -> None:
    """The prefix alone: the message can be copied."""
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setattr(sys, "stderr", shown := Terminal())

    assert 2 == cli.main(["plan"])
    assert shown.getvalue().startswith("\x1b[31meccentric: error:\x1b[0m the following arguments")


def test_stages_are_told_every_ten_seconds_in_a_file(
    clock: Clock, capsys: pytest.CaptureFixture[str]
) -> None:
    """Not before ten seconds, then the latest, then not again for ten."""
    tell = arguments.progress()
    assert tell is not None
    for clock.now, line in ((2.0, "first"), (11.0, "second"), (15.0, "third"), (22.0, "fourth")):
        tell(line)

    assert "eccentric: 11 s: second\neccentric: 22 s: fourth\n" == capsys.readouterr().err


def test_a_bar_becomes_lines_with_the_time_left(clock: Clock, capsys: pytest.CaptureFixture[str]) -> None:
    """A quarter done after ten seconds leaves thirty; the end is silent."""
    show = arguments.bar()
    assert show is not None
    for clock.now, part in ((0.0, 0.0), (10.0, 0.25), (40.0, 1.0)):
        show(part)

    assert "eccentric: 10 s: 25%, 30 s left\n" == capsys.readouterr().err


def test_lines_can_be_turned_off(monkeypatch: pytest.MonkeyPatch) -> None:
    """For whoever compares what is printed."""
    monkeypatch.setenv("ECCENTRIC_PROGRESS", "off")

    assert (None, None) == (arguments.progress(), arguments.bar())


@pytest.mark.parametrize(
    ("installed", "said"),
    [("chromium", "chromium, but there is no display: copy"), (None, "none, and no display: copy")],
)
def test_the_doctor_knows_a_browser_without_a_display(
    installed: str | None, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As in a container or over ssh: what can be done with the report."""
    monkeypatch.setattr(sys, "platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(
        doctor.shutil, "which", lambda name: f"/usr/bin/{name}" if name == installed else None
    )

    assert doctor._browser().startswith(said)


def test_each_warning_is_a_line_on_stderr(capsys: pytest.CaptureFixture[str]) -> None:
    """In their order, and nothing on stdout."""
    arguments.print_warnings(["no gravity", "no current"])

    assert ("", "eccentric: warning: no gravity\neccentric: warning: no current\n") == capsys.readouterr()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (f"'{sys.executable}' -Wall", f"Python {platform.python_version()}"),
        ("no-such-compiler -O2", "none (no-such-compiler in CC is not installed)"),
    ],
    ids=["installed", "missing"],
)
def test_the_doctor_asks_the_compiler_in_cc(given: str, said: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first line of what it says of its version, here Python's; the flags beside it do not count."""
    monkeypatch.setenv("CC", given)

    assert said == doctor._compiler()
