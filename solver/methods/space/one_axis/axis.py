"""Whether a scene turns about one axis only, and how its vectors and rotations are then told by fewer numbers.

The axis is one of the section's principal axes, a_p, and stands still: n in the lab. Where it lies across the tangent
the rod stays in a plane, and the scene is its own mirror image in that plane; where it is the tangent the rod stays
straight, and the scene is its own image when turned about it by half a turn. What starts as its own image, and is
given nothing that is not, remains it. So all that is given is looked at, for all times; what is in doubt turns in
space.
"""

from __future__ import annotations

from cmath import phase
from collections.abc import Iterator
from dataclasses import dataclass
from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.kernels.rotation import matrix_of, multiply, rotate
from solver.physics.section import sample
from solver.scene.curve import Curve, Vector
from solver.scene.ends import Component, End
from solver.scene.layout import nodes_at_rest
from solver.scene.scene import Scene

Plane = NDArray[np.complex128]
"""Vectors of a plane as complex numbers."""

NONE = 1e-10
"""Angle (rad) to the plane, or to the axis, that counts as none: what Newton's iteration leaves of a rotation."""


@kernel
def directions(phi: Array) -> Plane:
    """exp(i phi) (n,), the same on every CPU, which numpy's is not."""
    found = np.empty(len(phi), np.complex128)
    for j in range(len(phi)):
        found[j] = complex(np.cos(phi[j]), np.sin(phi[j]))
    return found


@dataclass(frozen=True)
class Axis:
    """The axis a_p, p = `index`, along `n` (3,) in the lab, and the plane whose vectors are complex numbers z.

    T is the tangent at angle phi. With the axis across it, T = exp(i phi) and the plane is normal to n; with the axis
    along it, T = 1 and the plane's real axis is n. `lab`, `material` (3,): z of e1, e2, e3 and z / T of a1, a2, a3;
    `quaternion` (4,): the orientation at phi = 0; `spanning`: by the frame of an end's conditions on its translation,
    the two components that lie in the plane; where the axis is the tangent nothing happens along the second.
    """

    index: int
    n: Array
    quaternion: Array
    lab: Plane
    material: Plane
    spanning: dict[str, tuple[int, int]]

    @property
    def swing(self) -> float:
        """By how much T turns when phi does: 1, or 0 where it is the axis."""
        return float(self.index != 2)

    def in_lab(self, z: Plane) -> Array:
        """Lab vectors (..., 3) of z (...)."""
        return np.asarray((z[..., None] * self.lab.conj()).real)

    def in_material(self, z: Plane) -> Array:
        """Material vectors (..., 3) of z / T (...)."""
        return np.asarray((z[..., None] * self.material.conj()).real)

    def about(self, x: Array) -> Array:
        """Material vectors (..., 3) along the axis."""
        return np.asarray(np.multiply.outer(x, np.eye(3)[self.index]))

    def orientations(self, phi: Array) -> Array:
        """Unit quaternions (n, 4) at angles phi (n,)."""
        half_turn, turned = np.zeros(4), np.zeros(4)
        half_turn[1 + self.index] = 1.0
        multiply(self.quaternion, half_turn, turned)
        half = directions(0.5 * phi)
        return np.asarray(half.real[:, None] * self.quaternion + half.imag[:, None] * turned)


def axis_of(scene: Scene) -> Axis | None:
    """The axis about which all of a scene turns, or None."""
    if scene.contact is not None:
        return None
    s = np.linspace(0.0, scene.rod.length, 2 * scene.numerics.intervals + 1)
    _, quaternion, kappa = nodes_at_rest(scene.initial, s)
    kappa0 = sample(scene.rod, s).kappa0
    for index in range(3):
        still = rotate(quaternion, np.tile(np.eye(3)[index], (len(s), 1)))
        turns = np.arange(3) == index
        moves = turns if index == 2 else ~turns
        bends = max(np.abs(kappa0[:, ~turns]).max() * scene.rod.length, np.abs(kappa[:, ~turns]).max() * s[2])
        if np.abs(still - still[0]).max() > NONE or bends > NONE:
            continue
        if not all(_lies_in(vectors, moves) for vectors in _vectors(scene, quaternion[0], s, moment=False)):
            continue
        if not all(_lies_in(vectors, turns) for vectors in _vectors(scene, quaternion[0], s, moment=True)):
            continue
        axis = _axis(index, quaternion[0])
        if all(_keeps(end, axis, moves, turns) for end in (scene.start, scene.end)):
            return axis
    return None


