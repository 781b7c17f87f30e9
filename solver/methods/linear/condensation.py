"""Block elimination of the box scheme's system, O(N): the production solve.

Each interval has six rows carried from the left and twelve of its own. In the lab frame (3) and (4) are differences,
Delta V and Delta F, and the system's scales make their coefficients 1:

    V_j = V_j+1 + A omega_j + A' omega_j+1 - b3,   F_j = F_j+1 + P V_j + P' V_j+1 + B omega_j + B' omega_j+1 - b4.

With these V_j and F_j are eliminated from the carried rows and from (5), without a search for a pivot. omega_j and
kappa_j are eliminated with row pivoting from the carried rows, (2) and (5); the six rows that remain are carried on.
That is half the arithmetic and half the searches of eliminating all twelve with row pivoting (de Boor & Weiss 1980,
SOLVEBLOK; Diaz, Fairweather & Keast 1983, COLROW). The six columns of omega_j and kappa_j are factored first; the
twelve of node j + 1 follow all at once, column beside column, which the compiler makes vectors of.

The pivots of V and F are not the largest of their columns, but the multipliers stay small enough:
`validation/linear_solve.py` measures the backward error.
"""

from __future__ import annotations

from solver.arrays import Array
from solver.kernels.kernel import inlined, inlined_late, inner
from solver.methods.linear.panels import Swaps
from solver.methods.space.box.fields import KAPPA, OMEGA, F, V

LOCAL = 6
"""Unknowns of a node that are eliminated with pivoting: omega and kappa."""
LARGEST_MULTIPLIERS = 16.0
"""Sum of the multipliers of a row that is eliminated with pivots that were not searched for."""
COMPATIBILITY, EXTENSION, TRANSLATION, ROTATION = 0, 3, 6, 9
"""First row of (2), (3), (4) and (5) among an interval's own."""
NEXT = 12
"""First column of node j + 1 in an interval's panel."""
WIDTH = 16
"""Its twelve columns and four empty ones: whole vectors."""
V_OMEGA, V_NEXT_OMEGA, F_V, F_NEXT_V, F_OMEGA, F_NEXT_OMEGA = 0, 1, 2, 3, 4, 5
"""Blocks of `swept`: A, A', P, P + P', B + P A and B' + P A'."""


@inlined
def sweep(panel: Array, swept: Array) -> None:
    """Write the blocks (6, 3, 3) by which V_j, once eliminated, and F_j depend on the other unknowns."""
    for i in range(3):
        for k in range(3):
            swept[V_OMEGA, i, k] = panel[EXTENSION + i, OMEGA + k]
            swept[V_NEXT_OMEGA, i, k] = panel[EXTENSION + i, NEXT + OMEGA + k]
            swept[F_V, i, k] = panel[TRANSLATION + i, V + k]
            swept[F_NEXT_V, i, k] = panel[TRANSLATION + i, V + k] + panel[TRANSLATION + i, NEXT + V + k]
    for i in range(3):
        x, y, z = panel[TRANSLATION + i, V], panel[TRANSLATION + i, V + 1], panel[TRANSLATION + i, V + 2]
        for k in range(3):
            swept[F_OMEGA, i, k] = (panel[TRANSLATION + i, OMEGA + k] + x * panel[EXTENSION, OMEGA + k]
                                    + y * panel[EXTENSION + 1, OMEGA + k]
                                    + z * panel[EXTENSION + 2, OMEGA + k])  # fmt: skip
            swept[F_NEXT_OMEGA, i, k] = (panel[TRANSLATION + i, NEXT + OMEGA + k]
                                         + x * panel[EXTENSION, NEXT + OMEGA + k]
                                         + y * panel[EXTENSION + 1, NEXT + OMEGA + k]
                                         + z * panel[EXTENSION + 2, NEXT + OMEGA + k])  # fmt: skip


