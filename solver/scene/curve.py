"""A scalar function of one variable: a profile along s or a schedule in time."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from solver.arrays import Array

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

Interpolation = Literal["linear", "smoothstep", "pchip", "cubic"]
Number = TypeVar("Number", float, Array)


class Curve:
    """Piecewise cubic function of one variable, held constant beyond its table.

    A `Curve` is `Curve.constant(value)` or `Curve.table(x, y, interpolation)`; it knows its
    derivative, its exact integral and its corners (the knots where a derivative may jump, to
    which the step control aligns the steps).
    """

    def __init__(self, knots: Array, coefficients: Array) -> None:
        """Polynomial of degree 3 on each piece; `coefficients[k]` multiplies (x - knot)^(3-k)."""
        self._knots: list[float] = [float(x) for x in knots]
        self._pieces: list[tuple[float, float, float, float]] = [
            (float(a), float(b), float(c), float(d)) for a, b, c, d in coefficients.T
        ]
        self._table: tuple[Array, Array] = np.array(self._knots), np.array(self._pieces).reshape(-1, 4)
        self._integral_at_knots: list[float] = [0.0]
        for i, piece in enumerate(self._pieces):
            width = self._knots[i + 1] - self._knots[i]
            self._integral_at_knots.append(self._integral_at_knots[-1] + _primitive(piece, width))
        self.corners: tuple[float, ...] = tuple(self._knots) if len(self._pieces) > 0 else ()
        self._first: float = 0.0
        self._last: float = 0.0
        if self._pieces:
            self._first = self._pieces[0][3]
            self._last = _cubic(self._pieces[-1], self._knots[-1] - self._knots[-2])

    @classmethod
    def constant(cls, value: float) -> Curve:
        """The function that is `value` everywhere."""
        if not np.isfinite(value):
            raise ValueError(f"value must be finite, got {value}")
        curve = cls(np.array([0.0]), np.zeros((4, 0)))
        curve._first = curve._last = float(value)
        return curve

    @classmethod
    def table(cls, x: ArrayLike, y: ArrayLike, interpolation: Interpolation = "linear") -> Curve:
        """The function through the points (x, y).

        `linear`; `smoothstep` (x^2 (3 - 2 x) from each value to the next, flat at every point);
        `pchip` (monotone, C1); `cubic` (not-a-knot spline, C2).

        Raises ValueError unless x increases strictly, both are finite and of one length >= 2.
        """
        xs, ys = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
        if xs.ndim != 1 or xs.shape != ys.shape or len(xs) < 2:
            raise ValueError(f"a table needs x and y of one length >= 2, got {xs.shape} and {ys.shape}")
        if not (np.isfinite(xs).all() and np.isfinite(ys).all()):
            raise ValueError("a table must hold finite numbers only")
        if not (np.diff(xs) > 0).all():
            raise ValueError("the x of a table must increase strictly")
        return cls(xs, _power_coefficients(xs, ys, interpolation))

    @property
    def is_constant(self) -> bool:
        """Whether the curve was made by `Curve.constant`."""
        return not self._pieces

    @property
    def polynomials(self) -> tuple[Array, Array]:
        """The points (m,) of its table, and the coefficients (m - 1, 4) of the cubics between them, of x less the point
        before, highest power first; of a constant one point and no cubic."""
        return self._table

    @property
    def is_zero(self) -> bool:
        """Whether the curve is zero everywhere."""
        return not any(any(piece) for piece in self._pieces) and self._first == 0.0 and self._last == 0.0

    def value(self, x: float) -> float:
        """The value at one x."""
        if not self._pieces or x <= self._knots[0]:
            return self._first
        if x >= self._knots[-1]:
            return self._last
        i = bisect_right(self._knots, x) - 1
        return _cubic(self._pieces[i], x - self._knots[i])

    def derivative(self, x: float) -> float:
        """The derivative at one x (the right-hand one at a corner; zero beyond the table)."""
        if not self._pieces or x < self._knots[0] or x >= self._knots[-1]:
            return 0.0
        i = bisect_right(self._knots, x) - 1
        a, b, c, _ = self._pieces[i]
        u = x - self._knots[i]
        return (3.0 * a * u + 2.0 * b) * u + c

    def integral(self, x: float) -> float:
        """The exact integral from the first knot (from 0 for a constant) to x."""
        if not self._pieces:
            return self._first * x
        if x <= self._knots[0]:
            return self._first * (x - self._knots[0])
        if x >= self._knots[-1]:
            return self._integral_at_knots[-1] + self._last * (x - self._knots[-1])
        i = bisect_right(self._knots, x) - 1
        return self._integral_at_knots[i] + _primitive(self._pieces[i], x - self._knots[i])

    def __call__(self, x: ArrayLike) -> Array:
        """The values at an array of x, of the same shape."""
        xs = np.asarray(x, dtype=float)
        if not self._pieces:
            return np.full(xs.shape, self._first)
        knots, pieces = self._table
        inside = np.clip(xs, knots[0], knots[-1])
        i = np.minimum(np.searchsorted(knots, inside, side="right"), len(pieces)) - 1
        a, b, c, d = np.moveaxis(pieces[i], -1, 0)
        values = _cubic((a, b, c, d), inside - knots[i])
        return np.where(xs <= knots[0], self._first, np.where(xs >= knots[-1], self._last, values))


def _cubic(piece: tuple[Number, Number, Number, Number], u: Number) -> Number:
    """The polynomial of one piece at u, or of as many pieces as there are u."""
    a, b, c, d = piece
    return ((a * u + b) * u + c) * u + d


def _primitive(piece: tuple[float, float, float, float], u: float) -> float:
    a, b, c, d = piece
    return (((a / 4 * u + b / 3) * u + c / 2) * u + d) * u


def _power_coefficients(x: Array, y: Array, interpolation: Interpolation) -> Array:
    flat, width, rise = np.zeros(len(x) - 1), np.diff(x), np.diff(y)
    if interpolation == "linear":
        return np.array([flat, flat, rise / width, y[:-1]])
    if interpolation == "smoothstep":
        return np.array([-2.0 * rise / width**3, 3.0 * rise / width**2, flat, y[:-1]])
    # scipy.interpolate takes a fifth of a second to load, and few scenes need it
    from scipy.interpolate import CubicSpline, PchipInterpolator

    spline: PPoly
    if interpolation == "pchip":
        spline = PchipInterpolator(x, y)
    elif interpolation == "cubic":
        spline = CubicSpline(x, y)
    else:
        raise ValueError(f"interpolation must be linear, smoothstep, pchip or cubic, got {interpolation!r}")
    coefficients = np.asarray(spline.c, dtype=float)
    return np.vstack([np.zeros((4 - len(coefficients), len(x) - 1)), coefficients])


def corners_of(*functions: object) -> tuple[float, ...]:
    """The points between which all of them are smooth, as far as they have any."""
    return tuple(sorted({corner for function in functions for corner in getattr(function, "corners", ())}))


Vector = tuple[Curve, Curve, Curve]


def constant_vector(values: Sequence[float]) -> Vector:
    """Three constant curves, one a component."""
    first, second, third = (Curve.constant(float(v)) for v in values)
    return first, second, third
