"""Writhe: values, order, symmetry and topology."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from solver.measures.topology import share_of_rays
from solver.run.linking import LinkingNumber
from validation.writhe import writhe, writhe_closed

Array = NDArray[np.float64]
E3 = np.array([0.0, 0.0, 1.0])
OPEN_CURVE = 0.120679172516
TREFOIL = -3.518239231


def open_helix(intervals: int, amplitude: float = 0.1) -> Array:
    """One turn of a right-handed helix that grows out of, and returns to, the axis."""
    s = np.linspace(0.0, 1.0, intervals + 1)
    w = amplitude * (4 * s * (1 - s)) ** 3
    return np.column_stack([w * np.cos(2 * pi * s), w * np.sin(2 * pi * s), s])


def trefoil(vertices: int) -> Array:
    u = np.arange(vertices) * 2 * pi / vertices
    return np.column_stack(
        [(2 + np.cos(3 * u)) * np.cos(2 * u), (2 + np.cos(3 * u)) * np.sin(2 * u), np.sin(3 * u)]
    )


def crooked(seed: int, vertices: int = 40) -> Array:
    return np.random.default_rng(seed).normal(size=(vertices, 3))


def rotation(seed: int) -> Array:
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return q * np.linalg.det(q)


def triangle_angle(a: Array, b: Array, c: Array) -> np.longdouble:
    """Half the area of a spherical triangle (van Oosterom & Strackee 1983) in extended precision."""
    a, b, c = (x / np.sqrt(np.sum(x * x)) for x in (a, b, c))
    volume = a[0] * (b[1] * c[2] - b[2] * c[1])
    volume += a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    return np.longdouble(np.arctan2(volume, 1 + np.sum(a * b) + np.sum(b * c) + np.sum(c * a)))


def plain_writhe_closed(r: Array) -> float:
    """The double sum, pair by pair, in extended precision."""
    points = r.astype(np.longdouble)
    n, total = len(points), np.longdouble(0)
    for i in range(n):
        for j in range(i + 2, n - (i == 0)):
            a, b = points[j] - points[i], points[(j + 1) % n] - points[i]
            c, d = points[(j + 1) % n] - points[i + 1], points[j] - points[i + 1]
            total -= triangle_angle(a, b, c) + triangle_angle(a, c, d)
    return float(total / pi)


def test_open_curve_has_the_reference_writhe_with_order_two():
    errors = [writhe(open_helix(n), E3, E3) - OPEN_CURVE for n in (100, 200, 400)]
    # The error is c/n^2 + O(n^-4): at n = 400 the fourth-order part is some 1e-3 of it.
    orders = np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))
    assert orders == pytest.approx(2.0, abs=0.01)
    extrapolated = OPEN_CURVE + (4 * errors[2] - errors[1]) / 3
    assert extrapolated == pytest.approx(OPEN_CURVE, abs=1e-8)


@pytest.mark.parametrize(
    ("vertices", "value"), [(200, -3.516726147), (400, -3.517860454), (800, -3.518144505)]
)
def test_trefoil_polygons_have_the_reference_writhe(vertices: int, value: float):
    assert writhe_closed(trefoil(vertices)) == pytest.approx(value, abs=5e-10)  # nine decimals are given


def test_trefoil_converges_to_the_smooth_knot():
    values = np.array([writhe_closed(trefoil(n)) for n in (200, 400, 800)])
    fourth_order = (4 * values[1:] - values[:-1]) / 3
    sixth_order = (16 * fourth_order[1] - fourth_order[0]) / 15
    assert sixth_order == pytest.approx(TREFOIL, abs=1e-9)  # as many decimals as are given


@pytest.mark.parametrize("r", [crooked(1), crooked(2), trefoil(60)], ids=["tangle", "tangle", "trefoil"])
def test_the_sum_agrees_with_extended_precision(r: Array):
    expected = plain_writhe_closed(r)
    assert writhe_closed(r) == pytest.approx(expected, rel=1e-12)


def test_far_pairs_keep_their_digits():
    # A gentle helix: every pair is far, or nearly parallel, and the sum is small.
    r = open_helix(200, 1e-3)
    r = np.vstack([r, [[1.0, 0.3, 2.0], [2.0, 0.0, -1.0]]])
    assert writhe_closed(r) == pytest.approx(plain_writhe_closed(r), rel=1e-12, abs=1e-15)


def test_a_ray_is_a_segment_continued():
    r, start, end = crooked(3), np.array([1.0, 2.0, 2.0]), np.array([-2.0, 1.0, 2.0])
    for reach in (1.0, 1e3):
        longer = np.vstack([r[0] - reach * start, r, r[-1] + reach * end])
        assert writhe(longer, start, end) == pytest.approx(writhe(r, start, end), rel=1e-11)


def test_rays_closed_in_a_far_plane_are_a_closed_curve():
    # Parallel rays joined by a far arc in a plane through the axis: the arc adds O(1 / reach).
    r, reach = open_helix(60, 0.2), 1e5
    around = np.array([[0, 0, reach], [reach, 0, reach], [reach, 0, -reach], [0, 0, -reach]])
    assert writhe_closed(np.vstack([r, around])) == pytest.approx(writhe(r, E3, E3), abs=1e-5)


def test_a_straight_rod_and_a_plane_curve_do_not_writhe():
    s = np.linspace(0.0, 1.0, 101)
    along = np.array([0.3, -0.5, 0.8])
    assert writhe(np.outer(s, along), along, along) == pytest.approx(0, abs=1e-13)
    arch = np.column_stack([np.sin(pi * s), 0 * s, np.cos(pi * s)])
    assert writhe(arch, [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]) == 0.0


@pytest.mark.parametrize("seed", range(3))
def test_mirror_changes_the_sign_only(seed: int):
    r, start, end = crooked(seed), crooked(seed + 10)[0], crooked(seed + 20)[0]
    mirror = np.array([1.0, 1.0, -1.0])
    mirrored = writhe(r * mirror, start * mirror, end * mirror)
    assert mirrored == pytest.approx(-writhe(r, start, end), rel=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_motion_scale_and_reversal_change_nothing(seed: int):
    r, start, end = crooked(seed), crooked(seed + 10)[0], crooked(seed + 20)[0]
    value, turn = writhe(r, start, end), rotation(seed)
    moved = 7.0 * r @ turn.T + [1.0, -2.0, 3.0]
    assert writhe(moved, turn @ start, 5.0 * turn @ end) == pytest.approx(value, rel=1e-11)
    assert writhe(r[::-1], -end, -start) == pytest.approx(value, rel=1e-12)


def pass_through(height: float) -> float:
    """A loop whose two strands cross at right angles, the second `height` above the first."""
    up = [[0, 0, -5], [0, 0, 1], [0, 1, 1]]
    across = [[height, 1, 0], [height, -1, 0], [0, -1, -1], [0, -3, -1]]
    r = np.array([*up, *across])
    return writhe(r, E3, [0.0, -1.0, 0.0])


def test_a_strand_that_passes_through_another_changes_it_by_two():
    jump = pass_through(1e-9) - pass_through(-1e-9)
    assert abs(jump) == pytest.approx(2.0, abs=1e-7)


def pass_through_ray(x: float) -> float:
    """A curve whose strand along e2 lies `x` beside the ray that leads in along e3."""
    loop = [[0, 0, 0], [0, 0, 1], [1, 0, 2], [2, 0, 0], [1, -1, -2]]
    return writhe(np.array([*loop, [x, -1, -3], [x, 1, -3], [3, 3, -3]]), E3, [1.0, 1.0, 0.0])


def test_a_strand_that_passes_through_a_ray_changes_it_by_two():
    jump = pass_through_ray(1e-9) - pass_through_ray(-1e-9)
    assert abs(jump) == pytest.approx(2.0, abs=1e-7)


def test_the_shortest_curves_are_accepted():
    assert writhe([[0, 0, 0], [0, 0, 1]], E3, E3) == 0.0
    assert writhe_closed([[0, 0, 0], [0, 0, 1], [0, 1, 0]]) == 0.0


def test_nan_is_not_swallowed():
    r = open_helix(50)
    r[20, 1] = np.nan
    assert np.isnan(writhe(r, E3, E3))


@pytest.mark.parametrize("lean", [-0.5, 0.0, 0.5])
def test_a_plane_hairpin_has_none_wherever_its_rays_cross(lean: float):
    """Its rays run into each other, beside each other, or apart. By rounding it leaves its plane."""
    angle = np.linspace(0.0, np.pi, 41)[:, None]
    leg = np.linspace(1.0, 0.0, 20, endpoint=False)[:, None]
    arc = 0.2 * np.hstack([np.cos(angle), 0 * angle, -np.sin(angle)])
    left, right = arc[0] + leg * [lean, 0, 1], arc[-1] + leg[::-1] * [-lean, 0, 1]
    plane = np.vstack([left, arc, right]) @ Rotation.from_rotvec([0.3, -1.1, 0.7]).as_matrix()
    assert writhe(plane, plane[1] - plane[0], plane[-1] - plane[-2]) == 0.0


def test_where_a_rod_leaves_a_plane_whose_rays_cross_tw_and_wr_remain_lk():
    linking = LinkingNumber()
    assert linking.of(0.0, 0.5, 0.0) == 0.5
    assert linking.of(np.pi, 1.0, 0.0) == 1.0
    assert linking.of(np.pi, 1.01, -1.01) == 0.0
    assert linking.of(2 * np.pi, 1.5, -1.0) == 0.5


def ring(points: int, lifted: float = 0.0, kink: float = 0.0) -> tuple[Array, Array, Array]:
    """A ring whose ends meet, and the tangents there; `lifted` out of its plane, and opened by an angle at its ends."""
    angle = np.linspace(kink, 2.0 * np.pi - kink, points)
    height = lifted * (np.sin(2.0 * angle) + 0.5 * np.sin(3.0 * angle))
    r = np.column_stack([np.cos(angle), np.sin(angle), height])
    r -= np.outer(np.linspace(0.0, 1.0, points), r[-1] - r[0])
    tangent = np.array([0.0, np.cos(kink), 3.5 * lifted + kink])
    return r, tangent, tangent * [1.0, 1.0, 1.0 if kink == 0.0 else -1.0]


@pytest.mark.parametrize("points", [17, 65, 257])
def test_a_ring_has_the_writhe_of_the_closed_curve_however_its_ends_are_rounded(points: int) -> None:
    """Its rays lay on each other and on it, and rounding made them cross it from one step to the next."""
    r, first, last = ring(points, 0.3)
    along = 1e-7 * first  # through the joint it goes along its tangent
    expected = writhe_closed(np.vstack([r[0] + along, r[1:-1], r[0] - along]))
    assert abs(expected) > 0.003
    random = np.random.default_rng(points)
    for size in (0.0, 1e-17, 1e-13, 1e-10):
        moved = r + size * random.normal(size=r.shape)
        assert writhe(moved, first, last) == pytest.approx(expected, abs=1e-6)
        assert abs(share_of_rays(moved, np.array([first, last]))) < 0.02


def test_rays_of_ends_that_meet_at_an_angle_touch_and_do_not_cross() -> None:
    r, first, last = ring(65, 0.3, 0.2)
    values = [writhe(r + size * np.random.default_rng(1).normal(size=r.shape), first, last)
              for size in (0.0, 1e-17, 1e-13, 1e-10)]  # fmt: skip
    assert values == pytest.approx([values[0]] * 4, abs=1e-8)
