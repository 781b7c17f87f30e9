"""How a rod moves as a whole: rigid motions are found, and nothing else is taken for one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from solver.arrays import Array
from solver.physics.contact.whole import ROUNDING, carry_as_a_whole, velocity_as_a_whole

seeds = st.integers(0, 2**32 - 1)


def rod(rng: np.random.Generator) -> tuple[Array, Array]:
    """Nodes of a bent rod, and points."""
    return np.cumsum(rng.normal(size=(30, 3)), axis=0), 5.0 * rng.normal(size=(7, 3))


def farthest(r: Array, p: Array) -> float:
    """How far the fit may set a point p for each radian of the rod at r: ROUNDING of the whole moment of inertia is
    taken to be about each axis, and counts where the rod has least of it."""
    least, *others = np.linalg.eigvalsh(np.cov(r, rowvar=False))
    part = ROUNDING * (least + sum(others)) / (least + others[0])
    return float(part * np.linalg.norm(p - r.mean(axis=0), axis=1).max() * (1.0 + 1e-3) + 1e-12)


@given(seeds)
@settings(max_examples=40, deadline=None)
def test_a_rigid_motion_is_found(seed: int) -> None:
    rng = np.random.default_rng(seed)
    (before, p), turn, shift = rod(rng), Rotation.from_rotvec(rng.uniform(-0.5, 0.5, 3)), 100.0 * rng.normal(size=3)
    nodes, points = np.empty_like(before), np.empty_like(p)
    carry_as_a_whole(before, turn.apply(before) + shift, nodes, p, points)
    assert_allclose(nodes, turn.apply(before) + shift, atol=1e-9)
    assert_allclose(points, turn.apply(p) + shift, atol=1e-9)


@given(seeds)
@settings(max_examples=40, deadline=None)
def test_whatever_the_rod_does_its_points_keep_their_distances(seed: int) -> None:
    """Even of a motion that no rigid one is near."""
    rng = np.random.default_rng(seed)
    before, p = rod(rng)
    nodes, points = np.empty_like(before), np.empty_like(p)
    carry_as_a_whole(before, rod(rng)[0], nodes, p, points)
    apart = [np.linalg.norm(x[:, None] - x, axis=-1) for x in (np.vstack([before, p]), np.vstack([nodes, points]))]
    assert_allclose(*apart, atol=1e-9)


@pytest.mark.parametrize("straight", [False, True])
@given(seeds)
@settings(max_examples=40, deadline=None)
def test_the_velocities_of_a_rigid_body_are_found_and_no_others(straight: bool, seed: int) -> None:
    rng = np.random.default_rng(seed)
    r, p = rod(rng)
    if straight:
        r = np.linspace(0.0, 1.0, 30)[:, None] * rng.normal(size=3)
    spin, flight = rng.normal(size=(2, 3))
    nodes, points = np.empty_like(r), np.empty_like(p)
    velocity_as_a_whole(r, np.cross(spin, r) + flight, nodes, p, points)
    assert_allclose(nodes, np.cross(spin, r) + flight, atol=1e-5)
    if not straight:
        assert_allclose(points, np.cross(spin, p) + flight, rtol=0.0, atol=farthest(r, p) * np.linalg.norm(spin))
        bends = np.sin(3.0 * np.arange(30.0))[:, None] * rng.normal(size=3)
        velocity_as_a_whole(r, bends, nodes, p, points)
        assert np.linalg.norm(bends - nodes) < np.linalg.norm(bends)
