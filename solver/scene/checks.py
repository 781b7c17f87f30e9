"""Rules that several parts of a scene have."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array


def require_finite(name: str, vector: tuple[float, float, float]) -> None:
    """Raise ValueError unless all components are finite."""
    if not np.isfinite(vector).all():
        raise ValueError(f"{name} must be finite, got {vector}")


def unit_vector(name: str, vector: tuple[float, float, float]) -> Array:
    """The unit vector (3,) along one of any length. Raise ValueError where that is zero or not finite."""
    require_finite(name, vector)
    largest = np.abs(vector).max()
    if largest == 0.0:
        raise ValueError(f"{name} must not be zero, got {vector}")
    scaled = np.array(vector, dtype=float) / largest  # its square neither vanishes nor overflows
    return np.asarray(scaled / np.linalg.norm(scaled))