@inlined
def condense(carried: Array, panel: Array, swept: Array, left: Array, right: Array) -> None:
    """Write the carried rows, (2) and (5) without V_j and F_j.

    `left` (12, 6): columns of omega_j and kappa_j; `right` (12, WIDTH): those of node j + 1.
    """
    for i in range(6):
        u, v, w = carried[i, V], carried[i, V + 1], carried[i, V + 2]
        x, y, z = carried[i, F], carried[i, F + 1], carried[i, F + 2]
        for k in range(3):
            left[i, k] = (carried[i, OMEGA + k]
                          + u * swept[V_OMEGA, 0, k] + v * swept[V_OMEGA, 1, k] + w * swept[V_OMEGA, 2, k]
                          + x * swept[F_OMEGA, 0, k] + y * swept[F_OMEGA, 1, k] + z * swept[F_OMEGA, 2, k])  # fmt: skip
            left[i, 3 + k] = carried[i, KAPPA + k]
            right[i, V + k] = (carried[i, V + k]
                               + x * swept[F_NEXT_V, 0, k] + y * swept[F_NEXT_V, 1, k]
                               + z * swept[F_NEXT_V, 2, k])  # fmt: skip
            right[i, OMEGA + k] = (
                u * swept[V_NEXT_OMEGA, 0, k] + v * swept[V_NEXT_OMEGA, 1, k] + w * swept[V_NEXT_OMEGA, 2, k]
                + x * swept[F_NEXT_OMEGA, 0, k] + y * swept[F_NEXT_OMEGA, 1, k]
                + z * swept[F_NEXT_OMEGA, 2, k])  # fmt: skip
            right[i, KAPPA + k] = 0.0
            right[i, F + k] = carried[i, F + k]
    for i in range(3):
        x, y, z = panel[ROTATION + i, F], panel[ROTATION + i, F + 1], panel[ROTATION + i, F + 2]
        for k in range(LOCAL):
            left[6 + i, k] = panel[COMPATIBILITY + i, OMEGA + k]
            left[9 + i, k] = panel[ROTATION + i, OMEGA + k]
        for k in range(12):
            right[6 + i, k] = panel[COMPATIBILITY + i, NEXT + k]
            right[9 + i, k] = panel[ROTATION + i, NEXT + k]
        for k in range(3):
            left[9 + i, k] += x * swept[F_OMEGA, 0, k] + y * swept[F_OMEGA, 1, k] + z * swept[F_OMEGA, 2, k]
            right[9 + i, V + k] += x * swept[F_NEXT_V, 0, k] + y * swept[F_NEXT_V, 1, k] + z * swept[F_NEXT_V, 2, k]
            right[9 + i, OMEGA + k] += (x * swept[F_NEXT_OMEGA, 0, k] + y * swept[F_NEXT_OMEGA, 1, k]
                                        + z * swept[F_NEXT_OMEGA, 2, k])  # fmt: skip
            right[9 + i, F + k] += panel[ROTATION + i, F + k]


@inlined
def keep_multipliers(carried: Array, panel: Array, by_swept: Array) -> None:
    """Write by how much V_j and F_j stood in the carried rows, and F_j in (5), into `by_swept` (9, 6)."""
    for k in range(3):
        for i in range(6):
            by_swept[i, k], by_swept[i, 3 + k] = carried[i, V + k], carried[i, F + k]
        for i in range(3):
            by_swept[6 + i, 3 + k] = panel[ROTATION + i, F + k]


@inlined
def factor_as_before(left: Array, swaps: Swaps, inverse: Array) -> bool:
    """Factor `left` (12, 6) in place with the row exchanges of the interval before; False if these do not suit it.

    Row by row, without a loop over columns: each row stays in registers. `inverse` (6,) is scratch.
    """
    for k in range(LOCAL):
        pivot = swaps[k]
        for c in range(LOCAL):
            left[k, c], left[pivot, c] = left[pivot, c], left[k, c]
    suits = _eliminate_row(0, 0, left, inverse)
    suits &= _eliminate_row(1, 1, left, inverse)
    suits &= _eliminate_row(2, 2, left, inverse)
    suits &= _eliminate_row(3, 3, left, inverse)
    suits &= _eliminate_row(4, 4, left, inverse)
    suits &= _eliminate_row(5, 5, left, inverse)
    for i in range(LOCAL, 12):
        suits &= _eliminate_row(i, LOCAL, left, inverse)
    return suits


