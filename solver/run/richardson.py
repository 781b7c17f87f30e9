"""What runs on several meshes say together: the extrapolated solution, and an estimate of its error.

Both methods are of order 2 along s: with k times the intervals the error of the mesh falls to 1/k^2 of what it was.
All arrays are (frames, nodes, columns), a column being a component of an output; a number is a column with one node.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solver.arrays import Array

WARY = 2.0
"""By how much the error of two meshes is taken larger: nothing shows yet that the order is 2."""
AGREEMENT = 0.6
"""Part of what order 2 would make the differences of successive meshes fall by, from which on it is believed."""
CLEAN = 0.1
"""How far from what order 2 has it the differences may fall for order 2 to show without doubt."""
LEFT, LEFT_IF_CLEAN = 1.0 / 3.0, 2.0 / 15.0
"""Part of the change from one extrapolated solution to the next that is left: as order 2 would leave it; and twice what
order 4 would, where order 2 shows in the meshes. Three such errors are more than the third."""
DAMPED = 2.5
"""How many times the difference of two meshes the error is, where viscosity damps the motion: see `unextrapolated`."""
LEAST, LEAST_IF_CLEAN = 0.02, 0.005
"""Part of the finest mesh's own error that the extrapolated one is never told to be below; and where order 2 shows."""

ORDER, HARDLY, MOST_ALIKE = 4.0, 1.5, 30.0
"""Power of the number of steps with which their error is taken to fall; how much more than 1 that of shorter ones is,
for their difference to be taken as it is; and how many times the difference the error may be, at the most."""


def extrapolate(meshes: Sequence[Array], ratios: Sequence[int]) -> tuple[Array, Array]:
    """The solution and its error at the nodes of the finest of up to three meshes, which come coarsest first.

    `ratios`: how many times finer each mesh is than the one before it. Of one, nothing tells the error: NaN. Of two, u1
    and u2: u2 + (u2 - u1) / (k^2 - 1), and as its error that correction, taken `WARY`. Of three, the difference of the
    two such solutions tells their error; a part of it is taken, see `LEFT`. Where a column's differences do not fall as
    order 2 has it, nothing is extrapolated, and the error is what a series of such differences would leave.
    """
    fine = meshes[-1]
    nodes, steps = fine.shape[1], [k if fine.shape[1] > 1 else 1 for k in ratios]
    if not ratios:
        return fine, np.full_like(fine, np.nan)
    apart = [finer[:, ::step] - coarser for coarser, finer, step in zip(meshes, meshes[1:], steps, strict=False)]
    corrections = [difference / (k**2 - 1.0) for difference, k in zip(apart, ratios, strict=True)]
    last = corrections[-1]
    spread = _spread(last, nodes)
    correction = np.where(np.isnan(spread), 0.0, spread)
    if len(meshes) == 2:
        return fine + correction, nowhere_small(WARY * np.abs(last), nodes)
    far = apart[1][:, :: steps[0]]
    fall = _rms(apart[0]) / np.maximum(_rms(far), 1e-300)
    believed = fall >= AGREEMENT * ratios[1] ** 2
    change = far + last[:, :: steps[0]] - corrections[0]
    clean = np.abs(fall / ratios[1] ** 2 - 1.0) <= CLEAN
    settled = np.maximum(np.where(clean, LEFT_IF_CLEAN, LEFT) * np.abs(change),
                         np.where(clean, LEAST_IF_CLEAN, LEAST) * np.abs(last[:, :: steps[0]]))  # fmt: skip
    left = np.clip(1.0 / np.maximum(fall - 1.0, 1e-3), 1.0 / (ratios[1] ** 2 - 1.0), 1.0)
    errors = nowhere_small(settled, nodes), nowhere_small(left * np.abs(apart[1]), nodes)
    return fine + np.where(believed, correction, 0.0), np.where(believed, *errors)


