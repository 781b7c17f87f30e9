"""Contact without constants: its law, what it foresees, and strands that it holds apart."""

from __future__ import annotations

from dataclasses import replace
from math import inf, log, pi

import numpy as np
import pytest
from numpy.testing import assert_allclose

from solver import Condition, Contact, Curve, DistributedLoad, End, Fluid, Initial, Rod
from solver.arrays import Array
from solver.physics.contact.law import Law, pair_force
from solver.physics.contact.points import Points
from solver.physics.contact.recipe import IN_MOTION, Foreseen, foreseen, held, spaced
from solver.scene.ends import FIXED
from solver.statics.contact import AT_REST
from tests.solver.physics.contact.test_law import AXIS, MASS, D, two_points
from tests.solver.physics.contact.test_self_contact import looped

LAW = Law.by_itself(spaced(Contact(), Rod.circular(1.0, D, 1e7, 5e6, 1500.0)), 0.4 * D, 0.02, IN_MOTION.pole)


STEEP = LAW._replace(pole=AT_REST.pole)


def force(points: Points, law: Law = LAW) -> Array:
    n = np.zeros(3)
    elastic, damping, _ = pair_force(law, points, 0, 1, n, np.zeros(3), np.zeros(3))
    return np.asarray((elastic + damping) * n)


def test_the_force_is_1_where_surfaces_touch_and_none_beyond_its_reach() -> None:
    """In P h^2: the test's points have MASS for P."""
    assert_allclose(force(two_points(D)), MASS * (0.4 * D) ** 2 * AXIS, rtol=1e-12)
    assert not force(two_points(1.001 * (2.0 - IN_MOTION.pole) * D)).any()
    assert np.linalg.norm(force(two_points(1.001 * IN_MOTION.pole * D))) > 1e6 * MASS * (0.4 * D) ** 2


@pytest.mark.parametrize(("d", "law"), [(0.8 * D, LAW), (1.1 * D, LAW), (0.505 * D, LAW), (0.97 * D, STEEP)])
def test_its_tangents_are_derivatives(d: float, law: Law) -> None:
    """By the separation along and across it, and by the relative velocity."""
    n, g, k = np.zeros(3), np.zeros(3), np.zeros(3)
    elastic, damping, gap = pair_force(law, two_points(d, closing=0.1), 0, 1, n, g, k)
    tangent = np.outer(n, g) + (elastic + damping) / d * np.eye(3)
    for moved in np.eye(3):
        one, two = two_points(d, closing=0.1), two_points(d, closing=0.1)
        one.p[0] += 1e-9 * moved
        two.p[0] -= 1e-9 * moved
        expected = (force(one, law) - force(two, law)) / 2e-9
        assert_allclose(tangent @ moved, expected, atol=1e-6 * float(np.abs(tangent).max()))
        one, two = two_points(d, closing=0.1), two_points(d, closing=0.1)
        one.w[0] += 1e-6 * moved
        two.w[0] -= 1e-6 * moved
        assert_allclose(n * k[2] * (n @ moved), (force(one, law) - force(two, law)) / 2e-6, atol=1e-6 * abs(k[2]))
    assert gap == pytest.approx(d - law.pole * D)


def test_at_rest_strands_cost_what_hard_ones_cost() -> None:
    """Under the pressure that is foreseen they rest at d, with D - d = U / p of the energy U that they store."""
    d = np.linspace(AT_REST.pole, 2.0 - AT_REST.pole, 20001)[1:-1] * D
    f = np.array([np.linalg.norm(force(two_points(x), STEEP)) for x in d])
    f *= AT_REST.margin / np.linalg.norm(force(two_points(D), STEEP))  # of the pressure
    at = float(np.interp(-1.0, -f, d))
    beyond = d >= at
    assert D - at == pytest.approx(float(np.trapezoid(f[beyond], d[beyond])), rel=2e-3)


