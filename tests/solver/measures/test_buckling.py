"""What lets a rod buckle out of the line, or the plane, to which its own motion keeps, against textbooks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from scipy.optimize import brentq

from solver import Condition, Curve, End, Initial, PointLoad, Rod, Scene, constant_vector
from solver.arrays import Array
from solver.measures.buckling import STRAIGHT, Disturbance, Transverse, axis_kept
from solver.measures.frame import Fields
from solver.physics.loads.solids import Floor
from solver.scene.ends import FIXED, FREE
from solver.scene.layout import nodes_at_rest
from tests.solver.scenes import ARC, ARC_ROD, LENGTH, ROD

EJ, GJ, MASS = (float(profile(0.0)) for profile in (ROD.stiffness[0], ROD.stiffness[2], ROD.mass))
S = np.linspace(0.0, LENGTH, 101)
CLAMP, PIN, FREE_END, SLIDER = End.clamp(), End.pin(), End.free(), End.slider()


def scene_of(start: End, end: End, rod: Rod = ROD, **more: object) -> Scene:
    return Scene(rod, Initial.straight(), start, end, 1.0, 0.1, **more)  # type: ignore[arg-type]


def state_of(initial: Initial, kappa: Array, q: Array, f: Array) -> Fields:
    """A rod at rest in its initial shape, on 100 intervals, with what it bears (n, 3)."""
    r, orientation, _ = nodes_at_rest(initial, S)
    none = np.zeros_like(r)
    return Fields(v=none, omega=none, f=f, kappa=kappa, q=q, r=r, orientation=orientation, strain=none[:, 0])


def lowest(scene: Scene, kappa: float = 0.0, q: Array | float = 0.0, f: Array | float = 0.0) -> float:
    """The lowest stiffness across a straight rod that bears a twist, a torque and a tension."""
    transverse = Transverse.of(scene)
    assert transverse is not None and transverse.p == STRAIGHT
    along = [np.column_stack([0.0 * S, 0.0 * S, row + 0.0 * S]) for row in (kappa, q, f)]
    return float(np.linalg.eigvalsh(transverse.stiffness(S, state_of(Initial.straight(), *along)))[0])


def critical(stiffness: Callable[[float], float], low: float, high: float) -> float:
    """From where on something grows."""
    return float(brentq(lambda load: 1.0 if stiffness(load) < -1e-5 else -1.0, low, high, xtol=1e-5 * high))


@pytest.mark.parametrize(("ends", "expected"), [
    ((PIN, PIN), pi**2), ((CLAMP, SLIDER), 4 * pi**2), ((CLAMP, PIN), 20.19), ((CLAMP, FREE_END), pi**2 / 4),
    ((FREE_END, CLAMP), pi**2 / 4),
])  # fmt: skip
def test_a_column_buckles_by_eulers_load(ends: tuple[End, End], expected: float) -> None:
    scene = scene_of(*ends)
    found = critical(lambda load: lowest(scene, f=-load * EJ / LENGTH**2), 1.0, 60.0)
    assert found == pytest.approx(expected, rel=4e-3)


def test_a_mast_buckles_by_its_weight() -> None:
    """Greenhill's 7.837 EJ/L^3 per length."""
    scene = scene_of(CLAMP, FREE_END)
    found = critical(lambda load: lowest(scene, f=-load * EJ / LENGTH**3 * (LENGTH - S)), 1.0, 20.0)
    assert found == pytest.approx(7.837, rel=2e-3)


def _torque(tension: float) -> float:
    """M L/EJ by which a rod between a clamp and one that slides buckles under a tension T in EJ/L^2.

    Across it d4u + i M d3u - T d2u = 0, and u and du are zero at both ends.
    """
    def determinant(M: float) -> float:
        a, b = 1j * (-M / 2 + sqrt(M**2 / 4 - tension)), 1j * (-M / 2 - sqrt(M**2 / 4 - tension))
        rows = [[1, 0, 1, 1], [0, 1, a, b], [1, 1, np.exp(a), np.exp(b)], [0, 1, a * np.exp(a), b * np.exp(b)]]
        return float((np.linalg.det(np.array(rows)) * np.exp(0.5j * M)).imag)

    return float(brentq(determinant, 2.0 * sqrt(tension) + 1.0, max(9.5, 2.0 * sqrt(tension) + 4.0)))


@pytest.mark.parametrize("twist", [0.0, 20.0])
@pytest.mark.parametrize("tension", [0.01, 20.0])
def test_a_wrung_rod_buckles_by_greenhills_torque(twist: float, tension: float) -> None:
    """However its section turns along it; between clamps, without tension, M L/EJ = 8.987."""
    scene = scene_of(CLAMP, SLIDER)
    assert _torque(0.01) == pytest.approx(8.987, rel=1e-3)
    found = critical(lambda torque: lowest(scene, twist, torque * EJ / LENGTH, tension * EJ / LENGTH**2), 1.0, 40.0)
    assert found == pytest.approx(_torque(tension), rel=5e-3)


