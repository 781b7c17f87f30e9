"""Pseudo-arclength continuation of equilibria (Keller 1977; Allgower & Georg, Numerical Continuation Methods, 6).

A point and the direction of its branch: rotations and the parameter q change along it at unit rate, in the norm

    |z|^2 = mean |psi|^2 + q^2.

A step follows the direction, bent as it was in the step before, and is corrected by Newton's iteration across it, so
that q may turn back at a fold.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.outcome import Outcome, RunFailed
from solver.statics.equations import Equations
from solver.statics.neutral import Neutral
from solver.statics.point import FORCE, PSI, Point, X
from solver.statics.stability import negative_modes

LONGEST, FIRST, SHORTEST = 0.5, 0.05, 1e-8
"""Lengths of a step: rms rotation (rad) of the sections and part of t_end."""
SHARPEST = 0.9
"""Least cosine of the angle by which a branch may turn in a step."""
KINK = 1e-4
"""Longest step in which it may turn as sharply as it likes, as where the rod comes to lie on a solid: back across the
direction that it had, even, so that only a step to a given q finds it; q goes on."""
EASY_ITERATIONS, MOST_ITERATIONS = 5, 10
TOLERANCE = 1e-10
"""Remaining correction, rotation (rad) and force relative to EJ/L^2 and to its largest, at an equilibrium."""
ROUNDING = 1e-7
"""A correction below which no smaller one need follow: rounding moves a buckle so that may lie anywhere, nearly."""
BALANCED = 1e-10
"""Unbalanced forces, relative to the largest in the rod, that are small enough once they no longer fall: a buckle turns
about a round rod for next to nothing."""
NO_LONGER = 0.3
"""Part of what it was before, above which a correction, or what is left, no longer falls."""
LARGEST_CORRECTION = 1.0
MOST_STEPS = 5000
"""Steps from one frame to the next after which a branch is given up."""
MOST_TURN = 1.0
"""By how much (rad) an end may be driven to turn in a step: whole turns are not to be seen where it ends."""
AT_ONCE = 200
"""Steps in which a branch that does not begin with what it is to let go will not begin with it."""
AHEAD = 3e-6
"""How far ahead of a corner of a schedule the branch's direction is taken."""
FIRST_CROSSING, CROSSING, PRESSED_CROSSING = 1e-6, 1e-3, 0.1
"""Longest step across which stability may change but at a fold, the first time and later: a longer one may have left
the branch for another. The first time, as where a rod buckles, it may also have passed the bend by which a small load
leads to the stable branch; and where strands press: what is wound may slide along the rod for next to no energy, which
rises and falls with every node that it passes."""
WITHOUT_END = 1e3
"""In rod lengths a unit of the branch: beside such a displacement only `SOFTEST_PLACE` stands against the loads."""
LEAST = 1e-7
"""By how much q changes at the least where the schedules begin, a unit of the branch."""
SOON, SMOOTHLY = 0.1, 1e-3
"""How far ahead loads are looked at that set in smoothly: their slope at the start is less than this part of that."""
LOOSE = 1e5
"""Rotation (rad rms) by a load of EJ/L^2, or a moment of EJ/L, with which nothing holds a rod."""
REACHED = 1e-10
STEEP = 0.005
"""Least dq at which a step may end at a given q."""


@dataclass
class Direction:
    """The branch at a point: `z` (N + 2, 9), dimensional, and `dq` a unit of arclength."""

    z: Array
    dq: float

    def __rmul__(self, x: float) -> Direction:
        return Direction(x * self.z, x * self.dq)

    def dot(self, z: Array, dq: float) -> float:
        """The inner product with a displacement."""
        return float(np.sum(self.z[:, PSI] * z[:, PSI])) / len(z) + self.dq * dq


