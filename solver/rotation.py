"""Rotations: unit quaternions (w, x, y, z), their matrices, and the exponential map.

A rotation R takes material components to lab ones. A rotation vector theta is material:
R(t + dt) = R(t) exp([theta]). Small rotations are material too: delta R = R [delta psi].
"""

from __future__ import annotations

import numpy as np

from solver.kernel import kernel
from solver.rod import Array


@kernel
def matrix_of(quaternion: Array, R: Array) -> None:
    """Write the rotation matrix of a unit quaternion into `R` (3, 3)."""
    w, x, y, z = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    R[0, 0] = 1.0 - 2.0 * (y * y + z * z)
    R[0, 1] = 2.0 * (x * y - w * z)
    R[0, 2] = 2.0 * (x * z + w * y)
    R[1, 0] = 2.0 * (x * y + w * z)
    R[1, 1] = 1.0 - 2.0 * (x * x + z * z)
    R[1, 2] = 2.0 * (y * z - w * x)
    R[2, 0] = 2.0 * (x * z - w * y)
    R[2, 1] = 2.0 * (y * z + w * x)
    R[2, 2] = 1.0 - 2.0 * (x * x + y * y)


@kernel
def tangent_of(quaternion: Array, T: Array) -> None:
    """Write the tangent R a3 of a unit quaternion (4,) into `T` (3,)."""
    w, x, y, z = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    T[0] = 2.0 * (x * z + w * y)
    T[1] = 2.0 * (y * z - w * x)
    T[2] = 1.0 - 2.0 * (x * x + y * y)


@kernel
def tangents_of(quaternion: Array, T: Array) -> None:
    """Write the tangents R a3 of unit quaternions (n, 4) into `T` (n, 3)."""
    for j in range(len(T)):
        tangent_of(quaternion[j], T[j])


@kernel
def turn(quaternion: Array, theta: Array, turned: Array) -> None:
    """Write quaternion * exp(theta), normalised, into `turned` (4,)."""
    square = theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2]
    if square < 1.0:
        # cos(a/2) and sin(a/2)/a by their series, exact to rounding
        p = 0.25 * square
        cosine, sinc = 1.0, 1.0
        for k in range(5, -1, -1):
            cosine = 1.0 - cosine * p * (1.0 / ((2 * k + 1.0) * (2 * k + 2.0)))
            sinc = 1.0 - sinc * p * (1.0 / ((2 * k + 2.0) * (2 * k + 3.0)))
        sinc *= 0.5
    else:
        angle = np.sqrt(square)
        cosine, sinc = np.cos(0.5 * angle), np.sin(0.5 * angle) / angle
    x, y, z = sinc * theta[0], sinc * theta[1], sinc * theta[2]
    a, b, c, d = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    turned[0] = a * cosine - b * x - c * y - d * z
    turned[1] = a * x + b * cosine + c * z - d * y
    turned[2] = a * y - b * z + c * cosine + d * x
    turned[3] = a * z + b * y - c * x + d * cosine
    norm = 1.0 / np.sqrt(turned[0] ** 2 + turned[1] ** 2 + turned[2] ** 2 + turned[3] ** 2)
    for i in range(4):
        turned[i] *= norm


@kernel
def multiply(left: Array, right: Array, product: Array) -> None:
    """Write the quaternion left * right into `product` (4,): first `right`, then `left`."""
    a, b, c, d = left[0], left[1], left[2], left[3]
    w, x, y, z = right[0], right[1], right[2], right[3]
    product[0] = a * w - b * x - c * y - d * z
    product[1] = a * x + b * w + c * z - d * y
    product[2] = a * y - b * z + c * w + d * x
    product[3] = a * z + b * y - c * x + d * w


