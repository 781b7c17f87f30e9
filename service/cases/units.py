"""What looks like a value in another unit: degrees, MPa, GPa, g/cm³, mm, or moduli that were swapped."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot, pi

import numpy as np

from service.cases.case import CaseSpec
from service.cases.errors import FieldError
from service.cases.extents import forces, times, widest
from service.cases.quantities import ProfileTable
from solver import Scene
from solver.physics.axial import LARGEST_STRAIN

MATERIALS = {"density": (10.0, 25e3), "youngs_modulus": (1e3, 2e12), "shear_modulus": (3e2, 1e12)}
"""kg/m³ and Pa: from foam and soft gels to osmium and diamond; DNA (1,700 kg/m³, 0.3 GPa) is well within."""
OTHER_UNITS = {
    "density": ((5e-10, 5e-8, "t/mm³"), (5e-7, 5e-5, "kg/mm³"), (0.1, 10.0, "g/cm³")),
    "youngs_modulus": ((0.1, 1e3, "MPa or GPa"),), "shear_modulus": ((0.03, 3e2, "MPa or GPa"),),
}  # fmt: skip
"""From what value on to which, below those of all materials, it is likely to be given in which unit."""
METAL, SLOWEST = 2500.0, 6.0
"""kg/m³ of the lightest metals and glass; and m/s at which sound runs in them, if their modulus is in MPa."""
SOFTEST = 1.0
"""Pa; a rope whose yarns slide on each other may bend a thousand times more easily than a gel."""
FOAM, SOLID = 25.0, 1e8
"""kg/m³ of foams, and Pa that no foam has."""
SWAPPED, FAR_APART = 1.5, 300.0
"""G / E, which is 1 for DNA and less than 1/2 for most materials; and E / G, which is some tens for fibres."""
TURNED_OVER = 4.0 * pi
"""Rotation (rad) of an end about an axis across the rod, beyond which it is likely to be in degrees."""
WATER = (0.95, 1.1)
"""g/cm³"""
GAS, RAPID, CREEPING = 100.0, 30.0, 5e-6
"""kg/m³ that no gas has; m/s of no current; and m, the diameter of a rod around which water flows at less than a
Reynolds number of 1 as long as it is slower than .2 m/s."""
EARTH = 9.81
"""m/s²; a gravity that is larger is doubted by itself."""
MUCH_SHEAR = 0.01
"""Shear strain of the surface by a twist, up to which turns are nothing special."""
EIGHTH = 45.0
"""Degrees; multiples of it are likely to be degrees."""


def units_of(spec: CaseSpec, scene: Scene) -> list[FieldError]:
    """What is likely to be in another unit than it should."""
    return [*([] if spec.rod.density == 1.0 else _material(spec, scene)),  # 1: the unit is the rod's own density
            *_water(spec), *_current(spec, scene), *_creeping(spec, scene), *_degrees(scene),
            *_twist(spec, scene)]  # fmt: skip


def _material(spec: CaseSpec, scene: Scene) -> list[FieldError]:
    """One doubt about the material is enough: others may follow from it."""
    return [*_range(spec, scene)] or [*_moduli(spec)] or [*_forces(spec, scene), *_weight(spec, scene)]


def _range(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    for name, (least, most) in MATERIALS.items():
        value = getattr(spec.rod, name)
        if value is not None and not least <= value <= most:
            unit = "kg/m³" if name == "density" else "Pa"
            asked = [f": is it in {other}?" for low, high, other in OTHER_UNITS[name] if low <= value < high]
            rule = "".join([f"is that of no material ({least:g} to {most:g} {unit})", *asked])
            yield FieldError(f"/rod/{name}", value, rule)
    if isinstance(stiffness := spec.rod.bending_stiffness, float):
        modulus = stiffness / (pi * widest(scene) ** 4 / 64.0)
        if not SOFTEST <= modulus <= MATERIALS["youngs_modulus"][1]:
            rule = f"needs a modulus of {modulus:.1g} Pa, which nothing has, for a diameter of {widest(scene):.3g} m"
            yield FieldError("/rod/bending_stiffness", stiffness, rule)


def _moduli(spec: CaseSpec) -> Iterator[FieldError]:
    """Moduli and a density that do not go together."""
    E, G, density = spec.rod.youngs_modulus, spec.rod.shear_modulus, spec.rod.density
    if E and density and density > METAL and E < SLOWEST**2 * density:
        rule = f"is that of a gel, beside a density of {density:g} kg/m³, which is that of a metal: is it in MPa?"
        yield FieldError("/rod/youngs_modulus", E, rule)
    if E and density and density < FOAM and E > SOLID:
        rule = f"is that of a foam, beside youngs_modulus, {E:g} Pa, which is that of a solid: is it in g/cm³?"
        yield FieldError("/rod/density", density, rule)
    if E and G and G > SWAPPED * E:
        rule = f"is more than youngs_modulus, {E:g} Pa; it is less than half of it in most materials: are they swapped?"
        yield FieldError("/rod/shear_modulus", G, rule)
    if E and G and E > FAR_APART * G:
        rule = f"is less than youngs_modulus, {E:g} Pa, by a factor of {E / G:.3g}: are both in Pa?"
        yield FieldError("/rod/shear_modulus", G, rule)


def _water(spec: CaseSpec) -> Iterator[FieldError]:
    fluid = spec.fluid
    if fluid and spec.rod.density != 1.0 and fluid.added_mass and WATER[0] <= fluid.density <= WATER[1]:
        rule = "is that of air, which adds next to no mass, and added_mass is given: is it in g/cm³?"
        yield FieldError("/fluid/density", fluid.density, rule)


def _current(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    if scene.fluid and spec.rod.density != 1.0 and scene.fluid.density > GAS and scene.fluid.fastest > RAPID:
        speed = scene.fluid.fastest
        yield FieldError("/fluid/current", speed, f"is faster than any current of a liquid ({RAPID:g} m/s)")


def _creeping(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    """A rod so thin that a liquid creeps around it."""
    fluid, diameter = scene.fluid, widest(scene)
    if fluid and fluid.density > GAS and fluid.drag_normal > 0.0 and diameter < CREEPING:
        rule = (f"is of u², and the liquid creeps around a rod of {diameter:.2g} m, whose drag is in proportion to u: "
                "give viscosity instead, in Pa s (water: .001)")  # fmt: skip
        yield FieldError("/fluid/drag_normal", fluid.drag_normal, rule)


def _forces(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    """A force that would tear a rod of this material. What `axial_stiffness` says is looked at elsewhere."""
    if spec.rod.youngs_modulus is None or spec.rod.axial_stiffness is not None:
        return
    stiffness = spec.rod.youngs_modulus * pi * widest(scene) ** 2 / 4.0
    where, force = max(forces(scene).items(), key=lambda one: one[1])
    if force > LARGEST_STRAIN * stiffness:
        rule = (f"has a force that would stretch a rod of this youngs_modulus and diameter by {force / stiffness:.2g} "
                "of its length: are they in N, Pa and m? If so, give the rod its axial_stiffness")  # fmt: skip
        yield FieldError(where, force, rule)


def _weight(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    """A rod that its own weight would tear, where an end holds it and nothing else bears it."""
    E, held = spec.rod.youngs_modulus, (*scene.start.translation, *scene.end.translation)
    if E is None or spec.rod.axial_stiffness is not None or all(c[0].kind == "load" for c in held):
        return
    if scene.loads:
        return
    s = np.linspace(0.0, spec.rod.length, 201)
    areas = pi * (scene.rod.diameter(s) + 0.0 * s) ** 2 / 4.0
    water = 0.0 if scene.fluid is None else scene.fluid.density
    weight = abs(float(np.mean(scene.rod.mass(s) - water * areas))) * min(hypot(*scene.gravity), EARTH)
    strain = weight * spec.rod.length / (E * float(np.max(areas)))
    if strain > LARGEST_STRAIN:
        rule = (f"is so small that its weight would stretch the rod by {strain:.2g} of its length: is it in MPa? If it "
                "is in Pa, give the rod its axial_stiffness")  # fmt: skip
        yield FieldError("/rod/youngs_modulus", E, rule)


def _degrees(scene: Scene) -> Iterator[FieldError]:
    """An end that is turned over several times, or by what is a round number of degrees."""
    for name, end in (("start", scene.start), ("end", scene.end)):
        for i, conditions in enumerate(end.rotation):
            angles = [float(np.max(np.abs(c.curve(times(scene))))) for c in conditions if c.kind == "position"]
            angle = max(angles, default=0.0)
            if _are_degrees(angle) if i == 2 else angle > TURNED_OVER:
                axis = "the rod" if i == 2 else "an axis across the rod"
                rule = f"is an angle in rad, of {angle / (2 * pi):.3g} turns about {axis}: is it in degrees?"
                yield FieldError(f"/ends/{name}/theta{i + 1}", angle, rule)


def _twist(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    """A round number of degrees, where so many rad are much for the rod: a long cable may have many turns."""
    twist = spec.initial.twist
    angle = max(map(abs, twist.value if isinstance(twist, ProfileTable) else (twist,)))
    if _are_degrees(angle) and 0.5 * widest(scene) * angle > MUCH_SHEAR * spec.rod.length:
        rule = f"is an angle in rad, of {angle / (2 * pi):.3g} turns: is it in degrees?"
        yield FieldError("/initial/twist", angle, rule)


def _are_degrees(angle: float) -> bool:
    return angle > 0.0 and angle % EIGHTH == 0.0