def test_a_tape_buckles_about_its_softer_axis() -> None:
    tape = replace(ROD, stiffness=(Curve.constant(9.0 * EJ), *ROD.stiffness[1:]))
    scene = scene_of(CLAMP, FREE_END, tape)
    found = critical(lambda load: lowest(scene, f=-load * EJ / LENGTH**2), 1.0, 20.0)
    assert found == pytest.approx(pi**2 / 4, rel=2e-3)


@pytest.mark.parametrize("p", [0, 1])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_ruler_on_edge_tips_over_by_prandtls_load(p: int, sign: float) -> None:
    """4.013 sqrt(EJ GJ) / L^2 on its free end, where it does not bend in its plane."""
    stiffness = [Curve.constant(EJ), Curve.constant(EJ), ROD.stiffness[2]]
    stiffness[p] = Curve.constant(1e4 * EJ)
    across_the_end = PointLoad(LENGTH, constant_vector(tuple(np.eye(3)[1 - p])))  # type: ignore[arg-type]
    scene = scene_of(CLAMP, FREE_END, replace(ROD, stiffness=tuple(stiffness)), points=(across_the_end,))
    transverse = Transverse.of(scene)
    assert transverse is not None and transverse.p == p

    def falls(load: float) -> float:
        q, f = np.zeros((101, 3)), np.zeros((101, 3))
        f[:, 1 - p], q[:, p] = load, sign * load * (LENGTH - S)
        state = state_of(Initial.straight(), 0.0 * q, q, f)
        return float(np.linalg.eigvalsh(transverse.stiffness(S, state))[0])

    unit = sqrt(EJ * GJ) / LENGTH**2
    assert critical(falls, unit, 10.0 * unit) == pytest.approx(4.013 * unit, rel=2e-3)


def test_an_arc_at_rest_falls_nowhere() -> None:
    """Without stress, however it is bent."""
    transverse = Transverse.of(Scene(ARC_ROD, ARC, CLAMP, FREE_END, 1.0, 0.1))
    assert transverse is not None and transverse.p != STRAIGHT
    none = np.zeros((101, 3))
    assert np.linalg.eigvalsh(transverse.stiffness(S, state_of(ARC, none, none, none)))[0] > 0.0


@pytest.mark.parametrize(("damping", "expected"), [(0.0, 1.0), (1.5, 0.5)])
@pytest.mark.parametrize("steps", [4, 40])
def test_a_disturbance_grows_as_the_mode_of_a_column(damping: float, expected: float, steps: int) -> None:
    """Between pins under twice Euler's load by pi^2 sqrt(EJ / m) / L^2, in which the damping is given."""
    unit = pi**2 * sqrt(EJ / MASS) / LENGTH**2
    transverse = Transverse.of(scene_of(PIN, PIN))
    assert transverse is not None
    K = transverse.straight(S, 0.0 * S, 0.0 * S, -2.0 * pi**2 * EJ / LENGTH**2 + 0.0 * S)
    disturbance = Disturbance(transverse, damping * unit)
    growth = []
    for t in (50.0, 50.0):
        for _ in range(steps):
            disturbance.go_on(t / unit / steps, K)
        growth.append(disturbance.growth)
    assert growth[1] - growth[0] == pytest.approx(50.0 * expected, rel=5e-3)
    disturbance.go_on(1.0, transverse.straight(S, 0.0 * S, 0.0 * S, 0.0 * S))
    assert disturbance.growth == growth[1]


def test_it_is_not_asked_where_loads_turn_or_something_else_holds_the_rod() -> None:
    push = Condition("load", Curve.constant(-1.0))
    following, guided = End((FREE, FREE, (push,)), (FREE,) * 3), End((FIXED, FIXED, (push,)), (FIXED,) * 3)
    for end in (FREE_END, guided, replace(following, frame="lab")):
        assert axis_kept(scene_of(CLAMP, end)) == STRAIGHT
    assert axis_kept(scene_of(CLAMP, FREE_END, gravity=(0.0, 1.0, 0.0))) == 0
    assert axis_kept(scene_of(CLAMP, FREE_END, gravity=(1.0, 1.0, 0.0))) is None
    assert axis_kept(scene_of(CLAMP, following)) is None
    assert axis_kept(scene_of(CLAMP, FREE_END, loads=(Floor(1.0),))) is None
    assert axis_kept(scene_of(CLAMP, FREE_END, points=(PointLoad(0.5 * LENGTH, frame="material"),))) is None
