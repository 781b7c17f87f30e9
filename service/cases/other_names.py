"""What people call fields that have another name here."""

from __future__ import annotations

from collections.abc import Sequence

OTHER_NAMES = (
    ("length", "l", ""),
    ("diameter", "d thickness", ""),
    ("diameter", "r radius", ", which is twice the radius"),
    ("youngs_modulus", "e young young_modulus elastic_modulus modulus", ""),
    ("shear_modulus", "g", ""),
    ("shear_modulus", "nu poisson poisson_ratio poissons_ratio", ", which is E / (2 (1 + nu))"),
    ("density", "rho", ""),
    ("bending_stiffness", "ei ej flexural_rigidity", ""),
    ("torsional_stiffness", "gj", ""),
    ("axial_stiffness", "ea", ""),
    ("mass_per_length", "mass linear_density", ""),
    ("kappa0", "curvature natural_curvature", ""),
    ("points", "centreline centerline nodes", ""),
    ("start", "left first begin", ""),
    ("end", "right last", ""),
    ("gravity", "g weight", ""),
    ("friction", "mu", ""),
    ("added_mass", "ca", ""),
    ("drag_normal", "cd cdn drag drag_coefficient", ""),
    ("drag_tangential", "cdt", ""),
    ("current", "velocity flow", ""),
    ("moment", "torque", ""),
    ("f3", "force", ", f1 or f2"),
    ("q3", "moment torque", ", q1 or q2"),
    ("v3", "velocity speed", ", v1 or v2"),
    ("x3", "displacement position", ", x1 or x2"),
    ("omega3", "angular_velocity", ", omega1 or omega2"),
    ("theta3", "angle rotation twist", ", theta1 or theta2"),
    ("intervals", "n nodes elements segments", ""),
    ("dt_max", "dt step time_step", ""),
    ("tolerance", "tol rtol accuracy", ""),
    ("interval", "dt step frames", ", the time between frames"),
    ("fields", "variables", ""),
    ("t_end", "t time duration", ""),
    ("t", "s time times", ""),
    ("s", "t x position arclength", ""),
)
"""A field, its other names in small letters, and what is to be said besides."""


def named_otherwise(name: str, known: Sequence[str]) -> str:
    """The field, of those that are known at its place, that goes by this name elsewhere, in words; or nothing."""
    words = (f"{field}{besides}" for field, others, besides in OTHER_NAMES
             if field in known and name.lower() in others.split())  # fmt: skip
    return next(words, "")
