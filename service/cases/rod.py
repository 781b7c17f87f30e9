"""The rod of a case: its length and section."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Tag, model_validator

from service.cases.errors import refusal
from service.cases.quantities import Positive, PositiveProfile, ProfileTriple, Spec, curve, curves
from solver import Rod
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


class RodSpec(Spec):
    """An inextensible rod of solid circular section, or with section properties given directly.

    `length`, `diameter` in m; `youngs_modulus`, `shear_modulus` in Pa; `density` in kg/m^3. Given
    directly: `bending_stiffness` EJ (one, or EJ1 and EJ2) and `torsional_stiffness` GJ in N m^2,
    `mass_per_length` in kg/m, `inertia_per_length` about a1, a2, a3 in kg m. A property given directly
    takes the place of the modulus or density that it would follow from. `kappa0`: stress-free
    curvature-twist in rad/m, or "initial": the initial shape is free of stress.
    """

    length: Positive
    diameter: PositiveProfile
    youngs_modulus: Positive | None = None
    shear_modulus: Positive | None = None
    density: Positive | None = None
    bending_stiffness: Bending | None = None
    torsional_stiffness: PositiveProfile | None = None
    mass_per_length: PositiveProfile | None = None
    inertia_per_length: tuple[PositiveProfile, PositiveProfile, PositiveProfile] | None = None
    kappa0: StressFree = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        for general, direct in (
            ("youngs_modulus", "bending_stiffness"),
            ("shear_modulus", "torsional_stiffness"),
        ):
            given = [name for name in (general, direct) if getattr(self, name) is not None]
            if len(given) != 1:
                raise refusal(general, getattr(self, general), f"or {direct} must be given, and not both")
        direct_mass = self.mass_per_length is not None and self.inertia_per_length is not None
        if direct_mass == (self.density is not None):
            rule = "must be given, or both mass_per_length and inertia_per_length in its place"
            raise refusal("density", self.density, rule)
        return self

    def build(self) -> Rod:
        """The solver's rod; `kappa0` "initial" is left to the scene, which knows the initial shape.

        Raises ValueError where a property is not > 0.
        """
        solid = Rod.circular(
            self.length,
            curve(self.diameter),
            self.youngs_modulus or 1.0,
            self.shear_modulus or 1.0,
            self.density or 1.0,
        )
        given: dict[str, Any] = {"stiffness": self._stiffness(solid)}
        if self.mass_per_length is not None:
            given["mass"] = curve(self.mass_per_length)
        if self.inertia_per_length is not None:
            given["inertia"] = curves(self.inertia_per_length)
        if self.kappa0 != "initial":
            given["kappa0"] = curves(self.kappa0)
        return replace(solid, **given)

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
