"""Rotations: unit quaternions (w, x, y, z), their matrices, and the exponential map.

A rotation R takes material components to lab ones. A rotation vector theta is material:
R(t + dt) = R(t) exp([theta]). Small rotations are material too: delta R = R [delta psi].
"""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import allocating, inlined, inner, kernel
from solver.kernels.lanes import series
from solver.kernels.scratch import scratch

Quaternion = tuple[float, float, float, float]
Entries = tuple[float, float, float, float, float, float, float, float, float]
"""Of a matrix (3, 3), row by row."""


@inlined
def cross(x: float, y: float, z: float, u: float, v: float, w: float) -> tuple[float, float, float]:
    """The cross product of two vectors."""
    return y * w - z * v, z * u - x * w, x * v - y * u


@inlined
def dot(x: float, y: float, z: float, u: float, v: float, w: float) -> float:
    """The scalar product of two vectors."""
    return x * u + y * v + z * w


@inlined
def product(a: float, b: float, c: float, d: float, w: float, x: float, y: float, z: float) -> Quaternion:
    """The product of two quaternions: first the second, then the first."""
    return (a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y, a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w)  # fmt: skip


@inlined
def entries(w: float, x: float, y: float, z: float) -> Entries:
    """The entries of the rotation matrix of a unit quaternion, row by row."""
    return (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y),
            2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
            2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))  # fmt: skip


@inlined
def turned_back(R00: float, R01: float, R02: float, R10: float, R11: float, R12: float, R20: float, R21: float,
                R22: float, x: float, y: float, z: float) -> tuple[float, float, float]:  # fmt: skip
    """R^t times a vector, from the entries of R row by row."""
    return R00 * x + R10 * y + R20 * z, R01 * x + R11 * y + R21 * z, R02 * x + R12 * y + R22 * z


@inlined
def cosine_and_sinc(square: float) -> tuple[float, float]:
    """cos(a/2) and sin(a/2)/a of a rotation by a, a^2 = `square`, by their series: exact to rounding up to 1 rad."""
    p, cosine, sinc = 0.25 * square, 1.0, 1.0
    for k in range(5, -1, -1):
        cosine = 1.0 - cosine * p * (1.0 / ((2 * k + 1.0) * (2 * k + 2.0)))
        sinc = 1.0 - sinc * p * (1.0 / ((2 * k + 2.0) * (2 * k + 3.0)))
    return cosine, 0.5 * sinc


@kernel
def any_cosine_and_sinc(square: float) -> tuple[float, float]:
    """The same for any angle but zero."""
    angle = np.sqrt(square)
    return np.cos(0.5 * angle), np.sin(0.5 * angle) / angle


@inlined
def is_beyond_a_radian(square: float) -> bool:
    """Whether the series of a rotation by a, a^2 = `square`, are not exact."""
    return square >= 1.0


series(cosine_and_sinc, is_beyond_a_radian, any_cosine_and_sinc)


@inlined
def unit(a: float, b: float, c: float, d: float) -> Quaternion:
    """The quaternion made as long as 1."""
    norm = 1.0 / np.sqrt(a * a + b * b + c * c + d * d)
    return a * norm, b * norm, c * norm, d * norm


@kernel
def matrix_of(quaternion: Array, R: Array) -> None:
    """Write the rotation matrix of a unit quaternion into `R` (3, 3)."""
    w, x, y, z = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    R[0, 0], R[0, 1], R[0, 2], R[1, 0], R[1, 1], R[1, 2], R[2, 0], R[2, 1], R[2, 2] = entries(w, x, y, z)


@kernel
def matrices_of(quaternion: Array, R: Array) -> None:
    """Write the rotation matrices of unit quaternions (n, 4) into `R` (n, 3, 3)."""
    for j in range(len(R)):
        matrix_of(quaternion[j], R[j])


