"""Radau IIA with three stages, order 5, and what its Newton iteration and error estimate need.

Hairer & Wanner, Solving Ordinary Differential Equations II, IV.5 and IV.8: A, c, the inverse of A brought to one real
and one complex eigenvalue by TRANSFORM, and the embedded estimate of order 3 with the weights ERROR.
"""

from __future__ import annotations

import numpy as np

ROOT = np.sqrt(6.0)
C = np.array([(4.0 - ROOT) / 10.0, (4.0 + ROOT) / 10.0, 1.0])
A = np.array(
    [
        [(88.0 - 7.0 * ROOT) / 360.0, (296.0 - 169.0 * ROOT) / 1800.0, (-2.0 + 3.0 * ROOT) / 225.0],
        [(296.0 + 169.0 * ROOT) / 1800.0, (88.0 + 7.0 * ROOT) / 360.0, (-2.0 - 3.0 * ROOT) / 225.0],
        [(16.0 - ROOT) / 36.0, (16.0 + ROOT) / 36.0, 1.0 / 9.0],
    ]
)
INVERSE = np.linalg.inv(A)


def _diagonalise() -> tuple[float, complex, np.ndarray]:
    """gamma, lambda and T with A^-1 = T diag(gamma, lambda) T^-1, where columns 2 and 3 of T hold a complex pair."""
    values, vectors = np.linalg.eig(INVERSE)
    real, pair = int(np.argmin(np.abs(values.imag))), int(np.argmax(values.imag))
    T = np.stack([vectors[:, real].real, vectors[:, pair].real, vectors[:, pair].imag], axis=1)
    # A^-1 (u + i w) = lambda (u + i w) makes x + i y of coefficients (x, y) of u and w turn by the conjugate
    return float(values[real].real), complex(values[pair].conj()), T


GAMMA, LAMBDA, TRANSFORM = _diagonalise()
BACK = np.linalg.inv(TRANSFORM)
ERROR = np.array([-13.0 - 7.0 * ROOT, -13.0 + 7.0 * ROOT, -1.0]) / (3.0 * GAMMA)
"""Weights of the stages in the error estimate; the slope at the start of the step has 1 / GAMMA."""


def _cubic(x: np.ndarray) -> np.ndarray:
    """x, x^2, x^3 (3, 3), by multiplication, which is the same on every CPU."""
    return np.vander(x, 4, increasing=True)[:, 1:]


def _parabola(x: np.ndarray) -> np.ndarray:
    """1, x, x^2 (3, 3)."""
    return np.vander(x, 3, increasing=True)


TO_CUBIC, TO_PARABOLA = np.linalg.inv(_cubic(C)), np.linalg.inv(_parabola(C))
"""From values at the stages to the coefficients of the polynomial through (0, 0) and them, and of the parabola."""


_IN_CUBIC = np.vstack([np.zeros(3), TO_CUBIC])
_IN_PARABOLA = np.vstack([TO_PARABOLA, np.zeros(3)])
_GAINED = np.vstack([np.zeros(3), TO_PARABOLA / np.array([[1.0], [2.0], [3.0]])])
_WITHIN = np.stack([_IN_CUBIC.T, _IN_PARABOLA.T, -_GAINED.T])
_WITHIN[2, :, 0] = _GAINED.sum(axis=0)


def within(part: float) -> np.ndarray:
    """(3, 3): weights of the stages after a part of the step: of what begins with 0, in the polynomial through that and
    them; of what may jump there, in the parabola through them; of rates, in what is gained until the end of the step.
    """
    return np.asarray(_WITHIN @ np.array([1.0, part, part * part, part * part * part]))
