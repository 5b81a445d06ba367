"""A log of the diagnosis benchmark, and its result."""

from __future__ import annotations

from dataclasses import dataclass, field

from benchmarks.oracle import Oracle


@dataclass(frozen=True)
class Job:
    """One log to diagnose."""

    kind: str
    seed: int
    effects: tuple[tuple[str, float], ...]
    outside: str | None = None
    minutes: float = 1.0
    drive: str = "fine"


@dataclass
class Result:
    """The result of one job."""

    job: Job
    verdict: str = "failed"
    truth: list[str] = field(default_factory=list)
    beyond: list[float] = field(default_factory=list)
    ranked: list[str] = field(default_factory=list)
    named: list[str] = field(default_factory=list)
    shared: bool = False  # a true effect was named by a name that covers it
    depends: list[str] = field(default_factory=list)
    probability: float = 0.0
    rmse: dict[str, float] = field(default_factory=dict)  # balance -> held out, of what is shipped
    oracle: Oracle | None = None
    peer: dict | None = None
    seconds: float = 0.0
    memory: float = 0.0
    note: str = ""
