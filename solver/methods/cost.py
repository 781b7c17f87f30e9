"""How long a method's steps take, by which runs to a tolerance count what they have spent.

Time that is measured would be another each time, and so would the resolutions that are tried: the same case is to give
the same bits on every machine. The figures are about those of one core of an EPYC, fitted to some 450 attempts at
a hundred scenes: they are right to a factor of 1.25 in the mean, of 1.5 where strands press on each other.
"""

from __future__ import annotations

from typing import NamedTuple

POINT = 0.4
"""Microseconds that each point of self-contact adds to a step in which it is looked where it is."""
ROUGH = 1.3
"""Microseconds that each iteration after a step's second takes more for each interval where loads may set in all of a
sudden: tangents are renewed."""
PRESSED, BESIDES = 0.5, 60
"""Microseconds that an iteration takes more for each interval, and for so many besides, where strands press on each
other."""
PAIR, BESIDES_PAIR = 0.0017, 280
"""Those that each pair of points that does adds for each interval, and for so many besides: of many, more directions
have to be searched."""


class Cost(NamedTuple):
    """Microseconds: of a `step`, and for each interval in a step (`interval`) and in a Newton iteration (`iteration`).
    """

    step: float
    interval: float
    iteration: float

    def of(self, intervals: int, steps: int, iterations: int, placed: int, pressing: int, rough: bool = False) -> float:
        """Of some steps (us); `iterations`: of all of them; `placed`: how many points of contact are looked at;
        `pressing`: how many pairs of them press on each other; `rough`: whether loads may set in all of a sudden."""
        renewed = ROUGH * intervals * max(iterations - 2 * steps, 0) if rough else 0.0
        each = self.step + self.interval * intervals + POINT * placed
        pairs = PAIR * pressing * (intervals + BESIDES_PAIR)
        pressed = PRESSED * (intervals + BESIDES) + pairs if pressing else 0.0
        return steps * each + iterations * (self.iteration * intervals + pressed) + renewed


ABOUT_AXIS, IN_SPACE, STRETCHED = Cost(105.0, 0.43, 0.14), Cost(140.0, 2.4, 0.32), Cost(230.0, 1.05, 1.05)
"""Of segments about one axis, in space, and of those that a law of stretch joins."""