@inlined_late
def _eliminate_row(i: int, pivots: int, left: Array, inverse: Array) -> bool:
    """Eliminate the first `pivots` entries of row i; False if a multiplier is large. Row i < 6 is the next pivot's."""
    x0, x1, x2, x3, x4, x5 = left[i, 0], left[i, 1], left[i, 2], left[i, 3], left[i, 4], left[i, 5]
    multipliers = 0.0
    if pivots > 0:
        x0 *= inverse[0]
        x1, x2, x3, x4, x5 = (x1 - x0 * left[0, 1], x2 - x0 * left[0, 2], x3 - x0 * left[0, 3],
                              x4 - x0 * left[0, 4], x5 - x0 * left[0, 5])  # fmt: skip
        multipliers = abs(x0)
    if pivots > 1:
        x1 *= inverse[1]
        x2, x3, x4, x5 = x2 - x1 * left[1, 2], x3 - x1 * left[1, 3], x4 - x1 * left[1, 4], x5 - x1 * left[1, 5]
        multipliers += abs(x1)
    if pivots > 2:
        x2 *= inverse[2]
        x3, x4, x5 = x3 - x2 * left[2, 3], x4 - x2 * left[2, 4], x5 - x2 * left[2, 5]
        multipliers += abs(x2)
    if pivots > 3:
        x3 *= inverse[3]
        x4, x5 = x4 - x3 * left[3, 4], x5 - x3 * left[3, 5]
        multipliers += abs(x3)
    if pivots > 4:
        x4 *= inverse[4]
        x5 -= x4 * left[4, 5]
        multipliers += abs(x4)
    if pivots > 5:
        x5 *= inverse[5]
        multipliers += abs(x5)
    left[i, 0], left[i, 1], left[i, 2], left[i, 3], left[i, 4], left[i, 5] = x0, x1, x2, x3, x4, x5
    if i < LOCAL:
        inverse[i] = 1.0 / left[i, i]
    return multipliers < LARGEST_MULTIPLIERS


@inner
def factor_anew(left: Array, swaps: Swaps) -> bool:
    """Factor `left` (12, 6) in place with row pivoting; `swaps` (6,) says where each pivot came from."""
    for k in range(LOCAL):
        pivot, largest = k, abs(left[k, k])
        for i in range(k + 1, 12):
            entry = abs(left[i, k])
            if entry > largest:
                pivot, largest = i, entry
        if not largest > 0.0:
            return False
        swaps[k] = pivot
        for c in range(LOCAL):
            left[k, c], left[pivot, c] = left[pivot, c], left[k, c]
        inverse = 1.0 / left[k, k]
        for i in range(k + 1, 12):
            multiplier = left[i, k] * inverse
            left[i, k] = multiplier
            for c in range(k + 1, LOCAL):
                left[i, c] -= multiplier * left[k, c]
    return True


@inlined
def eliminate_right(L: Array, swaps: Swaps, right: Array, upper: Array, carried: Array) -> None:
    """Do to the rows `right` (12, WIDTH) what the factors L (12, 6) of the columns to their left say.

    Writes the pivots' rows into `upper` (6 WIDTH,) and the others into `carried` (6, WIDTH); `right` is left with its
    rows exchanged. (In place the compiler would not make vectors of it.)
    """
    for k in range(LOCAL):
        pivot = swaps[k]
        for c in range(WIDTH if pivot != k else 0):
            right[k, c], right[pivot, c] = right[pivot, c], right[k, c]
    for c in range(WIDTH):
        x0 = right[0, c]
        x1 = right[1, c] - L[1, 0] * x0
        x2 = right[2, c] - L[2, 0] * x0 - L[2, 1] * x1
        x3 = right[3, c] - L[3, 0] * x0 - L[3, 1] * x1 - L[3, 2] * x2
        x4 = right[4, c] - L[4, 0] * x0 - L[4, 1] * x1 - L[4, 2] * x2 - L[4, 3] * x3
        x5 = right[5, c] - L[5, 0] * x0 - L[5, 1] * x1 - L[5, 2] * x2 - L[5, 3] * x3 - L[5, 4] * x4
        upper[c], upper[WIDTH + c], upper[2 * WIDTH + c] = x0, x1, x2
        upper[3 * WIDTH + c], upper[4 * WIDTH + c], upper[5 * WIDTH + c] = x3, x4, x5
        carried[0, c] = right[6, c] - _product(L, 6, x0, x1, x2, x3, x4, x5)
        carried[1, c] = right[7, c] - _product(L, 7, x0, x1, x2, x3, x4, x5)
        carried[2, c] = right[8, c] - _product(L, 8, x0, x1, x2, x3, x4, x5)
        carried[3, c] = right[9, c] - _product(L, 9, x0, x1, x2, x3, x4, x5)
        carried[4, c] = right[10, c] - _product(L, 10, x0, x1, x2, x3, x4, x5)
        carried[5, c] = right[11, c] - _product(L, 11, x0, x1, x2, x3, x4, x5)