def rotation_of(quaternion: Array) -> Array:
    """The rotation matrix (3, 3) of a unit quaternion (4,)."""
    R = np.empty((3, 3))
    matrix_of(quaternion, R)
    return R


@inner
def tangent_of(quaternion: Any) -> Any:
    """The tangent R a3 of a unit quaternion."""
    w, x, y, z = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    return 2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)


@kernel
def tangents_of(quaternion: Array, T: Array) -> None:
    """Write the tangents R a3 of unit quaternions (n, 4) into `T` (n, 3)."""
    for j in range(len(T)):
        T[j, 0], T[j, 1], T[j, 2] = tangent_of(quaternion[j])


@inner
def spun_between(R: Array, Q: Array) -> tuple[float, float]:
    """cos and sin of the angle by which Q (3, 3) is spun about its a3 against R, swung by the shortest way to there."""
    cosine, sine, swung = 0.0, 0.0, 1.0
    for k in range(3):
        cosine += R[k, 0] * Q[k, 0] + R[k, 1] * Q[k, 1]
        sine += R[k, 1] * Q[k, 0] - R[k, 0] * Q[k, 1]
        swung += R[k, 2] * Q[k, 2]
    whole = 1.0 / swung
    return cosine * whole, sine * whole


@kernel
def turn(quaternion: Array, theta: Array, turned: Array) -> None:
    """Write quaternion * exp(theta), normalised, into `turned` (4,)."""
    square = theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2]
    cosine, sinc = cosine_and_sinc(square) if square < 1.0 else any_cosine_and_sinc(square)
    a, b, c, d = product(quaternion[0], quaternion[1], quaternion[2], quaternion[3],
                         cosine, sinc * theta[0], sinc * theta[1], sinc * theta[2])  # fmt: skip
    turned[0], turned[1], turned[2], turned[3] = unit(a, b, c, d)


@kernel
def multiply(left: Array, right: Array, out: Array) -> None:
    """Write the quaternion left * right into `out` (4,): first `right`, then `left`."""
    out[0], out[1], out[2], out[3] = product(left[0], left[1], left[2], left[3], right[0], right[1], right[2], right[3])


@inlined
def jacobian_series(square: float) -> tuple[float, float]:
    """(1 - cos a)/a^2 and (a - sin a)/a^3 of a rotation by a, a^2 = `square`, by their series: exact to rounding up to
    1 rad."""
    first, second = 1.0, 1.0
    for k in range(7, -1, -1):
        first = 1.0 - first * square * (1.0 / ((2 * k + 3.0) * (2 * k + 4.0)))
        second = 1.0 - second * square * (1.0 / ((2 * k + 4.0) * (2 * k + 5.0)))
    return 0.5 * first, (1 / 6) * second


@kernel
def any_jacobian(square: float) -> tuple[float, float]:
    """The same for any angle but zero."""
    angle = np.sqrt(square)
    return (1.0 - np.cos(angle)) / square, (angle - np.sin(angle)) / (square * angle)


series(jacobian_series, is_beyond_a_radian, any_jacobian)


@inlined
def right_jacobian(x: float, y: float, z: float, first: float, second: float) -> Entries:
    """The entries of J_r, row by row: delta psi = J_r(theta) delta theta for theta = (x, y, z).

    J_r = I - (1 - cos a)/a^2 [theta] + (a - sin a)/a^3 [theta]^2 with a = |theta|, whose coefficients are given.
    """
    return (1.0 - second * (y * y + z * z), first * z + second * x * y, -first * y + second * x * z,
            -first * z + second * x * y, 1.0 - second * (x * x + z * z), first * x + second * y * z,
            first * y + second * x * z, -first * x + second * y * z, 1.0 - second * (x * x + y * y))  # fmt: skip


