"""What a rod is drawn above."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from numpy.testing import assert_allclose

from hockle.ground import Ground
from hockle.stage import TOWARDS

ROD = (np.array([0.0, -0.1, -0.3]), np.array([1.0, 0.1, 0.0]))
BOX = (ROD[0] - 0.1, ROD[1] + 0.1)
LAB = np.eye(3)
SLOPE = np.array([-0.6, 0.0, 0.8])


def ground(axes: np.ndarray = LAB, **floor: object) -> Ground:
    return Ground.of({"loads": {"floor": floor} if floor else {}}, axes, ROD, BOX)


def test_without_a_floor_it_is_the_bottom_of_the_box():
    bottom = ground()
    assert not bottom.is_floor
    assert_allclose(bottom.corners, [[-0.1, -0.2, -0.4], [1.1, -0.2, -0.4], [1.1, 0.2, -0.4], [-0.1, 0.2, -0.4]])


@pytest.mark.parametrize(("floor", "height"), [({"height": -0.2}, -0.2), ({"normal": [0, 0, 2.0], "height": 0.1}, 0.1)])
def test_a_floor_lies_at_its_height(floor: dict, height: float):
    level = ground(**floor)
    assert level.is_floor
    assert_allclose(level.corners[:, 2], height)
    assert_allclose(level.foot(np.array([[0.3, 0.1, 0.7]])), [[0.3, 0.1, height]])


def test_a_slope_lies_across_its_normal_and_reaches_below_all_of_the_box():
    slope = ground(normal=tuple(SLOPE), height=-0.5)
    assert_allclose(slope.corners @ SLOPE, -0.5)
    feet = slope.foot(np.array([BOX[0], BOX[1]]))
    assert_allclose(feet @ SLOPE, -0.5)
    for axis in range(3):
        assert slope.corners[:, axis].min() <= feet[:, axis].min() + 1e-12
        assert slope.corners[:, axis].max() >= feet[:, axis].max() - 1e-12


def test_a_floor_is_turned_as_the_view_is():
    axes = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])  # e1 is up
    assert_allclose(ground(axes, normal=[1.0, 0.0, 0.0], height=-0.2).corners[:, 2], -0.2)


def test_a_floor_that_is_farther_than_the_rod_is_long_is_not_drawn():
    assert ground(height=-1.2).is_floor
    assert not ground(height=-1.4).is_floor


@pytest.mark.parametrize(("normal", "before"), [(SLOPE * [-1, 1, 1], False), (-TOWARDS, True)])
def test_a_sheet_is_drawn_behind_the_rod_or_before_it_where_the_eye_is_below(
    normal: np.ndarray, before: bool, monkeypatch: pytest.MonkeyPatch
):
    faces = []

    def collection(quads, **more):
        faces.append(quads)
        return Poly3DCollection(quads, **more)

    monkeypatch.setattr("hockle.ground.Poly3DCollection", collection)
    axes = Figure().add_subplot(projection="3d")
    floor = ground(normal=tuple(normal), height=-0.5)
    floor.draw(axes, 0.1, TOWARDS)
    [sheet] = [one for one in axes.collections if isinstance(one, Poly3DCollection)]
    assert_allclose(faces, [[floor.corners]])
    assert (sheet.get_zorder() > 2) == before
    assert len(axes.lines) > 10
    for line in axes.lines:
        assert_allclose(np.array(line.get_data_3d()).T @ floor.normal, -0.5)
