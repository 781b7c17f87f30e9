"""Vectors as laws are written in: three components in space, two in a plane, none of them an array.

A vector is a tuple of its components, a matrix a tuple of its rows. A law that is written with these functions holds
in space and in a plane; which one is meant is settled while it is compiled, and no vector is ever stored. A rotation is
a matrix (3, 3) in space; in a plane (cos, sin, swing) of the angle of the tangent, and moments are numbers: `swing` is
1, or 0 where the tangent is the axis and stands still.
"""

from __future__ import annotations

from math import sqrt
from typing import Any

import numba

from solver.arrays import Array
from solver.kernels.kernel import by_type, inner

Vector = tuple[float, float, float]
"""In space."""


@by_type
def vector(a: Any, j: int) -> Any:
    """Line j of an array as a vector: of (n, 3) in space, of complex (n,) in a plane; the number of real (n,)."""
    if a.ndim == 2:
        return lambda a, j: (a[j, 0], a[j, 1], a[j, 2])
    if a.dtype == numba.complex128:
        return lambda a, j: (a[j].real, a[j].imag)
    return lambda a, j: a[j]


@inner
def matrix(a: Array, j: int) -> Any:
    """Matrix j of an array (n, 3, 3)."""
    return ((a[j, 0, 0], a[j, 0, 1], a[j, 0, 2]), (a[j, 1, 0], a[j, 1, 1], a[j, 1, 2]),
            (a[j, 2, 0], a[j, 2, 1], a[j, 2, 2]))  # fmt: skip


@by_type
def dot(a: Any, b: Any) -> Any:
    """The inner product."""
    if isinstance(a, numba.types.Float):
        return lambda a, b: a * b
    if len(a) == 2:
        return lambda a, b: a[0] * b[0] + a[1] * b[1]
    return lambda a, b: a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inner
def vector_product(a: Any, b: Any) -> Any:
    """a x b, in space."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inner
def norm(a: Any) -> float:
    """The length of a vector."""
    return sqrt(dot(a, a))


@by_type
def plus(a: Any, b: Any) -> Any:
    """a + b."""
    if isinstance(a, numba.types.Float):
        return lambda a, b: a + b
    if len(a) == 2:
        return lambda a, b: (a[0] + b[0], a[1] + b[1])
    return lambda a, b: (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@by_type
def minus(a: Any, b: Any) -> Any:
    """a - b."""
    if isinstance(a, numba.types.Float):
        return lambda a, b: a - b
    if len(a) == 2:
        return lambda a, b: (a[0] - b[0], a[1] - b[1])
    return lambda a, b: (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@inner
def times(factor: float, a: Any) -> Any:
    """A vector times a number."""
    if len(a) == 2:
        return factor * a[0], factor * a[1]
    return factor * a[0], factor * a[1], factor * a[2]


@by_type
def middle(a: Any, b: Any) -> Any:
    """The mean of two vectors; None of None."""
    if isinstance(a, numba.types.NoneType):
        return lambda a, b: None
    return lambda a, b: times(0.5, plus(a, b))


@by_type
def without(a: Any, b: Any) -> Any:
    """a - b, or a where b is None."""
    if isinstance(b, numba.types.NoneType):
        return lambda a, b: a
    return lambda a, b: minus(a, b)


@by_type
def stiffness(a: Any, j: int) -> Any:
    """Matrix j of an array (n, 3, 3); the number of (n,) about one axis."""
    if a.ndim == 1:
        return lambda a, j: a[j]
    return lambda a, j: matrix(a, j)


@by_type
def transform(A: Any, x: Any) -> Any:
    """A x, of a matrix or of a number."""
    if isinstance(A, numba.types.Float):
        return lambda A, x: A * x
    return lambda A, x: (dot(A[0], x), dot(A[1], x), dot(A[2], x))


@by_type
def times_each(a: Any, b: Any) -> Any:
    """The products of the components: diag(a) b; of two numbers their product."""
    if isinstance(a, numba.types.Float):
        return lambda a, b: a * b
    return lambda a, b: (a[0] * b[0], a[1] * b[1], a[2] * b[2])


@by_type
def diagonal(a: Any) -> Any:
    """The matrix diag(a); a number stays one."""
    if isinstance(a, numba.types.Float):
        return lambda a: a
    return lambda a: ((a[0], 0.0, 0.0), (0.0, a[1], 0.0), (0.0, 0.0, a[2]))


@inner
def outer(a: Any, b: Any) -> Any:
    """The matrix a b^t."""
    if len(a) == 2:
        return times(a[0], b), times(a[1], b)
    return times(a[0], b), times(a[1], b), times(a[2], b)


@inner
def identity(factor: float, a: Any) -> Any:
    """The identity of the space of `a`, times a number."""
    if len(a) == 2:
        return (factor, 0.0), (0.0, factor)
    return (factor, 0.0, 0.0), (0.0, factor, 0.0), (0.0, 0.0, factor)


@inner
def add(A: Any, B: Any) -> Any:
    """A + B, of matrices."""
    if len(A) == 2:
        return plus(A[0], B[0]), plus(A[1], B[1])
    return plus(A[0], B[0]), plus(A[1], B[1]), plus(A[2], B[2])


@inner
def scale(factor: float, A: Any) -> Any:
    """A matrix times a number."""
    if len(A) == 2:
        return times(factor, A[0]), times(factor, A[1])
    return times(factor, A[0]), times(factor, A[1]), times(factor, A[2])


@by_type
def in_lab(R: Any, x: Any) -> Any:
    """R x: a material vector in the lab frame."""
    if len(x) == 2:
        return lambda R, x: (R[0] * x[0] - R[1] * x[1], R[1] * x[0] + R[0] * x[1])
    return lambda R, x: (dot(R[0], x), dot(R[1], x), dot(R[2], x))


@by_type
def tangent_rate(R: Any, omega: Any) -> Any:
    """T_t = R (omega x a3)."""
    if isinstance(omega, numba.types.Float):
        return lambda R, omega: (-R[2] * omega * R[1], R[2] * omega * R[0])
    return lambda R, omega: (R[0][0] * omega[1] - R[0][1] * omega[0], R[1][0] * omega[1] - R[1][1] * omega[0],
                             R[2][0] * omega[1] - R[2][1] * omega[0])  # fmt: skip


@inner
def tangent_acceleration(R: Any, omega: Any, alpha: Any) -> Any:
    """T_tt = R (alpha x a3 + omega x (omega x a3)), in space."""
    return in_lab(R, (alpha[1] + omega[0] * omega[2], omega[1] * omega[2] - alpha[0],
                      -omega[0] * omega[0] - omega[1] * omega[1]))  # fmt: skip


@by_type
def in_lab_by_rotation(R: Any, x: Any) -> Any:
    """d(R x) / d psi for dR = R [d psi]: the matrix -R [x] in space, the vector of an angle in a plane."""
    if len(x) == 2:
        return lambda R, x: (-R[2] * (R[1] * x[0] + R[0] * x[1]), R[2] * (R[0] * x[0] - R[1] * x[1]))
    return lambda R, x: (_by_rotation(R[0], x), _by_rotation(R[1], x), _by_rotation(R[2], x))


@inner
def _by_rotation(row: Any, x: Any) -> Any:
    """A row of -R [x]."""
    return row[2] * x[1] - row[1] * x[2], row[0] * x[2] - row[2] * x[0], row[1] * x[0] - row[0] * x[1]


@by_type
def in_material(R: Any, x: Any) -> Any:
    """R^t x: a lab vector in the material frame; the moment about a plane's normal is the same in both."""
    if isinstance(x, numba.types.Float):
        return lambda R, x: x
    return lambda R, x: (R[0][0] * x[0] + R[1][0] * x[1] + R[2][0] * x[2],
                         R[0][1] * x[0] + R[1][1] * x[1] + R[2][1] * x[2],
                         R[0][2] * x[0] + R[1][2] * x[1] + R[2][2] * x[2])  # fmt: skip


