"""Elasticity with coupling: the moment, and what a coupled rod does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from service.cases import CaseError, apply_settings, load_case, parse_case
from solver import FREE, Condition, Curve, End, Fluid, Frame, Initial, Numerics, Rod, Scene, simulate
from solver.methods.registry import discretized
from solver.physics.elasticity import Coupling, add_strain, elasticity_of, moments
from tests.solver.methods.problem import problem
from tests.solver.methods.test_box_tangents import LARGEST_ERROR, error
from tests.solver.scenes import EJ, GJ, LENGTH, ROD

METHODS = ["box", "staggered"]
K23, K13 = 0.4 * min(EJ, GJ), -0.3 * min(EJ, GJ)
COUPLED = replace(ROD, laws=(Coupling(Curve.constant(K23), Curve.constant(K13)),))
K = np.array([[EJ, 0.0, K13], [0.0, EJ, K23], [K13, K23, GJ]])


def last(scene: Scene) -> Frame:
    *_, frame = simulate(scene)
    return frame


def test_the_moment_is_linear_in_the_strain() -> None:
    strain = np.array([[0.3, -0.2, 0.5]])
    assert_allclose(moments(elasticity_of(COUPLED, np.array([0.3])), strain), strain @ K, rtol=1e-12)


def test_strains_are_those_of_the_moments() -> None:
    elastic, kappa = elasticity_of(COUPLED, np.array([0.0, LENGTH])), np.array([[1.0, -2.0, 3.0], [0.5, 0.0, -4.0]])
    strain = np.zeros((2, 3))
    for j, q in enumerate(moments(elastic, kappa)):
        add_strain(elastic, j, (*map(float, q),), strain[j])
    assert_allclose(strain, kappa - elastic.kappa0, rtol=1e-14)


def test_a_law_that_nobody_knows_is_refused() -> None:
    with pytest.raises(TypeError, match="law of elasticity"):
        elasticity_of(replace(ROD, laws=("rubber",)), np.array([0.0]))


def test_a_stiffness_that_would_give_energy_is_refused() -> None:
    rod = replace(ROD, laws=(Coupling(Curve.constant(2.0 * max(EJ, GJ))),))
    with pytest.raises(ValueError, match="positive definite"):
        elasticity_of(rod, np.array([0.0]))
    raw = apply_settings(load_case("free-flight"), {"rod.coupling": [1e6, 0.0, 0.0]})
    with pytest.raises(CaseError, match="positive definite"):
        parse_case(raw)


@pytest.mark.parametrize("analysis", ["static", "dynamic"])
@pytest.mark.parametrize("method", METHODS)
def test_a_twisting_moment_bends_a_coupled_rod(method: str, analysis: str) -> None:
    """Small moments are the same along the rod, and so is the strain, K^-1 q."""
    moment = 1e-3 * GJ / LENGTH
    slowly = Curve.table([0.0, 8.0], [0.0, moment], "smoothstep")
    end = End((FREE, FREE, FREE), (FREE, FREE, (Condition("load", slowly),)))
    numerics = Numerics(method=method, intervals=20, dt_max=0.05)  # type: ignore[arg-type]
    scene = Scene(COUPLED, Initial.straight(), End.clamp(), end, 30.0, 30.0, numerics=numerics, damping=1.0,
                  analysis=analysis)  # type: ignore[arg-type]  # fmt: skip
    expected = np.linalg.solve(K, [0.0, 0.0, moment])
    assert abs(expected[0]) > 0.1 * expected[2]
    assert_allclose(last(scene).kappa, np.tile(expected, (21, 1)), atol=2e-3 * expected[2])


@pytest.mark.parametrize("method", METHODS)
def test_the_work_on_a_coupled_rod_is_its_energy(method: str) -> None:
    numerics = Numerics(method=method, intervals=20, dt_max=0.002, rho_inf=1.0)  # type: ignore[arg-type]
    turned = Curve.table([0.0, 1.0], [0.0, 0.5 * GJ / LENGTH], "smoothstep")
    end = End((FREE, FREE, FREE), (FREE, FREE, (Condition("load", turned),)))
    frames = list(simulate(Scene(COUPLED, Initial.straight(), End.clamp(), end, 1.0, 0.1, numerics=numerics)))
    stored = max(frame.energy_bending + frame.energy_torsion for frame in frames)
    assert max(frame.energy_kinetic for frame in frames) > 0.01 * stored
    assert max(abs(frame.energy_balance) for frame in frames) < 1e-4 * stored


def test_the_box_method_has_the_tangents_of_coupling(monkeypatch: pytest.MonkeyPatch) -> None:
    import tests.solver.methods.problem as module

    plain = module.rod

    def coupled(diameter: float) -> Rod:
        rod = plain(diameter)
        small = 0.3 * float(rod.stiffness[2](np.zeros(1))[0])
        return replace(rod, laws=(Coupling(*(Curve.constant(part * small) for part in (1.0, -0.7, 0.4))),))

    monkeypatch.setattr(module, "rod", coupled)
    assert error(problem(12, fluid=Fluid(1000.0, 1.0, 0.2, 0.1))) <= LARGEST_ERROR


def test_a_coupled_rod_turns_in_space() -> None:
    scene = Scene(COUPLED, Initial.straight(), End.clamp(), End.free(), 1.0, 1.0,
                  numerics=Numerics(method="staggered", intervals=4))  # fmt: skip
    assert type(discretized(scene)).__name__ == "StaggeredMethod"
