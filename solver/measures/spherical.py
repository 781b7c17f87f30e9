"""Areas of spherical triangles."""

from __future__ import annotations

from math import atan2, sqrt
from typing import Any

from solver.kernels.kernel import inlined, inner


@inner
def half_area(a: Any, b: Any, c: Any) -> float:
    """Half the signed area of the spherical triangle of directions a, b, c (3,), of any length > 0.

    By van Oosterom & Strackee (IEEE Trans. Biomed. Eng. 30 (1983) 125).
    """
    volume = (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )
    la = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    lb = sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2])
    lc = sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2])
    ab = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    bc = b[0] * c[0] + b[1] * c[1] + b[2] * c[2]
    ca = c[0] * a[0] + c[1] * a[1] + c[2] * a[2]
    return angle(la * lb * lc + ab * lc + bc * la + ca * lb, volume)


@inlined
def angle(x: float, y: float) -> float:
    """arg(x + i y), but 0 for what lies in one plane, whose area is none wherever its corners lie."""
    return 0.0 if y == 0.0 else atan2(y, x)