@inlined_late
def _product(L: Array, i: int, x0: float, x1: float, x2: float, x3: float, x4: float, x5: float) -> float:
    """Row i of L times x."""
    return float(L[i, 0] * x0 + L[i, 1] * x1 + L[i, 2] * x2 + (L[i, 3] * x3 + L[i, 4] * x4 + L[i, 5] * x5))


@inlined
def forward(carried: Array, b: Array, swept: Array, by_swept: Array, L: Array, swaps: Array, y: Array,
            local: Array) -> None:  # fmt: skip
    """What was done to the rows, done to their right-hand sides `carried` (6,) and `b` (12,).

    Writes those of (3), (4) and of the pivots into `y` (12,), and those to be carried on into `carried`; `local`
    (12,) is scratch.
    """
    y0, y1, y2 = -b[EXTENSION], -b[EXTENSION + 1], -b[EXTENSION + 2]
    y[0], y[1], y[2] = y0, y1, y2
    for i in range(3):
        y[3 + i] = swept[F_V, i, 0] * y0 + swept[F_V, i, 1] * y1 + swept[F_V, i, 2] * y2 - b[TRANSLATION + i]
    y3, y4, y5 = y[3], y[4], y[5]
    for i in range(6):
        local[i] = (carried[i] - (by_swept[i, 0] * y0 + by_swept[i, 1] * y1 + by_swept[i, 2] * y2)
                    - (by_swept[i, 3] * y3 + by_swept[i, 4] * y4 + by_swept[i, 5] * y5))  # fmt: skip
    for i in range(3):
        local[6 + i] = b[COMPATIBILITY + i]
        local[9 + i] = b[ROTATION + i] - (by_swept[6 + i, 3] * y3 + by_swept[6 + i, 4] * y4 + by_swept[6 + i, 5] * y5)
    for k in range(LOCAL):
        pivot = swaps[k]
        local[k], local[pivot] = local[pivot], local[k]
    x0 = local[0]
    x1 = local[1] - L[6] * x0
    x2 = local[2] - L[12] * x0 - L[13] * x1
    x3 = local[3] - L[18] * x0 - L[19] * x1 - L[20] * x2
    x4 = local[4] - L[24] * x0 - L[25] * x1 - L[26] * x2 - L[27] * x3
    x5 = local[5] - L[30] * x0 - L[31] * x1 - L[32] * x2 - L[33] * x3 - L[34] * x4
    y[6], y[7], y[8], y[9], y[10], y[11] = x0, x1, x2, x3, x4, x5
    for i in range(6):
        carried[i] = (local[6 + i] - (L[36 + 6 * i] * x0 + L[37 + 6 * i] * x1 + L[38 + 6 * i] * x2)
                      - (L[39 + 6 * i] * x3 + L[40 + 6 * i] * x4 + L[41 + 6 * i] * x5))  # fmt: skip


@inlined
def backward(y: Array, swept: Array, lower: Array, upper: Array, right: Array, x: Array) -> None:
    """Write the unknowns `x` (12,) of node j from those of node j + 1, `right` (12,)."""
    for i in range(LOCAL):
        total = y[6 + i]
        for k in range(12):
            total -= upper[WIDTH * i + k] * right[k]
        x[OMEGA + i] = total
    for i in range(LOCAL - 1, -1, -1):
        total = x[OMEGA + i]
        for k in range(i + 1, LOCAL):
            total -= lower[LOCAL * i + k] * x[OMEGA + k]
        x[OMEGA + i] = total / lower[LOCAL * i + i]
    for i in range(3):
        velocity, force = right[V + i] + y[i], right[F + i] + y[3 + i]
        for k in range(3):
            velocity += swept[V_OMEGA, i, k] * x[OMEGA + k] + swept[V_NEXT_OMEGA, i, k] * right[OMEGA + k]
            force += swept[F_NEXT_V, i, k] * right[V + k]
            force += swept[F_OMEGA, i, k] * x[OMEGA + k] + swept[F_NEXT_OMEGA, i, k] * right[OMEGA + k]
        x[V + i], x[F + i] = velocity, force