@inlined
def angle_by_sine(square: float, cosine: float) -> float:
    """The angle over sin(angle/2), from its square and cos(angle/2): 2 arctan(t) / t, t = sin / cos, by its series."""
    t, scale = square / (cosine * cosine), 0.0
    for k in range(11, -1, -1):
        scale = 1.0 / (2 * k + 1.0) - t * scale
    return scale * (2.0 / cosine)


@kernel
def any_angle_by_sine(square: float, cosine: float) -> float:
    """The same for any angle, the one below pi."""
    sine = np.sqrt(square)
    scale: float = 2.0 * np.arctan2(sine, abs(cosine)) / sine
    return -scale if cosine < 0.0 else scale


@inlined
def is_large(square: float, cosine: float) -> bool:
    """Whether `angle_by_sine` is not exact to rounding."""
    return not square < 0.04 * cosine * cosine


series(angle_by_sine, is_large, any_angle_by_sine)


@kernel
def relative_rotation(left: Array, right: Array, theta: Array) -> None:
    """Write the rotation vector of left^-1 right, shorter than pi, into `theta` (3,)."""
    cosine, x, y, z = product(left[0], -left[1], -left[2], -left[3], right[0], right[1], right[2], right[3])
    square = x * x + y * y + z * z
    scale = any_angle_by_sine(square, cosine) if is_large(square, cosine) else angle_by_sine(square, cosine)
    theta[0], theta[1], theta[2] = scale * x, scale * y, scale * z


@kernel
def relative_rotations(left: Array, right: Array, theta: Array) -> None:
    """Write the rotation vectors of left^-1 right (n, 4), shorter than pi, into `theta` (n, 3)."""
    for j in range(len(theta)):
        relative_rotation(left[j], right[j], theta[j])


def quaternion_of(R: Array) -> Array:
    """The unit quaternions (n, 4) of rotation matrices (n, 3, 3), with w >= 0 first and continuous along n.

    4 q q^T follows from the entries of R; its row with the largest diagonal is q but for its length (Shepperd 1978).
    """
    products, trace = np.empty((len(R), 4, 4)), np.trace(R, axis1=1, axis2=2)
    products[:, 0, 0] = 1.0 + trace
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        products[:, 0, i + 1] = products[:, i + 1, 0] = R[:, k, j] - R[:, j, k]
        products[:, i + 1, i + 1] = 1.0 + 2.0 * R[:, i, i] - trace
        products[:, j + 1, k + 1] = products[:, k + 1, j + 1] = R[:, j, k] + R[:, k, j]
    largest = np.argmax(np.diagonal(products, axis1=1, axis2=2), axis=1)
    quaternions: Array = products[np.arange(len(R)), largest]
    quaternions /= np.linalg.norm(quaternions, axis=1)[:, None]
    turned_over = np.sum(quaternions[1:] * quaternions[:-1], axis=1) < 0.0
    quaternions *= np.cumprod(np.where([quaternions[0, 0] < 0.0, *turned_over], -1.0, 1.0))[:, None]
    return quaternions


@allocating
def rotate(orientation: Array, vectors: Array) -> Array:
    """Material vectors (n, 3) in the lab frame, by unit quaternions (n, 4)."""
    rotated, R = np.empty_like(vectors), scratch((3, 3))
    for j in range(len(vectors)):
        matrix_of(orientation[j], R)
        for i in range(3):
            rotated[j, i] = R[i, 0] * vectors[j, 0] + R[i, 1] * vectors[j, 1] + R[i, 2] * vectors[j, 2]
    return rotated


@allocating
def rotate_back(orientation: Array, vectors: Array) -> Array:
    """Lab vectors (n, 3) in the material frame, by unit quaternions (n, 4)."""
    rotated, R = np.empty_like(vectors), scratch((3, 3))
    for j in range(len(vectors)):
        matrix_of(orientation[j], R)
        for i in range(3):
            rotated[j, i] = R[0, i] * vectors[j, 0] + R[1, i] * vectors[j, 1] + R[2, i] * vectors[j, 2]
    return rotated
