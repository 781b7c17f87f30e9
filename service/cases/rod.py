"""The rod of a case: its length and section."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Discriminator, Tag, model_validator

from service.cases.errors import refusal
from service.cases.quantities import Positive, PositiveProfile, Profile, ProfileTriple, Spec, curve, curves
from service.meaning import means
from solver import Rod
from solver.physics.elasticity import (
    Coupling,
    Locking,
    Softening,
    Stretch,
    TwistStretch,
    Viscosity,
    elasticity_of,
)
from solver.scene.rod import Profiles


def _one_or_two(value: Any) -> str:
    return "<pair>" if isinstance(value, (list, tuple)) else "<one>"


def _three_or_word(value: Any) -> str:
    return "<word>" if isinstance(value, str) else "<three>"


Bending = Annotated[
    Annotated[PositiveProfile, Tag("<one>")]
    | Annotated[tuple[PositiveProfile, PositiveProfile], Tag("<pair>")],
    Discriminator(_one_or_two),
]
StressFree = Annotated[
    Annotated[ProfileTriple, Tag("<three>")] | Annotated[Literal["initial"], Tag("<word>")],
    Discriminator(_three_or_word),
]


NO_COUPLING = (0.0, 0.0, 0.0)


class RodSpec(Spec):
    """A rod of solid circular section, or with section properties given directly. It stretches where that is asked for.

    A property given directly takes the place of the modulus or density that it would follow from.
    """

    length: Annotated[Positive, means("L, along the centreline", "m")]
    diameter: Annotated[
        PositiveProfile,
        means("profile; what fluid and contact see: of a tape its width in a flow, its thickness in contact", "m"),
    ]
    youngs_modulus: Annotated[Positive | None, means("E; this or `bending_stiffness`, not both", "Pa")] = None
    shear_modulus: Annotated[Positive | None, means("G; this or `torsional_stiffness`, not both", "Pa")] = None
    density: Annotated[
        Positive | None,
        means("of a solid section, whose mass and inertia it gives where they are not given themselves", "kg/m³"),
    ] = None
    bending_stiffness: Annotated[
        Bending | None, means("EJ: one profile, or two, EJ1 about a1 and EJ2 about a2", "N m²")
    ] = None
    torsional_stiffness: Annotated[PositiveProfile | None, means("GJ: profile", "N m²")] = None
    coupling: Annotated[
        ProfileTriple,
        means("K23, K13, K12: three profiles, what couples torsion with bending about a2 and about a1, and these two",
              "N m²"),
    ] = NO_COUPLING  # fmt: skip
    sticking_stiffness: Annotated[
        PositiveProfile | None,
        means("EJ: profile, by which bending is stiffer until layers slip; beside `slip_curvature`", "N m²"),
    ] = None
    slip_curvature: Annotated[
        PositiveProfile | None, means("profile, the curvature about which layers that stick come to slip", "1/m")
    ] = None
    locking_stiffness: Annotated[
        PositiveProfile | None,
        means("EJ: profile, by which bending is stiffer beyond `locking_curvature`; of bend restrictors", "N m²"),
    ] = None
    locking_curvature: Annotated[
        PositiveProfile | None, means("profile, the inverse of the radius at which bending locks", "1/m")
    ] = None
    axial_stiffness: Annotated[
        PositiveProfile | None,
        means("EA: profile; without it the rod cannot stretch. For `staggered` and static analyses", "N"),
    ] = None
    twist_stretch_coupling: Annotated[
        Profile,
        means("g: profile, what couples torsion with stretch; beside `axial_stiffness`, and smaller than √(EA GJ). "
              "Where it is negative, as DNA's, a pull winds the rod up", "N m"),
    ] = 0.0  # fmt: skip
    retardation_time: Annotated[
        PositiveProfile | None,
        means("profile, by which the material resists its own bending and twisting. For `staggered`", "s"),
    ] = None
    mass_per_length: Annotated[PositiveProfile | None, means("profile", "kg/m")] = None
    inertia_per_length: Annotated[
        tuple[PositiveProfile, PositiveProfile, PositiveProfile] | None,
        means("three profiles, about a1, a2, a3; without it that of a solid section", "kg m"),
    ] = None
    kappa0: Annotated[
        StressFree,
        means('curvature and twist that are free of stress: three profiles, or `"initial"` for those of the initial '
              "shape", "rad/m"),
    ] = (0.0, 0.0, 0.0)  # fmt: skip

    @model_validator(mode="after")
    def _check(self) -> Self:
        for general, direct in (
            ("youngs_modulus", "bending_stiffness"),
            ("shear_modulus", "torsional_stiffness"),
        ):
            present = [name for name in (general, direct) if getattr(self, name) is not None]
            if len(present) != 1:
                raise refusal(general, getattr(self, general), f"or {direct} must be given, and not both")
        if self.density is None and self.mass_per_length is None:
            raise refusal("density", None, "must be given, or mass_per_length in its place")
        if None not in (self.density, self.mass_per_length, self.inertia_per_length):
            raise refusal("density", self.density, "must not be given beside mass_per_length and inertia_per_length")
        if self.twist_stretch_coupling != 0.0 and self.axial_stiffness is None:
            rule = "must be 0 without axial_stiffness: only a rod that can stretch has it"
            raise refusal("twist_stretch_coupling", self.twist_stretch_coupling, rule)
        for pair in (("sticking_stiffness", "slip_curvature"), ("locking_stiffness", "locking_curvature")):
            present = [name for name in pair if getattr(self, name) is not None]
            if len(present) == 1:
                (missing,) = {*pair} - {*present}
                raise refusal(missing, None, f"must be given beside {present[0]}")
        return self

    def build(self) -> Rod:
        """The solver's rod; `kappa0` "initial" is left to the scene, which knows the initial shape.

        Raises ValueError where a property is not > 0, or the stiffness is not positive definite.
        """
        solid = Rod.circular(
            self.length,
            curve(self.diameter),
            self.youngs_modulus or 1.0,
            self.shear_modulus or 1.0,
            self.density or 1.0,
        )
        direct: dict[str, Any] = {"stiffness": self._stiffness(solid)}
        if self.mass_per_length is not None:
            direct["mass"] = curve(self.mass_per_length)
            if self.density is None:
                direct["inertia"] = Rod.solid_inertia(direct["mass"], solid.diameter)
        if self.inertia_per_length is not None:
            direct["inertia"] = curves(self.inertia_per_length)
        direct["laws"] = self._laws()
        if self.kappa0 != "initial":
            direct["kappa0"] = curves(self.kappa0)
        rod = replace(solid, **direct)
        elasticity_of(rod, np.linspace(0.0, self.length, 201))
        return rod

    def _laws(self) -> tuple[object, ...]:
        """Other laws of elasticity."""
        laws: list[object] = []
        if self.coupling != NO_COUPLING:
            first, second, third = curves(self.coupling)
            laws.append(Coupling(first, second, third))
        if self.sticking_stiffness is not None and self.slip_curvature is not None:
            laws.append(Softening(curve(self.sticking_stiffness), curve(self.slip_curvature)))
        if self.locking_stiffness is not None and self.locking_curvature is not None:
            laws.append(Locking(curve(self.locking_stiffness), curve(self.locking_curvature)))
        if self.axial_stiffness is not None:
            laws.append(Stretch(curve(self.axial_stiffness)))
        if self.twist_stretch_coupling != 0.0:
            laws.append(TwistStretch(curve(self.twist_stretch_coupling)))
        if self.retardation_time is not None:
            laws.append(Viscosity(curve(self.retardation_time)))
        return tuple(laws)

    def _stiffness(self, solid: Rod) -> Profiles:
        """EJ1, EJ2, GJ3: those given directly, else those of the solid section."""
        first, second, third = solid.stiffness
        if isinstance(self.bending_stiffness, tuple):
            first, second = (curve(stiffness) for stiffness in self.bending_stiffness)
        elif self.bending_stiffness is not None:
            first = second = curve(self.bending_stiffness)
        if self.torsional_stiffness is not None:
            third = curve(self.torsional_stiffness)
        return first, second, third
