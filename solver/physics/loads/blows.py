"""Where the points of a rod come to solids, and leave them: what steps are bounded by.

`load`: a record of `solids`; places r, velocities V and accelerations A (n, 3) of points that bear `mass` (n,) per
length, each of which swings on a solid at w = sqrt(k / mass).
"""

from __future__ import annotations

from math import acos, atan2, hypot, inf, pi, sqrt
from typing import Any

from solver.arrays import Array
from solver.kernels.kernel import inner, kernel
from solver.kernels.vectors import dot, norm, vector
from solver.physics.loads.surfaces import near

LEAP = 0.5
"""Part of the way to an obstacle, or of its radius, that a node may come nearer in a step."""
STRUCK = 0.02
"""How far off Radau's quadrature is, in (w dt)^2 of the speed, where a force sets in within a step."""
SHARE = 0.3
"""Part of the rod's largest speed with which a point meets or leaves a solid in a blow."""
AT_IT, TINY = 1e-4, 1e-3
"""In 1/w: how soon a point that is as good as on the surface passes it; and rad, how soon it would leave again."""
SMALLEST = 1e-300


@kernel
def longest_step(load: Any, r: Array, V: Array) -> float:
    """The step (s) in which no node comes nearer to an obstacle by more than LEAP of its gap, or of the radius where
    that is more."""
    fastest = SMALLEST
    for k in range(len(load.radius)):
        if load.flat[k]:
            continue
        for i in range(len(r)):
            by = near(load, k, vector(r, i))
            allowed = LEAP * max(by.height, load.radius[k])
            fastest = max(fastest, -dot(by.n, vector(V, i)) / allowed)
    return 1.0 / fastest


@kernel
def missed(load: Any, r: Array, mass: Array, dt: float) -> float:
    """Twice the way that a part of the rod goes on the one side of a surface which it passes in a step, on that where
    it is less, times STRUCK (w dt)^2, at most 1; `r` (times, n, 3)."""
    largest = 0.0
    for k in range(len(load.radius)):
        for i in range(len(mass)):
            low, high = inf, -inf
            for t in range(len(r)):
                height = near(load, k, (r[t, i, 0], r[t, i, 1], r[t, i, 2])).height
                low, high = min(low, height), max(high, height)
            if low < 0.0 <= high:
                unseen = min(STRUCK * dt**2 * load.stiffness[k] / mass[i], 1.0)
                largest = max(largest, 2.0 * unseen * min(-low, high))
    return largest


@kernel
def next_blow(load: Any, r: Array, V: Array, A: Array, mass: Array, followed: float) -> float:
    """In what time (s) the first point comes to a solid, or leaves it, faster than SHARE of what is fastest: in free
    flight until then, and in a swing on the solid, of which `followed` (rad) at the most."""
    fastest, soonest = 0.0, inf
    for i in range(len(mass)):
        fastest = max(fastest, norm(vector(V, i)))
    for k in range(len(load.radius)):
        for i in range(len(mass)):
            by = near(load, k, vector(r, i))
            height, rate, bend = by.height, dot(by.n, vector(V, i)), dot(by.n, vector(A, i))
            if not abs(rate) > SHARE * fastest:
                continue
            w = sqrt(load.stiffness[k] / mass[i])
            deep = rate < 0.0 if abs(height) < AT_IT * abs(rate) / w else height < 0.0
            soonest = min(soonest, until_left(height, rate, bend, w, followed) if deep
                          else until_met(height, rate, bend))  # fmt: skip
    return soonest


@inner
def until_met(height: float, rate: float, bend: float) -> float:
    """When a point in free flight is at height 0; inf if never."""
    square = rate * rate - 2.0 * bend * height
    if square < 0.0:
        return inf
    root = sqrt(square)
    if rate < 0.0:
        time = 2.0 * height / (root - rate)
    elif bend < 0.0:
        time = (-rate - root) / bend
    else:
        return inf
    return time if time > 0.0 else inf


@inner
def until_left(height: float, rate: float, bend: float, w: float, followed: float) -> float:
    """When a point that swings about where a solid bears it is at height 0, or has `followed` that (rad); inf if it
    stays below."""
    beside, speed = -bend / w**2, rate / w
    rest, size = height - beside, hypot(beside, speed)
    if not size > abs(rest):
        return inf
    phase = (atan2(speed, beside) - acos(-rest / size)) % (2.0 * pi)
    return (followed if phase < TINY else min(phase, followed)) / w
