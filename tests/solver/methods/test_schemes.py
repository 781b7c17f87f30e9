"""Generalized-alpha's parameters."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from solver.methods.schemes import Scheme


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 0.9, 1.0])
def test_what_a_displacement_lacks_is_known(rho_inf: float) -> None:
    """Of the rate exp(t) after many steps, over dt^2 / 12 of it, which the trapezoidal rule has too much."""
    scheme, dt, aux = Scheme.of(rho_inf), 0.01, 1.0
    rates = np.exp(dt * np.arange(401))
    for begin, end in pairwise(rates):
        mixed = scheme.alpha_f * end + (1.0 - scheme.alpha_f) * begin
        before, aux = aux, (mixed - (1.0 - scheme.alpha_m) * aux) / scheme.alpha_m
    moved = dt * ((1.0 - scheme.gamma) * before + scheme.gamma * aux)
    exact = end - begin
    assert 12.0 / dt**2 * (moved / exact - 1.0) == pytest.approx(scheme.left_out, rel=0.02)
