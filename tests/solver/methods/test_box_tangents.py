"""The analytic Jacobian of the box method against central differences, term by term."""

from __future__ import annotations

import numpy as np
import pytest

from solver import Contact, Fluid, UserLoad
from solver.arrays import Array
from tests.solver.methods.problem import Problem, problem

N = 12
RANDOM = np.random.default_rng(7)
LARGEST_ERROR = 1e-7
"""Relative to the row's largest entry; central differences of step 1e-6 err by about 1e-8 themselves."""


def error(case: Problem) -> float:
    """The largest difference of the two Jacobians, relative to each row's largest entry."""
    analytic, differences = case.matrix(), case.differences()
    return float((np.abs(analytic - differences).max(axis=1) / np.abs(analytic).max(axis=1)).max())


DENSITY = 1000.0
"""Of a fluid, kg/m^3."""


class Bed(UserLoad):
    """A bed that is pressed in, and rubs."""

    account = "lost"

    def force(self, t: float, s: Array, r: Array, V: Array) -> Array:
        depth = 0.05 - r[:, 2:]
        return np.where(depth > 0.0, 40.0 * depth**2 * (np.array([0.0, 0.0, 1.0]) - 0.3 * V), 0.0)


TERMS: dict[str, dict[str, object]] = {
    "inertia and elasticity alone": {},
    "weight": {"gravity": (1.0, -2.0, 3.0)},
    "dead forces and moments": {"dead": RANDOM.normal(size=(2, N + 1, 3))},
    "following forces and moments": {"following": RANDOM.normal(size=(2, N + 1, 3))},
    "damping": {"damping": 3.0},
    "added mass": {"fluid": Fluid(DENSITY, added_mass=1.0)},
    "normal drag": {"fluid": Fluid(DENSITY, drag_normal=0.2)},
    "tangential drag": {"fluid": Fluid(DENSITY, drag_tangential=0.06)},
    "drag in a current": {"fluid": Fluid(DENSITY, 1.0, 0.2, 0.016, (0.1, -0.2, 0.3))},
    "a user's load by place and velocity": {"others": (Bed(),)},
}  # fmt: skip


@pytest.mark.parametrize("term", TERMS)
def test_the_tangents_of_a_term_are_its_derivatives(term: str) -> None:
    assert error(problem(N, **TERMS[term])) <= LARGEST_ERROR  # type: ignore[arg-type]


@pytest.mark.parametrize("translation", [0, 1, 2, 3])
@pytest.mark.parametrize("rotation", [0, 1])
def test_the_tangents_of_an_end_condition_are_its_derivatives(translation: int, rotation: int) -> None:
    kinds = np.array([translation] * 3 + [rotation] * 3)
    assert error(problem(N, kinds=(kinds, kinds))) <= LARGEST_ERROR


def test_the_tangents_of_mixed_end_conditions_are_their_derivatives() -> None:
    kinds = np.array([0, 1, 0, 1, 0, 1]), np.array([3, 2, 3, 0, 1, 1])
    assert error(problem(N, kinds=kinds)) <= LARGEST_ERROR


@pytest.mark.parametrize("rho_inf_space", [0.0, 0.5, 0.9])
def test_the_tangents_of_generalized_alpha_in_space_are_its_derivatives(rho_inf_space: float) -> None:
    terms = {**TERMS["drag in a current"], **TERMS["following forces and moments"]}
    assert error(problem(N, rho_inf_space=rho_inf_space, **terms)) <= LARGEST_ERROR  # type: ignore[arg-type]


@pytest.mark.parametrize("damping", [0.0, 1e-2])
def test_the_tangents_of_contact_are_its_derivatives(damping: float) -> None:
    contact = Contact(k1=1e-7, k2=3.0, k3=damping, k4=1.0, aperture=np.radians(100), cutoff=0.013, skip=0.06,
                      spacing=0.004)  # fmt: skip
    case = problem(24, contact=contact)
    case.residual()
    assert case.contact.pressing > 20
    assert error(case) <= LARGEST_ERROR
