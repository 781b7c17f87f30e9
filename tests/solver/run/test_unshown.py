"""Layers of taut rods that are thinner than any mesh shows are within the bars, of moments and places too."""

from __future__ import annotations

import numpy as np
import pytest

from service.cases import build_scene, parse_case
from solver import VerifiedFrame, simulate

EI, T, ANGLE = 5e4, 3e5, 0.02
THIN = float(np.sqrt(EI / T))


def clamped_askew(length: float) -> VerifiedFrame:
    """A taut rod at rest whose clamp is turned, with the other end on the line of the tension."""
    turned = {"t": [0.0, 1.0], "value": [0.0, ANGLE], "interpolation": "smoothstep"}
    case = {
        "schema_version": 1, "name": "askew", "analysis": "static",
        "rod": {"length": length, "diameter": 0.1, "bending_stiffness": EI, "torsional_stiffness": EI,
                "mass_per_length": 20.0},
        "initial": {"shape": "straight", "direction": [1.0, 0.0, 0.0], "a1": [0.0, 1.0, 0.0]},
        "ends": {"start": {"preset": "clamp", "theta1": turned}, "end": {"preset": "pin", "frame": "lab", "f1": T}},
        "t_end": 1.0, "output": {"interval": 0.5},
    }  # fmt: skip
    *_, frame = simulate(build_scene(parse_case(case)))
    assert isinstance(frame, VerifiedFrame)
    return frame


@pytest.mark.parametrize("length", [40.0, 200.0, 1000.0, 5000.0])
def test_moment_place_and_curvature_beside_a_clamp_are_within_their_bars(length: float) -> None:
    frame = clamped_askew(length)
    s, bars = np.linspace(0.0, length, len(frame.r)), frame.error
    A = ANGLE / (1.0 / THIN - 1.0 / length)  # of T y'' = EI y'''', y(0) = y(length) = 0, y'(0) = ANGLE
    y = A * (1.0 - np.exp(-s / THIN) - s / length)
    kappa = A / THIN**2 * np.exp(-s / THIN)
    at_clamp = slice(0, 2)
    for true, found, bar in ((y, np.linalg.norm(frame.r[:, 1:], axis=1), np.linalg.norm(bars.r[:, 1:], axis=1)),
                             (kappa, np.abs(frame.kappa[:, 0]), bars.kappa[:, 0]),
                             (EI * kappa, np.abs(frame.q[:, 0]), bars.q[:, 0])):  # fmt: skip
        rounding = 3e-4 * np.abs(true).max()  # of the angle's square, and of what is not in this solution
        assert np.all(np.abs(found - true)[at_clamp] <= 3.0 * bar[at_clamp] + rounding)


def test_where_the_moment_is_that_of_the_curvature_bars_are_as_the_meshes_tell_them() -> None:
    frame = clamped_askew(2.0)
    assert np.abs(frame.error.q).max() < 1e-2 * np.abs(frame.q).max()
