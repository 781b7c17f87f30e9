"""One run of one solver at one resolution, and what it cost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import nan
from time import process_time

BOX, STAGGERED, STATICS, PAPER = "box", "staggered", "statics", "paper (box, shooting)"
DEFAULT = "default mode"
METHODS = (BOX, STAGGERED, STATICS, DEFAULT, PAPER)
"""hockle's; the default one chooses its resolution by a tolerance, and the last is there to be compared with."""
PYELASTICA, MUJOCO = "PyElastica", "MuJoCo cable"
AS_IT_COMES = ", clamp as it comes"
"""Ending of a peer's name where its clamp is left half an element inside the rod."""

CHEAP, REPEATS = 2.0, 3
"""A run below so many CPU seconds is repeated, and the cheapest kept."""
LONGEST = 120.0
"""CPU seconds: a peer's run that would take longer is skipped, and said to be."""


class Skipped(Exception):
    """A run that was not made, and why."""


@dataclass(frozen=True)
class Measured:
    """Process CPU time (s), the error of a quantity, and the number whose agreement between methods is judged."""

    cpu: float
    error: float
    value: float


@dataclass(frozen=True)
class Run:
    """`solver` at `resolution` on `scene`; `go` solves it once and measures each quantity that the scene asks for."""

    scene: str
    solver: str
    resolution: str
    go: Callable[[], dict[str, Measured]]


@dataclass(frozen=True)
class Point:
    """A point of the figure, or the reason why there is none."""

    scene: str
    quantity: str
    solver: str
    resolution: str
    cpu: float = nan
    error: float = nan
    value: float = nan
    missing: str = ""


def cheapest(go: Callable[[], dict[str, Measured]]) -> dict[str, Measured]:
    """The cheapest of a few repetitions; a costly run is made once."""
    repeats = [go()]
    while max(m.cpu for m in repeats[0].values()) < CHEAP and len(repeats) < REPEATS:
        repeats.append(go())
    return {name: min((measured[name] for measured in repeats), key=lambda m: m.cpu) for name in repeats[0]}


class Stopwatch:
    """Process CPU time (s) since it was made."""

    def __init__(self) -> None:
        self._started = process_time()

    def read(self) -> float:
        """CPU seconds so far."""
        return process_time() - self._started


def refuse_if_long(seconds_a_step: float, steps: int) -> None:
    """Raise `Skipped` if so many steps would take longer than `LONGEST`."""
    cost = seconds_a_step * steps
    if cost > LONGEST:
        raise Skipped(f"would take {cost:.0f} CPU s ({steps} steps)")
