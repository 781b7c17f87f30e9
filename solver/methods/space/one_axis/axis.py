"""The axis about which a scene turns, if it turns about one only, and its vectors and rotations by fewer numbers."""

from __future__ import annotations

from cmath import phase
from dataclasses import dataclass
from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.kernels.kernel import allocating
from solver.kernels.rotation import multiply, rotation_of
from solver.scene.layout import nodes_at_rest
from solver.scene.scene import Scene
from solver.scene.view import View

Plane = NDArray[np.complex128]
"""Vectors of a plane as complex numbers."""


@allocating
def directions(phi: Array) -> Plane:
    """exp(i phi) (n,), the same on every CPU, which numpy's is not."""
    units = np.empty(len(phi), np.complex128)
    for j in range(len(phi)):
        units[j] = complex(np.cos(phi[j]), np.sin(phi[j]))
    return units


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

    def six_components(self, in_lab: bool) -> Array:
        """What real and imaginary part of z, or of z / T, and a rotation about the axis are (3, 6) along the three axes
        of the lab, or of the material, and about those of the material."""
        z, rotation = self.lab if in_lab else self.material, np.eye(3)[self.index]
        return np.block([[z.real, np.zeros(3)], [z.imag, np.zeros(3)], [np.zeros(3), rotation]])


def axis_of(scene: Scene) -> Axis | None:
    """The axis about which all of a scene turns, or None: see `scene.view`."""
    s = np.linspace(0.0, scene.rod.length, 2 * scene.numerics.intervals + 1)
    _, quaternion, kappa = nodes_at_rest(scene.initial, s)
    views = (View(index, s, quaternion, kappa, rotation_of(quaternion[0])) for index in range(3))
    return next((_axis(view.index, quaternion[0]) for view in views if scene.keeps(view)), None)


def _axis(index: int, first: Array) -> Axis:
    """The axis a_index of the orientation `first`, and a plane along the lab's axes where there is one.

    Its real axis is the one nearest to the tangent, so that the force along a straight rod falls apart exactly.
    """
    R, material = rotation_of(first), np.array((0.0, -1j, 1.0) if index == 0 else (1j, 0.0, 1.0))
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
