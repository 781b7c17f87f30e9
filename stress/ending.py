"""How a run ended, as the stress test counts it."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any


class Ending(StrEnum):
    """Every way in which a run of a stress test can end. `FAILURES` must not happen."""

    CORRECT = "correct"
    NAMED = "named outcome"
    OUT_OF_BUDGET = "out of budget"
    """Still at it, and right so far, when its steps or CPU seconds were spent: as a job, its limit ends it by name.
    (What it has lost of its energy the solver judges at the end.)"""
    LOST_ENERGY = "lost energy"
    MADE_ENERGY = "made energy"
    STRETCHED = "stretched"
    TURNS_LOST = "turns lost"
    OUT_OF_BALANCE = "out of balance"
    CROSSED = "crossed silently"
    NOT_FINITE = "not finite"
    EXCEPTION = "exception"
    CRASH = "crash"
    HANG = "hang"


GOOD = (Ending.CORRECT, Ending.NAMED, Ending.OUT_OF_BUDGET)
FAILURES = tuple(ending for ending in Ending if ending not in GOOD)


@dataclass(frozen=True)
class Task:
    """One run: a shipped case or a raw one, with settings by dotted key, and its budget.

    `group`: the sweep, map or draw that it belongs to; `at`: where in it.
    """

    group: str
    at: tuple[Any, ...]
    case: dict[str, Any]
    steps: int = 2000
    cpu: float = 30.0


@dataclass(frozen=True)
class Result:
    """What became of a run.

    `balance`: energy balance over turnover, the worst of its frames, with its sign (made is positive); `stretch`: worst
    relative change of an interval's length beyond what its curvature explains; `turns`: worst |Tw + Wr - Lk|, where the
    ends do not swing; `error`: distance from the reference over the rod's length, NaN without one; `r`: the centreline
    at eleven places, at `t` (s); `case`: of a failure, to run it again.
    """

    group: str
    at: tuple[Any, ...]
    ending: Ending
    outcome: str = ""
    detail: str = ""
    t: float = 0.0
    steps: int = 0
    failed: int = 0
    cpu: float = 0.0
    balance: float = 0.0
    stretch: float = 0.0
    turns: float = 0.0
    error: float = float("nan")
    r: list[list[float]] = field(default_factory=list)
    case: dict[str, Any] | None = None