@kernel
def right_jacobian(theta: Array, scale: float, J: Array) -> None:
    """Write scale * J_r(theta) into `J` (3, 3): delta psi = J_r(theta) delta theta.

    J_r = I - (1 - cos a)/a^2 [theta] + (a - sin a)/a^3 [theta]^2 with a = |theta|.
    """
    x, y, z = theta[0], theta[1], theta[2]
    square = x * x + y * y + z * z
    if square < 1.0:
        first, second = 1.0, 1.0
        # sums over k of (-square)^k / (2 k + 2)! and / (2 k + 3)!, exact to rounding
        for k in range(7, -1, -1):
            first = 1.0 - first * square * (1.0 / ((2 * k + 3.0) * (2 * k + 4.0)))
            second = 1.0 - second * square * (1.0 / ((2 * k + 4.0) * (2 * k + 5.0)))
        first, second = 0.5 * first, (1 / 6) * second
    else:
        angle = np.sqrt(square)
        first, second = (1.0 - np.cos(angle)) / square, (angle - np.sin(angle)) / (square * angle)
    J[0, 0] = scale * (1.0 - second * (y * y + z * z))
    J[1, 1] = scale * (1.0 - second * (x * x + z * z))
    J[2, 2] = scale * (1.0 - second * (x * x + y * y))
    J[0, 1] = scale * (first * z + second * x * y)
    J[1, 0] = scale * (-first * z + second * x * y)
    J[0, 2] = scale * (-first * y + second * x * z)
    J[2, 0] = scale * (first * y + second * x * z)
    J[1, 2] = scale * (first * x + second * y * z)
    J[2, 1] = scale * (-first * x + second * y * z)


@kernel
def relative_rotation(left: Array, right: Array, theta: Array) -> None:
    """Write the rotation vector of left^-1 right, shorter than pi, into `theta` (3,)."""
    a, b, c, d = left[0], left[1], left[2], left[3]
    w, x, y, z = right[0], right[1], right[2], right[3]
    cosine = a * w + b * x + c * y + d * z
    theta[0] = a * x - b * w - c * z + d * y
    theta[1] = a * y + b * z - c * w - d * x
    theta[2] = a * z - b * y + c * x - d * w
    square = theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2]
    if square < 0.04 * cosine * cosine:
        # 2 arctan(t) / t with t = sin / cos, by its series: exact to rounding
        t, scale = square / (cosine * cosine), 0.0
        for k in range(11, -1, -1):
            scale = 1.0 / (2 * k + 1.0) - t * scale
        scale *= 2.0 / cosine
    else:
        sine = np.sqrt(square)
        scale = 2.0 * np.arctan2(sine, abs(cosine)) / sine
        if cosine < 0.0:
            scale = -scale
    for i in range(3):
        theta[i] *= scale


def quaternion_of(R: Array) -> Array:
    """The unit quaternions (n, 4) of rotation matrices (n, 3, 3), with w >= 0 first and continuous along n."""
    from scipy.spatial.transform import Rotation

    quaternions: Array = Rotation.from_matrix(R).as_quat(scalar_first=True)
    if quaternions[0, 0] < 0:
        quaternions[0] *= -1.0
    for i in range(1, len(quaternions)):
        if np.dot(quaternions[i - 1], quaternions[i]) < 0:
            quaternions[i] *= -1.0
    return quaternions


@kernel
def rotate(orientation: Array, vectors: Array) -> Array:
    """Material vectors (n, 3) in the lab frame, by unit quaternions (n, 4)."""
    rotated, R = np.empty_like(vectors), np.empty((3, 3))
    for j in range(len(vectors)):
        matrix_of(orientation[j], R)
        for i in range(3):
            rotated[j, i] = R[i, 0] * vectors[j, 0] + R[i, 1] * vectors[j, 1] + R[i, 2] * vectors[j, 2]
    return rotated


@kernel
def rotate_back(orientation: Array, vectors: Array) -> Array:
    """Lab vectors (n, 3) in the material frame, by unit quaternions (n, 4)."""
    rotated, R = np.empty_like(vectors), np.empty((3, 3))
    for j in range(len(vectors)):
        matrix_of(orientation[j], R)
        for i in range(3):
            rotated[j, i] = R[0, i] * vectors[j, 0] + R[1, i] * vectors[j, 1] + R[2, i] * vectors[j, 2]
    return rotated