class Path:
    """A branch, followed from stop to stop.

    `travelled`: by how much q has changed since the start, back and forth; `point` and `direction` where it is;
    `modes`: in how many directions the energy falls there; `last_dq`, `last_iterations` of the last step.
    """

    def __init__(self, equations: Equations, patience: int = MOST_STEPS) -> None:
        """`patience`: steps in which what holds the initial shape must have been let go."""
        self._equations, self._patience = equations, patience
        self.point = equations.start.moved(np.zeros((len(equations.start.quaternion), 9)), 0.0)
        self.direction = Direction(np.zeros((len(equations.start.quaternion), 9)), 1.0)
        self.steps, self.iterations, self.failed, self.last_iterations, self.modes = 0, 0, 0, 0, 0
        self._easy, self._neutral = True, Neutral(equations)
        self.begin([])

    def begin(self, corners: list[float]) -> None:
        """Go on with q from 0, from where the path is; the schedules bend at `corners`."""
        self.point.q, self.travelled, self.last_dq = 0.0, 0.0, 0.0
        self._corners, self._length, self._begun, self._idle, self._crossed = corners, FIRST, False, 0, False
        self._bend = 0.0 * self.direction
        """How the direction changes along the branch, as its last step had it."""

    def resume(self, point: Point) -> None:
        """Go on from near a point, with its q. Raises RunFailed where no equilibrium is near."""
        self._neutral.look(self._equations.linearise(point)[1])
        there = self._correct(point, None)
        if there is None:
            raise self._failure(Outcome.EQUILIBRIUM_LOST, "nothing holds the rod against its first loads")
        self.point, self.travelled, self._begun = there, there.q, False

    def advance(self, stop: float) -> bool:
        """Take one step towards where q has travelled as far as `stop`; whether it is there.

        Raises RunFailed where the branch cannot be followed.
        """
        if not self._begun:
            _, self.direction = self._at(self.point, 1.0)
            self.modes = negative_modes(self._equations)
            self._begun = True
            if not self._equations.letting_go and (self.direction.dq < LEAST or self._is_turned_as_a_whole()):
                raise self._failure(Outcome.SINGULAR_SYSTEM, "nothing holds the rod against its first loads")
        if self._left(stop) > REACHED:
            if self._idle == (self._patience if self._equations.letting_go else MOST_STEPS):
                raise self._failure(Outcome.EQUILIBRIUM_LOST, f"{MOST_STEPS} steps did not reach the next frame")
            if self._idle == AT_ONCE and self._equations.letting_go and abs(self.point.q) < REACHED:
                raise self._failure(Outcome.EQUILIBRIUM_LOST)
            self._step(self._left(stop))
            self._idle += 1
            if self.point.q < -REACHED and not self._equations.letting_go:
                raise self._failure(Outcome.PATH_TURNED_BACK)
        if self._left(stop) > REACHED:
            return False
        self.travelled, self._idle = stop, 0
        return True

    def _is_turned_as_a_whole(self) -> bool:
        """Whether the rod turns as a whole by its first loads, for nothing holds it against them."""
        if not len(self._neutral.turns):
            return False
        slope, soon = (self._equations.slope(self.point, ahead) for ahead in (AHEAD, SOON))
        if np.abs(slope).max() < SMOOTHLY * np.abs(soon).max():
            slope = soon
        _, solver = self._equations.linearise(self.point)
        turned = Direction(solver.solve(slope), 0.0)
        return bool(turned.dot(turned.z, 0.0) > (LOOSE * np.abs(slope).max()) ** 2)

    def _left(self, stop: float) -> float:
        """How far q is to travel to a stop. What holds the initial shape is let go where q is there, by any way."""
        return stop - (self.point.q if self._equations.letting_go else self.travelled)

    def _step(self, remaining: float) -> None:
        """Take one step, no farther than the next corner and `remaining` of q."""
        point, dq = self.point, self.direction.dq
        forward = 1.0 if dq > 0.0 else -1.0
        to_corner = min((forward * (c - point.q) for c in self._corners if forward * (c - point.q) > REACHED),
                        default=np.inf)  # fmt: skip
        room, wanted = min(remaining, to_corner), self._length
        limit, beyond = room / max(abs(dq), REACHED), False
        crossing = CROSSING if self._crossed else FIRST_CROSSING
        if self._equations.contact.pressing:
            crossing = PRESSED_CROSSING
        shortest = min(SHORTEST, 0.5 * limit)  # the last step may have ended right before a stop
        while min(wanted, limit) > shortest:
            length = min(wanted, limit)
            lands = abs(dq) > STEEP and (beyond or length * abs(dq) > room * (1.0 - 1e-9))
            bend = 0.5 * length**2 * self._bend
            guess = point.moved(length * self.direction.z + bend.z, forward * room if lands else length * dq + bend.dq)
            self._equations.look_ahead(point, guess)
            end, kinked = self._correct(guess, None if lands else self.direction), False
            if end is None and length < KINK:
                end, kinked = self._correct(guess, None), True
            if end is not None and self._equations.turned(point, end) > MOST_TURN:
                end = None
            if end is not None and not self._equations.refusal():
                cornered = lands and room == to_corner
                end, direction = self._at(end, forward if cornered or kinked else 0.0)
                modes = negative_modes(self._equations)
                kinked = kinked or (length < KINK and direction.dq * dq > 0.0)
                smooth = cornered or kinked or direction.dot(self.direction.z, dq) > SHARPEST
                if smooth and (modes == self.modes or direction.dq * dq < 0.0 or length < crossing):
                    swept, part = (room, 1.0) if lands else _sweep(end.q - point.q, dq, direction.dq, length, room)
                    # past where it is to stop, but not by a fold: from now on to be found there
                    beyond = part < 1.0 and abs(dq) > STEEP and direction.dq * dq > 0.0
                    if part > 0.99 and not beyond:
                        self._accept(end, direction, modes, swept, length, not (cornered or kinked))
                        # one that a stop cut short says nothing of the next; where a longer one has just failed, wait
                        grown = 2.0 * wanted if self._easy and length == wanted == self._length else wanted
                        self._length = min(LONGEST, grown)
                        return
                    limit = length * part
                    continue
            self.failed += 1
            wanted, beyond = 0.5 * length, False
        _, solver = self._equations.linearise(point)
        if solver.singular:
            raise self._failure(Outcome.SINGULAR_SYSTEM, "a pivot vanished")
        if np.abs(self.direction.z[:, X]).max() > WITHOUT_END * self._equations.units[3]:
            raise self._failure(Outcome.SINGULAR_SYSTEM, "nothing holds the rod against its loads")
        raise self._failure(Outcome.EQUILIBRIUM_LOST, "no step was short enough")

    def _accept(self, end: Point, direction: Direction, modes: int, swept: float, length: float, smooth: bool) -> None:
        per_length = 1.0 / length if smooth else 0.0
        self._bend = per_length * Direction(direction.z - self.direction.z, direction.dq - self.direction.dq)
        self.last_dq = end.q - self.point.q
        self._crossed = self._crossed or modes != self.modes
        self.point, self.direction, self.modes = end, direction, modes
        self.travelled += swept
        self.steps += 1
        self._equations.keep()

    def _correct(self, guess: Point, across: Direction | None) -> Point | None:
        """The equilibrium across a direction from a guess, or at the guess's own q; None if there is none near."""
        before = unbalanced = np.inf
        for iteration in range(1, MOST_ITERATIONS + 1):
            self.iterations += 1
            self._easy, self.last_iterations = iteration <= EASY_ITERATIONS, iteration
            left, solver = self._equations.linearise(guess)
            rest = float(np.abs(left).max())
            balanced = rest < BALANCED * self._equations.loading()
            if balanced and rest > NO_LONGER * unbalanced:
                return guess
            if solver.singular:
                return None
            z, dq = self._neutral.without(-solver.solve(left)), 0.0
            if across is not None:
                w = self._neutral.without(-solver.solve(self._equations.slope(guess, 0.0)))
                dq = -across.dot(z, 0.0) / across.dot(w, 1.0)
                z += dq * w
            size = self._size(z, guess)
            if balanced and size > before:
                return guess
            at_rest = ROUNDING > size > NO_LONGER * before
            falls = size < 2.0 * before or rest < NO_LONGER * unbalanced
            if not (at_rest or (falls and size < LARGEST_CORRECTION)) or not self._equations.keeps_apart(z):
                return None
            guess = guess.moved(z, dq)
            # Newton converges quadratically: what remains is some size^2, measured by the correction before
            quadratic = iteration > 1 and size < 0.1 * before and size * size / before < TOLERANCE
            if size < TOLERANCE or quadratic or at_rest:
                return guess
            before, unbalanced = size, rest
        return None

    def _size(self, z: Array, point: Point) -> float:
        units = self._equations.units
        force = max(units[6], float(np.abs(point.F).max()))
        return float(max(np.abs(z[:, PSI]).max(), np.abs(z[:, X]).max() / units[3], np.abs(z[:, FORCE]).max() / force))

    def _at(self, point: Point, forward: float = 0.0) -> tuple[Point, Direction]:
        """An equilibrium, turned as near to the last one as may be, and the branch's direction there: as it was, or
        right behind a corner with q going `forward` (+-1)."""
        _, solver = self._equations.linearise(point)
        self._neutral.look(solver)
        if len(self._neutral.turns):
            point = self._neutral.nearest(point, self.point)
            _, solver = self._equations.linearise(point)
        new = Direction(self._neutral.without(-solver.solve(self._equations.slope(point, forward * AHEAD))), 1.0)
        size = np.sqrt(new.dot(new.z, 1.0)) * np.sign(forward or self.direction.dot(new.z, 1.0))
        return point, Direction(new.z / size, float(1.0 / size))

    def _failure(self, outcome: Outcome, detail: str = "") -> RunFailed:
        q = self.point.q
        if self._equations.letting_go:
            return RunFailed(outcome, 0.0, self.steps, f"{100.0 * q:.3g} % of what holds the initial shape was let go")
        return RunFailed(outcome, self._equations.time(max(q, 0.0)), self.steps, detail)


def _sweep(dq: float, slope: float, end_slope: float, length: float, room: float) -> tuple[float, float]:
    """By how much q changes, back and forth, on a step; and the part of the step within which that is `room`.

    q is taken as the cubic with the values and slopes of both ends.
    """
    x = np.linspace(0.0, 1.0, 1001)
    q = x * (1 - x) ** 2 * slope * length + x**2 * (3 - 2 * x) * dq - x**2 * (1 - x) * end_slope * length
    swept = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(q)))])
    part = float(np.interp(room, swept, x)) if swept[-1] > room * (1.0 + 1e-9) else 1.0
    return float(min(swept[-1], room)), part
