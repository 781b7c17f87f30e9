"""An end in time: which conditions hold in a step, and their values."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.scene.ends import Component, Condition, End

RATE, LOAD, RATE_LAB, LOAD_LAB = 0, 1, 2, 3
"""Kinds of a condition on a translation component; a rotation component is RATE or LOAD."""
ABOUT_A3 = 5
"""Of the six components the rotation about the rod itself."""

Kinds = NDArray[np.int64]


def _smoothstep(x: float) -> float:
    x = min(max(x, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)


class DrivenEnd:
    """The six conditions of one end, followed through the run.

    Motion that is prescribed as a function of time is also followed as an integral: what the time scheme has
    accumulated is compared with the exact displacement or rotation, and the difference is fed back. So the
    relative rotation of the ends is the prescribed one, however coarse the steps.
    """

    def __init__(self, end: End) -> None:
        self._components = (*end.translation, *end.rotation)
        self.in_lab = end.frame == "lab"
        """Whether the translation's components are along e1, e2, e3."""
        self._active = [0] * 6
        self._stopping_from = [0.0] * 6
        self.travel = np.zeros(6)
        """Displacement along (m) and rotation about (rad) each axis since t = 0, as integrated."""
        self._travel_at_switch = np.zeros(6)
        self.kinds = np.zeros(6, np.int64)
        self._set_kinds()

    def corners(self) -> list[float]:
        """Times to which steps must be aligned."""
        times: list[float] = []
        for component in self._components:
            for condition in component:
                times += [condition.since, *condition.curve.corners]
                if condition.kind == "stop":
                    times.append(condition.since + condition.within)
        return times

    def jolts(self) -> list[float]:
        """Times at which the end's rate may jump: a rod that cannot stretch loses energy there, as in a collision."""
        times: list[float] = []
        for component in self._components:
            for condition in component:
                curve, start = condition.curve, condition.since
                times += [start] if start > 0.0 or (condition.kind == "rate" and curve.value(start) != 0.0) else []
                times += curve.corners if condition.kind in ("rate", "position") else ()
        return times

    def follow(self, moved: Array) -> None:
        """Add a step's displacement along, and rotation about, the axes (6,)."""
        self.travel += moved

    def switch(self, t: float, rates: Array) -> None:
        """Put in force the conditions that hold from `t` on; `rates` (6,): the end's velocity and omega now."""
        for i, component in enumerate(self._components):
            while self._active[i] + 1 < len(component) and component[self._active[i] + 1].since <= t:
                self._active[i] += 1
                self._stopping_from[i] = float(rates[i])
                self._travel_at_switch[i] = self.travel[i]
        self._set_kinds()

    def values(self, t: float, later: Sequence[float], gain: float) -> Array:
        """The six values (times, 6) at the times t + dt of a step from t, `later` being these dt."""
        values = np.empty((len(later), 6))
        values[:] = gain * self._held * (self._travel_at_switch - self.travel)
        for i in self._moving:
            values[:, i] = self._values_of(i, t, later, gain)
        return values

    @property
    def driven(self) -> bool:
        """Whether any motion is given now."""
        return bool(self._prescribed)

    def correction(self, t: float, dt: float, rates: Array, left_out: float, length: float) -> tuple[Array, float]:
        """What is to be added (6,) to the rates that are given at the end of a step from t, for the end, which has
        `rates` (6,) now, to be where it must; and the largest rotation (rad), or displacement in rod lengths, that it
        is still behind.

        It moves by the mean of both rates; `left_out`: see `Scheme`. Of what that would leave it behind by, less half
        of what the step leaves out, for the correction acts in the next step too.
        """
        extra, still = self._held * ((self._travel_at_switch - self.travel) / dt - 0.5 * rates), 0.0
        for i in self._prescribed:
            condition = self._condition(i)
            begin, end = _rate(condition, t + 2e-9 * dt, dt), _rate(condition, t + dt, dt)
            now, then = travel(condition, t), travel(condition, t + dt)
            uneven = left_out * ((then - now) / dt - 0.5 * (begin + end))
            behind = (now - self._travelled(i)) / dt + uneven - 0.5 * float(rates[i] - begin)
            extra[i] = behind + 0.5 * uneven
            still = max(still, dt * abs(0.5 * behind - 0.25 * uneven) / (length if i < 3 else 1.0))
        return extra, still

    def prescribed(self, component: int, t: float) -> float | None:
        """The exact displacement (m) along, or rotation (rad) about, an axis since t = 0, if it has been prescribed all
        along; `component`: 0 to 2 of the translation, 3 to 5 of the rotation."""
        conditions = self._components[component]
        so_far = [conditions[0], *(condition for condition in conditions[1:] if condition.since < t)]
        known = all(condition.kind in ("rate", "position") for condition in so_far)
        return travelled(conditions, t) if known else None

    def _set_kinds(self) -> None:
        self._held = np.zeros(6)
        """1 for components that are held where they are. Free ones are worth nothing."""
        self._moving: list[int] = []
        self._prescribed: list[int] = []
        """Numbers of the components whose motion is given."""
        for i, component in enumerate(self._components):
            condition = component[self._active[i]]
            load = condition.kind == "load"
            if condition.kind == "stop" or not condition.curve.is_zero:
                self._moving.append(i)
                self._prescribed += [i] if condition.kind in ("rate", "position") else []
            else:
                self._held[i] = float(not load)
            if i < 3 and self.in_lab:
                self.kinds[i] = LOAD_LAB if load else RATE_LAB
            else:
                self.kinds[i] = LOAD if load else RATE

    def _values_of(self, i: int, t: float, later: Sequence[float], gain: float) -> list[float]:
        condition = self._condition(i)
        if condition.kind == "load":
            return [condition.curve.value(t + dt) for dt in later]
        if condition.kind == "stop":
            speed, since, within = self._stopping_from[i], condition.since, condition.within
            return [speed * (1.0 - _smoothstep((t + dt - since) / within)) for dt in later]
        # how far the end, as it is now, is from where it must be (m or rad)
        behind = travel(condition, t) - self._travelled(i) if gain else 0.0
        return [_rate(condition, t + dt, dt) + gain * behind for dt in later]

    def _condition(self, i: int) -> Condition:
        """What is in force now of a component."""
        return self._components[i][self._active[i]]

    def _travelled(self, i: int) -> float:
        """The displacement (m) or rotation (rad) of a component since what is in force now came into force."""
        return float(self.travel[i] - self._travel_at_switch[i])


def _rate(condition: Condition, t: float, dt: float) -> float:
    """The rate at the end t of a step; at a corner the one before it."""
    if condition.kind == "rate":
        return condition.curve.value(t)
    return condition.curve.derivative(t - 1e-9 * dt)


def travel(condition: Condition, t: float) -> float:
    """The exact displacement or rotation from the time the condition came into force to t."""
    if condition.kind == "rate":
        return condition.curve.integral(t) - condition.curve.integral(condition.since)
    return condition.curve.value(t) - condition.curve.value(condition.since)


def travelled(component: Component, t: float) -> float:
    """The exact displacement or rotation from t = 0 to t, as far as the component's conditions prescribe it."""
    total, ends = 0.0, [*(condition.since for condition in component[1:]), inf]
    for condition, until in zip(component, ends, strict=True):
        if condition.kind in ("rate", "position"):
            total += travel(condition, min(max(t, condition.since), until))
    return total
