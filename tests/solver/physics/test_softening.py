"""Bending that softens when layers slip."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from service.cases import CaseError, apply_settings, build_scene, load_case, parse_case
from solver import FREE, Condition, Curve, End, Initial, Numerics, Rod, Scene, simulate
from solver.arrays import Array
from solver.methods.registry import discretized
from solver.physics.elasticity import Softening, add_strain, elasticity_of, moments, principal
from tests.solver.methods import problem as box
from tests.solver.methods.test_box_tangents import LARGEST_ERROR, error
from tests.solver.methods.test_staggered_tangents import check_rotation
from tests.solver.methods.test_staggered_tangents import problem as staggered_problem
from tests.solver.scenes import EJ, GJ, LENGTH, ROD, last

METHODS = ["box", "staggered"]
STICKING, SLIP = 3.0 * EJ, 0.5 / LENGTH
LAYERED = replace(ROD, laws=(Softening(Curve.constant(STICKING), Curve.constant(SLIP)),))
BEND = 2.0 / LENGTH


def moment(bend: Array | float) -> Array:
    """Of a rod that is bent by `bend`."""
    return np.asarray((EJ + STICKING / np.sqrt(1.0 + (np.asarray(bend) / SLIP) ** 2)) * bend)


def energy(bend: float) -> float:
    """Of the whole rod."""
    return float(0.5 * EJ * bend**2 + STICKING * SLIP**2 * (np.sqrt(1.0 + (bend / SLIP) ** 2) - 1.0)) * LENGTH


def coupled_end(axis: int = 0, value: float = float(moment(BEND)), rise: float = 8.0) -> Scene:
    """A straight cantilever, bent to a part of a circle by a moment at its end; `axis`: a1 or a2."""
    load = Condition("load", Curve.table([0.0, rise], [0.0, value], "smoothstep"))
    end = End((FREE, FREE, FREE), ((load,), FREE, FREE) if axis == 0 else (FREE, (load,), FREE))
    return Scene(LAYERED, Initial.straight(), End.clamp(), end, 30.0, 30.0, damping=1.0)


def test_the_moment_is_that_of_the_law() -> None:
    bend = np.array([0.0, 0.01, 0.3, 2.0, 40.0]) / LENGTH
    elastic = elasticity_of(LAYERED, np.linspace(0.0, LENGTH, 5))
    q = moments(elastic, np.stack([0.6 * bend, -0.8 * bend, np.ones(5)], axis=1))
    assert_allclose(0.6 * q[:, 0] - 0.8 * q[:, 1], moment(bend))
    assert_allclose(q[:, 2], GJ)
    assert_allclose(principal(elastic)[0], [EJ + STICKING, EJ + STICKING, GJ])


def test_strains_are_those_of_the_moments() -> None:
    elastic, kappa = elasticity_of(LAYERED, np.zeros(1)), np.array([[1.0, -2.0, 3.0]])
    off = kappa + 1e-4
    q = (moments(elastic, kappa) - moments(elastic, off))[0]
    add_strain(elastic, 0, (*map(float, q),), off[0])
    assert_allclose(off, kappa, rtol=1e-7)


@pytest.mark.parametrize("analysis", ["static", "dynamic"])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("axis", [0, 1])
def test_a_moment_bends_a_cantilever_to_a_circle(method: str, analysis: str, axis: int) -> None:
    numerics = Numerics(method=method, intervals=20, dt_max=0.05)  # type: ignore[arg-type]
    frame = last(replace(coupled_end(axis), numerics=numerics, analysis=analysis))  # type: ignore[type-var]
    assert_allclose(np.abs(frame.kappa[:, axis]), BEND, rtol=2e-3)
    assert_allclose(np.abs(frame.q[:, axis]), moment(BEND), rtol=2e-3)
    assert frame.energy_bending == pytest.approx(energy(BEND), rel=2e-3)


def imbalance(method: str, intervals: int) -> float:
    """The largest energy out of balance, over the largest that is stored, of a rod that is bent in half a period."""
    numerics = Numerics(method=method, intervals=intervals, dt_max=0.002, rho_inf=1.0)  # type: ignore[arg-type]
    scene = replace(coupled_end(rise=1.0), t_end=1.0, output_interval=0.1, damping=0.0, numerics=numerics)
    frames = list(simulate(scene))
    stored = max(frame.energy_bending for frame in frames)
    assert max(frame.energy_kinetic for frame in frames) > 0.01 * stored
    return max(abs(frame.energy_balance) for frame in frames) / stored


def test_the_work_on_the_rod_is_its_energy() -> None:
    assert imbalance("staggered", 20) < 1e-4


def test_the_box_method_balances_it_to_the_square_of_an_interval() -> None:
    """Its moment is the mean of two nodes': that of their mean strain only where the law is linear."""
    coarse, fine = imbalance("box", 20), imbalance("box", 40)
    assert fine < 2e-4
    assert coarse / fine == pytest.approx(4.0, rel=0.3)


def softened(rod: Rod) -> Rod:
    """A rod whose layers slip about as it is bent."""
    stiffness = rod.stiffness[0]
    return replace(rod, laws=(Softening(stiffness, Curve.constant(3.0)),))


def test_the_box_method_has_its_tangents(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = box.rod
    monkeypatch.setattr(box, "rod", lambda diameter: softened(plain(diameter)))
    assert error(box.problem(12)) <= LARGEST_ERROR


def test_the_staggered_method_has_its_tangents() -> None:
    check_rotation(staggered_problem("all of them", "free", rod=softened(ROD)))


def test_in_a_plane_it_turns_about_one_axis_and_does_the_same() -> None:
    scene = replace(coupled_end(rise=1.0), t_end=1.0, output_interval=1.0,
                    numerics=Numerics(method="staggered", intervals=20, dt_max=0.01))  # fmt: skip
    assert type(discretized(scene)).__name__ == "OneAxisMethod"
    out_of_it = replace(scene, gravity=(1e-9, 0.0, 0.0))
    assert type(discretized(out_of_it)).__name__ == "StaggeredMethod"
    plane, space = last(scene), last(out_of_it)
    assert_allclose(plane.r, space.r, atol=1e-6 * LENGTH)
    assert_allclose(plane.q, space.q, atol=1e-5 * float(moment(BEND)))
    assert plane.energy_bending == pytest.approx(space.energy_bending, rel=1e-5)


def test_a_case_has_both_or_neither() -> None:
    layers = {"rod.sticking_stiffness": 2.0, "rod.slip_curvature": 0.1}
    (law,) = build_scene(parse_case(apply_settings(load_case("free-flight"), layers))).rod.laws
    assert isinstance(law, Softening)
    for name in layers:
        with pytest.raises(CaseError, match="must be given with sticking_stiffness and slip_curvature"):
            parse_case(apply_settings(load_case("free-flight"), {name: 2.0}))
