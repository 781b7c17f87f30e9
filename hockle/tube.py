"""A rod as a shaded tube: facets that are lit, with a stripe along a1."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import xarray as xr
from numpy.typing import NDArray

Array = NDArray[np.float64]

FACETS = 16
MOST_RINGS = 400
BODY, STRIPE = np.array([0.93, 0.62, 0.20]), np.array([0.13, 0.22, 0.42])
LIGHT = np.array([-0.35, -0.55, 0.76])


def radius(case: Mapping[str, Any]) -> float:
    """Half the largest diameter (m) of a case's rod."""
    diameter = case["rod"]["diameter"]
    return float(max(diameter["value"]) if isinstance(diameter, Mapping) else diameter) / 2


@dataclass(frozen=True)
class Tube:
    """A centreline `r` (n, 3) and the section's axes `a1`, `a2` (n, 3) along it."""

    r: Array
    a1: Array
    a2: Array

    @classmethod
    def of(cls, r: Array, quaternion: Array) -> Self:
        """From positions (n, 3) and unit quaternions (n, 4), thinned out to what can be seen."""
        step = max(1, len(r) // MOST_RINGS)
        w, x, y, z = quaternion[::step].T
        a1 = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], axis=1)
        a2 = np.stack([2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)], axis=1)
        return cls(r[::step], a1, a2)

    @classmethod
    def at(cls, dataset: xr.Dataset, t: float) -> Self:
        """Of a dataset at a time (s): between two frames positions go on straight lines, and axes turn with them."""
        times = dataset.time.values
        after = int(np.clip(np.searchsorted(times, t), 1, len(times) - 1))
        part = float(np.clip((t - times[after - 1]) / (times[after] - times[after - 1]), 0.0, 1.0))
        two = dataset.isel(time=slice(after - 1, after + 1))
        (r, later), (quaternion, next_) = two.r.values, two.orientation.values
        sign = np.where((quaternion * next_).sum(axis=1) < 0, -1.0, 1.0)[:, None]  # q and -q are one rotation
        mixed = (1 - part) * quaternion + part * sign * next_
        return cls.of((1 - part) * r + part * later, mixed / np.linalg.norm(mixed, axis=1)[:, None])

    def turned(self, axes: Array) -> Self:
        """The same tube in other axes, the rows of `axes` (3, 3)."""
        return type(self)(self.r @ axes.T, self.a1 @ axes.T, self.a2 @ axes.T)

    def facets(self, radius: float) -> tuple[Array, Array]:
        """Quadrilaterals (m, 4, 3) of the surface and their colours (m, 3): lit, with a stripe along a1."""
        angle = np.arange(FACETS + 1) * 2 * np.pi / FACETS
        normal = np.cos(angle)[:, None] * self.a1[:, None, :] + np.sin(angle)[:, None] * self.a2[:, None, :]
        ring = self.r[:, None, :] + radius * normal
        quads = np.stack([ring[:-1, :-1], ring[1:, :-1], ring[1:, 1:], ring[:-1, 1:]], axis=2)
        outward = normal[:-1, :-1] + normal[1:, 1:]
        outward /= np.linalg.norm(outward, axis=2)[:, :, None]
        light = 0.45 + 0.55 * np.clip(outward @ LIGHT, 0.0, 1.0)
        striped = (np.arange(FACETS) < FACETS // 4)[None, :, None]
        colours = np.where(striped, STRIPE, BODY) * light[:, :, None]
        return quads.reshape(-1, 4, 3), np.clip(colours, 0.0, 1.0).reshape(-1, 3)
