"""The rod: its length and its section properties along s."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi

import numpy as np

from solver.arrays import Array
from solver.scene.curve import Curve, corners_of
from solver.scene.view import NONE, View, answer

Profile = Callable[[Array], Array]
"""A property along the rod: maps arclengths s (n,) in m to values (n,). A `Curve` is one.

Where it has `corners`, arclengths between which it is smooth, as a table's points, what lies between the nodes of a
mesh counts as well; without them it is taken to be smooth.
"""

Profiles = tuple[Profile, Profile, Profile]

NO_CURVATURE: Profiles = (Curve.constant(0.0), Curve.constant(0.0), Curve.constant(0.0))


class Derived:
    """A property that follows by a `law` from others at the same place."""

    def __init__(self, law: Callable[..., Array], *profiles: Profile) -> None:
        self._law, self._profiles = law, profiles
        self.corners = corners_of(*profiles)
        """See `Profile`."""

    def __call__(self, s: Array) -> Array:
        """Its values at arclengths s (n,)."""
        return self._law(*(profile(s) for profile in self._profiles))


@dataclass(frozen=True)
class Rod:
    """An unshearable Kirchhoff rod, inextensible but for a law of stretch (Goyal, Perkins & Lee 2003, eq. (1), tables
    1, 2).

    `stiffness` is (EJ1, EJ2, GJ3) in N m^2, `mass` is rho_c A in kg/m, `inertia` the mass moment of
    inertia per length about (a1, a2, a3) in kg m, `diameter` in m is what the fluid and the contact
    see, `kappa0` the stress-free curvature-twist in rad/m, all along s in [0, length].
    """

    length: float
    stiffness: Profiles
    mass: Profile
    inertia: Profiles
    diameter: Profile
    kappa0: Profiles = NO_CURVATURE
    laws: tuple[object, ...] = ()
    """Other laws of elasticity, of the kinds that `physics.elasticity` knows."""

    def __post_init__(self) -> None:
        if not (np.isfinite(self.length) and self.length > 0):
            raise ValueError(f"length must be > 0 m, got {self.length}")
        corners = [s for s in (*self.corners, *corners_of(*self.kappa0)) if 0.0 < s < self.length]
        s = np.union1d(np.linspace(0.0, self.length, 201), corners)
        named = [("diameter", self.diameter), ("mass", self.mass)]
        named += [(f"stiffness[{i}]", p) for i, p in enumerate(self.stiffness)]
        named += [(f"inertia[{i}]", p) for i, p in enumerate(self.inertia)]
        for name, profile in named:
            lowest = float(np.min(profile(s)))
            if not lowest > 0:
                raise ValueError(f"{name} must be > 0 everywhere along the rod, got {lowest}")
        for i, profile in enumerate(self.kappa0):
            values = np.asarray(profile(s))
            if not np.isfinite(values).all():
                wrong = values[~np.isfinite(values)][0]
                raise ValueError(f"kappa0[{i}] must be finite everywhere along the rod, got {wrong}")

    @property
    def corners(self) -> tuple[float, ...]:
        """Of its section properties, all but `kappa0`: see `Profile`."""
        of_laws = (value for law in self.laws for value in getattr(law, "__dict__", {}).values())
        return corners_of(*self.stiffness, self.mass, *self.inertia, self.diameter, *of_laws)

    def keeps(self, view: View) -> bool:
        """Whether the rod is free of stress along the motion about an axis."""
        kappa0 = view.along(self.kappa0)
        return bool(np.abs(kappa0[:, ~view.turns]).max() * self.length <= NONE) and answer(self.laws, view)

    @staticmethod
    def solid_inertia(mass: Profile, diameter: Profile) -> Profiles:
        """Of a solid circular section: m D^2/16 about a diameter, m D^2/8 about the axis."""

        def times(factor: float) -> Profile:
            return Derived(lambda mass, diameter: factor * mass * diameter**2, mass, diameter)

        return times(1.0 / 16.0), times(1.0 / 16.0), times(1.0 / 8.0)

    @classmethod
    def circular(
        cls,
        length: float,
        diameter: Profile | float,
        youngs_modulus: float,
        shear_modulus: float,
        density: float,
        kappa0: Profiles = NO_CURVATURE,
    ) -> Rod:
        """A solid circular section: A = pi D^2/4, J1 = J2 = A D^2/16, J3 = A D^2/8, I = rho_c J."""
        width: Profile = Curve.constant(diameter) if isinstance(diameter, (int, float)) else diameter
        for name, value in (("youngs_modulus", youngs_modulus), ("shear_modulus", shear_modulus), ("density", density)):
            if not (np.isfinite(value) and value > 0):
                raise ValueError(f"{name} must be > 0, got {value}")

        def area(factor: float) -> Profile:
            return Derived(lambda width: factor * pi / 4 * width**2, width)

        def second_moment(factor: float) -> Profile:
            return Derived(lambda width: factor * pi / 64 * (width**2) ** 2, width)

        bending, torsion, mass = second_moment(youngs_modulus), second_moment(2 * shear_modulus), area(density)
        return cls(
            length=length,
            stiffness=(bending, bending, torsion),
            mass=mass,
            inertia=cls.solid_inertia(mass, width),
            diameter=width,
            kappa0=kappa0,
        )
