"""Rules that several parts of a scene have."""

from __future__ import annotations

import numpy as np


def require_finite(name: str, vector: tuple[float, float, float]) -> None:
    """Raise ValueError unless all components are finite."""
    if not np.isfinite(vector).all():
        raise ValueError(f"{name} must be finite, got {vector}")
