"""Order in ds and in dt, from runs of three steps each half of the one before.

An uneven rod is loaded smoothly from rest until it moves through large angles, and a loop is pressed onto
itself; every field is measured on its own, in the maximum over the nodes that the runs share.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from service.cases.build import build_scene
from service.cases.library import apply_settings, load_case, parse_case
from solver import Condition, Curve, DistributedLoad, End, Frame, Initial, Rod, Scene, simulate
from solver.rod import Array
from validation.rods import DENSITY, DIAMETER, EJ, LENGTH, SHEAR_MODULUS, YOUNGS_MODULUS, fixed_steps
from validation.row import Row, observed_order

FIELDS = ("r", "v", "omega", "kappa", "f")
T_END = 4.0
DAMPING = 20.0
"""1/s; exp(-40) is left of the torsional ringing (90 rad/s, not resolved) that the load's start excites."""
LOOP_DAMPING = 60.0
CONTACT_SPACING = 2.5e-4
"""m: finer than all intervals, so that the contact force is smooth on the scale of each."""
PRESSED = 0.8
"""When (s) the loop's strands press on each other."""


def uneven_rod() -> Rod:
    """Rod R, a tenth thinner at mid-span, and half as stiff again about a2."""
    s = np.linspace(0.0, LENGTH, 9)
    thin = Curve.table(s, DIAMETER * (1 - 0.1 * np.sin(np.pi * s / LENGTH)), "cubic")
    rod = Rod.circular(LENGTH, thin, YOUNGS_MODULUS, SHEAR_MODULUS, DENSITY)
    bend, _, torsion = rod.stiffness
    return rod.with_properties(stiffness=(bend, lambda s: 1.5 * bend(s), torsion))


def smooth_motion(intervals: int, dt: float, rho_inf: float) -> Scene:
    """A cantilever that a spread force, a following moment and a turning clamp set in motion, all from rest."""

    def none(s: Array) -> Array:
        return 0.0 * s

    growth = Curve.table([0.0, T_END], [0.0, 1.0], "smoothstep")
    force = DistributedLoad((lambda s: 60 * EJ * np.sin(2 * s), lambda s: 60 * EJ * s, none), schedule=growth)
    moment = DistributedLoad(moment=(none, none, lambda s: 2 * EJ * s), frame="material", schedule=growth)
    clamp = End.clamp()
    start = End(clamp.translation, (*clamp.rotation[:2], (Condition("rate", growth),)))
    return Scene(
        rod=uneven_rod(), initial=Initial.straight(), start=start, end=End.free(), t_end=T_END,
        output_interval=T_END, damping=DAMPING, distributed=(force, moment),
        numerics=fixed_steps(intervals, dt, rho_inf), topology=False,
    )  # fmt: skip


def pressed_loop(intervals: int, dt: float, rho_inf: float) -> Scene:
    """The shipped short-loop case while its strands press on each other."""
    settings = {"numerics.intervals": intervals, "contact.spacing": CONTACT_SPACING}
    scene = build_scene(parse_case(apply_settings(load_case("short-loop"), settings)))
    numerics = fixed_steps(intervals, dt, rho_inf)
    damped = replace(scene, numerics=numerics, damping=LOOP_DAMPING, topology=False)
    return replace(damped, t_end=PRESSED, output_interval=PRESSED)


def last(scene: Scene) -> Frame:
    """The last frame of a run."""
    *_, frame = simulate(scene)
    return frame


def orders(name: str, scenes: list[Scene]) -> list[Row]:
    """Rows for each field from three runs, coarse to fine."""
    frames = [last(scene) for scene in scenes]
    intervals = min(len(frame.r) for frame in frames) - 1
    found = []
    for field in FIELDS:
        values = [getattr(frame, field)[:: (len(frame.r) - 1) // intervals] for frame in frames]
        errors = [float(np.abs(a - b).max()) for a, b in pairwise(values)]
        found.append(observed_order(f"order {name}, {field}", *errors))
    return found


def rows() -> list[Row]:
    """2.0 +- 0.1 for every field: smooth motion with rho_inf 1 and 0.5, and through contact."""
    found = orders("in ds, smooth load", [smooth_motion(n, 0.01, 1.0) for n in (50, 100, 200)])
    for rho_inf in (1.0, 0.5):
        name = f"in dt, smooth load, rho_inf={rho_inf:g}"
        found += orders(name, [smooth_motion(100, dt, rho_inf) for dt in (0.01, 0.005, 0.0025)])
    found += orders("in ds, through contact", [pressed_loop(n, 0.004, 0.5) for n in (60, 120, 240)])
    found += orders("in dt, through contact", [pressed_loop(60, dt, 0.5) for dt in (0.004, 0.002, 0.001)])
    return found
