"""By how much a rod is out of balance where it begins: what sets it moving by itself.

Of a rod at rest the internal force n and moment m follow from the loads q per length, lab frame (Antman, Nonlinear
Problems of Elasticity, 8):

    n = n0 - Q,  Q = int q ds,   m = m0 - (r - r0) x n0 + int t x Q ds.

n0 and m0 are those by which m is nearest to that of the rod as it is bent and twisted, while free ends bear what loads
them. What is left of m sets the rod moving: nothing of an arc whose ends are clamped, all of one that is let go.
"""

from __future__ import annotations

import numpy as np

from service.cases.stability import stiffness_and_mass
from solver import Scene
from solver.arrays import Array
from solver.kernels.rotation import rotate, rotation_of
from solver.physics.elasticity import elasticity_of, moments
from solver.scene.layout import nodes_at_rest

PLACES = 65
STRICTLY = 100.0
"""Weight of a free end's conditions beside those along the rod."""
NONE = 1e-10
"""Part of the largest effect below which n0 or m0 has none."""


def imbalance(scene: Scene) -> float:
    """The largest moment, in EJ/L, that is out of balance at t = 0, roughly: moments that load the rod are left out."""
    length, (stiffness, _) = float(scene.rod.length), stiffness_and_mass(scene)
    s = np.linspace(0.0, length, PLACES)
    r, quaternion, kappa = nodes_at_rest(scene.initial, s)
    bent = rotate(quaternion, moments(elasticity_of(scene.rod, s), kappa))
    tangent = rotate(quaternion, np.tile([0.0, 0.0, 1.0], (PLACES, 1)))
    Q = _loads(scene, s, quaternion)
    arm = _summed(np.cross(tangent, Q), s)
    levers = _crossing(r[0] - r)
    rows = [np.concatenate([levers, np.tile(np.eye(3), (PLACES, 1, 1))], axis=2).reshape(-1, 6)]
    left = [(bent - arm).ravel()]
    for i, end in ((0, scene.start), (-1, scene.end)):
        own = rotation_of(quaternion[i]).T
        axes = np.eye(3) if end.frame == "lab" else own
        for k, (force, moment) in enumerate(zip(end.translation, end.rotation, strict=True)):
            if force[0].kind == "load":
                rows.append(STRICTLY * length * np.concatenate([axes[k], np.zeros(3)])[None])
                borne = force[0].curve.value(0.0) + (axes[k] @ Q[-1] if i else 0.0)
                left.append(np.array([STRICTLY * length * borne]))
            if moment[0].kind == "load":
                rows.append(STRICTLY * np.concatenate([own[k] @ levers[i], own[k]])[None])
                left.append(np.array([STRICTLY * (moment[0].curve.value(0.0) - own[k] @ arm[i])]))
    A, b = np.concatenate(rows), np.concatenate(left)
    A = A / np.maximum(np.abs(A).max(axis=0), NONE * length)
    rest = b - A @ np.linalg.lstsq(A, b, rcond=NONE)[0]
    along = np.linalg.norm(rest[: 3 * PLACES].reshape(-1, 3), axis=1).max()
    return float(max(along, np.abs(rest[3 * PLACES :]).max(initial=0.0)) * length / stiffness)


def _loads(scene: Scene, s: Array, quaternion: Array) -> Array:
    """Q (n, 3), N, lab: what loads the rod before each of the places s at t = 0."""
    density = np.outer(scene.rod.mass(s) + 0.0 * s, scene.gravity)
    for spread in scene.distributed:
        force = np.stack([profile(s) + 0.0 * s for profile in spread.force], axis=1) * spread.schedule.value(0.0)
        density = density + (force if spread.frame == "lab" else rotate(quaternion, force))
    Q, half = _summed(density, s), 0.5 * (s[1] - s[0])
    for load in scene.points:
        force = np.array([[component.value(0.0) for component in load.force]])
        if load.frame == "material":
            force = rotate(quaternion[[np.abs(s - load.s).argmin()]], force)
        within = half < load.s < s[-1] - half
        part = np.clip(0.5 + 0.5 * (s - load.s) / half, 0.0, 1.0) if within else s >= load.s - half
        Q = Q + part[:, None] * force
    return np.asarray(Q)


def _summed(y: Array, s: Array) -> Array:
    """The integral of y (n, 3) from the start to each of the places s."""
    return np.vstack([np.zeros(3), np.cumsum(0.5 * (s[1] - s[0]) * (y[1:] + y[:-1]), axis=0)])


def _crossing(a: Array) -> Array:
    """Matrices (n, 3, 3) of a x, for vectors a (n, 3)."""
    x, y, z = a.T
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