@by_type
def in_material_by_rotation(y: Any) -> Any:
    """d(R^t x) / d psi for y = R^t x: the matrix [y]; nothing in a plane."""
    if isinstance(y, numba.types.Float):
        return lambda y: 0.0
    return lambda y: ((0.0, -y[2], y[1]), (y[2], 0.0, -y[0]), (-y[1], y[0], 0.0))


@by_type
def lever(a: Any, R: Any) -> Any:
    """a dT / d psi, dT = R (d psi x a3): the material moment T x a; that about a plane's normal."""
    if len(a) == 2:
        return lambda a, R: R[2] * (a[1] * R[0] - a[0] * R[1])
    return lambda a, R: (-(a[0] * R[0][1] + a[1] * R[1][1] + a[2] * R[2][1]),
                         a[0] * R[0][0] + a[1] * R[1][0] + a[2] * R[2][0], 0.0)  # fmt: skip


@by_type
def lever_by_rotation(a: Any, R: Any) -> Any:
    """d(a3 x R^t a) / d psi: a matrix in space, a number in a plane."""
    if len(a) == 2:
        return lambda a, R: -(a[0] * R[0] + a[1] * R[1])
    return lambda a, R: lever_turned(in_material(R, a))


@inner
def lever_turned(g: Any) -> Any:
    """The matrix that takes psi to a3 x (g x psi) = g psi_3 - g_3 psi, in space."""
    return (-g[2], 0.0, g[0]), (0.0, -g[2], g[1]), (0.0, 0.0, 0.0)


@by_type
def tangent_by_rotation(G: Any, R: Any) -> Any:
    """G dT / d psi: what a derivative G by the tangent says of a rotation; None of None."""
    if isinstance(G, numba.types.NoneType):
        return lambda G, R: None
    if len(G) == 2:
        return lambda G, R: (lever(G[0], R), lever(G[1], R))
    return lambda G, R: (lever(G[0], R), lever(G[1], R), lever(G[2], R))


@inner
def add_vector(factor: float, x: Any, out: Array) -> None:
    """Add factor x to `out` (3,), in a plane (2,), but nothing of None."""
    if x is not None:
        out[0] += factor * x[0]
        out[1] += factor * x[1]
        if len(x) == 3:
            out[2] += factor * x[2]


@inner
def add_matrix(factor: float, A: Any, out: Array) -> None:
    """Add factor A to `out` (3, 3), in a plane (2, 2), but nothing of None."""
    if A is not None:
        add_vector(factor, A[0], out[0])
        add_vector(factor, A[1], out[1])
        if len(A) == 3:
            add_vector(factor, A[2], out[2])


@inner
def subtract_product(A: Any, B: Array, out: Array) -> None:
    """Subtract A B from `out` (3, 3), but nothing of None."""
    if A is not None:
        _subtract_row(A[0], B, out[0])
        _subtract_row(A[1], B, out[1])
        _subtract_row(A[2], B, out[2])


@inner
def _subtract_row(a: Any, B: Array, out: Array) -> None:
    for k in range(3):
        out[k] -= a[0] * B[0, k] + a[1] * B[1, k] + a[2] * B[2, k]
