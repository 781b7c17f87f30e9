"""What no mesh shows of the layers in which a taut rod bends: errors that two meshes, which both lack it, do not tell.

The curvature of a layer is completed where the mesh is too coarse for it; the moment stays that of the mesh's balances,
and the place that of its nodes (`solver.methods.space.segments.layers`). In truth the moment is that of the curvature.
It is the tension times its lever about the end, so the rod beyond the layer is aside by as much as the moments differ,
over the tension. A rod whose other end is held is turned by that, over its length, and the layer bends by so much more.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.methods.space.segments.layers import Layer, Layers
from solver.physics.elasticity import Coupling, Viscosity
from solver.run.recording import FORCE, KAPPA, MOMENT
from solver.scene.scene import Scene

THIN = 0.5
"""Of h / lambda: below it meshes differ as they converge, and tell the error."""


class Unshown:
    """That of a scene on nodes at `s` (n,). Nothing of a rod whose moment about an axis is not by the curvature about
    it alone."""

    def __init__(self, scene: Scene, s: Array) -> None:
        self._layers, self._length = Layers.of(scene, s), float(s[-1])
        self.any = bool(self._layers.layers)
        if any(isinstance(law, Coupling | Viscosity) for law in scene.rod.laws):
            self.any = False
        self._kappa0 = np.stack([profile(s) for profile in scene.rod.kappa0[:2]], axis=1)

    def of(self, along: Array) -> tuple[Array, Array, Array]:
        """By how much the rod may be aside (frames,), m, and the errors of q in N m and of kappa in 1/m (frames, nodes,
        3); `along`: the outputs along the rod (frames, nodes, columns)."""
        aside, moments, kappa = np.zeros(len(along)), *np.zeros((2, *along.shape[:2], 3))
        for layer in self._layers.layers:
            T = along[:, layer.taut, FORCE][..., 2].mean(axis=1)
            lacking = self._lacking(layer, along) * (T > self._least(layer))[:, None, None]
            T = np.maximum(T, self._least(layer))
            root = np.linalg.norm(lacking[:, np.abs(layer.at) <= (layer.load is not None)], axis=-1).max(axis=1)
            bend = root / T / self._length * np.sqrt(T / layer.EJ.min())
            aside = np.maximum(aside, root / T)
            moments[:, layer.nodes, :2] = np.maximum(moments[:, layer.nodes, :2], lacking)
            kappa[:, layer.nodes, :2] = np.maximum(kappa[:, layer.nodes, :2], bend[:, None, None])
        return aside, moments, kappa

    def _lacking(self, layer: Layer, along: Array) -> Array:
        """By how much the moments (frames, nodes, 2) about a1 and a2 are not those of the curvature."""
        there = along[:, layer.nodes]
        bend = there[..., KAPPA][..., :2] - self._kappa0[layer.nodes]
        return np.asarray(np.abs(layer.EJ * bend - there[..., MOMENT][..., :2]))

    def _least(self, layer: Layer) -> float:
        """The tension (N) from which on a layer is thinner than the mesh shows."""
        return float(THIN**2 * layer.EJ.min() / self._layers.h**2)
