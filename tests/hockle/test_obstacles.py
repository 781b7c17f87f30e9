"""Obstacles in a figure."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from hockle.obstacles import FAR, ROOM, surfaces
from hockle.stage import TOWARDS

ROD = (np.array([0.0, -0.1, -0.3]), np.array([1.0, 0.1, 0.0]))
EXTENT = 1.0
LAB = np.eye(3)
BAR = {"start": [0.5, -0.1, -0.1], "end": [0.5, 0.2, 0.0], "radius": 0.1}
LONG = {"start": [0.5, -50.0, -0.1], "end": [0.5, 50.0, -0.1], "radius": 0.1}
BALL = {"start": [0.5, 0.0, -0.3], "radius": 0.2}
HILL = {"start": [0.2, 0.0, -50.3], "radius": 50.0}


def drawn(*obstacles: dict, axes: np.ndarray = LAB) -> tuple[np.ndarray, np.ndarray]:
    return surfaces({"loads": {"obstacles": obstacles}}, axes, ROD, TOWARDS)


def distance(places: np.ndarray, obstacle: dict) -> np.ndarray:
    """From the segment of an obstacle."""
    start = np.array(obstacle["start"])
    way = np.array(obstacle.get("end", obstacle["start"])) - start
    part = np.clip((places - start) @ way / max(way @ way, 1e-300), 0.0, 1.0)
    return np.linalg.norm(places - start - part[..., None] * way, axis=-1)


@pytest.mark.parametrize("obstacle", [BAR, LONG, BALL, HILL])
def test_a_surface_lies_where_the_obstacle_does_and_faces_the_eye(obstacle: dict):
    quads, colours = drawn(obstacle)
    assert len(quads) > 100 and colours.shape == (len(quads), 4)
    assert_allclose(distance(quads, obstacle), obstacle["radius"], rtol=1e-9)
    # a step along the line of sight from the middle of a facet leads out
    centre = quads.mean(axis=1)
    assert (distance(centre + 1e-3 * TOWARDS, obstacle) > distance(centre, obstacle)).mean() > 0.99


@pytest.mark.parametrize("obstacle", [BAR, BALL])
def test_one_that_lies_near_is_drawn_from_its_one_end_to_its_other(obstacle: dict):
    quads, colours = drawn(obstacle)
    ends = np.array([obstacle["start"], obstacle.get("end", obstacle["start"])])
    low, high = ends.min(axis=0) - obstacle["radius"], ends.max(axis=0) + obstacle["radius"]
    # half of it is not seen; where the outline is, both sides of an axis across the sight are
    right = np.array([-TOWARDS[1], TOWARDS[0], 0.0]) / np.hypot(TOWARDS[0], TOWARDS[1])
    across = (quads @ right).ravel()
    assert [across.min(), across.max()] == pytest.approx(
        [(ends @ right).min() - obstacle["radius"], (ends @ right).max() + obstacle["radius"]], abs=5e-3)  # fmt: skip
    assert (quads >= low - 1e-12).all() and (quads <= high + 1e-12).all()
    assert colours[:, 3].min() == colours[:, 3].max()  # nothing is faded


@pytest.mark.parametrize("obstacle", [LONG, HILL])
def test_one_that_goes_on_is_drawn_around_the_rod_and_fades(obstacle: dict):
    quads, colours = drawn(obstacle)
    assert (quads.mean(axis=1) > ROD[0] - ROOM * EXTENT - 0.1).all()
    assert (quads.mean(axis=1) < ROD[1] + ROOM * EXTENT + 0.1).all()
    assert np.ptp(quads[..., 1]) > np.ptp([ROD[0][1], ROD[1][1]]) + 1.5 * ROOM * EXTENT
    outermost = np.abs(quads[..., 1]).min(axis=1).argmax()
    assert colours[outermost, 3] < 0.2 * colours[:, 3].max()


def test_one_that_is_far_is_not_drawn():
    near, far = (1.0 + at * FAR * EXTENT + 0.1 for at in (0.9, 1.1))
    assert len(drawn({"start": [near, 0.0, 0.0], "radius": 0.1})[0]) > 100
    assert len(drawn({"start": [far, 0.0, 0.0], "radius": 0.1})[0]) == 0
    assert len(drawn()[0]) == 0


def test_it_is_turned_as_the_view_is():
    axes = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    quads, _ = drawn(BAR, axes=axes)
    assert_allclose(distance(quads @ axes, BAR), BAR["radius"], rtol=1e-9)