def _axis(index: int, first: Array) -> Axis:
    """The axis a_index of the orientation `first`, and a plane along the lab's axes where there is one.

    Its real axis is the one nearest to the tangent, so that the force along a straight rod falls apart exactly.
    """
    R, material = np.zeros((3, 3)), np.array((0.0, -1j, 1.0) if index == 0 else (1j, 0.0, 1.0))
    matrix_of(first, R)
    n, k = R[:, index].copy(), int(np.argmax(np.abs(R[:, index])))
    turned, phi = np.zeros(4), 0.0
    if index == 2:
        lab, pair = R @ material, (k, (k + 1) % 3)
    else:
        j = int(np.argmax(np.abs(R[:, 2])))
        along = np.sign(R[j, 2]) * (np.eye(3)[j] - n[j] * n)
        along /= np.linalg.norm(along)
        lab, pair = along + 1j * np.cross(n, along), ((k + 1) % 3, (k + 2) % 3)
        phi = phase(complex(R[:, 2] @ lab))
    back = np.array([cos(0.5 * phi), 0.0, 0.0, 0.0])
    back[1 + index] = -sin(0.5 * phi)
    multiply(first, back, turned)
    return Axis(index, n, turned, lab, material, {"lab": pair, "material": (2, 1 if index == 0 else 0)})


def _lies_in(vectors: Array, allowed: NDArray[np.bool_]) -> bool:
    """Whether vectors (m, 3) have none but the allowed components."""
    return bool(np.abs(vectors[:, ~allowed]).max() <= NONE * np.abs(vectors).max())


def _vectors(scene: Scene, first: Array, s: Array, moment: bool) -> Iterator[Array]:
    """Every given velocity and force, or angular velocity and moment, (m, 3) in the axes a1, a2, a3 at the start."""
    R = np.zeros((3, 3))
    matrix_of(first, R)
    if moment:
        yield np.array([scene.initial.angular_velocity]) @ R
    else:
        yield np.array([scene.initial.velocity]) @ R
        yield np.array([scene.gravity]) @ R
        if scene.fluid is not None:
            yield np.array([scene.fluid.current]) @ R
    for load in scene.distributed:
        profiles = load.moment if moment else load.force
        yield np.stack([p(s) for p in profiles], axis=1) @ (R if load.frame == "lab" else np.eye(3))
    for point in scene.points:
        yield _at_all_times(point.moment if moment else point.force) @ (R if point.frame == "lab" else np.eye(3))


def _at_all_times(curves: Vector) -> Array:
    """Values (m, 3) of three curves at four points of each piece: a cubic that is zero there is zero."""
    knots = np.unique([0.0, *(corner for curve in curves for corner in curve.corners)])
    times = [knots, *(knots[:-1] + part * np.diff(knots) for part in (1 / 3, 2 / 3))]
    return np.stack([curve(np.concatenate(times)) for curve in curves], axis=1)


def _keeps(end: End, axis: Axis, moves: NDArray[np.bool_], turns: NDArray[np.bool_]) -> bool:
    """Whether an end asks for no motion and no load but those that are allowed."""
    if end.frame == "lab":
        along = np.abs(axis.n) > 0.5
        if np.abs(np.abs(axis.n) - along).max() > NONE:
            return False
        moves = along if axis.index == 2 else ~along
    given = [*zip(end.translation, moves, strict=True), *zip(end.rotation, turns, strict=True)]
    return all(allowed or _is_nothing(component) for component, allowed in given)


def _is_nothing(component: Component) -> bool:
    """Whether the conditions ask for rest and no load at all times."""
    def nothing(kind: str, curve: Curve) -> bool:
        return kind == "stop" or (curve.is_constant if kind == "position" else curve.is_zero)

    return all(nothing(condition.kind, condition.curve) for condition in component)
