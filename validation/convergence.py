"""Order in ds and in dt, from runs of three steps each half of the one before.

An uneven rod is loaded smoothly from rest until it moves through large angles, and a loop is pressed onto
itself; every field is measured on its own, in the maximum over the nodes that the runs share, and through contact
over all frames in which the rod presses on itself.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicSpline

from solver import Condition, Contact, Curve, DistributedLoad, End, Frame, Initial, Rod, Scene, simulate
from solver.arrays import Array
from solver.scene.layout import nodes_at_rest
from validation.rods import DENSITY, DIAMETER, EJ, LENGTH, SHEAR_MODULUS, YOUNGS_MODULUS, fixed_steps
from validation.row import Row, observed_order

FIELDS = ("r", "v", "omega", "kappa", "f")
T_END = 4.0
DAMPING = 20.0
"""1/s; exp(-40) is left of the torsional ringing (90 rad/s, not resolved) that the load's start excites."""
LOOP = 0.3
"""Length (m) of the loop that is pressed onto itself."""
PRESSED = 0.2
"""s, in which the loop's load grows."""


def uneven_rod() -> Rod:
    """Rod R, a tenth thinner at mid-span, and half as stiff again about a2."""
    s = np.linspace(0.0, LENGTH, 9)
    thin = Curve.table(s, DIAMETER * (1 - 0.1 * np.sin(np.pi * s / LENGTH)), "cubic")
    rod = Rod.circular(LENGTH, thin, YOUNGS_MODULUS, SHEAR_MODULUS, DENSITY)
    bend, _, torsion = rod.stiffness
    return replace(rod, stiffness=(bend, lambda s: 1.5 * bend(s), torsion))


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


def looped(s: Array) -> Array:
    """A smooth loop: its tangent turns by 5.2 rad and rises, so that the strands cross 27 mm apart."""
    fine = np.linspace(0.0, LOOP, 4001)
    angle, rise = 2.6 * np.tanh((fine - 0.5 * LOOP) / 0.05), 0.14
    across = np.sqrt(1.0 - rise**2)
    tangent = np.stack([across * np.cos(angle), across * np.sin(angle), np.full_like(fine, rise)], axis=1)
    return np.asarray(CubicSpline(fine, tangent).antiderivative()(s), dtype=float)


def pressed_loop(intervals: int, dt: float, rho_inf: float) -> Scene:
    """A loop, free of stress as it is, whose crossing strands a spread force presses onto each other, against damping.

    It is pressed, from half-way on, until the surfaces are 6 mm apart, within the contact's cutoff of 20 mm. An order
    shows only where everything is resolved: a load that starts smoothly (a clamp driven by a smoothstep starts with a
    jump of its acceleration, which rings on in the shortest waves), a contact that is wider than an interval, and
    contact points closer than the nodes. The shipped short-loop case has none of these: its f is of order 1.8 in ds
    at 60 to 240 intervals, 1.96 at 120 to 480; and where its errors are down at 5e-7 rad/s in omega, the C1 taper of
    the force shows as an order of 1.6 to 1.9 in dt.
    """
    initial, zero = Initial(looped, a1=(0.0, 0.0, 1.0)), Curve.constant(0.0)
    fine = np.linspace(0.0, LOOP, 2001)
    kappa1, kappa2, kappa3 = (Curve.table(fine, column, "cubic") for column in nodes_at_rest(initial, fine)[2].T)
    rod = replace(Rod.circular(LOOP, 0.004, 5e7, 2e7, DENSITY), kappa0=(kappa1, kappa2, kappa3))
    growth = Curve.table([0.0, PRESSED], [0.0, 1.0], "smoothstep")
    force = DistributedLoad((zero, zero, lambda s: 1.5 * np.sin(2 * np.pi * s / LOOP)), schedule=growth)
    contact = Contact(
        k1=2e-5, k2=3.0, k3=1e-4, k4=1.0, aperture=0.5 * np.pi, cutoff=0.02, skip=0.03, spacing=2.5e-4
    )
    return Scene(
        rod=rod, initial=initial, start=End.clamp(), end=End.free(), t_end=PRESSED, output_interval=0.25 * PRESSED,
        damping=300.0, distributed=(force,), contact=contact, numerics=fixed_steps(intervals, dt, rho_inf),
        topology=False,
    )  # fmt: skip


def last(scene: Scene) -> list[Frame]:
    """The last frame of a run."""
    return list(simulate(scene))[-1:]


def pressing(scene: Scene) -> list[Frame]:
    """The frames of a run in which the rod presses on itself."""
    return [frame for frame in simulate(scene) if frame.contacts > 0]


def orders(name: str, runs: list[list[Frame]]) -> list[Row]:
    """Rows for each field from the frames of three runs, coarse to fine."""
    intervals = min(len(run[0].r) for run in runs) - 1
    table = []
    for field in FIELDS:
        values = [np.array([getattr(f, field)[:: (len(f.r) - 1) // intervals] for f in run]) for run in runs]
        errors = [float(np.abs(a - b).max()) for a, b in pairwise(values)]
        table.append(observed_order(f"order {name}, {field}", *errors))
    return table


def rows() -> list[Row]:
    """2.0 +- 0.1 for every field: smooth motion with rho_inf 1 and 0.5, and through contact."""
    table = orders("in ds, smooth load", [last(smooth_motion(n, 0.01, 1.0)) for n in (50, 100, 200)])
    for rho_inf in (1.0, 0.5):
        name = f"in dt, smooth load, rho_inf={rho_inf:g}"
        table += orders(name, [last(smooth_motion(100, dt, rho_inf)) for dt in (0.01, 0.005, 0.0025)])
    # f has a term of order 4 besides, from the arcs between the nodes: 2.13 at 120 to 480 intervals
    table += orders("in ds, through contact", [pressing(pressed_loop(n, 1e-3, 0.5)) for n in (240, 480, 960)])
    table += orders("in dt, through contact", [pressing(pressed_loop(120, dt, 0.5)) for dt in (1e-3, 5e-4, 2.5e-4)])
    return table
