"""The curvature of a taut rod where it is held at an angle or kinked, and bends within less than an interval.

There, as in a wire at its clamp, kappa = (theta / lambda) exp(-s / lambda), lambda = sqrt(EJ / T), by the angle theta
between the end and the direction in which the rod goes off (of large ones, 2 sin(theta / 2) instead: the elastica). A
chain with intervals h longer than that shows all of theta in its first joint, 2 theta / h, which says how fine the mesh
is. The same chain solved in closed form, x = h / lambda, tells what its joints show of such a layer: the rotations of
its segments differ from that far away by psi_j, with

    psi_j+1 - 2 psi_j + psi_j-1 = x^2 psi_j,   psi_j+1 = rho psi_j,   psi_1 = 2 theta / (x^2 + 3 - rho).

So theta follows from what two joints show, and then what is missing at each node; of order h^2 where the mesh resolves
the layer. A force P in a point kinks the rod by theta = 2 asin(P / 2T), half of it on each side; if it acts on segment
m, the part a of an interval behind its first joint, the layers before and behind it are on this mesh as high as if they
were those of p theta and (1 - p) theta, p = (1 - rho + x^2 (1 - a)) / (2 (1 - rho) + x^2).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import asin, pi, sin, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.kernels.rotation import rotation_of
from solver.measures.frame import Fields
from solver.physics.elasticity import Coupling, Stretch, TwistStretch, Viscosity
from solver.physics.loads.given import points_within
from solver.scene.loads import PointLoad
from solver.scene.scene import Scene

LINEAR = (Coupling, Stretch, TwistStretch, Viscosity)
"""Laws with which bending stays proportional to curvature."""
RESOLVED = 0.05
"""Of h / lambda: below it nothing is missing that rounding would not blur."""
WIDE = 3
"""Nodes of a layer on one side that are completed."""


class Layer(NamedTuple):
    """What may be one: `nodes` that are completed, where the tension is taken (`taut`), and EJ (2,) in N m^2 about a1
    and a2; of a kink its load, which acts the part `a` of an interval behind the joint before it."""

    nodes: list[int]
    taut: list[int]
    EJ: Array
    load: PointLoad | None
    a: float

    def shown(self, x: float) -> tuple[Array, Array]:
        """h kappa over theta at its nodes, on the mesh and in truth."""
        rho = 1.0 / (1.0 + 0.5 * x * x + x * sqrt(1.0 + 0.25 * x * x))
        fading = rho ** np.arange(WIDE)
        if self.load is None:
            psi = 2.0 / (x * x + 3.0 - rho)
            return np.array([2.0 * (1.0 - psi), *(psi * (1.0 - rho) * fading[:-1])]), x * np.exp(-x * np.arange(WIDE))
        p = (1.0 - rho + x * x * (1.0 - self.a)) / (2.0 * (1.0 - rho) + x * x)
        away = np.abs(np.arange(1 - WIDE, WIDE + 1) - self.a)
        return (1.0 - rho) * np.append(p * fading[::-1], (1.0 - p) * fading), 0.5 * x * np.exp(-x * away)


class Layers(NamedTuple):
    """Those of a rod with intervals `h` (m), of which the first two are the ends'; none of a rod whose moment is not
    proportional to its curvature."""

    h: float
    layers: list[Layer]

    @classmethod
    def of(cls, scene: Scene, s: Array) -> Layers:
        """Those of a scene on nodes at `s` (n,)."""
        rod, h, last = scene.rod, float(s[1] - s[0]), len(s) - 1
        if last < WIDE or not all(isinstance(law, LINEAR) for law in rod.laws):
            return cls(h, [])

        def stiffness(place: float) -> Array:
            return np.array([float(profile(np.array([place]))[0]) for profile in rod.stiffness[:2]])

        layers = [Layer([abs(end - k) for k in range(WIDE)], [abs(end - 1)], stiffness(s[end]), None, 0.0)
                  for end in (0, last)]  # fmt: skip
        for load in points_within(scene):
            i, beyond = int(load.s / h), WIDE - 1
            if load.pulls and beyond <= i < last - beyond:
                nodes = list(range(i - beyond, i + 2 + beyond))
                layers.append(Layer(nodes, [i - 1, i + 2], stiffness(load.s), load, load.s / h - i))
        return cls(h, layers)

    def complete(self, fields: Fields, held: Sequence[NDArray[np.bool_]], t: float) -> Fields:
        """Add what is missing to kappa at time t; `held`: whether each end is held about a1 and a2.

        q stays: it is what is in the balances of this mesh.
        """
        about, missing = [*held, *[np.ones(2, dtype=bool)] * len(self.layers)], np.zeros_like(fields.kappa)
        for layer, turned in zip(self.layers, about, strict=False):
            T = float(np.mean(fields.f[layer.taut, 2]))
            x = self.h * np.sqrt(max(T, 0.0) / layer.EJ)
            lacking = turned & (x > RESOLVED)
            if lacking.any():
                shown = [layer.shown(float(value)) for value in x]
                theta = self._angle(fields, layer, [mesh for mesh, _ in shown]) if layer.load is None else (
                    _kink(fields, layer, layer.load, T, t))  # fmt: skip
                lacks = np.array([true - mesh for mesh, true in shown]) / self.h
                _add(missing, fields, layer, theta, np.where(lacking[:, None], lacks, 0.0))
        fields.kappa[:] += missing
        return fields

    def _angle(self, fields: Fields, layer: Layer, mesh: list[Array]) -> Array:
        """The angle (3,), as a vector, lab, between an end and the direction in which the rod goes off there."""
        R, beyond = (rotation_of(fields.orientation[layer.nodes[k]]) for k in (0, WIDE - 1))
        moment = fields.q[layer.nodes[0]] - R.T @ beyond @ fields.q[layer.nodes[-1]]
        return np.asarray(R[:, :2] @ [moment[k] * self.h / (layer.EJ[k] * (mesh[k][0] - mesh[k][-1])) for k in (0, 1)])


def _kink(fields: Fields, layer: Layer, load: PointLoad, T: float, t: float) -> Array:
    """The angle (3,), as a vector, lab, by which a load kinks the rod under a tension T."""
    along = np.sum([rotation_of(fields.orientation[i])[:, 2] for i in layer.taut], axis=0)
    force = np.array([component.value(t) for component in load.force])
    if load.frame == "material":
        force = rotation_of(fields.orientation[layer.nodes[WIDE - 1 + round(layer.a)]]) @ force
    turned = np.cross(force, along) / (np.linalg.norm(along) * T)
    size = float(np.linalg.norm(turned))
    return np.asarray(turned * (2.0 * asin(min(0.5 * size, 1.0)) / size if size > 0.0 else 1.0))


def _add(missing: Array, fields: Fields, layer: Layer, theta: Array, lacks: Array) -> None:
    """Add to what is `missing` what the nodes of a layer of an angle theta (3,) lack of it, 1/m (2, nodes)."""
    for i, lack in zip(layer.nodes, lacks.T, strict=True):
        angle = (rotation_of(fields.orientation[i]).T @ theta)[:2]
        half = (0.5 if layer.load is None else 0.25) * min(float(np.hypot(*angle)), pi)
        missing[i, :2] += (sin(half) / half if half > 0.0 else 1.0) * angle * lack
