"""Signals that end a run: exceptions, so that it cleans up, and held back while files are moved."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

# SIGINT last: `held` gives the handlers back in this order, and that of SIGINT is the one that raises most.
_SIGNALS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP", "SIGINT") if hasattr(signal, name))


CLEANING_S = 10.0
"""After an interrupt, others are ignored for so long: they would end the cleaning, not the run sooner."""


class Ended(KeyboardInterrupt):
    """A signal asks the run to end. It is an interrupt, so that nothing mistakes it for an error.

    Attributes:
        number: of the signal.
    """

    def __init__(self, number: int) -> None:
        super().__init__(signal.Signals(number).name)
        self.number = number


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Let SIGTERM and SIGHUP raise `Ended` in the main thread, in this block, and SIGINT its exception once.

    One that is ignored (nohup) or handled by somebody else stays so. Does nothing in other threads.
    """
    quiet = [n for n in _SIGNALS if signal.getsignal(n) is signal.SIG_DFL and n != signal.SIGINT]
    before: list[tuple[int, Callable[..., Any] | int]] = [(n, signal.SIG_DFL) for n in quiet]
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        before.append((signal.SIGINT, signal.default_int_handler))
    before = before if _is_main() else []
    try:
        for number, _ in before:
            signal.signal(number, _once() if number == signal.SIGINT else _end)
        yield
    finally:
        _give_back(before)


@contextmanager
def held() -> Iterator[None]:
    """Let signals that would raise in this thread wait until the end of the block.

    Handlers are replaced instead of masking the signals: another thread may receive them, and its handler
    runs in the main thread all the same.
    """
    came: list[int] = []

    def wait(number: int, _: object) -> None:
        came.append(number)

    handlers = [(number, signal.getsignal(number)) for number in _SIGNALS] if _is_main() else []
    before = [(number, handler) for number, handler in handlers if callable(handler)]
    try:
        for number, _ in before:
            signal.signal(number, wait)
        yield
    finally:
        _give_back(before)
        for number in dict.fromkeys(came):
            signal.raise_signal(number)


def _end(number: int, _: object) -> None:
    raise Ended(number)


def _once() -> Callable[[int, object], None]:
    """A handler that raises KeyboardInterrupt, but not again while what it ended cleans up."""
    last = -CLEANING_S

    def interrupt(_number: int, _frame: object) -> None:
        nonlocal last
        if (now := time.monotonic()) - last >= CLEANING_S:
            last = now
            raise KeyboardInterrupt

    return interrupt


def _is_main() -> bool:
    return threading.current_thread() is threading.main_thread()


def _give_back(before: Sequence[tuple[int, Callable[..., Any] | int]]) -> None:
    """Restore the handlers, all of them even if one that is restored raises at once."""
    if before:
        (number, handler), *rest = before
        try:
            signal.signal(number, handler)
        finally:
            _give_back(rest)
