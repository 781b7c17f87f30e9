"""Axial stiffness, where a rod is held so that it would have to stretch.

The rod of the equations cannot stretch. Held at both ends and straight between them, it has no start: nothing says what
force it bears. There it is given the compliance of a uniform bar, c = int ds / EA (m/N), half at either end, along the
tangent t there: the end of the rod is c/2 t (t . F) short of where it is held. That is the bar's stiffness between its
ends, and touches them only; how the stretch is spread along the rod, and axial waves, are left out.
See docs/decisions/0015-held-at-both-ends.md. A rod with a law of stretch (`physics.elasticity`) needs none of it.
"""

from __future__ import annotations

from math import inf

import numpy as np

from solver.arrays import Array
from solver.kernels.rotation import rotation_of
from solver.physics.elasticity import can_stretch
from solver.physics.ends import travel
from solver.physics.section import sample
from solver.scene.ends import Component, End
from solver.scene.layout import nodes_at_rest
from solver.scene.scene import Scene

TAUT = 0.999
"""Distance of the ends, in rod lengths, from which on the rod has to be able to stretch."""
LARGEST_STRAIN = 0.1
"""Of a rod without a law of stretch: beyond it the rod that is computed is another one."""
LARGEST_BY_LAW, LARGEST_IN_CONTACT = 4.0, 0.5
"""Of a rod with one, as of rubber; and where contact holds strands apart, whose points the stretch spreads."""
LOOKED_AT = 201
"""Points along the rod, and in time, that are looked at."""


def largest_strain(scene: Scene) -> float:
    """The strain up to which a run goes on; a rod may be squeezed by the same factor."""
    if not can_stretch(scene.rod):
        return LARGEST_STRAIN
    return LARGEST_BY_LAW if scene.contact is None else LARGEST_IN_CONTACT


def stretch_of(strain: Array) -> float:
    """The largest strain, that of what is squeezed by a factor being as large as of what is stretched by it."""
    longest, shortest = 1.0 + float(strain.max()), 1.0 + float(strain.min())
    return max(longest, 1.0 / shortest) - 1.0 if shortest > 0.0 else inf


def axial_compliance(scene: Scene) -> float:
    """c = int ds / EA (m/N) of a rod that has to stretch and has no law for it, else 0.

    EA follows from EJ of the softer axis and the diameter of a solid circle, EA = 16 EJ / D^2.
    """
    if can_stretch(scene.rod) or not has_to_stretch(scene):
        return 0.0
    s = np.linspace(0.0, scene.rod.length, LOOKED_AT)
    section = sample(scene.rod, s)
    softer = np.min([profile(s) for profile in scene.rod.stiffness[:2]], axis=0)
    return float(np.trapezoid(section.diameter**2 / (16.0 * softer), s))


def axial_stiffness(scene: Scene) -> float:
    """EA (N), the harmonic mean along the rod, that a rod has which has to stretch, else 0."""
    compliance = axial_compliance(scene)
    return float(scene.rod.length) / compliance if compliance > 0.0 else 0.0


def has_to_stretch(scene: Scene) -> bool:
    """Whether both ends hold their places, and are ever as far apart as the rod is long."""
    apart = distances(scene)
    return apart is not None and bool(apart.max() >= TAUT * scene.rod.length)


def distances(scene: Scene) -> Array | None:
    """How far the ends are apart (m) at times from 0 to t_end (LOOKED_AT,), if both hold their places."""
    if not (_holds(scene.start) and _holds(scene.end)):
        return None
    s = np.linspace(0.0, scene.rod.length, LOOKED_AT)
    r, quaternion, _ = nodes_at_rest(scene.initial, s)
    times = np.linspace(0.0, scene.t_end, LOOKED_AT)
    start, end = (_path(e, r[i], quaternion[i], times) for e, i in ((scene.start, 0), (scene.end, -1)))
    return np.asarray(np.linalg.norm(end - start, axis=1))


def _holds(end: End) -> bool:
    return all(component[0].kind in ("rate", "position") for component in end.translation)


def _path(end: End, r: Array, quaternion: Array, times: Array) -> Array:
    """Where an end is held (times, 3), as far as its first conditions say, along the axes that it has at t = 0."""
    moved = np.stack([_moved(component, times) for component in end.translation], axis=1)
    return np.asarray(r + (moved if end.frame == "lab" else moved @ rotation_of(quaternion).T))


def _moved(component: Component, times: Array) -> Array:
    first = component[0]
    if first.curve.is_zero:
        return np.zeros_like(times)
    until = component[1].since if len(component) > 1 else inf
    return np.array([travel(first, min(t, until)) for t in times.tolist()])
