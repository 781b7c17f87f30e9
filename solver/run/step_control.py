"""How long the next step may be: the tightest of what each reason allows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import ceil, inf

SMALLEST_STEP = 2.0**-22
"""In dt_max: a step below it is given up."""
GROWTH = 1.5
FIRST_STEP = 2.0**-4
"""In dt_max: the step after the start and after each switch of an end condition."""
CONSISTENT_STEPS = (2.0**-14, 2.0**-18, 2.0**-22, 2.0**-10, 2.0**-6, 2.0**-2)
"""In dt_max: steps that find consistent accelerations and forces at the start. The shorter ones are tried where a rod
is let go with a stress that its ends do not bear; the longer ones where a shape violates its end conditions, so that a
boundary layer has to form within the first interval."""


class StepControl:
    """Chooses steps that end exactly on every corner and on every output time that they may not pass."""

    def __init__(self, dt_max: float, tolerance: float, order: float, easy: int, shortest: float,
                 corners: Iterable[float], outputs: Sequence[float], strides: int = 1) -> None:  # fmt: skip
        """`strides`: how many dt_max a step may last, and how many outputs it may pass; `tolerance`: relative increment
        aimed at; `order`: power of the step with which it falls; `easy`: iterations of an easy step."""
        self._exponent, self._easy = 1.0 / order, easy
        self._dt_max, self._longest, self._tolerance = dt_max, strides * dt_max, tolerance
        self._first = max(dt_max * FIRST_STEP, shortest)
        self.smallest = max(dt_max * SMALLEST_STEP, shortest)
        """The step (s) below which the run is given up."""
        self._wanted = self._first
        self._events = sorted({*corners, *outputs[strides - 1 :: strides], *outputs[-1:]})
        self._next = 0
        self._near = max(1e-9 * min([dt_max, *outputs]), 1e-15 * max(outputs, default=0.0))

    def reached(self, event: float, t: float) -> bool:
        """Whether an event's time has come at t: a corner and an output of the same time may differ by rounding."""
        return event <= t + self._near

    def step_from(self, t: float, limit: float, blow: float = inf) -> tuple[float, float]:
        """The next step from t, and where it ends: equal steps up to the next event, each at most `limit`; or, if that
        is sooner, one that ends with a `blow`."""
        while self._next < len(self._events) and self.reached(self._events[self._next], t):
            self._next += 1
        wanted = min(self._wanted, self._longest, limit)
        blow = max(blow, self.smallest)
        if blow < wanted and (self._next == len(self._events) or t + blow < self._events[self._next] - self._near):
            return blow, t + blow
        if self._next == len(self._events):
            return wanted, t + wanted
        event = self._events[self._next]
        count = ceil((event - t) / wanted - 1e-6)
        dt = (event - t) / max(count, 1)
        return dt, event if count <= 1 else t + dt

    def accepted(self, dt: float, relative_increment: float, iterations: int) -> None:
        """Learn from a step: its error relative to its motion, and Newton's iterations."""
        taken = max(dt, 0.5 * self._wanted)
        # growth starts from the step that was wanted: from one that was cut to end on a frame it would never double
        grown = GROWTH * (self._wanted if 2.0 * dt >= self._wanted else taken)
        longest = grown if iterations <= self._easy else (taken if iterations <= self._easy + 3 else 0.7 * taken)
        if relative_increment > 0.0:
            accurate = 0.9 * dt * (self._tolerance / relative_increment) ** self._exponent
            longest = min(longest, max(0.5 * taken, accurate))
        self._wanted = min(self._longest, longest)

    @property
    def stuck(self) -> bool:
        """Whether accuracy asks for steps below the smallest: at that pace a run would not end."""
        return self._wanted < self._dt_max * SMALLEST_STEP

    def too_coarse(self, relative_increment: float) -> bool:
        """Whether a step's error is so large that it must be taken again."""
        return relative_increment > 4.0 * self._tolerance

    def rejected(self, dt: float) -> None:
        """Halve the step."""
        self._wanted = 0.5 * dt

    def restart(self) -> None:
        """Begin small again, after the conditions have jumped."""
        self._wanted = min(self._wanted, self._first)
