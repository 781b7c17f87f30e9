"""The rod: section properties, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from math import inf, nan, pi
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from solver.scene.curve import Curve
from solver.scene.rod import Rod

S = np.linspace(0.0, 1.0, 11)
ONE = Curve.constant(1.0)


def uniform(**properties: object) -> Rod:
    rod = Rod(length=1.0, stiffness=(ONE, ONE, ONE), mass=ONE, inertia=(ONE, ONE, ONE), diameter=ONE)
    return replace(rod, **properties)


def test_a_circular_section_has_the_properties_of_the_papers_tables() -> None:
    """Goyal, Perkins & Lee 2003: A = pi D^2/4, J1 = J2 = A D^2/16, J3 = A D^2/8, I = rho_c J."""
    E, G, rho, D = 1.25e7, 5e6, 1500.0, 0.01
    rod = Rod.circular(1.0, D, E, G, rho)
    A = pi * D**2 / 4
    J1, J3 = A * D**2 / 16, A * D**2 / 8
    assert_allclose(rod.mass(S), rho * A, rtol=1e-14)
    for profile, value in zip(rod.stiffness, (E * J1, E * J1, G * J3), strict=True):
        assert_allclose(profile(S), value, rtol=1e-14)
    for profile, value in zip(rod.inertia, (rho * J1, rho * J1, rho * J3), strict=True):
        assert_allclose(profile(S), value, rtol=1e-14)
    assert_allclose(rod.diameter(S), D, rtol=1e-14)


def test_a_circular_section_may_vary_along_the_rod() -> None:
    D = Curve.table([0.0, 0.5, 1.0], [0.01, 0.008, 0.02])
    rod = Rod.circular(1.0, D, 2e9, 1e9, 1000.0)
    assert_allclose(rod.mass(S), 1000.0 * pi / 4 * D(S) ** 2, rtol=1e-14)
    assert_allclose(rod.stiffness[0](S), 2e9 * pi / 64 * D(S) ** 4, rtol=1e-14)
    assert_allclose(rod.stiffness[2](S), 1e9 * pi / 32 * D(S) ** 4, rtol=1e-14)
    assert_allclose(rod.inertia[1](S), 1000.0 * pi / 64 * D(S) ** 4, rtol=1e-14)


def test_a_rod_is_straight_when_free_of_stress_unless_told_otherwise() -> None:
    assert_allclose([profile(S) for profile in Rod.circular(1.0, 0.01, 1e7, 5e6, 1500.0).kappa0], 0.0)


def test_properties_given_directly_replace_those_of_the_section() -> None:
    rod = Rod.circular(1.0, 0.01, 1e7, 5e6, 1500.0)
    heavier = replace(rod, mass=Curve.constant(9.0))
    assert_allclose(heavier.mass(S), 9.0)
    assert heavier.stiffness is rod.stiffness


@pytest.mark.parametrize("length", [0.0, -1.0, nan, inf])
def test_a_length_that_is_not_positive_is_refused(length: float) -> None:
    with pytest.raises(ValueError, match=f"length must be > 0 m, got {length}"):
        uniform(length=length)


@pytest.mark.parametrize("name", ["diameter", "mass"])
def test_a_property_that_vanishes_somewhere_is_refused(name: str) -> None:
    somewhere = Curve.table([0.0, 0.5, 1.0], [1.0, -0.25, 1.0])
    with pytest.raises(ValueError, match=rf"^{name} must be > 0 everywhere along the rod, got -0\.25$"):
        uniform(**{name: somewhere})


@pytest.mark.parametrize("name", ["stiffness", "inertia"])
@pytest.mark.parametrize("component", [0, 1, 2])
def test_a_component_that_is_not_positive_is_refused(name: str, component: int) -> None:
    profiles = [ONE, ONE, ONE]
    profiles[component] = Curve.constant(0.0)
    with pytest.raises(ValueError, match=rf"{name}\[{component}\] must be > 0 everywhere .*, got 0\.0"):
        uniform(**{name: tuple(profiles)})


def test_a_property_that_is_not_a_number_is_refused() -> None:
    with pytest.raises(ValueError, match="mass must be > 0"):
        uniform(mass=lambda s: np.full_like(s, nan))


@pytest.mark.parametrize("name", ["youngs_modulus", "shear_modulus", "density"])
@pytest.mark.parametrize("value", [0.0, -2.0, nan, inf])
def test_a_material_constant_that_is_not_positive_is_refused(name: str, value: Any) -> None:
    material: dict[str, Any] = {"youngs_modulus": 1e7, "shear_modulus": 5e6, "density": 1500.0, name: value}
    with pytest.raises(ValueError, match=f"{name} must be > 0, got {value}"):
        Rod.circular(1.0, 0.01, **material)


def test_a_diameter_of_zero_is_refused() -> None:
    with pytest.raises(ValueError, match="diameter must be > 0"):
        Rod.circular(1.0, 0, 1e7, 5e6, 1500.0)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_natural_curvature_that_is_not_finite_is_refused(value: float) -> None:
    none = Curve.constant(0.0)
    with pytest.raises(ValueError, match=rf"^kappa0\[1\] must be finite everywhere along the rod, got {value}$"):
        Rod.circular(1.0, 0.01, 1e7, 5e6, 1500.0, kappa0=(none, lambda s: np.where(s > 0.5, value, 1.0), none))
