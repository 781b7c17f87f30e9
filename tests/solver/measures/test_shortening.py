"""The writhe of a shortened polygon, with the area it lost, is that of the whole one."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from numpy.typing import NDArray

from solver.measures.shortening import BLOCK, shorten
from solver.measures.topology import writhe_shares
from validation.writhe import writhe

Array = NDArray[np.float64]
E3 = np.array([0.0, 0.0, 1.0])


def whole(r: Array, first: Array, last: Array) -> float:
    """The writhe by all pairs of segments, none left out."""
    unit = np.array([direction / np.linalg.norm(direction) for direction in (first, last)])
    return sum(writhe_shares(r, unit))


def vertices_left(r: Array, first: Array, last: Array) -> int:
    unit = [tuple(direction / np.linalg.norm(direction)) for direction in (first, last)]
    shorter, _ = shorten(np.ascontiguousarray(r.T), *unit)
    assert shorter[:, 0] == pytest.approx(r[0], abs=0)
    assert shorter[:, -1] == pytest.approx(r[-1], abs=0)
    return shorter.shape[1]


def waves(seed: int) -> tuple[Array, Array, Array]:
    """A curve of some waves, of any number of vertices, smooth or rough, and the directions of its rays."""
    random = np.random.default_rng(seed)
    s = np.linspace(0.0, 1.0, random.integers(3, 400))[:, None]
    r, roughness = np.hstack([0 * s, 0 * s, 3 * s * (seed % 3)]), random.uniform(0, 2)
    for wave in range(6):
        r += random.normal(size=3) / (1 + wave) ** roughness * np.sin(pi * (2 * wave + 1) * s + random.uniform(0, 6, 3))
    along = (r[1] - r[0], r[-1] - r[-2])
    return (r, *(along if seed % 2 else random.normal(size=(2, 3))))


def plectoneme(vertices: int, apart: float) -> Array:
    """Two strands `apart`, wound about each other, joined by a long loop: a third of the vertices each."""
    down = np.linspace(3.0, 0.0, vertices // 3)
    strand = 0.5 * apart * np.column_stack([np.cos(4 * pi * down), np.sin(4 * pi * down), 0 * down])
    strand[:, 2] = down
    loop = np.linspace(0.0, pi, vertices // 3 + 2)[1:-1, None]
    bottom = 0.5 * apart * np.cos(loop) * [1.0, 0.0, 0.0] - np.sin(loop) * [0.0, 0.0, 1.0]
    return np.vstack([strand, bottom, (strand * [-1.0, -1.0, 1.0])[::-1]])


@pytest.mark.parametrize("seed", range(60))
def test_any_curve_keeps_its_writhe(seed: int):
    r, first, last = waves(seed)
    assert writhe(r, first, last) == pytest.approx(whole(r, first, last), abs=1e-12)


@pytest.mark.parametrize("apart", [0.3, 0.05, 0.01])
def test_strands_wound_about_each_other_keep_their_writhe(apart: float):
    r = plectoneme(1500, apart)
    first, last = r[1] - r[0], r[-1] - r[-2]
    value = writhe(r, first, last)
    assert abs(value) > 5
    assert value == pytest.approx(whole(r, first, last), abs=1e-12)


def test_only_blocks_that_are_alone_are_shortened():
    curves = {apart: plectoneme(3000, apart) for apart in (0.3, 0.01)}
    left = {apart: vertices_left(r, r[1] - r[0], r[-1] - r[-2]) for apart, r in curves.items()}
    assert left[0.3] == pytest.approx(3000 / BLOCK, rel=0.1)
    assert left[0.01] == 3000


def test_a_smooth_curve_loses_all_inner_vertices_of_its_blocks():
    s = np.linspace(0.0, 1.0, 1001)
    w = 0.1 * (4 * s * (1 - s)) ** 3
    helix = np.column_stack([w * np.cos(6 * pi * s), w * np.sin(6 * pi * s), s])
    assert vertices_left(helix, E3, E3) == 1000 // BLOCK + 1


def test_the_blocks_at_a_sharp_bend_are_kept():
    s = np.linspace(0.0, 1.0, 10 * BLOCK + 1)[:, None]
    corner = np.vstack([s * [1.0, 0.0, 0.0], [1.0, 0.0, 0.0] + s[1:] * [0.0, 1.0, 0.2]])
    left = vertices_left(corner, np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.2]))
    assert left == 20 + 1 + 2 * (BLOCK - 1)


def test_a_block_that_a_ray_passes_through_is_kept():
    s = np.linspace(0.0, pi, 161)
    arch = np.column_stack([np.sin(s), 1e-9 * (s - pi / 2), 1.0 - np.cos(s)])
    aimed = arch[80] - arch[-1]
    assert vertices_left(arch, np.array([1.0, 0.0, 0.0]), aimed) > 21
    assert vertices_left(arch, np.array([1.0, 0.0, 0.0]), -aimed) == 21
    for last in (aimed, -aimed):
        value = writhe(arch, np.array([1.0, 0.0, 0.0]), last)
        assert value == pytest.approx(whole(arch, np.array([1.0, 0.0, 0.0]), last), abs=1e-12)


def test_not_a_number_stays_one():
    r = np.column_stack([np.zeros(50), np.zeros(50), np.linspace(0.0, 1.0, 50)])
    r[20, 1] = np.nan
    assert np.isnan(writhe(r, E3, E3))
