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
    ("viscosity", "mu eta dynamic_viscosity linear_drag drag_linear drag_viscous stokes", ""),
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
    ("s", "x position arclength", ""),
    ("s", "t time", ", along the rod, for it stays the same in time"),
)
"""A field, its other names in small letters, and what is to be said besides."""
NOT_THERE = (
    ("contact", "friction mu", "strands slide on each other without friction; floors and obstacles have it"),
    ("start end", "stiffness spring spring_stiffness k damping",
     "an end is held, or its load is given: it has no spring"),
    ("start end", "inertia moment_of_inertia", "a body at an end is a point: it has a mass alone"),
    ("point", "schedule", "each component of its force and moment is a function of time itself"),
    ("point", "mass m", "a body within the rod is a short piece of it with a larger mass_per_length"),
    ("obstacles floor", "velocity motion rotation angular_velocity", "what the rod meets stands still"),
    ("fluid", "surface water_level level depth", "a fluid fills all space"),
    ("loads", "temperature thermal", "thermal strain of a held rod is ends that move by it; heat has no field"),
    ("", "rods", "a case has one rod"),
    ("", "supports support", "what bears a rod within is an obstacle, or the floor, of loads"),
    ("", "_comment comment comments note notes", "what a case is stands in its title and description"),
    ("fluid", "wave waves wave_height wave_period", "waves are a current with a schedule"),
    ("", "walls wall", "a wall is the floor, with its normal, or a row of obstacles"),
)
"""What some look for and hockle does not have: the last name of the place (nothing: the case itself), names in small
letters, and what there is instead."""
OTHER_KINDS = (
    ("'clamp'", "clamp", "fixed clamped encastre built-in cantilever rigid"),
    ("'clamp'", "pin", "pinned hinge hinged ball joint simply_supported simple bearing"),
    ("'clamp'", "an object, a pin with frame lab and a force of 0 along its way, as f1", "roller roll rolling"),
    ("'clamp'", "an object, a clamp with frame lab and a force of 0 along its way, as f1",
     "guided guide sliding slide"),
    ("centreline", "centreline, with points of that curve",
     "arc catenary circle coil curve helix knot loop parabola polyline ring spiral spline"),
    ("'smoothstep'", "cubic, with a table of some 20 points a period", "sine sin sinusoidal cosine cos harmonic"),
    ("'smoothstep'", "linear, with two points close together where it jumps", "step constant previous jump"),
)
"""A word by which the rule for a value is known, one that it may have, in words, and what others call that."""
TABLES = ("t", "value")
"""Fields of a function of time."""
WAVES = "sin sine cos cosine amplitude frequency omega period phase"


def kind_named_otherwise(name: object, rule: str) -> str:
    """What goes by this name elsewhere, of what the rule for a value allows, in words; or nothing."""
    called = name.lower().replace(" ", "_") if isinstance(name, str) else ""
    return next((kind for word, kind, others in OTHER_KINDS if word in rule and called in others.split()), "")


def not_there(name: str, path: Sequence[str], known: Sequence[str]) -> str:
    """What there is instead of a field that hockle does not have, at a place with the fields that are `known`; or
    nothing."""
    if set(TABLES) <= set(known) and name.lower() in WAVES.split():
        return "a function of time is a table of t and value: some 20 points a period, with interpolation cubic"
    place = next((part for part in reversed(path) if not part.isdigit()), "")
    words = (instead for places, names, instead in NOT_THERE
             if place in (places.split() or [""]) and name.lower() in names.split())  # fmt: skip
    return next(words, "")


def named_otherwise(name: str, known: Sequence[str]) -> str:
    """The field, of those that are known at its place, that goes by this name elsewhere, in words; or nothing."""
    words = (f"{field}{besides}" for field, others, besides in OTHER_NAMES
             if field in known and name.lower() in others.split())  # fmt: skip
    return next(words, "")
