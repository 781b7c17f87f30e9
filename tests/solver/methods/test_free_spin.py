"""A rod that nothing keeps from spinning about itself, and nothing spins, does not spin on the whole."""

from __future__ import annotations

import numpy as np
import pytest

from solver import Curve, DistributedLoad, End, Initial, Numerics, Rod, Scene, simulate
from solver.arrays import Array
from solver.methods.space.segments.initial import natural_part

LENGTH, WIDTH = 0.5, 0.3
"""Of a catenary, m, and its parameter."""
ZERO = Curve.constant(0.0)


def catenary(s: Array) -> Array:
    """Between two points of the same height."""
    along = WIDTH * np.arcsinh((s - 0.5 * LENGTH) / WIDTH)
    return np.column_stack([along, np.zeros_like(s), WIDTH * np.cosh(along / WIDTH)])


def thread(intervals: int) -> Scene:
    """A thread that is straight when free of stress, hung between two pins; a wind moves it aside. The air damps spin
    so slowly that a moment by errors of the mesh would turn it by radians."""
    rises = Curve.table([0.0, 0.5], [0.0, 1.0], "smoothstep")
    wind = DistributedLoad((ZERO, Curve.constant(5e-6), ZERO), schedule=rises)
    numerics = Numerics("staggered", intervals=intervals, dt_max=0.01, increment_tolerance=1e-2)
    return Scene(rod=Rod.circular(LENGTH, 3e-6, 1e10, 2.4e9, 1300.0), initial=Initial(catenary), start=End.pin(),
                 end=End.pin(), gravity=(0.0, 0.0, -9.81), damping=800.0, distributed=(wind,), t_end=1.0,
                 output_interval=0.1, numerics=numerics, topology=False)  # fmt: skip


def test_errors_of_the_mesh_do_not_make_a_rope_spin() -> None:
    frames = list(simulate(thread(32)))
    turns = max(np.abs(frame.omega[:, :2]).max() for frame in frames)
    assert turns > 1.0
    assert max(abs(frame.omega[:, 2].mean()) for frame in frames) < 0.02 * turns


def test_as_much_of_a_curvature_is_natural_as_is_free_of_stress() -> None:
    kappa = np.array([[0.0, 2.0, 0.0], [0.0, 2.0, 0.0], [0.0, 2.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.0]])
    kappa0 = np.array([[0.0, 2.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [3.0, -1.0, 0.0], [0.0, 1.0, 0.0]])
    assert natural_part(kappa0, kappa)[:, 0] == pytest.approx([1.0, 0.0, 0.5, 0.0, 1.0], abs=0.01)
    assert natural_part(kappa, kappa) == pytest.approx(np.ones((5, 1)))
    assert not natural_part(0.0 * kappa, kappa).any()
