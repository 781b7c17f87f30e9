"""A straight rod with a loose overhand knot that is pulled at its end: without friction it rests as nearly a ring.

Audoly, Clauvelin & Neukirch, Phys. Rev. Lett. 99 (2007) 164301: as the rod's diameter h falls to 0 the knot becomes a
ring of the radius R whose tails bear the pull F = B / (2 R^2), B the bending stiffness. R is taken to be that of the
ring that has as much bending energy, E = pi B / R, as differs from it by some h^(1/2) only: F R^2 / B is followed to 0
along a parabola in (h/R)^(1/2).
"""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from solver import Condition, Contact, Curve, End, Initial, Numerics, Rod, Scene, simulate
from solver.scene.ends import FIXED
from validation.rods import trefoil
from validation.row import Row, at_most, relative

LENGTH, B, MASS = 1.0, 1.0, 1.0
PULL, DAMPING, T_END = 260.0, 25.0, 1.0
KNOTTED = 0.3
"""Part of the rod that is knotted at first. What the clamp bends of a tail falls by e in (B / F)^(1/2), .06 m: tails of
.3 m hardly tell the knot where it is; of .2 m they let it slide towards the nearer end without rest."""
MESHES = {0.004: 280, 0.002: 420, 0.001: 630}
"""Intervals, of diameters (m)."""
AIM = 0.01


def scene(diameter: float) -> Scene:
    """Damped until it rests; its end slides along the pull and may spin."""
    pull, free = ((Condition("load", Curve.constant(value)),) for value in (PULL, 0.0))
    E = 64.0 * B / (pi * diameter**4)
    rod = Rod.circular(LENGTH, diameter, E, E / 2.6, 4.0 * MASS / (pi * diameter**2))
    return Scene(
        rod=rod, initial=Initial.through(trefoil(LENGTH, KNOTTED), LENGTH), start=End.clamp(),
        end=End((FIXED, FIXED, pull), (FIXED, FIXED, free), frame="lab"), t_end=T_END, output_interval=T_END,
        damping=DAMPING, contact=Contact(),
        numerics=Numerics("staggered", intervals=MESHES[diameter], dt_max=T_END / 15),
    )  # fmt: skip


def rows() -> list[Row]:
    """F R^2 / B of the knot as h falls to 0, and that nothing passed through anything on the way."""
    values, roots, jumps = [], [], []
    for diameter in MESHES:
        *_, frame = simulate(scene(diameter))
        R = pi * B / frame.energy_bending
        values.append(PULL * R**2 / B)
        roots.append(sqrt(diameter / R))
        jumps.append(abs(frame.Tw + frame.Wr - frame.Lk))
    limit = float(np.polyfit(roots, values, 2)[2])
    return [relative("loose knot, h/R to 0: F R^2 / B", limit, 0.5, AIM),
            at_most("loose knot: |Tw+Wr-Lk|", max(jumps), 1e-6)]  # fmt: skip
