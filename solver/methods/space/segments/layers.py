"""The curvature of a taut rod at its ends and where it is kinked, which changes within less than an interval.

There, as in a wire at its clamp, kappa = (theta / lambda) exp(-s / lambda), lambda = sqrt(EJ / T), by the angle theta
between the end and the force there, along which the rod goes off (of large ones, 2 sin(theta / 2) instead: the
elastica). A chain with intervals h longer than that shows all of theta in its first joint, 2 theta / h, which says how
fine the mesh is. The same chain solved in closed form, x = h / lambda, tells what its joints show of such a layer: the
rotations of its segments differ from that far away by psi_j, with

    psi_j+1 - 2 psi_j + psi_j-1 = x^2 psi_j,   psi_j+1 = rho psi_j,   psi_1 = 2 theta / (x^2 + 3 - rho).

What is missing at each node is of order h^2 where the mesh resolves the layer.

A force P in a point kinks the rod by theta = 2 asin(P / 2T), half of it on each side; if it acts on segment
m, the part a of an interval behind its first joint, the layers before and behind it are on this mesh as high as if they
were those of p theta and (1 - p) theta, p = (1 - rho + x^2 (1 - a)) / (2 (1 - rho) + x^2).

At an end that may turn, a pin or a free one under tension, the moment is given, and far from there the loads bend the
rod: kappa = K - b exp(-s / lambda), where the mesh has K - b rho^k at node k. Where K is linear beside the end, the
first three nodes tell b = (2 kappa_1 - kappa_2 - kappa_0) / (1 - rho)^2, and b (rho^k - exp(-x k)) is missing.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import asin, atan2, hypot, pi, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.kernels.rotation import rotate_back, rotation_of
from solver.measures.frame import Fields
from solver.physics.elasticity import Coupling, Stretch, TwistStretch, Viscosity
from solver.physics.loads.given import points_within
from solver.scene.loads import PointLoad
from solver.scene.scene import Scene

LINEAR = (Coupling, Stretch, TwistStretch, Viscosity)
"""Laws with which bending stays proportional to curvature."""
RESOLVED = 0.05
"""Of h / lambda: below it nothing is missing that rounding would not blur."""
WIDE = 24
"""Nodes of a layer on one side that are completed."""
SECOND = 2
"""Node of an end layer up to which it is looked at."""
ALIKE = 0.5
"""Force at an end, by that at its second joint, from which on it is taken to be the same in a layer."""


class Layer(NamedTuple):
    """What may be one: `nodes` that are completed, and where they lie in it (intervals); where the tension is taken
    (`taut`), and EJ (2,) in N m^2 about a1 and a2; of a kink its load, which acts the part `a` of an interval behind
    the joint before it."""

    nodes: NDArray[np.int64]
    at: NDArray[np.int64]
    taut: list[int]
    EJ: Array
    load: PointLoad | None
    a: float

    @classmethod
    def at_end(cls, end: int, last: int, EJ: Array) -> Layer:
        """At the end `end` of a rod with nodes up to `last`."""
        at = np.arange(min(WIDE, (last + 1) // 2))
        return cls(np.abs(end - at), at, [abs(end - 1)], EJ, None, 0.0)

    @classmethod
    def kink(cls, load: PointLoad, place: float, last: int, EJ: Array) -> Layer:
        """Where a load acts, `place` intervals from the start."""
        i = int(place)
        at = np.arange(max(1 - WIDE, -i), min(WIDE, last - i) + 1)
        return cls(i + at, at, [i - 1, i + 2], EJ, load, place - i)

    def part(self, angles: Array) -> Array:
        """Half of the angle by which the rod turns in it on one side, of angles (n, 2)."""
        return (0.5 if self.load is None else 0.25) * np.minimum(np.hypot(angles[:, 0], angles[:, 1]), pi)

    def shown(self, x: float) -> tuple[Array, Array]:
        """h kappa over theta at its nodes, on the mesh and in truth."""
        rho = _decay(x)
        if self.load is None:
            psi = 2.0 / (x * x + 3.0 - rho)
            mesh = np.append(2.0 * (1.0 - psi), psi * (1.0 - rho) * rho ** self.at[:-1])
            return mesh, x * np.exp(-x * self.at)
        p = self._before(x, rho)
        mesh = (1.0 - rho) * np.where(self.at <= 0, p, 1.0 - p) * rho ** np.where(self.at <= 0, -self.at, self.at - 1)
        return mesh, 0.5 * x * np.exp(-x * np.abs(self.at - self.a))

    def missing(self, x: float, part: float) -> float:
        """By how much its bending energy is more than on the mesh, in EJ theta^2 / h; `part` as above.

        What the first joint beside it leaves of the angle bends as an elastica on the mesh too.
        """
        rho = _decay(x)
        beyond = 0.5 * (1.0 - rho) / (1.0 + rho)
        if self.load is None:
            left = 2.0 / (x * x + 3.0 - rho)
            on_mesh, true = (1.0 - left) ** 2 + beyond * left**2, 0.25 * x
        else:
            left, p = rho, self._before(x, rho)
            on_mesh, true = beyond * (p**2 + (1.0 - p) ** 2), 0.125 * x
        full, rest = _elastica(0.5 * part * np.array([1.0, left])) ** 2
        return float(true * full - on_mesh * rest)

    def _before(self, x: float, rho: float) -> float:
        """p of a kink."""
        return (1.0 - rho + x * x * (1.0 - self.a)) / (2.0 * (1.0 - rho) + x * x)


class Layers(NamedTuple):
    """Those of a rod with intervals `h` (m), of which the first two are the ends'; none of a rod whose moment is not
    proportional to its curvature."""

    h: float
    layers: list[Layer]

    @classmethod
    def of(cls, scene: Scene, s: Array) -> Layers:
        """Those of a scene on nodes at `s` (n,)."""
        rod, h, last = scene.rod, float(s[1] - s[0]), len(s) - 1
        if last <= 2 * SECOND or not all(isinstance(law, LINEAR) for law in rod.laws):
            return cls(h, [])

        def stiffness(place: float) -> Array:
            return np.array([float(profile(np.array([place]))[0]) for profile in rod.stiffness[:2]])

        layers = [Layer.at_end(end, last, stiffness(float(s[end]))) for end in (0, last)]
        return cls(h, layers + [
            Layer.kink(load, load.s / h, last, stiffness(load.s))
            for load in points_within(scene) if load.pulls and SECOND <= int(load.s / h) < last - SECOND
        ])  # fmt: skip

    def complete(self, fields: Fields, held: Sequence[NDArray[np.bool_]], t: float) -> float:
        """Add what is missing to kappa at time t; `held`: whether each end is held about a1 and a2. Returns by how much
        the bending energy of the layers (J) is more than the mesh shows of it.

        q stays: it is what is in the balances of this mesh.
        """
        about, missing = [*held, *[np.ones(2, dtype=bool)] * len(self.layers)], np.zeros_like(fields.kappa)
        energy = 0.0
        for layer, turned in zip(self.layers, about, strict=False):
            T = sum(float(fields.f[i, 2]) for i in layer.taut) / len(layer.taut)
            if T * self.h**2 <= RESOLVED**2 * layer.EJ.min():
                continue
            x = self.h * np.sqrt(T / layer.EJ)
            lacking = turned & (x > RESOLVED)
            if layer.load is None:
                missing[layer.nodes, :2] += self._at_hinge(fields, layer, x, ~turned & (x > RESOLVED))
            if lacking.any():
                theta = _off_end(fields, layer) if layer.load is None else _kink(fields, layer, layer.load, T, t)
                if not theta.any():
                    continue
                turned_back = rotate_back(fields.orientation[layer.nodes], np.tile(theta, (len(layer.at), 1)))
                angles = np.where(lacking, turned_back[:, :2], 0.0)
                shape = _elastica(layer.part(angles))
                for k in np.flatnonzero(lacking):
                    mesh, true = layer.shown(float(x[k]))
                    missing[layer.nodes, k] += shape * angles[:, k] * (true - mesh) / self.h
                    stored = layer.missing(float(x[k]), float(layer.part(angles[:1])[0]))
                    energy += float(layer.EJ[k] * angles[0, k] ** 2 / self.h * stored)
        fields.kappa[:] += missing
        return energy

    def _at_hinge(self, fields: Fields, layer: Layer, x: Array, lacking: NDArray[np.bool_]) -> Array:
        """What is missing in kappa1 and kappa2 (nodes, 2) of a layer at an end that may turn about the `lacking` axes.
        """
        missing, (end, first, second) = np.zeros((len(layer.at), 2)), layer.nodes[: SECOND + 1]
        if not lacking.any() or fields.f[end, 2] < ALIKE * fields.f[second, 2]:
            return missing
        R = rotation_of(fields.orientation[end])
        near, far = (R.T @ rotation_of(fields.orientation[i]) @ fields.q[i] for i in (first, second))
        bend = (2.0 * near - far - fields.q[end])[:2] / layer.EJ
        for k in np.flatnonzero(lacking):
            rho = _decay(float(x[k]))
            missing[:, k] = bend[k] / (1.0 - rho) ** 2 * (rho**layer.at - np.exp(-x[k] * layer.at))
        return missing


def _decay(x: float) -> float:
    """rho."""
    return 1.0 / (1.0 + 0.5 * x * x + x * sqrt(1.0 + 0.25 * x * x))


def _elastica(half: Array) -> Array:
    """sin(x) / x (n,): by how much less an elastica bends that turns by 2x in a layer."""
    return np.asarray(np.sinc(half / pi))


def _off_end(fields: Fields, layer: Layer) -> Array:
    """The angle (3,), as a vector, lab, by which the rod turns between an end and the force there; 0 if there is none.
    """
    end, _, second = layer.nodes[: SECOND + 1].tolist()
    f1, f2, f3 = fields.f[end].tolist()
    across = hypot(f1, f2)
    if across == 0.0 or hypot(across, f3) < ALIKE * float(np.linalg.norm(fields.f[second])):
        return np.zeros(3)
    angle = atan2(across, f3) / across
    turned = np.array([-angle * f2, angle * f1, 0.0])
    return np.asarray(rotation_of(fields.orientation[end]) @ (turned if end == 0 else -turned))


def _kink(fields: Fields, layer: Layer, load: PointLoad, T: float, t: float) -> Array:
    """The angle (3,), as a vector, lab, by which a load kinks the rod under a tension T."""
    force = np.array([component.value(t) for component in load.force])
    if not force.any():
        return force
    along = np.sum([rotation_of(fields.orientation[i])[:, 2] for i in layer.taut], axis=0)
    if load.frame == "material":
        force = rotation_of(fields.orientation[layer.taut[0] + 1 + round(layer.a)]) @ force
    turned = np.cross(force, along) / (np.linalg.norm(along) * T)
    size = float(np.linalg.norm(turned))
    return np.asarray(turned * (2.0 * asin(min(0.5 * size, 1.0)) / size if size > 0.0 else 1.0))
