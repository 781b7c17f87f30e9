"""How fast a push aside grows on a straight rod that is pressed or wrung: what a run that stays straight does not show.

With small rotations w (2,) of the sections across the rod, in the lab, at a state with a tension f3 and a torque q3,
the Lagrangian's second variation is

    1/2 int w'.(D w') + f3 |w|^2 - q3 (w x w')_3 ds,   D = EJ1 a1 a1 + EJ2 a2 a2,

and the rod moves across by u' = (w_2, -w_1), so that the kinetic energy is that of m |u_t|^2 / 2: a quadratic
eigenvalue problem, lambda < 0 for what grows. Loads are held as they are. With q3 = 0 it is Euler's column or, with
f3 linear in s, Greenhill's; with f3 = 0 Greenhill's shaft (Timoshenko & Gere, Theory of Elastic Stability, 2.).
"""

from __future__ import annotations

from collections.abc import Iterable
from math import sqrt

import numpy as np
from scipy.linalg import eigh, null_space

from solver.arrays import Array
from solver.scene.ends import Component
from solver.scene.scene import Scene

INTERVALS = 32
"""Into which the rod is divided."""
MUCH = 10.0
"""Logarithm of a growth, 2e4, from which on no rod is straight enough to stay so."""
HARMLESS = 1.0
"""Compression in EJ/L^2, and torque in EJ/L, that no ends let a rod buckle by."""


def can_buckle(scene: Scene) -> bool:
    """Whether what grows on a straight rod follows from its second variation: nothing turns with it, and nothing that
    is not looked at, as a floor, holds it."""
    frames = {load.frame for load in scene.points} | {load.frame for load in scene.distributed}
    turning = any(end.frame == "material" and not _held(end.rotation[:2]) and _pushes(end.translation)
                  for end in (scene.start, scene.end))  # fmt: skip
    return not (turning or "material" in frames or scene.loads)


def growth_rate(scene: Scene, s: Array, tension: Array, torque: Array, twist: Array) -> float:
    """The rate (1/s) at which a push aside grows on a straight rod, 0 if none does: by f3 (N), q3 (N m) and kappa3
    (rad/m) at arclengths `s` (n,), all (n,)."""
    length, at = float(scene.rod.length), np.linspace(0.0, scene.rod.length, INTERVALS + 1)
    EJ = np.stack([profile(at) + 0.0 * at for profile in scene.rod.stiffness[:2]], axis=1)
    tension, torque, twist = (np.interp(at, s, row) for row in (tension, torque, twist))
    if max(-tension.min() * length**2, np.abs(torque).max() * length) < HARMLESS * float(EJ.min()):
        return 0.0
    ways = _ways(scene, length, wrung=bool(torque.any()))
    K, M = _second_variation(EJ, tension, torque, twist, length), _mass(scene, at)
    lowest = eigh(ways.T @ K @ ways, ways.T @ M @ ways, eigvals_only=True, subset_by_index=[0, 0])[0]
    c = float(scene.damping)
    return max(sqrt(0.25 * c * c - min(float(lowest), 0.0)) - 0.5 * c, 0.0)


def _second_variation(EJ: Array, tension: Array, torque: Array, twist: Array, length: float) -> Array:
    """Of w_1 at the nodes, then w_2, and of the start's place, which costs nothing: (2 n + 2, 2 n + 2)."""
    n, h = len(tension), length / (len(tension) - 1)
    phi = np.append(0.0, np.cumsum(0.5 * h * (twist[1:] + twist[:-1])))
    phi, EJ, torque = (0.5 * (row[1:] + row[:-1]) for row in (phi, EJ, torque))
    rise, K = np.diff(np.eye(n), axis=0) / h, np.zeros((2 * n + 2, 2 * n + 2))
    a1, a2 = np.stack([np.cos(phi), np.sin(phi)]), np.stack([-np.sin(phi), np.cos(phi)])
    for i in range(2):
        for k in range(2):
            D = EJ[:, 0] * a1[i] * a1[k] + EJ[:, 1] * a2[i] * a2[k]
            K[i * n : i * n + n, k * n : k * n + n] = h * rise.T @ (D[:, None] * rise)
    held = tension * _weights(n, h)
    K[:n, :n] += np.diag(held)
    K[n : 2 * n, n : 2 * n] += np.diag(held)
    j = np.arange(n - 1)
    for sign, one, other in ((1.0, j, j + 1), (-1.0, j + 1, j)):  # (w x w')_3 of an interval is (w_j x w_j+1)_3 / h
        K[one, n + other] -= 0.5 * sign * torque
        K[n + other, one] -= 0.5 * sign * torque
    return K


def _mass(scene: Scene, at: Array) -> Array:
    """Of the same: that of the places across, and of intervals that turn as sticks."""
    n, h, rod = len(at), float(at[1]), scene.rod
    across = rod.mass(at) + 0.0 * at
    if scene.fluid:
        across = across + scene.fluid.density * scene.fluid.added_mass * 0.25 * np.pi * rod.diameter(at) ** 2
    weights = across * _weights(n, h)
    moved = np.hstack([_sums(n, h), np.ones((n, 1))])
    each = moved.T @ (weights[:, None] * moved)
    each[:n, :n] += np.diag(weights * h**2 / 12.0)
    M, order = np.zeros((2 * n + 2, 2 * n + 2)), [np.r_[0:n, 2 * n], np.r_[n : 2 * n, 2 * n + 1]]
    for rows in order:
        M[np.ix_(rows, rows)] = each
    return M


def _ways(scene: Scene, length: float, wrung: bool) -> Array:
    """Columns: the motions that the ends leave. One that holds something of the place is taken to hold it across; and
    of a rod that is `wrung` the tangents are taken to be held, with which a torque would turn."""
    n, h = INTERVALS + 1, length / INTERVALS
    rows = []
    for end, node in ((scene.start, 0), (scene.end, n - 1)):
        turned, moved = np.zeros(n + 1), np.append(_sums(n, h)[node], 1.0)
        turned[node] = 1.0
        rows += [turned] * (wrung or _held(end.rotation[:2])) + [moved] * _held(end.translation)
    free = null_space(np.array(rows)) if rows else np.eye(n + 1)
    ways = np.zeros((2 * n + 2, 2 * free.shape[1]))
    for i, columns in enumerate((slice(None, free.shape[1]), slice(free.shape[1], None))):
        ways[i * n : i * n + n, columns], ways[2 * n + i, columns] = free[:n], free[n]
    return ways


def _sums(n: int, h: float) -> Array:
    """The integral up to each node of what is given at the nodes (n, n)."""
    return np.cumsum(np.vstack([np.zeros(n), 0.5 * h * (np.eye(n)[1:] + np.eye(n)[:-1])]), axis=0)


def _weights(n: int, h: float) -> Array:
    weights = np.full(n, h)
    weights[[0, -1]] *= 0.5
    return weights


def _held(components: Iterable[Component]) -> bool:
    """Whether any of an end's components is not left to a load, at any time."""
    return any(condition.kind != "load" for component in components for condition in component)


def _pushes(components: Iterable[Component]) -> bool:
    """Whether an end's force is given, and not always zero."""
    return any(c.kind == "load" and not c.curve.is_zero for component in components for c in component)