def unextrapolated(meshes: Sequence[Array], ratios: Sequence[int]) -> tuple[Array, Array]:
    """The same of meshes on which an artificial viscosity damps the motion: its waves do not converge as a power of h,
    so the solution is that of the finest, and in error by `DAMPED` times what it differs from the one before."""
    fine = meshes[-1]
    if not ratios:
        return fine, np.full_like(fine, np.nan)
    step = ratios[-1] if fine.shape[1] > 1 else 1
    return fine, nowhere_small(DAMPED * np.abs(fine[:, ::step] - meshes[-2]), fine.shape[1])


def error_of_steps(series: Sequence[Array], shorter: bool, nodes: int) -> Array:
    """The error, at `nodes` nodes, of one of two or three runs on one mesh, which come with the longest steps first.

    Of the last, or, if there is one with `shorter` steps than the run in question, of the last but one. The error is
    in proportion to a step's tolerance, a quarter from one to the next, where three show it; of two a third of their
    difference, taken `WARY`.
    """
    apart = np.abs(series[-1] - series[-2])
    if shorter:
        return nowhere_small(apart, nodes)
    if len(series) < 3:
        return nowhere_small(WARY / 3.0 * apart, nodes)
    fall = _rms(series[-2] - series[-3]) / np.maximum(_rms(apart), 1e-300)
    return nowhere_small(np.clip(1.0 / np.maximum(fall - 1.0, 1e-3), 1.0 / 3.0, 1.0) * apart, nodes)


def alike(before: float, work: float) -> float:
    """By how much the error of steps is more than their difference says, where steps that might be shorter hardly are:
    something else keeps both short. `work`: of the shorter ones, and of those `before`."""
    more: float = max(work / max(before, 1.0), 1.0) ** ORDER - 1.0
    return min(max(HARDLY / max(more, HARDLY / MOST_ALIKE), 1.0), MOST_ALIKE)


def nowhere_small(error: Array, nodes: int) -> Array:
    """An error at `nodes` nodes, nowhere less than its column's rms: where two solutions cross, they say nothing."""
    error = np.maximum(error, _rms(error))
    many = error.shape[1]
    if many == nodes:
        return error
    between = (nodes - 1) // (many - 1)
    spread = _at_nodes(error, nodes, between)
    for k in range(1, between):
        part = k / between
        spread[:, k::between] = (1.0 - part) * error[:, :-1] + part * error[:, 1:]
    return spread


def _spread(values: Array, nodes: int) -> Array:
    """Values of a smooth function of s at more nodes, by the cubic through the four nearest."""
    many = values.shape[1]
    if many == nodes:
        return values
    between = (nodes - 1) // (many - 1)
    spread = _at_nodes(values, nodes, between)
    for k in range(1, between):
        part = k / between
        new = spread[:, k::between]
        new[:, 1:-1] = _cubic(1.0 + part, values[:, :-3], values[:, 1:-2], values[:, 2:-1], values[:, 3:])
        new[:, 0] = _cubic(part, *np.moveaxis(values[:, :4], 1, 0))
        new[:, -1] = _cubic(2.0 + part, *np.moveaxis(values[:, -4:], 1, 0))
    return spread


def _at_nodes(values: Array, nodes: int, between: int) -> Array:
    """An array for values at `nodes`, which holds those that there are: at each that is a multiple of `between`."""
    spread = np.empty((len(values), nodes, values.shape[2]))
    spread[:, ::between] = values
    return spread


def _cubic(x: float, a: Array, b: Array, c: Array, d: Array) -> Array:
    """The cubic through a, b, c, d at 0, 1, 2, 3, at x."""
    p, q, r, s = x, x - 1.0, x - 2.0, x - 3.0
    return -q * r * s / 6.0 * a + 0.5 * p * r * s * b - 0.5 * p * q * s * c + p * q * r / 6.0 * d


def _rms(values: Array) -> Array:
    return np.asarray(np.sqrt(np.mean(values**2, axis=1, keepdims=True)))