def test_the_pressure_has_the_scale_of_the_rod() -> None:
    """P D^3 / EJ is the same from DNA to an umbilical, if the pull F D^2 / EJ and L / D are."""

    def scaled(D: float, EJ: float, mass: float) -> tuple[float, float]:
        stiffness, heavy = Curve.constant(EJ), Curve.constant(mass)
        rod = Rod(100 * D, (stiffness,) * 3, heavy, (heavy,) * 3, Curve.constant(D))
        law = held(rod, Foreseen(5.0, 0.1 * EJ / D**2, 0.5), np.array([0.0, 50 * D]))
        return float(law.strength[0] * D**4 / EJ), law.relaxation / (D * D * np.sqrt(mass / EJ))

    assert_allclose(scaled(2e-9, 2e-28, 3e-15), scaled(0.2, 1e5, 60.0), rtol=1e-9)


def test_the_ends_tell_the_turns_and_the_slack() -> None:
    scene = looped(Contact(), 0.0)
    turning = Condition("position", Curve.table([0.0, 0.5, 1.0], [0.0, 8 * pi, 8 * pi], "smoothstep"))
    there = scene.end.translation
    end = End(there, (FIXED, FIXED, (turning,)), frame="lab")
    scene = replace(scene, end=end, rod=replace(scene.rod, kappa0=(Curve.constant(0.0),) * 3))
    assert foreseen(scene).turns == pytest.approx(4.0)
    pulled = replace(end, translation=(there[0], there[1], (Condition("load", Curve.constant(3.0)),)))
    assert foreseen(replace(scene, end=pulled)).pull == pytest.approx(3.0)
    assert foreseen(replace(scene, contact=None)) == Foreseen()


def test_a_load_along_the_rod_and_a_current_pull_as_well() -> None:
    scene, none = looped(Contact(), 0.0), Curve.constant(0.0)
    force = Curve.constant(3.0), Curve.constant(4.0), none
    load = DistributedLoad(force, schedule=Curve.table([0.0, 1.0], [0.0, -2.0]))
    assert foreseen(replace(scene, distributed=(load,))).pull == pytest.approx(10.0 * scene.rod.length)
    stream = Fluid(1000.0, drag_normal=1.0, current=(3.0, 0.0, 4.0))
    area = scene.rod.length * float(scene.rod.diameter(0.0))
    assert foreseen(replace(scene, fluid=stream)).pull == pytest.approx(12500.0 * area)
    syrup = Fluid(1000.0, viscosity=20.0, current=(3.0, 0.0, 4.0))
    per_length = 5.0 * 4.0 * pi * 20.0 / (log(scene.rod.length / float(scene.rod.diameter(0.0))) + 0.84)
    assert foreseen(replace(scene, fluid=syrup)).pull == pytest.approx(per_length * scene.rod.length)


def test_a_ring_goes_on_from_its_end_to_its_start() -> None:
    scene = looped(Contact(), 0.0)
    L = scene.rod.length

    def closing(turn: float) -> float:
        angle = np.linspace(0.0, turn, 201)
        circle = L / turn * np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
        return foreseen(replace(scene, initial=Initial.through(circle, L))).closing

    assert closing(2 * pi - 0.02) == pytest.approx(0.02 * L / (2 * pi), rel=1e-2)
    assert closing(2 * pi) == pytest.approx(0.0, abs=1e-5 * L)
    assert closing(1.5 * pi) == inf


@pytest.mark.parametrize("name", ["k1", "aperture", "cutoff"])
def test_some_constants_of_eq_6_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match=rf"must be given with the other constants of eq. \(6\), or none: got {name}"):
        Contact(**{name: 1.0})  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="sum must be density"):
        Contact(sum="grid_points")


def test_geometry_alone_may_be_given() -> None:
    rod = Rod.circular(1.0, D, 1e7, 5e6, 1500.0)
    assert Contact(spacing=1e-3).automatic
    assert spaced(Contact(spacing=1e-3), rod).spacing == 1e-3
    assert spaced(Contact(), rod).spacing == pytest.approx(0.4 * D)
