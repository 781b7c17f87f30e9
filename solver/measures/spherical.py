"""Areas of spherical triangles."""

from __future__ import annotations

from math import atan2
from typing import Any

from solver.kernels.kernel import inlined, inner
from solver.kernels.vectors import dot, norm, vector_product


@inner
def half_area(a: Any, b: Any, c: Any) -> float:
    """Half the signed area of the spherical triangle of directions a, b, c (3,), of any length > 0.

    By van Oosterom & Strackee (IEEE Trans. Biomed. Eng. 30 (1983) 125).
    """
    la, lb, lc = norm(a), norm(b), norm(c)
    return angle(la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb, dot(a, vector_product(b, c)))


@inlined
def angle(x: float, y: float) -> float:
    """arg(x + i y), but 0 for what lies in one plane, whose area is none wherever its corners lie."""
    return 0.0 if y == 0.0 else atan2(y, x)
